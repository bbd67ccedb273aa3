// SPDX-License-Identifier: Apache-2.0
// Blocks that are read pixel by pixel near their middles: each with its bases, and the bound that comes with them.
#pragma once

#include <algorithm>
#include <span>
#include <type_traits>

#include "anamorph/plan/block_writer.h"
#include "anamorph/plan/boxes.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph::plan_detail {

// The least pixels of a direct block, whose bases cost as much as some tens of them: in float, where double would need fewer
// blocks; and where nothing larger holds the tolerance.
inline constexpr int kLeastInFloat = 512, kLeastDirect = 128;

/// The records that a region's direct blocks are read with.
template <class Local>
struct DirectRecords {
    struct Reading {
        Local place;
        std::size_t first, count;  ///< position and number of its bases
        Point<double> middle;
    };

    std::vector<Reading> readings;
    std::vector<float> in_float;
    std::vector<double> in_double;

    /// Appends a reading with its bases in Real. Returns the reading's number.
    template <class Real>
    int add(const Local& place, const NearReading& found, const Bases& bases) {
        auto& all = all_of<Real>(*this);
        readings.push_back({place, all.size(), bases.size(), found.middle});
        all.insert(all.end(), bases.begin(), bases.end());
        return static_cast<int>(readings.size()) - 1;
    }
    template <class Real>
    NearBlock<Local, Real> at(int record) const {
        const Reading& r = readings[static_cast<std::size_t>(record)];
        return {r.place, r.middle, {all_of<Real>(*this).data() + r.first, r.count}};
    }

  private:
    template <class Real, class Self>
    static auto& all_of(Self& self) {
        if constexpr (std::is_same_v<Real, float>)
            return self.in_float;
        else
            return self.in_double;
    }
};

/// Makes the turn that brings a block's middle into an image that closes on itself; of others the period is
/// 0.
inline void turn_into_image(Block& block, int period) {
    if (period > 0)
        block.base_x -= static_cast<int>(std::floor(static_cast<double>(block.base_x) / period)) * period;
}

/// Is a block read as its bases are written?
template <class Real>
bool is_read_as_written(const NearReading& found, const ReadOrders& orders) {
    return found.order == (std::is_same_v<Real, float> ? orders.in_float : orders.in_double);
}
/// Reads the middle of a box for blocks of its size. The error is infinite where blocks would read other bases than these.
template <class Real, class Map>
NearReading read_near(const Map& map, const Box& box, const typename Map::Local& local,
                      const ReadOrders& orders, Bases& bases) {
    bases.clear();
    NearReading found = map.template direct<Real>(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1),
                                                  half(box.width()), half(box.height()), local, bases);
    if (!is_read_as_written<Real>(found, orders)) found.error = HUGE_VAL;
    return found;
}
/// May parts in float of a box that is off by `error` keep the tolerance, and pay? A known error falls at least as the sides,
/// and these as the root of the pixels; large boxes, whose bounds count their width many times over, have an error that
/// falls as the square of the pixels.
inline bool serves_in_float(const Box& box, double error, double tol) {
    const double times = static_cast<double>(box.width()) * box.height() / kLeastInFloat;
    return error <= tol * std::max({1.0, std::sqrt(times), square(times / 2)});
}

/// Makes direct blocks of what a plan leaves to them.
template <class Map>
class DirectBlocks {
  public:
    using Local = typename Map::Local;

    DirectBlocks(const Map& map, double goal, const ReadOrders& orders, DirectRecords<Local>& records)
        : m_map(map), m_goal(goal), m_orders(orders), m_records(records) {}

    /// Appends the blocks of a block that lies on one branch of the map; exact ones where no direct one holds
    /// the tolerance.
    void place(const Block& left, Blocks& blocks) {
        const Box& box = left.box;
        const Local local = m_map.local_around(0.5 * (box.x0 + box.x1), 0.5 * (box.y0 + box.y1), left.piece);
        if (!left.precise) {
            const double error = read<float>(left, local, blocks);
            if (error <= m_goal) return;
            // What has no bound in float has none in double.
            if (!(error < HUGE_VAL) || serves_in_float(box, error, m_goal)) return halve(left, blocks);
        }
        if (!(read<double>(left, local, blocks) <= m_goal)) halve(left, blocks);
    }

    /// The blocks of a plan, with the direct ones made.
    Blocks placed(const Blocks& planned) {
        Blocks blocks;
        blocks.reserve(planned.size());
        for (const Block& block : planned)
            if (block.kind == Block::Kind::computed)
                place(block, blocks);
            else
                blocks.push_back(block);
        return blocks;
    }

  private:
    /// Appends the block in Real if it holds the tolerance. Returns its error.
    template <class Real>
    double read(const Block& left, const Local& local, Blocks& blocks) {
        constexpr bool kPrecise = std::is_same_v<Real, double>;
        const NearReading found = read_near<Real>(m_map, left.box, local, m_orders, m_bases);
        if (!BlockWriter(m_goal, blocks).computed(left.box, found.middle, found.error, kPrecise))
            return found.error > m_goal ? found.error : HUGE_VAL;
        Block& block = blocks.back();
        block.record = m_records.template add<Real>(local, found, m_bases);
        block.data = left.data;
        block.piece = left.piece;
        block.source_piece = m_map.source_piece(local);
        turn_into_image(block, m_map.period());
        return block.bound;
    }
    /// Places the halves of a block. Halves that both came out exact are one block.
    void halve(const Block& left, Blocks& blocks) {
        const std::size_t first = blocks.size();
        Block half = left;
        const bool is_small = left.box.width() * left.box.height() < 2 * kLeastDirect;
        for (const bool second : {false, true}) {
            if (is_small) break;
            half.box = sub_box(left.box, left.box.width() > left.box.height(), second);
            place(half, blocks);
        }
        const auto is_exact = [](const Block& b) { return b.kind == Block::Kind::exact; };
        if (!std::all_of(blocks.begin() + static_cast<std::ptrdiff_t>(first), blocks.end(), is_exact)) return;
        blocks.resize(first);
        half = {};
        half.box = left.box;
        half.piece = left.piece;
        half.kind = Block::Kind::exact;
        blocks.push_back(half);
    }

    const Map& m_map;
    double m_goal;
    ReadOrders m_orders;
    DirectRecords<Local>& m_records;
    Bases m_bases;
};

}  // namespace anamorph::plan_detail
