// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/simd/direct_rows.cpp"
#include "anamorph/simd/direct_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

#ifndef ANAMORPH_SIMD_NEXT_BASE
#define ANAMORPH_SIMD_NEXT_BASE
namespace anamorph::simd {

/// The bases that are still to be read, of the type that is read. Once a row's formula stands in one function its reads
/// are at known places. (By the usual model plugins would call a function for each.)
static thread_local const void* t_next __attribute__((tls_model("initial-exec"))) = nullptr;

}  // namespace anamorph::simd
#endif

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"
using anamorph::both;  // of decisions at a base
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

/// A base: a constant, or one that was written down. Operations read their result in place of computing it.
template <class Real>
struct ReadBase {
    Real value = 0;

    ReadBase() = default;
    HWY_INLINE ReadBase(double k) : value(static_cast<Real>(k)) {}  // NOLINT: a number is a constant
    static HWY_INLINE ReadBase next() { return known(next_value()); }
    static HWY_INLINE Real next_value() {
        const Real* const next = static_cast<const Real*>(t_next);
        t_next = next + 1;
        return *next;
    }
    static HWY_INLINE ReadBase known(Real value) {
        ReadBase base;
        base.value = value;
        return base;
    }

    HWY_INLINE L<Real> lanes() const { return L<Real>(hn::Set(D<Real>(), value)); }

    friend HWY_INLINE ReadBase operator-(const ReadBase&) { return next(); }
    friend HWY_INLINE ReadBase operator+(const ReadBase&, const ReadBase&) { return next(); }
    friend HWY_INLINE ReadBase operator-(const ReadBase&, const ReadBase&) { return next(); }
    friend HWY_INLINE ReadBase operator*(const ReadBase&, const ReadBase&) { return next(); }
    friend HWY_INLINE ReadBase operator/(const ReadBase&, const ReadBase&) { return next(); }
    friend HWY_INLINE ReadBase sqrt(const ReadBase&) { return next(); }
    friend HWY_INLINE ReadBase asinh(const ReadBase&) { return next(); }
    friend HWY_INLINE ReadBase atan2(const ReadBase&, const ReadBase&) { return next(); }
    friend HWY_INLINE void sin_cos(const ReadBase&, ReadBase& s, ReadBase& c) {
        s = next();
        c = next();
    }
    friend HWY_INLINE ReadBase scaled_sinh(const ReadBase&, ReadBase& s) {
        s = next();
        return next();
    }
    template <std::size_t N>
    friend HWY_INLINE void sinc_cos_series(const ReadBase&, ReadBase (&s)[N], ReadBase (&c)[N]) {
        for (std::size_t k = 0; k < N; ++k) {
            s[k] = next();
            c[k] = next();
        }
    }
    friend HWY_INLINE bool is_negative(const ReadBase&) { return next_value() != 0; }
    friend HWY_INLINE bool is_zero(const ReadBase&) { return next_value() != 0; }
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
        const bool is_small = Base::next_value() != 0;
        return HWY_LIKELY(is_small) ? small_angle(y, x) : AnyAngle<Real>(y, x);
    }
    static HWY_INLINE Base choose(bool condition, const Base& a, const Base& b) { return condition ? a : b; }
    static HWY_INLINE Rest choose(bool condition, const Rest& a, const Rest& b) { return condition ? a : b; }
};

template <class Real>
using N = Near<ReadBase<Real>, L<Real>>;

/// As in map/lens.h.
template <class Real>
HWY_INLINE N<Real> shrink(const LensTerms&, const N<Real>& value) {
    ReadBase<Real> bases[ComputedSeries::kDegree + 1];
    for (int k = ComputedSeries::kDegree; k >= 0; --k) bases[k] = ReadBase<Real>::next();
    return N<Real>::series(bases, value.rest);
}
/// No block is read so: there is no bound.
template <class Real>
HWY_INLINE Point<N<Real>> settled(const LensTerms&, const Point<N<Real>>& v) {
    return v;
}

/// The local rays of a row: their bases, and the rests.
template <class Real>
struct Rays {
    Real x, y, z;
    HWY_ALIGN Real rest_x[Block::kMaxSide], rest_y[Block::kMaxSide], rest_z[Block::kMaxSide];
};

/// As transform() in geometry/point.h.
template <class Real>
HWY_INLINE Ray<N<Real>> Transformed(const glm::dmat3& m, const Ray<N<Real>>& ray) {
    const auto row = [&](int i)
                         HWY_ATTR -> N<Real> { return ray.x * m[0][i] + ray.y * m[1][i] + ray.z * m[2][i]; };
    return {row(0), row(1), row(2)};
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
        const N<Real> px(Base::next(), lanes + Rest(x + static_cast<Real>(i)));
        const N<Real> py(Base::next(), Rest(hn::Set(D<Real>(), y)));
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
    }
}

/// Chart::local_point() of a row.
template <class Projection, class Real>
ANAMORPH_FLATTEN void SourcePoints(const DirectBlock<Real>& block, const Rays<Real>& rays, int count, Real* x,
                                   Real* y) {
    using Base = ReadBase<Real>;
    using Rest = L<Real>;
    const Branch branch = block.local.source;
    const Chart::Plane plane = block.source.plane(branch.piece);
    const void* const first = t_next;
    for (int i = 0; i < count; i += Rest::kCount) {
        t_next = first;
        const Ray<N<Real>> r{{Base::known(rays.x), Rest::load(rays.rest_x + i)},
                             {Base::known(rays.y), Rest::load(rays.rest_y + i)},
                             {Base::known(rays.z), Rest::load(rays.rest_z + i)}};
        Point<N<Real>> p = Projection::point(r, branch);
        if constexpr (Projection::lensed != Lensed::no)
            if (block.source.lens()) p = formulas::observed_point(block.source.lens()->terms(), p);
        const N<Real> sx = (p.x - branch.centre_x) * plane.sx + plane.cx,
                      sy = (p.y - branch.centre_y) * plane.sy + plane.cy;
        (Rest(hn::Set(D<Real>(), block.middle.x)) + sx.rest).store(x + i);
        (Rest(hn::Set(D<Real>(), block.middle.y)) + sy.rest).store(y + i);
    }
}

template <class Real>
void ComputeDirectRow(const DirectBlock<Real>& block, int begin, int end, int row, Real* x, Real* y) {
    Rays<Real> rays;
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
#define ANAMORPH_PROJECTION(name, Type)                               \
    case Projection::name:                                            \
        SourcePoints<formulas::Type>(block, rays, end - begin, x, y); \
        break;
#include "anamorph/map/projection/list.h"
#undef ANAMORPH_PROJECTION
    }
    HWY_DASSERT(t_next == block.bases.data() + block.bases.size());
}

void ComputeDirectRows(const DirectBlock<float>& block, const Box& part, const PointRows& to) {
    for (int row = part.y0; row < part.y1; ++row) {
        const std::ptrdiff_t at = (row - part.y0) * to.stride;
        ComputeDirectRow(block, part.x0, part.x1, row, to.x + at, to.y + at);
    }
}
void ComputePreciseRow(const DirectBlock<double>& block, int row, double* x, double* y) {
    ComputeDirectRow(block, 0, block.width, row, x, y);
}

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

}  // namespace anamorph::simd
#endif
