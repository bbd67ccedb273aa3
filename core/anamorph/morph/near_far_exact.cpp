// SPDX-License-Identifier: Apache-2.0
// With u = 2^-53, w_i the weights, l_i = w_i / sum of w, D_i what the lines say and D their mean.
//
// (1) A line's place and what it says: FeatureMap::Rounding holds what its numbers are off by. At a distance
// rho from p
//     the place in its frame is off by turn rho + place, its displacement by as much and (1 + stretch) times
//     that, and a + dist by h.
// (2) Its weight is off, in proportion, by b h / (a + dist) and a constant. A weight off by a factor 1 + e
// moves D by
//     e l_i |D_i - D| = e l_i (1 - l_i) |D_i - (mean of the others)|, where 1 - l_i <= (others' weights) /
//     w_i falls with the distance as it ought to: near the line D is D_i, however badly its distance is
//     known. Where 2 (1 + b) h is more than a + dist, the weight counts as unknown: D moves by (1 - l_i) of
//     that at most.
// (3) Sums of n terms, the quotient and the product with the scale.
//
// All are bounded over a box from distances at its centre; a box on which (2) is much is cut in two.
//
// The factors. F = turn rho + place + 2 u (rho + |x| + |y| + a), L is the line's length, s its stretch.
//
// - 4 F for the place in the frame, and for a + dist (line_off). Its parts are, of the direction, turn rho;
//   of p, sqrt(2) place; of what is computed, 3 u rho in along and in beside (a difference, a product, a
//   sum), sqrt(2) times that together, 3 u rho for the length and 2 u (rho + a) for what is added and
//   subtracted: below 10 u rho + 2 u a. With rho <= |x| + |y| + |p| and place >= 5 u times a coordinate of p
//   that is 5 u (rho + |x| + |y|) + 2 u a + sqrt(2) place. In all less than 4 F / 1.4; what is left holds
//   products of two.
//
// - (3 + 2 s) 4 F + 8 place for the displacement. The rates, as a matrix, are no longer than 3 + s, which the
//   place in the frame is multiplied by, and off by sqrt(2) turn, times rho; they are multiplied and added up
//   within 4 u (3 + s) rho; the origin is off by 4 place. With s >= 1, (3 + s) 4 F / 1.4 + 1.5 turn rho +
//   4 u (3 + s) rho + 4 place is less.
//
// - 2 (1 + b) h / d for a weight at d = a + dist. Where it is below 1, x = h / d is below 1 / (2 + 2 b), and
//   (1 - x)^-b - 1 <= e^y - 1 <= 1.3 y for y = b x / (1 - x) <= 1/2; 1 / (1 - x) <= (2 + 2 b) / (1 + 2 b)
//   makes 1.3 y <= 2 (1 + b) x for any b. Where it is above 1 the distance is at most d + h <= 1.5 d.
//
// - Distances in the box lie within `radius` of the centre's, which is itself off by h, as is each: 2 h, and
//   twice that from the nearest to the farthest.
//
// - 2 power_rounding (morph/feature_rows.h) for powers that vectors make of logarithms, of the line's greatest
//   distance over the least of any line; as FeatureMap makes them they are in the constant.
//
// - 4 u (n + 4) of the mean's size: n + 1 roundings of numerator and denominator each, and 2 more, twice; and
//   8 u of the pixel's place, which is added and scaled (2 u), four times.
//
// - 2 of all: parts of the sum of weights, l_i and the mean are those of weights that are off themselves.
//
// Shaders, with u = 2^-24. GLSL 4.1 (4.7.1 of its specification) lets a quotient be off by 5 u and a square root by 9 u, as its
// reciprocal and the quotient are; sums and products are rounded once. P is the larger coordinate of p, o the displacement at p. In
// addition to what double has:
//
// - Of a + dist (shader_off): p is off by sqrt(2) u P as it becomes a float. X - p, the direction, their product and the sum round by
//   u each, 4 u rho in along and in beside, 5.7 u rho together. The length of a line counts where along exceeds it, and then it is at
//   most rho: as a float u rho, and u rho as it is subtracted. Squares, their sum and the root make 10 u dist, a and the sum u (dist + 2 a).
//   With dist <= rho that is less than 19 u rho + 1.5 u P + 2 u a.
// - Of the displacement: the place, times 3 + s, 5.7 u rho + sqrt(2) u P; rates as floats, products and two sums, 4 u (3 + s) rho; the
//   origin as a float and the sums, 3 u |o|. In all less than (3 + s) (10 u rho + 1.5 u P) + 3 u |o|.
// - Of a weight, in proportion: the distance over the nearest, its power, the factor and the product, (16 + b) u. A power other than
//   those is exp2 of a product with log2: log2 is off by 8 u, or 6 u in proportion, b and the product by 2 u in proportion, exp2 by
//   6 u + 4 u |x|: less than u (6 + 8 b + 16 b |log c|).
// - Of sums: a quotient and a product are 6 u, so that 4 u (n + 4) holds here too; 8 u of the pixel's place hold the scale as a float.
// Products of two of all these are less than 1 / 100 of them.
#include "anamorph/morph/near_far_exact.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "anamorph/morph/feature_rows.h"
#include "anamorph/number/hypot.h"

namespace anamorph {
namespace {

constexpr double kHalfSpacing = 0x1p-53, kInShaders = 0x1p-24;
// Boxes are not cut for less than this, in pixels, unless less is asked for.
constexpr double kFineEnough = 1e-6;

/// What is known of a line over a box.
struct LineOnBox {
    double off;            ///< h
    double displaced;      ///< by how much its displacement is off
    double nearest, most;  ///< a + dist and the weight, at the box's nearest point
    double powers = 0;     ///< by how much its weight is off, in proportion, as a power
    double reach;          ///< the greatest distance of its displacement from the reference
};

// The length of a vector, with two roundings more than hypot's, which is nothing beside the factors; what
// overflows has no bound.
double length(double x, double y) {
    return std::sqrt(x * x + y * y);
}

/// What a shader adds to line_off().
LineOff shader_off(const FeatureMap& map, std::size_t i, const std::vector<int>& shapes, double rho) {
    constexpr double kUnit = 1.01 * kInShaders;
    const FeatureMap::TargetLine& line = map.line(i);
    const double place = 1.5 * std::max(std::fabs(line.p.x), std::fabs(line.p.y));
    double origin = 0;
    for (const int shape : shapes) {
        const Point<double>& o = map.displacement(i, shape).origin;
        origin = std::max(origin, length(o.x, o.y));
    }
    return {kUnit * (19 * rho + place + 2 * map.weights().a),
            kUnit * ((3 + map.rounding(i).stretch) * (10 * rho + place) + 3 * origin)};
}

class BoxBound {
  public:
    BoxBound(const FeatureMap& map, const std::vector<int>& shapes, double goal, bool in_shader = false)
        : m_map(map), m_shapes(shapes), m_goal(goal), m_in_shader(in_shader) {
        m_lines.resize(map.size());
    }

    double of(const Box& box) {
        const Parts parts = bound(box);
        const double all = parts.places + parts.weights;
        if (all <= m_goal) return all;
        if (parts.weights <= parts.places || (box.width() == 1 && box.height() == 1)) {
            // The goal cannot be reached: no other part is cut for it.
            m_goal = std::max(m_goal, kFineEnough);
            return all;
        }
        const auto [first, second] = halves_of(box);
        return std::max(of(first), of(second));
    }

    /// The same, whose worst boxes are cut first, until there are so many.
    double worst_first(const Box& box, std::size_t most_boxes) {
        const auto is_less = [](const Known& a, const Known& b) { return a.parts.all() < b.parts.all(); };
        std::vector<Known> boxes{{box, bound(box)}};
        while (boxes.size() < most_boxes) {
            const Known& worst = boxes.front();
            const bool is_pixel = worst.box.width() == 1 && worst.box.height() == 1;
            if (is_pixel || worst.parts.weights <= worst.parts.places) break;
            const auto halves = halves_of(worst.box);
            std::pop_heap(boxes.begin(), boxes.end(), is_less);
            boxes.pop_back();
            for (const Box& half : halves) {
                boxes.push_back({half, bound(half)});
                std::push_heap(boxes.begin(), boxes.end(), is_less);
            }
        }
        return boxes.front().parts.all();
    }

  private:
    struct Parts {
        double places = 0, weights = 0;

        /// What is no number has no bound.
        double all() const {
            const double sum = places + weights;
            return std::isnan(sum) ? HUGE_VAL : sum;
        }
    };
    struct Known {
        Box box;
        Parts parts;
    };

    static std::array<Box, 2> halves_of(const Box& box) {
        Box first = box, second = box;
        if (box.width() >= box.height())
            first.x1 = second.x0 = box.x0 + box.width() / 2;
        else
            first.y1 = second.y0 = box.y0 + box.height() / 2;
        return {first, second};
    }

    double power(double distance, double unit) const {
        return feature_detail::inverse_power(distance / unit, m_map.weights().b);
    }

    /// x^(1 / b)
    double root(double x) const {
        const double b = m_map.weights().b;
        return b == 2 ? std::sqrt(x) : b == 1 ? x : std::pow(x, 1 / b);
    }

    Parts bound(const Box& box) {
        Parts worst;
        for (const int shape : m_shapes) {
            const Parts p = bound(box, shape);
            worst.places = std::max(worst.places, p.places);
            worst.weights = std::max(worst.weights, p.weights);
        }
        return worst;
    }

    Parts bound(const Box& box, int shape) {
        const double x = 0.5 * (box.x0 + box.x1), y = 0.5 * (box.y0 + box.y1);
        // Of the pixels' centres.
        const double radius = 0.5 * hypot(box.width() - 1, box.height() - 1);
        const Point<double> at = m_map(x, y, shape), scale = m_map.scale(shape);
        const Point<double> reference{at.x / scale.x - x, at.y / scale.y - y};
        double unit = HUGE_VAL;
        for (std::size_t i = 0; i < m_lines.size(); ++i)
            unit = std::min(unit, look(i, shape, x, y, radius, reference));

        bound_powers(radius);

        double least = 0, all = 0, moment = 0, farthest = 0, displaced = 0;
        int boundless = 0;
        for (std::size_t i = 0; i < m_lines.size(); ++i) {
            LineOnBox& l = m_lines[i];
            const double factor = m_map.line(i).factor;
            l.most = factor * power(l.nearest, unit);
            least += factor * power(l.nearest + 2 * radius + 4 * l.off, unit);
            if (std::isfinite(l.most)) {
                all += l.most;
                moment += l.most * l.reach;
            } else
                ++boundless;
            farthest = std::max(farthest, l.reach);
            displaced = std::max(displaced, l.displaced);
        }
        double weights = 0, mean_displaced = 0, mean = 0;
        // By how much weights differ over the box.
        double spread = 1;
        for (std::size_t i = 0; i < m_lines.size(); ++i)
            if (std::isfinite(m_lines[i].most))
                spread =
                    std::max(spread, m_lines[i].most /
                                         (m_map.line(i).factor *
                                          power(m_lines[i].nearest + 2 * radius + 4 * m_lines[i].off, unit)));
        for (std::size_t i = 0; i < m_lines.size(); ++i) {
            const LineOnBox& l = m_lines[i];
            const double part = std::min(1.0, l.most / least);
            mean += part * l.reach;
            mean_displaced += part * l.displaced;
            const bool finite = std::isfinite(l.most);
            const double others = boundless > (finite ? 0 : 1) ? HUGE_VAL : finite ? all - l.most : all;
            // The mean of the others: where no weight is boundless and the least are near the most.
            const double between = l.reach + (others < HUGE_VAL && others > 0 && !finite
                                                  ? std::min(farthest, spread * moment / others)
                                                  : farthest);
            weights += part * between * moved(i, std::max(others, 0.0), unit);
        }
        const double to_source = std::max(scale.x, scale.y);
        const double size = length(reference.x, reference.y) + std::min(mean, farthest);
        const double sums = 4 * rounding_unit() * (static_cast<double>(m_lines.size()) + 4) * size +
                            8 * rounding_unit() * (std::fabs(x) + std::fabs(y) + 2 * radius);
        return {2 * to_source * (std::min(displaced, mean_displaced) + sums), 2 * to_source * weights};
    }

    /// Fills in a line but for its weight. Returns a + dist, the most in the box.
    double look(std::size_t i, int shape, double x, double y, double radius, const Point<double>& reference) {
        const FeatureMap::TargetLine& line = m_map.line(i);
        const FeatureMap::Frame<double> at = m_map.frame(line, x, y);
        const double distance = m_map.distance(line, at);
        const double rho = length(at.along, at.beside) + radius;
        LineOnBox& to = m_lines[i];
        const LineOff off = off_of(i, rho, std::fabs(x) + std::fabs(y) + 2 * radius);
        to.off = off.distance;
        to.displaced = off.displacement;
        // Without any rounding.
        if (!m_in_shader && radius == 0 && distance == 0 && m_map.passes_through(i, x, y)) to.off = 0;
        to.nearest = std::max(distance - radius - 2 * to.off, m_map.weights().a);
        const FeatureMap::Displacement& d = m_map.displacement(i, shape);
        const auto moved = [&](double origin, double along_rate, double beside_rate) {
            return feature_detail::displacement_by_line(origin, along_rate, at.along, beside_rate, at.beside);
        };
        const double dx = moved(d.origin.x, d.along_rate.x, d.beside_rate.x) - reference.x;
        const double dy = moved(d.origin.y, d.along_rate.y, d.beside_rate.y) - reference.y;
        to.reach = length(dx, dy) + 2 * (1 + m_map.rounding(i).stretch) * radius + to.displaced;
        return distance + radius + 2 * to.off;
    }

    void bound_powers(double radius) {
        const double b = m_map.weights().b;
        if (b == 0 || b == 0.5 || b == 1 || b == 2) return;
        double nearest = HUGE_VAL;
        for (const LineOnBox& l : m_lines) nearest = std::min(nearest, l.nearest);
        for (LineOnBox& l : m_lines) {
            const double ratio = (l.nearest + 2 * radius + 4 * l.off) / nearest;
            const double log = ratio > 0 ? b * std::log(ratio) : HUGE_VAL;
            const double most = std::min(log, simd::kMostPowerLog);
            l.powers =
                2 * rounding_unit() * (m_in_shader ? 6 + 8 * b + 16 * most : simd::power_rounding(most));
        }
    }

    /// The greatest product of a weight's error in proportion and of 1 - l over the box, as (2) says.
    double moved(std::size_t i, double others, double unit) const {
        const LineOnBox& l = m_lines[i];
        const double b = m_map.weights().b, factor = m_map.line(i).factor;
        const double constant = 2 * weight_rounding(i) + l.powers;
        if (b == 0 || (l.nearest == 0 && l.off == 0)) return std::min(1.0, constant);
        const double unknown = 2 * (1 + b) * l.off;
        const auto rest = [&](double distance) {
            return std::min(1.0, others / factor / power(distance, unit));
        };
        // unknown / d falls and 1 - l grows until it may be 1, at `turn`: as a product the greatest at one of
        // the ends.
        const double from = std::max(l.nearest, unknown);
        const double turn = others > 0 ? unit * root(factor / others) : HUGE_VAL;
        double worst = from < turn ? unknown / from * rest(from) : unknown / from;
        if (b >= 1 && from < turn) worst = unknown / turn;
        // Nearer than `unknown`, 1 - l is at most what it is there, with the error of the distance.
        if (l.nearest < unknown) worst = std::max(worst, rest(1.5 * unknown));
        return std::min(1.0, worst + constant);
    }

    double rounding_unit() const { return m_in_shader ? kInShaders : kHalfSpacing; }
    LineOff off_of(std::size_t i, double rho, double farthest) const {
        const LineOff off = line_off(m_map, i, rho, farthest);
        if (!m_in_shader) return off;
        const LineOff more = shader_off(m_map, i, m_shapes, rho);
        return {off.distance + more.distance, off.displacement + more.displacement};
    }
    double weight_rounding(std::size_t i) const {
        return m_map.rounding(i).weight + (m_in_shader ? kInShaders * (16 + m_map.weights().b) : 0);
    }

    const FeatureMap& m_map;
    const std::vector<int>& m_shapes;
    double m_goal;  ///< boxes are cut until they are below it
    bool m_in_shader;
    std::vector<LineOnBox> m_lines;
};

}  // namespace

LineOff line_off(const FeatureMap& map, std::size_t i, double rho, double farthest) {
    const FeatureMap::Rounding& rounding = map.rounding(i);
    const double other = rounding.place + 2 * kHalfSpacing * (rho + farthest + map.weights().a);
    // A direction that is off moves no point of the line by more than its end, and X, seen from p, by as much
    // as it is away.
    const double turned = rounding.turn * std::min(rho, map.line(i).length);
    return {4 * (turned + other),
            (3 + 2 * rounding.stretch) * 4 * (rounding.turn * rho + other) + 8 * rounding.place};
}

double exact_bound(const FeatureMap& map, const std::vector<int>& shapes, const Box& box, double tol) {
    return BoxBound(map, shapes, tol > 0 ? std::min(tol, kFineEnough) : kFineEnough).of(box);
}

double shader_bound(const FeatureMap& map, const std::vector<int>& shapes, const Box& box,
                    std::size_t most_boxes) {
    return BoxBound(map, shapes, 0, true).worst_first(box, most_boxes);
}

}  // namespace anamorph
