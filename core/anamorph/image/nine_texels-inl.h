// SPDX-License-Identifier: Apache-2.0
// Two or four bilinear taps that lie within half a texel of a point read no more than the nine texels about the one that
// it falls into: each of these once, by the sum of what the taps give it, in place of four for each tap.
//
// With v in [-1/2, 1/2] from the middle of that texel to the point, along one axis, and o in [-1/2, 1/2] from the point to a tap, s =
// v + o is in [-1, 1]: the tap gives the texel before max(-s, 0), the one behind max(s, 0), and its own what is left of 1. Weights of
// the nine are the sums of products of these. Included once for every instruction set, as Highway's own headers are.
#include <cstddef>
#include <cstdint>

#include "anamorph/image/block_sampler.h"
// Compiled for each instruction set.
#include "anamorph/image/block_rows-inl.h"
#include "hwy/highway.h"

#if defined(ANAMORPH_SIMD_NINE_TEXELS_INL_H_) == defined(HWY_TARGET_TOGGLE)
#ifdef ANAMORPH_SIMD_NINE_TEXELS_INL_H_
#undef ANAMORPH_SIMD_NINE_TEXELS_INL_H_
#else
#define ANAMORPH_SIMD_NINE_TEXELS_INL_H_
#endif

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Do the taps that all pixels share read nine texels?
HWY_INLINE bool ReadNine(const Texels& s) {
    bool all = s.kernel == Kernel::bilinear && (s.tap_count == 2 || s.tap_count == 4);
    for (int i = 0; i < s.tap_count && all; ++i)
        all = s.taps[i].x >= -0.5f && s.taps[i].x <= 0.5f && s.taps[i].y >= -0.5f && s.taps[i].y <= 0.5f;
    return all;
}

/// The weights of a pixel's nine texels but the one in the middle, whose weight is what is left of 1.
struct EightWeights {
    using V = hn::Vec<Floats>;
    V above_left, above, above_right, left, right, below_left, below, below_right;
};

/// The sums of what taps give to the texels around.
class TapSums {
  public:
    using V = hn::Vec<Floats>;

    /// Those of the first tap. share: what each tap has of the pixel.
    HWY_INLINE TapSums(V v_x, V v_y, V share, V x, V y) : m_vx(v_x), m_vy(v_y), m_share(share) {
        const Parts p = PartsOf(x, y);
        m_corner[0] = hn::Mul(p.above, p.left);
        m_corner[1] = hn::Mul(p.above, p.right);
        m_corner[2] = hn::Mul(p.below, p.left);
        m_corner[3] = hn::Mul(p.below, p.right);
        m_before_x = hn::Mul(p.left, m_share);
        m_behind_x = hn::Mul(p.right, m_share);
        m_before_y = p.above;
        m_behind_y = p.below;
    }
    HWY_INLINE void Add(V x, V y) {
        const Parts p = PartsOf(x, y);
        m_corner[0] = Fused(p.above, p.left, m_corner[0]);
        m_corner[1] = Fused(p.above, p.right, m_corner[1]);
        m_corner[2] = Fused(p.below, p.left, m_corner[2]);
        m_corner[3] = Fused(p.below, p.right, m_corner[3]);
        m_before_x = Fused(p.left, m_share, m_before_x);
        m_behind_x = Fused(p.right, m_share, m_behind_x);
        m_before_y = hn::Add(p.above, m_before_y);
        m_behind_y = hn::Add(p.below, m_behind_y);
    }
    HWY_INLINE EightWeights Weights() const {
        const auto& c = m_corner;
        return {c[0],
                hn::Sub(m_before_y, hn::Add(c[0], c[1])),
                c[1],
                hn::Sub(m_before_x, hn::Add(c[0], c[2])),
                hn::Sub(m_behind_x, hn::Add(c[1], c[3])),
                c[2],
                hn::Sub(m_behind_y, hn::Add(c[2], c[3])),
                c[3]};
    }

  private:
    /// What a tap gives along x, and its share of what it gives along y.
    struct Parts {
        V left, right, above, below;
    };
    HWY_INLINE Parts PartsOf(V x, V y) const {
        const auto zero = hn::Zero(Floats());
        const auto s = hn::Add(m_vx, x), t = hn::Add(m_vy, y);
        const auto right = hn::Max(s, zero), down = hn::Max(t, zero);
        return {hn::Sub(right, s), right, hn::Mul(hn::Sub(down, t), m_share), hn::Mul(down, m_share)};
    }

    V m_vx, m_vy, m_share;
    V m_before_x, m_behind_x, m_before_y, m_behind_y, m_corner[4];
};

/// Two or four taps that all pixels share, or four that each has for itself.
class TapsOfRow {
  public:
    HWY_INLINE TapsOfRow(const Texels& s, const Offsets& at)
        : m_count(s.tap_count),
          m_share(hn::Set(Floats(), 1.0f / static_cast<float>(at.own.x_i ? 4 : s.tap_count))),
          m_own(at.own) {
        for (int k = 0; k < 4; ++k) {
            const Tap tap = m_own.x_i || k >= m_count ? Tap{} : s.taps[k];
            m_x[k] = hn::Set(Floats(), tap.x);
            m_y[k] = hn::Set(Floats(), tap.y);
        }
    }

    /// The weights of the pixels from i on, v from the middles of their texels.
    HWY_INLINE EightWeights Weights(hn::Vec<Floats> v_x, hn::Vec<Floats> v_y, int i) const {
        const Floats d;
        if (m_own.x_i) {
            const auto ax = hn::LoadU(d, m_own.x_i + i), ay = hn::LoadU(d, m_own.y_i + i);
            const auto bx = hn::LoadU(d, m_own.x_j + i), by = hn::LoadU(d, m_own.y_j + i);
            const auto px = hn::Add(ax, bx), py = hn::Add(ay, by), qx = hn::Sub(ax, bx), qy = hn::Sub(ay, by);
            TapSums sums(v_x, v_y, m_share, hn::Neg(px), hn::Neg(py));
            sums.Add(qx, qy);
            sums.Add(hn::Neg(qx), hn::Neg(qy));
            sums.Add(px, py);
            return sums.Weights();
        }
        TapSums sums(v_x, v_y, m_share, m_x[0], m_y[0]);
        sums.Add(m_x[1], m_y[1]);
        if (m_count == 4) {
            sums.Add(m_x[2], m_y[2]);
            sums.Add(m_x[3], m_y[3]);
        }
        return sums.Weights();
    }

  private:
    int m_count;
    hn::Vec<Floats> m_share, m_x[4], m_y[4];
    OwnTaps m_own;
};

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#endif
