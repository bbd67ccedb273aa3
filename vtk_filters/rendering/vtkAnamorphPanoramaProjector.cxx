// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphPanoramaProjector.h"

#include <algorithm>
#include <iterator>

#include "anamorph/error.h"
#include "anamorph/map/panorama.h"
#include "vtkObjectFactory.h"
#include "vtkTexture.h"

vtkObjectFactoryNewMacro(vtkAnamorphPanoramaProjector);

vtkAnamorphPanoramaProjector::~vtkAnamorphPanoramaProjector() {
    this->SetLens(nullptr);
}

void vtkAnamorphPanoramaProjector::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    const auto write = [&](const char* name, const double* v) {
        os << indent << name << ": " << v[0] << " " << v[1] << " " << v[2] << "\n";
    };
    os << indent << "Panorama: " << this->Panorama.Get() << "\n"
       << indent << "Projection: " << this->GetProjectionName() << "\n"
       << indent << "FieldOfView: " << this->FieldOfView << "\n"
       << indent << "PanniniDistance: " << this->PanniniDistance << "\n"
       << indent << "Lens: " << (this->Lens ? this->Lens : "(none)") << "\n";
    write("Position", this->Position);
    write("Direction", this->Direction);
    write("ViewUp", this->ViewUp);
    os << indent << "Fade: " << this->Fade << "\n";
}

void vtkAnamorphPanoramaProjector::SetPanorama(vtkTexture* panorama) {
    if (panorama == this->Panorama) return;
    this->Panorama = panorama;
    this->Modified();
}

vtkTexture* vtkAnamorphPanoramaProjector::GetPanorama() {
    return this->Panorama;
}

int vtkAnamorphPanoramaProjector::GetNumberOfProjections() {
    return static_cast<int>(std::size(anamorph::kProjections));
}

void vtkAnamorphPanoramaProjector::SetProjection(int projection) {
    const int clamped = std::clamp(projection, 0, GetNumberOfProjections() - 1);
    if (clamped == this->Projection) return;
    this->Projection = clamped;
    this->Modified();
}

void vtkAnamorphPanoramaProjector::SetProjectionName(const char* name) {
    try {
        this->SetProjection(static_cast<int>(anamorph::projection_from_name(name ? name : "")));
    } catch (const anamorph::Error& error) {
        vtkErrorMacro(<< error.what());
    }
}

const char* vtkAnamorphPanoramaProjector::GetProjectionName() {
    return anamorph::name_of(anamorph::kProjections[this->Projection]).data();
}

void vtkAnamorphPanoramaProjector::SetOrientation(double yaw, double pitch, double roll) {
    // Cameras of the core look along z with y downwards.
    const glm::dmat3 r = anamorph::rotation({yaw, pitch, roll});
    this->SetDirection(r[2].x, -r[2].y, -r[2].z);
    this->SetViewUp(-r[1].x, r[1].y, r[1].z);
}
