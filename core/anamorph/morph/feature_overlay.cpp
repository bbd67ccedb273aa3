// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/feature_overlay.h"

#include <algorithm>
#include <cmath>

namespace anamorph {
namespace {

constexpr float kColors[][3] = {{1, 0.3f, 0.1f}, {0.1f, 0.55f, 1}, {0.2f, 0.9f, 0.3f}};
constexpr double kHalfWidth = 0.75;  ///< pixels

/// The pixels that a line may cover.
Box reach_of(const Line& line, const Box& box) {
    constexpr double kReach = kHalfWidth + 1;
    const auto low = [](double a, double b, int least) {
        return static_cast<int>(std::max<double>(std::floor(std::min(a, b) - kReach), least));
    };
    const auto high = [](double a, double b, int most) {
        return static_cast<int>(std::min<double>(std::ceil(std::max(a, b) + kReach), most));
    };
    return {low(line.p.x, line.q.x, box.x0), low(line.p.y, line.q.y, box.y0),
            high(line.p.x, line.q.x, box.x1), high(line.p.y, line.q.y, box.y1)};
}

/// A line's color on a pixel's, which counts where it is not covered only, be it infinite or no number.
float laid_over(float below, float line, float cover) {
    if (std::isfinite(below)) return below + cover * (line - below);
    return cover == 1 ? line : below;
}

void draw_line(const Line& line, const float* color, const PixelRows& pixels) {
    const Box reach = reach_of(line, pixels.box);
    const Point<double> e{line.q.x - line.p.x, line.q.y - line.p.y};
    const double length = std::hypot(e.x, e.y);
    for (int y = reach.y0; y < reach.y1; ++y)
        for (int x = reach.x0; x < reach.x1; ++x) {
            const double dx = x + 0.5 - line.p.x, dy = y + 0.5 - line.p.y;
            const double along = (dx * e.x + dy * e.y) / length;
            const double beside = (dy * e.x - dx * e.y) / length;
            const double distance = feature_detail::distance_to_line(-along, along - length, beside);
            const auto cover = static_cast<float>(std::clamp(kHalfWidth + 0.5 - distance, 0.0, 1.0));
            if (cover == 0) continue;
            float* p = pixels.at(x, y);
            for (int c = 0; c < pixels.channels; ++c) p[c] = laid_over(p[c], c < 3 ? color[c] : 1, cover);
        }
}

}  // namespace

void draw_features(const Features& features, const FeatureMap& map, const PixelRows& pixels) {
    const Size target = map.target();
    for (std::size_t i = 0; i < features.size(); ++i)
        for (int k = 0; k < features.shapes(); ++k) {
            const Features::Frame frame = features.frame(k);
            const double sx = target.width / (frame.width > 0 ? frame.width : map.picture(k).width);
            const double sy = target.height / (frame.height > 0 ? frame.height : map.picture(k).height);
            const Line& l = features.line(i, k);
            draw_line({{l.p.x * sx, l.p.y * sy}, {l.q.x * sx, l.q.y * sy}}, kColors[k % 3], pixels);
        }
}

}  // namespace anamorph
