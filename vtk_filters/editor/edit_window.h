// SPDX-License-Identifier: Apache-2.0
// What windows that edit a file of a recipe share: panes side by side, points that are selected and dragged, steps that are taken back,
// a line of text, and a file that is saved.
//
//     left button        selects a point and drags what is selected; elsewhere, a rectangle of points
//     shift, ctrl        with it: these too; each as it was not
//     double click       what the editor does there
//     wheel              larger, smaller
//     middle, right      moves the picture in its pane
//     ctrl+z, ctrl+y     takes a step back; does it again (ctrl+shift+z too)
//     ctrl+s             saves
//     v                  drawn by the core, or by the graphics card fragment by fragment
//     f, a, escape, q    whole picture; selects all; gives a drag up, or selects none; ends
#pragma once

#include <vtkCallbackCommand.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkTextActor.h>

#include <chrono>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/editing.h"
#include "anamorph/geometry/bounds_tree.h"
#include "pane.h"

namespace anamorph_editor {

using anamorph::Selecting;

/// Replaces a file as a whole, or leaves it as it is. Throws Error.
void write_file(const std::string& name, const std::string& text);

class EditWindow {
  public:
    virtual ~EditWindow();
    EditWindow(const EditWindow&) = delete;
    EditWindow& operator=(const EditWindow&) = delete;

    vtkRenderWindow* window() { return m_window; }
    vtkRenderWindowInteractor* interactor() { return m_interactor; }
    Pane& pane(std::size_t i) { return *m_panes[i]; }
    const Pane& pane(std::size_t i) const { return *m_panes[i]; }
    std::size_t panes() const { return m_panes.size(); }

    /// Leaves drawing the result to the graphics card, or to the core.
    void draw_by_fragments(bool does);
    bool draws_by_fragments() const { return m_by_fragments; }
    /// How far any pixel of the result is off at most, in source pixels; NaN where nothing is proven.
    double bound() const { return m_bound; }
    /// Saves the file. False where that fails, of which error() tells.
    bool save();
    /// Are there changes that are not saved?
    bool has_changes() const { return this->is_dragging() || m_saved != this->text(); }
    /// What the line below the panes says.
    const std::string& status() const { return m_status; }
    /// The error that occurred last; empty where none did since.
    const std::string& error() const { return m_error; }
    /// The pixels of the window that were drawn last, together.
    std::int64_t drawn_area() const { return m_drawn_area; }
    /// The time that drawing the result took last, in milliseconds.
    double milliseconds() const { return m_milliseconds; }
    /// Has the program been asked to end, and may it?
    bool ended() const { return m_ended; }

  protected:
    /// `panes`: how many stand side by side. `file`: the one that is saved to. `lower`: the part of the window's height below the
    /// panes.
    EditWindow(std::size_t panes, const std::string& title, const std::string& file, double lower);

    /// The text that is saved.
    virtual std::string text() const = 0;
    /// Draws what changed. `anew`: of each pane, whether all of its pixels are new.
    virtual void draw(const std::vector<bool>& anew) = 0;
    /// What the line says beyond time and error.
    virtual std::string describe() const = 0;

    /// Selects the point that is nearest to a place, at most `within` pixels of the picture away. Of those that are selected
    /// already `only` changes nothing. False where there is none.
    virtual bool pick(std::size_t pane, const Point<double>& at, double within, Selecting how) = 0;
    virtual void select_in(std::size_t pane, const anamorph::Bounds& box, Selecting how) = 0;
    virtual void select_none() = 0;
    virtual void drag(std::size_t pane, const Point<double>& by) = 0;
    virtual void end_drag(bool keep) = 0;
    /// What a double click does. False where it is nothing, and counts as a click.
    virtual bool double_click(std::size_t, const Point<double>&) { return false; }
    virtual bool undo() = 0;
    virtual bool redo() = 0;
    /// A key that means nothing to all windows. `at`: where the pointer is.
    virtual void key(const std::string& name, std::size_t pane, const Point<double>& at) = 0;
    virtual void timer() {}
    /// Does the left button draw lines, in place of selecting?
    virtual bool draws_lines() const { return false; }
    virtual void draw_line(std::size_t, const Point<double>&, const Point<double>&) {}
    /// The left button below the panes, at pixels from the lower left corner. Returns whether there is something to hold.
    virtual bool press_below(const Point<double>&) { return false; }
    virtual void move_below(const Point<double>&) {}

    vtkRenderer* lower() { return m_lower; }
    Damage& lower_damage() { return m_lower_damage; }
    /// Runs what may fail; an error is kept for the line.
    template <class Body>
    bool guarded(const Body& body) {
        try {
            m_error.clear();
            body();
            return true;
        } catch (const std::exception& e) {
            m_error = anamorph::message_of(e, "the picture");
            return false;
        }
    }
    /// Says that the result was drawn, which began at `start`, and is off by `max_error` source pixels at most (NaN: not proven), of the
    /// tolerance `tol`.
    void drew(std::chrono::steady_clock::time_point start, double max_error, double tol);
    /// The same of what the graphics card draws, which is off by `bound` at most.
    void drew_by_fragments(std::chrono::steady_clock::time_point start, double bound);
    void set_saved() { m_saved = this->text(); }
    bool has_gesture() const { return m_gesture != Gesture::none; }
    bool is_dragging() const { return m_gesture == Gesture::drag; }
    void render() { m_interactor->Render(); }
    /// Has the next drawing draw all panes.
    void forget_drawn() { m_forgotten = true; }

  private:
    enum class Gesture { none, drag, band, line, below, pan };
    using Display = std::array<int, 2>;

    static void handle(vtkObject* caller, unsigned long event, void* window, void*);
    void event(unsigned long event);
    void update();
    void draw_damage();
    void present();
    bool shows_a_window() const { return m_window->GetShowWindow() && !m_window->GetUseOffScreenBuffers(); }
    void press();
    void move();
    void release();
    void wheel(bool larger);
    void press_key();
    void control_key(const std::string& name);
    void end();
    void show_band();
    void write_status();
    std::size_t pane_at(const Display& at);
    Display mouse() const;
    Selecting selecting() const;
    void press_in_pane(const Display& at);
    bool is_second_click(const Display& at) const;

    std::string m_file, m_saved, m_status, m_error;
    std::string m_off;  ///< how far the result is off at most, in words; empty before it is drawn
    double m_milliseconds = 0, m_bound = 0;
    bool m_ended = false, m_warned = false, m_forgotten = true, m_by_fragments = false;
    Gesture m_gesture = Gesture::none;
    std::size_t m_held = 0;  ///< the pane in which a button was pressed
    Display m_pressed{}, m_last{};
    std::vector<std::unique_ptr<Pane>> m_panes;
    std::vector<std::unique_ptr<Overlay>> m_bands;
    vtkNew<vtkCallbackCommand> m_observer;
    Damage m_lower_damage;
    std::vector<anamorph::Box> m_drawn;  ///< pixels of the window that were drawn since it was presented
    std::int64_t m_drawn_area = 0;
    bool m_keeps_buffer = false;  ///< does what was presented stay behind the window?
    std::chrono::steady_clock::time_point m_presented_all;
    std::string m_written;  ///< the line as it is shown
    std::chrono::steady_clock::time_point m_written_at;
    vtkNew<vtkRenderer> m_lower;
    vtkNew<vtkTextActor> m_text;
    vtkNew<vtkRenderWindow> m_window;
    vtkNew<vtkRenderWindowInteractor> m_interactor;
};

}  // namespace anamorph_editor
