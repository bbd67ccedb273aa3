// SPDX-License-Identifier: Apache-2.0
#include "bump_editor.h"

#include <vtkCamera.h>
#include <vtkObjectFactory.h>
#include <vtkPointSet.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>

#include <algorithm>
#include <cmath>
#include <limits>

vtkStandardNewMacro(BumpEditor);

namespace {

constexpr double kReach = 12;            ///< pixels from a + at which it is caught
constexpr double kDegrees = 5;           ///< that an arrow key turns the view
constexpr double kWidenPerPixel = 1.01;  ///< factor of the extents

}  // namespace

void BumpEditor::edit(vtkAnamorphDeform* deform, vtkRenderer* renderer) {
    m_deform = deform;
    m_renderer = renderer;
    this->SetDefaultRenderer(renderer);
}

BumpEditor::Bump BumpEditor::bump(int position) const {
    Bump result;
    const double* numbers = m_deform->GetDeformation(position);
    std::copy(numbers, numbers + result.size(), result.begin());
    return result;
}

std::array<double, 3> BumpEditor::handle(int position) const {
    m_deform->Update();
    auto* before = vtkPointSet::SafeDownCast(m_deform->GetInputDataObject(0, 0));
    auto* after = vtkPointSet::SafeDownCast(m_deform->GetOutputDataObject(0));
    const Bump wanted = this->bump(position);
    vtkIdType nearest = 0;
    double least = std::numeric_limits<double>::infinity();
    for (vtkIdType i = 0; i < before->GetNumberOfPoints(); ++i) {
        const double* p = before->GetPoint(i);
        const double distance = std::hypot(p[0] - wanted[0], p[1] - wanted[1]);
        if (distance < least) {
            least = distance;
            nearest = i;
        }
    }
    std::array<double, 3> result;
    after->GetPoint(nearest, result.data());
    return result;
}

// ---- Edits ----

void BumpEditor::put(int position, const Bump& b) {
    m_deform->SetDeformation(position, b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8]);
}

void BumpEditor::apply(const Edit& edit) {
    if (edit.before && edit.after) {
        this->put(edit.position, *edit.after);
    } else if (edit.after) {
        const Bump& b = *edit.after;
        m_deform->InsertDeformation(edit.position, b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7], b[8]);
    } else {
        m_deform->RemoveDeformation(edit.position);
    }
    m_selected = edit.after ? edit.position : -1;
    m_renderer->ResetCameraClippingRange();
    this->Interactor->Render();
}

void BumpEditor::make(const Edit& edit) {
    m_done.push_back(edit);
    m_undone.clear();
    this->apply(edit);
}

void BumpEditor::undo() {
    if (m_done.empty() || m_drag != Drag::none) return;
    m_undone.push_back(m_done.back());
    m_done.pop_back();
    this->apply(m_undone.back().opposite());
}

void BumpEditor::redo() {
    if (m_undone.empty() || m_drag != Drag::none) return;
    m_done.push_back(m_undone.back());
    m_undone.pop_back();
    this->apply(m_done.back());
}

// ---- The mouse ----

int BumpEditor::bump_at_mouse() const {
    const int* mouse = this->Interactor->GetEventPosition();
    int found = -1;
    double least = kReach;
    for (int i = 0; i < this->bumps(); ++i) {
        const std::array<double, 3> at = this->handle(i);
        m_renderer->SetWorldPoint(at[0], at[1], at[2], 1);
        m_renderer->WorldToDisplay();
        const double* seen = m_renderer->GetDisplayPoint();
        const double distance = std::hypot(seen[0] - mouse[0], seen[1] - mouse[1]);
        if (distance < least) {
            least = distance;
            found = i;
        }
    }
    return found;
}

/// Where the line of sight through the mouse meets the plane at z; nothing if it does not.
std::optional<std::array<double, 2>> BumpEditor::mouse_at_height(double z) const {
    const int* mouse = this->Interactor->GetEventPosition();
    double ends[2][4];
    for (int k = 0; k < 2; ++k) {
        m_renderer->SetDisplayPoint(mouse[0], mouse[1], k);
        m_renderer->DisplayToWorld();
        m_renderer->GetWorldPoint(ends[k]);
        for (int c = 0; c < 3; ++c) ends[k][c] /= ends[k][3];
    }
    const double t = (z - ends[0][2]) / (ends[1][2] - ends[0][2]);
    if (!(t >= 0 && t <= 1)) return std::nullopt;
    return std::array{ends[0][0] + t * (ends[1][0] - ends[0][0]), ends[0][1] + t * (ends[1][1] - ends[0][1])};
}

/// At the distance of the camera's focal point.
double BumpEditor::length_of_a_pixel() const {
    vtkCamera* camera = m_renderer->GetActiveCamera();
    const double height =
        camera->GetParallelProjection()
            ? 2 * camera->GetParallelScale()
            : 2 * camera->GetDistance() * std::tan(0.5 * camera->GetViewAngle() * std::acos(-1.0) / 180);
    return height / m_renderer->GetSize()[1];
}

/// From here on the bump keeps its place beside the mouse.
void BumpEditor::start_move() {
    const Bump b = this->bump(m_selected);
    if (const auto at = this->mouse_at_height(m_height)) m_grip = {b[0] - (*at)[0], b[1] - (*at)[1]};
}

void BumpEditor::OnLeftButtonDown() {
    const int found = this->bump_at_mouse();
    if (found < 0) {
        this->Superclass::OnLeftButtonDown();
        return;
    }
    m_selected = found;
    m_before = this->bump(found);
    m_height = this->handle(found)[2];
    const int* mouse = this->Interactor->GetEventPosition();
    m_last = {mouse[0], mouse[1]};
    m_drag = this->Interactor->GetShiftKey()     ? Drag::raise
             : this->Interactor->GetControlKey() ? Drag::widen
                                                 : Drag::move;
    this->start_move();
}

void BumpEditor::OnMouseMove() {
    if (m_drag == Drag::none) {
        this->Superclass::OnMouseMove();
        return;
    }
    this->drag_to_mouse();
    this->Interactor->Render();
}

void BumpEditor::drag_to_mouse() {
    const int* mouse = this->Interactor->GetEventPosition();
    if (m_last == std::array{mouse[0], mouse[1]}) return;
    const int up = mouse[1] - m_last[1];
    m_last = {mouse[0], mouse[1]};
    Bump b = this->bump(m_selected);
    if (m_drag == Drag::raise) {
        b[6] += up * this->length_of_a_pixel();
    } else if (m_drag == Drag::widen) {
        const double factor = std::pow(kWidenPerPixel, up);
        b[2] *= factor;
        b[3] *= factor;
    } else if (const auto at = this->mouse_at_height(m_height)) {
        b[0] = (*at)[0] + m_grip[0];
        b[1] = (*at)[1] + m_grip[1];
    }
    this->put(m_selected, b);
}

void BumpEditor::OnLeftButtonUp() {
    if (m_drag == Drag::none) {
        this->Superclass::OnLeftButtonUp();
        return;
    }
    // The last piece of the way may come without a move of its own.
    this->drag_to_mouse();
    m_drag = Drag::none;
    const Bump b = this->bump(m_selected);
    if (b != m_before) this->make({m_selected, m_before, b});
}

// ---- Keys ----

void BumpEditor::rotate(double azimuth, double elevation) {
    vtkCamera* camera = m_renderer->GetActiveCamera();
    camera->Azimuth(azimuth);
    camera->Elevation(elevation);
    camera->OrthogonalizeViewUp();
    m_renderer->ResetCameraClippingRange();
    if (m_drag == Drag::move) this->start_move();
    this->Interactor->Render();
}

void BumpEditor::OnKeyPress() {
    const std::string key = this->Interactor->GetKeySym() ? this->Interactor->GetKeySym() : "";
    if (key == "Left" || key == "Right") this->rotate(key == "Left" ? kDegrees : -kDegrees, 0);
    if (key == "Up" || key == "Down") this->rotate(0, key == "Up" ? -kDegrees : kDegrees);
    if (key == "z") this->undo();
    if (key == "y") this->redo();
    if (m_drag != Drag::none) return;
    if (key == "n")
        if (const auto at = this->mouse_at_height(0))
            this->make({this->bumps(), std::nullopt, Bump{(*at)[0], (*at)[1], 0.1, 0.1, 0, 0, 0.1, 0, 1}});
    if (key == "Delete" && m_selected >= 0) this->make({m_selected, this->bump(m_selected), std::nullopt});
}

/// Keys have a meaning of their own here; of the usual ones, these stay.
void BumpEditor::OnChar() {
    const char key = this->Interactor->GetKeyCode();
    if (std::string("eqrsw").find(key) != std::string::npos) this->Superclass::OnChar();
}
