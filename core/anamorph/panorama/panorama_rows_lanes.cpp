// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/panorama/panorama_rows_lanes.cpp"
#include "anamorph/panorama/panorama_rows.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"

// The formulas once more, for this instruction set.
namespace formulas {
template <class Tag>
HWY_INLINE bool somewhere(const LaneMask<Tag>& condition) {
    return !hn::AllFalse(Tag(), condition.m);
}
#include "anamorph/chart/chart_plane.h"
#include "anamorph/chart/lens_formula.h"
#include "anamorph/chart/projection/list.h"
}  // namespace formulas

using D = hn::CappedTag<double, kExactRow>;
using L = Lanes<D>;

/// The transformed ray, as transform() in geometry/point.h computes it.
template <class Entry>
HWY_INLINE Ray<L> Transformed(const Entry& entry, const Ray<L>& r) {
    return {r.x * entry(0, 0) + r.y * entry(1, 0) + r.z * entry(2, 0),
            r.x * entry(0, 1) + r.y * entry(1, 1) + r.z * entry(2, 1),
            r.x * entry(0, 2) + r.y * entry(1, 2) + r.z * entry(2, 2)};
}

struct Matrix {
    double entries[3][3];
    double operator()(int column, int row) const { return entries[column][row]; }
};
Matrix MatrixOf(const Turn& turn) {
    Matrix m{};
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t r = 0; r < 3; ++r) m.entries[c][r] = turn[c][r].value();
    return m;
}
Matrix MatrixOf(const glm::dmat3& axes) {
    Matrix m{};
    for (int c = 0; c < 3; ++c)
        for (int r = 0; r < 3; ++r) m.entries[c][r] = axes[c][r];
    return m;
}

/// Finds the rays of a row of target points, with the lens of the target, if it has one and its projection
/// may have one.
template <class Projection>
void TargetRays(const Chart& target, const Matrix& turn, int piece, double x0, double y, int count,
                RayRow& rays) {
    const Branch& branch = target.branch(piece);
    const Chart::Scale scale = target.scale();
    const Matrix axes = MatrixOf(branch.axes);
    const L lanes(hn::Iota(D(), 0));
    for (int i = 0; i < count; i += L::kCount) {
        Point<L> p = formulas::plane_of_pixel(lanes + L(i) + x0, L(y), branch, scale.per_x, scale.per_y);
        L inside(1);
        if constexpr (Projection::lensed != Lensed::no)
            if (target.lens()) {
                inside = formulas::has_ideal(target.lens()->terms(), p);
                p = formulas::ideal_point(target.lens()->terms(), p);
            }
        min(Projection::inside(p, branch), inside).store(rays.inside + i);
        const Ray<L> r = Transformed(turn, Transformed(axes, Projection::ray(p, branch)));
        r.x.store(rays.x + i);
        r.y.store(rays.y + i);
        r.z.store(rays.z + i);
    }
}

/// The piece that looks most along each ray, as a number.
HWY_INLINE L PieceOf(const Chart& source, const Ray<L>& r) {
    L most(0), best(0);
    for (std::size_t k = 0; k < source.pieces().size(); ++k) {
        const glm::dvec3& f = source.pieces()[k].toward;
        const L along = r.x * f[0] + r.y * f[1] + r.z * f[2];
        const LaneMask<D> better = k == 0 ? is_zero(L(0)) : most < along;
        most = select(better, along, most);
        best = select(better, L(static_cast<double>(k)), best);
    }
    return best;
}

template <class Projection>
void SourcePoints(const Chart& source, const RayRow& rays, int count, ExactRow& row) {
    const int pieces = static_cast<int>(source.pieces().size());
    const Chart::Scale scale = source.scale();
    for (int i = 0; i < count; i += L::kCount) {
        const Ray<L> r{L::load(rays.x + i), L::load(rays.y + i), L::load(rays.z + i)};
        const L piece = pieces > 1 ? PieceOf(source, r) : L(0);
        LaneMask<D> seen{hn::Ge(L::load(rays.inside + i).v, hn::Zero(D()))};
        L x(0), y(0), sees(1);
        for (int k = 0; k < pieces; ++k) {
            const LaneMask<D> here = is_zero(piece - L(k));
            if (hn::AllFalse(D(), here.m)) continue;
            const Branch& branch = source.branch(k);
            const Ray<L> local = Transformed(MatrixOf(glm::transpose(branch.axes)), r);
            if (!source.pieces_see_all()) sees = select(here, Projection::sees(local, branch), sees);
            Point<L> p = Projection::point(local, branch);
            if constexpr (Projection::lensed != Lensed::no)
                if (source.lens()) {
                    seen = both(seen, L(0) < formulas::has_observed(source.lens()->terms(), p));
                    p = formulas::observed_point(source.lens()->terms(), p);
                }
            p = formulas::pixel_of_plane(p, branch, scale.x, scale.y);
            x = select(here, p.x, x);
            y = select(here, p.y, y);
        }
        seen = both(seen, L(0) < sees);
        // Finite: what is infinite or no number less itself is not zero.
        seen = both(seen, both(is_zero(x - x), is_zero(y - y)));
        x.store(row.x + i);
        y.store(row.y + i);
        piece.store(row.piece + i);
        select(seen, L(1), L(0)).store(row.seen + i);
    }
}

void AnySourcePoints(const Chart& source, const RayRow& rays, int count, ExactRow& row) {
    switch (source.projection()) {
#define ANAMORPH_PROJECTION(name, Type)                         \
    case Projection::name:                                      \
        SourcePoints<formulas::Type>(source, rays, count, row); \
        break;
#include "anamorph/chart/projection/list.h"
#undef ANAMORPH_PROJECTION
    }
}

void ComputeExactRow(const Chart& target, const Chart& source, const Turn& turn, int piece, double x,
                     double y, int count, ExactRow& row) {
    RayRow rays;
    const Matrix matrix = MatrixOf(turn);
    switch (target.projection()) {
#define ANAMORPH_PROJECTION(name, Type)                                       \
    case Projection::name:                                                    \
        TargetRays<formulas::Type>(target, matrix, piece, x, y, count, rays); \
        break;
#include "anamorph/chart/projection/list.h"
#undef ANAMORPH_PROJECTION
    }
    AnySourcePoints(source, rays, count, row);
}

/// Turns the rays.
void ComputeExactPoints(const Chart& source, const Turn& turn, RayRow& rays, int count, ExactRow& row) {
    const Matrix matrix = MatrixOf(turn);
    for (int i = 0; i < count; i += L::kCount) {
        const Ray<L> r =
            Transformed(matrix, Ray<L>{L::load(rays.x + i), L::load(rays.y + i), L::load(rays.z + i)});
        r.x.store(rays.x + i);
        r.y.store(rays.y + i);
        r.z.store(rays.z + i);
    }
    AnySourcePoints(source, rays, count, row);
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(ComputeExactRow);
HWY_EXPORT(ComputeExactPoints);

void exact_row(const Chart& target, const Chart& source, const Turn& turn, int piece, double x, double y,
               int count, ExactRow& row) {
    HWY_DYNAMIC_DISPATCH(ComputeExactRow)(target, source, turn, piece, x, y, count, row);
}
void exact_points(const Chart& source, const Turn& turn, RayRow& rays, int count, ExactRow& row) {
    HWY_DYNAMIC_DISPATCH(ComputeExactPoints)(source, turn, rays, count, row);
}

}  // namespace anamorph::simd
#endif
