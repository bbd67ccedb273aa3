// SPDX-License-Identifier: Apache-2.0
// The rival to beat: every pixel exact, with vectors of pixels, tiles, wide loads, prefetches and streaming
// stores.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <initializer_list>

#include "anamorph/image/prefetch.h"
#include "pano_rivals.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "pano_simd_exact.cpp"
#include "hwy/cache_control.h"
#include "hwy/foreach_target.h"  // before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::bench::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using D = hn::ScalableTag<float>;
using V = hn::Vec<D>;
using DI = hn::RebindToSigned<D>;

constexpr int kTileWidth = 64, kTileHeight = kSimdTileHeight;

/// What one row of a tile reads: where the upper left taps stand (floats from the origin) and the weights of
/// the taps to the right and below.
struct RowTaps {
    HWY_ALIGN_MAX std::int32_t offset[kTileWidth];
    HWY_ALIGN_MAX float x[kTileWidth], y[kTileWidth];
};

/// atan t for 0 <= t <= 1: minimax polynomial in t^2, absolute error below 4e-8, below 1.4e-7 with rounding.
HWY_INLINE V atan_to_one(D d, V t) {
    const V a = hn::Mul(t, t);
    V r = hn::Set(d, -0.004054567139f);
    for (const float c : {0.0218629576f, -0.05591232636f, 0.09642197297f, -0.1390862954f, 0.1994656565f,
                          -0.3332986078f, 0.9999993356f})
        r = hn::MulAdd(r, a, hn::Set(d, c));
    return hn::Mul(r, t);
}

HWY_INLINE V atan2(D d, V y, V x) {
    constexpr float kHalfTurn = 3.14159265f, kQuarterTurn = 1.57079633f;
    const V ax = hn::Abs(x), ay = hn::Abs(y);
    V r = atan_to_one(d, hn::Div(hn::Min(ax, ay), hn::Max(ax, ay)));
    r = hn::IfThenElse(hn::Gt(ay, ax), hn::Sub(hn::Set(d, kQuarterTurn), r), r);
    r = hn::IfThenElse(hn::Lt(x, hn::Zero(d)), hn::Sub(hn::Set(d, kHalfTurn), r), r);
    return hn::CopySign(r, y);
}

/// Sine and cosine for |t| below some turns: the nearest quarter turn is taken off in two parts, Taylor
/// polynomials do the rest. Absolute error about 1e-7.
HWY_INLINE void sin_cos(D d, V t, V& sin, V& cos) {
    const V quarters = hn::Round(hn::Mul(t, hn::Set(d, 0.636619772f)));
    const V r = hn::NegMulAdd(quarters, hn::Set(d, -4.37113883e-8f),
                              hn::NegMulAdd(quarters, hn::Set(d, 1.57079637f), t));
    const V a = hn::Mul(r, r);
    const auto polynomial = [&](std::initializer_list<float> c) {
        V sum = hn::Zero(d);
        for (const float k : c) sum = hn::MulAdd(sum, a, hn::Set(d, k));
        return sum;
    };
    const V s = hn::Mul(r, polynomial({2.7557319e-6f, -1.9841270e-4f, 8.3333333e-3f, -0.16666667f, 1.0f}));
    const V c = polynomial({2.4801587e-5f, -1.3888889e-3f, 4.1666667e-2f, -0.5f, 1.0f});
    const DI di;
    const auto whole = hn::ConvertTo(di, quarters);
    const auto odd = hn::RebindMask(d, hn::Ne(hn::And(whole, hn::Set(di, 1)), hn::Zero(di)));
    const auto half_turn = hn::BitCast(d, hn::ShiftLeft<30>(hn::And(whole, hn::Set(di, 2))));
    const auto of_cos =
        hn::BitCast(d, hn::ShiftLeft<30>(hn::And(hn::Add(whole, hn::Set(di, 1)), hn::Set(di, 2))));
    sin = hn::Xor(hn::IfThenElse(odd, c, s), half_turn);
    cos = hn::Xor(hn::IfThenElse(odd, s, c), of_cos);
}

/// The map in float.
struct FloatMap {
    explicit FloatMap(const PlainView& view)
        : target(view.target),
          face_height(view.height / view.faces),
          cylinder(view.cylinder),
          last_row(static_cast<float>(view.source_height)),
          step(static_cast<float>(view.step)),
          first_x(static_cast<float>(view.first_x)),
          first_y(static_cast<float>(view.first_y)),
          scale_x(static_cast<float>(view.scale_x)),
          scale_y(static_cast<float>(view.scale_y)),
          centre_x(static_cast<float>(0.5 * view.source_width - 0.5)),
          centre_y(static_cast<float>(0.5 * view.source_height - 0.5)) {
        std::copy_n(&view.rotation[0][0], 9 * view.faces, &rotation[0][0]);
    }

    /// Source points of the pixels (i + lane, j), texel centres at whole numbers.
    HWY_INLINE void operator()(D d, int i, int j, V& x, V& y) const {
        const float* r = rotation[j / face_height];
        const V lanes = hn::Iota(d, 0.0f);
        const V u = hn::MulAdd(hn::Add(lanes, hn::Set(d, static_cast<float>(i))), hn::Set(d, step),
                               hn::Set(d, first_x));
        const float v = first_y + static_cast<float>(j % face_height) * step;
        V rx, ry, rz;
        if (target == Projection::rectilinear || target == Projection::cubemap) {
            rx = hn::MulAdd(u, hn::Set(d, r[0]), hn::Set(d, r[1] * v + r[2]));
            ry = hn::MulAdd(u, hn::Set(d, r[3]), hn::Set(d, r[4] * v + r[5]));
            rz = hn::MulAdd(u, hn::Set(d, r[6]), hn::Set(d, r[7] * v + r[8]));
        } else {
            V a, b, c;
            ray(d, u, v, a, b, c);
            const auto turned = [&](const float* row) {
                return hn::MulAdd(a, hn::Set(d, row[0]),
                                  hn::MulAdd(b, hn::Set(d, row[1]), hn::Mul(c, hn::Set(d, row[2]))));
            };
            rx = turned(r), ry = turned(r + 3), rz = turned(r + 6);
        }
        const V rho = hn::Sqrt(hn::MulAdd(rx, rx, hn::Mul(rz, rz)));
        const V down = cylinder ? hn::Div(ry, rho) : atan2(d, ry, rho);
        x = hn::MulAdd(atan2(d, rx, rz), hn::Set(d, scale_x), hn::Set(d, centre_x));
        y = hn::MulAdd(down, hn::Set(d, scale_y), hn::Set(d, centre_y));
        y = hn::Min(hn::Max(y, hn::Set(d, -1.0f)), hn::Set(d, last_row));
    }

    /// The target's ray of a point of its plane, of a projection that is not flat.
    HWY_INLINE void ray(D d, V u, float v, V& x, V& y, V& z) const {
        if (target == Projection::stereographic) {
            x = u, y = hn::Set(d, v);
            z = hn::MulAdd(hn::Mul(u, u), hn::Set(d, -0.25f), hn::Set(d, 1 - 0.25f * v * v));
        } else if (target == Projection::fisheye) {
            const V angle = hn::Sqrt(hn::MulAdd(u, u, hn::Set(d, v * v)));
            V sin;
            sin_cos(d, angle, sin, z);
            const V k = hn::Div(sin, hn::Max(angle, hn::Set(d, 1e-20f)));
            x = hn::Mul(u, k), y = hn::Mul(hn::Set(d, v), k);
        } else {
            sin_cos(d, u, x, z);
            const float latitude = target == Projection::mercator ? std::atan(std::sinh(v)) : v;
            const V cos_v = hn::Set(d, std::cos(latitude));
            x = hn::Mul(x, cos_v), y = hn::Set(d, std::sin(latitude)), z = hn::Mul(z, cos_v);
        }
    }

    Projection target;
    int face_height;
    bool cylinder;
    float last_row, step, first_x, first_y, scale_x, scale_y, centre_x, centre_y;
    float rotation[6][9];
};

/// The taps of as many pixels as a vector holds, pixel k of the row being (i + k, j).
HWY_INLINE void compute_taps(const FloatMap& map, int i, int j, int k, std::int32_t row_floats,
                             RowTaps& taps) {
    const D d;
    const DI di;
    V x, y;
    map(d, i + k, j, x, y);
    const V left = hn::Floor(x), top = hn::Floor(y);
    hn::Store(hn::Sub(x, left), d, taps.x + k);
    hn::Store(hn::Sub(y, top), d, taps.y + k);
    // The bits of n + 1.5 * 2^23 are kBits + n; integers wrap, so one constant takes kBits out of both terms.
    constexpr std::uint32_t kBits = 0x4B400000;
    const auto bits = [&](V n) { return hn::BitCast(di, hn::Add(n, hn::Set(d, 12582912.0f))); };
    const auto none = static_cast<std::int32_t>(kBits + kBits * (static_cast<std::uint32_t>(row_floats) / 3));
    const auto rows = hn::Mul(bits(top), hn::Set(di, row_floats));
    const auto columns = hn::Sub(bits(left), hn::Set(di, none));
    hn::Store(hn::Add(rows, hn::Add(columns, hn::Add(columns, columns))), di, taps.offset + k);
}

/// Of texels far apart each pixel's own; elsewhere one in four is in every cache line, and the upper row came before.
HWY_INLINE void prefetch(const RowTaps& taps, const float* origin, std::ptrdiff_t row_floats, bool apart) {
    constexpr int kPixelsPerLine = 4;
    const float* below = origin + row_floats;
    if (apart) {
        for (int k = 0; k < kTileWidth; ++k) {
            simd::prefetch_to_second_level(origin + taps.offset[k]);
            simd::prefetch_to_second_level(below + taps.offset[k]);
        }
        return;
    }
    for (int k = 0; k < kTileWidth; k += kPixelsPerLine) hwy::Prefetch(below + taps.offset[k]);
}

/// Bilinear samples of three channels to `row`, which has room for one float more.
HWY_INLINE void sample(const RowTaps& taps, int first, int count, const float* origin,
                       std::int32_t row_floats, float* row) {
#if HWY_MAX_BYTES >= 32
    const hn::FixedTag<float, 4> d4;
    const hn::FixedTag<float, 8> d8;
    HWY_ALIGN static constexpr std::int32_t kRight[8] = {3, 4, 5, 6, 7, 7, 7, 7};
    const auto right = hn::SetTableIndices(d8, kRight);
    HWY_UNROLL(16)
    for (int k = first; k < first + count; ++k) {
        // Both taps of a texel row by one load: r g b r g b.
        const float* p = origin + taps.offset[k];
        const auto above = hn::LoadU(d8, p), below = hn::LoadU(d8, p + row_floats);
        const auto both = hn::MulAdd(hn::Set(d8, taps.y[k]), hn::Sub(below, above), above);
        const auto a = hn::LowerHalf(d4, both), b = hn::LowerHalf(d4, hn::TableLookupLanes(both, right));
        hn::StoreU(hn::MulAdd(hn::Set(d4, taps.x[k]), hn::Sub(b, a), a), d4, row + 3 * k);
    }
#else
    for (int k = first; k < first + count; ++k) {
        const float *a = origin + taps.offset[k], *b = a + row_floats;
        for (int c = 0; c < 3; ++c) {
            const float left = a[c] + taps.y[k] * (b[c] - a[c]);
            const float right = a[c + 3] + taps.y[k] * (b[c + 3] - a[c + 3]);
            row[3 * k + c] = left + taps.x[k] * (right - left);
        }
    }
#endif
}

HWY_INLINE void stream_row(const float* row, float* to) {
    const D d;
    for (std::size_t k = 0; k < 3 * kTileWidth; k += hn::Lanes(d))
        hn::Stream(hn::Load(d, row + k), d, to + k);
}

/// The tiles of one strip of the picture. Coordinates run kAhead rows ahead of the samples, which gives the
/// prefetches their time; a row is streamed after the next one is sampled, when its stores have reached the
/// cache.
void draw_strip(const PlainView& view, const float* origin, std::ptrdiff_t row_floats, float* picture,
                int strip) {
    constexpr int kAhead = 3;
    const FloatMap map(view);
    // More than three texels a pixel, in the middle of the view.
    const bool apart = view.step * view.scale_x * view.step * view.scale_y > 3;
    const int width = view.width, top = strip * kTileHeight, rows = std::min(kTileHeight, view.height - top);
    const int steps = (width + kTileWidth - 1) / kTileWidth * rows;
    const int lanes = static_cast<int>(hn::Lanes(D()));
    const auto stride = static_cast<std::int32_t>(row_floats);
    RowTaps taps[kAhead + 1];
    HWY_ALIGN_MAX float drawn[2][3 * kTileWidth + 16];
    const auto finish = [&](int step) {
        const int left = step / rows * kTileWidth, j = top + step % rows;
        float* to = picture + 3 * (static_cast<std::ptrdiff_t>(j) * width + left);
        if (width % kTileWidth == 0)
            stream_row(drawn[step & 1], to);
        else
            std::memcpy(to, drawn[step & 1],
                        static_cast<std::size_t>(std::min(kTileWidth, width - left)) * 12);
    };
    for (int step = 0; step < steps + kAhead; ++step) {
        RowTaps& next = taps[step % (kAhead + 1)];
        const int now = step - kAhead;
        const RowTaps& current = taps[(now + kAhead + 1) % (kAhead + 1)];
        // Arithmetic and loads side by side.
        for (int k = 0; k < kTileWidth; k += lanes) {
            if (step < steps) compute_taps(map, step / rows * kTileWidth, top + step % rows, k, stride, next);
            if (now >= 0) sample(current, k, lanes, origin, stride, drawn[now & 1]);
        }
        if (step < steps) prefetch(next, origin, row_floats, apart);
        if (now > 0) finish(now - 1);
    }
    finish(steps - 1);
}

void points(const PlainView& view, Point<float>* to) {
    const D d;
    const FloatMap map(view);
    const int lanes = static_cast<int>(hn::Lanes(d));
    HWY_ALIGN_MAX float x[kTileWidth], y[kTileWidth];
    for (int j = 0; j < view.height; ++j)
        for (int i = 0; i < view.width; i += lanes) {
            V vx, vy;
            map(d, i, j, vx, vy);
            hn::Store(vx, d, x);
            hn::Store(vy, d, y);
            for (int k = 0; k < std::min(lanes, view.width - i); ++k) *to++ = {x[k] + 0.5f, y[k] + 0.5f};
        }
}

void read_and_fill(const std::byte* source, std::size_t read, std::byte* target, std::size_t written) {
    const hn::ScalableTag<std::uint32_t> d;
    const std::size_t lanes = hn::Lanes(d);
    const auto* from = reinterpret_cast<const std::uint32_t*>(source);
    auto* to = reinterpret_cast<std::uint32_t*>(target);
    auto sum = hn::Zero(d);
    for (std::size_t k = 0; k < read / 4; k += lanes) sum = hn::Add(sum, hn::Load(d, from + k));
    for (std::size_t k = 0; k < written / 4; k += lanes) hn::Stream(sum, d, to + k);
}

const char* target() {
    return hwy::TargetName(HWY_TARGET);
}

}  // namespace anamorph::bench::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::bench {

HWY_EXPORT(draw_strip);
HWY_EXPORT(points);
HWY_EXPORT(read_and_fill);
HWY_EXPORT(target);

void draw_simd_exact(const PlainView& view, const PaddedSource& source, float* picture,
                     const ParallelFor& parallel_for) {
    parallel_for((view.height + kSimdTileHeight - 1) / kSimdTileHeight, [&](std::int64_t strip) {
        HWY_DYNAMIC_DISPATCH(draw_strip)
        (view, source.origin, source.row_floats, picture, static_cast<int>(strip));
        hwy::FlushStream();
    });
}

std::vector<Point<float>> simd_exact_points(const PlainView& view) {
    std::vector<Point<float>> all(static_cast<std::size_t>(view.width) *
                                  static_cast<std::size_t>(view.height));
    HWY_DYNAMIC_DISPATCH(points)(view, all.data());
    return all;
}

std::string simd_target() {
    return HWY_DYNAMIC_DISPATCH(target)();
}

void stream(const std::byte* source, std::size_t read, std::byte* target, std::size_t written) {
    HWY_DYNAMIC_DISPATCH(read_and_fill)(source, read, target, written);
}

}  // namespace anamorph::bench
#endif
