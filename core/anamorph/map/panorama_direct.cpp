// SPDX-License-Identifier: Apache-2.0
#include "anamorph/map/panorama.h"

namespace anamorph {

bool Panorama::may_be_direct() const {
    const Lens *target = m_target.lens(), *source = m_source.lens();
    const auto settles = [](const LensTerms& terms, bool observed) {
        return terms.tangential && terms.to_observed != observed;
    };
    return !(target && settles(target->terms(), false)) && !(source && settles(source->terms(), true));
}

Panorama::Direct Panorama::direct(double x, double y, const Local& local) const {
    Direct found;
    found.bases.reserve(128);
    WrittenBase::to = &found.bases;
    const NearBase px(WrittenBase::written(x), NoRest()), py(WrittenBase::written(y), NoRest());
    const Point<NearBase> p = (*this)(px, py, local);
    WrittenBase::to = nullptr;
    found.middle = {p.x.base.value, p.y.base.value};
    return found;
}

template <class Real>
double Panorama::direct_error(const Interval& x, const Interval& y, double half_width, double half_height,
                              const Local& local) const {
    using R = Rounded<Real>;
    const NearBound<Real> px(x, R(Interval(-half_width, half_width), 0, 0)),
        py(y, R(Interval(-half_height, half_height), 0, 0));
    const Point<NearBound<Real>> p = (*this)(px, py, local);
    const auto error = [&](const NearBound<Real>& found) {
        if constexpr (std::is_same_v<Real, double>) {
            // Source pixels: the middle, which may be moved by whole turns, and what is added to it.
            const double farthest = magnitude(found.base) + magnitude(found.rest.range) + period();
            return found.rest.error + 2 * R::kUnit * farthest;
        } else {
            // The middle counts from the block's base, which is less than a pixel away, a hair aside. The sum is rounded,
            // and once more when the sampler moves it by half a pixel (simd/block_sampler.h).
            const R middle = rounded_detail::result<Real>(Interval(-1, 2), 0, 0, R::kUnit);
            const R offset = middle + found.rest;
            return offset.error + R::kUnit * (offset.computed_size() + 1);
        }
    };
    return std::hypot(error(p.x), error(p.y)) * rounded_detail::kUp;
}

template double Panorama::direct_error<float>(const Interval&, const Interval&, double, double,
                                              const Local&) const;
template double Panorama::direct_error<double>(const Interval&, const Interval&, double, double,
                                               const Local&) const;

}  // namespace anamorph
