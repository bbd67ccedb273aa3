// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chart/chart_near.h"
#include "anamorph/number/hypot.h"
#include "anamorph/panorama/panorama.h"
#include "anamorph/plan/near_pixels.h"

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
    BaseWriter writer{bases, {}};
    WrittenBase::to = &writer;
    const Point<NearBound<Real>> pixels = pixels_near<Real>(x, y, half_width, half_height);
    // A row's rays and their points are numbered apart, as they are read apart (panorama/direct_rows_lanes.cpp).
    Ray<NearBound<Real>> ray = local_ray(pixels.x, pixels.y, local);
    const std::uint64_t to_rays = order_with(ray.x, ray.y, ray.z);
    writer.order = {};
    for (NearBound<Real>* part : {&ray.x, &ray.y, &ray.z})
        part->base.number = WrittenBase::next(BaseOperation::input, 0);
    const Point<NearBound<Real>> p = m_source.local_point(ray, local.source);
    const std::uint64_t order = ReadingOrder::joined(to_rays, order_with(p.x, p.y));
    WrittenBase::to = nullptr;
    const double period_x = period();
    return {{p.x.base.value, p.y.base.value},
            hypot(drawn_error(p.x, period_x), drawn_error(p.y, period_x)) * rounded_detail::kUp,
            order};
}

template NearReading Panorama::direct<float>(double, double, double, double, const Local&, Bases&) const;
template NearReading Panorama::direct<double>(double, double, double, double, const Local&, Bases&) const;

}  // namespace anamorph
