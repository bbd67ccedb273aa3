// SPDX-License-Identifier: Apache-2.0
#include "anamorph/plan/block.h"

#include <algorithm>
#include <mutex>
#include <optional>
#include <unordered_map>

namespace anamorph {

BlockPolynomial quadratic_of(const Block& block) {
    BlockPolynomial p;
    const auto put = [&](const float* from, int first) {
        p.c[0][first] = from[0];
        p.c[0][first + 1] = from[1];
        p.c[1][first] = from[2];
        p.c[0][first + 2] = from[3];
        p.c[1][first + 1] = from[4];
        p.c[2][first] = from[5];
    };
    put(block.x, 0);
    put(block.y, 4);
    return p;
}

struct BlockMap::Cache {
    explicit Cache(std::size_t most_regions) : most(most_regions) {}

    struct Region {
        std::once_flag once;
        Blocks blocks;
    };
    const std::size_t most;
    std::mutex mutex;
    std::unordered_map<std::int64_t, std::shared_ptr<Region>> regions;
    std::optional<Reached> reached;
};

BlockMap::BlockMap(int width, int height, const std::vector<Box>& pieces, const BlockLayout& layout)
    : m_width(width),
      m_height(height),
      m_layout(layout),
      m_cache(std::make_shared<Cache>(layout.kept_regions)) {
    const int side = layout.region_side;
    for (const Box& box : pieces) {
        const int x0 = region_corner(box.x0, side), y0 = region_corner(box.y0, side);
        const int columns = (box.x1 - x0 + side - 1) / side, rows = (box.y1 - y0 + side - 1) / side;
        m_grids.push_back({box, m_regions, columns, x0, y0});
        m_regions += std::int64_t{columns} * rows;
        m_pixels += std::int64_t{box.width()} * box.height();
    }
}

BlockMap::Place BlockMap::place_of(std::int64_t region) const {
    std::size_t piece = m_grids.size() - 1;
    while (m_grids[piece].first > region) --piece;
    const Grid& grid = m_grids[piece];
    const int side = m_layout.region_side;
    const int x = grid.x0 + static_cast<int>((region - grid.first) % grid.columns) * side;
    const int y = grid.y0 + static_cast<int>((region - grid.first) / grid.columns) * side;
    return {intersection({x, y, x + side, y + side}, grid.box), static_cast<int>(piece)};
}

std::vector<std::int64_t> BlockMap::regions_in(const Box& box) const {
    std::vector<std::int64_t> found;
    for (const Grid& grid : m_grids) {
        const Box part = intersection(box, grid.box);
        if (part.empty()) continue;
        const auto number = [&](int at, int from) { return (at - from) / m_layout.region_side; };
        for (int row = number(part.y0, grid.y0); row <= number(part.y1 - 1, grid.y0); ++row)
            for (int column = number(part.x0, grid.x0); column <= number(part.x1 - 1, grid.x0); ++column)
                found.push_back(grid.first + std::int64_t{row} * grid.columns + column);
    }
    return found;
}

bool BlockMap::covers(const Box& box) const {
    std::int64_t pixels = 0;
    for (const Grid& grid : m_grids) {
        const Box part = intersection(box, grid.box);
        if (!part.empty()) pixels += std::int64_t{part.width()} * part.height();
    }
    return pixels == std::int64_t{box.width()} * box.height();
}

int BlockMap::piece_at(double x, double y) const {
    for (auto grid = m_grids.rbegin(); grid != m_grids.rend(); ++grid)
        if (const Box& box = grid->box; x >= box.x0 && x <= box.x1 && y >= box.y0 && y <= box.y1)
            return static_cast<int>(m_grids.rend() - grid) - 1;
    return -1;
}

SharedBlocks BlockMap::blocks(std::int64_t region) const {
    std::shared_ptr<Cache::Region> found;
    {
        const std::lock_guard lock(m_cache->mutex);
        if (m_cache->regions.size() >= m_cache->most) m_cache->regions.clear();
        std::shared_ptr<Cache::Region>& entry = m_cache->regions[region];
        if (!entry) entry = std::make_shared<Cache::Region>();
        found = entry;
    }
    std::call_once(found->once, [&] {
        const Place place = place_of(region);
        plan(place.box, place.piece, found->blocks);
    });
    return SharedBlocks({found, &found->blocks});
}

Reached BlockMap::reached(const ParallelFor& parallel_for) const {
    {
        const std::lock_guard lock(m_cache->mutex);
        if (m_cache->reached) return *m_cache->reached;
    }
    Reached reached;
    std::int64_t exact = 0;
    std::mutex mutex;
    parallel_for(regions(), [&](std::int64_t region) {
        double bound = 0;
        std::int64_t pixels = 0;
        for (const Block& b : blocks(region)) {
            bound = std::max(bound, b.bound);
            if (is_exact(b)) pixels += std::int64_t{b.box.width()} * b.box.height();
        }
        const std::lock_guard lock(mutex);
        reached.max_error = std::max(reached.max_error, bound);
        exact += pixels;
    });
    reached.exact_fraction = static_cast<double>(exact) / (static_cast<double>(m_pixels) * layers());
    const std::lock_guard lock(m_cache->mutex);
    m_cache->reached = reached;
    return reached;
}

bool BlockMap::seen(double x, double y, int piece) const noexcept {
    Point<double> p{};
    int source_piece = 0;
    return exact(x, y, piece, p, source_piece);
}

bool BlockMap::truth(double x, double y, int piece, Point<DoubleDouble>& source_point,
                     int& source_piece) const noexcept {
    Point<double> p{};
    const bool seen = exact(x, y, piece, p, source_piece);
    source_point = {p.x, p.y};
    return seen;
}

bool BlockMap::exact(const Block& block, double x, double y, Point<double>& source_point,
                     int& source_piece) const noexcept {
    if (!block.precise) return exact(x, y, block.piece, source_point, source_piece);
    Point<DoubleDouble> p{};
    const bool seen = truth(x, y, block.piece, p, source_piece);
    source_point = {static_cast<double>(p.x), static_cast<double>(p.y)};
    return seen;
}

void BlockMap::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    for (int row = begin; row < end; ++row)
        for (int i = 0; i < block.box.width(); ++i) {
            Point<double> at{};
            int piece = 0;
            const bool seen = exact(block, block.box.x0 + i + 0.5, block.box.y0 + row + 0.5, at, piece);
            const std::ptrdiff_t k = (row - begin) * to.stride + i;
            to.x[k] = at.x;
            to.y[k] = at.y;
            to.piece[k] = seen ? piece : -1;
        }
}

BlockPolynomial BlockMap::bicubic(const Block& block) const noexcept {
    return quadratic_of(block);
}

void BlockMap::computed_row(const Block&, int, int begin, int end, float* x, float* y) const noexcept {
    std::fill_n(x, end - begin, 0.0f);
    std::fill_n(y, end - begin, 0.0f);
}

void BlockMap::computed(std::span<const Block> layers, const PointRows* to) const noexcept {
    for (const Block& block : layers) {
        for (int row = 0; row < block.box.height(); ++row)
            computed_row(block, row, 0, block.box.width(), to->x + row * to->stride,
                         to->y + row * to->stride);
        ++to;
    }
}

}  // namespace anamorph
