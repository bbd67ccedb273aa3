// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/line_overlay.h"

#include <algorithm>
#include <cmath>

namespace anamorph {
namespace {

constexpr std::array<float, 3> kOverlayColors[] = {{1, 0.3f, 0.1f}, {0.1f, 0.55f, 1}, {0.2f, 0.9f, 0.3f}};
constexpr double kHalfWidth = 0.75;  ///< pixels

/// The pixels that a line may cover.
Box reach_of_line(const Point<double>& p, const Point<double>& q, const Box& box) {
    constexpr double kReach = kHalfWidth + 1;
    const auto low = [](double a, double b, int least, int most) {
        return static_cast<int>(std::clamp<double>(std::floor(std::min(a, b) - kReach), least, most));
    };
    const auto high = [](double a, double b, int least, int most) {
        return static_cast<int>(std::clamp<double>(std::ceil(std::max(a, b) + kReach), least, most));
    };
    return {low(p.x, q.x, box.x0, box.x1), low(p.y, q.y, box.y0, box.y1), high(p.x, q.x, box.x0, box.x1),
            high(p.y, q.y, box.y0, box.y1)};
}

/// A line's color on a pixel's, which counts where it is not covered only, be it infinite or no number.
float laid_over(float below, float line, float cover) {
    if (std::isfinite(below)) return below + cover * (line - below);
    return cover == 1 ? line : below;
}

}  // namespace

const std::array<float, 3>& overlay_color(int i) {
    return kOverlayColors[i % 3];
}

void draw_line_over(const Point<double>& from, const Point<double>& to, const std::array<float, 3>& color,
                    const PixelRows& pixels) {
    const Box reach = reach_of_line(from, to, pixels.box);
    const Point<double> e{to.x - from.x, to.y - from.y};
    const double length = std::hypot(e.x, e.y);
    for (int y = reach.y0; y < reach.y1; ++y)
        for (int x = reach.x0; x < reach.x1; ++x) {
            const double dx = x + 0.5 - from.x, dy = y + 0.5 - from.y;
            const double along = (dx * e.x + dy * e.y) / length;
            const double beside = (dy * e.x - dx * e.y) / length;
            // Beyond an end, the distance from that.
            const double beyond = std::max(0.0, std::max(-along, along - length));
            const double distance = std::sqrt(beyond * beyond + beside * beside);
            const auto cover = static_cast<float>(std::clamp(kHalfWidth + 0.5 - distance, 0.0, 1.0));
            if (cover == 0) continue;
            float* p = pixels.at(x, y);
            for (int c = 0; c < pixels.channels; ++c)
                p[c] = laid_over(p[c], c < 3 ? color[static_cast<std::size_t>(c)] : 1, cover);
        }
}

}  // namespace anamorph
