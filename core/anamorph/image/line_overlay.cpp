// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/line_overlay.h"

#include <algorithm>
#include <cmath>

#include "anamorph/number/hypot.h"

namespace anamorph {
namespace {

constexpr std::array<float, 3> kOverlayColors[] = {{1, 0.3f, 0.1f}, {0.1f, 0.55f, 1}, {0.2f, 0.9f, 0.3f}};
constexpr double kHalfWidth = 0.75;  ///< pixels

/// The pixels that points from a corner to another, and a line between them, may cover.
Box reach_of_line(const Point<double>& low, const Point<double>& high, const Box& box) {
    constexpr double kReach = kHalfWidth + 1;
    const auto pixel = [](double at, int least, int most) {
        return static_cast<int>(std::clamp<double>(at, least, most));
    };
    return {
        pixel(std::floor(low.x - kReach), box.x0, box.x1), pixel(std::floor(low.y - kReach), box.y0, box.y1),
        pixel(std::ceil(high.x + kReach), box.x0, box.x1), pixel(std::ceil(high.y + kReach), box.y0, box.y1)};
}

Point<double> least(const Point<double>& p, const Point<double>& q) {
    return {std::min(p.x, q.x), std::min(p.y, q.y)};
}
Point<double> greatest(const Point<double>& p, const Point<double>& q) {
    return {std::max(p.x, q.x), std::max(p.y, q.y)};
}

/// How much of the pixels of a box lies under a chain of lines: of each the most that one of them covers.
struct Cover {
    Box box;
    std::vector<float> values;

    explicit Cover(const Box& of)
        : box(of), values(static_cast<std::size_t>(of.width()) * static_cast<std::size_t>(of.height())) {}
    float& at(int x, int y) {
        return values[static_cast<std::size_t>(y - box.y0) * static_cast<std::size_t>(box.width()) +
                      static_cast<std::size_t>(x - box.x0)];
    }
    void add(const Point<double>& from, const Point<double>& to) {
        const Point<double> e{to.x - from.x, to.y - from.y};
        const double length = hypot(e.x, e.y);
        if (length == 0) return;
        const Box reach = reach_of_line(least(from, to), greatest(from, to), box);
        for (int y = reach.y0; y < reach.y1; ++y)
            for (int x = reach.x0; x < reach.x1; ++x) {
                const double dx = x + 0.5 - from.x, dy = y + 0.5 - from.y;
                const double along = (dx * e.x + dy * e.y) / length;
                const double beside = (dy * e.x - dx * e.y) / length;
                // Beyond an end, the distance from that.
                const double beyond = std::max(0.0, std::max(-along, along - length));
                const double distance = std::sqrt(beyond * beyond + beside * beside);
                at(x, y) =
                    std::max(at(x, y), static_cast<float>(std::clamp(kHalfWidth + 0.5 - distance, 0.0, 1.0)));
            }
    }
};

/// A line's color on a pixel's, which counts where it is not covered only, be it infinite or no number.
float laid_over(float below, float line, float cover) {
    if (std::isfinite(below)) return below + cover * (line - below);
    return cover == 1 ? line : below;
}

}  // namespace

const std::array<float, 3>& overlay_color(int i) {
    return kOverlayColors[i % 3];
}

void draw_line_over(const std::vector<Point<double>>& line, const std::array<float, 3>& color,
                    const PixelRows& pixels) {
    if (line.empty()) return;
    Point<double> low = line[0], high = line[0];
    for (const Point<double>& p : line) low = least(low, p), high = greatest(high, p);
    const Box reach = reach_of_line(low, high, pixels.box);
    if (reach.empty()) return;
    Cover cover(reach);
    for (std::size_t i = 0; i + 1 < line.size(); ++i) cover.add(line[i], line[i + 1]);
    for (int y = reach.y0; y < reach.y1; ++y)
        for (int x = reach.x0; x < reach.x1; ++x) {
            const float covered = cover.at(x, y);
            if (covered == 0) continue;
            float* p = pixels.at(x, y);
            for (int c = 0; c < pixels.channels; ++c)
                p[c] = laid_over(p[c], c < 3 ? color[static_cast<std::size_t>(c)] : 1, covered);
        }
}

}  // namespace anamorph
