// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chain/chain_plan.h"

#include "anamorph/chain/middle_edges.h"
#include "anamorph/plan/formula_plan_impl.h"

namespace anamorph {

template class FormulaPlan<ChainMap>;

void ChainPlan::find(const Box& block, int piece, const Box& part, std::vector<PartialPixel>& pixels) const {
    using D = Jet1<double>;
    const Interval x(block.x0, block.x1), y(block.y0, block.y1);
    const ChainMap::Way way = map().way_of(x, y, piece);
    if (map().is_clear_beyond(way)) return;
    const auto at = [](double px, double py) {
        return Point<D>{D::variable(px, 1, 0), D::variable(py, 0, 1)};
    };
    // Where no map ends only pixels that an edge may cross need to be looked at.
    const bool may_end = map().ends_beyond(way);
    const std::optional<EdgesOverBox> near = may_end ? std::nullopt : map().edges_over(block, piece, way);
    std::vector<D> edges;
    for (int j = part.y0; j < part.y1; ++j)
        for (int i = part.x0; i < part.x1; ++i) {
            const Cover cover = near ? near->cover({i, j, i + 1, j + 1}) : Cover::mixed;
            if (cover == Cover::inside || cover == Cover::outside) continue;
            edges.clear();
            const Point<D> p = at(i + 0.5, j + 0.5);
            const bool has_point = !may_end || map().add_ends_beyond(p, piece, way, edges);
            // Beyond an end of a map nothing is known of what follows.
            if (!map().add_edges(p, piece, way, edges) && (has_point || edges.empty())) continue;
            const PartialPixel pixel = part_within(i, j, edges);
            if (pixel.share > 0 && pixel.share < 1) pixels.push_back(pixel);
        }
}

}  // namespace anamorph
