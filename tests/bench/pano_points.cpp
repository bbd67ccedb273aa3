// SPDX-License-Identifier: Apache-2.0
#include "pano_points.h"

#include <cmath>

namespace anamorph::bench {
namespace {

std::size_t pixels(const Panorama& map) {
    return static_cast<std::size_t>(map.target().width()) * static_cast<std::size_t>(map.target().height());
}

Point<double>& at(const Panorama& map, Points& points, int i, int j) {
    return points[static_cast<std::size_t>(j) * static_cast<std::size_t>(map.target().width()) +
                  static_cast<std::size_t>(i)];
}

}  // namespace

Points true_points(const Panorama& map, const ParallelFor& parallel_for) {
    Points points(pixels(map), {std::nan(""), std::nan("")});
    for (std::size_t k = 0; k < map.target().pieces().size(); ++k) {
        const Box box = map.target().pieces()[k].box;
        parallel_for(box.height(), [&](std::int64_t row) {
            const int j = box.y0 + static_cast<int>(row);
            for (int i = box.x0; i < box.x1; ++i) {
                Point<DoubleDouble> p{};
                int piece = 0;
                if (map.exact(DoubleDouble(i + 0.5), DoubleDouble(j + 0.5), static_cast<int>(k), p, piece))
                    at(map, points, i, j) = {static_cast<double>(p.x), static_cast<double>(p.y)};
            }
        });
    }
    return points;
}

Points plan_points(const PanoramaPlan& plan, const ParallelFor& parallel_for) {
    Points points(pixels(plan.map()), {std::nan(""), std::nan("")});
    parallel_for(plan.regions(), [&](std::int64_t region) {
        for (const Block& block : plan.blocks(region))
            for_points(plan, block,
                       [&](int i, int j, const Point<double>& p) { at(plan.map(), points, i, j) = p; });
    });
    return points;
}

double distance(const Chart& source, const Point<double>& a, const Point<double>& b) {
    double dx = a.x - b.x;
    if (source.closed()) dx = std::remainder(dx, static_cast<double>(source.period()));
    return std::hypot(dx, a.y - b.y);
}

bool well_inside(const Chart& source, const Point<double>& p) {
    return p.x > 1 && p.y > 1 && p.x < source.width() - 1 && p.y < source.height() - 1;
}

std::vector<float> distances(const Chart& source, const Points& used, const Points& truth) {
    std::vector<float> errors;
    errors.reserve(truth.size());
    for (std::size_t k = 0; k < truth.size(); ++k) {
        const Point<double>& p = truth[k];
        if (!(p.x >= 0 && p.y >= 0 && p.x <= source.width() && p.y <= source.height())) continue;
        const double error = distance(source, used[k], p);
        errors.push_back(std::isnan(error) ? HUGE_VALF : static_cast<float>(error));
    }
    return errors;
}

}  // namespace anamorph::bench
