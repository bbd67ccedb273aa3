// SPDX-License-Identifier: Apache-2.0
// Every pixel of every block of a plan held against the truth.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "anamorph/image/block_reader.h"
#include "anamorph/image/block_sampler.h"
#include "anamorph/plan/block.h"

namespace anamorph::test {

struct Findings {
    double worst_excess = -HUGE_VAL;  ///< largest error less its bound
    double worst_bound = 0;           ///< largest bound of polynomial and computed blocks
    double worst_exact_bound = 0;
    double worst_exact = 0;  ///< error of exact points, over the size of their coordinates
    std::int64_t pixels = 0, exact_pixels = 0, outside_pixels = 0, overlaps = 0;
    std::vector<double> ratios;  ///< bound over largest error, one for each block
};

/// Compares all pixels of a map with `truth(x, y)`, which gives a Point<long double>.
template <class Truth>
Findings examine(const BlockMap& map, const Truth& truth) {
    Findings found;
    std::vector<char> covered(static_cast<std::size_t>(map.width()) * static_cast<std::size_t>(map.height()));
    for (std::int64_t r = 0; r < map.regions(); ++r)
        for (const Block& block : map.blocks(r)) {
            const int width = block.box.width();
            double largest = 0;
            for (int y = block.box.y0; y < block.box.y1; ++y) {
                alignas(64) float px[simd::kRowRoom], py[simd::kRowRoom];
                block_row(map, block, block.box, y, px, py);
                for (int i = 0; i < width; ++i) {
                    char& seen = covered[static_cast<std::size_t>(y) * static_cast<std::size_t>(map.width()) +
                                         static_cast<std::size_t>(block.box.x0 + i)];
                    found.overlaps += seen++;
                    ++found.pixels;
                    if (block.kind == Block::Kind::outside) {
                        ++found.outside_pixels;
                        continue;
                    }
                    const double x = block.box.x0 + i + 0.5;
                    const Point<long double> p = truth(x, y + 0.5);
                    if (block.kind == Block::Kind::exact) {
                        ++found.exact_pixels;
                        Point<double> at{};
                        int piece = 0;
                        if (!map.exact(x, y + 0.5, block.piece, at, piece)) continue;
                        const auto error = static_cast<double>(std::hypot(at.x - p.x, at.y - p.y));
                        found.worst_exact = std::max(found.worst_exact,
                                                     error / static_cast<double>(1 + std::hypot(p.x, p.y)));
                        largest = std::max(largest, error);
                        continue;
                    }
                    largest = std::max(largest,
                                       static_cast<double>(std::hypot(block.base_x + double(px[i]) - p.x,
                                                                      block.base_y + double(py[i]) - p.y)));
                }
            }
            const bool exact = block.kind == Block::Kind::exact;
            double& worst = exact ? found.worst_exact_bound : found.worst_bound;
            worst = std::max(worst, block.bound);
            if (block.kind == Block::Kind::outside) continue;
            // A NaN exceeds too.
            found.worst_excess = std::max(found.worst_excess, largest - block.bound);
            if (!(largest <= block.bound)) found.worst_excess = std::max(found.worst_excess, HUGE_VAL);
            if (largest > 0 && !exact) found.ratios.push_back(block.bound / largest);
        }
    return found;
}

}  // namespace anamorph::test
