// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/formula/text_rows_lanes.cpp"
#include "anamorph/formula/text_rows.h"

#include <algorithm>
#include <cmath>

#include "anamorph/number/next_base.h"
#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"
#define ANAMORPH_INLINE HWY_INLINE
#include "anamorph/number/near.h"
#undef ANAMORPH_INLINE

/// Pixels that are read together.
constexpr int kTextRow = 64;

template <class Real>
using D = hn::CappedTag<Real, kTextRow>;
template <class Real>
using L = Lanes<D<Real>>;

#include "anamorph/number/read_bases.h"

template <class Real>
using Base = ReadBase<Real, NoOrder>;
template <class Real>
using N = Near<Base<Real>, L<Real>>;

/// Pixels of a block as a number that read_program reads: each operation is done for all of them. Its functions are not for
/// inlining: the program's reader is compiled for no instruction set.
template <class Real>
struct Pixels {
    Base<Real> base;
    alignas(64) Real rest[kTextRow];

    Pixels() = default;
    HWY_NOINLINE Pixels(double k) {  // NOLINT: a number is many
        set([k](int) HWY_ATTR { return N<Real>(k); });
    }
    /// One near number after the other, each of which reads the same bases.
    template <class Value>
    HWY_INLINE void set(const Value& value) {
        const void* const first = t_next;
        for (int i = 0; i < kTextRow; i += L<Real>::kCount) {
            t_next = first;
            const N<Real> one = value(i);
            one.rest.store(rest + i);
            base = one.base;
        }
    }
    template <class Value>
    static HWY_INLINE Pixels of(const Value& value) {
        Pixels pixels;
        pixels.set(value);
        return pixels;
    }
    HWY_INLINE N<Real> at(int i) const { return {base, L<Real>::load(rest + i)}; }

    friend HWY_NOINLINE Pixels operator+(const Pixels& a, const Pixels& b) {
        return of([&](int i) HWY_ATTR { return a.at(i) + b.at(i); });
    }
    friend HWY_NOINLINE Pixels operator+(const Pixels& a, double b) {
        return of([&](int i) HWY_ATTR { return a.at(i) + b; });
    }
    friend HWY_NOINLINE Pixels operator*(const Pixels& a, const Pixels& b) {
        return of([&](int i) HWY_ATTR { return a.at(i) * b.at(i); });
    }
    friend HWY_NOINLINE Pixels operator*(const Pixels& a, double b) {
        return of([&](int i) HWY_ATTR { return a.at(i) * b; });
    }
    friend HWY_NOINLINE Pixels operator/(const Pixels& a, const Pixels& b) {
        return of([&](int i) HWY_ATTR { return a.at(i) / b.at(i); });
    }
    friend HWY_NOINLINE Pixels operator-(const Pixels& a) {
        return of([&](int i) HWY_ATTR { return -a.at(i); });
    }
    friend HWY_NOINLINE Pixels square(const Pixels& a) {
        return of([&](int i) HWY_ATTR { return square(a.at(i)); });
    }
    friend HWY_NOINLINE Pixels sqrt(const Pixels& a) {
        return of([&](int i) HWY_ATTR { return sqrt(a.at(i)); });
    }
    friend HWY_NOINLINE Pixels asinh(const Pixels& a) {
        return of([&](int i) HWY_ATTR { return asinh(a.at(i)); });
    }
    friend HWY_NOINLINE Pixels atan2(const Pixels& y, const Pixels& x) {
        return of([&](int i) HWY_ATTR { return atan2(y.at(i), x.at(i)); });
    }
    friend HWY_NOINLINE void sin_cos(const Pixels& a, Pixels& sine, Pixels& cosine) {
        const void* const first = t_next;
        for (int i = 0; i < kTextRow; i += L<Real>::kCount) {
            t_next = first;
            N<Real> s, c;
            sin_cos(a.at(i), s, c);
            s.rest.store(sine.rest + i);
            c.rest.store(cosine.rest + i);
            sine.base = s.base;
            cosine.base = c.base;
        }
    }
    // No block is read with these: TextMap::may_be_direct().
    friend HWY_NOINLINE Pixels exp(const Pixels& a) { return a; }
    friend HWY_NOINLINE Pixels log(const Pixels& a) { return a; }
    friend HWY_NOINLINE Pixels floor_of(const Pixels& a) { return a; }

    /// The condition is the number itself, which choose() asks.
    struct Negative {
        const Pixels& of;
    };
    friend Negative is_negative(const Pixels& a) { return {a}; }
    friend HWY_NOINLINE Pixels choose(const Negative& where, const Pixels& a, const Pixels& b) {
        return of([&](int i) HWY_ATTR { return select(is_negative(where.of.at(i)), a.at(i), b.at(i)); });
    }
};

/// kTextRow pixels whose rests across and down are those of `x` and `y`; their bases are set here.
template <class Real>
void ReadPixels(const TextBlock<Real>& block, Pixels<Real>& x, Pixels<Real>& y, Point<Pixels<Real>>& found) {
    t_next = block.bases.data();
    x.base = Base<Real>::next(BaseOperation::input, 0);
    y.base = Base<Real>::next(BaseOperation::input, 0);
    const Point<Pixels<Real>> at = block.scale(x, y);
    const auto [to_x, to_y] = read_program<2>(block.program, at.x, at.y);
    found = {to_x, to_y};
}

/// The rests of `width` times `rows` pixels of a block, from (left, top) on. What stands behind them is read, and left.
template <class Real>
void SetRests(const TextBlock<Real>& block, int left, int top, int width, int rows, Pixels<Real>& x,
              Pixels<Real>& y) {
    const auto half = static_cast<Real>(0.5);
    const Real first = static_cast<Real>(left) - half * static_cast<Real>(block.width - 1);
    const Real highest = static_cast<Real>(top) - half * static_cast<Real>(block.height - 1);
    for (int row = 0; row < rows; ++row)
        for (int i = 0; i < width; ++i) {
            x.rest[row * width + i] = first + static_cast<Real>(i);
            y.rest[row * width + i] = highest + static_cast<Real>(row);
        }
    std::fill(x.rest + rows * width, x.rest + kTextRow, first);
    std::fill(y.rest + rows * width, y.rest + kTextRow, highest);
}

/// Computes as many rows at once as there is room for.
void ComputeTextRows(const TextBlock<float>& block, const Box& part, const PointRows& to) {
    const int width = part.width(), most = std::max(1, kTextRow / width);
    Pixels<float> x, y;
    Point<Pixels<float>> found;
    for (int top = part.y0; top < part.y1; top += most) {
        const int rows = std::min(most, part.y1 - top);
        SetRests(block, part.x0, top, width, rows, x, y);
        ReadPixels(block, x, y, found);
        for (int row = 0; row < rows; ++row) {
            const std::ptrdiff_t at = (top - part.y0 + row) * to.stride;
            const float *const from_x = found.x.rest + row * width, *const from_y =
                                                                        found.y.rest + row * width;
            for (int i = 0; i < width; ++i) {
                to.x[at + i] = block.middle.x + from_x[i];
                to.y[at + i] = block.middle.y + from_y[i];
            }
        }
    }
}

void ComputeTextRow(const TextBlock<double>& block, int row, double* x, double* y) {
    Pixels<double> px, py;
    Point<Pixels<double>> found;
    SetRests(block, 0, row, block.width, 1, px, py);
    ReadPixels(block, px, py, found);
    for (int i = 0; i < block.width; ++i) {
        x[i] = block.middle.x + found.x.rest[i];
        y[i] = block.middle.y + found.y.rest[i];
    }
}

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

HWY_EXPORT(ComputeTextRows);
HWY_EXPORT(ComputeTextRow);

void text_rows(const TextBlock<float>& block, const Box& part, const PointRows& to) {
    HWY_DYNAMIC_DISPATCH(ComputeTextRows)(block, part, to);
}
void text_row(const TextBlock<double>& block, int row, double* x, double* y) {
    HWY_DYNAMIC_DISPATCH(ComputeTextRow)(block, row, x, y);
}

}  // namespace anamorph::simd
#endif
