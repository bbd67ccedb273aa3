// SPDX-License-Identifier: Apache-2.0
// A mesh that a list of deformations and a formula move, kept from one execution of a filter to the next:
// while the mesh and the settings stay, only what an edit of the list reaches is computed again.
//
// Arrays that were handed out are written again only if nobody else holds them, and copied before otherwise.
#pragma once

#include <glm/vec2.hpp>
#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "anamorph/deform/deformed_surface.h"
#include "anamorph/deform/formula_displacement.h"
#include "anamorph/deform/plane_warp.h"
#include "execution.h"
#include "vtkType.h"

class vtkDataArray;
class vtkPointSet;

namespace anamorph_vtk {

struct DeformSettings {
    bool on_plane = true;
    anamorph::ParameterPlane plane;  ///< where on_plane
    anamorph::DeformOptions options;
    int precision = 0;  ///< as vtkAlgorithm::DesiredOutputPrecision
    bool displacement = true, normals = true;

    bool operator==(const DeformSettings& other) const {
        return on_plane == other.on_plane && plane == other.plane && options.cutoff == other.options.cutoff &&
               options.resolution == other.options.resolution && precision == other.precision &&
               displacement == other.displacement && normals == other.normals;
    }
};

/// A deformed mesh, in the number type of its points.
class DeformedMesh {
  public:
    static constexpr vtkIdType kMostPoints = std::numeric_limits<std::int32_t>::max();

    virtual ~DeformedMesh() = default;

    /// Makes a mesh; null if it has no points. Throws anamorph::Error.
    static std::unique_ptr<DeformedMesh> make(vtkPointSet* mesh, vtkDataArray* coordinates,
                                              const DeformSettings& settings);

    /// Is this what make() would make?
    virtual bool fits(vtkPointSet* mesh, vtkDataArray* coordinates, const DeformSettings& settings) const = 0;
    /// Sets the formula that deform() adds from now on; all points are then written again, unless it is the
    /// one that was added before.
    virtual void set_formula(const std::optional<anamorph::FormulaDisplacement>& formula,
                             const anamorph::ParallelFor& parallel_for) = 0;
    /// The offsets that the formula adds; none where there is no formula.
    virtual const anamorph::FormulaOffsets& offsets() const = 0;
    /// Follows the list and gives `out`, a shallow copy of the mesh, its points and point arrays. Returns how
    /// many points were written. After an exception the object is to be thrown away.
    virtual vtkIdType deform(const std::vector<anamorph::Deformation>& list, vtkPointSet* out,
                             Execution& execution, double progress_begin, double progress_end) = 0;

    /// A point and the determinant of the Jacobian of the map of space p + D(p) there.
    struct Jacobian {
        glm::dvec3 point{0.0};  ///< of the undeformed mesh
        double determinant = std::numeric_limits<double>::infinity();
    };
    /// Gives `out` the array Jacobian, of all points, after deform(), and returns the least, the first of several. Points that are not
    /// moved have 1. Of a plane's parameters; how the sides of bumps change is not counted.
    virtual Jacobian write_jacobians(vtkPointSet* out, const anamorph::ParallelFor& parallel_for) = 0;

    /// The depths and normals of all points; none where the list needs none.
    virtual const anamorph::PointDepths& depths() const = 0;
    /// The parameters of all points; those of points that are not moved are not finite.
    virtual const std::vector<glm::dvec2>& parameters() const = 0;
};

}  // namespace anamorph_vtk
