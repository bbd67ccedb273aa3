// SPDX-License-Identifier: Apache-2.0
#include "edit_window.h"

#include <vtkCommand.h>
#include <vtkTextProperty.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace anamorph_editor {

using anamorph::Error;
using anamorph::printable;

namespace {

/// Pixels of the window within which a point is hit, and the farthest that a click may slip.
constexpr int kHit = 8, kSlip = 3;
constexpr unsigned long kEvents[] = {vtkCommand::LeftButtonPressEvent,
                                     vtkCommand::LeftButtonReleaseEvent,
                                     vtkCommand::MiddleButtonPressEvent,
                                     vtkCommand::MiddleButtonReleaseEvent,
                                     vtkCommand::RightButtonPressEvent,
                                     vtkCommand::RightButtonReleaseEvent,
                                     vtkCommand::MouseMoveEvent,
                                     vtkCommand::MouseWheelForwardEvent,
                                     vtkCommand::MouseWheelBackwardEvent,
                                     vtkCommand::KeyPressEvent,
                                     vtkCommand::ExitEvent,
                                     vtkCommand::TimerEvent};

}  // namespace

void write_file(const std::string& name, const std::string& text) {
    const std::string next = name + ".part";
    std::ofstream file(next, std::ios::binary);
    file << text;
    file.close();
    std::error_code failure;
    if (file) std::filesystem::rename(next, name, failure);
    if (file && !failure) return;
    std::filesystem::remove(next, failure);
    throw Error(printable(name) + " cannot be written");
}

EditWindow::EditWindow(std::size_t panes, const std::string& title, const std::string& file, double lower)
    : m_file(file) {
    for (std::size_t i = 0; i < panes; ++i) {
        const double n = double(panes), at = double(i);
        m_panes.push_back(std::make_unique<Pane>(std::array<double, 4>{at / n, lower, (at + 1) / n, 1}));
        m_bands.push_back(
            std::make_unique<Overlay>(m_panes[i]->renderer(), std::array<double, 3>{1, 1, 1}, 1.0f));
        m_window->AddRenderer(m_panes[i]->renderer());
    }
    m_lower->SetViewport(0, 0, 1, lower);
    m_lower->SetBackground(0.1, 0.1, 0.1);
    m_window->AddRenderer(m_lower);
    m_text->SetPosition(8, 6);
    m_text->GetTextProperty()->SetFontSize(14);
    m_lower->AddActor2D(m_text);
    m_window->SetMultiSamples(0);
    m_window->SetWindowName(title.c_str());
    m_interactor->SetRenderWindow(m_window);
    m_interactor->SetInteractorStyle(nullptr);
    m_observer->SetCallback(&EditWindow::handle);
    m_observer->SetClientData(this);
    for (const unsigned long event : kEvents) m_interactor->AddObserver(event, m_observer);
    m_panes[0]->renderer()->AddObserver(vtkCommand::StartEvent, m_observer);
}

EditWindow::~EditWindow() {
    m_interactor->RemoveObserver(m_observer);
    m_panes[0]->renderer()->RemoveObserver(m_observer);
}

void EditWindow::drew(std::chrono::steady_clock::time_point start, double max_error, double tol) {
    m_milliseconds =
        std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
    m_off = std::isnan(max_error) ? "off as its machine is"
                                  : "off by at most " + anamorph::shortest(static_cast<float>(max_error)) +
                                        " px (tol " + anamorph::shortest(tol) + ")";
}

bool EditWindow::save() {
    return this->guarded([&] {
        write_file(m_file, this->text());
        this->set_saved();
    });
}

void EditWindow::update() {
    std::vector<bool> anew;
    for (const auto& pane : m_panes) anew.push_back(pane->update() || m_forgotten);
    m_forgotten = false;
    const std::string before = m_error;
    if (this->guarded([&] { this->draw(anew); })) m_error = before;
    this->write_status();
}

void EditWindow::write_status() {
    char time[32];
    std::snprintf(time, sizeof time, "%.1f ms", m_milliseconds);
    m_status = std::string(time) + "   " + m_off + "   " + this->describe();
    if (this->has_changes()) m_status += "   not saved";
    if (!m_error.empty()) m_status += "\n" + m_error;
    m_text->SetInput(m_status.c_str());
}

EditWindow::Display EditWindow::mouse() const {
    const int* at = m_interactor->GetEventPosition();
    return {at[0], at[1]};
}

/// The pane under a place, or else the one in which a button is held.
std::size_t EditWindow::pane_at(const Display& at) {
    for (std::size_t i = 0; i < m_panes.size(); ++i)
        if (m_panes[i]->has(at)) return i;
    return m_held;
}

Selecting EditWindow::selecting() const {
    return m_interactor->GetControlKey() ? Selecting::other
           : m_interactor->GetShiftKey() ? Selecting::more
                                         : Selecting::only;
}

/// VTK counts presses that follow each other soon, wherever they are.
bool EditWindow::is_second_click(const Display& at) const {
    return m_interactor->GetRepeatCount() > 0 && std::abs(at[0] - m_pressed[0]) <= kSlip &&
           std::abs(at[1] - m_pressed[1]) <= kSlip;
}

void EditWindow::press() {
    const Display at = this->mouse();
    m_held = this->pane_at(at);
    this->guarded([&] {
        if (m_panes[m_held]->has(at)) return this->press_in_pane(at);
        if (this->press_below({double(at[0]), double(at[1])})) m_gesture = Gesture::below;
    });
    this->render();
}

void EditWindow::press_in_pane(const Display& at) {
    const bool is_second = this->is_second_click(at);
    m_pressed = m_last = at;
    Pane& pane = *m_panes[m_held];
    const Point<double> place = pane.to_picture(at);
    if (this->draws_lines()) {
        m_gesture = Gesture::line;
        return;
    }
    if (is_second && this->double_click(m_held, place)) return;
    const bool is_picked = this->pick(m_held, place, kHit * pane.pixel(), this->selecting());
    m_gesture = is_picked ? Gesture::drag : Gesture::band;
}

void EditWindow::move() {
    const Display at = this->mouse();
    Pane& pane = *m_panes[m_held];
    if (m_gesture == Gesture::none || at == m_last) return;
    if (m_gesture == Gesture::pan) pane.pan(at[0] - m_last[0], at[1] - m_last[1]);
    m_last = at;
    if (m_gesture == Gesture::drag)
        this->guarded([&] { this->drag(m_held, pane.to_picture(at) - pane.to_picture(m_pressed)); });
    if (m_gesture == Gesture::below) this->guarded([&] { this->move_below({double(at[0]), double(at[1])}); });
    this->show_band();
    this->render();
}

void EditWindow::release() {
    const Gesture gesture = m_gesture;
    m_gesture = Gesture::none;
    if (gesture == Gesture::none) return;
    Pane& pane = *m_panes[m_held];
    this->guarded([&] {
        if (gesture == Gesture::drag) this->end_drag(true);
        if (gesture != Gesture::band && gesture != Gesture::line) return;
        const Point<double> a = pane.to_picture(m_pressed), b = pane.to_picture(this->mouse());
        if (gesture == Gesture::line) return this->draw_line(m_held, a, b);
        this->select_in(m_held,
                        {std::min(a.x, b.x), std::min(a.y, b.y), std::max(a.x, b.x), std::max(a.y, b.y)},
                        this->selecting());
    });
    this->show_band();
    this->render();
}

void EditWindow::show_band() {
    std::vector<Polyline> lines;
    Pane& pane = *m_panes[m_held];
    const Point<double> a = pane.to_picture(m_pressed), b = pane.to_picture(m_last);
    if (m_gesture == Gesture::band) lines = pane.to_renderer({{a, {b.x, a.y}, b, {a.x, b.y}, a}});
    if (m_gesture == Gesture::line) lines = pane.to_renderer({{a, b}});
    m_bands[m_held]->set_lines(lines);
}

void EditWindow::wheel(bool larger) {
    const Display at = this->mouse();
    m_panes[this->pane_at(at)]->zoom(at, larger);
    this->render();
}

void EditWindow::control_key(const std::string& name) {
    const bool shift = m_interactor->GetShiftKey() != 0;
    const auto is = [&](const char* lower, const char* upper) { return name == lower || name == upper; };
    if (is("s", "S")) return static_cast<void>(this->save());
    if (is("y", "Y") || (is("z", "Z") && shift)) return static_cast<void>(this->redo());
    if (is("z", "Z")) this->undo();
}

void EditWindow::press_key() {
    const char* symbol = m_interactor->GetKeySym();
    if (!symbol) return;
    const std::string name = symbol;
    const Display at = this->mouse();
    const std::size_t i = this->pane_at(at);
    const auto all = [&](const auto& body) { std::for_each(m_panes.begin(), m_panes.end(), body); };
    if (name == "q") return this->end();
    m_warned = false;
    const bool saves = m_interactor->GetControlKey() && (name == "s" || name == "S");
    this->guarded([&] {
        if (m_interactor->GetControlKey() && !saves) return this->control_key(name);
        if (name == "f") return all([](const auto& pane) { pane->fit(); });
        if (name == "a") return this->select_in(i, {-1e300, -1e300, 1e300, 1e300}, Selecting::only);
        if (name == "Escape") {
            if (m_gesture == Gesture::drag)
                this->end_drag(false);
            else
                this->select_none();
            m_gesture = Gesture::none;
            return this->show_band();
        }
        if (!saves) this->key(name, i, m_panes[i]->to_picture(at));
    });
    if (saves) this->save();
    this->render();
}

/// What is not saved is not lost by one key.
void EditWindow::end() {
    if (this->has_changes() && !m_warned) {
        m_warned = true;
        m_error = "there are changes that are not saved: ctrl+s saves them, once more gives them up";
        return this->render();
    }
    m_ended = true;
    m_interactor->TerminateApp();
}

void EditWindow::event(unsigned long event) {
    switch (event) {
        case vtkCommand::StartEvent:
            return this->update();
        case vtkCommand::LeftButtonPressEvent:
            return this->press();
        case vtkCommand::MiddleButtonPressEvent:
        case vtkCommand::RightButtonPressEvent:
            m_pressed = m_last = this->mouse();
            m_held = this->pane_at(m_pressed);
            m_gesture = Gesture::pan;
            return;
        case vtkCommand::MouseMoveEvent:
            return this->move();
        case vtkCommand::MouseWheelForwardEvent:
        case vtkCommand::MouseWheelBackwardEvent:
            return this->wheel(event == vtkCommand::MouseWheelForwardEvent);
        case vtkCommand::KeyPressEvent:
            return this->press_key();
        case vtkCommand::ExitEvent:
            return this->end();
        case vtkCommand::TimerEvent:
            return this->timer();
        default:
            return this->release();
    }
}

void EditWindow::handle(vtkObject*, unsigned long event, void* data, void*) {
    static_cast<EditWindow*>(data)->event(event);
}

}  // namespace anamorph_editor
