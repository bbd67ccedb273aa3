// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/panorama/direct_rows_lanes.cpp"
#include "anamorph/panorama/direct_rows.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <vector>

#include "anamorph/number/next_base.h"
#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"
// In one function each the formulas are fast, and take long to compile: with sanitizers minutes, and single numbers read them mostly to learn
// their order.
#undef ANAMORPH_FLATTEN
#if defined(ANAMORPH_SANITIZED) || ANAMORPH_LANES_CALLED
#define ANAMORPH_INLINE inline
#define ANAMORPH_FLATTEN
#else
#define ANAMORPH_INLINE HWY_INLINE
#define ANAMORPH_FLATTEN HWY_FLATTEN
#endif
#include "anamorph/number/near.h"
#undef ANAMORPH_INLINE

// The formulas once more, for this instruction set.
namespace formulas {
template <class Number>
HWY_INLINE bool somewhere(const Number&) {
    return true;
}
#include "anamorph/chart/chart_plane.h"
#include "anamorph/chart/lens_formula.h"
#include "anamorph/chart/projection/list.h"
}  // namespace formulas

template <class Real>
using D = hn::CappedTag<Real, Block::kMaxSide>;
template <class Real>
using L = Lanes<D<Real>>;

#include "anamorph/number/read_bases.h"

template <class Real, class Order>
using N = Near<ReadBase<Real, Order>, L<Real>>;

/// shrink() as in chart/lens.h, read from its bases.
template <class Real, class Order>
HWY_INLINE N<Real, Order> shrink(const LensTerms&, const N<Real, Order>& value) {
    ReadBase<Real, Order> bases[ComputedSeries::kDegree + 1];
    for (int k = ComputedSeries::kDegree; k >= 0; --k)
        bases[k] = ReadBase<Real, Order>::next(BaseOperation::power_series, value.base.number);
    return N<Real, Order>::series(bases, value.rest);
}
/// No block is read so: there is no bound.
template <class Real, class Order>
HWY_INLINE Point<N<Real, Order>> settled(const LensTerms&, const Point<N<Real, Order>>& v) {
    return v;
}

/// The local rays of a row: their bases, the order in which those came, and the rests.
template <class Real>
struct Rays {
    Real x, y, z;
    std::uint64_t order = 0;
    HWY_ALIGN Real rest_x[Block::kMaxSide], rest_y[Block::kMaxSide], rest_z[Block::kMaxSide];
};

/// The transformed ray, as transform() in geometry/point.h computes it.
template <class Number>
HWY_INLINE Ray<Number> Transformed(const glm::dmat3& m, const Ray<Number>& ray) {
    const auto row = [&](int i)
                         HWY_ATTR -> Number { return ray.x * m[0][i] + ray.y * m[1][i] + ray.z * m[2][i]; };
    return {row(0), row(1), row(2)};
}

/// The order up to here, with what it has led to.
template <class Order, class... Result>
HWY_INLINE std::uint64_t OrderWith(const Result&... results) {
    (t_order<Order>.next(BaseOperation::output, results.base.number), ...);
    return t_order<Order>.sum();
}

/// Panorama::local_ray() of a row, `y` below the middle of the block, from `x` on.
template <class Projection, class Order, class Real>
ANAMORPH_FLATTEN void TargetRays(const DirectBlock<Real>& block, Real x, Real y, int count,
                                 Rays<Real>& rays) {
    using Base = ReadBase<Real, Order>;
    using Rest = L<Real>;
    using Number = N<Real, Order>;
    // Copies, which no store below can change, stay in registers.
    const Branch branch = block.local.target;
    const glm::dmat3 rotation = block.local.rotation;
    const Chart::Scale scale = block.target.scale();
    const Rest lanes(hn::Iota(D<Real>(), 0));
    for (int i = 0; i < count; i += Rest::kCount) {
        t_next = block.bases.data();
        t_order<Order> = Order();
        const Number px(Base::next(BaseOperation::input, 0), lanes + Rest(x + static_cast<Real>(i)));
        const Number py(Base::next(BaseOperation::input, 0), Rest(hn::Set(D<Real>(), y)));
        Point<Number> p = formulas::plane_of_pixel(px, py, branch, scale.per_x, scale.per_y);
        if constexpr (Projection::lensed != Lensed::no)
            if (block.target.lens()) p = formulas::ideal_point(block.target.lens()->terms(), p);
        const Ray<Number> r = Transformed(rotation, Projection::ray(p, branch));
        r.x.rest.store(rays.rest_x + i);
        r.y.rest.store(rays.rest_y + i);
        r.z.rest.store(rays.rest_z + i);
        if (i + Rest::kCount < count) continue;
        rays.x = r.x.base.value;
        rays.y = r.y.base.value;
        rays.z = r.z.base.value;
        rays.order = OrderWith<Order>(r.x, r.y, r.z);
    }
}

/// Chart::local_point() of a row. Returns the order in which its bases came.
template <class Projection, class Order, class Real>
ANAMORPH_FLATTEN std::uint64_t SourcePoints(const DirectBlock<Real>& block, const Rays<Real>& rays, int count,
                                            Real* x, Real* y) {
    using Base = ReadBase<Real, Order>;
    using Rest = L<Real>;
    using Number = N<Real, Order>;
    const Branch branch = block.local.source;
    const Chart::Scale scale = block.source.scale();
    const void* const first = t_next;
    std::uint64_t order = 0;
    for (int i = 0; i < count; i += Rest::kCount) {
        t_next = first;
        t_order<Order> = Order();
        const Ray<Number> r{{Base::input(rays.x), Rest::load(rays.rest_x + i)},
                            {Base::input(rays.y), Rest::load(rays.rest_y + i)},
                            {Base::input(rays.z), Rest::load(rays.rest_z + i)}};
        Point<Number> p = Projection::point(r, branch);
        if constexpr (Projection::lensed != Lensed::no)
            if (block.source.lens()) p = formulas::observed_point(block.source.lens()->terms(), p);
        p = formulas::pixel_of_plane(p, branch, scale.x, scale.y);
        (Rest(hn::Set(D<Real>(), block.middle.x)) + p.x.rest).store(x + i);
        (Rest(hn::Set(D<Real>(), block.middle.y)) + p.y.rest).store(y + i);
        order = OrderWith<Order>(p.x, p.y);
    }
    return order;
}

/// Returns the order in which the bases came.
template <class Order, class Real>
std::uint64_t ComputeDirectRow(const DirectBlock<Real>& block, int begin, int end, int row, Real* x,
                               Real* y) {
    Rays<Real> rays;
    std::uint64_t order = 0;
    const Real left = static_cast<Real>(begin) - static_cast<Real>(0.5) * static_cast<Real>(block.width - 1);
    const Real down = static_cast<Real>(row) - static_cast<Real>(0.5) * static_cast<Real>(block.height - 1);
    switch (block.target.projection()) {
#define ANAMORPH_PROJECTION(name, Type)                                          \
    case Projection::name:                                                       \
        TargetRays<formulas::Type, Order>(block, left, down, end - begin, rays); \
        break;
#include "anamorph/chart/projection/list.h"
#undef ANAMORPH_PROJECTION
    }
    switch (block.source.projection()) {
#define ANAMORPH_PROJECTION(name, Type)                                              \
    case Projection::name:                                                           \
        order = SourcePoints<formulas::Type, Order>(block, rays, end - begin, x, y); \
        break;
#include "anamorph/chart/projection/list.h"
#undef ANAMORPH_PROJECTION
    }
    return ReadingOrder::joined(rays.order, order);
}

void ComputeDirectRows(const DirectBlock<float>& block, const Box& part, const PointRows& to) {
    for (int row = part.y0; row < part.y1; ++row) {
        const std::ptrdiff_t at = (row - part.y0) * to.stride;
        ComputeDirectRow<NoOrder>(block, part.x0, part.x1, row, to.x + at, to.y + at);
    }
}
void ComputePreciseRow(const DirectBlock<double>& block, int row, double* x, double* y) {
    ComputeDirectRow<NoOrder>(block, 0, block.width, row, x, y);
}

#if HWY_TARGET == HWY_STATIC_TARGET
/// The first row, computed on one set of instructions for all, and the order in which its bases come.
template <class Real>
std::uint64_t ComputeInOrder(const DirectBlock<Real>& block, Real* x, Real* y) {
    return ComputeDirectRow<ReadingOrder>(block, 0, block.width, 0, x, y);
}
#endif

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(ComputeDirectRows);
HWY_EXPORT(ComputePreciseRow);

void direct_rows(const DirectBlock<float>& block, const Box& part, const PointRows& to) {
    HWY_DYNAMIC_DISPATCH(ComputeDirectRows)(block, part, to);
}
void direct_row(const DirectBlock<double>& block, int row, double* x, double* y) {
    HWY_DYNAMIC_DISPATCH(ComputePreciseRow)(block, row, x, y);
}

namespace {

void draw_first_row(const DirectBlock<float>& block, float* x, float* y) {
    direct_rows(block, {0, 0, block.width, 1}, {x, y, 0});
}
void draw_first_row(const DirectBlock<double>& block, double* x, double* y) {
    direct_row(block, 0, x, y);
}

/// Is the first row drawn as its bases are read in order?
template <class Real>
bool is_drawn_in_order(const DirectBlock<Real>& block, std::uint64_t& order) {
    std::array<Real, Block::kMaxSide> x, y, drawn_x, drawn_y;
    order = HWY_STATIC_DISPATCH(ComputeInOrder)(block, x.data(), y.data());
    draw_first_row(block, drawn_x.data(), drawn_y.data());
    const auto same = [&](const auto& a, const auto& b) {
        return std::equal(a.begin(), a.begin() + block.width, b.begin(),
                          [](Real p, Real q) { return p == q || (std::isnan(p) && std::isnan(q)); });
    };
    return same(x, drawn_x) && same(y, drawn_y);
}

/// More than any formula has, of any size, one in eight 0: a decision that does not hold.
template <class Real>
std::vector<Real> any_bases() {
    std::mt19937 random(1);
    std::vector<Real> bases(4096);
    for (Real& base : bases) base = random() % 8 == 0 ? 0 : 1 + static_cast<Real>(random() % 4096) / 4096;
    return bases;
}

}  // namespace

template <class Real>
std::uint64_t direct_order(const Chart& target, const Chart& source, const Panorama::Local& local) {
    static const std::vector<Real> bases = any_bases<Real>();
    std::uint64_t order = 0;
    for (std::size_t first = 0; first < 8; ++first)
        if (!is_drawn_in_order<Real>(
                {target, source, local, std::span(bases).subspan(101 * first), 8, 1, {0, 0}}, order))
            return 0;
    return order;
}
template std::uint64_t direct_order<float>(const Chart&, const Chart&, const Panorama::Local&);
template std::uint64_t direct_order<double>(const Chart&, const Chart&, const Panorama::Local&);

}  // namespace anamorph::simd
#endif
