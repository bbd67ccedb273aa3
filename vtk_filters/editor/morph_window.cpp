// SPDX-License-Identifier: Apache-2.0
#include "morph_window.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "anamorph/morph/features_file.h"
#include "anamorph/operation/morph.h"
#include "anamorph/side_files.h"

namespace anamorph_editor {

using anamorph::Error;
using anamorph::FeatureEditor;
using anamorph::Features;
using anamorph::printable;
using anamorph::Size;

namespace {

constexpr std::array<double, 3> kLineColor{1, 0.85, 0.2}, kPointColor{1, 1, 1}, kSelectedColor{1, 0.25, 0.15};
constexpr double kStep = 0.05, kFrameStep = 1.0 / 60;
constexpr int kFrameTime = 33;  ///< ms
/// Sliders: key, and the range that it has at first.
struct Range {
    const char* name;
    double least, most;
};
constexpr Range kSliders[] = {{"t", 0, 1}, {"weight_a", 0, 50}, {"weight_b", 0, 4}, {"weight_p", 0, 2}};

Features opened_features(const DrawnRecipe& recipe, bool starts_empty) {
    const std::string& file = recipe.edited_file();
    const bool exists = anamorph::side_file_reader().exists(file);
    if (starts_empty && exists)
        throw Error("features", printable(file),
                    "is there already: must be another file where --new is given");
    if (starts_empty) return Features(2);
    if (!exists)
        throw Error("features", printable(file), "does not exist: must be a file, or --new be given");
    Features features = anamorph::parse_features_file(anamorph::side_file_reader().text(file), file);
    if (features.shapes() != 2)
        throw Error("features", printable(file),
                    "has " + std::to_string(features.shapes()) + " shapes: must have two to be edited");
    // A picture's layer is that which it is linked to, whatever the order of layers.
    const auto is_of = [&](int shape, std::size_t image) {
        const std::string& link = features.picture(shape);
        return !link.empty() && recipe.image_file(image).find(link) != std::string::npos;
    };
    const bool turned = is_of(0, 1) && is_of(1, 0) && !is_of(0, 0) && !is_of(1, 1);
    return turned ? features.in_order({1, 0}) : features;
}

}  // namespace

/// What the window is made of, in the order in which it is found.
struct MorphWindow::Opened {
    DrawnRecipe recipe;
    Features features;
    std::string title, file;

    Opened(const std::string& name, bool starts_empty, const std::string& save_as)
        : recipe(name, "features"),
          features(this->checked(starts_empty)),
          title("anamorph-warp: " + name),
          file(saved_file(save_as, recipe.edited_file(), {".json", ".csv", ".svg"})) {
        // Sizes are those of all pictures or of none.
        const bool framed = features.frame(0).width > 0 || features.frame(1).width > 0;
        for (int k = 0; framed && k < 2; ++k) {
            const Size size = recipe.image(static_cast<std::size_t>(k)).size();
            if (!(features.frame(k).width > 0))
                features.set_frame(k, {double(size.width), double(size.height)});
        }
        for (int k = 0; k < 2; ++k)
            if (features.picture(k).empty())
                features.set_title(k, features.title(k),
                                   std::filesystem::path(recipe.image_file(static_cast<std::size_t>(k)))
                                       .filename()
                                       .string());
    }

  private:
    /// Only what sliders and panes can show.
    Features checked(bool starts_empty) const {
        if (recipe.images() != 2)
            throw Error("a recipe of " + std::to_string(recipe.images()) +
                        " pictures: must have two, a and b");
        for (const char* key : {"shape_weights", "color_weights", "t_color"})
            if (recipe.values().given(key))
                throw Error(key, printable(recipe.values().text(key)), "must not be given: the window has t");
        return opened_features(recipe, starts_empty);
    }
};

MorphWindow::MorphWindow(const std::string& recipe, bool starts_empty, const std::string& save_as)
    : MorphWindow(Opened(recipe, starts_empty, save_as)) {}

MorphWindow::MorphWindow(Opened opened)
    : EditWindow(3, opened.title, opened.file, 0.12),
      m_recipe(std::move(opened.recipe)),
      m_images{DrawnRecipe(m_recipe, 0), DrawnRecipe(m_recipe, 1)},
      m_format(opened.file),
      m_editor(opened.features) {
    const anamorph::MorphRequest request =
        anamorph::read_morph_request(m_recipe.values(), {m_recipe.image(0).size(), m_recipe.image(1).size()});
    m_picture = {request.width, request.height};
    for (std::size_t i = 0; i < 2; ++i) {
        this->pane(i).set_picture(m_recipe.image(i).size());
        vtkRenderer* const renderer = this->pane(i).renderer();
        Damage& damage = this->pane(i).damage();
        m_overlays.emplace_back(new Overlays{{renderer, damage, kLineColor, 2},
                                             {renderer, damage, kPointColor, 5},
                                             {renderer, damage, kSelectedColor, 9}});
    }
    this->pane(2).set_picture(m_picture);
    for (const Range& range : kSliders)
        m_sliders.push_back(std::make_unique<Slider>(this->lower(), this->lower_damage(), range.name,
                                                     range.least, range.most,
                                                     m_recipe.values().number(range.name)));
    // A recipe that cannot be drawn is refused before there is a window.
    if (m_editor.features().size() > 0) m_recipe.ready(features_json(m_editor.features()), {});
    if (anamorph::side_file_reader().exists(m_recipe.edited_file())) this->set_saved();
}

std::string MorphWindow::text() const {
    return anamorph::features_text(m_editor.features(), m_format);
}

const Slider& MorphWindow::slider(const std::string& name) const {
    const auto found = std::find_if(m_sliders.begin(), m_sliders.end(),
                                    [&](const auto& slider) { return slider->name() == name; });
    if (found == m_sliders.end()) throw Error(name + ": there is no such slider");
    return **found;
}

void MorphWindow::draw(const std::vector<bool>& anew) {
    for (std::size_t i = 0; i < 2; ++i)
        if (anew[i]) this->draw_image(i);
    const int* size = this->lower()->GetSize();
    const double part = double(size[0]) / double(m_sliders.size());
    for (std::size_t i = 0; i < m_sliders.size(); ++i)
        m_sliders[i]->place(part * (double(i) + 0.1), part * (double(i) + 0.9), size[1] - 34);
    this->draw_features();
    this->draw_picture(anew[2]);
}

void MorphWindow::draw_image(std::size_t i) {
    Pane& pane = this->pane(i);
    const ReadyPicture ready = m_images[i].ready("", pane.drawn_size());
    m_images[i].draw(ready, pane.pixels().box, pane.pixels());
    pane.show(pane.pixels().box);
}

void MorphWindow::draw_picture(bool anew) {
    if (m_editor.features().size() == 0) return;
    const std::string text = features_json(m_editor.features());
    // What moves has a bound that is found quickly, and once it stands still a better one.
    const std::string all =
        text + m_recipe.values().key() + (this->draws_by_fragments() && this->is_moving() ? " moving" : "");
    if (!anew && all == m_drawn) return;
    this->pane(2).show_pixels(!this->draws_by_fragments());
    if (m_fragments) m_fragments->show(this->draws_by_fragments());
    // a of the weights is in pixels of the picture.
    const double a = m_recipe.values().number("weight_a");
    m_recipe.values().set("weight_a", a * this->pane(2).drawn_size().width / m_picture.width);
    const bool is_drawn =
        this->guarded([&] { this->draws_by_fragments() ? this->draw_by_card() : this->draw_by_core(text); });
    m_recipe.values().set("weight_a", a);
    if (!is_drawn) throw Error(this->error());
    m_drawn = all;
}

void MorphWindow::draw_by_core(const std::string& text) {
    const auto start = std::chrono::steady_clock::now();
    Pane& pane = this->pane(2);
    const ReadyPicture ready = m_recipe.ready(text, pane.drawn_size());
    m_recipe.draw(ready, pane.pixels().box, pane.pixels());
    pane.show(pane.pixels().box);
    this->drew(start, ready.max_error(), m_recipe.values().number("tol"));
}

void MorphWindow::draw_by_card() {
    const auto start = std::chrono::steady_clock::now();
    const std::vector<Size> sizes{m_recipe.image(0).size(), m_recipe.image(1).size()};
    const anamorph::MorphRequest request = anamorph::read_morph_request(m_recipe.values(), sizes);
    Features features = m_editor.features();
    if (request.pin_border) features.pin_border(*request.pin_border);
    const anamorph::MorphOptions& options = request.options;
    const anamorph::FeatureMap map(features, sizes, this->pane(2).drawn_size(),
                                   anamorph::shape_mixture(options, 2),
                                   {options.weight_a, options.weight_b, options.weight_p});
    if (!m_fragments) m_fragments = std::make_unique<FragmentPicture>(this->pane(2), m_recipe);
    this->pane(2).damage(this->pane(2).pixels().box);
    m_fragments->draw(map, anamorph::color_mixture(options, 2)[1], this->is_moving());
    this->drew_by_fragments(start, m_fragments->bound());
}

Point<double> MorphWindow::unit(std::size_t shape) const {
    const Features::Frame frame = m_editor.features().frame(static_cast<int>(shape));
    const Size size = m_recipe.image(shape).size();
    if (!(frame.width > 0)) return {1, 1};
    return {frame.width / size.width, frame.height / size.height};
}

void MorphWindow::draw_features() {
    for (std::size_t k = 0; k < 2; ++k) {
        const auto at = [&](const Point<double>& p) {
            return this->pane(k).to_renderer({p.x / this->unit(k).x, p.y / this->unit(k).y});
        };
        const auto shape = static_cast<int>(k);
        std::vector<Polyline> lines;
        Polyline points, selected;
        const Features& features = m_editor.features();
        for (std::size_t i = 0; m_shows_features && i < features.size(); ++i)
            lines.push_back({at(features.line(i, shape).p), at(features.line(i, shape).q)});
        if (m_shows_features)
            for (const FeatureEditor::Place& place : m_editor.points(shape))
                (m_editor.selected().count(place) ? selected : points).push_back(at(m_editor.at(place)));
        m_overlays[k]->lines.set_lines(lines);
        m_overlays[k]->points.set_points(points);
        m_overlays[k]->selected.set_points(selected);
    }
}

std::string MorphWindow::describe() const {
    std::string text = std::to_string(m_editor.features().size()) + " lines, " +
                       std::to_string(m_editor.selected().size()) + " points selected";
    if (m_draws_lines) text += "   drawing lines (n: no more)";
    return text;
}

bool MorphWindow::pick(std::size_t pane, const Point<double>& at, double within, Selecting how) {
    if (pane > 1) return false;
    const Point<double> unit = this->unit(pane);
    const auto place =
        m_editor.point_near(static_cast<int>(pane), {at.x * unit.x, at.y * unit.y}, within * unit.x);
    if (!place) return false;
    if (how != Selecting::only || m_editor.selected().count(*place) == 0) m_editor.select(*place, how);
    return true;
}

void MorphWindow::select_in(std::size_t pane, const anamorph::Bounds& box, Selecting how) {
    if (pane > 1) return;
    const Point<double> unit = this->unit(pane);
    m_editor.select_in(static_cast<int>(pane),
                       {box.x0 * unit.x, box.y0 * unit.y, box.x1 * unit.x, box.y1 * unit.y}, how);
}

void MorphWindow::drag(std::size_t pane, const Point<double>& by) {
    const Point<double> unit = this->unit(pane);
    m_editor.drag({by.x * unit.x, by.y * unit.y});
}

/// In the other picture the line begins at the same part of its width and height.
void MorphWindow::draw_line(std::size_t pane, const Point<double>& from, const Point<double>& to) {
    if (pane > 1) return;
    std::vector<anamorph::Line> line;
    const Size own = m_recipe.image(pane).size();
    for (std::size_t k = 0; k < 2; ++k) {
        const Size size = m_recipe.image(k).size();
        const Point<double> unit{this->unit(k).x * size.width / own.width,
                                 this->unit(k).y * size.height / own.height};
        line.push_back({{from.x * unit.x, from.y * unit.y}, {to.x * unit.x, to.y * unit.y}});
    }
    m_editor.add_line(line);
}

void MorphWindow::set_value(const std::string& name, double value) {
    m_recipe.values().set(name, value);
    for (const auto& slider : m_sliders)
        if (slider->name() == name) slider->set(value);
}

void MorphWindow::step(double by) {
    this->set_value("t", std::clamp(m_recipe.values().number("t") + by, 0.0, 1.0));
}

void MorphWindow::play() {
    if (m_timer != 0) {
        this->interactor()->DestroyTimer(m_timer);
        m_timer = 0;
        return;
    }
    m_timer = this->interactor()->CreateRepeatingTimer(kFrameTime);
}

void MorphWindow::timer() {
    if (m_timer == 0) return;
    const double t = m_recipe.values().number("t");
    if (t >= 1) m_way = -1;
    if (t <= 0) m_way = 1;
    this->step(m_way * kFrameStep);
    this->render();
}

bool MorphWindow::press_below(const Point<double>& at) {
    m_held_slider = nullptr;
    for (const auto& slider : m_sliders)
        if (slider->has(at)) m_held_slider = slider.get();
    if (m_held_slider) this->move_below(at);
    return m_held_slider != nullptr;
}

void MorphWindow::move_below(const Point<double>& at) {
    if (m_held_slider) this->set_value(m_held_slider->name(), m_held_slider->value_at(at.x));
}

void MorphWindow::key(const std::string& name, std::size_t, const Point<double>&) {
    if (name == "n") m_draws_lines = !m_draws_lines;
    if (name == "g") m_shows_features = !m_shows_features;
    if (name == "Delete" || name == "BackSpace") m_editor.remove_selected();
    if (name == "space") this->play();
    if (name == "comma") this->step(-kStep);
    if (name == "period") this->step(kStep);
}

}  // namespace anamorph_editor
