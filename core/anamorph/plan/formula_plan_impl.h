// SPDX-License-Identifier: Apache-2.0
// FormulaPlan, defined. Included only by source files that instantiate it.
#pragma once

#include <algorithm>
#include <memory>

#include "anamorph/parameter/left_out.h"
#include "anamorph/plan/direct_blocks.h"
#include "anamorph/plan/exact_bounds.h"
#include "anamorph/plan/formula_plan.h"
#include "anamorph/plan/map_link.h"
#include "anamorph/plan/subdivider.h"

namespace anamorph {

/// The pieces of a map's target with its overscan.
inline std::vector<Box> with_overscan(std::vector<Box> pieces, const Size& overscan) {
    if (pieces.size() == 1) pieces[0] = widened(pieces[0], overscan);
    return pieces;
}

template <class Map>
FormulaPlan<Map>::FormulaPlan(const Map& map, const PlanOptions& options, const ReadOrders& orders)
    : BlockMap(map.target_size().width, map.target_size().height,
               with_overscan(map.target_pieces(), options.overscan)),
      m_map(map),
      m_options(options),
      m_orders(orders) {
    check_tol(options.tol);
    if (kIsSmall && options.scheme == Scheme::residual) refuse_left_out("scheme=residual");
}

template <class Map>
void FormulaPlan<Map>::plan(const Box& box, int piece, Blocks& blocks) const {
    using namespace plan_detail;
    Blocks planned;
    planned.reserve(2 * kRegion * kRegion / (kBlockWidth * kBlockHeight));
    const auto records = std::make_shared<Records<typename Map::Local>>();
    Subdivider<Map>(m_map, m_options, m_orders, box, piece, planned, *records).plan(box);
    if constexpr (DirectMap<Map>)
        planned = DirectBlocks<Map>(m_map, goal_of(m_options), m_orders, records->direct).placed(planned);
    blocks.reserve(planned.size());
    ExactBounds<Map> exact(m_map, m_options.tol, blocks);
    for (const Block& block : planned)
        if (block.kind == Block::Kind::exact)
            exact.place(block);
        else
            blocks.push_back(block);
    if (!records->terms.empty() || !records->precise.empty() || !records->direct.readings.empty())
        blocks.data = records;
}

template <class Map>
BlockPolynomial FormulaPlan<Map>::bicubic(const Block& block) const noexcept {
    return plan_detail::cubic_of(block);
}

template <class Map>
void FormulaPlan<Map>::exact_rows(const Block& block, int begin, int end,
                                  const DoubleRows& to) const noexcept {
    if (block.kind != Block::Kind::bicubic) return BlockMap::exact_rows(block, begin, end, to);
    for (int row = begin; row < end; ++row) {
        const std::ptrdiff_t at = (row - begin) * to.stride;
        plan_detail::precise_row(block, row, to.x + at, to.y + at);
        std::fill_n(to.piece + at, block.box.width(), block.source_piece);
    }
}

template <class Map>
bool FormulaPlan<Map>::exact(double x, double y, int piece, Point<double>& source_point,
                             int& source_piece) const noexcept {
    return m_map.exact(x, y, piece, source_point, source_piece);
}

template <class Map>
bool FormulaPlan<Map>::truth(double x, double y, int piece, Point<DoubleDouble>& source_point,
                             int& source_piece) const noexcept {
    return m_map.exact(static_cast<DoubleDouble>(x), static_cast<DoubleDouble>(y), piece, source_point,
                       source_piece);
}

template <class Map>
Jacobian FormulaPlan<Map>::jacobian(double x, double y, int piece) const noexcept {
    using J = Jet1<double>;
    const Point<J> p = m_map(J::variable(x, 1, 0), J::variable(y, 0, 1), m_map.local_around(x, y, piece));
    return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
}

template <class Map>
std::shared_ptr<const MapLink> FormulaPlan<Map>::link() const {
    const bool is_free = m_options.scheme == Scheme::automatic || m_options.scheme == Scheme::exact;
    return is_free && !kIsSmall ? std::make_shared<const LinkOf<Map>>(m_map, m_options) : nullptr;
}

template <class Map>
NearBlock<typename Map::Local, float> FormulaPlan<Map>::near_in_float(const Block& block) {
    return plan_detail::near_block<typename Map::Local, float>(block);
}
template <class Map>
NearBlock<typename Map::Local, double> FormulaPlan<Map>::near_in_double(const Block& block) {
    return plan_detail::near_block<typename Map::Local, double>(block);
}

}  // namespace anamorph
