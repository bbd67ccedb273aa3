// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphPanoramaProjector.h"

#include <algorithm>
#include <iterator>

#include "anamorph/error.h"
#include "anamorph/panorama/panorama.h"
#include "vtkAlgorithm.h"
#include "vtkAlgorithmOutput.h"
#include "vtkObjectFactory.h"
#include "vtkPolyData.h"
#include "vtkTexture.h"
#include "vtkTrivialProducer.h"

vtkObjectFactoryNewMacro(vtkAnamorphPanoramaProjector);

vtkAnamorphPanoramaProjector::vtkAnamorphPanoramaProjector() = default;

vtkAnamorphPanoramaProjector::~vtkAnamorphPanoramaProjector() {
    this->SetLens(nullptr);
}

void vtkAnamorphPanoramaProjector::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    constexpr const char* kShadows[] = {"map", "rays", "rays in stills"};
    const auto write = [&](const char* name, const double* v) {
        os << indent << name << ": " << v[0] << " " << v[1] << " " << v[2] << "\n";
    };
    os << indent << "Panorama: " << this->Panorama.Get() << "\n"
       << indent << "Projection: " << this->GetProjectionName() << "\n"
       << indent << "FieldOfView: " << this->FieldOfView << "\n"
       << indent << "VerticalFieldOfView: " << this->VerticalFieldOfView << "\n"
       << indent << "PanniniDistance: " << this->PanniniDistance << "\n"
       << indent << "ProjectionAlpha: " << this->ProjectionAlpha << "\n"
       << indent << "Lens: " << (this->Lens ? this->Lens : "(none)") << "\n";
    write("Position", this->Position);
    write("Direction", this->Direction);
    write("ViewUp", this->ViewUp);
    os << indent << "Occluders: " << this->Occluders.Get() << "\n"
       << indent << "Shadows: " << kShadows[this->Shadows] << "\n"
       << indent << "ShadowSize: " << this->ShadowSize << "\n"
       << indent << "Fade: " << this->Fade << "\n"
       << indent << "Circles: " << this->Circles << "\n"
       << indent << "CircleRadius: " << this->CircleRadius << "\n"
       << indent << "FollowCamera: " << this->FollowCamera << "\n";
    write("Viewpoint", this->Viewpoint);
}

void vtkAnamorphPanoramaProjector::SetPanorama(vtkTexture* panorama) {
    if (panorama == this->Panorama) return;
    this->Panorama = panorama;
    this->Modified();
}

vtkTexture* vtkAnamorphPanoramaProjector::GetPanorama() {
    return this->Panorama;
}

void vtkAnamorphPanoramaProjector::SetOccluderConnection(vtkAlgorithmOutput* output) {
    if (output == this->Occluders) return;
    this->Occluders = output;
    this->OccluderData = nullptr;
    this->Modified();
}

void vtkAnamorphPanoramaProjector::SetOccluderData(vtkPolyData* mesh) {
    if (this->OccluderData && this->OccluderData->GetOutputDataObject(0) == mesh) return;
    const auto data = mesh ? vtkSmartPointer<vtkTrivialProducer>::New() : nullptr;
    if (data) data->SetOutput(mesh);
    this->SetOccluderConnection(data ? data->GetOutputPort() : nullptr);
    this->OccluderData = data;
}

vtkPolyData* vtkAnamorphPanoramaProjector::GetOccluders() {
    if (!this->Occluders) return nullptr;
    vtkAlgorithm* producer = this->Occluders->GetProducer();
    producer->Update(this->Occluders->GetIndex());
    return vtkPolyData::SafeDownCast(producer->GetOutputDataObject(this->Occluders->GetIndex()));
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
