// SPDX-License-Identifier: Apache-2.0
// Charts of every projection in the list, as its own entries describe it.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "anamorph/chart/chart.h"

namespace anamorph::test {

/// A chart with faces of n x n pixels, or of 2 n x n pixels.
inline Chart example_chart(Projection projection, int n, PixelSpacing spacing = PixelSpacing::edges,
                           double fov = 0) {
    const FaceGrid faces = faces_of(projection);
    if (faces.columns > 0) return Chart(projection, faces.columns * n, faces.rows * n, fov, spacing);
    return Chart(projection, 2 * n, n, fov, spacing);
}

/// A chart of about that width, in the projection's own shape.
inline Chart chart_of_width(Projection projection, int width, double fov = 0,
                            PixelSpacing spacing = PixelSpacing::edges) {
    const FaceGrid faces = faces_of(projection);
    if (faces.columns > 0)
        return Chart(projection, width / faces.columns * faces.columns, width / faces.columns * faces.rows,
                     fov, spacing);
    const double aspect = natural_aspect(projection, fov == 0 ? Chart::default_fov(projection) : fov);
    return Chart(projection, width, std::max(1, static_cast<int>(width * std::min(aspect, 0.75))), fov,
                 spacing);
}

/// The fields of view that a projection may have, from tiny to the largest.
inline std::vector<double> fovs_of(Projection projection) {
    const FieldOfView limits = fov_of(projection);
    if (limits.fixed) return {limits.standard};
    std::vector<double> fovs;
    for (const double fov : {1e-3, 1.0, 60.0, 120.0, 179.9, 180.0, 240.0, 359.0, 360.0})
        if (fov < limits.most || (fov == limits.most && !limits.open)) fovs.push_back(fov);
    return fovs;
}

}  // namespace anamorph::test
