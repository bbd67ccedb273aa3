// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/surface_cost.h"

#include "anamorph/surface/shape/all.h"

namespace anamorph::machine {
namespace {

using surface::SurfaceShape;
using surface::SurfaceSum;

/// Numbers of a point in space, and of a surface beside its bumps (SurfaceShape).
constexpr int kCoordinates = 3, kShapeNumbers = 9;
/// Numbers of a bump: V, c and a of (4.1).
constexpr int kBumpNumbers = 7;
/// Products of a mean of four values: by twos, along one side and then along the other.
constexpr int kMeanOfFour = 3;

template <class Formula>
concept HasNormal = requires(const Formula& formula, const Counted& u) {
    formula.normal(u, u);
};

template <class Formula>
OperationCounts counts_of(const SurfaceShape& shape, bool raised) {
    OperationCounts counts;
    const Formula formula(shape);
    const Counted u(counts), v(counts);
    formula.point(u, v);
    if constexpr (HasNormal<Formula>)
        if (raised) formula.normal(u, v);
    return counts;
}

OperationCounts counts_of(const FormulaProgram& program) {
    OperationCounts counts;
    for (const ProgramStep& step : program.steps) switch (step.kind) {
            case StepKind::product:
            case StepKind::times_number:
            case StepKind::times_constant:
            case StepKind::square:
                ++counts.products;
                break;
            case StepKind::quotient:
                ++counts.divisions;
                break;
            case StepKind::sine_and_cosine:
                counts.functions += 2;
                break;
            case StepKind::sqrt:
            case StepKind::angle:
            case StepKind::exp:
            case StepKind::log:
            case StepKind::asinh:
                ++counts.functions;
                break;
            default:
                break;
        }
    return counts;
}

/// A bump moves a point by V F (4.1): the kernel, and a product for each coordinate.
OperationCounts counts_of(const Deformation& bump) {
    OperationCounts counts;
    const Counted number(counts);
    if (bump.is_plain())
        influence(bump, number, number);
    else
        influence(bump, number, number, number, number);
    counts.products += kCoordinates;
    return counts;
}

SurfaceCost cost_of_part(const SurfaceSum& sum, const SurfaceSum::Part& part) {
    using Count = OperationCounts (*)(const SurfaceShape&, bool);
    static constexpr Count kCounts[] = {
#define ANAMORPH_SURFACE(name, Type) counts_of<surface::shapes::Type>,
#include "anamorph/surface/shape/list.h"
#undef ANAMORPH_SURFACE
    };
    const std::size_t shapes = std::size(kCounts);
    if (part.which == shapes) return {{kCoordinates * kMeanOfFour + 2, 0, 0}, 0};
    if (part.which > shapes)
        return {counts_of(sum.formula->point), static_cast<int>(sum.formula->point.numbers.size())};
    const bool raised = sum.heights && surface::has_smooth_normals(part.which);
    SurfaceCost cost{kCounts[part.which](sum.shape, raised), kShapeNumbers};
    // The height, by its scale, along the normal.
    if (raised) cost.point += {kMeanOfFour + 2 + 1 + kCoordinates, 0, 0};
    return cost;
}

}  // namespace

SurfaceCost cost_of(const SurfaceSum& sum) {
    SurfaceCost cost;
    const bool weighted = sum.parts.size() > 1 || (sum.parts.size() == 1 && sum.parts[0].weight != 1);
    for (const SurfaceSum::Part& part : sum.parts) {
        const SurfaceCost of_part = cost_of_part(sum, part);
        cost.point += of_part.point;
        cost.numbers += of_part.numbers;
        // Eq. 4.3.
        if (weighted) cost.point += {kCoordinates, 0, 0};
        if (weighted) ++cost.numbers;
    }
    for (const Deformation& bump : sum.deformations) {
        if (!bump.enabled) continue;
        cost.point += counts_of(bump);
        cost.numbers += kBumpNumbers;
    }
    return cost;
}

}  // namespace anamorph::machine
