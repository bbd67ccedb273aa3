// SPDX-License-Identifier: Apache-2.0
// The blocks of a panorama's pull map.
#pragma once

#include "anamorph/approx/formula_plan.h"
#include "anamorph/map/panorama.h"

namespace anamorph {

extern template class FormulaPlan<Panorama>;

class PanoramaPlan final : public FormulaPlan<Panorama> {
  public:
    using FormulaPlan::exact;
    using FormulaPlan::FormulaPlan;

    /// Exact pixels by vectors.
    void exact_row(const Block& block, int row, ExactPoint* points) const noexcept override;
    /// And direct ones.
    void computed_row(const Block& block, int row, int begin, int end, float* x,
                      float* y) const noexcept override;
    void computed(std::span<const Block> layers, const PointRows* to) const noexcept override;

  private:
    void direct_rows(const Block& block, const Box& part, const PointRows& to) const;
};

}  // namespace anamorph
