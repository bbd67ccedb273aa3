// SPDX-License-Identifier: Apache-2.0
#include <bump_editor.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkActor.h>
#include <vtkAnamorphReliefSource.h>
#include <vtkCamera.h>
#include <vtkDataSetMapper.h>
#include <vtkImageData.h>
#include <vtkPointSet.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkUnsignedCharArray.h>

#include <cmath>

namespace {

using Bump = BumpEditor::Bump;

/// The program without its window's loop: two bumps on a plane from -1 to 1, seen from above.
class VtkEditor : public testing::Test {
  protected:
    VtkEditor() {
        vtkNew<vtkImageData> flat;
        flat->SetDimensions(2, 2, 1);
        flat->AllocateScalars(VTK_FLOAT, 1);
        for (int i = 0; i < 4; ++i) flat->SetScalarComponentFromDouble(i % 2, i / 2, 0, 0, 0);
        m_relief->SetInputData(flat);
        m_relief->SetResolution(101, 101);
        m_relief->SetSize(2, 2);
        m_deform->SetInputConnection(m_relief->GetOutputPort());
        m_deform->AutomaticPlaneOff();
        m_deform->AddDeformation(-0.4, 0.1, 0.15, 0.2, 0, 0, 0.3);
        m_deform->AddDeformation(0.4, 0.2, 0.2, 0.15, 0, 0, -0.2);
        vtkNew<vtkDataSetMapper> mapper;
        mapper->SetInputConnection(m_deform->GetOutputPort());
        mapper->ScalarVisibilityOff();
        vtkNew<vtkActor> actor;
        actor->SetMapper(mapper);
        m_renderer->AddActor(actor);
        m_window->AddRenderer(m_renderer);
        m_window->SetSize(300, 300);
        m_window->SetMultiSamples(0);
        m_interactor->SetRenderWindow(m_window);
        m_editor->edit(m_deform, m_renderer);
        m_interactor->SetInteractorStyle(m_editor);
        m_interactor->Initialize();
        m_window->Render();
    }

    void event(unsigned long id, std::array<int, 2> at, const char* key = nullptr, bool shift = false,
               bool control = false) {
        m_interactor->SetEventInformation(at[0], at[1], control, shift, 0, 0, key);
        m_interactor->InvokeEvent(id);
    }
    void press(const char* key, std::array<int, 2> at = {0, 0}) {
        this->event(vtkCommand::KeyPressEvent, at, key);
    }
    void drag(std::array<int, 2> from, std::array<int, 2> to, bool shift = false, bool control = false) {
        this->event(vtkCommand::LeftButtonPressEvent, from, nullptr, shift, control);
        for (int k = 1; k <= 4; ++k)
            this->event(vtkCommand::MouseMoveEvent,
                        {from[0] + (to[0] - from[0]) * k / 4, from[1] + (to[1] - from[1]) * k / 4}, nullptr,
                        shift, control);
        this->event(vtkCommand::LeftButtonReleaseEvent, to, nullptr, shift, control);
    }
    std::array<int, 2> seen(const std::array<double, 3>& at) {
        m_renderer->SetWorldPoint(at[0], at[1], at[2], 1);
        m_renderer->WorldToDisplay();
        const double* p = m_renderer->GetDisplayPoint();
        return {static_cast<int>(std::lround(p[0])), static_cast<int>(std::lround(p[1]))};
    }
    std::array<int, 2> seen(int bump) { return this->seen(m_editor->handle(bump)); }
    std::vector<double> points() {
        m_deform->Update();
        auto* surface = vtkPointSet::SafeDownCast(m_deform->GetOutputDataObject(0));
        std::vector<double> result;
        for (vtkIdType i = 0; i < surface->GetNumberOfPoints(); ++i)
            result.insert(result.end(), surface->GetPoint(i), surface->GetPoint(i) + 3);
        return result;
    }
    std::vector<unsigned char> pixels() {
        vtkNew<vtkUnsignedCharArray> data;
        m_window->Render();
        m_window->GetPixelData(0, 0, 299, 299, 0, data);
        return {data->GetPointer(0), data->GetPointer(0) + data->GetNumberOfValues()};
    }
    std::array<double, 3> camera() {
        std::array<double, 3> at;
        m_renderer->GetActiveCamera()->GetPosition(at.data());
        return at;
    }
    /// The numbers of a bump but those given.
    static void expect_same_but(const Bump& got, Bump wanted, std::initializer_list<std::size_t> changed) {
        for (const std::size_t i : changed) {
            EXPECT_NE(got[i], wanted[i]) << i;
            wanted[i] = got[i];
        }
        EXPECT_EQ(got, wanted);
    }

    vtkNew<vtkAnamorphReliefSource> m_relief;
    vtkNew<vtkAnamorphDeform> m_deform;
    vtkNew<vtkRenderer> m_renderer;
    vtkNew<vtkRenderWindow> m_window;
    vtkNew<vtkRenderWindowInteractor> m_interactor;
    vtkNew<BumpEditor> m_editor;
};

TEST_F(VtkEditor, ABumpFollowsTheMouse) {
    const Bump first = m_editor->bump(0), second = m_editor->bump(1);
    const std::array<int, 2> from = this->seen(0), to{from[0] + 60, from[1] - 40};
    this->drag(from, to);
    EXPECT_EQ(m_editor->selected(), 0);
    expect_same_but(m_editor->bump(0), first, {0, 1});
    EXPECT_EQ(m_editor->bump(1), second);
    // To the right and down; the + is where the mouse is, within a point of the surface.
    EXPECT_GT(m_editor->bump(0)[0], first[0] + 0.1);
    EXPECT_LT(m_editor->bump(0)[1], first[1] - 0.1);
    const std::array<int, 2> now = this->seen(0);
    EXPECT_NEAR(now[0], to[0], 4);
    EXPECT_NEAR(now[1], to[1], 4);
    // Only what the bump reaches was computed again.
    EXPECT_GT(m_deform->GetNumberOfPointsComputed(), 0);
    EXPECT_LT(m_deform->GetNumberOfPointsComputed(), 101 * 101);
}

TEST_F(VtkEditor, ShiftRaisesAndControlWidens) {
    const Bump first = m_editor->bump(0);
    const std::array<int, 2> from = this->seen(0);
    this->drag(from, {from[0] + 9, from[1] + 30}, true);
    expect_same_but(m_editor->bump(0), first, {6});
    EXPECT_GT(m_editor->bump(0)[6], 0.3);
    const Bump raised = m_editor->bump(0);
    const std::array<int, 2> again = this->seen(0);
    this->drag(again, {again[0], again[1] - 20}, false, true);
    expect_same_but(m_editor->bump(0), raised, {2, 3});
    EXPECT_NEAR(m_editor->bump(0)[2], 0.15 * std::pow(1.01, -20), 1e-12);
}

TEST_F(VtkEditor, ADragEndsWhereTheButtonIsReleased) {
    for (const bool shift : {false, true}) {
        const std::array<int, 2> from = this->seen(0), to{from[0] + 40, from[1] + 25};
        const Bump before = m_editor->bump(0);
        this->drag(from, to, shift);
        const Bump wanted = m_editor->bump(0);
        this->press("z");
        ASSERT_EQ(m_editor->bump(0), before);
        // The last move, or all of them, may not be told.
        for (const bool moved : {true, false}) {
            this->event(vtkCommand::LeftButtonPressEvent, from, nullptr, shift);
            if (moved) this->event(vtkCommand::MouseMoveEvent, {from[0] + 7, from[1] + 31}, nullptr, shift);
            this->event(vtkCommand::LeftButtonReleaseEvent, to, nullptr, shift);
            for (std::size_t i = 0; i < wanted.size(); ++i)
                EXPECT_NEAR(m_editor->bump(0)[i], wanted[i], 1e-12) << i;
            this->press("z");
            EXPECT_EQ(m_editor->bump(0), before);
        }
    }
}

TEST_F(VtkEditor, AClickSelectsAndEditsNothing) {
    const Bump first = m_editor->bump(0), second = m_editor->bump(1);
    this->drag(this->seen(0), {150, 150});
    const Bump dragged = m_editor->bump(0);
    for (const int k : {1, 0})
        for (const bool moved : {true, false}) {
            const std::array<int, 2> at = this->seen(k);
            this->event(vtkCommand::LeftButtonPressEvent, at);
            if (moved) this->event(vtkCommand::MouseMoveEvent, at);
            this->event(vtkCommand::LeftButtonReleaseEvent, at);
            EXPECT_EQ(m_editor->selected(), k);
            EXPECT_EQ(m_editor->bump(0), dragged);
            EXPECT_EQ(m_editor->bump(1), second);
        }
    this->press("z");  // of the drag: clicks are no steps
    EXPECT_EQ(m_editor->bump(0), first);
}

TEST_F(VtkEditor, ElsewhereTheViewRotatesAndNothingIsEdited) {
    const std::vector<double> before = this->points();
    const std::array<double, 3> from = this->camera();
    this->drag({20, 20}, {90, 50});
    EXPECT_NE(this->camera(), from);
    EXPECT_EQ(this->points(), before);
    this->press("z");  // nothing to undo
    EXPECT_EQ(this->points(), before);
}

TEST_F(VtkEditor, TheViewRotatesWhileABumpIsDragged) {
    const Bump first = m_editor->bump(0);
    const std::array<int, 2> from = this->seen(0);
    this->event(vtkCommand::LeftButtonPressEvent, from);
    this->event(vtkCommand::MouseMoveEvent, {from[0] + 20, from[1]});
    const Bump dragged = m_editor->bump(0);
    const std::array<double, 3> camera_before = this->camera();
    for (int k = 0; k < 4; ++k) this->press(k % 2 ? "Up" : "Left", {from[0] + 20, from[1]});
    EXPECT_NE(this->camera(), camera_before);
    EXPECT_EQ(m_editor->bump(0), dragged);  // turning alone moves nothing
    this->event(vtkCommand::MouseMoveEvent, {from[0] + 20, from[1]});
    for (std::size_t i = 0; i < dragged.size(); ++i) EXPECT_NEAR(m_editor->bump(0)[i], dragged[i], 1e-9) << i;
    this->event(vtkCommand::MouseMoveEvent, {from[0] + 50, from[1]});
    this->event(vtkCommand::LeftButtonReleaseEvent, {from[0] + 50, from[1]});
    EXPECT_GT(m_editor->bump(0)[0], dragged[0] + 0.05);
    this->press("z");  // one step for all of the drag
    EXPECT_EQ(m_editor->bump(0), first);
}

TEST_F(VtkEditor, UndoGivesBackTheBitsAndThePicture) {
    const std::vector<double> surface = this->points();
    const std::vector<unsigned char> picture = this->pixels();
    const Bump first = m_editor->bump(0), second = m_editor->bump(1);

    this->drag(this->seen(0), {200, 220});
    const std::vector<double> moved = this->points();
    EXPECT_NE(moved, surface);
    EXPECT_NE(this->pixels(), picture);
    this->drag(this->seen(1), {100, 80}, true);
    this->press("n", {150, 60});
    ASSERT_EQ(m_editor->bumps(), 3);
    EXPECT_EQ(m_editor->selected(), 2);
    EXPECT_EQ(this->seen({m_editor->bump(2)[0], m_editor->bump(2)[1], 0}), (std::array{150, 60}));
    this->drag(this->seen(0), {60, 150});
    ASSERT_EQ(m_editor->selected(), 0);
    this->press("Delete");
    ASSERT_EQ(m_editor->bumps(), 2);
    EXPECT_EQ(m_editor->selected(), -1);
    this->press("Delete");  // nothing is selected
    ASSERT_EQ(m_editor->bumps(), 2);
    const std::vector<double> last = this->points();

    for (int k = 0; k < 4; ++k) this->press("z");
    EXPECT_EQ(this->points(), moved);
    this->press("z");
    this->press("z");  // one more than there were
    EXPECT_EQ(m_editor->bumps(), 2);
    EXPECT_EQ(m_editor->bump(0), first);
    EXPECT_EQ(m_editor->bump(1), second);
    EXPECT_EQ(this->points(), surface);
    EXPECT_EQ(this->pixels(), picture);
    for (int k = 0; k < 6; ++k) this->press("y");
    EXPECT_EQ(this->points(), last);

    // A new edit forgets what was undone.
    this->press("z");
    this->drag(this->seen(1), {100, 100}, true);
    const std::vector<double> other = this->points();
    this->press("y");
    EXPECT_EQ(this->points(), other);
}

}  // namespace
