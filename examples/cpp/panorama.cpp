// SPDX-License-Identifier: Apache-2.0
// A view out of a panorama in memory.
#include <anamorph/panorama.h>

#include <iostream>
#include <span>
#include <vector>

using namespace anamorph;

int main() {
    std::vector<float> panorama(1024 * 512), view(480 * 360);
    for (std::size_t i = 0; i < panorama.size(); ++i) panorama[i] = float(i % 1024) / 1024;
    const MemorySource source(
        packed_view(std::as_bytes(std::span(panorama)).data(), PixelType::float32, 1024, 512, 1));
    const auto drawn =
        packed_view(std::as_writable_bytes(std::span(view)).data(), PixelType::float32, 480, 360, 1);

    // From where to where, how the camera is turned, and how far a source point may be off, in source pixels.
    const Chart from(Projection::equirectangular, 1024, 512),
        to(Projection::rectilinear, 480, 360, /*fov=*/100);
    const Picture picture = reprojected_picture(Panorama(from, to, {.yaw = 160}), {.tol = 0.001});

    // Any part of it can be drawn, in any order, from any number of threads.
    if (!picture.draw(&source, {0, 0, 480, 360}, drawn)) return 1;
    const Reached reached = picture.reached();
    std::cout << "off by at most " << reached.max_error << ", " << 100 * reached.exact_fraction
              << " % computed exactly, middle " << view[180 * 480 + 240] << "\n";
}
