// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/outline_arcs.h"

#include <algorithm>

namespace anamorph::figure {
namespace {

/// Cuts arcs at `period`.
void unroll(std::vector<Arc>& arcs, double period) {
    const std::size_t count = arcs.size();
    for (std::size_t k = 0; k < count; ++k)
        if (arcs[k].end > period) {
            arcs.push_back({0, arcs[k].end - period});
            arcs[k].end = period;
        }
}

/// Joins the last arc to the first where they meet at 0.
void roll(std::vector<Arc>& arcs, double period) {
    if (arcs.size() < 2 || arcs.front().begin > 0 || arcs.back().end < period) return;
    arcs.back().end += arcs.front().end;
    arcs.erase(arcs.begin());
}

/// Sorts arcs of [0, period], and joins those that meet.
void join(std::vector<Arc>& arcs) {
    std::sort(arcs.begin(), arcs.end(), [](const Arc& a, const Arc& b) { return a.begin < b.begin; });
    std::size_t kept = 0;
    for (const Arc& arc : arcs) {
        if (!(arc.end > arc.begin)) continue;
        if (kept > 0 && arc.begin <= arcs[kept - 1].end)
            arcs[kept - 1].end = std::max(arcs[kept - 1].end, arc.end);
        else
            arcs[kept++] = arc;
    }
    arcs.resize(kept);
}

/// What of [0, period] joined arcs leave out, to the bit.
std::vector<Arc> gaps_of(const std::vector<Arc>& arcs, double period) {
    std::vector<Arc> gaps;
    double end = 0;
    for (const Arc& arc : arcs) {
        if (arc.begin > end) gaps.push_back({end, arc.begin});
        end = arc.end;
    }
    if (end < period) gaps.push_back({end, period});
    return gaps;
}

}  // namespace

std::vector<Arc> union_of(std::vector<Arc> arcs, double period, bool closed) {
    unroll(arcs, period);
    join(arcs);
    if (closed) roll(arcs, period);
    return arcs;
}

std::vector<Arc> complement_of(std::vector<Arc> arcs, double period, bool closed) {
    unroll(arcs, period);
    join(arcs);
    std::vector<Arc> rest = gaps_of(arcs, period);
    if (closed) roll(rest, period);
    return rest;
}

void split(std::vector<Arc> hidden_parts, const std::vector<Arc>& cut, double period, bool closed,
           std::vector<Arc>& visible, std::vector<Arc>& hidden) {
    unroll(hidden_parts, period);
    join(hidden_parts);
    hidden = std::move(hidden_parts);
    visible = gaps_of(hidden, period);
    if (!cut.empty()) {
        // Each is what the other and the cut leave out.
        std::vector<Arc> taken = hidden, other = visible;
        for (std::vector<Arc>* arcs : {&taken, &other}) {
            arcs->insert(arcs->end(), cut.begin(), cut.end());
            unroll(*arcs, period);
            join(*arcs);
        }
        visible = gaps_of(taken, period);
        hidden = gaps_of(other, period);
    }
    if (!closed) return;
    roll(visible, period);
    roll(hidden, period);
}

std::vector<Arc> nearer_part(double from, double to, double near) {
    if (from >= near && to >= near) return {};
    if (from < near && to < near) return {{0, 1}};
    const double s = std::clamp((near - from) / (to - from), 0.0, 1.0);
    return {from < near ? Arc{0, s} : Arc{s, 1}};
}

}  // namespace anamorph::figure
