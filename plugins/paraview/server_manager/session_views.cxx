// SPDX-License-Identifier: Apache-2.0
#include "session_views.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "vtkCallbackCommand.h"
#include "vtkCommand.h"
#include "vtkRenderWindowInteractor.h"
#include "vtkSMRenderViewProxy.h"

namespace anamorph_paraview {

std::vector<vtkSMRenderViewProxy*> render_views(vtkSMProxy* of) {
    std::vector<vtkSMRenderViewProxy*> views;
    any_proxy(of, "views", [&](vtkSMProxy* proxy) {
        if (auto* view = vtkSMRenderViewProxy::SafeDownCast(proxy)) views.push_back(view);
        return false;
    });
    return views;
}

vtkRenderWindowInteractor* window_of(vtkSMRenderViewProxy* view) {
    vtkRenderWindowInteractor* interactor = view->GetInteractor();
    return interactor && interactor->IsA("QVTKInteractor") ? interactor : nullptr;
}

void draw_views(vtkSMProxy* of) {
    for (vtkSMRenderViewProxy* view : render_views(of)) view->StillRender();
}

ViewMouse::ViewMouse(Clicked clicked)
    : m_clicked(std::move(clicked)), m_command(vtkSmartPointer<vtkCallbackCommand>::New()) {
    m_command->SetCallback(&ViewMouse::happens);
    m_command->SetClientData(this);
}

ViewMouse::~ViewMouse() {
    for (const Watched& watched : m_watched)
        if (watched.window)
            for (const unsigned long observer : watched.observers) watched.window->RemoveObserver(observer);
    m_command->SetClientData(nullptr);
}

void ViewMouse::watch(vtkSMProxy* of) {
    constexpr float kBeforeWidgets = 1;  // theirs are 0.5
    for (vtkSMRenderViewProxy* view : render_views(of)) {
        vtkRenderWindowInteractor* window = window_of(view);
        const auto is_watched = [&](const Watched& watched) { return watched.window == window; };
        if (!window || std::any_of(m_watched.begin(), m_watched.end(), is_watched)) continue;
        m_watched.push_back(
            {view,
             window,
             {window->AddObserver(vtkCommand::LeftButtonPressEvent, m_command, kBeforeWidgets),
              window->AddObserver(vtkCommand::LeftButtonReleaseEvent, m_command, kBeforeWidgets)}});
    }
}

void ViewMouse::happens(vtkObject* object, unsigned long event, void* self, void*) {
    constexpr int kStill = 2;  // pixels that a hand moves
    auto* mouse = static_cast<ViewMouse*>(self);
    auto* window = vtkRenderWindowInteractor::SafeDownCast(object);
    if (!mouse || !window) return;
    const int* const now = window->GetEventPosition();
    const std::array<int, 2> at = {now[0], now[1]};
    mouse->m_down = event == vtkCommand::LeftButtonPressEvent;
    if (mouse->m_down) {
        mouse->m_at = at;
        return;
    }
    if (std::abs(at[0] - mouse->m_at[0]) > kStill || std::abs(at[1] - mouse->m_at[1]) > kStill) return;
    for (const Watched& watched : mouse->m_watched)
        if (watched.window == window && watched.view)
            return mouse->m_clicked(watched.view, at, window->GetControlKey() != 0);
}

}  // namespace anamorph_paraview
