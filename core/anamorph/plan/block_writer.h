// SPDX-License-Identifier: Apache-2.0
// Blocks as plans write them: checked against the tolerance, halved where they miss it.
#pragma once

#include <algorithm>
#include <cmath>

#include "anamorph/number/hypot.h"
#include "anamorph/plan/block.h"

namespace anamorph {

/// The largest distance, in texels of one coordinate, of the point that is sampled from the one given
/// (image/block_sampler.h), less 2^-24 of the offset: x - 1/2 is rounded by at most 2^-24 (|x| + 1/2), and
/// what is left of it past a whole number by 2^-25 just below one, else not at all. Nearest texels are those
/// of the points given.
inline constexpr double kSamplerRounding = 0x1p-24;

/// The farthest that a source point may be; others are none.
inline constexpr double kFarthest = 1 << 30;

/// The largest rounding to float of a term of power n = i + j, of s^i t^j in a block's polynomial, over its
/// size. Every rounding is a factor within 1 -+ u, u = 2^-24. image/block_sampler_lanes.cpp rounds so often,
/// where multiplication and addition round apart (fused, it does so less):
///
/// - 2 times the coefficient: as it is stored, and again in texels of a pyramid's level;
///
/// - 2 n times the powers of s and t, each a whole number (exact) times a rounded reciprocal;
///
/// - 2 n + 2 times in Horner's rule, which multiplies j times by t and adds at most j + 1 times, then i times
/// by s and at most i + 1 times;
///
/// - once as the sampler moves the sum by half a texel.
///
/// The product of these m = 4 n + 5 <= 29 factors is within 1 -+ 1.01 m u: (1 + u)^m <= 1 + x + x^2 with
/// x = m u <= 1. What else is lost does not grow with the block: kSamplerRounding.
constexpr double term_rounding(int n) {
    return (4 * n + 5) * (1.01 * 0x1p-24);
}

/// The largest rounding of a point: that of a polynomial's terms in x and in y with the sampler's own.
inline double point_rounding(double terms_x, double terms_y) {
    const double x = terms_x + kSamplerRounding, y = terms_y + kSamplerRounding;
    return std::sqrt(x * x + y * y);
}

/// Half the distance between the first and the last of a row of pixel centres.
inline double half(int pixels) {
    return pixels > 1 ? 0.5 * (pixels - 1) : 0.5;
}

class BlockWriter {
  public:
    // A block is at most as large as keeps its source and target rows in the first-level cache.
    static constexpr int kWidth = 64, kHeight = 32;
    // The number of exact pixels that cost as much as to plan a polynomial.
    static constexpr int kFloorPixels = 12;

    BlockWriter(double tol, Blocks& blocks) : m_tol(tol), m_blocks(blocks) {}

    static bool below_floor(const Box& box) { return box.width() * box.height() < kFloorPixels; }

    /// Writes an exact block. `bound`: that of the rounding in double.
    void exact(const Box& box, double bound) { add(box, Block::Kind::exact, bound); }
    void outside(const Box& box) { add(box, Block::Kind::outside, 0); }

    /// Writes a quadratic block, coefficients as in Block with the base, if it keeps the tolerance in float,
    /// `error` apart. True if so.
    bool polynomial(const Box& box, const double* x, const double* y, double error) {
        Block block;
        if (!start(box, Block::Kind::polynomial, x, y, block)) return false;
        return finish(block, rounding<6>(x, block.base_x), rounding<6>(y, block.base_y), error);
    }

    /// Writes, if it keeps the tolerance, a bicubic block of total degree 3: coefficients degree by degree
    /// (EconomizedCubic), as the map will give them, with the base.
    bool cubic(const Box& box, const double* x, const double* y, double error) {
        Block block;
        if (!start(box, Block::Kind::bicubic, x, y, block)) return false;
        return finish(block, rounding<10>(x, block.base_x), rounding<10>(y, block.base_y), error);
    }
    /// The largest rounding to float of a cubic.
    static double cubic_rounding(const double* x, const double* y) {
        return point_rounding(rounding<10>(x, std::floor(x[0])), rounding<10>(y, std::floor(y[0])));
    }
    /// Writes, if it keeps the tolerance, a bicubic block of total degree 4 in double: as often rounded, but
    /// for what the sampler does, and once more as the base is added.
    bool precise(const Box& box, const double* x, const double* y, double error) {
        Block block;
        if (!start(box, Block::Kind::bicubic, x, y, block)) return false;
        block.precise = true;
        const auto in_double = [](const double* c, std::int32_t base) {
            return 0x1p-29 * rounding<15>(c, base) + 0x1p-53 * (size(c, base) + std::fabs(double(base)));
        };
        block.bound = error + hypot(in_double(x, block.base_x), in_double(y, block.base_y));
        if (!(block.bound <= m_tol)) return false;
        m_blocks.push_back(block);
        return true;
    }

    /// Writes, if it keeps the tolerance, a bicubic block: coefficients of s^i t^j as the map will give them,
    /// with the base, and the quadratic near it.
    bool bicubic(const Box& box, const double (&x)[4][4], const double (&y)[4][4], const double* near_x,
                 const double* near_y, double error) {
        Block block;
        if (!start(box, Block::Kind::bicubic, near_x, near_y, block)) return false;
        return finish(block, rounding(x, block.base_x), rounding(y, block.base_y), error);
    }

    /// Writes a computed block whose base is `middle` rounded down, if it keeps the tolerance. `error` holds
    /// the rounding of offsets from the base, when they are stored and when the sampler moves them; or that
    /// of points in double.
    bool computed(const Box& box, const Point<double>& middle, double error, bool precise = false) {
        if (!precise) error += point_rounding(0, 0);
        if (!(error <= m_tol && std::fabs(middle.x) < kFarthest && std::fabs(middle.y) < kFarthest))
            return false;
        Block block;
        block.box = box;
        block.kind = Block::Kind::computed;
        block.precise = precise;
        block.base_x = static_cast<std::int32_t>(std::floor(middle.x));
        block.base_y = static_cast<std::int32_t>(std::floor(middle.y));
        block.bound = error;
        m_blocks.push_back(block);
        return true;
    }

    /// Calls body(half) for the halves of a box of at least two pixels; where all that comes of it is exact,
    /// one block.
    template <class Body>
    void halve(const Box& box, bool vertical_cut, const Body& body) {
        const std::size_t first = m_blocks.size();
        if (vertical_cut ? box.width() < 2 : box.height() < 2) vertical_cut = !vertical_cut;
        Box a = box, b = box;
        if (vertical_cut)
            a.x1 = b.x0 = (box.x0 + box.x1) / 2;
        else
            a.y1 = b.y0 = (box.y0 + box.y1) / 2;
        body(a);
        body(b);
        const auto is_exact = [](const Block& block) { return block.kind == Block::Kind::exact; };
        const auto from = m_blocks.begin() + static_cast<std::ptrdiff_t>(first);
        if (!std::all_of(from, m_blocks.end(), is_exact)) return;
        double bound = 0;
        std::for_each(from, m_blocks.end(), [&](const Block& part) { bound = std::max(bound, part.bound); });
        m_blocks.resize(first);
        exact(box, bound);
    }

    /// Calls body(block) for the parts of a box, of at most kWidth x kHeight pixels.
    template <class Body>
    static void for_blocks(const Box& box, const Body& body) {
        for (int y = box.y0; y < box.y1; y += kHeight)
            for (int x = box.x0; x < box.x1; x += kWidth)
                body(Box{x, y, std::min(x + kWidth, box.x1), std::min(y + kHeight, box.y1)});
    }

  private:
    void add(const Box& box, Block::Kind kind, double bound) {
        Block block;
        block.box = box;
        block.kind = kind;
        block.bound = bound;
        m_blocks.push_back(block);
    }

    /// Sets a block's base and quadratic. False where they are too far away.
    static bool start(const Box& box, Block::Kind kind, const double* x, const double* y, Block& block) {
        if (!(std::fabs(x[0]) < kFarthest && std::fabs(y[0]) < kFarthest)) return false;
        block.box = box;
        block.kind = kind;
        block.base_x = static_cast<std::int32_t>(std::floor(x[0]));
        block.base_y = static_cast<std::int32_t>(std::floor(y[0]));
        for (int i = 0; i < 6; ++i) {
            block.x[i] = static_cast<float>(i ? x[i] : x[0] - block.base_x);
            block.y[i] = static_cast<float>(i ? y[i] : y[0] - block.base_y);
        }
        return true;
    }
    bool finish(Block& block, double rounding_x, double rounding_y, double error) {
        block.bound = error + point_rounding(rounding_x, rounding_y);
        if (!(block.bound <= m_tol)) return false;
        m_blocks.push_back(block);
        return true;
    }

    /// The largest rounding to float of a coordinate of a polynomial of total degree 2, 3 or 4.
    template <int Count>
    static double rounding(const double* c, double base) {
        constexpr int kPower[15] = {0, 1, 1, 2, 2, 2, 3, 3, 3, 3, 4, 4, 4, 4, 4};
        double sum = 0;
        for (int i = 0; i < Count; ++i) sum += std::fabs(i ? c[i] : c[0] - base) * term_rounding(kPower[i]);
        return sum;
    }
    /// The largest rounding to float of a coordinate of a bicubic.
    static double rounding(const double (&c)[4][4], std::int32_t base) {
        double sum = 0;
        for (int i = 0; i < 4; ++i)
            for (int j = 0; j < 4; ++j)
                sum += std::fabs(i + j ? c[i][j] : c[0][0] - base) * term_rounding(i + j);
        return sum;
    }

    /// The sum of the magnitudes of the coefficients of a polynomial of total degree 4.
    static double size(const double* c, double base) {
        double sum = std::fabs(c[0] - base);
        for (int i = 1; i < 15; ++i) sum += std::fabs(c[i]);
        return sum;
    }

    double m_tol;
    Blocks& m_blocks;
};

}  // namespace anamorph
