// SPDX-License-Identifier: Apache-2.0
// A surface whose bumps are edited with the mouse (bump_editor.h says how).
//
// Usage: edit_bumps [LIST.json | LIST.csv [PICTURE]]
//
// LIST is read if it is there, and written when the window is closed. PICTURE raises the surface; without
// one, it is flat.
#include <vtkActor.h>
#include <vtkAnamorphDeformationList.h>
#include <vtkAnamorphReliefSource.h>
#include <vtkCamera.h>
#include <vtkDataSetMapper.h>
#include <vtkImageData.h>
#include <vtkPointSet.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>

#include <cstdlib>
#include <filesystem>
#include <iostream>

#include "bump_editor.h"

int main(int argc, char** argv) {
    if (argc > 3) {
        std::cerr << "Usage: edit_bumps [LIST.json | LIST.csv [PICTURE]]\n";
        return EXIT_FAILURE;
    }
    vtkNew<vtkImageData> flat;
    flat->SetDimensions(2, 2, 1);
    flat->AllocateScalars(VTK_FLOAT, 1);
    for (int i = 0; i < 4; ++i) flat->SetScalarComponentFromDouble(i % 2, i / 2, 0, 0, 0);
    vtkNew<vtkAnamorphReliefSource> relief;
    if (argc > 2)
        relief->SetFileName(argv[2]);
    else
        relief->SetInputData(flat);
    relief->SetResolution(300, 300);
    relief->SetSize(2, 2);
    relief->SetSmoothing(argc > 2 ? 2 : 0);

    vtkNew<vtkAnamorphDeform> deform;
    deform->SetInputConnection(relief->GetOutputPort());
    deform->AutomaticPlaneOff();  // the parameters are x and y
    deform->GenerateOverlayOn();
    if (argc > 1 && std::filesystem::exists(argv[1])) {
        if (!deform->GetDeformationList()->ReadFile(argv[1])) return EXIT_FAILURE;
    } else {
        deform->AddDeformation(-0.4, 0.1, 0.2, 0.3, 0, 0, 0.3);
        deform->AddDeformation(0.4, 0.1, 0.3, 0.2, 0, 0, -0.2);
    }

    deform->Update();
    if (vtkPointSet::SafeDownCast(deform->GetOutputDataObject(0))->GetNumberOfPoints() == 0) {
        std::cerr << "edit_bumps: there is no surface\n";
        return EXIT_FAILURE;
    }

    vtkNew<vtkDataSetMapper> surface_mapper;
    surface_mapper->SetInputConnection(deform->GetOutputPort(0));
    surface_mapper->ScalarVisibilityOff();
    vtkNew<vtkActor> surface;
    surface->SetMapper(surface_mapper);
    surface->GetProperty()->SetColor(0.86, 0.68, 0.55);
    vtkNew<vtkPolyDataMapper> overlay_mapper;
    overlay_mapper->SetInputConnection(deform->GetOutputPort(1));
    overlay_mapper->ScalarVisibilityOff();
    vtkMapper::SetResolveCoincidentTopologyToPolygonOffset();  // lines are seen on the surface, not in it
    overlay_mapper->SetRelativeCoincidentTopologyLineOffsetParameters(-2, -400);
    vtkNew<vtkActor> overlay;
    overlay->SetMapper(overlay_mapper);
    overlay->GetProperty()->SetColor(0.1, 0.2, 0.6);
    overlay->GetProperty()->SetLineWidth(2);
    overlay->GetProperty()->LightingOff();

    vtkNew<vtkRenderer> renderer;
    renderer->AddActor(surface);
    renderer->AddActor(overlay);
    renderer->SetBackground(0.16, 0.18, 0.22);
    renderer->ResetCamera();
    renderer->GetActiveCamera()->Elevation(-35);
    renderer->GetActiveCamera()->Zoom(1.3);
    vtkNew<vtkRenderWindow> window;
    window->AddRenderer(renderer);
    window->SetSize(800, 700);
    window->SetWindowName(
        "left: drag a bump (Shift: height, Control: size) or rotate; n: new, z: undo, y: redo");
    vtkNew<vtkRenderWindowInteractor> interactor;
    interactor->SetRenderWindow(window);
    vtkNew<BumpEditor> editor;
    editor->edit(deform, renderer);
    interactor->SetInteractorStyle(editor);
    window->Render();
    interactor->Start();
    return argc < 2 || deform->GetDeformationList()->WriteFile(argv[1]) ? EXIT_SUCCESS : EXIT_FAILURE;
}
