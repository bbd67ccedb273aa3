// SPDX-License-Identifier: Apache-2.0
// The operation pano: a panorama seen through another lens.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "anamorph/machine/bump_unit.h"
#include "anamorph/operation/operation.h"
#include "anamorph/panorama/reproject.h"

namespace anamorph {

const Operation& pano_operation();

/// The source of a panorama.
struct TakenSource {
    Chart chart;
    std::string
        reason;  ///< why it is taken for this: "given", "assumed from the 2:1 shape", "given, 90 degrees assumed" ...
    double ahead = 0;  ///< Orientation::ahead of a part of a panorama

    /// The source and the reason as an attribute of the picture.
    Attribute says() const;
};

/// A reprojection as asked for.
struct ReprojectRequest {
    TakenSource source;
    Chart target;
    Orientation orientation;  ///< orientation of the picture's camera
    Orientation held;         ///< orientation of the source's camera
    ReprojectOptions options;
    /// The unit that draws the picture with scheme hardware, in place of options.scheme and tol.
    std::optional<machine::BumpUnit> machine = {};

    Panorama map() const { return Panorama(source.chart, target, orientation, held); }
};

/// Reads a request from a table's values. Throws Error; it names `from` when the source does not say what it
/// is.
///
/// Without `from`: what the image says, else 2:1 is equirectangular and 1:6 a cubemap. Without `srcfov`: what
/// the image says, where that is of the same projection, else, of a rectilinear one, what follows from its camera's
/// focal length, else the projection's default; so too, but for the focal length, `srclens`.
/// Without `size`: the source's pixels per degree at the centre of both, at most kMaxDefaultSize either way.
/// With one number, the width; the height is then the projection's own: half the width for a full
/// equirectangular image, 90 degrees for a cylindrical one, square faces for cubes, else the width.
ReprojectRequest read_reproject_request(const ParameterValues& values, const SourceFacts& source);
inline constexpr int kMaxDefaultSize = 16384;

/// Read parts of a request, for tables with some of its rows: the source, how it was held, the picture (to,
/// fov, d, lens, size), its overscan, where its camera looks (yaw, pitch, roll), and all options (tol, filter, wrap,
/// output) but the scheme. Throw Error.
TakenSource read_source(const ParameterValues& values, const SourceFacts& source);
Orientation read_held(const ParameterValues& values, const SourceFacts& facts, const TakenSource& source);
Chart read_target_chart(const ParameterValues& values, const Chart& source);
Size read_overscan(const ParameterValues& values, const Chart& target);
Orientation read_orientation(const ParameterValues& values);
/// What the picture shows and how its camera is turned: that of `to`, or one face of it alone where `face` is given.
struct TargetView {
    Chart chart;
    Orientation look;
};
TargetView read_target_view(const ParameterValues& values, const Chart& source);
ReprojectOptions read_reproject_options(const ParameterValues& values, const SourceFacts& source);

/// The picture of a request, at all its levels.
std::unique_ptr<const Pictures> reprojected_pictures(const ReprojectRequest& request);

/// The next level of a picture's pyramid: half the pixels each way (rounded down, at least 1), the same view;
/// none after the last.
std::optional<Chart> half_size(const Chart& chart);

/// A picture at one of its levels: its chart there, and what is known of it before it is solved.
struct PanoramaLevel {
    Chart target;
    PictureRequest request;  ///< its size, windows, alpha, kind of pixels, and the attributes of its chart
};
/// A level of a picture whose level 0 shows `target`; none past the last. One with overscan has no coarser levels, on which its windows
/// would not lie on pixels.
std::optional<PanoramaLevel> panorama_level(const Chart& target, const ReprojectOptions& options,
                                            PixelKind pixels, int level);

}  // namespace anamorph
