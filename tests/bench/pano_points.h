// SPDX-License-Identifier: Apache-2.0
// The points of the source where the pixels of a view are read: by the exact map in long double, and by a
// plan's blocks.
#pragma once

#include <vector>

#include "anamorph/image/block_reader.h"
#include "anamorph/panorama/panorama.h"
#include "anamorph/panorama/panorama_plan.h"
#include "anamorph/parallel_for.h"

namespace anamorph::bench {

/// Source points, one a pixel, row by row; NaN where there is none.
using Points = std::vector<Point<double>>;

/// The points that Panorama::exact finds with long double.
Points true_points(const Panorama& map, const ParallelFor& parallel_for);

/// Calls `body(i, j, point)` for the pixels of a block. Polynomials are evaluated here as block.h states
/// them, in plain float arithmetic, apart from the product's own loops, those in double and direct ones by the plan; exact
/// pixels by Panorama::exact<double>.
template <class Body>
void for_points(const PanoramaPlan& plan, const Block& block, const Body& body) {
    const Panorama& map = plan.map();
    const Box& box = block.box;
    const bool bicubic = block.kind == Block::Kind::bicubic;
    const BlockPolynomial polynomial = bicubic && !block.precise ? plan.bicubic(block) : quadratic_of(block);
    PointsInDouble row;
    const bool precise = block.precise && block.kind != Block::Kind::exact;
    const bool direct = block.kind == Block::Kind::computed;
    const auto room = static_cast<std::size_t>(box.width()) + 16;
    std::vector<float> x(room), y(room);
    // s and t run from -1 to 1 over the pixel centres; a single one stands at 0.
    const auto along = [](int k, int count) {
        return count > 1 ? static_cast<float>(2 * k - (count - 1)) / static_cast<float>(count - 1) : 0.0f;
    };
    const auto value = [&](int first, float s, float t) {
        float sum = 0;
        for (int i = polynomial.degree; i >= 0; --i) {
            float of_s = 0;
            for (int j = polynomial.degree; j >= 0; --j) of_s = of_s * t + polynomial.c[j][first + i];
            sum = sum * s + of_s;
        }
        return sum;
    };
    for (int j = box.y0; j < box.y1; ++j) {
        if (precise)
            row.read(plan, block, j - box.y0, j - box.y0 + 1);
        else if (direct)
            plan.computed_row(block, j - box.y0, 0, box.width(), x.data(), y.data());
        for (int i = box.x0; i < box.x1; ++i) {
            Point<double> p{std::nan(""), std::nan("")};
            if (precise) {
                p = row.at(i - box.x0, 0);
            } else if (direct) {
                const auto k = static_cast<std::size_t>(i - box.x0);
                p = {block.base_x + double{x[k]}, block.base_y + double{y[k]}};
            } else if (block.kind == Block::Kind::polynomial || bicubic) {
                const float s = along(i - box.x0, box.width()), t = along(j - box.y0, box.height());
                p = {block.base_x + static_cast<double>(value(0, s, t)),
                     block.base_y + static_cast<double>(value(4, s, t))};
            } else if (block.kind == Block::Kind::exact) {
                int piece = 0;
                Point<double> q{};
                if (map.exact(i + 0.5, j + 0.5, block.piece, q, piece)) p = q;
            }
            body(i, j, p);
        }
    }
}

/// The points that a plan leads the pixels to.
Points plan_points(const PanoramaPlan& plan, const ParallelFor& parallel_for);

/// The distance of two source points; a turn apart is the same where the source closes on itself.
double distance(const Chart& source, const Point<double>& a, const Point<double>& b);

/// Does a bilinear filter at this point read texels of the source image only?
bool well_inside(const Chart& source, const Point<double>& p);

/// The distances for all pixels whose true point lies in the source image. A pixel that has a true point
/// there but none in `used` counts as infinite.
std::vector<float> distances(const Chart& source, const Points& used, const Points& truth);

}  // namespace anamorph::bench
