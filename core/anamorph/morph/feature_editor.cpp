// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/feature_editor.h"

#include <cmath>
#include <utility>

#include "anamorph/number/hypot.h"

namespace anamorph {

Point<double> FeatureEditor::at(const Place& place) const {
    return features()
        .given()
        .at(place.feature)
        .points.at(static_cast<std::size_t>(place.shape))
        .at(place.point);
}

std::vector<FeatureEditor::Place> FeatureEditor::points(int shape) const {
    std::vector<Place> all;
    const std::vector<Features::Given>& given = features().given();
    for (std::size_t i = 0; i < given.size(); ++i)
        for (std::size_t n = 0; n < given[i].points[static_cast<std::size_t>(shape)].size(); ++n)
            all.push_back({i, shape, n});
    return all;
}

std::optional<FeatureEditor::Place> FeatureEditor::point_near(int shape, const Point<double>& to,
                                                              double within) const {
    std::optional<Place> nearest;
    for (const Place& place : points(shape)) {
        const Point<double> p = at(place);
        const double far = hypot(p.x - to.x, p.y - to.y);
        if (!(far <= within)) continue;
        within = far;
        nearest = place;
    }
    return nearest;
}

void FeatureEditor::select(const Place& place, Selecting how) {
    const Point<double> where = at(place);
    std::vector<Place> there = points(place.shape);
    std::erase_if(there, [&](const Place& p) { return at(p).x != where.x || at(p).y != where.y; });
    select_places(there, how, m_state.selected);
}

void FeatureEditor::select_in(int shape, const Bounds& box, Selecting how) {
    std::vector<Place> inside = points(shape);
    std::erase_if(inside, [&](const Place& place) {
        const Point<double> p = at(place);
        return !(p.x >= box.x0 && p.x <= box.x1 && p.y >= box.y0 && p.y <= box.y1);
    });
    select_places(inside, how, m_state.selected);
}

Features FeatureEditor::with(const std::vector<Features::Given>& given) const {
    Features made(features().shapes());
    for (const Features::Given& feature : given) made.add(feature);
    for (int k = 0; k < made.shapes(); ++k) {
        made.set_title(k, features().title(k), features().picture(k));
        if (features().frame(k).width > 0) made.set_frame(k, features().frame(k));
    }
    made.pin_border(features().border_weight());
    return made;
}

void FeatureEditor::drag(const Point<double>& by) {
    if (m_state.selected.empty()) return;
    const State& from = m_before ? *m_before : m_state;
    std::vector<Features::Given> given = from.features.given();
    for (const Place& place : m_state.selected) {
        Point<double>& p = given[place.feature].points[static_cast<std::size_t>(place.shape)][place.point];
        p = {p.x + by.x, p.y + by.y};
    }
    Features moved = with(given);
    if (!m_before) m_before = m_state;
    m_state.features = std::move(moved);
}

void FeatureEditor::end_drag(bool keep) {
    if (!m_before) return;
    State before = std::move(*m_before);
    m_before.reset();
    if (keep) return m_steps.keep(std::move(before));
    m_state = std::move(before);
}

void FeatureEditor::add_line(const std::vector<Line>& line) {
    end_drag();
    State next = m_state;
    next.features.add_line(line);
    next.selected.clear();
    for (int k = 0; k < next.features.shapes(); ++k)
        for (const std::size_t end : {0, 1}) next.selected.insert({next.features.given().size() - 1, k, end});
    std::swap(m_state, next);
    m_steps.keep(std::move(next));
}

bool FeatureEditor::remove_selected() {
    end_drag();
    if (m_state.selected.empty()) return false;
    std::vector<Features::Given> rest;
    const std::vector<Features::Given>& given = features().given();
    std::set<std::size_t> gone;
    for (const Place& place : m_state.selected) gone.insert(place.feature);
    for (std::size_t i = 0; i < given.size(); ++i)
        if (gone.count(i) == 0) rest.push_back(given[i]);
    State next{with(rest), {}};
    std::swap(m_state, next);
    m_steps.keep(std::move(next));
    return true;
}

bool FeatureEditor::restore(std::optional<State> state) {
    if (!state) return false;
    m_state = std::move(*state);
    return true;
}

}  // namespace anamorph
