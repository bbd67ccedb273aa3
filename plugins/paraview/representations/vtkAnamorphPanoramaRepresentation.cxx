// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphPanoramaRepresentation.h"

#include "vtkAnamorphPanoramaProjector.h"
#include "vtkAnamorphProjectionShader.h"
#include "vtkObjectFactory.h"
#include "vtkPVLODActor.h"
#include "vtkTexture.h"

vtkStandardNewMacro(vtkAnamorphPanoramaRepresentation);

vtkAnamorphPanoramaRepresentation::vtkAnamorphPanoramaRepresentation() {
    this->Shader->AddTo(this->Actor);
}

vtkAnamorphPanoramaRepresentation::~vtkAnamorphPanoramaRepresentation() {
    this->Shader->RemoveFrom(this->Actor);
}

void vtkAnamorphPanoramaRepresentation::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    this->Shader->PrintSelf(os, indent);
}

void vtkAnamorphPanoramaRepresentation::SetPanorama(vtkTexture* panorama) {
    this->Projector->SetPanorama(panorama);
    if (panorama) {
        panorama->InterpolateOn();
        panorama->RepeatOn();
        panorama->MipmapOn();
        // Some drivers filter anisotropically without the gradients that we give, and show seams.
        panorama->SetMaximumAnisotropicFiltering(1);
        this->Shader->AddProjector(this->Projector);
    } else
        this->Shader->RemoveAllProjectors();
}

void vtkAnamorphPanoramaRepresentation::SetPanoramaProjection(int projection) {
    this->Projector->SetProjection(projection);
}

void vtkAnamorphPanoramaRepresentation::SetPanoramaFieldOfView(double degrees) {
    this->Projector->SetFieldOfView(degrees);
}

void vtkAnamorphPanoramaRepresentation::SetPanoramaPanniniDistance(double d) {
    this->Projector->SetPanniniDistance(d);
}

void vtkAnamorphPanoramaRepresentation::SetPanoramaLens(const char* lens) {
    this->Projector->SetLens(lens);
}

void vtkAnamorphPanoramaRepresentation::SetProjectorPosition(double x, double y, double z) {
    this->Projector->SetPosition(x, y, z);
}

void vtkAnamorphPanoramaRepresentation::SetProjectorDirection(double x, double y, double z) {
    this->Projector->SetDirection(x, y, z);
}

void vtkAnamorphPanoramaRepresentation::SetProjectorViewUp(double x, double y, double z) {
    this->Projector->SetViewUp(x, y, z);
}

void vtkAnamorphPanoramaRepresentation::SetProjectionMode(int mode) {
    this->Shader->SetMode(mode);
}

void vtkAnamorphPanoramaRepresentation::SetHideUnpainted(bool hide) {
    this->Shader->SetHideUnpainted(hide);
}
