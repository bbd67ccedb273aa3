// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphProjectionProxy
 * @brief   A projection that is coarse at once in ParaView's window, and fine when it is left alone.
 *
 * Where the session has a view in a window of Qt, a change of the filter or of its inputs gives the server's filter the
 * time of PreviewTime to be cut in. If Tolerance is not held then, it is cut without a budget, and all views are drawn, a moment after the
 * last change, when no button is pressed. No property has that state: undo, traces and states know nothing of it. Without a
 * window, or while an animation track moves the filter, the budget is none.
 */
#ifndef vtkSMAnamorphProjectionProxy_h
#define vtkSMAnamorphProjectionProxy_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMSourceProxy.h"

#include "vtkWeakPointer.h"  // for the window's timer

class vtkRenderWindowInteractor;

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphProjectionProxy : public vtkSMSourceProxy {
  public:
    static vtkSMAnamorphProjectionProxy* New();
    vtkTypeMacro(vtkSMAnamorphProjectionProxy, vtkSMSourceProxy);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    void MarkDirty(vtkSMProxy* modified) override;

  protected:
    vtkSMAnamorphProjectionProxy();
    ~vtkSMAnamorphProjectionProxy() override;

    void PostUpdateData(bool using_cache) override;

  private:
    vtkSMAnamorphProjectionProxy(const vtkSMAnamorphProjectionProxy&) = delete;
    void operator=(const vtkSMAnamorphProjectionProxy&) = delete;

    vtkRenderWindowInteractor* FindWindow();
    bool IsAnimated();
    void GiveTime(double seconds);
    void StartTimer();
    void StopTimer();
    void TimerFires(vtkObject*, unsigned long, void* id);
    void Refine();

    double Given = 0;  ///< the server's TimeBudget
    bool InStep = false;
    vtkWeakPointer<vtkRenderWindowInteractor> Window;  ///< whose timer runs
    int Timer = 0;
    unsigned long Observer = 0;
};

#endif
