// SPDX-License-Identifier: Apache-2.0
// Projects of Hugin (.pto): a panorama, and the images that it is made of. A row is a letter and values, each behind its name:
//
//   p f2 w4000 h2000 v360 E12.5 S0,4000,200,1800 n"TIFF_m c:LZW"
//   i w3000 h2000 f0 v65.5 a0 b-0.01 c0 d3 e-2 y10 p0 r0 Eev12.5 n"first.jpg"
//   i w3000 h2000 f0 v=0 a=0 b=0 c=0 d=0 e=0 y50 p1 r0.3 Eev12.5 S20,2980,10,1990 n"second.jpg"
//   k i0 t0 p"10 20 300 20 300 400"
//
// A value =0 is that of image 0. Of the panorama (p) are read f, P (of f19), w, h, v and S; of images (i) w, h, f, v, a to e, g, t, y, p, r, TrX
// to TrZ, Tpy, Tpp, S and n; of masks (k) those that cut a part of their own image out (t0). Control points, what is to be
// optimized, output formats and comments mean nothing here. What else an image has, such as tilt (TiX), has to be 0. Exposure, white
// balance, vignetting and response curves are not geometry: they are named, and not applied.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/chart/chart.h"
#include "anamorph/geometry/box.h"
#include "anamorph/geometry/point.h"
#include "anamorph/geometry/size.h"
#include "anamorph/panorama/panorama.h"

namespace anamorph {

/// An image of a project. Pixels, x right, y down, from the upper left corner; angles in degrees.
struct HuginImage {
    std::string file;  ///< as the project names it
    Size size;
    Projection projection = Projection::rectilinear;
    double fov = 0;                   ///< horizontal field of view of the whole image
    std::array<double, 7> lens = {};  ///< a, b, c, g, t, d and e, as ptlens has them
    double yaw = 0, pitch = 0, roll = 0;
    std::optional<PlaneTransfer> transfer = {};  ///< of a camera that stands beside the panorama's
    std::optional<Box> crop = {};                ///< the part that is drawn; it may reach beyond the image
    bool is_round = false;                       ///< of the crop the circle in its middle alone
    std::vector<std::vector<Point<double>>> masks = {};  ///< polygons that are cut out
    /// The first thing that it has and that is not drawn, "row 3: g5: must be 0 (shear)"; empty where all is.
    std::string refused = {};

    /// Throws Error "FILE: row 3: ..." where something is refused. `project`: name of its file.
    void check(std::string_view project) const;
};

/// The panorama that a project asks for.
struct HuginPanorama {
    Projection projection = Projection::equirectangular;
    Size size;
    double fov = 360;
    std::optional<double> d = {};  ///< of pannini, its distance
    std::optional<Box> crop = {};  ///< the part of `size` that is drawn, inside of it
    std::string refused = {};      ///< as HuginImage has it

    void check(std::string_view project) const;
};

struct HuginProject {
    std::optional<HuginPanorama> panorama = {};
    std::vector<HuginImage> images;  ///< at least one
    /// Names of the photometric values that would change colours: "Eev, Vb"; empty where none would.
    std::string not_applied = {};
};

inline constexpr std::size_t kMostHuginImages = 1024, kMostHuginMasks = 4096, kMostHuginCorners = 4096;

/// Parses a project. Throws Error naming the file, the row, the value and what is allowed.
HuginProject parse_hugin_project(std::string_view text, std::string_view name);

}  // namespace anamorph
