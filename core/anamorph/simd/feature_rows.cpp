// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/simd/feature_rows.cpp"
#include "anamorph/simd/feature_rows.h"

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
#include "anamorph/map/feature_formula.h"

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
    HWY_INLINE L Distance() const { return distance_to_line(before, behind, beside); }
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
    L nearest(HUGE_VAL);
    for (std::size_t i = 0; i < map.size(); ++i)
        nearest = min(nearest, SeenFrom(map.line(i), x, y).Distance());
    return nearest;
}

template <PowerKind kPower, bool kWeighted>
HWY_INLINE void FeaturePoints(const FeatureMap& map, int shape, double x0, double y0, int count, double* to_x,
                              double* to_y) {
    const L a(map.weights().a), b(map.weights().b), zero(0), y(y0);
    const Point<double> scale = map.scale(shape);
    for (int i = 0; i < count; i += L::kCount) {
        const L x = L(hn::Iota(D(), static_cast<double>(i))) + L(x0);
        const L nearest = kWeighted ? Nearest(map, x, y) + a : zero;
        L weights(0), moved_x(0), moved_y(0);
        for (std::size_t n = 0; n < map.size(); ++n) {
            const FeatureMap::TargetLine& line = map.line(n);
            const SeenFrom seen(line, x, y);
            L weight(line.factor);
            if constexpr (kWeighted) {
                // Where a line is at distance 0 those that are not do not count.
                const L far = seen.Distance() + a;
                const L power = InversePower<kPower>(far / nearest, b) * weight;
                weight = select(zero < nearest, power, select(zero < far, zero, weight));
            }
            weights = weights + weight;
            if (!line.moves) continue;
            const FeatureMap::Displacement& d = map.displacement(n, shape);
            const auto moved = [&](double origin, double along_rate, double beside_rate) HWY_ATTR {
                return displacement_by_line(L(origin), L(along_rate), seen.along, L(beside_rate),
                                            seen.beside);
            };
            moved_x = moved_x + weight * moved(d.origin.x, d.along_rate.x, d.beside_rate.x);
            moved_y = moved_y + weight * moved(d.origin.y, d.along_rate.y, d.beside_rate.y);
        }
        ((x + moved_x / weights) * L(scale.x)).store(to_x + i);
        ((y + moved_y / weights) * L(scale.y)).store(to_y + i);
    }
}

void FeatureRow(const FeatureMap& map, int shape, double x, double y, int count, double* to_x, double* to_y) {
    const double b = map.weights().b;
    if (!(b > 0)) return FeaturePoints<PowerKind::one, false>(map, shape, x, y, count, to_x, to_y);
    if (b == 2) return FeaturePoints<PowerKind::two, true>(map, shape, x, y, count, to_x, to_y);
    if (b == 1) return FeaturePoints<PowerKind::one, true>(map, shape, x, y, count, to_x, to_y);
    if (b == 0.5) return FeaturePoints<PowerKind::half, true>(map, shape, x, y, count, to_x, to_y);
    FeaturePoints<PowerKind::other, true>(map, shape, x, y, count, to_x, to_y);
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(FeatureRow);

void feature_row(const FeatureMap& map, int shape, double x, double y, int count, double* to_x,
                 double* to_y) {
    HWY_DYNAMIC_DISPATCH(FeatureRow)(map, shape, x, y, count, to_x, to_y);
}

}  // namespace anamorph::simd
#endif
