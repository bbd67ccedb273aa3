// SPDX-License-Identifier: Apache-2.0
// Features that are edited (Kim 2003, 5.6.3): what a window for morphs does, without the window. Points of lines, polylines and curves are
// selected and dragged in the picture of each shape, lines are drawn and taken away, and every step may be undone.
//
// Frames. Positions are in the pixels that the features are given in (Features::frame), of the shape that is named.
#pragma once

#include <compare>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "anamorph/editing.h"
#include "anamorph/geometry/bounds_tree.h"
#include "anamorph/morph/feature_lines.h"

namespace anamorph {

class FeatureEditor {
  public:
    /// A point of what was given: in Features::given(), in a shape, by its number there.
    struct Place {
        std::size_t feature;
        int shape;
        std::size_t point;
        friend auto operator<=>(const Place&, const Place&) = default;
    };

    /// Starts with features, which may be none.
    explicit FeatureEditor(Features features) : m_state{std::move(features), {}} {}

    const Features& features() const { return m_state.features; }
    /// The position of a point.
    Point<double> at(const Place& place) const;
    /// All points of a shape.
    std::vector<Place> points(int shape) const;
    const std::set<Place>& selected() const { return m_state.selected; }

    /// The point of a shape nearest to a position, no farther than `within`.
    std::optional<Place> point_near(int shape, const Point<double>& at, double within) const;
    /// Selects a point, and all of its shape that lie exactly there: ends that meet stay together.
    void select(const Place& place, Selecting how);
    /// Selects the points of a shape in a rectangle.
    void select_in(int shape, const Bounds& box, Selecting how);
    void select_none() { m_state.selected.clear(); }

    /// Moves the selected points to `by` pixels from where they were when dragging began, which it does by this. All of a drag is one step. Throws
    /// Error, and leaves all as it was, where a line would have no length or a point would lie too far away.
    void drag(const Point<double>& by);
    /// Ends a drag; with `keep` false all is as before it.
    void end_drag(bool keep = true);

    /// Adds a line, given once for each shape, and selects its ends. Throws Error as Features::add_line() does.
    void add_line(const std::vector<Line>& line);
    /// Takes away the features of which a point is selected. False where none is.
    bool remove_selected();

    /// Takes back the last step, or does it again. False where there is none.
    bool undo() { return restore(m_steps.undo(settled())); }
    bool redo() { return restore(m_steps.redo(settled())); }
    std::size_t steps() const { return m_steps.kept().size(); }

  private:
    struct State {
        Features features;
        std::set<Place> selected;
    };
    /// The same features with others in the place of those given.
    Features with(const std::vector<Features::Given>& given) const;
    /// The state after a drag that is ended.
    const State& settled() {
        end_drag();
        return m_state;
    }
    bool restore(std::optional<State> state);

    State m_state;
    std::optional<State> m_before;
    UndoSteps<State> m_steps;
};

}  // namespace anamorph
