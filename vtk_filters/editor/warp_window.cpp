// SPDX-License-Identifier: Apache-2.0
#include "warp_window.h"

#include <algorithm>
#include <chrono>
#include <climits>
#include <cmath>
#include <set>

#include "anamorph/mesh/mesh_file.h"
#include "anamorph/operation/warp.h"
#include "anamorph/side_files.h"
#include "card_texels.h"

namespace anamorph_editor {

using anamorph::Box;
using anamorph::ControlMesh;
using anamorph::Direction;
using anamorph::Error;
using anamorph::Mesh;
using anamorph::MeshEditor;
using anamorph::printable;
using anamorph::Size;

namespace {

constexpr std::array<double, 3> kLatticeColor{0.55, 0.65, 0.75}, kEdgeColor{1, 0.85, 0.2},
    kFreeColor{1, 1, 1}, kSelectedColor{1, 0.25, 0.15}, kFixedColor{0.3, 0.9, 1};
/// Half of the arms of the cross that a T-vertex is shown as, in pixels of the window.
constexpr double kCross = 4;

ControlMesh even_mesh(const Size& cells) {
    ControlMesh mesh;
    mesh.units = anamorph::Units::fractions;
    mesh.columns = cells.width;
    mesh.rows = cells.height;
    for (int row = 0; row <= cells.height; ++row)
        for (int column = 0; column <= cells.width; ++column)
            mesh.vertices.push_back({double(column) / cells.width, double(row) / cells.height});
    return mesh;
}

ControlMesh opened_mesh(const DrawnRecipe& recipe, const Size& cells) {
    const std::string& file = recipe.edited_file();
    if (!file.ends_with(".json")) throw Error("mesh", printable(file), "must be a .json file to be edited");
    const bool exists = anamorph::side_file_reader().exists(file);
    if (cells.width > 0 && exists)
        throw Error("mesh", printable(file), "is there already: must be another file where --cells is given");
    if (cells.width > 0) return even_mesh(cells);
    if (!exists)
        throw Error("mesh", printable(file),
                    "does not exist: must be a mesh, or --cells be given for a new one");
    const anamorph::WarpMap map = anamorph::parse_mesh_json(anamorph::side_file_reader().text(file), file);
    const auto* mesh = std::get_if<ControlMesh>(&map.shape);
    if (!mesh) throw Error("mesh", printable(file), "the file holds points: must hold a mesh to be edited");
    return *mesh;
}

/// The same pixels in boxes that do not overlap: in each stretch of rows, all columns from the first to the last.
std::vector<Box> apart(const std::vector<Box>& boxes) {
    std::set<int> rows;
    for (const Box& box : boxes) rows.insert({box.y0, box.y1});
    std::vector<Box> out;
    for (auto row = rows.begin(); row != rows.end() && std::next(row) != rows.end(); ++row) {
        Box stretch{INT_MAX, *row, INT_MIN, *std::next(row)};
        for (const Box& box : boxes)
            if (box.y0 < stretch.y1 && box.y1 > stretch.y0) {
                stretch.x0 = std::min(stretch.x0, box.x0);
                stretch.x1 = std::max(stretch.x1, box.x1);
            }
        if (stretch.empty()) continue;
        Box* last = out.empty() ? nullptr : &out.back();
        if (last && last->y1 == stretch.y0 && last->x0 == stretch.x0 && last->x1 == stretch.x1)
            last->y1 = stretch.y1;
        else
            out.push_back(stretch);
    }
    return out;
}

/// The cells' edges where the mesh lies.
std::vector<Polyline> lattice_of(const Mesh& mesh) {
    std::vector<Polyline> lines;
    for (anamorph::MeshEdge& edge : anamorph::mesh_edges(mesh, false)) lines.push_back(std::move(edge.line));
    return lines;
}

}  // namespace

/// What the window is made of, in the order in which it is found.
struct WarpWindow::Opened {
    DrawnRecipe recipe;
    ControlMesh mesh;
    Direction own_direction;
    Size source, picture;
    std::string title, file;

    Opened(const std::string& name, const Size& cells, const std::string& save_as)
        : recipe(name, "mesh"),
          mesh(opened_mesh(recipe, cells)),
          own_direction(mesh.direction),
          source(recipe.image(0).size()),
          picture(anamorph::warp_target(recipe.values(), source)),
          title("anamorph-warp: " + name),
          file(saved_file(save_as, recipe.edited_file(), {".json"})) {
        if (recipe.values().given("direction"))
            mesh.direction = anamorph::read_warp_request(recipe.values(), source).direction.value();
    }
    bool pulls() const { return mesh.direction == Direction::pull; }
};

WarpWindow::WarpWindow(const std::string& recipe, const Size& cells, const std::string& save_as)
    : WarpWindow(Opened(recipe, cells, save_as)) {}

WarpWindow::WarpWindow(Opened opened)
    : EditWindow(2, opened.title, opened.file, 0.06),
      m_recipe(std::move(opened.recipe)),
      m_source(m_recipe, 0),
      m_from(opened.pulls() ? opened.picture : opened.source),
      m_to(opened.pulls() ? opened.source : opened.picture),
      m_own_direction(opened.own_direction),
      m_pulls(opened.pulls()),
      m_editor(opened.mesh, m_from, m_to, printable(m_recipe.edited_file())),
      m_lattice(this->pane(1 - this->edited_pane()).renderer(), this->pane(1 - this->edited_pane()).damage(),
                kLatticeColor, 1),
      m_edges(this->pane(this->edited_pane()).renderer(), this->pane(this->edited_pane()).damage(),
              kEdgeColor, 1),
      m_free(this->pane(this->edited_pane()).renderer(), this->pane(this->edited_pane()).damage(), kFreeColor,
             5),
      m_selected(this->pane(this->edited_pane()).renderer(), this->pane(this->edited_pane()).damage(),
                 kSelectedColor, 9),
      m_fixed(this->pane(this->edited_pane()).renderer(), this->pane(this->edited_pane()).damage(),
              kFixedColor, 1) {
    this->pane(0).set_picture(opened.source);
    this->pane(1).set_picture(opened.picture);
    // A recipe that cannot be drawn is refused before there is a window.
    m_recipe.ready(this->text(), {});
    if (anamorph::side_file_reader().exists(m_recipe.edited_file())) this->set_saved();
}

std::string WarpWindow::text() const {
    ControlMesh mesh = m_editor.mesh();
    mesh.direction = m_own_direction;
    return anamorph::mesh_json(mesh);
}

ControlMesh WarpWindow::scaled_mesh() const {
    ControlMesh mesh = m_editor.mesh();
    const Size source = m_pulls ? m_to : m_from, picture = m_pulls ? m_from : m_to;
    const bool is_whole = this->pane(1).drawn_size() == picture;
    if (is_whole) return mesh;
    return std::get<ControlMesh>(anamorph::in_fractions({"mesh", mesh}, source, picture).shape);
}

void WarpWindow::draw(const std::vector<bool>& anew) {
    if (anew[0]) this->draw_source();
    this->draw_picture(anew[1]);
    this->draw_mesh();
}

void WarpWindow::draw_source() {
    Pane& pane = this->pane(0);
    const ReadyPicture ready = m_source.ready("", pane.drawn_size());
    m_source.draw(ready, pane.pixels().box, pane.pixels());
    pane.show(pane.pixels().box);
}

/// All that is seen, or what the mesh changed of it.
std::vector<Box> WarpWindow::boxes_to_draw(const Mesh* before, const Mesh& now, bool anew) {
    const Box seen = this->pane(1).pixels().box;
    const anamorph::ParameterValues& values = m_recipe.values();
    const std::string& scheme = values.text("scheme");
    const bool by_cells =
        m_pulls && scheme != "hardware" && scheme != "residual" && values.text("output") != "mesh";
    if (anew || !before || !by_cells || !(before->from() == now.from())) return {seen};
    std::vector<Box> boxes;
    for (const Box& box : apart(anamorph::changed_pixels(*before, now)))
        if (const Box part = anamorph::intersection(box, seen); !part.empty()) boxes.push_back(part);
    return boxes;
}

void WarpWindow::draw_picture(bool anew) {
    const ControlMesh mesh = this->scaled_mesh();
    std::string text = anamorph::mesh_json(mesh);
    if (!anew && text == m_drawn_text) return;
    const Size drawn = this->pane(1).drawn_size();
    Mesh map(mesh, m_pulls ? drawn : m_from, m_pulls ? m_to : drawn, m_recipe.values().number("amount"));
    this->pane(1).show_pixels(!this->draws_by_fragments());
    if (m_fragments) m_fragments->show(this->draws_by_fragments());
    if (this->draws_by_fragments())
        this->draw_by_card(map, anew);
    else
        this->draw_by_core(map, text, anew);
    m_drawn_mesh = std::move(map);
    m_drawn_text = std::move(text);
}

void WarpWindow::draw_by_card(const Mesh& map, bool anew) {
    const auto start = std::chrono::steady_clock::now();
    if (!m_pulls) anamorph_viewer::refuse_card("meshes that push");
    if (!m_fragments) m_fragments = std::make_unique<FragmentPicture>(this->pane(1), m_recipe);
    m_fragments->draw(map);
    for (const Box& box : this->boxes_to_draw(m_drawn_mesh ? &*m_drawn_mesh : nullptr, map, anew))
        this->pane(1).damage(box);
    this->drew_by_fragments(start, m_fragments->bound());
}

void WarpWindow::draw_by_core(const Mesh& map, const std::string& text, bool anew) {
    const auto start = std::chrono::steady_clock::now();
    Pane& pane = this->pane(1);
    const ReadyPicture ready = m_recipe.ready(text, pane.drawn_size());
    m_drawn_pixels = 0;
    for (const Box& box : this->boxes_to_draw(m_drawn_mesh ? &*m_drawn_mesh : nullptr, map, anew)) {
        m_recipe.draw(ready, box, pane.pixels());
        pane.show(box);
        m_drawn_pixels += std::int64_t{box.width()} * box.height();
    }
    this->drew(start, ready.max_error(), m_recipe.values().number("tol"));
}

void WarpWindow::draw_mesh() {
    const Pane &edited = this->pane(this->edited_pane()), &other = this->pane(1 - this->edited_pane());
    if (!m_shows_mesh) {
        for (Overlay* overlay : {&m_lattice, &m_edges, &m_fixed}) overlay->set_lines({});
        for (Overlay* overlay : {&m_free, &m_selected}) overlay->set_points({});
        return;
    }
    m_lattice.set_lines(other.to_renderer(lattice_of(m_editor.map())));
    m_edges.set_lines(edited.to_renderer(m_editor.edges()));
    Polyline free, selected;
    std::vector<Polyline> fixed;
    for (const MeshEditor::ControlPoint& point : m_editor.points()) {
        const Point<double> at = edited.to_renderer(point.at);
        if (point.is_fixed) {
            fixed.push_back({{at.x - kCross, at.y - kCross}, {at.x + kCross, at.y + kCross}});
            fixed.push_back({{at.x - kCross, at.y + kCross}, {at.x + kCross, at.y - kCross}});
        } else {
            (m_editor.selected().count(point.place) ? selected : free).push_back(at);
        }
    }
    m_free.set_points(free);
    m_selected.set_points(selected);
    m_fixed.set_lines(fixed);
}

std::string WarpWindow::describe() const {
    return std::to_string(m_editor.selected().size()) + " of " + std::to_string(m_editor.points().size()) +
           " points selected";
}

bool WarpWindow::pick(std::size_t pane, const Point<double>& at, double within, Selecting how) {
    if (pane != this->edited_pane()) return false;
    const auto place = m_editor.point_near(at, within);
    if (!place) return false;
    if (how != Selecting::only || m_editor.selected().count(*place) == 0) m_editor.select(*place, how);
    return true;
}

void WarpWindow::select_in(std::size_t pane, const anamorph::Bounds& box, Selecting how) {
    if (pane == this->edited_pane()) m_editor.select_in(box, how);
}

void WarpWindow::drag(std::size_t, const Point<double>& by) {
    m_editor.drag(by);
}

bool WarpWindow::double_click(std::size_t pane, const Point<double>& at) {
    const Point<double> place = pane == this->edited_pane() ? at : m_editor.map().at(at.x, at.y);
    if (!m_editor.cut_at(place)) throw Error("there is no cell to be cut here");
    return true;
}

void WarpWindow::key(const std::string& name, std::size_t pane, const Point<double>& at) {
    if (name == "c") this->double_click(pane, at);
    if (name == "g") m_shows_mesh = !m_shows_mesh;
}

}  // namespace anamorph_editor
