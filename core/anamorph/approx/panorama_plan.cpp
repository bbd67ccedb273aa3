// SPDX-License-Identifier: Apache-2.0
#include "anamorph/approx/panorama_plan.h"

#include "anamorph/approx/formula_planner.h"
#include "anamorph/simd/panorama_rows.h"

namespace anamorph {

template class FormulaPlan<Panorama>;

void PanoramaPlan::exact_row(const Block& block, int row, ExactPoint* points) const noexcept {
    if (block.precise) return FormulaPlan::exact_row(block, row, points);
    simd::ExactRow found;
    const int count = block.box.width();
    simd::exact_row(map().target(), map().source(), map().turn(), block.piece, block.box.x0 + 0.5,
                    block.box.y0 + row + 0.5, count, found);
    for (int i = 0; i < count; ++i)
        points[i] = {{found.x[i], found.y[i]}, static_cast<int>(found.piece[i]), found.seen[i] != 0};
}

}  // namespace anamorph
