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

/// How much of a point is a projector's, before shares are divided by their sum; 0 where it throws nothing. `texel` is set
/// where it is not. `fade`: in texels of the panorama, how wide its border fades.
double share_of(const Projector& projector, const glm::dvec3& point, const glm::dvec3& normal, double fade,
                Point<double>& texel);

/// A projector and its picture.
struct ThrownPicture {
    Projector projector;            ///< and the size of its panorama
    const float* pixels = nullptr;  ///< rows from the top, channels beside each other; they have to last
    const Occluders* occluders = nullptr;  ///< about the projector's position; none: nothing is hidden
};

/// A triangle of a mesh with its texture coordinates, u to the right and v up, from 0 to 1.
struct BakedTriangle {
    std::array<glm::dvec3, 3> points;         ///< in the scene
    std::array<glm::dvec2, 3> coordinates{};  ///< of its texture
};

/// How a texture is made.
struct BakeOptions {
    Size size{1024, 1024};  ///< of the texture
    int channels = 3;       ///< of all pictures
    double fade = 32;       ///< texels of a panorama: towards its borders, its share goes down to 0
    /// Texels beyond the border of a triangle that are painted, too, as its plane goes on: for filters that read across it.
    double margin = 1;
    /// Only rows first_row, first_row + row_step and so on are made, for several that share the work; others stay 0.
    int first_row = 0;
    int row_step = 1;  ///< from one of these to the next
};

/// A texture: rows from the top, the channels of the pictures and one of coverage, 0 or 1.
struct BakedTexture {
    std::vector<float> pixels;  ///< colours are not multiplied by coverage; 0 where that is
    std::int64_t painted = 0;   ///< texels
    std::int64_t unseen = 0;    ///< texels of the mesh that no projector throws anything on
};

/// Bakes. The first triangle that a texel lies in has it. The same bits for any `parallel_for`. Throws Error: a size, a number
/// of channels, a fade, a margin or a row out of their range, or no pixels.
BakedTexture bake(const std::vector<BakedTriangle>& mesh, const std::vector<ThrownPicture>& pictures,
                  const BakeOptions& options = {}, const ParallelFor& parallel_for = serial_for);

}  // namespace anamorph
