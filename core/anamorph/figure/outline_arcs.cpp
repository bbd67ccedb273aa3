// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline_arcs.h"

#include <algorithm>

namespace anamorph {
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

}  // namespace

std::vector<Arc> union_of(std::vector<Arc> arcs, double period, bool closed) {
    unroll(arcs, period);
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
    if (closed) roll(arcs, period);
    return arcs;
}

std::vector<Arc> complement_of(const std::vector<Arc>& arcs, double period, bool closed) {
    std::vector<Arc> rest;
    if (arcs.empty()) return {{0, period}};
    // The gaps before each arc, from the end of an arc that runs over `period` on.
    double end = std::max(0.0, arcs.back().end - period);
    for (const Arc& arc : arcs) {
        if (arc.begin > end) rest.push_back({end, arc.begin});
        end = arc.end;
    }
    if (end < period) rest.push_back({end, period});
    if (closed) roll(rest, period);
    return rest;
}

void split(std::vector<Arc> hidden_parts, const std::vector<Arc>& cut, double period, bool closed,
           std::vector<Arc>& visible, std::vector<Arc>& hidden) {
    visible = complement_of(hidden_parts, period, closed);
    hidden = std::move(hidden_parts);
    if (cut.empty()) return;
    std::vector<Arc> not_visible = hidden, not_hidden = visible;
    not_visible.insert(not_visible.end(), cut.begin(), cut.end());
    not_hidden.insert(not_hidden.end(), cut.begin(), cut.end());
    visible = complement_of(union_of(std::move(not_visible), period, closed), period, closed);
    hidden = complement_of(union_of(std::move(not_hidden), period, closed), period, closed);
}

std::vector<Arc> nearer_part(double from, double to, double near) {
    if (from >= near && to >= near) return {};
    if (from < near && to < near) return {{0, 1}};
    const double s = std::clamp((near - from) / (to - from), 0.0, 1.0);
    return {from < near ? Arc{0, s} : Arc{s, 1}};
}

}  // namespace anamorph
