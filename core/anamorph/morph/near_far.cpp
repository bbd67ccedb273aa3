// SPDX-License-Identifier: Apache-2.0
// The maps of a morph by near/far: plans of regions as blocks, and the points of blocks.
//
// The proof of the bound stands where its parts are computed: what interpolation is off by in
// near_far_interpolation.cpp, by facts about interpolation at Chebyshev's nodes; what rounding to float adds
// in near_far_rounding.cpp, by counting; that a cell is kept only where both together hold the tolerance in
// near_far_subdivider.cpp; what rounding in double is off by, where no cell holds it, in near_far_exact.cpp.
#include "anamorph/morph/near_far.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anamorph/morph/near_far_line.h"
#include "anamorph/morph/near_far_subdivider.h"
#include "anamorph/plan/scheme.h"
#include "anamorph/room_pool.h"

namespace anamorph {

using namespace near_far;

namespace {

// A line's rates are rounded to floats, off by u of themselves or by 2^-126 where they are less than that,
// four of them at most in a slope; then the slope itself is, by u. 2 u in all, and 84 times as much is
// allowed.
constexpr double kSlopeRounding = 1e-5, kSlopeUnderflow = 1e-12;

}  // namespace

struct NearFar::State {
    FeatureMap map;  ///< along_curve
    NearFarOptions options;
    Chebyshev chebyshev;
    std::vector<float> slopes;  ///< line by line: the most that its displacement changes over a pixel
    RoomPool<NearFarSubdivider> subdividers;  ///< which keep their memory from region to region

    State(const FeatureMap& given, const NearFarOptions& near_far)
        : map(given.along_curve()), options(near_far), chebyshev(degree_for(near_far.tol)) {
        if (options.tol == 0) return;
        constexpr double kNowhere[kComponents] = {};
        for (std::size_t i = 0; i < map.size(); ++i) {
            const FieldLine l = seen_from(map, i, options.shapes, 0, 0, kNowhere, 1);
            double slope = 0;
            for (int c = 0; c < kComponents; c += 2) {
                const auto length = [](float x, float y) {
                    return std::sqrt(static_cast<double>(x) * static_cast<double>(x) +
                                     static_cast<double>(y) * static_cast<double>(y));
                };
                slope =
                    std::max(slope, length(l.right[c], l.right[c + 1]) + length(l.down[c], l.down[c + 1]));
            }
            slopes.push_back(static_cast<float>(slope * (1 + kSlopeRounding) + kSlopeUnderflow));
        }
    }
};

NearFar::NearFar(const FeatureMap& map, const NearFarOptions& options)
    : FeatureBlocks(map, options.shapes, options.overscan) {
    check_tol(options.tol);
    m_state = std::make_unique<State>(map, options);
}
NearFar::~NearFar() = default;

void NearFar::plan(const Box& box, int, Blocks& blocks) const {
    const double tol = m_state->options.tol;
    if (tol == 0) {
        each_square(box, [&](const Box& square) { add_exact(square, tol, blocks); });
        return;
    }
    const auto region = std::make_shared<Region>();
    State& state = *m_state;
    auto subdivider = state.subdividers.take([&] {
        return std::make_unique<NearFarSubdivider>(state.map, state.options, state.chebyshev, state.slopes);
    });
    subdivider->plan(region_corner(box.x0, kRegion), region_corner(box.y0, kRegion), *region);
    state.subdividers.give_back(std::move(subdivider));

    blocks.reserve(region->cells.size() * static_cast<std::size_t>(layers()));
    for (std::size_t i = 0; i < region->cells.size(); ++i) {
        const Cell& cell = region->cells[i];
        if (cell.exact)
            add_exact(cell.box, tol, blocks);
        else
            for (int k = 0; k < layers(); ++k) {
                Block block;
                block.box = cell.box;
                block.kind = Block::Kind::computed;
                block.piece = k;
                block.base_x = cell.base[2 * k];
                block.base_y = cell.base[2 * k + 1];
                block.bound = cell.bound;
                block.data = region.get();
                block.record = static_cast<int>(i);
                blocks.push_back(block);
            }
    }
    blocks.data = region;
}

namespace {

/// Pixels `part` of a cell, for all layers: x and y of the first from to[0] and to[1] on, and so on.
void cell_points(const FeatureMap& map, const std::vector<int>& shapes, int degree, const Region& region,
                 const Cell& cell, const Box& part, float* const* to, std::ptrdiff_t stride) {
    // In the frame of the cell's centre.
    simd::FieldCell field{{0, 0, cell.frame.half},
                          0,
                          nullptr,
                          region.lines.data() + cell.near,
                          cell.near_count,
                          {static_cast<float>(map.weights().a), static_cast<float>(map.weights().b)},
                          cell.fine};
    if (cell.coefficients != std::numeric_limits<std::size_t>::max()) {
        field.k = degree;
        field.coefficients = region.coefficients.data() + cell.coefficients;
    }
    // Regions stand on multiples of their size, a power of two, before the picture as well.
    const auto from_center = [](int pixel, float center) {
        return static_cast<float>((pixel & (kRegion - 1)) + 0.5 - kHalfRegion - static_cast<double>(center));
    };
    simd::FieldOutput out{};
    out.x = from_center(part.x0, cell.frame.x);
    out.y = from_center(part.y0, cell.frame.y);
    out.width = part.width();
    out.height = part.height();
    out.components = 2 * static_cast<int>(shapes.size());
    out.stride = stride;
    for (std::size_t n = 0; n < shapes.size(); ++n) {
        const Point<double> scale = map.scale(shapes[n]);
        for (std::size_t axis = 0; axis < 2; ++axis) {
            const std::size_t c = 2 * n + axis;
            const double slope = axis ? scale.y : scale.x;
            const double center = static_cast<double>(axis ? cell.frame.y : cell.frame.x);
            out.slope[c] = static_cast<float>(slope);
            out.offset[c] = static_cast<float>(region.origin[c] + slope * center - cell.base[c]);
            out.to[c] = to[c];
        }
    }
    simd::field_points(field, out);
}

}  // namespace

void NearFar::computed(std::span<const Block> layers, const PointRows* to) const noexcept {
    const auto& region = static_cast<const Region&>(*layers.front().data);
    float* planes[kComponents] = {};
    for (std::size_t k = 0; k < layers.size(); ++k) {
        planes[2 * k] = to[k].x;
        planes[2 * k + 1] = to[k].y;
    }
    cell_points(map(), shapes(), m_state->chebyshev.k, region,
                region.cells[static_cast<std::size_t>(layers.front().record)], layers.front().box, planes,
                to->stride);
}

void NearFar::computed_row(const Block& block, int row, int begin, int end, float* x,
                           float* y) const noexcept {
    const auto& region = static_cast<const Region&>(*block.data);
    const Box& box = block.box;
    constexpr int kRoom = Block::kMaxSide + 16;
    float others[2][kRoom];
    // What the other layer has there comes with it and is not wanted.
    float* planes[kComponents] = {others[0], others[1], others[0], others[1]};
    planes[2 * layer_of(block)] = x;
    planes[2 * layer_of(block) + 1] = y;
    cell_points(map(), shapes(), m_state->chebyshev.k, region,
                region.cells[static_cast<std::size_t>(block.record)],
                {box.x0 + begin, box.y0 + row, box.x0 + end, box.y0 + row + 1}, planes, kRoom);
}

}  // namespace anamorph
