// SPDX-License-Identifier: Apache-2.0
// Tours: panoramas with hot spots that lead from one to another, as in QuickTime VR (Chen 1995), from a JSON file.
//
//   {
//     "panoramas": [
//       {"file": "hall.exr", "options": "from=equirectangular&srcyaw=12", "yaw": 30, "pitch": 0, "fov": 80,
//        "spots": [{"yaw": 95, "pitch": -4, "radius": 6, "target": "garden.exr", "view": {"yaw": 180, "fov": 60}}]},
//       {"file": "garden.exr"}
//     ]
//   }
//
// All but `file`, and a spot's place, radius and target, may be missing. A target is the file of one of the panoramas. Angles
// are in degrees: yaw to the right, pitch up.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace anamorph {

/// The direction of a view, and its width; what is empty stays as it was.
struct TourView {
    std::optional<double> yaw = {}, pitch = {}, fov = {};
};

/// A disc of directions that leads to another panorama.
struct HotSpot {
    double yaw = 0, pitch = 0, radius = 0;
    std::size_t target = 0;  ///< index of a panorama
    TourView view = {};      ///< by default the target's own view
};

struct TourPanorama {
    std::string file, options = {};  ///< options: keys of .pano, key=value&key=value
    TourView view = {};
    std::vector<HotSpot> spots = {};

    /// The spot that a direction is in, of several the one whose centre is nearest; -1: none.
    int spot_at(double yaw, double pitch) const;
};

/// A tour of at least one panorama; the first is where it begins.
using Tour = std::vector<TourPanorama>;

inline constexpr std::size_t kMostTourPanoramas = 4096, kMostHotSpots = 1024;

/// Parses a tour. Throws Error naming the file and the panorama.
Tour parse_tour_json(std::string_view text, std::string_view name);

/// The angle between two directions, in degrees.
double angle_between(double yaw, double pitch, double other_yaw, double other_pitch);

}  // namespace anamorph
