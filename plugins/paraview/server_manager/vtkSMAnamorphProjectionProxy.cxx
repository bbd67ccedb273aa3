// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphProjectionProxy.h"

#include "session_views.h"
#include "vtkClientServerStream.h"
#include "vtkCommand.h"
#include "vtkInteractorStyle.h"
#include "vtkObjectFactory.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkSMPropertyHelper.h"
#include "vtkSMRenderViewProxy.h"

vtkStandardNewMacro(vtkSMAnamorphProjectionProxy);

namespace {
constexpr unsigned long kLeftAlone = 400;  // milliseconds
}  // namespace

vtkSMAnamorphProjectionProxy::vtkSMAnamorphProjectionProxy() = default;

vtkSMAnamorphProjectionProxy::~vtkSMAnamorphProjectionProxy() {
    this->StopTimer();
}

void vtkSMAnamorphProjectionProxy::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Given: " << this->Given << "\n";
}

/// The interactor of a view in a window of Qt; null where there is none.
vtkRenderWindowInteractor* vtkSMAnamorphProjectionProxy::FindWindow() {
    for (vtkSMRenderViewProxy* view : anamorph_paraview::render_views(this))
        if (vtkRenderWindowInteractor* window = anamorph_paraview::window_of(view)) return window;
    return nullptr;
}

bool vtkSMAnamorphProjectionProxy::IsAnimated() {
    return anamorph_paraview::any_proxy(this, "animation", [&](vtkSMProxy* cue) {
        return cue->GetProperty("AnimatedProxy") &&
               vtkSMPropertyHelper(cue, "AnimatedProxy").GetAsProxy() == this;
    });
}

/// Past the properties, which undo, traces and states follow.
void vtkSMAnamorphProjectionProxy::GiveTime(double seconds) {
    if (seconds == this->Given || !this->ObjectsCreated) return;
    this->Given = seconds;
    vtkClientServerStream stream;
    stream << vtkClientServerStream::Invoke << VTKOBJECT(this) << "SetTimeBudget" << seconds
           << vtkClientServerStream::End;
    this->ExecuteStream(stream);
}

void vtkSMAnamorphProjectionProxy::MarkDirty(vtkSMProxy* modified) {
    if (!this->InStep) {
        const double time = vtkSMPropertyHelper(this, "PreviewTime", true).GetAsDouble();
        this->GiveTime(time > 0 && this->FindWindow() && !this->IsAnimated() ? time : 0);
    }
    this->Superclass::MarkDirty(modified);
}

void vtkSMAnamorphProjectionProxy::PostUpdateData(bool using_cache) {
    this->Superclass::PostUpdateData(using_cache);
    this->UpdatePropertyInformation(this->GetProperty("UsedTolerance"));
    if (this->Given > 0) this->StartTimer();
}

void vtkSMAnamorphProjectionProxy::StartTimer() {
    this->StopTimer();
    this->Window = this->FindWindow();
    if (!this->Window) return;
    this->Observer =
        this->Window->AddObserver(vtkCommand::TimerEvent, this, &vtkSMAnamorphProjectionProxy::TimerFires);
    this->Timer = this->Window->CreateOneShotTimer(kLeftAlone);
}

void vtkSMAnamorphProjectionProxy::StopTimer() {
    if (this->Window) {
        this->Window->DestroyTimer(this->Timer);
        this->Window->RemoveObserver(this->Observer);
    }
    this->Window = nullptr;
}

void vtkSMAnamorphProjectionProxy::TimerFires(vtkObject*, unsigned long, void* id) {
    if (!id || *static_cast<int*>(id) != this->Timer || !this->Window) return;
    auto* style = vtkInteractorStyle::SafeDownCast(this->Window->GetInteractorStyle());
    if (style && style->GetState() != VTKIS_NONE) return this->StartTimer();
    this->StopTimer();
    this->Refine();
}

void vtkSMAnamorphProjectionProxy::Refine() {
    if (this->Given == 0) return;
    const double held = vtkSMPropertyHelper(this, "UsedTolerance").GetAsDouble(),
                 asked = vtkSMPropertyHelper(this, "Tolerance").GetAsDouble();
    if (held <= asked) return;
    this->InStep = true;
    this->GiveTime(0);
    this->MarkDirty(this);
    this->InStep = false;
    anamorph_paraview::draw_views(this);
}
