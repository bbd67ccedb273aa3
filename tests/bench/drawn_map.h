// SPDX-License-Identifier: Apache-2.0
// Maps whose blocks are made anew for every drawing, and what draws them: square pictures of three channels of floats, bilinear.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/image/filter.h"
#include "anamorph/plan/block.h"
#include "anamorph/plan/formula_plan.h"
#include "bench.h"
#include "pixels.h"

namespace anamorph::bench {

/// One map that is drawn: its blocks, and the chart of its source.
struct DrawnMap {
    std::string name;
    Chart source;
    std::function<std::shared_ptr<const BlockMap>(const PlanOptions&)> plan;
};

/// The default options, with this tolerance.
PlanOptions options_of(double tol);

/// Draws maps of one size, or only plans them.
class MapDrawing {
  public:
    explicit MapDrawing(const Settings& settings);

    void draw(const DrawnMap& map, const PlanOptions& options, Filter filter = Filter::bilinear);
    /// As users get it who set nothing but the tolerance, which is the default's.
    void draw_with_defaults(const DrawnMap& map, const PlanOptions& options) {
        draw(map, options, Filter::antialias);
    }
    /// Draws by blocks that are made already.
    void draw(const DrawnMap& map, const std::shared_ptr<const BlockMap>& blocks,
              Filter filter = Filter::bilinear);
    void plan(const DrawnMap& map, const PlanOptions& options);

  private:
    static std::size_t bytes_of(int width, int height);

    const Settings& m_settings;
    Pool m_pool;
    Buffer m_texels, m_picture;
};

/// A drawing that is to be timed, and its row of the table; the times are not in it yet.
struct TimedRow {
    Row row;
    std::function<void()> draw;
};
/// A row of the table with the bound and the exact fraction of a map's blocks.
Row row_of(const Settings& settings, const DrawnMap& map, const PlanOptions& options);
/// Times all of them in the same rounds, and adds their rows.
void time_all(const Settings& settings, Report& report, std::vector<TimedRow>& timed);

}  // namespace anamorph::bench
