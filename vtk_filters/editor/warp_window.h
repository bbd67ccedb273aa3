// SPDX-License-Identifier: Apache-2.0
// A window that edits the control mesh of a warp (Kim 2003, 5.5 and Fig. 5.8): the source on the left, the picture on the right, and
// the mesh over both. Its points are dragged where its vertices lie: over the source of a mesh that pulls, over the picture of one
// that pushes.
//
//     double click, c    cuts the cell under the pointer into four
//     g                  shows the mesh or hides it
#pragma once

#include <optional>
#include <string>

#include "anamorph/mesh/mesh_editor.h"
#include "drawn_recipe.h"
#include "edit_window.h"
#include "fragment_picture.h"

namespace anamorph_editor {

class WarpWindow final : public EditWindow {
  public:
    /// Opens a recipe of .warp whose mesh is a .json file. `cells`: where there is no such file, the cells across and down of the mesh that it
    /// starts with; 0 by 0: there has to be one. `save_as`: the file that is saved to; by default the mesh's. Throws Error.
    WarpWindow(const std::string& recipe, const anamorph::Size& cells = {}, const std::string& save_as = {});

    const anamorph::MeshEditor& editor() const { return m_editor; }
    /// The pane in which points are dragged.
    std::size_t edited_pane() const { return m_pulls ? 0 : 1; }
    /// The pixels of the picture that were drawn last, together.
    std::int64_t drawn_pixels() const { return m_drawn_pixels; }

  private:
    struct Opened;
    explicit WarpWindow(Opened opened);

    std::string text() const override;
    void draw(const std::vector<bool>& anew) override;
    std::string describe() const override;
    bool pick(std::size_t pane, const Point<double>& at, double within, Selecting how) override;
    void select_in(std::size_t pane, const anamorph::Bounds& box, Selecting how) override;
    void select_none() override { m_editor.select_none(); }
    void drag(std::size_t pane, const Point<double>& by) override;
    void end_drag(bool keep) override { m_editor.end_drag(keep); }
    bool double_click(std::size_t pane, const Point<double>& at) override;
    bool undo() override { return m_editor.undo(); }
    bool redo() override { return m_editor.redo(); }
    void key(const std::string& name, std::size_t pane, const Point<double>& at) override;

    void draw_source();
    void draw_picture(bool anew);
    void draw_by_core(const anamorph::Mesh& map, const std::string& text, bool anew);
    void draw_by_card(const anamorph::Mesh& map, bool anew);
    void draw_mesh();
    /// The mesh as the operation reads it for a picture of the size in which it is drawn.
    anamorph::ControlMesh scaled_mesh() const;
    std::vector<anamorph::Box> boxes_to_draw(const anamorph::Mesh* before, const anamorph::Mesh& now,
                                             bool anew);

    DrawnRecipe m_recipe, m_source;
    anamorph::Size m_from, m_to;
    anamorph::Direction m_own_direction;
    bool m_pulls;
    anamorph::MeshEditor m_editor;
    bool m_shows_mesh = true;
    /// What the picture was drawn by.
    std::optional<anamorph::Mesh> m_drawn_mesh;
    std::string m_drawn_text;
    std::int64_t m_drawn_pixels = 0;
    std::unique_ptr<FragmentPicture> m_fragments;
    /// Edges of cells in the image that the mesh lies in, and in the one that its vertices lie in; points.
    Overlay m_lattice, m_edges, m_free, m_selected, m_fixed;
};

}  // namespace anamorph_editor
