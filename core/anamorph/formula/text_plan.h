// SPDX-License-Identifier: Apache-2.0
// The blocks of a formula that is text.
#pragma once

#include "anamorph/formula/text_map.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

extern template class FormulaPlan<TextMap>;

class TextPlan final : public FormulaPlan<TextMap> {
  public:
    using FormulaPlan::FormulaPlan;

    /// Exact pixels by vectors.
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;
};

}  // namespace anamorph
