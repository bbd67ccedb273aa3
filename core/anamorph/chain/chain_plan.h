// SPDX-License-Identifier: Apache-2.0
// The blocks of a chain of maps.
#pragma once

#include "anamorph/chain/chain_map.h"
#include "anamorph/plan/formula_plan.h"
#include "anamorph/plan/partial_pixels.h"

namespace anamorph {

extern template class FormulaPlan<ChainMap>;

class ChainPlan final : public FormulaPlan<ChainMap>, public PartialPixels {
  public:
    using FormulaPlan<ChainMap>::FormulaPlan;

    Jacobian jacobian(double x, double y, int piece) const noexcept override {
        return map().jacobian(x, y, piece);
    }

    /// By the maps' derivatives in the middle of a pixel: edges are straight lines in it, and so is where a map of a picture in the middle
    /// ends (a lens, the rim of a fisheye's circle, what lies behind a camera).
    void find(const Box& block, int piece, const Box& part, std::vector<PartialPixel>& pixels) const override;
};

}  // namespace anamorph
