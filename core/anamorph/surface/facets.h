// SPDX-License-Identifier: Apache-2.0
// A surface as a camera sees it, cut into triangles that are linear in space: fine enough for a tolerance on the
// screen, and without cracks.
//
// Let f be the surface, M the camera's frame, h and k the sides of a patch, and q = sum l_i q_i a point of a triangle
// whose corners q_i lie in the patch. Taylor's formula about q gives
//     sum l_i f(q_i) - f(q) = sum l_i integral_0^1 (1 - s) f''(q + s (q_i - q)) [q_i - q]^2 ds,
// and sum l_i (q_i - q)_u^2 is a variance of numbers in an interval of length h: at most h^2 / 4. So, axis by axis,
//     e <= (h^2 |f_uu| + 2 h k |f_uv| + k^2 |f_vv|) / 8,                                                           (E)
// with bounds of the derivatives over the patch, turned into the camera's frame. The point is then seen off by at most
//     F (e_x + |X / Z| e_z) / Z' and F (e_y + |Y / Z| e_z) / Z',
// where (X, Y, Z) is f(q) and Z' = Z + e the depth that it is drawn at. It does not matter how a patch is cut into
// triangles: next to smaller patches it is a fan over all their corners, so that neighbours share whole edges.
//
// The depth that is drawn of q is sum l_i f_z(q_i), at most e_z from the surface's own.
//
// Corners are then moved to a grid of 2^-bits pixels. As the weights with which corners make up a point of the screen
// are not negative and their sum is 1, no point moves farther than a corner; each place of the screen then shows another q of the
// triangle, with the depth that belongs to that one.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/geometry/box.h"
#include "anamorph/surface/camera.h"
#include "anamorph/surface/surface_tree.h"

namespace anamorph::surface {

/// A corner on the screen's grid.
struct FacetCorner {
    double x, y;      ///< position in units of the grid, from the middle of the screen: integers
    double weight;    ///< as in Camera::weight
    double nearness;  ///< linear on the screen; greater is nearer
    double u, v;
};

/// The function (b - a) x (p - a) of the edge from a to b at a point p = (x, y) of the grid: positive to one
/// side of it; where x and y are integers, one itself, without rounding.
inline double edge_function(const FacetCorner& a, const FacetCorner& b, double x, double y) {
    return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

/// A triangle of corners.
struct Facet {
    std::uint32_t corner[3];
    std::uint32_t leaf;
};

/// A patch that is drawn.
struct FacetLeaf {
    std::int32_t patch;
    double bound;       ///< bound of the distance on the screen, in pixels; infinite where it is not known
    double by_u, by_v;  ///< the most pixels on the screen per unit of u and of v
    /// The least and the largest depth ahead of the camera that the patch may have.
    double nearest = -HUGE_VAL, farthest = HUGE_VAL;
    double depth_bound =
        HUGE_VAL;  ///< of how far the depth of what is drawn is from that of the same point of the surface
};

/// The part of a surface that a camera sees.
struct Facets {
    int grid_bits = 0;          ///< corners lie on multiples of 2^-bits pixels
    bool inverse_depth = true;  ///< nearness is 1 over the depth; else less the depth
    std::vector<FacetCorner> corners;
    std::vector<Facet> facets;
    std::vector<FacetLeaf> leaves;
};

/// The facets of a view, and room to make them in, used again for other views.
struct FacetRoom {
    /// The corners and sides of a leaf's patch.
    struct Outline {
        std::array<std::int32_t, 4> corners, sides;
    };
    /// Columns and rows of squares of the screen, from the first to the last.
    struct Squares {
        std::uint16_t x0, y0, x1, y1;
    };

    Facets facets;
    // Of cut_into_facets().
    std::vector<std::int32_t> open, hidden, used;
    std::vector<std::uint32_t> numbers, rim;
    std::vector<Outline> outlines;
    std::vector<char> fits;
    // Of FacetRaster.
    std::vector<Box> boxes;
    std::vector<Squares> squares;
    std::vector<std::size_t> first;
    std::vector<std::uint32_t> lists;
};

/// The largest coordinate of a corner: an edge's function, a difference of two products of differences, stays
/// below 2^52, and so do its steps.
inline constexpr double kMostGrid = 0x1p24;
/// The bits of the grid of a screen: so fine that an edge's function of a pixel is an integer that double
/// holds.
int grid_bits_of(const Size& screen);
/// The farthest that the grid moves a point, in pixels.
double grid_error(int bits);

/// The share of a tolerance that is left to points in float (DrapeMap).
inline constexpr double kFloatShare = 1.0 / 64;

/// Thrown where a tolerance takes more patches than are made.
class TooManyPatches final : public Error {
  public:
    TooManyPatches(double tol, std::size_t most, const std::string& rule = "");

    std::size_t most;  ///< the most patches that are made
};

/// Cuts what the camera sees so that every bound, with its share for points in float, is at most `tol` pixels. Throws
/// Error where tol is less than the grid or double allow, TooManyPatches where it takes more patches than twice the pixels
/// over tol (at least 2^16, at most 2^20).
void cut_into_facets(SurfaceTree& tree, const Camera& camera, double tol, FacetRoom& room);
Facets cut_into_facets(SurfaceTree& tree, const Camera& camera, double tol);

}  // namespace anamorph::surface
