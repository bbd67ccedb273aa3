// SPDX-License-Identifier: Apache-2.0
// A picture warped by a control mesh whose middle vertex was dragged.
#include <anamorph/mesh.h>

#include <iostream>
#include <span>
#include <vector>

using namespace anamorph;

int main() {
    constexpr int kSide = 200;
    std::vector<float> pixels(kSide * kSide), warped(kSide * kSide);
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = float(i % kSide) / kSide;
    const MemorySource source(
        packed_view(std::as_bytes(std::span(pixels)).data(), PixelType::float32, kSide, kSide, 1));
    const auto drawn =
        packed_view(std::as_writable_bytes(std::span(warped)).data(), PixelType::float32, kSide, kSide, 1);

    // 2 x 2 cells. It lies in the target and pulls: its middle shows what the source has at (0.6, 0.5). The text of a
    // file says the same, for parse_warp_file().
    ControlMesh mesh;
    mesh.units = Units::fractions;
    mesh.columns = mesh.rows = 2;
    for (const double y : {0.0, 0.5, 1.0})
        for (const double x : {0.0, 0.5, 1.0}) mesh.vertices.push_back({x, y});
    mesh.vertices[4] = {0.6, 0.5};

    const Picture picture = warped_picture({"dragged", mesh}, {kSide, kSide}, {kSide, kSide}, {.tol = 0.001});
    if (!picture.draw(&source, {0, 0, kSide, kSide}, drawn)) return 1;
    std::cout << "off by at most " << picture.reached().max_error << ", middle "
              << warped[kSide * kSide / 2 + kSide / 2] << "\n";
}
