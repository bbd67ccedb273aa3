// SPDX-License-Identifier: Apache-2.0
// How much of a body is worth drawing, by its size on the screen.
#pragma once

#include <span>
#include <vector>

#include "anamorph/figure/body/ellipsoid.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/outline/outline_view.h"

namespace anamorph::figure {

/// How a body is drawn, from least to most.
enum class Detail : unsigned char { none, dot, line, ellipse, body };

/// What a body is worth follows from the width of its outline on the screen: a `dot` where it is nowhere
/// wider than `lod`, a `line` (its longest axis) where it is so in one direction, an `ellipse` (a flat
/// outline) up to `body_factor` times `lod` wide, and a whole `body` beyond. `none`: behind the observer.
struct DetailOptions {
    double lod = kLevelOfDetailRow.standard;  ///< pixels; 0: all bodies whole
    double body_factor = 16;
};

/// The details, one for each body. A body that reaches nearer than View::near is drawn whole. Throws Error
/// as outlines does, and when an option is negative or not a number.
std::vector<Detail> levels_of_detail(std::span<const Ellipsoid> bodies, const View& view,
                                     const DetailOptions& options = {});

}  // namespace anamorph::figure
