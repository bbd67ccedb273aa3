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

template <class Real>
NearReading Panorama::direct(double x, double y, double half_width, double half_height, const Local& local,
                             Bases& bases) const {
    using R = RestBound<Real>;
    WrittenBase::to = &bases;
    const NearBound<Real> px(WrittenBase::written(x), R(0, half_width, 0)),
        py(WrittenBase::written(y), R(0, half_height, 0));
    const Point<NearBound<Real>> p = (*this)(px, py, local);
    WrittenBase::to = nullptr;
    const auto error = [&](const NearBound<Real>& found) {
        if constexpr (std::is_same_v<Real, double>) {
            // Source pixels: the middle, which may be moved by whole turns, and what is added to it.
            const double farthest = std::fabs(found.base.value) + found.rest.size() + period();
            return found.rest.error + 2 * R::kUnit * farthest;
        } else {
            // The middle counts from the block's base, which is less than a pixel away, a hair aside. The sum is rounded,
            // and once more when the sampler moves it by half a pixel (simd/block_sampler.h).
            const R offset = R::result(0.5, 1.5, 0, R::kUnit) + found.rest;
            return offset.error + R::kUnit * (offset.computed_size() + 1);
        }
    };
    return {{p.x.base.value, p.y.base.value}, std::hypot(error(p.x), error(p.y)) * rounded_detail::kUp};
}

template NearReading Panorama::direct<float>(double, double, double, double, const Local&, Bases&) const;
template NearReading Panorama::direct<double>(double, double, double, double, const Local&, Bases&) const;

}  // namespace anamorph
