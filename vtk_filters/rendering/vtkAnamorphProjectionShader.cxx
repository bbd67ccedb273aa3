// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphProjectionShader.h"

#include <algorithm>
#include <string>
#include <vector>

#include "projection_hook.h"
#include "vtkActor.h"
#include "vtkAnamorphPanoramaProjector.h"
#include "vtkObjectFactory.h"
#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

using anamorph_vtk::ProjectionHook;

vtkObjectFactoryNewMacro(vtkAnamorphProjectionShader);

struct vtkAnamorphProjectionShader::Internals {
    std::vector<vtkSmartPointer<vtkAnamorphPanoramaProjector>> projectors;
    std::vector<vtkWeakPointer<vtkActor>> actors;
};

vtkAnamorphProjectionShader::vtkAnamorphProjectionShader() : Inside(std::make_unique<Internals>()) {}

vtkAnamorphProjectionShader::~vtkAnamorphProjectionShader() = default;

void vtkAnamorphProjectionShader::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    constexpr const char* kModes[] = {"direct", "residual", "multipass"};
    os << indent << "Mode: " << kModes[this->Mode] << "\n"
       << indent << "NumberOfDirections: " << this->NumberOfDirections << "\n"
       << indent << "VerticalReach: " << this->VerticalReach << "\n"
       << indent << "TableSize: " << this->TableSize << "\n"
       << indent << "Machine: " << (this->Machine.empty() ? "(none)" : this->Machine) << "\n"
       << indent << "PlaneSize: " << this->PlaneSize << "\n"
       << indent << "HideUnpainted: " << this->HideUnpainted << "\n"
       << indent << "Projectors: " << this->Inside->projectors.size() << "\n";
    for (const auto& projector : this->Inside->projectors) projector->PrintSelf(os, indent.GetNextIndent());
}

vtkMTimeType vtkAnamorphProjectionShader::GetMTime() {
    vtkMTimeType time = this->Superclass::GetMTime();
    for (const auto& projector : this->Inside->projectors) time = std::max(time, projector->GetMTime());
    return time;
}

void vtkAnamorphProjectionShader::AddProjector(vtkAnamorphPanoramaProjector* projector) {
    auto& all = this->Inside->projectors;
    if (!projector || std::find(all.begin(), all.end(), projector) != all.end()) return;
    if (all.size() == MostProjectors) {
        vtkErrorMacro("AddProjector: there must be no more than " << MostProjectors << " projectors");
        return;
    }
    all.emplace_back(projector);
    this->AddToAll();
}

void vtkAnamorphProjectionShader::RemoveProjector(vtkAnamorphPanoramaProjector* projector) {
    auto& all = this->Inside->projectors;
    const auto found = std::find(all.begin(), all.end(), projector);
    if (found == all.end()) return;
    all.erase(found);
    this->AddToAll();
}

void vtkAnamorphProjectionShader::RemoveAllProjectors() {
    if (this->Inside->projectors.empty()) return;
    this->Inside->projectors.clear();
    this->AddToAll();
}

int vtkAnamorphProjectionShader::GetNumberOfProjectors() {
    return static_cast<int>(this->Inside->projectors.size());
}

vtkAnamorphPanoramaProjector* vtkAnamorphProjectionShader::GetProjector(int index) {
    if (index < 0 || index >= this->GetNumberOfProjectors()) return nullptr;
    return this->Inside->projectors[static_cast<std::size_t>(index)];
}

void vtkAnamorphProjectionShader::SetMode(int mode) {
    const int clamped = std::clamp(mode, static_cast<int>(DIRECT), static_cast<int>(MULTIPASS));
    if (clamped == this->Mode) return;
    this->Mode = clamped;
    this->AddToAll();
}

void vtkAnamorphProjectionShader::SetMachine(const char* text) {
    const std::string machine = text ? text : "";
    if (machine == this->Machine) return;
    this->Machine = machine;
    this->Modified();
}

double vtkAnamorphProjectionShader::GetResidualBound(vtkActor* actor, int projector) {
    const auto* prepared = actor ? ProjectionHook::prepared_for(actor, projector) : nullptr;
    return prepared && prepared->thrown.mode == RESIDUAL ? prepared->bound() : 0;
}

int vtkAnamorphProjectionShader::GetNumberOfShadowDraws(vtkActor* actor, int projector) {
    return actor && projector >= 0 ? ProjectionHook::shadow_draws_for(actor, projector) : 0;
}

void vtkAnamorphProjectionShader::AddTo(vtkActor* actor) {
    if (!actor) return;
    this->RemoveFrom(actor);
    this->Inside->actors.emplace_back(actor);
    ProjectionHook::put_on(actor, this);
}

void vtkAnamorphProjectionShader::RemoveFrom(vtkActor* actor) {
    if (!actor) return;
    auto& all = this->Inside->actors;
    all.erase(std::remove_if(all.begin(), all.end(), [&](const auto& a) { return !a || a == actor; }),
              all.end());
    ProjectionHook::take_off(actor);
}

/// When projectors or the mode are others.
void vtkAnamorphProjectionShader::AddToAll() {
    this->Modified();
    const auto actors = this->Inside->actors;
    for (const auto& actor : actors) {
        if (!actor) continue;
        // Another shader may have it by now.
        const vtkAnamorphProjectionShader* owner = ProjectionHook::owner_of(actor);
        if (!owner || owner == this) this->AddTo(actor);
    }
}
