// SPDX-License-Identifier: Apache-2.0
// A meridian (a great circle through a pole) turns half a turn about the pole, and where it meets the curve
// is followed: roots of one equation in the latitude, which outline_roots tells apart however close they are.
// The pole lies where the quadric is thinnest, so that its two faces stay apart.
//
// f(longitude, latitude) = |v|^2 - 1 with v = offset + matrix (e cos + p sin) and e = e1 cos + e2 sin.
// Between two meridians the latitudes are divided into boxes in which Taylor's theorem says that f has no
// zero, or that f rises or falls with the latitude. Where boxes of the second kind stand alone, exactly one
// branch of the curve passes; where a box is neither, the meridians come closer together.
#include "anamorph/figure/outline/outline_loops.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <glm/geometric.hpp>

#include "anamorph/figure/body/eigenvectors.h"
#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/outline/outline_roots.h"
#include "anamorph/number/hypot.h"

namespace anamorph::figure {
namespace {

constexpr int kFirstStrips = 16, kDeepestStrip = 44;
// Bodies that nearly coincide meet nearly everywhere: what is then left of the curve is cut short.
constexpr int kMostStrips = 1 << 20, kMostDoubtfulStrips = 20000, kMostBoxes = 1 << 19;
// Smaller parts of what is allowed do not matter.
constexpr double kNegligible = 0.02;

/// An interval of latitudes, in parts of the turn, so that neighbours share their ends to the bit.
struct LatitudeBox {
    static constexpr int kLevels = 40;
    static constexpr std::int64_t kAll = std::int64_t{8} << kLevels;
    std::int64_t low = 0, size = 0;

    static double angle(std::int64_t at) {
        return kTurn * static_cast<double>(at) / static_cast<double>(kAll);
    }
    double middle() const { return angle(low) + radius(); }
    double radius() const { return 0.5 * angle(size); }
};

enum class Kind { free, steady, unknown };

/// Where the curve meets a meridian.
struct Root {
    double latitude = 0;
    int node = 0;
};

/// Neighbouring boxes that the curve may pass.
struct Group {
    std::int64_t low = 0, high = 0;  ///< in the parts of a LatitudeBox; high may be beyond the turn
    bool certain = true;             ///< one branch passes, or none
    double bend = 0;                 ///< bounds the second derivative of the branch by the longitude
    std::int64_t unknown_low = 0, unknown_high = 0;  ///< where it is not
    std::vector<Root> left, right;

    double extent() const { return LatitudeBox::angle(unknown_high - unknown_low); }
};

class Sweep {
  public:
    Sweep(const SphereCurve& curve, const AllowedDeviation& allowed) : m_curve(curve), m_allowed(allowed) {
        const glm::dmat3 axes = eigenvectors(glm::transpose(curve.matrix) * curve.matrix);
        m_pole = pole_of(axes);
        const int other = std::fabs(glm::dot(axes[2], m_pole)) < 0.7 ? 2 : 0;
        m_first = glm::normalize(glm::cross(axes[other], m_pole));
        m_second = glm::cross(m_pole, m_first);
        m_at_pole = curve.matrix * m_pole;
        const glm::dvec3 one = curve.matrix * m_first, two = curve.matrix * m_second;
        m_pole_size = glm::length(m_at_pole);
        // The larger singular value.
        const double a = glm::dot(one, one), b = glm::dot(two, two);
        m_equator_size = std::sqrt(0.5 * (a + b) + hypot(0.5 * (a - b), glm::dot(one, two)));
        m_skew = std::fabs(glm::dot(one, m_at_pole)) + std::fabs(glm::dot(two, m_at_pole));
        bound_by_form(axes);
    }

    std::vector<std::vector<glm::dvec3>> loops() {
        if (coincides()) return {};
        std::vector<LatitudeBox> all;
        all.reserve(8);
        for (int k = 0; k < 8; ++k) all.push_back({k * (LatitudeBox::kAll / 8), LatitudeBox::kAll / 8});
        // The strips begin at an angle that no symmetry prefers.
        constexpr double from = 0.3;
        const Meridian first = meridian(from);
        Meridian left = first;
        for (int k = 1; k <= kFirstStrips; ++k) {
            Meridian right =
                k < kFirstStrips ? meridian(from + 0.5 * kTurn * k / kFirstStrips) : turned(first);
            strip(left, right, all, 0);
            left = std::move(right);
        }
        return linked();
    }

  private:
    struct Node {
        glm::dvec3 u{0.0};
        std::array<int, 2> link{-1, -1};  ///< to the left and to the right: twice the node, plus its side
        bool visited = false;
    };
    struct Meridian {
        double longitude = 0;
        std::vector<Root> roots;  ///< by their latitudes
    };

    /// The direction in which the quadric is thinnest; of several, that in which it lies.
    glm::dvec3 pole_of(const glm::dmat3& axes) const {
        const auto size = [&](int k) { return glm::length(m_curve.matrix * axes[k]); };
        const glm::dvec3 toward = glm::transpose(m_curve.matrix) * m_curve.offset;
        glm::dvec3 pole(0.0);
        for (int k = 0; k < 3; ++k)
            if (size(k) > size(0) * (1 - 0x1p-20)) pole += axes[k] * glm::dot(axes[k], toward);
        return glm::length(pole) > 0x1p-20 * glm::length(toward) ? glm::normalize(pole) : axes[0];
    }

    /// Bounds derivatives by the form: with |u| = 1, f = u Q u + 2 g u + a constant, where Q =
    /// matrix^T matrix - s may have any s: the middle of the eigenvalues makes it least. Bounds by Q and g
    /// are small where the bodies nearly coincide, those by v elsewhere. No derivative of u by longitude and
    /// latitude is longer than 1.
    void bound_by_form(const glm::dmat3& axes) {
        const glm::dvec3 large = m_curve.matrix * axes[0], small = m_curve.matrix * axes[2];
        const double most = glm::dot(large, large), least = glm::dot(small, small);
        const double form = 0.5 * (most - least) + 0x1p-44 * most;
        const double linear = glm::length(glm::transpose(m_curve.matrix) * m_curve.offset);
        m_most_second = 4 * form + 2 * linear;
        m_most_third = 8 * form + 2 * linear;
    }

    bool coincides() const {
        for (int k = 0; k < 64; ++k) {
            const double z = (k + 0.5) / 32 - 1, r = std::sqrt(1 - z * z), t = 2.4 * k;
            if (std::fabs(m_curve.at({r * std::cos(t), r * std::sin(t), z})) > m_curve.noise) return false;
        }
        return true;
    }

    glm::dvec3 equator(double longitude) const {
        return m_first * std::cos(longitude) + m_second * std::sin(longitude);
    }

    Meridian meridian(double longitude) {
        const glm::dvec3 e = equator(longitude), at = m_curve.matrix * e;
        WaveSquares f;
        f.x = {m_curve.offset.x, at.x, m_at_pole.x};
        f.y = {m_curve.offset.y, at.y, m_at_pole.y};
        f.z = {m_curve.offset.z, at.z, m_at_pole.z};
        f.w.k = 1;
        f.noise = m_curve.noise;
        Roots roots;
        add_roots(f, roots);
        drop_touching(f, roots);
        Meridian m;
        m.longitude = longitude;
        for (int k = 0; k < roots.count; ++k) {
            const double t = roots.angle[k];
            m.roots.push_back({t, static_cast<int>(m_nodes.size())});
            m_nodes.push_back({glm::normalize(e * std::cos(t) + m_pole * std::sin(t)), {-1, -1}, false});
        }
        return m;
    }

    /// When the number of roots is odd, one is no change of sign: two that rounding has made one.
    static void drop_touching(const WaveSquares& f, Roots& roots) {
        const auto negative_after = [&](int k) {
            const double next = k + 1 < roots.count ? roots.angle[k + 1] : roots.angle[0] + kTurn;
            return f.at(direction(0.5 * (roots.angle[k] + next))) < 0;
        };
        for (int k = 0; roots.count % 2 == 1 && k < roots.count; ++k) {
            if (roots.count > 1 && negative_after(k) != negative_after((k + roots.count - 1) % roots.count))
                continue;
            std::copy(roots.angle + k + 1, roots.angle + roots.count, roots.angle + k);
            --roots.count;
        }
    }

    /// A meridian half a turn on: the same one, whose latitude runs the other way.
    static Meridian turned(Meridian m) {
        m.longitude += 0.5 * kTurn;
        for (Root& root : m.roots) {
            root.latitude = 0.5 * kTurn - root.latitude;
            if (root.latitude < 0) root.latitude += kTurn;
        }
        std::sort(m.roots.begin(), m.roots.end(),
                  [](const Root& a, const Root& b) { return a.latitude < b.latitude; });
        return m;
    }

    // --- Boxes

    struct Strip {
        double half = 0;                  ///< of its width
        glm::dvec3 at{0.0}, across{0.0};  ///< matrix e in its middle, and the derivative by the longitude
    };

    /// What f does in a box of latitudes within a strip.
    struct Findings {
        Kind kind = Kind::unknown;
        bool hopeless = false;         ///< only a narrower strip helps
        double first = 0, second = 0;  ///< of a branch: bound the latitude's derivatives by the longitude
        double bend = 0;               ///< and the second derivative of the point
    };
    Findings examine(const Strip& strip, double middle, double r) const {
        const double cosine = std::cos(middle), sine = std::sin(middle), h = strip.half, e = m_equator_size;
        const double c0 = std::fabs(cosine), s0 = std::fabs(sine);
        const double c = std::min(1.0, c0 + r), s = std::min(1.0, s0 + r), reach = c * e + s * m_pole_size;
        const glm::dvec3 v = m_curve.offset + strip.at * cosine + m_at_pole * sine,
                         by_latitude = m_at_pole * cosine - strip.at * sine,
                         by_longitude = strip.across * cosine;
        const double f = std::fabs(glm::dot(v, v) - 1), a = 2 * std::fabs(glm::dot(v, by_longitude)),
                     b = 2 * std::fabs(glm::dot(v, by_latitude)), size = glm::length(v);
        Findings found;
        // How far v and its derivative by the latitude may go from the middle of the box.
        const double steepest = glm::length(by_latitude) + h * s * e + r * reach;
        const double moved = h * c * e + r * steepest, farthest = size + moved;
        const double bent = moved * moved + size * (h * h * c * e + 2 * h * r * s * e + r * r * reach);
        const double swing = h * a + r * b + std::min(bent, 0.5 * m_most_second * (h + r) * (h + r));
        if (f > swing + 2 * m_curve.noise) {
            found.kind = Kind::free;
            return found;
        }
        // The second derivatives in the middle, and how much the third, bounded, change them in the box.
        const glm::dvec3 twist = strip.across * -sine, back = strip.at * -cosine,
                         fall = back - m_at_pole * sine;
        const auto bound_21 = [&](double cos_most, double sin_most, double v_most) {
            const double by_v =
                3 * cos_most * sin_most * e * e + cos_most * cos_most * m_skew + v_most * sin_most * e;
            return std::min(2 * by_v, m_most_third);
        };
        const double to_side = s * (s * e * e + c * m_skew);
        const auto third = [&](double half) { return std::min(2 * half, m_most_third); };
        const double t30 = third(3 * c * c * e * e + farthest * c * e), t21 = bound_21(c, s, farthest),
                     t12 = third(2 * to_side + c * (c * e * e + s * m_skew) + farthest * c * e),
                     t03 = third(3 * steepest * reach + farthest * (s * e + c * m_pole_size));
        const auto second = [&](double at_middle, double by_h, double by_r) {
            return 2 * std::fabs(at_middle) + h * by_h + r * by_r;
        };
        const double along = second(glm::dot(by_longitude, by_longitude) + glm::dot(v, back), t30, t21);
        const double mixed_here = glm::dot(by_longitude, by_latitude) + glm::dot(v, twist);
        const double mixed = second(mixed_here, t21, t12);
        const double twice = second(glm::dot(by_latitude, by_latitude) + glm::dot(v, fall), t12, t03);
        const double slope = b - h * mixed - r * twice;
        if (slope > 0) {
            found.kind = Kind::steady;
            found.first = (a + h * along + r * mixed) / slope;
            found.second = (along + 2 * mixed * found.first + twice * found.first * found.first) / slope;
            found.bend = c + 2 * s * found.first + found.first * found.first + found.second;
            return found;
        }
        // The same for the middle alone, which no narrower box changes.
        const double moved_here = h * c0 * e;
        const double bent_here = size * h * moved_here + moved_here * moved_here;
        const bool never_free =
            f <= h * a + std::min(bent_here, 0.5 * m_most_second * h * h) + 2 * m_curve.noise;
        const bool never_steady =
            b <= h * (2 * std::fabs(mixed_here) + h * bound_21(c0, s0, size + moved_here));
        found.hopeless = (never_free && never_steady) || f + swing <= 8 * m_curve.noise;
        return found;
    }

    /// Bounds the second derivative of the only branch in a strip, whose latitudes at its sides are known,
    /// where it stays in a box about them: as far as its steepest slope in the box takes it.
    double bend_of(const Strip& strip, double left, double right, double otherwise) const {
        right -= kTurn * std::round((right - left) / kTurn);
        const double middle = 0.5 * (left + right);
        double r = 0.7 * std::fabs(right - left) + 0x1p-40;
        for (int k = 0; k < 4; ++k) {
            const Findings found = examine(strip, middle, r);
            if (found.kind != Kind::steady) break;
            const double needed = found.first * strip.half;
            if (needed <= r) return std::min(found.bend, otherwise);
            r = 1.3 * needed;
        }
        return otherwise;
    }

    /// Divides a box until it is known, or only a narrower strip helps; adds what is not free.
    void divide(const Strip& strip, const LatitudeBox& box, std::vector<LatitudeBox>& boxes,
                std::vector<Group>& groups) {
        const Findings found = examine(strip, box.middle(), box.radius());
        if (found.kind == Kind::free) return;
        if (found.kind == Kind::unknown && !found.hopeless && box.size > 1 && ++m_boxes < kMostBoxes) {
            divide(strip, {box.low, box.size / 2}, boxes, groups);
            divide(strip, {box.low + box.size / 2, box.size / 2}, boxes, groups);
            return;
        }
        boxes.push_back(box);
        if (groups.empty() || groups.back().high != box.low)
            groups.push_back({box.low, box.low, true, 0, 0, 0, {}, {}});
        Group& group = groups.back();
        group.high = box.low + box.size;
        if (found.kind != Kind::steady) {
            if (group.certain) group.unknown_low = box.low;
            group.unknown_high = group.high;
            group.certain = false;
        }
        group.bend = std::max(group.bend, found.bend);
    }

    /// Joins the last group to the first where they meet at 0.
    static void close(std::vector<Group>& groups) {
        if (groups.size() < 2 || groups.front().low > 0 || groups.back().high < LatitudeBox::kAll) return;
        Group& last = groups.back();
        const Group& front = groups.front();
        last.high += front.high;
        if (!front.certain) {
            if (last.certain) last.unknown_low = LatitudeBox::kAll + front.unknown_low;
            last.unknown_high = LatitudeBox::kAll + front.unknown_high;
            last.certain = false;
        }
        last.bend = std::max(last.bend, front.bend);
        groups.erase(groups.begin());
    }

    /// Gives the roots of a meridian to their groups; false where one is in none.
    static bool assign(const Meridian& m, std::vector<Group>& groups, bool left) {
        for (const Root& root : m.roots) {
            Group* nearest = nullptr;
            double least = HUGE_VAL;
            for (Group& g : groups)
                for (const double turn : {0.0, kTurn}) {
                    const double t = root.latitude + turn;
                    const double away =
                        std::max({LatitudeBox::angle(g.low) - t, t - LatitudeBox::angle(g.high), 0.0});
                    if (away < least) least = away, nearest = &g;
                }
            if (!nearest || least > 1e-9) return false;
            (left ? nearest->left : nearest->right).push_back(root);
        }
        return true;
    }

    // --- Strips

    const glm::dvec3& point(const Root& root) const { return m_nodes[static_cast<std::size_t>(root.node)].u; }

    void link(const Root& one, int a_side, const Root& other, int b_side) {
        const int a = one.node, b = other.node;
        m_nodes[static_cast<std::size_t>(a)].link[static_cast<std::size_t>(a_side)] = 2 * b + b_side;
        m_nodes[static_cast<std::size_t>(b)].link[static_cast<std::size_t>(b_side)] = 2 * a + a_side;
    }

    /// Is all that matters known of a group in a strip of this width?
    bool settled(const Group& g, const Strip& strip, double width) const {
        const double middle = 0.5 * (LatitudeBox::angle(g.unknown_low) + LatitudeBox::angle(g.unknown_high));
        if (g.certain && g.left.size() == g.right.size() && g.left.size() < 2) {
            if (g.left.empty()) return true;
            const glm::dvec3 &p = point(g.left[0]), &q = point(g.right[0]);
            const double length = glm::distance(p, q);
            const double bend = bend_of(strip, g.left[0].latitude, g.right[0].latitude, g.bend);
            return bend * width * width / 8 <= m_allowed(glm::normalize(p + q), length);
        }
        const std::vector<Root>& two = g.left.empty() ? g.right : g.left;
        const bool fold = g.left.size() + g.right.size() == 2 && two.size() == 2;
        const glm::dvec3 u =
            fold ? point(two[0]) : equator(m_middle) * std::cos(middle) + m_pole * std::sin(middle);
        const double small = kNegligible * m_allowed(u, g.extent() + width);
        // Where a branch turns back it does so within the strip, between its two roots.
        if (fold && width <= small && g.extent() <= 4 * glm::distance(point(two[0]), point(two[1])))
            return true;
        return width <= small && g.extent() <= small;
    }

    /// Joins what is left of a group: across the strip in order, and what remains, neighbour to neighbour.
    void join(const Group& g) {
        std::vector<Root> left = g.left, right = g.right;
        std::vector<Root>& more = left.size() > right.size() ? left : right;
        const std::size_t fewer = std::min(left.size(), right.size());
        const int side = &more == &left ? 1 : 0;
        while (more.size() >= fewer + 2) {
            std::size_t nearest = 0;
            const auto gap = [&](std::size_t k) { return glm::distance(point(more[k]), point(more[k + 1])); };
            for (std::size_t k = 1; k + 1 < more.size(); ++k)
                if (gap(k) < gap(nearest)) nearest = k;
            link(more[nearest], side, more[nearest + 1], side);
            more.erase(more.begin() + static_cast<std::ptrdiff_t>(nearest),
                       more.begin() + static_cast<std::ptrdiff_t>(nearest) + 2);
        }
        for (std::size_t k = 0; k < std::min(left.size(), right.size()); ++k) link(left[k], 1, right[k], 0);
    }

    void strip(const Meridian& left, const Meridian& right, const std::vector<LatitudeBox>& boxes,
               int depth) {
        const double width = right.longitude - left.longitude;
        m_middle = 0.5 * (left.longitude + right.longitude);
        Strip strip_here;
        strip_here.half = 0.5 * width * (1 + 0x1p-40);
        strip_here.at = m_curve.matrix * equator(m_middle);
        strip_here.across = m_curve.matrix * equator(m_middle + 0.25 * kTurn);
        std::vector<LatitudeBox> finer;
        std::vector<Group> groups;
        for (const LatitudeBox& box : boxes) divide(strip_here, box, finer, groups);
        close(groups);
        const bool assigned = assign(left, groups, true) && assign(right, groups, false);
        const bool doubtful = !assigned || std::any_of(groups.begin(), groups.end(), [](const Group& g) {
            return !g.certain || g.left.size() != g.right.size();
        });
        const bool enough = depth == kDeepestStrip || ++m_strips > kMostStrips || m_boxes > kMostBoxes ||
                            (doubtful && ++m_doubtful > kMostDoubtfulStrips);
        const bool done = assigned && std::all_of(groups.begin(), groups.end(), [&](const Group& g) {
                              return settled(g, strip_here, width);
                          });
        if (done || enough) {
            for (const Group& g : groups) join(g);
            return;
        }
        const Meridian middle = meridian(m_middle);
        strip(left, middle, finer, depth + 1);
        strip(middle, right, finer, depth + 1);
    }

    // --- Loops

    std::vector<std::vector<glm::dvec3>> linked() {
        std::vector<std::vector<glm::dvec3>> all;
        for (std::size_t start = 0; start < m_nodes.size(); ++start) {
            if (m_nodes[start].visited) continue;
            std::vector<glm::dvec3> loop = followed(start, 1);
            // The other end of what is not closed, which only rounding leaves so.
            if (const std::vector<glm::dvec3> rest = followed(start, 0); rest.size() > 1)
                loop.insert(loop.begin(), rest.rbegin(), rest.rend() - 1);
            if (loop.size() > 2) all.push_back(std::move(loop));
        }
        return all;
    }

    std::vector<glm::dvec3> followed(std::size_t start, int side) {
        std::vector<glm::dvec3> points{m_nodes[start].u};
        m_nodes[start].visited = true;
        std::size_t at = start;
        while (true) {
            const int next = m_nodes[at].link[static_cast<std::size_t>(side)];
            if (next < 0 || m_nodes[static_cast<std::size_t>(next / 2)].visited) return points;
            at = static_cast<std::size_t>(next / 2);
            side = 1 - next % 2;
            m_nodes[at].visited = true;
            points.push_back(m_nodes[at].u);
        }
    }

    const SphereCurve& m_curve;
    const AllowedDeviation& m_allowed;
    glm::dvec3 m_pole{0.0}, m_first{0.0}, m_second{0.0}, m_at_pole{0.0};
    double m_pole_size = 0, m_equator_size = 0;  ///< the largest of `matrix` on the pole, and on the equator
    double m_skew = 0;  ///< how far the images of pole and equator are from orthogonal
    double m_most_second = 0, m_most_third = 0;  ///< bound the second and third derivatives of f
    double m_middle = 0;
    int m_strips = 0, m_doubtful = 0, m_boxes = 0;
    std::vector<Node> m_nodes;
};

}  // namespace

std::vector<std::vector<glm::dvec3>> loops_of(const SphereCurve& curve, const AllowedDeviation& allowed) {
    return Sweep(curve, allowed).loops();
}

namespace {

/// The root of |v + s w| = 1 at which that rises with s (side 1) or falls (-1); with side 0 the step of
/// Newton's method.
double root_on_side(const glm::dvec3& v, const glm::dvec3& w, int side) {
    const double a = glm::dot(w, w), b = glm::dot(v, w), c = glm::dot(v, v) - 1;
    const double discriminant = b * b - a * c;
    if (side == 0 || !(discriminant > 0)) return -c / (2 * b);
    const double root = side * std::sqrt(discriminant);
    return (b < 0) == (side > 0) ? (root - b) / a : -c / (root + b);
}

}  // namespace

glm::dvec3 point_between(const SphereCurve& curve, const glm::dvec3& p, const glm::dvec3& q, double s) {
    const double length = glm::distance(p, q);
    const glm::dvec3 start = glm::normalize(p + (q - p) * s);
    if (!(length > 0)) return start;
    const glm::dvec3 along = (q - p) / length, across = glm::cross(start, along);
    // The other face of a thin quadric may be nearer to the chord than the curve is: the face is the one on
    // which the quadric rises across the chord as it does at both ends.
    const auto rises_at = [&](const glm::dvec3& u) {
        return glm::dot(curve.matrix * u + curve.offset, curve.matrix * glm::cross(u, along)) > 0;
    };
    const bool rises = rises_at(p);
    const int side = rises != rises_at(q) ? 0 : rises ? 1 : -1;
    // Newton's method across the chord, in the sphere.
    glm::dvec3 u = start;
    double moved = 0;
    for (int k = 0; k < 12; ++k) {
        const double step = root_on_side(curve.matrix * u + curve.offset, curve.matrix * across, side);
        if (!(std::fabs(moved + step) < length)) return start;
        moved += step;
        u = glm::normalize(start + across * moved);
        if (std::fabs(step) < 0x1p-50) break;
    }
    return u;
}

}  // namespace anamorph::figure
