// SPDX-License-Identifier: Apache-2.0
// Halfway from one picture to another, along a line that both have.
#include <anamorph/morph.h>

#include <iostream>
#include <memory>
#include <span>
#include <vector>

using namespace anamorph;

int main() {
    constexpr int kSide = 128;
    const std::vector<float> black(kSide * kSide, 0), white(kSide * kSide, 1);
    std::vector<float> pixels(kSide * kSide);
    const auto source_of = [](const std::vector<float>& image) {
        return MemorySource(
            packed_view(std::as_bytes(std::span(image)).data(), PixelType::float32, kSide, kSide, 1));
    };
    const MemorySource a = source_of(black), b = source_of(white);
    const auto drawn =
        packed_view(std::as_writable_bytes(std::span(pixels)).data(), PixelType::float32, kSide, kSide, 1);

    // The same line in either picture, from p to q. parse_features_file() reads them from text.
    auto features = std::make_shared<Features>(2);
    features->add_line({{{40, 30}, {90, 35}}, {{30, 60}, {100, 50}}});

    const Picture picture = morphed_picture(features, {{kSide, kSide}, {kSide, kSide}}, {kSide, kSide},
                                            {.tol = 0.001, .t = 0.25});
    if (!picture.draw({&a, &b}, {0, 0, kSide, kSide}, drawn)) return 1;
    std::cout << "off by at most " << picture.reached().max_error << ", middle "
              << pixels[kSide * kSide / 2 + kSide / 2] << "\n";
}
