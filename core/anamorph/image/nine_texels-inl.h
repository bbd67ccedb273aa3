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
    HWY_INLINE TapSums(hn::Vec<Floats> v_x, hn::Vec<Floats> v_y, int taps)
        : m_vx(v_x), m_vy(v_y), m_share(hn::Set(Floats(), 1.0f / static_cast<float>(taps))) {
        m_before_x = m_behind_x = m_before_y = m_behind_y = hn::Zero(Floats());
        m_corner[0] = m_corner[1] = m_corner[2] = m_corner[3] = m_before_x;
    }
    HWY_INLINE void Add(hn::Vec<Floats> x, hn::Vec<Floats> y) {
        const auto zero = hn::Zero(Floats());
        const auto s = hn::Add(m_vx, x), t = hn::Add(m_vy, y);
        const auto right = hn::Max(s, zero), left = hn::Sub(right, s);
        const auto down = hn::Max(t, zero);
        const auto below = hn::Mul(down, m_share), above = hn::Mul(hn::Sub(down, t), m_share);
        m_corner[0] = Fused(above, left, m_corner[0]);
        m_corner[1] = Fused(above, right, m_corner[1]);
        m_corner[2] = Fused(below, left, m_corner[2]);
        m_corner[3] = Fused(below, right, m_corner[3]);
        m_before_x = Fused(left, m_share, m_before_x);
        m_behind_x = Fused(right, m_share, m_behind_x);
        m_before_y = hn::Add(above, m_before_y);
        m_behind_y = hn::Add(below, m_behind_y);
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
    hn::Vec<Floats> m_vx, m_vy, m_share;
    hn::Vec<Floats> m_before_x, m_behind_x, m_before_y, m_behind_y, m_corner[4];
};

/// Taps that all pixels share, or that each has for itself.
class TapsOfRow {
  public:
    HWY_INLINE TapsOfRow(const Texels& s, const Offsets& at)
        : m_taps(s.taps), m_count(s.tap_count), m_own(at.own) {}

    /// The weights of the pixels from i on, v from the middles of their texels.
    HWY_INLINE EightWeights Weights(hn::Vec<Floats> v_x, hn::Vec<Floats> v_y, int i) const {
        const Floats d;
        TapSums sums(v_x, v_y, m_own.x_i ? 4 : m_count);
        if (m_own.x_i) {
            const auto ax = hn::LoadU(d, m_own.x_i + i), ay = hn::LoadU(d, m_own.y_i + i);
            const auto bx = hn::LoadU(d, m_own.x_j + i), by = hn::LoadU(d, m_own.y_j + i);
            const auto px = hn::Add(ax, bx), py = hn::Add(ay, by), qx = hn::Sub(ax, bx), qy = hn::Sub(ay, by);
            sums.Add(hn::Neg(px), hn::Neg(py));
            sums.Add(qx, qy);
            sums.Add(hn::Neg(qx), hn::Neg(qy));
            sums.Add(px, py);
        } else {
            for (int k = 0; k < m_count; ++k) sums.Add(hn::Set(d, m_taps[k].x), hn::Set(d, m_taps[k].y));
        }
        return sums.Weights();
    }

  private:
    const Tap* m_taps;
    int m_count;
    OwnTaps m_own;
};

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#endif
