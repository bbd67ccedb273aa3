// SPDX-License-Identifier: Apache-2.0
// Blend shapes as a file of glTF 2.0: a base with morph targets, which multiple inbetweening (Oka 1987, section 4.2) blends by
// weights, base + sum w_i (S_i - base), and weights over time.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/deform/key_frames.h"

namespace anamorph {

/// What moves: as many in every shape.
struct ShapePoints {
    std::vector<std::array<double, 3>> points;
    std::vector<std::array<double, 3>> normals;  ///< one a point, or none
};

/// A part of a surface, in all shapes.
struct ShapePart {
    std::string name;
    std::vector<ShapePoints> shapes;                        ///< the base first
    std::vector<std::array<double, 2>> texture;             ///< one a point, v up, or none
    std::vector<std::uint32_t> triangles, lines, vertices;  ///< numbers of points, 3, 2 and 1 for each
};

/// A surface with its blend shapes.
struct BlendShapes {
    std::vector<std::string> names;  ///< of the shapes beside the base
    std::vector<ShapePart> parts;    ///< each with a base and as many shapes as there are names
    std::vector<double> weights;     ///< of the shapes beside the base, as long as no animation runs; or none
    std::optional<KeyFrames> keys;   ///< these weights over time, in seconds
    KeyInterpolation interpolation = KeyInterpolation::linear;  ///< that of the keys
};

/// A file's bytes, and those of the second one that a .gltf has beside it.
struct ShapesFile {
    std::string bytes, buffer;
    /// The largest distance of a point of any shape from what the file's floats, base and offset, add up to.
    double max_error = 0;
};

/// The shapes as a .glb; or as a .gltf, if `buffer_name` is not empty: the name of the file beside it. Weights and times are
/// rounded to float. Throws Error, naming the number, where one is not finite or does not fit float, where times are below 0 or
/// the same in float, and where counts differ.
ShapesFile shapes_file(const BlendShapes& shapes, const std::string& buffer_name);

}  // namespace anamorph
