// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chain/joined.h"

#include <algorithm>
#include <memory>

#include "anamorph/chain/chain_plan.h"

namespace anamorph {
namespace {

/// The map of a picture of one source, or null; `reason` says why.
std::shared_ptr<const MapLink> link_of(const Picture& picture, std::string& reason) {
    const bool is_mixed = picture.maps.size() != 1 || picture.maps[0].layers.size() != 1;
    if (is_mixed || picture.maps[0].layers[0].weights)
        reason = "has several sources";
    else if (picture.value || picture.overlay || picture.same_as)
        reason = "shows more than its source";
    else if (std::shared_ptr<const MapLink> link = picture.maps[0].blocks->link())
        return link;
    else
        reason = picture.maps[0].blocks->why_unlinked();
    return nullptr;
}

const Border& border_of(const Picture& picture) {
    return picture.maps[0].layers[0].border;
}

/// The reason why a picture cannot go on with what another one draws; empty where it can.
std::string mismatch(const Picture& outer, const Picture& inner, const MapLink& to, const Box& shown) {
    const Border& border = border_of(outer);
    const Chart& chart = border.chart();
    if (outer.filter != inner.filter || !(outer.data == inner.data)) return "the filters differ";
    if (inner.output != Output::color) return "its source is no picture in colour";
    const bool ends = border.wrap() == Wrap::automatic || (border.wrap() == Wrap::black && !chart.closed());
    if (!ends) return "wrap goes on beyond its source's edges";
    if (chart.pieces().size() > 1) return "its source has faces";
    const bool is_whole = shown == Box{0, 0, inner.width(), inner.height()};
    if (chart.closed() && (!is_whole || chart.period() != inner.width()))
        return "its source closes on itself, but not at its edges";
    // Read by itself it would go on across its seam, which its own source need not do.
    if (chart.closed() && to.target_period() != chart.period())
        return "its source closes on itself, but not what that is drawn from";
    return "";
}

PlanOptions options_of(const Picture& outer, const PlanOptions& a, const PlanOptions& b) {
    PlanOptions options = b;
    if (a.scheme == Scheme::exact) options.scheme = Scheme::exact;
    options.tol = std::min(a.tol, b.tol);
    options.cull = b.cull && (outer.output == Output::color || outer.output == Output::coverage);
    options.overscan = a.overscan;
    return options;
}

}  // namespace

Joined joined_picture(const Picture& outer, const Picture& inner, const Box& shown) {
    std::string reason;
    const std::shared_ptr<const MapLink> from = link_of(outer, reason);
    if (!from) return {{}, "it " + reason};
    const std::shared_ptr<const MapLink> to = link_of(inner, reason);
    if (!to || !to->reads_computed_points())
        return {{}, "its source " + (to ? "is inverted point by point" : reason)};
    if (reason = mismatch(outer, inner, *to, shown); !reason.empty()) return {{}, reason};

    const Chart& chart = border_of(outer).chart();
    const Point<double> corner{double(shown.x0 - inner.overscan.width),
                               double(shown.y0 - inner.overscan.height)};
    const ChainMap map(from, to, {corner, inner.overscan, chart.closed() && chart.reaches_poles()});
    Picture picture = outer;
    picture.maps[0].blocks =
        std::make_shared<const ChainPlan>(map, options_of(outer, from->options(), to->options()));
    picture.maps[0].layers = inner.maps[0].layers;
    picture.adds_alpha |= inner.adds_alpha;
    return {std::move(picture), ""};
}

}  // namespace anamorph
