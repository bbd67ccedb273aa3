// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/morph/feature_rows_lanes.cpp"
#include "anamorph/morph/feature_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"

using D = hn::CappedTag<double, 8>;
using L = Lanes<D>;

HWY_INLINE L root(const L& square) {
    return sqrt(square);
}
#include "anamorph/morph/feature_formula.h"

/// Where points lie as seen from a line.
struct SeenFrom {
    L along, beside, before, behind;

    HWY_INLINE SeenFrom(const FeatureMap::TargetLine& line, const L& x, const L& y) {
        const L dx = x - L(line.p.x), dy = y - L(line.p.y), ux(line.along.x), uy(line.along.y);
        along = along_line(dx, dy, ux, uy);
        beside = beside_line(dx, dy, ux, uy);
        before = -along;
        behind = along - L(line.length);
    }
    HWY_INLINE L Square() const { return square_to_line(before, behind, beside); }
    HWY_INLINE L Distance() const { return root(Square()); }
};

enum class PowerKind { half, one, two, other };

/// c^-b.
template <PowerKind kPower>
HWY_INLINE L InversePower(const L& c, const L& b) {
    if constexpr (kPower == PowerKind::two) return L(1) / (c * c);
    if constexpr (kPower == PowerKind::one) return L(1) / c;
    if constexpr (kPower == PowerKind::half) return L(1) / sqrt(c);
    return exp(-(b * log(c)));
}

/// The least distance of any line from each point.
HWY_INLINE L Nearest(const FeatureMap& map, const L& x, const L& y) {
    // A root that is rounded grows with what it is taken of: the least is that of the least square.
    L square(HUGE_VAL);
    for (std::size_t i = 0; i < map.size(); ++i) square = min(square, SeenFrom(map.line(i), x, y).Square());
    return root(square);
}

template <PowerKind kPower, bool kWeighted, std::size_t kShapes>
HWY_INLINE void FeaturePoints(const FeatureMap& map, const FeatureRow* rows, double x0, double y0,
                              int count) {
    const L a(map.weights().a), b(map.weights().b), zero(0), y(y0), lanes(hn::Iota(D(), 0));
    for (int i = 0; i < count; i += L::kCount) {
        const L x = lanes + L(i) + L(x0);
        const L nearest = kWeighted ? Nearest(map, x, y) + a : zero;
        const L per_nearest = L(1) / max(nearest, L(feature_detail::kLeastUnit));
        L weights(0), moved_x[kShapes], moved_y[kShapes];
        for (std::size_t k = 0; k < kShapes; ++k) moved_x[k] = moved_y[k] = zero;
        for (std::size_t n = 0; n < map.size(); ++n) {
            const FeatureMap::TargetLine& line = map.line(n);
            const SeenFrom seen(line, x, y);
            L weight(line.factor);
            if constexpr (kWeighted) {
                // Where a line is at distance 0 those that are not do not count.
                const L far = seen.Distance() + a;
                const L power = InversePower<kPower>(far * per_nearest, b) * weight;
                weight = select(zero < nearest, power, select(zero < far, zero, weight));
            }
            weights = weights + weight;
            if (!line.moves) continue;
            for (std::size_t k = 0; k < kShapes; ++k) {
                const FeatureMap::Displacement& d = map.displacement(n, rows[k].shape);
                const auto moved = [&](double origin, double along_rate, double beside_rate) HWY_ATTR {
                    return displacement_by_line(L(origin), L(along_rate), seen.along, L(beside_rate),
                                                seen.beside);
                };
                moved_x[k] = moved_x[k] + weight * moved(d.origin.x, d.along_rate.x, d.beside_rate.x);
                moved_y[k] = moved_y[k] + weight * moved(d.origin.y, d.along_rate.y, d.beside_rate.y);
            }
        }
        for (std::size_t k = 0; k < kShapes; ++k) {
            const Point<double> scale = map.scale(rows[k].shape);
            ((x + moved_x[k] / weights) * L(scale.x)).store(rows[k].x + i);
            ((y + moved_y[k] / weights) * L(scale.y)).store(rows[k].y + i);
        }
    }
}

template <std::size_t kShapes>
void RowsOf(const FeatureMap& map, const FeatureRow* rows, double x, double y, int count) {
    const double b = map.weights().b;
    if (!(b > 0)) return FeaturePoints<PowerKind::one, false, kShapes>(map, rows, x, y, count);
    if (b == 2) return FeaturePoints<PowerKind::two, true, kShapes>(map, rows, x, y, count);
    if (b == 1) return FeaturePoints<PowerKind::one, true, kShapes>(map, rows, x, y, count);
    if (b == 0.5) return FeaturePoints<PowerKind::half, true, kShapes>(map, rows, x, y, count);
    FeaturePoints<PowerKind::other, true, kShapes>(map, rows, x, y, count);
}
void FeatureRows(const FeatureMap& map, const FeatureRow* rows, int shapes, double x, double y, int count) {
    for (; shapes > 1; shapes -= 2, rows += 2) RowsOf<2>(map, rows, x, y, count);
    if (shapes > 0) RowsOf<1>(map, rows, x, y, count);
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(FeatureRows);

void feature_rows(const FeatureMap& map, std::span<const FeatureRow> rows, double x, double y, int count) {
    HWY_DYNAMIC_DISPATCH(FeatureRows)(map, rows.data(), static_cast<int>(rows.size()), x, y, count);
}

}  // namespace anamorph::simd
#endif
