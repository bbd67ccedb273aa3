// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/near_far_line.h"

namespace anamorph {

simd::FieldLine seen_from(const FeatureMap& map, std::size_t i, const std::vector<int>& shapes, double x,
                          double y, const double* reference, double unit) {
    const FeatureMap::TargetLine& line = map.line(i);
    const FeatureMap::Frame<double> at = map.frame(line, x, y);
    simd::FieldLine to{};
    const auto split = [](double value, float& most, float& rest) {
        most = static_cast<float>(value);
        rest = static_cast<float>(value - static_cast<double>(most));
    };
    split(-at.along, to.before, to.before_rest);
    split(at.along - line.length, to.behind, to.behind_rest);
    split(at.beside, to.beside, to.beside_rest);
    split(line.along.x, to.along_x, to.along_x_rest);
    split(line.along.y, to.along_y, to.along_y_rest);
    to.factor = static_cast<float>(line.factor * unit);
    for (std::size_t n = 0; n < shapes.size(); ++n) {
        const FeatureMap::Displacement& d = map.displacement(i, shapes[n]);
        const Point<double> scale = map.scale(shapes[n]);
        const auto set = [&](std::size_t c, double origin, double along_rate, double beside_rate, double k) {
            const auto moved = [&](double from, double along, double beside) {
                return k * feature_detail::displacement_by_line(from, along_rate, along, beside_rate, beside);
            };
            to.at[c] = static_cast<float>(moved(origin, at.along, at.beside) - reference[c]);
            // A pixel right is along_x along the line and -along_y beside it, one down along_y and along_x.
            to.right[c] = static_cast<float>(moved(0, line.along.x, -line.along.y));
            to.down[c] = static_cast<float>(moved(0, line.along.y, line.along.x));
        };
        set(2 * n, d.origin.x, d.along_rate.x, d.beside_rate.x, scale.x);
        set(2 * n + 1, d.origin.y, d.along_rate.y, d.beside_rate.y, scale.y);
    }
    return to;
}

}  // namespace anamorph
