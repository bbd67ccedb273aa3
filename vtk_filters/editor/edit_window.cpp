// SPDX-License-Identifier: Apache-2.0
#include "edit_window.h"

#include <vtkCommand.h>
#include <vtkOpenGLFramebufferObject.h>
#include <vtkOpenGLRenderWindow.h>
#include <vtkOpenGLState.h>
#include <vtkTextProperty.h>
#include <vtk_glew.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

namespace anamorph_editor {

using anamorph::Box;
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
        m_bands.push_back(std::make_unique<Overlay>(m_panes[i]->renderer(), m_panes[i]->damage(),
                                                    std::array<double, 3>{1, 1, 1}, 1.0f));
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
    m_window->AddObserver(vtkCommand::StartEvent, m_observer);
    m_window->AddObserver(vtkCommand::EndEvent, m_observer);
}

EditWindow::~EditWindow() {
    m_interactor->RemoveObserver(m_observer);
    m_window->RemoveObserver(m_observer);
}

namespace {

double milliseconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}
std::string at_most(double error) {
    return "off by at most " + anamorph::shortest(static_cast<float>(error)) + " px";
}

}  // namespace

void EditWindow::drew(std::chrono::steady_clock::time_point start, double max_error, double tol) {
    m_milliseconds = milliseconds_since(start);
    m_bound = max_error;
    m_off = std::isnan(max_error) ? "off as its machine is"
                                  : at_most(max_error) + " (tol " + anamorph::shortest(tol) + ")";
}

void EditWindow::drew_by_fragments(std::chrono::steady_clock::time_point start, double bound) {
    m_milliseconds = milliseconds_since(start);
    m_bound = bound;
    m_off = at_most(bound) + " (by fragments)";
}

void EditWindow::draw_by_fragments(bool does) {
    m_by_fragments = does;
    m_forgotten = true;
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
    for (std::size_t i = 0; i < m_panes.size(); ++i)
        if (anew[i]) m_panes[i]->damage().add_all();
    if (std::find(anew.begin(), anew.end(), true) != anew.end()) m_lower_damage.add_all();
    m_forgotten = false;
    const std::string before = m_error;
    if (this->guarded([&] { this->draw(anew); })) m_error = before;
    this->write_status();
    this->draw_damage();
}

/// Has renderers draw what changed, and nothing else.
void EditWindow::draw_damage() {
    const auto add = [&](vtkRenderer* renderer, const Box& pixels) {
        const int* const corner = renderer->GetOrigin();
        if (!pixels.empty())
            m_drawn.push_back(
                {corner[0] + pixels.x0, corner[1] + pixels.y0, corner[0] + pixels.x1, corner[1] + pixels.y1});
    };
    for (const auto& pane : m_panes) add(pane->renderer(), pane->draw_damage());
    m_lower->SetDraw(!m_lower_damage.is_empty());
    const int* const size = m_lower->GetSize();
    if (!m_lower_damage.is_empty()) add(m_lower, {0, 0, size[0], size[1]});
    m_lower_damage.clear();
    m_drawn_area = 0;
    for (const Box& box : m_drawn) m_drawn_area += std::int64_t{box.width()} * box.height();
    // What is drawn comes into the window by present().
    auto* const window = vtkOpenGLRenderWindow::SafeDownCast(m_window);
    if (!window || !this->shows_a_window()) return;
    window->SetFrameBlitModeToNoBlit();
    window->SwapBuffersOff();
}

/// Takes what was drawn over to the window. Mesa's software renderer copies the buffer behind the window to it, and keeps it, so that only
/// what changed is taken to there; graphics cards, which may exchange the two, take all of it. So does a frame in which nothing changed,
/// as after the window was covered, and one now and then: a window that is new or resized may lose its buffer without a word.
void EditWindow::present() {
    auto* const window = vtkOpenGLRenderWindow::SafeDownCast(m_window);
    if (!window || !this->shows_a_window()) return m_drawn.clear();
    const int* const size = window->GetSize();
    constexpr std::chrono::milliseconds kOften(500);
    const auto now = std::chrono::steady_clock::now();
    if (!m_keeps_buffer || m_drawn.empty() || now - m_presented_all > kOften) {
        m_drawn = {{0, 0, size[0], size[1]}};
        m_presented_all = now;
    }
    vtkOpenGLState* const state = window->GetState();
    state->PushFramebufferBindings();
    window->GetDisplayFramebuffer()->Bind(GL_READ_FRAMEBUFFER);
    window->GetDisplayFramebuffer()->ActivateReadBuffer(0);
    state->vtkglBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
    state->vtkglDrawBuffer(GL_BACK);
    state->vtkglDisable(GL_SCISSOR_TEST);
    for (const Box& b : m_drawn)
        glBlitFramebuffer(b.x0, b.y0, b.x1, b.y1, b.x0, b.y0, b.x1, b.y1, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    state->PopFramebufferBindings();
    m_drawn.clear();
    window->SwapBuffersOn();
    window->Frame();
    window->SwapBuffersOff();
    m_keeps_buffer = state->GetRenderer().find("llvmpipe") != std::string::npos;
}

void EditWindow::write_status() {
    char time[32];
    std::snprintf(time, sizeof time, "%.1f ms", m_milliseconds);
    m_status = std::string(time) + "   " + m_off + "   " + this->describe();
    if (this->has_changes()) m_status += "   not saved";
    if (!m_error.empty()) m_status += "\n" + m_error;
    // Nobody reads what changes with each frame.
    constexpr std::chrono::milliseconds kReading(150);
    const auto now = std::chrono::steady_clock::now();
    if (m_status == m_written || (this->has_gesture() && now - m_written_at < kReading)) return;
    m_written = m_status;
    m_written_at = now;
    m_text->SetInput(m_status.c_str());
    m_lower_damage.add_all();
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
        if (name == "v") return this->draw_by_fragments(!m_by_fragments);
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
        case vtkCommand::EndEvent:
            return this->present();
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
