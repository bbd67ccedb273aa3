// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/feature_lines.h"

#include <array>
#include <cstdint>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

// Farther out, and longer, than any picture; products of two of them stay far from overflow.
constexpr double kMostCoordinate = 1e9;
constexpr double kHalfUlp = 0x1p-53;
// Relative to the greatest: so that no sum of weights is 0.
constexpr double kLeastFactor = 1e-250;

std::string written(const Line& line) {
    return shortest(line.p.x) + "," + shortest(line.p.y) + "," + shortest(line.q.x) + "," +
           shortest(line.q.y);
}

bool fits(const Point<double>& p) {
    return std::fabs(p.x) <= kMostCoordinate && std::fabs(p.y) <= kMostCoordinate;
}

/// The name of a feature in messages, before it has been added.
std::string name_of(const std::string& name, std::size_t index) {
    return name.empty() ? "line " + std::to_string(index + 1) : name;
}

double length_of(const Point<double>& v) {
    return std::sqrt(v.x * v.x + v.y * v.y);
}

/// A double, and whether it is what exact arithmetic gives: an operation's remainder, which a fused product
/// or differences tell, is 0. Products near underflow, whose remainder has no double, do not count as exact.
struct Checked {
    double value = 0;
    bool exact = true;

    friend Checked operator*(const Checked& a, const Checked& b) {
        const double p = a.value * b.value;
        const bool none =
            a.value == 0 || b.value == 0 || (std::fabs(p) > 1e-250 && std::fma(a.value, b.value, -p) == 0);
        return {p, a.exact && b.exact && none};
    }
    friend Checked operator/(const Checked& a, const Checked& b) {
        const double q = a.value / b.value;
        return {q, a.exact && b.exact && (Checked{q} * b).exact && q * b.value == a.value};
    }
    friend Checked operator+(const Checked& a, const Checked& b) {
        const double sum = a.value + b.value, of_b = sum - a.value, of_a = sum - of_b;
        return {sum, a.exact && b.exact && (a.value - of_a) + (b.value - of_b) == 0};
    }
    friend Checked operator-(const Checked& a, const Checked& b) { return a + Checked{-b.value, b.exact}; }
};

/// The coordinates of p, then of q.
using Ends = std::array<Checked, 4>;

Line line_of(const Ends& e) {
    return {{e[0].value, e[1].value}, {e[2].value, e[3].value}};
}

/// A line of the target: the sum of every shape's by its weight.
Ends mixed(const std::vector<Ends>& shapes, const std::vector<double>& mixture) {
    Ends sum;
    for (std::size_t k = 0; k < shapes.size(); ++k)
        for (std::size_t i = 0; i < sum.size(); ++i) sum[i] = sum[i] + Checked{mixture[k]} * shapes[k][i];
    return sum;
}

/// What rounding does to a line of the target of this length, and to what it says: FeatureMap::Rounding but
/// for the weight. Ends are made of a quotient and two products for each coordinate and shape and their sum;
/// a direction is the difference of two ends over a length that is off as they are.
FeatureMap::Rounding rounding_of(const std::vector<Ends>& shapes, const std::vector<double>& mixture,
                                 const Ends& target, double length) {
    double in_mixture = 0, largest = 0, shortest_length = length, longest = length;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
        const Line l = line_of(shapes[k]);
        const double size =
            std::max({std::fabs(l.p.x), std::fabs(l.p.y), std::fabs(l.q.x), std::fabs(l.q.y)});
        in_mixture += std::fabs(mixture[k]) * size;
        largest = std::max(largest, size);
        const double own = length_of({l.q.x - l.p.x, l.q.y - l.p.y});
        shortest_length = std::min(shortest_length, own);
        longest = std::max(longest, own);
    }
    const double place = (static_cast<double>(shapes.size()) + 3) * kHalfUlp * std::max(in_mixture, largest);
    const double stretch = longest / length;
    const bool exact = std::all_of(target.begin(), target.end(), [](const Checked& c) { return c.exact; });
    return {place, 8 * place * (1 + stretch) / shortest_length, 0, stretch, exact, line_of(target).q};
}

/// Lines that keep the chain within kCurveDeviation of a cubic: between two points at a step h of its
/// parameter a curve strays by at most h^2 / 8 of its second derivative.
int lines_of(const Point<double>* c) {
    const auto second = [&](int i) {
        return length_of({c[i].x - 2 * c[i + 1].x + c[i + 2].x, c[i].y - 2 * c[i + 1].y + c[i + 2].y});
    };
    const double most = 6 * std::max(second(0), second(1));
    const double n = std::ceil(std::sqrt(most / (8 * Features::kCurveDeviation)));
    return n >= 1 ? static_cast<int>(std::min<double>(n, Features::kMostCurveLines)) : 1;
}

Point<double> on_cubic(const Point<double>* c, double t) {
    const double s = 1 - t, w[4] = {s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    Point<double> p{0, 0};
    for (int i = 0; i < 4; ++i) p = {p.x + w[i] * c[i].x, p.y + w[i] * c[i].y};
    return p;
}

}  // namespace

// --- Features

Features::Features(int shapes) : m_shapes(shapes) {
    if (shapes < 2) throw Error("shapes", std::to_string(shapes), "a morph needs two or more");
    m_frames.resize(static_cast<std::size_t>(shapes));
    m_titles.resize(m_frames.size());
    m_pictures.resize(m_frames.size());
}

std::string Features::name(std::size_t i) const {
    return name_of(m_names[i], i);
}

void Features::add(const Given& feature) {
    if (feature.kind == Given::Kind::polyline)
        return add_polyline(feature.points, feature.weight, feature.name);
    if (feature.kind == Given::Kind::curve) return add_curve(feature.points, feature.weight, feature.name);
    std::vector<Line> line;
    for (const std::vector<Point<double>>& ends : feature.points) line.push_back({ends.at(0), ends.at(1)});
    add_line(line, feature.weight, feature.name);
}

void Features::add_line(const std::vector<Line>& line, double weight, const std::string& name) {
    append_line(line, weight, name);
    Given given{Given::Kind::line, {}, weight, name};
    for (const Line& l : line) given.points.push_back({l.p, l.q});
    m_given.push_back(std::move(given));
}

void Features::append_line(const std::vector<Line>& line, double weight, const std::string& name) {
    const std::string what = name_of(name, size());
    if (line.size() != static_cast<std::size_t>(m_shapes))
        throw Error(what, std::to_string(line.size()) + " shapes", "must be " + std::to_string(m_shapes));
    for (const Line& l : line) {
        if (!fits(l.p) || !fits(l.q)) throw Error(what, written(l), "coordinates must be at most 1e9 pixels");
        if (l.p.x == l.q.x && l.p.y == l.q.y) throw Error(what, written(l), "a line needs a length");
    }
    if (!(weight >= 0 && std::isfinite(weight)))
        throw Error(what + " weight", shortest(weight), "must be a finite number of at least 0");
    m_lines.insert(m_lines.end(), line.begin(), line.end());
    m_weights.push_back(weight);
    m_names.push_back(name);
}

void Features::add_polyline(const std::vector<std::vector<Point<double>>>& vertices, double weight,
                            const std::string& name) {
    append_polyline(vertices, weight, name);
    m_given.push_back({Given::Kind::polyline, vertices, weight, name});
}

void Features::append_polyline(const std::vector<std::vector<Point<double>>>& vertices, double weight,
                               const std::string& name) {
    const std::string what = name_of(name, size());
    if (vertices.size() != static_cast<std::size_t>(m_shapes))
        throw Error(what, std::to_string(vertices.size()) + " shapes", "must be " + std::to_string(m_shapes));
    const std::size_t count = vertices[0].size();
    if (count < 2) throw Error(what, std::to_string(count) + " vertices", "must be two or more");
    for (const auto& v : vertices)
        if (v.size() != count)
            throw Error(what, std::to_string(v.size()) + " vertices",
                        "the first shape has " + std::to_string(count));
    std::vector<Line> line(vertices.size());
    for (std::size_t i = 0; i + 1 < count; ++i) {
        for (std::size_t k = 0; k < vertices.size(); ++k) line[k] = {vertices[k][i], vertices[k][i + 1]};
        append_line(line, weight, name);
    }
}

void Features::add_curve(const std::vector<std::vector<Point<double>>>& control_points, double weight,
                         const std::string& name) {
    const std::string what = name_of(name, size());
    if (control_points.size() != static_cast<std::size_t>(m_shapes))
        throw Error(what, std::to_string(control_points.size()) + " shapes",
                    "must be " + std::to_string(m_shapes));
    const std::size_t count = control_points[0].size();
    if (count < 4 || count % 3 != 1)
        throw Error(what, std::to_string(count) + " control points", "must be 4, 7, 10 ...");
    for (const auto& points : control_points) {
        if (points.size() != count)
            throw Error(what, std::to_string(points.size()) + " control points",
                        "the first shape has " + std::to_string(count));
        for (const Point<double>& p : points)
            if (!fits(p))
                throw Error(what, shortest(p.x) + "," + shortest(p.y),
                            "coordinates must be at most 1e9 pixels");
    }
    std::vector<std::vector<Point<double>>> chain(control_points.size());
    for (std::size_t k = 0; k < chain.size(); ++k) chain[k].push_back(control_points[k][0]);
    for (std::size_t i = 0; i + 3 < count; i += 3) {
        int n = 1;
        for (const auto& points : control_points) n = std::max(n, lines_of(points.data() + i));
        for (std::size_t k = 0; k < chain.size(); ++k)
            for (int j = 1; j <= n; ++j)
                chain[k].push_back(on_cubic(control_points[k].data() + i, static_cast<double>(j) / n));
    }
    append_polyline(chain, weight, name);
    m_given.push_back({Given::Kind::curve, control_points, weight, name});
}

void Features::pin_border(double weight) {
    if (!(weight >= 0 && std::isfinite(weight)))
        throw Error("pin_border", shortest(weight), "must be a finite number of at least 0");
    m_border = weight;
}

void Features::set_title(int shape, const std::string& title, const std::string& picture) {
    m_titles[static_cast<std::size_t>(shape)] = title;
    m_pictures[static_cast<std::size_t>(shape)] = picture;
}

Features Features::in_order(const std::vector<int>& shapes) const {
    Features ordered = *this;
    const auto count = static_cast<std::size_t>(m_shapes);
    for (std::size_t k = 0; k < count; ++k) {
        const auto from = static_cast<std::size_t>(shapes[k]);
        ordered.m_frames[k] = m_frames[from];
        ordered.m_titles[k] = m_titles[from];
        ordered.m_pictures[k] = m_pictures[from];
        for (std::size_t i = 0; i < m_given.size(); ++i)
            ordered.m_given[i].points[k] = m_given[i].points[from];
        for (std::size_t i = 0; i < size(); ++i) ordered.m_lines[i * count + k] = m_lines[i * count + from];
    }
    return ordered;
}

void Features::set_frame(int shape, const Frame& frame) {
    if (shape < 0 || shape >= m_shapes)
        throw Error("shape", std::to_string(shape), "must be 0 to " + std::to_string(m_shapes - 1));
    if (!(frame.width > 0 && frame.height > 0 && frame.width <= kMostCoordinate &&
          frame.height <= kMostCoordinate))
        throw Error("size", shortest(frame.width) + "x" + shortest(frame.height),
                    "must be above 0 and at most 1e9 pixels");
    m_frames[static_cast<std::size_t>(shape)] = frame;
}

// --- FeatureMap

/// Makes the lines of a map: each as the target has it, and what it says.
class FeatureMap::Builder {
  public:
    Builder(FeatureMap& map, const std::vector<double>& mixture) : m_map(map), m_mixture(mixture) {}

    void add_features(const Features& features);
    /// The four edges of the picture, which lie in the same place in every shape.
    void add_border(double weight);
    /// Weights in proportion to the greatest, with their rounding.
    void finish_weights();

  private:
    void add(const std::vector<Ends>& shape_lines, double weight, const std::string& name);

    FeatureMap& m_map;
    const std::vector<double>& m_mixture;
};

void FeatureMap::Builder::add(const std::vector<Ends>& shape_lines, double weight, const std::string& name) {
    const Ends ends = mixed(shape_lines, m_mixture);
    const Line line = line_of(ends);
    bool moves = false;
    const Point<double> e{line.q.x - line.p.x, line.q.y - line.p.y};
    const double length = length_of(e);
    // Shorter than this its direction is rounding.
    const double size = std::fabs(line.p.x) + std::fabs(line.p.y) + std::fabs(line.q.x) + std::fabs(line.q.y);
    if (!(length > 1e-12 * size && length > 1e-9))
        throw Error(name, written(line), "a line needs a length, here too");
    const Point<double> along{e.x / length, e.y / length};
    for (const Ends& shape_line : shape_lines) {
        const Line l = line_of(shape_line);
        const Point<double> to{l.q.x - l.p.x, l.q.y - l.p.y};
        const double to_length = length_of(to);
        if (!(to_length > 1e-9)) throw Error(name, written(l), "a line needs a length");
        // Eq. 5.10 less X: (P' - P) + u (e' - e) + v (perp(e') / |e'| - perp(e) / |e|)
        const Displacement d{{l.p.x - line.p.x, l.p.y - line.p.y},
                             {to.x / length - along.x, to.y / length - along.y},
                             {along.y - to.y / to_length, to.x / to_length - along.x}};
        m_map.m_displacements.push_back(d);
        for (const Point<double>& v : {d.origin, d.along_rate, d.beside_rate})
            moves = moves || v.x != 0 || v.y != 0;
    }
    m_map.m_lines.push_back({line.p, along, length, weight, moves});
    m_map.m_roundings.push_back(rounding_of(shape_lines, m_mixture, ends, length));
}

void FeatureMap::Builder::add_features(const Features& features) {
    const Size& target = m_map.m_target;
    std::vector<Ends> scaled(m_mixture.size());
    for (std::size_t i = 0; i < features.size(); ++i) {
        if (features.weight(i) == 0) continue;
        for (int k = 0; k < m_map.m_shapes; ++k) {
            const Features::Frame frame = features.frame(k);
            const auto ratio = [](double to, double own, double otherwise) {
                return Checked{to} / Checked{own > 0 ? own : otherwise};
            };
            const Checked sx = ratio(target.width, frame.width, m_map.picture(k).width),
                          sy = ratio(target.height, frame.height, m_map.picture(k).height);
            const Line& l = features.line(i, k);
            scaled[static_cast<std::size_t>(k)] = {Checked{l.p.x} * sx, Checked{l.p.y} * sy,
                                                   Checked{l.q.x} * sx, Checked{l.q.y} * sy};
        }
        add(scaled, features.weight(i), features.name(i));
    }
}

void FeatureMap::Builder::add_border(double weight) {
    const double w = m_map.m_target.width, h = m_map.m_target.height;
    const Point<double> corners[] = {{0, 0}, {w, 0}, {w, h}, {0, h}};
    for (int i = 0; i < 4; ++i) {
        const Point<double>&p = corners[i], &q = corners[(i + 1) % 4];
        add(std::vector<Ends>(m_mixture.size(), {Checked{p.x}, Checked{p.y}, Checked{q.x}, Checked{q.y}}),
            weight, "border");
    }
}

void FeatureMap::Builder::finish_weights() {
    double longest = 0, heaviest = 0;
    for (const TargetLine& line : m_map.m_lines) {
        longest = std::max(longest, line.length);
        heaviest = std::max(heaviest, line.factor);
    }
    const double b = m_map.m_weights.b, exponent = m_map.m_weights.p * b;
    for (std::size_t i = 0; i < m_map.m_lines.size(); ++i) {
        TargetLine& line = m_map.m_lines[i];
        Rounding& rounding = m_map.m_roundings[i];
        // The rounding of the length, the exponent, the two powers (of the distance too), quotients and
        // products; nothing is known of a factor that is raised.
        rounding.weight =
            exponent * 4 * rounding.place / line.length +
            kHalfUlp * (16 + 4 * b + 2 * exponent * (1 + std::fabs(std::log(line.length / longest))));
        line.factor = line.factor / heaviest * std::pow(line.length / longest, exponent);
        if (line.factor >= kLeastFactor) continue;
        line.factor = kLeastFactor;
        rounding.weight = 1;
    }
}

FeatureMap::FeatureMap(const Features& features, const std::vector<Size>& pictures, const Size& target,
                       const std::vector<double>& mixture, const LineWeights& weights)
    : m_shapes(features.shapes()), m_target(target), m_pictures(pictures), m_weights(weights) {
    const auto check_count = [&](const char* name, std::size_t count) {
        if (count != static_cast<std::size_t>(m_shapes))
            throw Error(name, std::to_string(count),
                        "the features have " + std::to_string(m_shapes) + " shapes");
    };
    check_count("pictures", pictures.size());
    check_count("shape weights", mixture.size());
    const auto check = [](const char* name, double value, double most) {
        if (!(value >= 0 && value <= most))
            throw Error(name, shortest(value), "must be a number from 0 to " + shortest(most));
    };
    check("weight_a", weights.a, LineWeights::kMostA);
    check("weight_b", weights.b, LineWeights::kMostB);
    check("weight_p", weights.p, LineWeights::kMostP);
    for (const Size& picture : pictures)
        m_scales.push_back({double(picture.width) / target.width, double(picture.height) / target.height});

    Builder builder(*this, mixture);
    builder.add_features(features);
    if (features.border_weight() > 0) builder.add_border(features.border_weight());
    if (m_lines.empty()) throw Error("features", "0 lines", "there must be one with a weight above 0");
    builder.finish_weights();
}

FeatureMap FeatureMap::along_curve() const {
    const auto spread = [](double at) {
        const auto place = static_cast<std::uint32_t>(std::clamp(at, -0x1p30, 0x1p30) + 0x1p30);
        std::uint64_t code = 0;
        for (unsigned bit = 0; bit < 32; ++bit) code |= std::uint64_t{place >> bit & 1} << 2 * bit;
        return code;
    };
    std::vector<std::pair<std::uint64_t, std::size_t>> order;
    for (std::size_t i = 0; i < m_lines.size(); ++i) {
        const TargetLine& l = m_lines[i];
        const double half = 0.5 * l.length;
        order.emplace_back(spread(l.p.x + half * l.along.x) | spread(l.p.y + half * l.along.y) << 1, i);
    }
    std::sort(order.begin(), order.end());
    FeatureMap sorted = *this;
    sorted.m_displacements.clear();
    for (std::size_t to = 0; to < order.size(); ++to) {
        const std::size_t i = order[to].second;
        sorted.m_lines[to] = m_lines[i];
        sorted.m_roundings[to] = m_roundings[i];
        for (int k = 0; k < m_shapes; ++k) sorted.m_displacements.push_back(displacement(i, k));
    }
    return sorted;
}

bool FeatureMap::passes_through(std::size_t i, double x, double y) const {
    const Point<double>&p = m_lines[i].p, &q = m_roundings[i].q;
    const auto between = [](double a, double b, double at) {
        return std::min(a, b) <= at && at <= std::max(a, b);
    };
    if (!m_roundings[i].exact || !between(p.x, q.x, x) || !between(p.y, q.y, y)) return false;
    // The point is on the straight line where dy ex = dx ey.
    const Checked dx = Checked{x} - Checked{p.x}, dy = Checked{y} - Checked{p.y};
    const Checked ex = Checked{q.x} - Checked{p.x}, ey = Checked{q.y} - Checked{p.y};
    if (!(dx.exact && dy.exact && ex.exact && ey.exact)) return false;
    const Checked one = dy * ex, other = dx * ey;
    return one.exact && other.exact && one.value == other.value;
}

}  // namespace anamorph
