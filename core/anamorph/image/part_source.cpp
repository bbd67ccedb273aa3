// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/part_source.h"

#include <optional>

namespace anamorph {
namespace {

/// Pixels [from, to) of a side of level 0 as those of a level; none where they end within one.
struct LevelRun {
    int first, count;
};
std::optional<LevelRun> run_on_level(int from, int to, int side, int of_level) {
    const std::int64_t first = std::int64_t{from} * of_level, last = std::int64_t{to} * of_level;
    if (first % side != 0 || last % side != 0 || last == first) return {};
    return LevelRun{static_cast<int>(first / side), static_cast<int>((last - first) / side)};
}

}  // namespace

PartSource::PartSource(const Source& base, const Box& part) : m_base(base) {
    const Size finest = base.size(0);
    for (int level = 0; level < base.levels(); ++level) {
        const Size whole = base.size(level);
        const std::optional<LevelRun> across = run_on_level(part.x0, part.x1, finest.width, whole.width),
                                      down = run_on_level(part.y0, part.y1, finest.height, whole.height);
        if (!across || !down) return;
        Level made{across->first, down->first, {across->count, down->count}, {}};
        if (const ConstImageView* view = base.view(level)) {
            made.view = *view;
            made.view.data = view->at(across->first, down->first);
            made.view.width = across->count;
            made.view.height = down->count;
        }
        m_levels.push_back(made);
    }
}

}  // namespace anamorph
