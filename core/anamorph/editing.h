// SPDX-License-Identifier: Apache-2.0
// What editors of points share: how points are selected, and steps that are taken back.
#pragma once

#include <cstddef>
#include <optional>
#include <set>
#include <utility>
#include <vector>

namespace anamorph {

/// How points are selected: these alone, these too, or each as it was not.
enum class Selecting { only, more, other };

/// Selects the points at these places, in that way.
template <class Place>
void select_places(const std::vector<Place>& places, Selecting how, std::set<Place>& selected) {
    if (how == Selecting::only) selected.clear();
    for (const Place& place : places)
        if (!selected.insert(place).second && how == Selecting::other) selected.erase(place);
}

inline constexpr std::size_t kMostUndoSteps = 1000;

/// The states before the steps that were taken, and after those that were taken back: the last kMostUndoSteps of them.
template <class State>
class UndoSteps {
  public:
    /// Keeps the state before a step that was taken; those that were taken back cannot be done again.
    void keep(State before) {
        m_redo.clear();
        m_undo.push_back(std::move(before));
        if (m_undo.size() > kMostUndoSteps) forget_first();
    }
    void forget_first() { m_undo.erase(m_undo.begin()); }
    /// The states before all steps that may be taken back.
    const std::vector<State>& kept() const { return m_undo; }

    /// The state before the last step, which is taken back, or after the one that is done again; nothing where there is none.
    std::optional<State> undo(const State& now) { return exchange(m_undo, now, m_redo); }
    std::optional<State> redo(const State& now) { return exchange(m_redo, now, m_undo); }

  private:
    static std::optional<State> exchange(std::vector<State>& from, const State& now, std::vector<State>& to) {
        if (from.empty()) return {};
        to.push_back(now);
        std::optional<State> then = std::move(from.back());
        from.pop_back();
        return then;
    }

    std::vector<State> m_undo, m_redo;
};

}  // namespace anamorph
