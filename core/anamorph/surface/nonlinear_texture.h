// SPDX-License-Identifier: Apache-2.0
// Pictures on meshes of triangles in space, with texture coordinates that are cubic within each triangle (Kim 2003, section 7.2), cut until
// what a graphics card interpolates linearly holds a tolerance.
//
// Along a side the texture coordinates are the Hermite cubic of their values at its ends and of their slopes there along the side. Triangles
// with a common side have the same there, and slopes at a point fit together in all triangles about it: pictures do not break at sides.
// Within, the cubic has these sides in Bernstein's form, and in the middle the point with which it is quadratic wherever the sides are (Farin
// 1986, "Triangular Bernstein-Bezier patches"):
//     b210 = f(P) + (grad f(P), Q - P) / 3,  and so on,
//     b111 = (b210 + b120 + b021 + b012 + b102 + b201) / 4 - (b300 + b030 + b003) / 6.
// Texture coordinates that are linear in space, with their own slopes, stay so.
//
// A side is cut by a rule that knows its two ends alone, and what is within a triangle by that triangle: meshes fit without cracks, also where
// they are in pieces, where points are doubled, and beside triangles that have no numbers.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/geometry/point.h"
#include "anamorph/geometry/size.h"
#include "anamorph/parallel_for.h"
#include "anamorph/surface/texture_rows.h"

namespace anamorph::surface {

/// The most triangles that a mesh is cut into.
inline constexpr std::int64_t kMostTextureTriangles = std::int64_t{1} << 22;

/// How texture coordinates change in space, by unit of it.
struct TextureSlopes {
    glm::dvec3 u{0.0}, v{0.0};
};

/// A mesh of triangles with texture coordinates at its points, 0 to 1 over the texture. All lists of points have the same length.
struct TexturedMesh {
    std::vector<glm::dvec3> points;
    std::vector<Point<double>> texture;
    std::vector<TextureSlopes> slopes;
    std::vector<std::array<std::int64_t, 3>> triangles;
};

/// The slopes at the points of a mesh, in the plane across the sum of its triangles' normals (by area): those by which the points at the
/// other ends of its sides are missed least, squares weighted by 1 / distance^2. Where these lie on one line it is the slope along that. Points
/// at the same place with the same texture coordinates are one, and points that are no numbers do not count. The slopes at a point have the
/// same bits wherever the triangles about it are in a list.
std::vector<TextureSlopes> fitted_slopes(const TexturedMesh& mesh,
                                         const ParallelFor& parallel_for = serial_for);

/// A point of a mesh that was cut: where it is in the given triangle, in space, and its texture coordinates.
struct TexturedPoint {
    std::int64_t triangle = 0;
    std::array<double, 3> weights{};  ///< of the triangle's corners; they sum to 1, and are exact
    /// Made of corners by taking the middle of two points again and again. On a side it has the same bits for all triangles that have it.
    glm::dvec3 place{0.0};
    Point<double> texture{0, 0};
};

/// A mesh cut into triangles.
struct CutMesh {
    struct Triangle {
        std::array<std::int64_t, 3> points;  ///< first those of the given mesh, then `points`
        std::int64_t triangle;               ///< the given one that it is a part of
    };
    std::vector<TexturedPoint> points;  ///< beyond those of the given mesh
    std::vector<Triangle> triangles;    ///< the parts of a triangle turn as it does, and stand together
    /// The largest bound of the distance of linear interpolation from the cubics, in texels, rounding included.
    double max_error = 0;
    /// Given triangles with a number that is none, or that is beyond double's range. They are cut along sides that others have
    /// too, and have no bound.
    std::int64_t not_finite = 0;
};

/// Cuts the triangles of a mesh. Those without an area are cut along their sides alone. Throws Error where `tol` or the texture's size is
/// out of its row's range, where texture coordinates are so large that rounding exceeds an eighth of `tol`, or where more triangles than
/// `most` would be needed.
CutMesh cut_texture(const TexturedMesh& mesh, const Size& texture, double tol,
                    const ParallelFor& parallel_for = serial_for, std::int64_t most = kMostTextureTriangles);

/// Checks what cut_texture() takes. Throws Error where a number is out of its row's range.
void check_texture(const Size& texture, double tol);

}  // namespace anamorph::surface
