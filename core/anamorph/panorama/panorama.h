// SPDX-License-Identifier: Apache-2.0
// The pull map of a reprojection: from a point of the target image through its ray, the cameras' rotations and
// the source's projection to a point of the source image. Pixels, x right, y down, pixel centres at + 0.5.
#pragma once

#include <array>
#include <glm/mat3x3.hpp>

#include "anamorph/chart/chart_numbers.h"
#include "anamorph/number/near_bound.h"
#include "anamorph/plan/formula_map.h"

namespace anamorph {

/// A camera that stands beside the middle of a world in which all that it sees lies on one plane, 1 away. A direction d of the
/// middle meets that at X = d / (n . d), n being the plane's normal, where n . d > 0, and the camera sees X in the direction
/// X - c, c being its place: in that of (I - c n^T) d. Where n . d is not positive no plane is met, but the map goes on.
struct PlaneTransfer {
    std::array<double, 3> camera{};  ///< c: right, down, forward
    double yaw = 0, pitch = 0;       ///< of n, in degrees: to the right, up

    /// n: right, down, forward.
    glm::dvec3 normal() const;
};

/// The orientation of a camera, in degrees: yaw to the right, pitch up, roll clockwise; the camera is rolled first, then
/// pitched, then turned. With R its rotation, world ray = R * ray of the camera.
struct Orientation {
    double yaw = 0, pitch = 0, roll = 0;
    /// A turn to the right before all others: where a part of a panorama has its middle in the whole one. Of sources alone.
    double ahead = 0;
    /// The axes (right, down, forward) of a face of a cube as columns, which is turned so before all others. Of targets alone.
    glm::dmat3 face{1};
    /// The yaw, pitch and roll by which one lens of a camera of several is turned before all that. Of sources alone.
    std::array<double, 3> lens{};
    /// Where its camera stands, if not in the middle. Of sources alone.
    std::optional<PlaneTransfer> transfer{};
};

/// The rotation R of an orientation, between frames with x right, y down, z forward.
glm::dmat3 rotation(const Orientation& orientation);

/// The pull map between two charts, one turned against the other.
class Panorama {
  public:
    /// `orientation`: that of the target's camera; `held`: that of the source's camera (srcyaw, srcpitch and srcroll in
    /// errors). Throws Error where an angle is not finite, and where a camera lies in its plane.
    Panorama(const Chart& source, const Chart& target, const Orientation& orientation = {},
             const Orientation& held = {});

    const Chart& source() const { return m_source; }
    const Chart& target() const { return m_target; }
    /// The rotation between the rays, by columns, with a transfer before it: source ray = turn * target ray.
    const std::array<std::array<Constant, 3>, 3>& turn() const { return m_turn; }

    /// The branch of the map about one point: a branch of either chart, and the matrix (turn()) between their local rays.
    struct Local {
        Branch target, source;
        glm::dmat3 rotation;
    };
    /// The map about a target point, for its neighbourhood.
    Local local_around(double x, double y, int piece) const;
    /// The map about a target point, with the source's branch about another ray of it.
    Local local_around(double x, double y, int piece, const Ray<double>& source_ray) const;

    // The members that make this a FormulaMap (plan/formula_map.h).
    Size target_size() const { return {m_target.width(), m_target.height()}; }
    Size source_size() const { return {m_source.width(), m_source.height()}; }
    std::vector<Box> target_pieces() const;
    /// The piece of the source that a branch leads to.
    int source_piece(const Local& local) const { return local.source.piece; }
    int period() const { return m_source.closed() ? m_source.period() : 0; }
    /// The number of pixels after which the rows of the target repeat, or 0.
    int target_period() const { return m_target.closed() ? m_target.period() : 0; }
    SourceEdges source_edges() const;
    /// Whether the points of a box have source points on one branch.
    Cover cover(const Interval& x, const Interval& y, int piece, const Local& local, bool across_seam) const;
    /// Whether the points of a box have rays, on one branch of the target.
    Cover target_cover(const Interval& x, const Interval& y, int piece) const;
    /// Whether local rays of the source, of target points that have one, have source points on one branch.
    Cover cover(const Ray<Interval>& ray, const Local& local, bool across_seam) const;

    /// The source's ray of a target point.
    template <class T>
    Ray<T> source_ray(const T& x, const T& y, int piece) const {
        return transform([&](int column, int row) { return m_turn[column][row].template as<T>(); },
                         m_target.ray(x, y, piece));
    }

    /// The source's local ray of a target point.
    template <class T>
    Ray<T> local_ray(const T& x, const T& y, const Local& local) const {
        return transform(local.rotation, m_target.local_ray(x, y, local.target), m_local_error);
    }

    /// The source point of a target point.
    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        return m_source.local_point(local_ray(x, y, local), local.source);
    }

    /// Finds the source point of one target point in double or DoubleDouble, which is what errors are measured against.
    /// False where the target point has no ray, or the source's lens does not see it.
    template <class T>
    bool exact(const T& x, const T& y, int piece, Point<T>& source_point, int& source_piece) const {
        if (!(m_target.inside(x, y, piece) >= 0)) return false;
        return exact(source_ray(x, y, piece), source_point, source_piece);
    }
    /// Finds the source point of one ray of the source. False where the source does not see the ray.
    template <class T>
    bool exact(const Ray<T>& r, Point<T>& source_point, int& source_piece) const {
        source_piece = m_source.piece_of(r);
        if (!m_source.pieces_see_all() && !(seen(r, source_piece) > 0)) return false;
        source_point = m_source.point(r, source_piece);
        return isfinite(source_point.x) && isfinite(source_point.y);
    }

    /// A number that is positive where there is a source point, and changes sign where those end: at the rim of either picture, of a
    /// source of several pieces where the last one of them ends.
    double end(double x, double y, int piece) const;
    Interval end(const Interval& x, const Interval& y, int piece) const;  ///< Encloses it over a box.

    /// Bounds the rounding of exact<Real>, its result kept in double, over a box of target points: the
    /// distance from the truth in source pixels. Around a source with azimuths, points a full turn apart
    /// count as one; on a cube, so do those of one ray on two faces. 0 where no point has a source point;
    /// infinite where it is not certain that there is one.
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int piece, double off = 0) const;
    /// Bounds the rounding of exact<Real> over rays of the source.
    template <class Real>
    double exact_error(const Ray<Rounded<Real>>& ray) const;

    /// Can the map be read by direct()? It cannot where a lens with a tangential part has to be inverted.
    bool may_be_direct() const;
    /// Evaluates the map with Real, float or double, near the middle (x, y) of a block of pixels (number/near.h), whose centres
    /// are up to half_width and half_height away. Bases are appended to `bases`. NearReading::error is infinite or NaN where no
    /// bound is known.
    template <class Real>
    NearReading direct(double x, double y, double half_width, double half_height, const Local& local,
                       Bases& bases) const;

    /// The largest error of an entry of Local::rotation, a product S^T M T of rotations to and from a local frame, against the
    /// product of the exact M and the exact frames about the angles that the branches say.
    ///
    /// S and T are off in four entries, each by Heading::kError, which is h here, as it counts the angle's error too. A column of
    /// such errors meets one of a rotation, of length 1: each frame brings sqrt 2 h at most, and terms of h^2 are next to nothing.
    /// With u = 2^-53: M's entries are rounded by u of each, which meets a column of S and one of T, of length 1: sqrt 3 u at
    /// most, as the squares of M's entries add up to 3; the .07 u that DoubleDouble left meet two entries of each: .14 u. An entry
    /// of S^T M, three products and two sums, is off by 3 u times the product of two lengths, 1, and of such errors three meet a
    /// column of T with two entries: 3 sqrt 2 u. The other product brings 3 u. That is 2 sqrt 2 h + 10 u at most, about half of
    /// what is returned.
    ///
    /// With a transfer M is a rotation times I - c n^T, which makes nothing longer than by 1 + |c|, as |n| = 1: all of these lengths
    /// and errors are as much larger at most.
    static constexpr double kLocalError = 6 * Heading::kError + 64 * 0x1p-53;
    /// That bound for this map.
    double local_error() const { return m_local_error; }

  private:
    Local local_around(const Ray<double>& target_ray, int piece, const Ray<double>& source_ray) const;
    /// Chart::sees() of a ray of the source.
    template <class T>
    T seen(const Ray<T>& r, int piece) const {
        if (m_source.pieces().size() == 1) return m_source.sees(r);
        return m_source.sees(transform(glm::transpose(m_source.branch(piece).axes), r), piece);
    }
    /// Positive where any piece sees the ray.
    template <class T>
    T seen_by_any(const Ray<T>& ray) const;
    /// Is it certain that no piece sees any of these local rays, given that the piece that they are local to does not?
    bool is_unseen(const Ray<Interval>& ray, const Local& local) const;
    /// Are all these local rays seen, except that some may lie beyond the end of the source's lens?
    bool ends_by_lens(const Ray<Interval>& ray, const Local& local) const;

    Chart m_source, m_target;
    double m_local_error = kLocalError;
    /// turn(), and the same in double.
    std::array<std::array<Constant, 3>, 3> m_turn;
    glm::dmat3 m_rotation;
};

}  // namespace anamorph
