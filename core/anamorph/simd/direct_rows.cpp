// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/simd/direct_rows.cpp"
#include "anamorph/simd/direct_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

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

using D = hn::CappedTag<float, Block::kMaxSide>;
using L = Lanes<D>;

/// The bases that are still to be read. Once a row's formula stands in one function its reads are at known places.
thread_local const float* t_next = nullptr;

/// A base: a constant, or one that was written down. Operations read their result in place of computing it.
struct ReadBase {
    float value = 0;

    ReadBase() = default;
    HWY_INLINE ReadBase(double k) : value(static_cast<float>(k)) {}  // NOLINT: a number is a constant
    static HWY_INLINE ReadBase next() { return known(*t_next++); }
    static HWY_INLINE ReadBase known(float value) {
        ReadBase base;
        base.value = value;
        return base;
    }

    HWY_INLINE L lanes() const { return L(hn::Set(D(), value)); }

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
    friend HWY_INLINE bool is_negative(const ReadBase&) { return *t_next++ != 0; }
    friend HWY_INLINE bool is_zero(const ReadBase&) { return *t_next++ != 0; }
};

template <>
struct NearRest<ReadBase, L> {
    static HWY_INLINE L of(const ReadBase& base) { return base.lanes(); }
    static HWY_INLINE L off(const L& rest, const ReadBase&, double) { return rest; }
    static HWY_INLINE ReadBase choose(bool condition, const ReadBase& a, const ReadBase& b) {
        return condition ? a : b;
    }
    static HWY_INLINE L choose(bool condition, const L& a, const L& b) { return condition ? a : b; }
};

using N = Near<ReadBase, L>;

/// Lenses are not followed the way that is a root: there is no bound (map/lens.h).
HWY_INLINE N shrink(const LensTerms&, const N& value) {
    return value;
}
HWY_INLINE Point<N> settled(const LensTerms&, const Point<N>& v) {
    return v;
}

/// The local rays of a row: their bases, and the rests.
struct Rays {
    float x, y, z;
    HWY_ALIGN float rest_x[Block::kMaxSide], rest_y[Block::kMaxSide], rest_z[Block::kMaxSide];
};

/// As transform() in geometry/point.h.
HWY_INLINE Ray<N> Transformed(const glm::dmat3& m, const Ray<N>& ray) {
    const auto row = [&](int i) HWY_ATTR -> N { return ray.x * m[0][i] + ray.y * m[1][i] + ray.z * m[2][i]; };
    return {row(0), row(1), row(2)};
}

/// Panorama::local_ray() of a row, `y` below the middle of the block, from `x` on.
template <class Projection>
ANAMORPH_FLATTEN void TargetRays(const DirectBlock& block, float x, float y, int count, Rays& rays) {
    const Branch& branch = block.local.target;
    const Chart::Plane plane = block.target.plane(branch.piece);
    for (int i = 0; i < count; i += L::kCount) {
        t_next = block.bases.data();
        const N px(ReadBase::next(), L(hn::Iota(D(), x + static_cast<float>(i))));
        const N py(ReadBase::next(), L(hn::Set(D(), y)));
        Point<N> p{(px - plane.cx) * plane.per_x + branch.centre_x,
                   (py - plane.cy) * plane.per_y + branch.centre_y};
        if constexpr (Projection::lensed != Lensed::no)
            if (block.target.lens()) p = formulas::ideal_point(block.target.lens()->terms(), p);
        const Ray<N> r = Transformed(block.local.rotation, Projection::ray(p, branch));
        r.x.rest.store(rays.rest_x + i);
        r.y.rest.store(rays.rest_y + i);
        r.z.rest.store(rays.rest_z + i);
        if (i + L::kCount < count) continue;
        rays.x = r.x.base.value;
        rays.y = r.y.base.value;
        rays.z = r.z.base.value;
    }
}

/// Chart::local_point() of a row.
template <class Projection>
ANAMORPH_FLATTEN void SourcePoints(const DirectBlock& block, const Rays& rays, int count, float* x,
                                   float* y) {
    const Branch& branch = block.local.source;
    const Chart::Plane plane = block.source.plane(branch.piece);
    const float* const first = t_next;
    for (int i = 0; i < count; i += L::kCount) {
        t_next = first;
        const Ray<N> r{{ReadBase::known(rays.x), L::load(rays.rest_x + i)},
                       {ReadBase::known(rays.y), L::load(rays.rest_y + i)},
                       {ReadBase::known(rays.z), L::load(rays.rest_z + i)}};
        Point<N> p = Projection::point(r, branch);
        if constexpr (Projection::lensed != Lensed::no)
            if (block.source.lens()) p = formulas::observed_point(block.source.lens()->terms(), p);
        const N sx = (p.x - branch.centre_x) * plane.sx + plane.cx,
                sy = (p.y - branch.centre_y) * plane.sy + plane.cy;
        (L(hn::Set(D(), block.middle.x)) + sx.rest).store(x + i);
        (L(hn::Set(D(), block.middle.y)) + sy.rest).store(y + i);
    }
}

void ComputeDirectRow(const DirectBlock& block, int begin, int end, int row, float* x, float* y) {
    Rays rays;
    const float left = static_cast<float>(begin) - 0.5f * static_cast<float>(block.width - 1);
    const float down = static_cast<float>(row) - 0.5f * static_cast<float>(block.height - 1);
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

void ComputeDirectRows(const DirectBlock& block, const Box& part, const PointRows& to) {
    for (int row = part.y0; row < part.y1; ++row) {
        const std::ptrdiff_t at = (row - part.y0) * to.stride;
        ComputeDirectRow(block, part.x0, part.x1, row, to.x + at, to.y + at);
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(ComputeDirectRows);

void direct_rows(const DirectBlock& block, const Box& part, const PointRows& to) {
    HWY_DYNAMIC_DISPATCH(ComputeDirectRows)(block, part, to);
}

}  // namespace anamorph::simd
#endif
