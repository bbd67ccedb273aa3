// SPDX-License-Identifier: Apache-2.0
// The detail with which a body is worth drawing, by its size on the screen.
#pragma once

#include <span>
#include <vector>

#include "anamorph/figure/body/ellipsoid.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/outline/outline_view.h"

namespace anamorph::figure {

/// How a body is drawn, from least to most.
enum class Detail : unsigned char { none, dot, line, ellipse, body };

/// The limits by which the level of detail of a body follows from the width of its outline on the screen: a `dot` where
/// the outline is nowhere wider than `lod`, a `line` (its longest axis) where that holds in one direction only, an
/// `ellipse` (a flat outline) up to `body_factor` times `lod` wide, and a whole `body` beyond. A body behind the
/// observer is `none`.
struct DetailOptions {
    double lod = kLevelOfDetailRow.standard;  ///< pixels; 0: all bodies whole
    double body_factor = 16;
};

/// Finds the level of detail of each body. A body that extends nearer than View::near is drawn whole. Throws Error as
/// outlines() does, and where an option is negative or not a number.
std::vector<Detail> levels_of_detail(std::span<const Ellipsoid> bodies, const View& view,
                                     const DetailOptions& options = {});

}  // namespace anamorph::figure
