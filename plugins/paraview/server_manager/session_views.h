// SPDX-License-Identifier: Apache-2.0
// The views of a session, and the mouse in those that are in ParaView's window.
#pragma once

#include <array>
#include <functional>
#include <vector>

#include "vtkNew.h"
#include "vtkSMProxy.h"
#include "vtkSMProxyIterator.h"
#include "vtkSMSessionProxyManager.h"
#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

class vtkCallbackCommand;
class vtkObject;
class vtkRenderWindowInteractor;
class vtkSMRenderViewProxy;

namespace anamorph_paraview {

/// Calls `call` with every proxy of a group until it returns true.
template <class Call>
bool any_proxy(vtkSMProxy* of, const char* group, const Call& call) {
    vtkSMSessionProxyManager* manager = of->GetSessionProxyManager();
    if (!manager) return false;
    vtkNew<vtkSMProxyIterator> each;
    each->SetSessionProxyManager(manager);
    each->SetModeToOneGroup();
    for (each->Begin(group); !each->IsAtEnd(); each->Next())
        if (call(each->GetProxy())) return true;
    return false;
}

/// The session's render views.
std::vector<vtkSMRenderViewProxy*> render_views(vtkSMProxy* of);

/// The interactor of a view in a window of Qt; null where there is none.
vtkRenderWindowInteractor* window_of(vtkSMRenderViewProxy* view);

/// Draws all render views anew.
void draw_views(vtkSMProxy* of);

/// The left button in the views of ParaView's window, seen before what else takes it, and left to that.
class ViewMouse {
  public:
    /// The view that was clicked, the button pressed and let go at one place, in pixels from the lower left; and whether Ctrl was held.
    using Clicked =
        std::function<void(vtkSMRenderViewProxy* view, const std::array<int, 2>& at, bool control)>;

    explicit ViewMouse(Clicked clicked);
    ~ViewMouse();
    ViewMouse(const ViewMouse&) = delete;
    ViewMouse& operator=(const ViewMouse&) = delete;

    /// Looks for views that are new.
    void watch(vtkSMProxy* of);
    /// Is the button held?
    bool is_down() const { return m_down; }

  private:
    struct Watched {
        vtkWeakPointer<vtkSMRenderViewProxy> view;
        vtkWeakPointer<vtkRenderWindowInteractor> window;
        std::array<unsigned long, 2> observers;
    };
    static void happens(vtkObject* window, unsigned long event, void* self, void*);

    Clicked m_clicked;
    vtkSmartPointer<vtkCallbackCommand> m_command;
    std::vector<Watched> m_watched;
    bool m_down = false;
    std::array<int, 2> m_at{};  ///< where it was pressed
};

}  // namespace anamorph_paraview
