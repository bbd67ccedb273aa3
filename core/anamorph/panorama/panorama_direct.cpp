// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chart/chart_near.h"
#include "anamorph/panorama/panorama.h"

namespace anamorph {
namespace {

/// The order up to here, with what it has led to.
template <class... Result>
std::uint64_t order_with(const Result&... results) {
    (WrittenBase::next(BaseOperation::output, results.base.number), ...);
    return WrittenBase::to->order.sum();
}

}  // namespace

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
    BaseWriter writer{bases, {}};
    WrittenBase::to = &writer;
    const NearBound<Real> px(WrittenBase::input(x), R(0, half_width, 0)),
        py(WrittenBase::input(y), R(0, half_height, 0));
    // A row's rays and their points are numbered apart, as they are read apart (panorama/direct_rows_lanes.cpp).
    Ray<NearBound<Real>> ray = local_ray(px, py, local);
    const std::uint64_t to_rays = order_with(ray.x, ray.y, ray.z);
    writer.order = {};
    for (NearBound<Real>* part : {&ray.x, &ray.y, &ray.z})
        part->base.number = WrittenBase::next(BaseOperation::input, 0);
    const Point<NearBound<Real>> p = m_source.local_point(ray, local.source);
    const std::uint64_t order = ReadingOrder::joined(to_rays, order_with(p.x, p.y));
    WrittenBase::to = nullptr;
    const auto error = [&](const NearBound<Real>& found) {
        if constexpr (std::is_same_v<Real, double>) {
            // Source pixels: the middle, which may be moved by whole turns, and what is added to it.
            const double farthest = std::fabs(found.base.value) + found.rest.size() + period();
            return found.rest.error + 2 * R::kUnit * farthest;
        } else {
            // The middle counts from the block's base, which is less than a pixel away, a hair aside. The sum is rounded,
            // and once more when the sampler moves it by half a pixel (image/block_sampler.h).
            const R offset = R::result(0.5, 1.5, 0, R::kUnit) + found.rest;
            return offset.error + R::kUnit * (offset.computed_size() + 1);
        }
    };
    return {
        {p.x.base.value, p.y.base.value}, std::hypot(error(p.x), error(p.y)) * rounded_detail::kUp, order};
}

template NearReading Panorama::direct<float>(double, double, double, double, const Local&, Bases&) const;
template NearReading Panorama::direct<double>(double, double, double, double, const Local&, Bases&) const;

}  // namespace anamorph
