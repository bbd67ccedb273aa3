// SPDX-License-Identifier: Apache-2.0
// A control mesh that is edited (Kim 2003, 5.5): what a window for warps does, without the window. Control points are selected and
// dragged, cells are cut finer, and every step may be undone.
//
// Frames. Positions are in pixels of the image that the mesh's vertices lie in ("to" of mesh.h: of a mesh that pulls the source,
// of one that pushes the picture), whatever units the mesh has, which it keeps.
#pragma once

#include <compare>
#include <cstddef>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "anamorph/editing.h"
#include "anamorph/geometry/bounds_tree.h"
#include "anamorph/geometry/box.h"
#include "anamorph/mesh/mesh.h"
#include "anamorph/mesh/mesh_edges.h"

namespace anamorph {

class MeshEditor {
  public:
    /// A vertex, by its numbers on the lattice of the coarsest level that has it.
    struct Place {
        int level, column, row;
        friend auto operator<=>(const Place&, const Place&) = default;
    };
    struct ControlPoint {
        Place place;
        Point<double> at;
        /// Is it a T-vertex: one on a cell that is not cut, which follows the patch of that cell and cannot be dragged?
        bool is_fixed;
    };

    /// Starts with a mesh that lies in an image of the size `from` and whose vertices lie in one of the size `to`. `name`: what
    /// messages call it. Throws Error where the map of the mesh does, and for ST-maps that are taken pixel for pixel.
    MeshEditor(ControlMesh mesh, const Size& from, const Size& to, const std::string& name = "mesh");

    const ControlMesh& mesh() const { return m_state.mesh; }
    /// The map of the mesh as it is now.
    const Mesh& map() const { return m_map; }
    /// All vertices of cells that are not cut, in order of their places; none of the lines that are added around the given ones.
    const std::vector<ControlPoint>& points() const { return m_points; }
    /// The edges of all cells, each a line of kEdgeSteps steps along the map.
    std::vector<std::vector<Point<double>>> edges() const;
    static constexpr int kEdgeSteps = kMeshEdgeSteps;

    const std::set<Place>& selected() const { return m_state.selected; }
    /// The control point nearest to a position, no farther than `within`, that can be dragged.
    std::optional<Place> point_near(const Point<double>& at, double within) const;
    /// Selects one point; of a T-vertex, or where there is none, nothing changes.
    void select(const Place& place, Selecting how);
    /// Selects the points in a rectangle that can be dragged.
    void select_in(const Bounds& box, Selecting how);
    void select_none() { m_state.selected.clear(); }

    /// Moves the selected points to `by` pixels from where they were when dragging began, which it does by this. All of a drag is
    /// one step. Throws Error, and leaves all as it was, where a point would lie farther than ControlMesh::kMaxPosition or `by` is
    /// no number.
    void drag(const Point<double>& by);
    bool is_dragging() const { return m_before.has_value(); }
    /// Ends a drag; with `keep` false all is as before it.
    void end_drag(bool keep = true);

    /// Cuts the cell that shows at a position into four, and those around it as far as neighbours must be within one level. Where
    /// the mesh folds, of several cells the finest. False where no cell shows there, or one beyond the mesh's given lines. Throws
    /// Error where the mesh would have more levels or vertices than ControlMesh allows.
    bool cut_at(const Point<double>& at);

    /// Takes back the last step, or does it again. False where there is none.
    bool undo() { return restore(m_steps.undo(settled())); }
    bool redo() { return restore(m_steps.redo(settled())); }
    /// The number of steps that may be taken back: the last kMostUndoSteps, fewer where their meshes have more than
    /// ControlMesh::kMaxVertices vertices together, at least one.
    std::size_t steps() const { return m_steps.kept().size(); }

  private:
    struct State {
        ControlMesh mesh;
        std::set<Place> selected;
    };
    /// A position of the mesh that is dragged: of vertex `index` of a level.
    struct Handle {
        int level;
        std::size_t index;
        Point<double> from;
    };

    void take(ControlMesh mesh);
    void find_points();
    void start_drag();
    /// The vertex that says where a point lies, made where none does so far.
    Handle handle_of(ControlMesh& mesh, const Place& place) const;
    void keep_step(State before);
    /// The state after a drag that is ended.
    const State& settled() {
        end_drag();
        return m_state;
    }
    bool restore(std::optional<State> state);

    Size m_from, m_to;
    std::string m_name;
    State m_state;
    Mesh m_map;
    std::vector<ControlPoint> m_points;
    std::optional<State> m_before;
    std::vector<Handle> m_handles;
    UndoSteps<State> m_steps;
};

/// The pixels of "from" that two meshes, of the same images, may map differently, in boxes that may overlap: those of all cells
/// whose patches differ, and of the blocks that these meet. A picture that a mesh pulls has the same bits in all others.
std::vector<Box> changed_pixels(const Mesh& before, const Mesh& after);

}  // namespace anamorph
