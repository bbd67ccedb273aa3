// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphDeformProxy
 * @brief   A list of deformations as a panel, handles in a view, and files edit it.
 *
 * The list is the property Deformations, of a row of numbers for each deformation: c_u, c_v, a_u, a_v, V_x,
 * V_y, V_z, kernel, enabled (Oka 1987, eq. 4.1). A table in a panel edits it, but a handle in a view wants
 * properties of its own, in space: SelectedCenter, SelectedCorner (centre + extent), SelectedTip (the centre's
 * handle + V) and SelectedVector show row SelectedDeformation, after an update on the deformed surface. What is written to them is written to the row, and they follow the list, the
 * selection and the plane of (u, v).
 *
 * What is set between two updates of the filter acts together, each property with its last value, whatever
 * the order it is set in: the list, in it the row that is selected, in it what the handles were put to, seen
 * in the parameters that are chosen. A handle that is where the row has it changes nothing, to the bit. So
 * traces and macros, which have the handles beside the list, make the list that was recorded.
 *
 * Bumps is the whole table: the columns of the properties Deformations, Depths and Frames, which the server has, row by row, so that a
 * row that is removed, moved or added takes all of its own along. What is set of the parts is shown in the table, and the other way round.
 *
 * A new list begins with a bump that shows on the input, which on closed surfaces has rows of Depths and Frames. A script that then gives another list
 * of Deformations alone, as scripts did before there were the others, gets that list: these rows go, and the subdivisions for it, which go with any other list.
 *
 * Scripts that remove rows from Deformations alone, and do not set Depths or Frames in the same step, lose the rows of these that
 * belong to them.
 *
 * The automatic plane is that of the last update, or before one that of the input's bounds. The command
 * FreezePlane updates the filter and makes it Origin, Axis1 and Axis2, with AutomaticPlane off.
 *
 * In ParaView's window, dragging a handle shows the surface live: the server's filter has the row that the handle says, past the properties, which
 * undo, traces and states follow; these change when it is applied. A click on the surface selects the bump it is on (of several the one that it is
 * the most in the middle of), and with Ctrl makes a new one there, anchored to the surface, or at the (u, v) of texture
 * coordinates: of a filter that is the active source.
 *
 * Setting ImportFile takes the list from a file on the server, setting ExportFile writes it to one; both are
 * empty again when that is done.
 *
 * States have all of this as it was, and are loaded without one side following the other.
 */
#ifndef vtkSMAnamorphDeformProxy_h
#define vtkSMAnamorphDeformProxy_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMAnamorphSourceProxy.h"

#include <array>       // for points
#include <functional>  // for defaults
#include <memory>      // for the edits and the mouse
#include <vector>      // for lists

namespace anamorph_paraview {
class ViewMouse;
}

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphDeformProxy : public vtkSMAnamorphSourceProxy {
  public:
    static vtkSMAnamorphDeformProxy* New();
    vtkTypeMacro(vtkSMAnamorphDeformProxy, vtkSMAnamorphSourceProxy);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    void UpdateVTKObjects() override;
    int LoadXMLState(vtkPVXMLElement* element, vtkSMProxyLocator* locator) override;
    void LoadState(const vtkSMMessage* message, vtkSMProxyLocator* locator) override;

    /**
     * Origin, Axis1 and Axis2 of the automatic plane of the last update, or, for texture coordinates, of the plane that touches the deformed
     * surface at the centre of the selected deformation; null where there was none, or the parameters are others than then.
     */
    const double* GetUsedPlane();

    /**
     * What a list's property (Deformations, or after it Depths, and after that Frames) has of the deformation that a new list begins
     * with; nothing where there is no surface yet, a file or a table gives the list, or the properties before it have another one.
     */
    std::vector<double> DefaultRow(vtkSMProperty* property);
    /**
     * What Subdivisions has of it.
     */
    int DefaultSubdivisions();
    /**
     * Calls what sets a property to its default, which is not an edit of it.
     */
    void SetDefault(const std::function<void()>& set);

  protected:
    vtkSMAnamorphDeformProxy();
    ~vtkSMAnamorphDeformProxy() override;

    int ReadXMLAttributes(vtkSMSessionProxyManager* manager, vtkPVXMLElement* element) override;
    void SetPropertyModifiedFlag(const char* name, int flag) override;
    void PostUpdateData(bool using_cache) override;

  private:
    vtkSMAnamorphDeformProxy(const vtkSMAnamorphDeformProxy&) = delete;
    void operator=(const vtkSMAnamorphDeformProxy&) = delete;

    struct Edits;

    void Edited(const char* name);
    void Resolve();
    void ShowHandles(bool all);
    void TakeUsedPlane();
    void Find(const char* what);
    bool TakeHeights();
    bool TipIsShown();
    void ImportDeformations(const char* file);
    void RemoveDepths();
    void SplitBumps();
    void ShowBumps();
    bool TakeAnchor(double* row);
    void FindDefault();
    void ForgetDefault(bool alone);
    void AnchorSelected();
    void PropertyPushed(vtkObject*, unsigned long, void* name);
    void FreezePlane();
    void HandleDragged();
    void ViewClicked(vtkSMProxy* view, double x, double y, bool control);
    bool IsActive();
    int FindBump(double u, double v);
    void SelectBump(int position);
    void AddBump(double u, double v, double w, const std::array<double, 3>& away);

    bool InStep = true;         ///< one side follows the other, or not all properties are there yet
    bool HandlesPut = false;    ///< SelectedCenter has been written to
    bool FilesPending = false;  ///< ImportFile or ExportFile is set, and not yet sent
    double UsedPlane[9] = {};
    bool UsedPlaneKnown = false;
    int UsedMode = 0;                ///< ParameterMode of the last update
    std::vector<double> KnownList;   ///< Deformations, as they were sent last
    bool ListEdited = false;         ///< Deformations has been written to since
    double Heights[2] = {};          ///< of the handles of the centre and the corner over the plane
    std::unique_ptr<Edits> Pending;  ///< edits since the last update
    std::vector<double>
        DefaultBump;  ///< the numbers of the default that was given last, as it was edited since
    std::vector<double>
        DraggedRow;  ///< that the server has in place of the selected one; none if it has that
    std::unique_ptr<anamorph_paraview::ViewMouse> Mouse;
};

#endif
