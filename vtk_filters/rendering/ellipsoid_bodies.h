// SPDX-License-Identifier: Apache-2.0
// The ellipsoids that points of data stand for, and the numbers that shaders draw them by.
#pragma once

#include <bit>
#include <cstdint>
#include <glm/mat3x3.hpp>
#include <glm/vec3.hpp>
#include <optional>
#include <string>
#include <vector>

#include "block_looks.h"
#include "vtkType.h"

class vtkDataSet;
class vtkUnsignedCharArray;

namespace anamorph_vtk {

/// The arrays of the points that say what shape the bodies have.
struct EllipsoidArrays {
    enum Shape { AXES, TENSOR, COVARIANCE };
    int shape = AXES;
    std::string axes, orientation, tensor;
    double scale = 1;
    std::string texture, offset;  ///< arrays of textures' names or numbers, and of 2 texels
    const std::vector<std::string>* textures = nullptr;  ///< their names; null: the arrays are not read
};

/// The points center + axes s with |s| <= 1.
struct EllipsoidBody {
    glm::dvec3 center{0.0};
    glm::dmat3 axes{0.0}, inverse{0.0};
    bool drawn = false;
    vtkIdType cell = -1;    ///< the cell that the point is in; -1: none
    vtkIdType picked = -1;  ///< what a selection of cells finds: the cell, or the point that is in none
    float color[4] = {1, 1, 1, 1};
    int texture = -1;           ///< number of the texture; -1: none
    double offset[2] = {0, 0};  ///< texels
};

/// The place where a line meets a body.
struct LineHit {
    double t;  ///< 0 to 1 from the line's first point to its last
    vtkIdType body;
};

/// A body for each point of a data set: `first` to `first + count` of all.
struct EllipsoidBlock {
    unsigned int index = 0;  ///< number in composite data, depth first
    vtkIdType first = 0, count = 0;
    BlockLook look;
};

/// A point as the sum of two in single precision.
struct FloatPair {
    float high[3], low[3];

    explicit FloatPair(const glm::dvec3& point) {
        for (int k = 0; k < 3; ++k) {
            const double first = leading_bits(point[k]);
            high[k] = static_cast<float>(first);
            low[k] = static_cast<float>(point[k] - first);
        }
    }

    /// A number's sign, exponent and first 24 bits. (GCC 12 at -O3 wrongly leaves out a conversion to float
    /// and back.)
    static double leading_bits(double number) {
        return std::bit_cast<double>(std::bit_cast<std::uint64_t>(number) & ~((std::uint64_t{1} << 29) - 1));
    }
};

class EllipsoidBodies {
  public:
    std::vector<EllipsoidBody> bodies;
    std::vector<EllipsoidBlock> blocks;
    vtkIdType skipped = 0;  ///< points whose numbers make no body

    /// Adds the points of a block, hidden ones and ghosts as bodies that are not drawn. Throws Error naming an
    /// array that is missing or not as it should be.
    void add(vtkDataSet* data, unsigned int index, const EllipsoidArrays& arrays);
    /// Gives the bodies of a block the colors of their points, or of their cells: `colors`, RGBA.
    void color(const EllipsoidBlock& block, vtkUnsignedCharArray* colors, bool of_cells);
    /// Gives all of a block one color, and its opacity.
    void color(const EllipsoidBlock& block, const double* color);
    bool bounds(double box[6]) const;
    /// The `count` bodies that are longest, in their order; of equally long ones any, spread over all.
    std::vector<std::uint32_t> largest(std::size_t count) const;
    /// The first of a block's bodies that a line enters, or leaves where it begins in it.
    std::optional<LineHit> hit(const EllipsoidBlock& block, const glm::dvec3& from,
                               const glm::dvec3& to) const;

    /// A power of two near the size of all bodies; texels() gives the texels of ellipsoid_shader.h in that
    /// unit.
    double unit() const;
    std::vector<float> texels(double unit) const;
};

}  // namespace anamorph_vtk
