// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphPanoramaStyle.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "vtkCallbackCommand.h"
#include "vtkCamera.h"
#include "vtkCommand.h"
#include "vtkMath.h"
#include "vtkObjectFactory.h"
#include "vtkRenderWindow.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkRenderer.h"
#include "vtkRendererCollection.h"

vtkStandardNewMacro(vtkAnamorphPanoramaStyle);

namespace {

/// A step of the wheel, and of a key.
constexpr double kZoomStep = 1.1;
/// Of the field of view: a step of an arrow key.
constexpr double kKeyStep = 0.1;
/// A press and a release as near to each other as this, in pixels, are a click.
constexpr int kClick = 3;
/// Pixels of a drag that zoom as much as a step of the wheel.
constexpr double kPixelsOfStep = 10;

double radians(double degrees) {
    return degrees * (vtkMath::Pi() / 180);
}
double degrees(double radians) {
    return radians * (180 / vtkMath::Pi());
}

/// Sets a range that lies within [least, most]. Has it changed?
bool set_range(double range[2], double from, double to, double least, double most) {
    if (!(from >= least && to <= most && from <= to)) return false;
    if (range[0] == from && range[1] == to) return false;
    range[0] = from;
    range[1] = to;
    return true;
}

/// Whether there is a window to end a drag in: it may have gone in the midst of one.
bool has_window(vtkRenderWindowInteractor* interactor) {
    return interactor && interactor->GetRenderWindow();
}

}  // namespace

void vtkAnamorphPanoramaStyle::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Yaw: " << this->Yaw << "\n";
    os << indent << "Pitch: " << this->Pitch << "\n";
    os << indent << "FieldOfView: " << this->FieldOfView << "\n";
    os << indent << "PitchRange: " << this->PitchRange[0] << " " << this->PitchRange[1] << "\n";
    os << indent << "FieldOfViewRange: " << this->FieldOfViewRange[0] << " " << this->FieldOfViewRange[1]
       << "\n";
    os << indent << "MoveCamera: " << this->MoveCamera << "\n";
}

void vtkAnamorphPanoramaStyle::SetYaw(double value) {
    if (!std::isfinite(value)) return;
    value -= 360 * std::floor((value + 180) / 360);
    if (value >= 180) value = -180;  // by rounding
    if (value == this->Yaw) return;
    this->Yaw = value;
    this->Modified();
}

void vtkAnamorphPanoramaStyle::SetPitch(double value) {
    if (std::isnan(value)) return;
    value = std::clamp(value, this->PitchRange[0], this->PitchRange[1]);
    if (value == this->Pitch) return;
    this->Pitch = value;
    this->Modified();
}

void vtkAnamorphPanoramaStyle::SetFieldOfView(double value) {
    if (std::isnan(value)) return;
    value = std::clamp(value, this->FieldOfViewRange[0], this->FieldOfViewRange[1]);
    if (value == this->FieldOfView) return;
    this->FieldOfView = value;
    this->Modified();
}

void vtkAnamorphPanoramaStyle::SetPitchRange(double least, double most) {
    if (!set_range(this->PitchRange, least, most, -90, 90)) return;
    this->Modified();
    this->SetPitch(this->Pitch);
}

void vtkAnamorphPanoramaStyle::SetFieldOfViewRange(double least, double most) {
    if (!set_range(this->FieldOfViewRange, least, most, 0.01, 179)) return;
    this->Modified();
    this->SetFieldOfView(this->FieldOfView);
}

vtkRenderer* vtkAnamorphPanoramaStyle::ViewRenderer() {
    if (this->CurrentRenderer) return this->CurrentRenderer;
    if (this->DefaultRenderer) return this->DefaultRenderer;
    vtkRenderWindow* window = this->Interactor ? this->Interactor->GetRenderWindow() : nullptr;
    return window ? window->GetRenderers()->GetFirstRenderer() : nullptr;
}

void vtkAnamorphPanoramaStyle::Look() {
    vtkRenderer* renderer = this->ViewRenderer();
    if (renderer && this->MoveCamera) {
        const double yaw = radians(this->Yaw), pitch = radians(this->Pitch);
        const double c = std::cos(pitch), s = std::sin(pitch), right = std::sin(yaw), ahead = std::cos(yaw);
        vtkCamera* camera = renderer->GetActiveCamera();
        double at[3];
        camera->GetPosition(at);
        camera->SetFocalPoint(at[0] + c * right, at[1] + s, at[2] - c * ahead);
        camera->SetViewUp(-s * right, c, s * ahead);
        camera->UseHorizontalViewAngleOn();
        camera->SetViewAngle(this->FieldOfView);
        renderer->ResetCameraClippingRange();
    }
    this->InvokeEvent(vtkCommand::InteractionEvent, nullptr);
    if (this->Interactor) this->Interactor->Render();
}

/// Drags the middle of the view by so many pixels.
void vtkAnamorphPanoramaStyle::Turn(double right, double up) {
    vtkRenderer* renderer = this->ViewRenderer();
    const double width = renderer ? std::max(1, renderer->GetSize()[0]) : 1;
    const double of_pixel = degrees(2 * std::tan(radians(this->FieldOfView) / 2) / width);
    // Near a pole a turn moves what is in the middle the less.
    const double across = std::max(std::cos(radians(this->Pitch)), 0.1);
    this->SetYaw(this->Yaw + right * of_pixel / across);
    this->SetPitch(this->Pitch + up * of_pixel);
    this->Look();
}

void vtkAnamorphPanoramaStyle::ScaleFieldOfView(double factor) {
    this->SetFieldOfView(this->FieldOfView * factor);
    this->Look();
}

void vtkAnamorphPanoramaStyle::OnLeftButtonDown() {
    if (!this->Interactor) return;
    const int* at = this->Interactor->GetEventPosition();
    this->FindPokedRenderer(at[0], at[1]);
    if (!this->CurrentRenderer) return;
    std::copy_n(at, 2, this->Pressed);
    this->GrabFocus(this->EventCallbackCommand);
    this->StartRotate();
}
void vtkAnamorphPanoramaStyle::OnLeftButtonUp() {
    if (this->State != VTKIS_ROTATE) return;
    if (!has_window(this->Interactor)) {
        this->State = VTKIS_NONE;
        return;
    }
    this->EndRotate();
    this->ReleaseFocus();
    const int* at = this->Interactor->GetEventPosition();
    if (std::abs(at[0] - this->Pressed[0]) <= kClick && std::abs(at[1] - this->Pressed[1]) <= kClick)
        this->InvokeEvent(vtkCommand::PickEvent, nullptr);
}
void vtkAnamorphPanoramaStyle::OnRightButtonDown() {
    if (!this->Interactor) return;
    const int* at = this->Interactor->GetEventPosition();
    this->FindPokedRenderer(at[0], at[1]);
    if (!this->CurrentRenderer) return;
    this->GrabFocus(this->EventCallbackCommand);
    this->StartDolly();
}
void vtkAnamorphPanoramaStyle::OnRightButtonUp() {
    if (this->State != VTKIS_DOLLY) return;
    if (!has_window(this->Interactor)) {
        this->State = VTKIS_NONE;
        return;
    }
    this->EndDolly();
    this->ReleaseFocus();
}

void vtkAnamorphPanoramaStyle::OnMouseMove() {
    if (!this->Interactor) return;
    const int *at = this->Interactor->GetEventPosition(), *last = this->Interactor->GetLastEventPosition();
    if (this->State == VTKIS_ROTATE) this->Turn(last[0] - at[0], last[1] - at[1]);
    if (this->State == VTKIS_DOLLY)
        this->ScaleFieldOfView(std::pow(kZoomStep, (last[1] - at[1]) / kPixelsOfStep));
}

void vtkAnamorphPanoramaStyle::OnMouseWheelForward() {
    if (!this->Interactor) return;
    const int* at = this->Interactor->GetEventPosition();
    this->FindPokedRenderer(at[0], at[1]);
    this->ScaleFieldOfView(1 / kZoomStep);
}
void vtkAnamorphPanoramaStyle::OnMouseWheelBackward() {
    if (!this->Interactor) return;
    const int* at = this->Interactor->GetEventPosition();
    this->FindPokedRenderer(at[0], at[1]);
    this->ScaleFieldOfView(kZoomStep);
}

void vtkAnamorphPanoramaStyle::OnKeyPress() {
    if (!this->Interactor) return;
    const char* key = this->Interactor->GetKeySym();
    if (!key) return;
    const auto is = [&](const char* name) { return std::strcmp(key, name) == 0; };
    vtkRenderer* renderer = this->ViewRenderer();
    const double step = kKeyStep * (renderer ? renderer->GetSize()[0] : 1);
    if (is("Left")) this->Turn(-step, 0);
    if (is("Right")) this->Turn(step, 0);
    if (is("Up")) this->Turn(0, step);
    if (is("Down")) this->Turn(0, -step);
    if (is("plus") || is("equal")) this->ScaleFieldOfView(1 / kZoomStep);
    if (is("minus")) this->ScaleFieldOfView(kZoomStep);
}

void vtkAnamorphPanoramaStyle::OnChar() {
    if (!this->Interactor) return;
    // Of the usual keys only those that end the program: the others pick, reset the camera, or change how things are drawn.
    const char key = this->Interactor->GetKeyCode();
    if (key == 'q' || key == 'Q' || key == 'e' || key == 'E') this->Superclass::OnChar();
}
