// SPDX-License-Identifier: Apache-2.0
// Pixels in memory as a source, and a coarse level of them.
#include <anamorph/image.h>

#include <iostream>
#include <span>
#include <vector>

using namespace anamorph;

int main() {
    // A view is strided pixels that somebody else owns.
    std::vector<float> pixels(256 * 256);
    for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = float(i % 256) / 255;
    const auto view = packed_view(std::as_bytes(std::span(pixels)).data(), PixelType::float32, 256, 256, 1);

    // Levels are made where and when they are read.
    const MemorySource finest(view);
    const Pyramid pyramid(finest);
    const int last = pyramid.levels() - 1;
    const Size size = pyramid.size(last);
    std::vector<float> texels(std::size_t(size.width) * size.height);
    if (!pyramid.read(last, {0, 0, size.width, size.height}, std::as_writable_bytes(std::span(texels)).data(),
                      std::ptrdiff_t(sizeof(float)) * size.width))
        return 1;
    std::cout << "level " << last << " has " << size.width << "x" << size.height << " texels, the first row";
    for (int x = 0; x < size.width; ++x) std::cout << " " << texels[std::size_t(x)];
    std::cout << "\n";
}
