// SPDX-License-Identifier: Apache-2.0
// Edits the list of a vtkAnamorphDeform with the mouse.
//
//     left, on a bump's +       drags the bump over the surface
//       with Shift              up and down: raises and lowers it
//       with Control            up and down: makes it wider and narrower
//     left elsewhere            rotates the view; middle pans, right zooms
//     arrows                    rotate the view, also while a bump is dragged
//     n                         a new bump under the mouse
//     Delete                    removes the selected bump
//     z, y                      undo, redo (a drag is one step)
#pragma once

#include <vtkAnamorphDeform.h>
#include <vtkInteractorStyleTrackballCamera.h>
#include <vtkNew.h>
#include <vtkRenderer.h>

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <vector>

class BumpEditor : public vtkInteractorStyleTrackballCamera {
  public:
    static BumpEditor* New();
    vtkTypeMacro(BumpEditor, vtkInteractorStyleTrackballCamera);

    /// The parameters of `deform` have to be x and y of its input.
    void edit(vtkAnamorphDeform* deform, vtkRenderer* renderer);

    /// The nine numbers of a deformation: centre, extent, displacement, kernel, enabled.
    using Bump = std::array<double, 9>;
    int bumps() const { return m_deform->GetNumberOfDeformations(); }
    Bump bump(int position) const;
    /// The selected one's position in the list, or -1.
    int selected() const { return m_selected; }
    /// Where the centre of a bump is on the deformed surface.
    std::array<double, 3> handle(int position) const;

    void undo();
    void redo();

    void OnLeftButtonDown() override;
    void OnLeftButtonUp() override;
    void OnMouseMove() override;
    void OnKeyPress() override;
    void OnChar() override;

  private:
    /// What an edit changes: nothing before is an added bump, nothing after a removed one.
    struct Edit {
        int position;
        std::optional<Bump> before, after;
        Edit opposite() const { return {position, after, before}; }
    };
    enum class Drag { none, move, raise, widen };

    void put(int position, const Bump& bump);
    void apply(const Edit& edit);
    void make(const Edit& edit);
    void rotate(double azimuth, double elevation);
    void start_move();
    void drag_to_mouse();
    int bump_at_mouse() const;
    std::optional<std::array<double, 2>> mouse_at_height(double z) const;
    double length_of_a_pixel() const;

    vtkAnamorphDeform* m_deform = nullptr;
    vtkRenderer* m_renderer = nullptr;
    std::vector<Edit> m_done, m_undone;
    int m_selected = -1;
    Drag m_drag = Drag::none;
    Bump m_before{};                 ///< the bump when the drag began
    std::array<int, 2> m_last{};     ///< where the mouse was
    double m_height = 0;             ///< of the plane in which the bump is moved
    std::array<double, 2> m_grip{};  ///< from the mouse's point of that plane to the bump's centre
};
