// SPDX-License-Identifier: Apache-2.0
// The numbers that users set of a projector (projector.h, projected_triangles.h).
#pragma once

#include <string>

#include "anamorph/chart/chart.h"
#include "anamorph/geometry/size.h"
#include "anamorph/parameter/number_row.h"

namespace anamorph {

/// The largest error of the texel that a point of the scene is painted with, in texels of the panorama.
inline constexpr NumberRow kProjectionTolRow{"projection_tol", 0.125, 0, 1e6, NumberRow::above_least};
/// The width of the panorama, in texels.
inline constexpr NumberRow kPanoramaWidthRow{"panorama_width", 4096, 1, 1 << 24, NumberRow::closed, true};
inline constexpr NumberRow kPanoramaHeightRow{"panorama_height", 2048, 1, 1 << 24, NumberRow::closed, true};
/// The horizontal field of view of the panorama, or of each of its faces, in degrees; 0: the projection's default.
inline constexpr NumberRow kFieldOfViewRow{"field_of_view", 0, 0, 360};
/// The vertical one, in degrees, where texels are not square; 0: as square ones make it.
inline constexpr NumberRow kVerticalFieldOfViewRow{"vertical_field_of_view", 0, 0, 360};
/// The number d of projections that have one: Pannini's distance, xi of the unified model and the double sphere, beta of the
/// enhanced unified model.
inline constexpr NumberRow kPanniniDistanceRow{"pannini_distance", 1, Chart::kLeastDistance,
                                               Chart::kMostDistance};
/// The number alpha of the double sphere and the enhanced unified model.
inline constexpr NumberRow kProjectionAlphaRow{"projection_alpha", Distance::kSecond, 0, 1};

inline constexpr NumberRow kProjectorRows[] = {
    kProjectionTolRow,       kPanoramaWidthRow,   kPanoramaHeightRow, kFieldOfViewRow,
    kVerticalFieldOfViewRow, kPanniniDistanceRow, kProjectionAlphaRow};

/// A panorama as users of projectors describe it.
struct ThrownChart {
    Projection projection = Projection::equirectangular;
    double fov = kFieldOfViewRow.standard, vfov = kVerticalFieldOfViewRow.standard;
    double d = kPanniniDistanceRow.standard, e = kProjectionAlphaRow.standard;
    std::string lens = {};  ///< as LensModel::parse() reads it; none where it is empty

    bool operator==(const ThrownChart&) const = default;
    /// The chart of such a panorama of so many texels. Throws Error, whose parameters begin with "panorama ".
    Chart of(const Size& size) const {
        kVerticalFieldOfViewRow.check(vfov, "panorama vfov");
        kPanniniDistanceRow.check(d, "panorama d");
        kProjectionAlphaRow.check(e, "panorama e");
        return Chart(projection, size.width, size.height, fov, PixelSpacing::edges, "panorama ", {d, e},
                     lens.empty() ? LensModel{} : LensModel::parse(lens), {.fov = vfov});
    }
};

}  // namespace anamorph
