// SPDX-License-Identifier: Apache-2.0
// The blocks of a formula that is text.
#pragma once

#include "anamorph/formula/text_map.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

extern template class FormulaPlan<TextMap>;

class TextPlan final : public FormulaPlan<TextMap> {
  public:
    using FormulaPlan::exact;
    TextPlan(const TextMap& map, const PlanOptions& options);

    /// Reads exact pixels by vectors, and direct ones in double.
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;
    /// Reads direct pixels in float.
    void computed_row(const Block& block, int row, int begin, int end, float* x,
                      float* y) const noexcept override;
    void computed(std::span<const Block> layers, const PointRows* to) const noexcept override;

  private:
    void direct_rows(const Block& block, const Box& part, const PointRows& to) const;
};

}  // namespace anamorph
