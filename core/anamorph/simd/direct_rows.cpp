// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/simd/direct_rows.cpp"
#include "anamorph/simd/direct_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

#ifndef ANAMORPH_SIMD_NEXT_BASE
#define ANAMORPH_SIMD_NEXT_BASE
namespace anamorph::simd {

/// The bases that are still to be read, of the type that is read, and in which order they are. Once a row's formula stands in
/// one function its reads are at known places, and the order is a number known to the compiler. (By the usual model plugins
/// would call a function for each.)
static thread_local const void* t_next __attribute__((tls_model("initial-exec"))) = nullptr;
static thread_local ReadingOrder t_order __attribute__((tls_model("initial-exec")));

}  // namespace anamorph::simd
#endif

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"
#define ANAMORPH_INLINE HWY_INLINE
#ifdef ANAMORPH_SANITIZED
// In one function each the formulas take minutes to compile.
#define ANAMORPH_FLATTEN
#else
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
#include "anamorph/map/lens_formula.h"
#include "anamorph/map/projection/list.h"
}  // namespace formulas

template <class Real>
using D = hn::CappedTag<Real, Block::kMaxSide>;
template <class Real>
using L = Lanes<D<Real>>;

/// A decision at a base, that was written down.
struct ReadDecision {
    bool holds;
    ReadingOrder::Number number;

    friend HWY_INLINE ReadDecision both(const ReadDecision& a, const ReadDecision& b) {
        return {a.holds && b.holds, t_order.next(BaseOperation::both, a.number, b.number)};
    }
};

/// A base: a constant, or one that was written down. Operations read their result in place of computing it.
template <class Real>
struct ReadBase {
    using Number = ReadingOrder::Number;

    Real value = 0;
    Number number = 0;  ///< as WrittenBase has it

    ReadBase() = default;
    HWY_INLINE ReadBase(double k) : value(static_cast<Real>(k)) {}  // NOLINT: a number is a constant
    static HWY_INLINE ReadBase next(BaseOperation operation, Number a, Number b = 0) {
        return known(next_value(), t_order.next(operation, a, b));
    }
    static HWY_INLINE ReadDecision next_decision(BaseOperation operation, Number a) {
        return {next_value() != 0, t_order.next(operation, a)};
    }
    static HWY_INLINE Real next_value() {
        const Real* const next = static_cast<const Real*>(t_next);
        t_next = next + 1;
        return *next;
    }
    static HWY_INLINE ReadBase known(Real value, Number number) {
        ReadBase base;
        base.value = value;
        base.number = number;
        return base;
    }
    static HWY_INLINE ReadBase input(Real value) { return known(value, t_order.next(BaseOperation::input)); }

    HWY_INLINE L<Real> lanes() const { return L<Real>(hn::Set(D<Real>(), value)); }

    friend HWY_INLINE ReadBase operator-(const ReadBase& a) {
        return next(BaseOperation::negation, a.number);
    }
    friend HWY_INLINE ReadBase operator+(const ReadBase& a, const ReadBase& b) {
        return next(BaseOperation::sum, a.number, b.number);
    }
    friend HWY_INLINE ReadBase operator-(const ReadBase& a, const ReadBase& b) {
        return next(BaseOperation::difference, a.number, b.number);
    }
    friend HWY_INLINE ReadBase operator*(const ReadBase& a, const ReadBase& b) {
        return next(BaseOperation::product, a.number, b.number);
    }
    friend HWY_INLINE ReadBase operator/(const ReadBase& a, const ReadBase& b) {
        return next(BaseOperation::quotient, a.number, b.number);
    }
    friend HWY_INLINE ReadBase sqrt(const ReadBase& a) { return next(BaseOperation::root, a.number); }
    friend HWY_INLINE ReadBase asinh(const ReadBase& a) { return next(BaseOperation::area_sine, a.number); }
    friend HWY_INLINE ReadBase atan2(const ReadBase& y, const ReadBase& x) {
        return next(BaseOperation::angle, y.number, x.number);
    }
    friend HWY_INLINE void sin_cos(const ReadBase& a, ReadBase& s, ReadBase& c) {
        const Number of = a.number;
        s = next(BaseOperation::sine_and_cosine, of);
        c = next(BaseOperation::sine_and_cosine, of);
    }
    friend HWY_INLINE ReadBase scaled_sinh(const ReadBase& a, ReadBase& s) {
        const Number of = a.number;
        s = next(BaseOperation::scaled_sine, of);
        return next(BaseOperation::scaled_sine, of);
    }
    template <std::size_t N>
    friend HWY_INLINE void sinc_cos_series(const ReadBase& a, ReadBase (&s)[N], ReadBase (&c)[N]) {
        for (std::size_t k = 0; k < N; ++k) {
            s[k] = next(BaseOperation::sinc_and_cosine, a.number);
            c[k] = next(BaseOperation::sinc_and_cosine, a.number);
        }
    }
    friend HWY_INLINE ReadDecision is_negative(const ReadBase& a) {
        return next_decision(BaseOperation::is_negative, a.number);
    }
    friend HWY_INLINE ReadDecision is_zero(const ReadBase& a) {
        return next_decision(BaseOperation::is_zero, a.number);
    }
};

/// Angles beyond those that are small: few blocks read one.
template <class Real>
HWY_NOINLINE __attribute__((const)) L<Real> AnyAngle(L<Real> y, L<Real> x) {
    return atan2(y, x);
}

template <class Real>
struct NearRest<ReadBase<Real>, L<Real>> {
    using Base = ReadBase<Real>;
    using Rest = L<Real>;
    static constexpr int kSincDegree = sinc_degree<Real>;
    static HWY_INLINE Rest of(const Base& base) { return base.lanes(); }
    static HWY_INLINE Rest off(const Rest& rest, const Base&, double) { return rest; }
    static HWY_INLINE Rest left_out(const Rest& rest, const Rest&, double) { return rest; }
    static HWY_INLINE Rest within(const Rest& rest, const Rest&) { return rest; }
    static HWY_INLINE Rest angle(const Rest& y, const Rest& x) {
        const ReadDecision is_small = Base::next_decision(BaseOperation::is_small_angle, 0);
        return HWY_LIKELY(is_small.holds) ? small_angle(y, x) : AnyAngle<Real>(y, x);
    }
    static HWY_INLINE Base choose(const ReadDecision& condition, const Base& a, const Base& b) {
        return Base::known(condition.holds ? a.value : b.value,
                           t_order.next(BaseOperation::choice, condition.number, a.number, b.number));
    }
    static HWY_INLINE Rest choose(const ReadDecision& condition, const Rest& a, const Rest& b) {
        return condition.holds ? a : b;
    }
};

template <class Real>
using N = Near<ReadBase<Real>, L<Real>>;

/// As in map/lens.h.
template <class Real>
HWY_INLINE N<Real> shrink(const LensTerms&, const N<Real>& value) {
    ReadBase<Real> bases[ComputedSeries::kDegree + 1];
    for (int k = ComputedSeries::kDegree; k >= 0; --k)
        bases[k] = ReadBase<Real>::next(BaseOperation::power_series, value.base.number);
    return N<Real>::series(bases, value.rest);
}
/// No block is read so: there is no bound.
template <class Real>
HWY_INLINE Point<N<Real>> settled(const LensTerms&, const Point<N<Real>>& v) {
    return v;
}

/// The local rays of a row: their bases, the order in which those came, and the rests.
template <class Real>
struct Rays {
    Real x, y, z;
    std::uint64_t order = 0;
    HWY_ALIGN Real rest_x[Block::kMaxSide], rest_y[Block::kMaxSide], rest_z[Block::kMaxSide];
};

/// As transform() in geometry/point.h.
template <class Real>
HWY_INLINE Ray<N<Real>> Transformed(const glm::dmat3& m, const Ray<N<Real>>& ray) {
    const auto row = [&](int i)
                         HWY_ATTR -> N<Real> { return ray.x * m[0][i] + ray.y * m[1][i] + ray.z * m[2][i]; };
    return {row(0), row(1), row(2)};
}

/// The order up to here, with what it has led to.
template <class... Result>
HWY_INLINE std::uint64_t OrderWith(const Result&... results) {
    (t_order.next(BaseOperation::output, results.base.number), ...);
    return t_order.sum();
}

/// Panorama::local_ray() of a row, `y` below the middle of the block, from `x` on.
template <class Projection, class Real>
ANAMORPH_FLATTEN void TargetRays(const DirectBlock<Real>& block, Real x, Real y, int count,
                                 Rays<Real>& rays) {
    using Base = ReadBase<Real>;
    using Rest = L<Real>;
    // Copies, which no store below can change, stay in registers.
    const Branch branch = block.local.target;
    const glm::dmat3 rotation = block.local.rotation;
    const Chart::Plane plane = block.target.plane(branch.piece);
    const Rest lanes(hn::Iota(D<Real>(), 0));
    for (int i = 0; i < count; i += Rest::kCount) {
        t_next = block.bases.data();
        t_order = ReadingOrder();
        const N<Real> px(Base::next(BaseOperation::input, 0), lanes + Rest(x + static_cast<Real>(i)));
        const N<Real> py(Base::next(BaseOperation::input, 0), Rest(hn::Set(D<Real>(), y)));
        Point<N<Real>> p{(px - plane.cx) * plane.per_x + branch.centre_x,
                         (py - plane.cy) * plane.per_y + branch.centre_y};
        if constexpr (Projection::lensed != Lensed::no)
            if (block.target.lens()) p = formulas::ideal_point(block.target.lens()->terms(), p);
        const Ray<N<Real>> r = Transformed(rotation, Projection::ray(p, branch));
        r.x.rest.store(rays.rest_x + i);
        r.y.rest.store(rays.rest_y + i);
        r.z.rest.store(rays.rest_z + i);
        if (i + Rest::kCount < count) continue;
        rays.x = r.x.base.value;
        rays.y = r.y.base.value;
        rays.z = r.z.base.value;
        rays.order = OrderWith(r.x, r.y, r.z);
    }
}

/// Chart::local_point() of a row. Returns the order in which its bases came.
template <class Projection, class Real>
ANAMORPH_FLATTEN std::uint64_t SourcePoints(const DirectBlock<Real>& block, const Rays<Real>& rays, int count,
                                            Real* x, Real* y) {
    using Base = ReadBase<Real>;
    using Rest = L<Real>;
    const Branch branch = block.local.source;
    const Chart::Plane plane = block.source.plane(branch.piece);
    const void* const first = t_next;
    std::uint64_t order = 0;
    for (int i = 0; i < count; i += Rest::kCount) {
        t_next = first;
        t_order = ReadingOrder();
        const Ray<N<Real>> r{{Base::input(rays.x), Rest::load(rays.rest_x + i)},
                             {Base::input(rays.y), Rest::load(rays.rest_y + i)},
                             {Base::input(rays.z), Rest::load(rays.rest_z + i)}};
        Point<N<Real>> p = Projection::point(r, branch);
        if constexpr (Projection::lensed != Lensed::no)
            if (block.source.lens()) p = formulas::observed_point(block.source.lens()->terms(), p);
        const N<Real> sx = (p.x - branch.centre_x) * plane.sx + plane.cx,
                      sy = (p.y - branch.centre_y) * plane.sy + plane.cy;
        (Rest(hn::Set(D<Real>(), block.middle.x)) + sx.rest).store(x + i);
        (Rest(hn::Set(D<Real>(), block.middle.y)) + sy.rest).store(y + i);
        order = OrderWith(sx, sy);
    }
    return order;
}

/// Returns the order in which the bases came.
template <class Real>
std::uint64_t ComputeDirectRow(const DirectBlock<Real>& block, int begin, int end, int row, Real* x,
                               Real* y) {
    Rays<Real> rays;
    std::uint64_t order = 0;
    const Real left = static_cast<Real>(begin) - static_cast<Real>(0.5) * static_cast<Real>(block.width - 1);
    const Real down = static_cast<Real>(row) - static_cast<Real>(0.5) * static_cast<Real>(block.height - 1);
    switch (block.target.projection()) {
#define ANAMORPH_PROJECTION(name, Type)                                   \
    case Projection::name:                                                \
        TargetRays<formulas::Type>(block, left, down, end - begin, rays); \
        break;
#include "anamorph/map/projection/list.h"
#undef ANAMORPH_PROJECTION
    }
    switch (block.source.projection()) {
#define ANAMORPH_PROJECTION(name, Type)                                       \
    case Projection::name:                                                    \
        order = SourcePoints<formulas::Type>(block, rays, end - begin, x, y); \
        break;
#include "anamorph/map/projection/list.h"
#undef ANAMORPH_PROJECTION
    }
    return ReadingOrder::joined(rays.order, order);
}

void ComputeDirectRows(const DirectBlock<float>& block, const Box& part, const PointRows& to) {
    for (int row = part.y0; row < part.y1; ++row) {
        const std::ptrdiff_t at = (row - part.y0) * to.stride;
        ComputeDirectRow(block, part.x0, part.x1, row, to.x + at, to.y + at);
        HWY_DASSERT(t_next == block.bases.data() + block.bases.size());
    }
}
void ComputePreciseRow(const DirectBlock<double>& block, int row, double* x, double* y) {
    ComputeDirectRow(block, 0, block.width, row, x, y);
    HWY_DASSERT(t_next == block.bases.data() + block.bases.size());
}

template <class Real>
std::uint64_t DirectOrder(const DirectBlock<Real>& block) {
    HWY_ALIGN Real x[Block::kMaxSide], y[Block::kMaxSide];
    const std::uint64_t order = ComputeDirectRow(block, 0, 1, 0, x, y);
    HWY_DASSERT(t_next <= block.bases.data() + block.bases.size());
    return order;
}
std::uint64_t DirectOrderInFloat(const DirectBlock<float>& block) {
    return DirectOrder(block);
}
std::uint64_t DirectOrderInDouble(const DirectBlock<double>& block) {
    return DirectOrder(block);
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(ComputeDirectRows);
HWY_EXPORT(ComputePreciseRow);
HWY_EXPORT(DirectOrderInFloat);
HWY_EXPORT(DirectOrderInDouble);

void direct_rows(const DirectBlock<float>& block, const Box& part, const PointRows& to) {
    HWY_DYNAMIC_DISPATCH(ComputeDirectRows)(block, part, to);
}
void direct_row(const DirectBlock<double>& block, int row, double* x, double* y) {
    HWY_DYNAMIC_DISPATCH(ComputePreciseRow)(block, row, x, y);
}
std::uint64_t direct_order(const DirectBlock<float>& block) {
    return HWY_DYNAMIC_DISPATCH(DirectOrderInFloat)(block);
}
std::uint64_t direct_order(const DirectBlock<double>& block) {
    return HWY_DYNAMIC_DISPATCH(DirectOrderInDouble)(block);
}

}  // namespace anamorph::simd
#endif
