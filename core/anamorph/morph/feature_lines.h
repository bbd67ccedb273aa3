// SPDX-License-Identifier: Apache-2.0
// Features: lines that correspond to each other in two or more pictures (key shapes), and the pull map that
// they make (Beier and Neely 1992; Kim 2003, eq. 5.9 to 5.11).
//
// Frames. Pixels of each key shape's own picture, x right, y down, the centre of pixel (i, j) at (i + 0.5,
// j + 0.5). A picture of another size than the features were drawn for (Features::frame) is taken to show the
// same, scaled. The map works in the target's pixels: every shape's lines are scaled onto the target, and
// what comes out is scaled back to that shape's picture. With the shapes' weights at one shape, the map to
// that shape is hence exactly the scaling (the identity where the sizes agree).
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

#include "anamorph/chart/chart.h"
#include "anamorph/geometry/size.h"
#include "anamorph/number/jet.h"

namespace anamorph {

/// A directed line from p to q, in pixels.
struct Line {
    Point<double> p, q;
};

/// Feature lines that correspond to each other in the pictures of all key shapes.
class Features {
  public:
    /// A size in pixels.
    struct Frame {
        double width = 0, height = 0;
    };

    /// What was added by one call, as it was given: the two ends of a line, the vertices of a polyline, or the control points of a
    /// curve, for each shape.
    struct Given {
        /// What its points are.
        enum class Kind { line, polyline, curve };
        Kind kind = Kind::line;
        std::vector<std::vector<Point<double>>> points;
        double weight = 1;
        std::string name = {};
    };

    /// Starts without lines. Throws Error when there are fewer than two shapes.
    explicit Features(int shapes = 2);

    int shapes() const { return m_shapes; }
    /// The number of lines.
    std::size_t size() const { return m_weights.size(); }
    /// Line i in the picture of a shape.
    const Line& line(std::size_t i, int shape) const {
        return m_lines[i * static_cast<std::size_t>(m_shapes) + static_cast<std::size_t>(shape)];
    }
    /// The factor of the weight (eq. 5.11) of line i; 1 by default.
    double weight(std::size_t i) const { return m_weights[i]; }
    /// The name of line i in messages: its own or "line 7" (the first is 1).
    std::string name(std::size_t i) const;

    /// All that was added, in its order.
    const std::vector<Given>& given() const { return m_given; }
    /// Adds it again. Throws Error as the functions below do.
    void add(const Given& feature);

    /// Adds a line, given once for each shape. Throws Error, naming the line, where one of them has no length (in the
    /// pixels that it is given in) or is not finite, and where the weight is not finite or below 0.
    void add_line(const std::vector<Line>& line, double weight = 1, const std::string& name = {});
    /// Adds a chain of lines from vertex to vertex, with as many vertices in every shape. Throws Error as add_line() does.
    void add_polyline(const std::vector<std::vector<Point<double>>>& vertices, double weight = 1,
                      const std::string& name = {});
    /// Adds a curve of cubic Bezier segments, with 3 n + 1 control points in every shape. Each segment becomes a chain of
    /// lines between points at equal steps of its parameter, as many as keep every shape's chain within kCurveDeviation of
    /// its curve, at most kMostCurveLines. Throws Error as add_line() does.
    void add_curve(const std::vector<std::vector<Point<double>>>& control_points, double weight = 1,
                   const std::string& name = {});
    static constexpr double kCurveDeviation = 0.25;  ///< pixels
    static constexpr int kMostCurveLines = 64;

    /// Pins the picture's border: its four edges become lines of this weight in every shape; 0: they do not. Throws Error
    /// on a weight that is not finite or below 0.
    void pin_border(double weight);
    double border_weight() const { return m_border; }

    /// The size of the picture for which a shape's lines are given; {0, 0}: any size that the picture has.
    Frame frame(int shape) const { return m_frames[static_cast<std::size_t>(shape)]; }
    /// What its file calls a shape; empty where it does not say.
    const std::string& title(int shape) const { return m_titles[static_cast<std::size_t>(shape)]; }
    /// The name of the picture that a shape was drawn on, as its file says; empty where it does not.
    const std::string& picture(int shape) const { return m_pictures[static_cast<std::size_t>(shape)]; }
    /// Sets title() and picture().
    void set_title(int shape, const std::string& title, const std::string& picture);
    /// The same features with their shapes in another order: of each its number now.
    Features in_order(const std::vector<int>& shapes) const;
    /// Sets frame(). Throws Error unless the size is above 0 and at most 1e9 pixels either way.
    void set_frame(int shape, const Frame& frame);

  private:
    void append_line(const std::vector<Line>& line, double weight, const std::string& name);
    void append_polyline(const std::vector<std::vector<Point<double>>>& vertices, double weight,
                         const std::string& name);

    int m_shapes;
    std::vector<Given> m_given;
    std::vector<Line> m_lines;  ///< line by line, shape by shape
    std::vector<double> m_weights;
    std::vector<std::string> m_names;
    std::vector<Frame> m_frames;
    std::vector<std::string> m_titles, m_pictures;
    double m_border = 0;
};

/// The weights of eq. 5.11 between lines: weight = (length^p / (a + dist))^b.
struct LineWeights {
    static constexpr double kMostA = 1e6, kMostB = 16, kMostP = 16;
    double a = 1, b = 2, p = 0.5;  ///< 0 or more
};

namespace feature_detail {

template <class T>
inline T max(const T& x, const T& y) {
    return constant_part(x) < constant_part(y) ? y : x;
}
template <class T>
inline T root(const T& square) {
    using std::sqrt;
    // The root has a kink on a line, where its derivative is taken to be 0.
    if (constant_part(square) == 0) return T(0);
    return sqrt(square);
}
/// The least distance by which others are divided: its reciprocal is finite, and so are the powers of smaller distances.
inline constexpr double kLeastUnit = 1e-307;

/// The power c^-b of a number that is no jet.
template <class T>
inline T inverse_power_of_constant(const T& c, double b) {
    using std::pow;
    using std::sqrt;
    return b == 2 ? 1 / (c * c) : b == 1 ? 1 / c : b == 0.5 ? 1 / sqrt(c) : pow(c, -b);
}
/// The power x^-b.
template <class T>
inline T inverse_power(const T& x, double b) {
    const auto c = constant_part(x);
    const auto value = inverse_power_of_constant(c, b);
    if constexpr (RealNumber<T>)
        return value;
    else
        return T(value) + (x - c) * (-b * value / c);
}

#include "anamorph/morph/feature_formula.h"

}  // namespace feature_detail

/// The maps from the target to every shape's picture that features make, at one mixture of the shapes. All
/// share the target's lines, hence u, v and the weights.
///
/// Limits. With a = 0 a pixel on a line goes exactly where that line says; on several at once, to the mean of
/// what they say, by their weights at equal distance (what a -> 0 tends to). Far from all lines, and for any
/// b, the weights are taken relative to the nearest line's: none overflows, and those that underflow are 0.
class FeatureMap {
  public:
    /// A line of the target and the numbers of its displacements (feature_formula.h).
    struct TargetLine {
        Point<double> p, along;  ///< its first point, and the unit vector from there to the second one, q
        double length;
        double factor;  ///< weight * length^(p b), relative to the greatest of each
        bool moves;     ///< is it not the same line in every shape?
    };
    /// The displacement by one line for one shape, in the target's pixels: at p, and its rates along and beside the line.
    struct Displacement {
        Point<double> origin, along_rate, beside_rate;
    };
    /// Bounds of the rounding of a line's numbers, which are doubles computed from others.
    struct Rounding {
        double place;    ///< rounding of its ends, in the target's pixels
        double turn;     ///< rounding of its direction, and of the rates of its displacements
        double weight;   ///< rounding of its weight without the distance, relative
        double stretch;  ///< no rounding: the greatest length in a shape over that in the target
        bool exact;      ///< are its ends p and q exact?
        Point<double> q;
    };

    /// `mixture`: the weights of the shapes, with sum 1. Throws Error naming a line that has no length in the target, and
    /// on sizes or weights that are out of range or not as many as the shapes.
    FeatureMap(const Features& features, const std::vector<Size>& pictures, const Size& target,
               const std::vector<double>& mixture, const LineWeights& weights);

    int shapes() const { return m_shapes; }
    Size target() const { return m_target; }
    /// This map with its lines in another order: those that lie together come one after the other (along Morton's curve), so that
    /// what is read of the lines about a place is one stretch of memory; sums round in another order.
    FeatureMap along_curve() const;

    /// The size of a shape's picture.
    Size picture(int shape) const { return m_pictures[static_cast<std::size_t>(shape)]; }
    const LineWeights& weights() const { return m_weights; }
    std::size_t size() const { return m_lines.size(); }
    /// Line i of the target.
    const TargetLine& line(std::size_t i) const { return m_lines[i]; }
    /// The displacement by line i for a shape.
    const Displacement& displacement(std::size_t i, int shape) const {
        return m_displacements[i * static_cast<std::size_t>(m_shapes) + static_cast<std::size_t>(shape)];
    }
    /// Bounds of the rounding of the numbers of line i.
    const Rounding& rounding(std::size_t i) const { return m_roundings[i]; }
    /// Does line i, as the features define it, certainly pass through this point exactly?
    bool passes_through(std::size_t i, double x, double y) const;
    /// Pixels of a shape's picture per pixel of the target.
    Point<double> scale(int shape) const { return m_scales[static_cast<std::size_t>(shape)]; }

    /// The source point in one shape's picture of the target point (x, y).
    template <class T>
    Point<T> operator()(const T& x, const T& y, int shape) const;
    /// Finds the source points in all shapes' pictures of the target point (x, y); `points` has room for one a shape.
    template <class T>
    void all(const T& x, const T& y, Point<T>* points) const;

    /// The position of a point along and beside a line, in pixels of the target.
    template <class T>
    struct Frame {
        T along, beside;
    };
    /// Finds the position of a point along and beside a line.
    template <class T>
    Frame<T> frame(const TargetLine& line, const T& x, const T& y) const {
        const T dx = x - line.p.x, dy = y - line.p.y;
        return {feature_detail::along_line(dx, dy, line.along.x, line.along.y),
                feature_detail::beside_line(dx, dy, line.along.x, line.along.y)};
    }
    /// The sum a + dist of eq. 5.11.
    template <class T>
    T distance(const TargetLine& line, const Frame<T>& at) const {
        return feature_detail::distance_to_line<T>(-at.along, at.along - line.length, at.beside) +
               m_weights.a;
    }

  private:
    class Builder;

    template <class T>
    void sum(const T& x, const T& y, int first, int last, Point<T>* points) const;

    int m_shapes;
    Size m_target;
    std::vector<Size> m_pictures;
    std::vector<Point<double>> m_scales;
    LineWeights m_weights;
    std::vector<TargetLine> m_lines;
    std::vector<Displacement> m_displacements;  ///< line by line, shape by shape
    std::vector<Rounding> m_roundings;          ///< line by line
};

template <class T>
void FeatureMap::sum(const T& x, const T& y, int first, int last, Point<T>* points) const {
    // The nearest line's a + dist, to which weights are relative.
    auto nearest = constant_part(T(std::numeric_limits<double>::infinity()));
    for (const TargetLine& line : m_lines)
        nearest = std::min(nearest, constant_part(distance(line, frame(line, x, y))));

    // Rounded once for all lines, which moves no quotient of weights.
    const T per_nearest(1 / std::max<decltype(nearest)>(nearest, feature_detail::kLeastUnit));

    T weights(0);
    for (int k = first; k < last; ++k) points[k - first] = {T(0), T(0)};
    for (std::size_t i = 0; i < m_lines.size(); ++i) {
        const TargetLine& line = m_lines[i];
        const Frame<T> at = frame(line, x, y);
        const T far = distance(line, at);
        const auto power = [&](const T& of) {
            return feature_detail::inverse_power<T>(of * per_nearest, m_weights.b);
        };
        const T weight = m_weights.b > 0 ? feature_detail::weight_of_line(far, T(nearest), line.factor, power)
                                         : T(line.factor);
        weights = weights + weight;
        if (!line.moves) continue;
        for (int k = first; k < last; ++k) {
            const Displacement& d = displacement(i, k);
            Point<T>& p = points[k - first];
            const auto along = [&](double origin, double along_rate, double beside_rate) {
                return feature_detail::displacement_by_line<T>(T(origin), T(along_rate), at.along,
                                                               T(beside_rate), at.beside);
            };
            p.x = p.x + weight * along(d.origin.x, d.along_rate.x, d.beside_rate.x);
            p.y = p.y + weight * along(d.origin.y, d.along_rate.y, d.beside_rate.y);
        }
    }
    for (int k = first; k < last; ++k) {
        Point<T>& p = points[k - first];
        const Point<double> s = scale(k);
        p = {feature_detail::source_coordinate(x, p.x, weights, s.x),
             feature_detail::source_coordinate(y, p.y, weights, s.y)};
    }
}

template <class T>
Point<T> FeatureMap::operator()(const T& x, const T& y, int shape) const {
    Point<T> point{};
    sum(x, y, shape, shape + 1, &point);
    return point;
}

template <class T>
void FeatureMap::all(const T& x, const T& y, Point<T>* points) const {
    sum(x, y, 0, m_shapes, points);
}

}  // namespace anamorph
