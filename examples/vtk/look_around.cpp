// SPDX-License-Identifier: Apache-2.0
// Looks around in a panorama with the mouse (Kim 2003, section 4.5): it is thrown from the camera onto a sphere around it,
// fragment by fragment.
//
// Usage: look_around PANORAMA [PROJECTION]
//
// PANORAMA is a picture that VTK reads: .hdr, .png, .jpg, .tif. PROJECTION is equirectangular unless it is given.
#include <vtkActor.h>
#include <vtkAnamorphPanoramaProjector.h>
#include <vtkAnamorphPanoramaStyle.h>
#include <vtkAnamorphProjectionShader.h>
#include <vtkCamera.h>
#include <vtkImageReader2.h>
#include <vtkImageReader2Factory.h>
#include <vtkNew.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderWindowInteractor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkSphereSource.h>
#include <vtkTexture.h>

#include <cstdlib>
#include <iostream>

int main(int argc, char** argv) {
    if (argc != 2 && argc != 3) {
        std::cerr << "Usage: look_around PANORAMA [PROJECTION]\n";
        return EXIT_FAILURE;
    }
    const auto reader =
        vtkSmartPointer<vtkImageReader2>::Take(vtkImageReader2Factory::CreateImageReader2(argv[1]));
    if (!reader) {
        std::cerr << "look_around: " << argv[1] << ": VTK does not read it\n";
        return EXIT_FAILURE;
    }
    reader->SetFileName(argv[1]);
    vtkNew<vtkTexture> texture;
    texture->SetInputConnection(reader->GetOutputPort());
    texture->SetColorModeToDirectScalars();
    texture->InterpolateOn();

    vtkNew<vtkAnamorphPanoramaProjector> projector;
    projector->SetPanorama(texture);
    if (argc > 2) projector->SetProjectionName(argv[2]);
    vtkNew<vtkSphereSource> sphere;
    sphere->SetRadius(10);
    sphere->SetThetaResolution(64);
    sphere->SetPhiResolution(32);
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputConnection(sphere->GetOutputPort());
    vtkNew<vtkActor> actor;
    actor->SetMapper(mapper);
    actor->GetProperty()->SetAmbient(1);
    actor->GetProperty()->SetDiffuse(0);
    vtkNew<vtkAnamorphProjectionShader> shader;
    shader->AddProjector(projector);
    shader->AddTo(actor);

    vtkNew<vtkRenderer> renderer;
    renderer->AddActor(actor);
    renderer->GetActiveCamera()->SetPosition(0, 0, 0);
    vtkNew<vtkRenderWindow> window;
    window->AddRenderer(renderer);
    window->SetSize(960, 640);
    window->SetWindowName("look_around");
    vtkNew<vtkRenderWindowInteractor> interactor;
    interactor->SetRenderWindow(window);
    vtkNew<vtkAnamorphPanoramaStyle> style;
    style->SetDefaultRenderer(renderer);
    interactor->SetInteractorStyle(style);
    interactor->Initialize();
    style->Look();
    interactor->Start();
    return EXIT_SUCCESS;
}
