// SPDX-License-Identifier: Apache-2.0
// A surface in space on which a picture lies (Oka 1987, section 2: f), once continuously differentiable, and twice but
// on curves.
#pragma once

#include <algorithm>
#include <array>
#include <glm/vec3.hpp>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "anamorph/deform/deformation.h"
#include "anamorph/formula/formula_text.h"
#include "anamorph/number/interval.h"
#include "anamorph/number/jet.h"
#include "anamorph/surface/sampled_field.h"
#include "anamorph/surface/shape/shape.h"

namespace anamorph::surface {

/// The position of a point, and its derivatives by u and v.
struct SurfaceFrame {
    glm::dvec3 position, by_u, by_v;
};

/// The Taylor coefficients of x, y and z over a box of (u, v): position, first and second derivatives.
using SurfaceRange = std::array<Jet<Interval, 2>, 3>;

/// A surface as a function of (u, v). Thread safe.
class DrapedSurface {
  public:
    virtual ~DrapedSurface() = default;
    virtual glm::dvec3 position(double u, double v) const noexcept = 0;
    /// Finds the points of a grid, row by row, (u[i], v[j]): as far from the exact ones as those of
    /// position() may be. A point has the same bits in every grid, but not those of position().
    virtual void positions(std::span<const double> u, std::span<const double> v, glm::dvec3* to) const {
        for (const double t : v)
            for (const double s : u) *to++ = position(s, t);
    }
    /// The largest distance of position() from the exact point, coordinate by coordinate.
    virtual double rounding(double u, double v) const noexcept = 0;
    /// The largest rounding() at any point of a box. It grows with the magnitudes that a formula meets, which
    /// are largest at corners; of text, whose numbers may be largest anywhere, all points are asked. Infinite
    /// where that is not known.
    virtual double rounding(const Interval& u, const Interval& v) const noexcept {
        double most = rounding(u.lo / 2 + u.hi / 2, v.lo / 2 + v.hi / 2);
        for (const double s : {u.lo, u.hi})
            for (const double t : {v.lo, v.hi}) most = std::max(most, rounding(s, t));
        return most;
    }
    virtual SurfaceFrame frame(double u, double v) const noexcept = 0;
    /// The position as exactly as it is known: errors are measured against it.
    virtual std::array<DoubleDouble, 3> truth(DoubleDouble u, DoubleDouble v) const noexcept = 0;
    /// Encloses the Taylor coefficients at every point of the box that is not missing; those of the second degree wherever
    /// they exist. Derivatives may be infinite, and say nothing then.
    virtual SurfaceRange range(const Interval& u, const Interval& v) const noexcept = 0;
    /// Is there no surface over a box (SampledField::missing)?
    virtual Certainty missing(const Interval& u, const Interval& v) const noexcept = 0;
};

/// The names of surfaces, in the order of surface/shape/list.h.
const std::vector<std::string>& surface_names();
/// The names of surfaces, and those that only sums have: `positions` and `formula`.
const std::vector<std::string>& all_surface_names();
/// Does a surface have normals that are once continuously differentiable, along which a relief can be raised?
bool has_smooth_normals(std::size_t which);

/// A surface as a sum of others (Oka 1987, eq. 4.3), each raised along its own normal, moved by deformations (eq. 4.1).
struct SurfaceSum {
    struct Part {
        std::size_t which = 0;  ///< place in surface_names(); after the last `positions`, and then `formula`
        double weight = 1;
        std::shared_ptr<const SampledField> positions = {};  ///< of `positions`, where they are not the sum's
        bool operator==(const Part&) const = default;
    };
    std::vector<Part> parts = {{}};
    SurfaceShape shape = {};
    std::shared_ptr<const SampledField> positions = {};  ///< x, y and z
    std::optional<SpaceFormula> formula = {};
    std::shared_ptr<const SampledField> heights = {};  ///< heights of parts that has_smooth_normals() allows
    double height_scale = 0;                           ///< scale of the heights of parts of weight 1
    /// Their u and v run from 0 to 1 with v up, and their depth is z before they move it. Their sides go by the mean of the parts'
    /// normals before reliefs, by the magnitudes of weights.
    std::vector<Deformation> deformations = {};

    bool operator==(const SurfaceSum&) const = default;
};

/// Makes a sum of surfaces. Throws Error on a deformation that check_deformation refuses, and on one with a side where not all parts
/// has_smooth_normals() allows.
std::shared_ptr<const DrapedSurface> make_surface(const SurfaceSum& sum);

/// Makes a single surface, with deformations.
std::shared_ptr<const DrapedSurface> make_surface(std::size_t which, const SurfaceShape& shape,
                                                  const std::vector<Deformation>& deformations = {});

}  // namespace anamorph::surface
