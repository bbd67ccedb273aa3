// SPDX-License-Identifier: Apache-2.0
// Panoramas thrown onto a mesh, blended, and kept in the mesh's own texture.
//
// The centre of every texel of the texture is a point of the mesh: its texture coordinates are linear across a triangle, and
// so is the way back. Every projector's formula is evaluated there in double, without approximation, a ray tells whether the
// point is hidden from it, and its panorama is read bilinearly.
//
// A point takes from each projector in proportion to how close its rays lie there: the cosine of the angle to the surface's
// normal, on either side, over the square of the distance. Towards borders of a panorama the share fades to 0, so that no
// seam shows where one ends.
#pragma once

#include <array>
#include <cstdint>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/parallel_for.h"
#include "anamorph/projector/occluders.h"
#include "anamorph/projector/projector.h"

namespace anamorph {

/// The share of a projector in the colour of a point, before shares are divided by their sum; 0 where the point does not
/// receive its panorama. `texel` is set where the share is not 0. `fade`: the width, in texels of the panorama, over which the
/// share falls to 0 towards its border.
double share_of(const Projector& projector, const glm::dvec3& point, const glm::dvec3& normal, double fade,
                Point<double>& texel);

/// A projector and its picture.
struct ThrownPicture {
    Projector projector;                   ///< the projector, whose panorama has the size of the picture
    const float* pixels = nullptr;         ///< not owned; rows from the top, channels beside each other
    const Occluders* occluders = nullptr;  ///< centred on the projector's position; null: nothing is hidden
};

/// A triangle of a mesh with its texture coordinates, u to the right and v up, from 0 to 1.
struct BakedTriangle {
    std::array<glm::dvec3, 3> points;         ///< in the scene
    std::array<glm::dvec2, 3> coordinates{};  ///< texture coordinates
};

/// How a texture is made.
struct BakeOptions {
    Size size{1024, 1024};  ///< size of the texture
    int channels = 3;       ///< number of channels of every picture
    double fade = 32;       ///< texels of a panorama over which its share falls to 0 towards its borders
    /// The width, in texels, of a margin around a triangle that is painted, too, by its plane: for filters that read across
    /// the border.
    double margin = 1;
    /// The first row that is made, and the step to the next ones, for processes that share the work; other rows stay 0.
    int first_row = 0;
    int row_step = 1;
    /// The rows that the texture holds, from `begin_row` to before `end_row` or the last: a part of it, for processes that need no more.
    int begin_row = 0;
    int end_row = 1 << 30;
};

/// A baked texture: rows from the top, the channels of the pictures and one of coverage, 0 or 1.
struct BakedTexture {
    std::vector<float>
        pixels;  ///< of the rows that it holds: colours, not multiplied by coverage; 0 where coverage is 0
    std::int64_t painted = 0;  ///< texels that are painted
    std::int64_t unseen = 0;   ///< texels of the mesh that no projector throws anything on
};

/// Bakes pictures into the texture of a mesh. A texel belongs to the first triangle that it lies in. The bits are the same for
/// any `parallel_for`. Throws Error where a size, a number of channels, a fade, a margin or a row is out of its range, or
/// where a picture has no pixels.
BakedTexture bake(const std::vector<BakedTriangle>& mesh, const std::vector<ThrownPicture>& pictures,
                  const BakeOptions& options = {}, const ParallelFor& parallel_for = serial_for);

}  // namespace anamorph
