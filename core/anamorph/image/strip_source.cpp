// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/strip_source.h"

namespace anamorph {

StripSource::StripSource(const Source& base, int first, int rows) : m_base(base) {
    const int height = base.size(0).height;
    for (int level = 0; level < base.levels(); ++level) {
        const Size whole = base.size(level);
        const auto row = [&](int of_finest) { return std::int64_t{of_finest} * whole.height; };
        if (row(first) % height != 0 || row(rows) % height != 0) return;
        const int from = static_cast<int>(row(first) / height), count = static_cast<int>(row(rows) / height);
        if (count < 1) return;
        Level made{from, {whole.width, count}, {}};
        if (const ConstImageView* view = base.view(level)) {
            made.view = *view;
            made.view.data = view->at(0, from);
            made.view.height = count;
        }
        m_levels.push_back(made);
    }
}

}  // namespace anamorph
