// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphPanoramaStyle.h>
#include <vtkCallbackCommand.h>
#include <vtkCamera.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>

#include <array>
#include <cmath>
#include <sstream>

namespace {

/// A window of 400 x 300 pixels, with a camera at (1, 2, 3).
class VtkPanoramaStyle : public testing::Test {
  protected:
    VtkPanoramaStyle() {
        m_window->AddRenderer(m_renderer);
        m_window->SetSize(400, 300);
        m_window->OffScreenRenderingOn();
        m_renderer->GetActiveCamera()->SetPosition(1, 2, 3);
        m_interactor->SetRenderWindow(m_window);
        m_interactor->SetInteractorStyle(m_style);
        m_interactor->Initialize();
        m_window->Render();
    }
    void event(unsigned long id, std::array<int, 2> at, const char* key = nullptr, char code = 0) {
        m_interactor->SetEventInformation(at[0], at[1], 0, 0, code, 0, key);
        m_interactor->InvokeEvent(id);
    }
    void drag(std::array<int, 2> from, std::array<int, 2> to, unsigned long press, unsigned long release) {
        this->event(press, from);
        for (int k = 1; k <= 4; ++k)
            this->event(vtkCommand::MouseMoveEvent,
                        {from[0] + (to[0] - from[0]) * k / 4, from[1] + (to[1] - from[1]) * k / 4});
        this->event(release, to);
    }
    void drag(std::array<int, 2> from, std::array<int, 2> to) {
        this->drag(from, to, vtkCommand::LeftButtonPressEvent, vtkCommand::LeftButtonReleaseEvent);
    }
    std::array<double, 2> seen_at(const std::array<double, 3>& world) {
        m_renderer->SetWorldPoint(world[0], world[1], world[2], 1);
        m_renderer->WorldToDisplay();
        double* at = m_renderer->GetDisplayPoint();
        return {at[0], at[1]};
    }

    vtkNew<vtkRenderer> m_renderer;
    vtkNew<vtkRenderWindow> m_window;
    vtkNew<vtkRenderWindowInteractor> m_interactor;
    vtkNew<vtkAnamorphPanoramaStyle> m_style;
};

constexpr double kDegree = 3.14159265358979323846 / 180;

TEST_F(VtkPanoramaStyle, DraggingTakesTheMiddleAlong) {
    const double per_pixel = 2 * std::tan(45 * kDegree) / 400 / kDegree;
    this->drag({200, 150}, {180, 150});
    EXPECT_NEAR(m_style->GetYaw(), 20 * per_pixel, 1e-9);
    EXPECT_EQ(m_style->GetPitch(), 0);
    this->drag({200, 150}, {200, 140});
    EXPECT_NEAR(m_style->GetPitch(), 10 * per_pixel, 1e-9);
    // What was straight ahead is now where the mouse has taken it, but for the tangent's curve.
    const auto at = this->seen_at({1, 2, 3 - 100});
    EXPECT_NEAR(at[0], 180, 0.3);
    EXPECT_NEAR(at[1], 140, 0.3);
    // A mouse that is not pressed turns nothing.
    const double yaw = m_style->GetYaw();
    this->event(vtkCommand::MouseMoveEvent, {10, 10});
    EXPECT_EQ(m_style->GetYaw(), yaw);
}

TEST_F(VtkPanoramaStyle, TheCameraLooksThereFromWhereItIs) {
    m_style->SetYaw(90);
    m_style->SetPitch(30);
    m_style->SetFieldOfView(60);
    m_style->SetDefaultRenderer(m_renderer);
    m_style->Look();
    const double* at = m_renderer->GetActiveCamera()->GetPosition();
    const double* way = m_renderer->GetActiveCamera()->GetDirectionOfProjection();
    EXPECT_THAT(std::vector<double>(at, at + 3), testing::ElementsAre(1, 2, 3));
    EXPECT_NEAR(way[0], std::cos(30 * kDegree), 1e-12);
    EXPECT_NEAR(way[1], 0.5, 1e-12);
    EXPECT_NEAR(way[2], 0, 1e-12);
    // The left edge is 30 degrees to the left: towards yaw 60, at the height of the middle.
    const double up[3] = {-0.5, std::cos(30 * kDegree), 0};
    const double left[3] = {way[0], way[1], -std::tan(30 * kDegree)};
    EXPECT_NEAR(this->seen_at({1 + left[0], 2 + left[1], 3 + left[2]})[0], 0, 1e-6);
    EXPECT_NEAR(m_renderer->GetActiveCamera()->GetViewUp()[0], up[0], 1e-12);
    // Straight up as well.
    m_style->SetPitch(90);
    m_style->Look();
    EXPECT_NEAR(m_renderer->GetActiveCamera()->GetDirectionOfProjection()[1], 1, 1e-12);
}

TEST_F(VtkPanoramaStyle, TheCameraStaysWhereItIsWanted) {
    m_style->MoveCameraOff();
    m_renderer->GetActiveCamera()->SetFocalPoint(1, 2, -3);
    this->drag({200, 150}, {100, 150});
    EXPECT_GT(m_style->GetYaw(), 10);
    EXPECT_EQ(m_renderer->GetActiveCamera()->GetFocalPoint()[2], -3);
}

TEST_F(VtkPanoramaStyle, TheWheelZoomsWithinLimits) {
    this->event(vtkCommand::MouseWheelForwardEvent, {200, 150});
    EXPECT_NEAR(m_style->GetFieldOfView(), 90 / 1.1, 1e-12);
    EXPECT_NEAR(m_renderer->GetActiveCamera()->GetViewAngle(), 90 / 1.1, 1e-12);
    for (int i = 0; i < 100; ++i) this->event(vtkCommand::MouseWheelForwardEvent, {200, 150});
    EXPECT_EQ(m_style->GetFieldOfView(), 5);
    for (int i = 0; i < 100; ++i) this->event(vtkCommand::MouseWheelBackwardEvent, {200, 150});
    EXPECT_EQ(m_style->GetFieldOfView(), 130);
    this->drag({200, 150}, {200, 160}, vtkCommand::RightButtonPressEvent,
               vtkCommand::RightButtonReleaseEvent);
    EXPECT_NEAR(m_style->GetFieldOfView(), 130 / 1.1, 1e-9);
    m_style->SetFieldOfViewRange(20, 40);
    EXPECT_EQ(m_style->GetFieldOfView(), 40);
}

TEST_F(VtkPanoramaStyle, KeysTurnAndZoom) {
    this->event(vtkCommand::KeyPressEvent, {0, 0}, "Right");
    const double step = 0.1 * 400 * 2 * std::tan(45 * kDegree) / 400 / kDegree;
    EXPECT_NEAR(m_style->GetYaw(), step, 1e-9);
    this->event(vtkCommand::KeyPressEvent, {0, 0}, "Left");
    EXPECT_NEAR(m_style->GetYaw(), 0, 1e-9);
    this->event(vtkCommand::KeyPressEvent, {0, 0}, "Up");
    EXPECT_NEAR(m_style->GetPitch(), step, 1e-9);
    for (int i = 0; i < 50; ++i) this->event(vtkCommand::KeyPressEvent, {0, 0}, "Up");
    EXPECT_EQ(m_style->GetPitch(), 90);
    for (int i = 0; i < 50; ++i) this->event(vtkCommand::KeyPressEvent, {0, 0}, "Down");
    EXPECT_EQ(m_style->GetPitch(), -90);
    this->event(vtkCommand::KeyPressEvent, {0, 0}, "plus");
    EXPECT_NEAR(m_style->GetFieldOfView(), 90 / 1.1, 1e-12);
    // The usual w of VTK, which draws wires, does nothing.
    this->event(vtkCommand::CharEvent, {0, 0}, "w", 'w');
}

TEST_F(VtkPanoramaStyle, ValuesAreKeptInTheirRanges) {
    m_style->SetYaw(540 + 30);
    EXPECT_EQ(m_style->GetYaw(), -150);
    m_style->SetYaw(-180);
    EXPECT_EQ(m_style->GetYaw(), -180);
    const vtkMTimeType before = m_style->GetMTime();
    for (const double nothing : {std::nan(""), HUGE_VAL}) m_style->SetYaw(nothing);
    m_style->SetPitch(std::nan(""));
    m_style->SetFieldOfView(std::nan(""));
    m_style->SetYaw(180);
    m_style->SetPitchRange(10, 0);
    m_style->SetPitchRange(-91, 0);
    m_style->SetPitchRange(std::nan(""), 0);
    m_style->SetFieldOfViewRange(0, 90);
    m_style->SetFieldOfViewRange(10, 180);
    EXPECT_EQ(m_style->GetMTime(), before);
    m_style->SetPitchRange(10, 20);
    EXPECT_EQ(m_style->GetPitch(), 10);
    EXPECT_GT(m_style->GetMTime(), before);
    std::ostringstream text;
    m_style->Print(text);
    EXPECT_THAT(text.str(), testing::HasSubstr("PitchRange: 10 20"));
}

TEST_F(VtkPanoramaStyle, ObserversSeeEveryChange) {
    int changes = 0;
    vtkNew<vtkCallbackCommand> count;
    count->SetClientData(&changes);
    count->SetCallback([](vtkObject*, unsigned long, void* to, void*) { ++*static_cast<int*>(to); });
    m_style->AddObserver(vtkCommand::InteractionEvent, count);
    this->drag({200, 150}, {180, 150});
    EXPECT_EQ(changes, 4);
    this->event(vtkCommand::MouseWheelForwardEvent, {200, 150});
    EXPECT_EQ(changes, 5);
}

TEST_F(VtkPanoramaStyle, AClickPicks) {
    int picks = 0;
    vtkNew<vtkCallbackCommand> count;
    count->SetClientData(&picks);
    count->SetCallback([](vtkObject*, unsigned long, void* to, void*) { ++*static_cast<int*>(to); });
    m_style->AddObserver(vtkCommand::PickEvent, count);
    this->drag({200, 150}, {180, 150});
    EXPECT_EQ(picks, 0);
    this->drag({200, 150}, {200, 150});
    EXPECT_EQ(picks, 1);
    this->event(vtkCommand::LeftButtonReleaseEvent, {200, 150});
    EXPECT_EQ(picks, 1) << "without a press";
}

TEST(VtkPanoramaStyleAlone, WithoutAWindowNothingHappens) {
    vtkNew<vtkAnamorphPanoramaStyle> style;
    style->SetYaw(10);
    style->Look();
    EXPECT_EQ(style->GetYaw(), 10);
}

}  // namespace
