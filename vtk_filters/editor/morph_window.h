// SPDX-License-Identifier: Apache-2.0
// A window that edits the features of a morph (Kim 2003, 5.6.3 and Fig. 5.8): picture a, picture b and the one between them side by side,
// the features over both, and sliders for t and for a, b and p of the lines' weights.
//
//     n                  the next lines are drawn with the left button, until it is pressed again
//     delete, backspace  takes features away
//     space              plays t from 0 to 1 and back, or stops
//     comma, period      a step of t back or on
//     g                  shows the features or hides them
#pragma once

#include <array>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/morph/feature_editor.h"
#include "drawn_recipe.h"
#include "edit_window.h"
#include "fragment_picture.h"
#include "slider.h"

namespace anamorph_editor {

class MorphWindow final : public EditWindow {
  public:
    /// Opens a recipe of .morph with two pictures. `starts_empty`: there is no file of features yet. `save_as`: the file that is saved
    /// to, by its ending as JSON, CSV or SVG; by default the recipe's. Throws Error.
    MorphWindow(const std::string& recipe, bool starts_empty = false, const std::string& save_as = {});

    const anamorph::FeatureEditor& editor() const { return m_editor; }
    /// The slider of a key: t, weight_a, weight_b or weight_p.
    const Slider& slider(const std::string& name) const;
    bool plays() const { return m_timer != 0; }

  private:
    struct Opened;
    explicit MorphWindow(Opened opened);

    std::string text() const override;
    void draw(const std::vector<bool>& anew) override;
    std::string describe() const override;
    bool pick(std::size_t pane, const Point<double>& at, double within, Selecting how) override;
    void select_in(std::size_t pane, const anamorph::Bounds& box, Selecting how) override;
    void select_none() override { m_editor.select_none(); }
    void drag(std::size_t pane, const Point<double>& by) override;
    void end_drag(bool keep) override { m_editor.end_drag(keep); }
    bool undo() override { return m_editor.undo(); }
    bool redo() override { return m_editor.redo(); }
    void key(const std::string& name, std::size_t pane, const Point<double>& at) override;
    void timer() override;
    bool draws_lines() const override { return m_draws_lines; }
    void draw_line(std::size_t pane, const Point<double>& from, const Point<double>& to) override;
    bool press_below(const Point<double>& at) override;
    void move_below(const Point<double>& at) override;

    void draw_image(std::size_t i);
    void draw_picture(bool anew);
    void draw_by_core(const std::string& text);
    void draw_by_card();
    void draw_features();
    void set_value(const std::string& name, double value);
    void step(double by);
    void play();
    bool is_moving() const { return this->has_gesture() || this->plays(); }
    /// Pixels of the features' own per pixel of a picture.
    Point<double> unit(std::size_t shape) const;

    DrawnRecipe m_recipe;
    std::array<DrawnRecipe, 2> m_images;
    anamorph::Size m_picture;
    std::string m_format;
    anamorph::FeatureEditor m_editor;
    std::vector<std::unique_ptr<Slider>> m_sliders;
    Slider* m_held_slider = nullptr;
    bool m_draws_lines = false, m_shows_features = true;
    int m_timer = 0;
    double m_way = 1;  ///< 1 where t grows, -1 where it falls
    std::string m_drawn;
    std::unique_ptr<FragmentPicture> m_fragments;
    struct Overlays {
        Overlay lines, points, selected;
    };
    std::vector<std::unique_ptr<Overlays>> m_overlays;
};

}  // namespace anamorph_editor
