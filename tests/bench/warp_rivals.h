// SPDX-License-Identifier: Apache-2.0
// What a mesh warp can be drawn with instead: VTK's image reslice through a cubic grid transform,
// OpenImageIO's st_warp and OpenCV's remap, the last two given the finished map. Each only where it was
// found; all draw three channels.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/image/view.h"
#include "anamorph/mesh/mesh.h"

namespace anamorph::bench {

/// A way to draw, and the source point that it uses for a pixel, if it uses one.
struct Rival {
    std::string scheme;
    std::function<void()> draw;
    std::function<Point<double>(int x, int y)> point;
};

/// The pictures that the rivals read and write. `map` holds the source points of all pixels, row by row.
struct RivalTask {
    const Mesh* mesh;
    const std::vector<Point<double>>* map;
    ConstImageView source;
    ImageView picture;
    int threads;
};

/// The rivals that are installed.
std::vector<Rival> warp_rivals(const RivalTask& task);

}  // namespace anamorph::bench
