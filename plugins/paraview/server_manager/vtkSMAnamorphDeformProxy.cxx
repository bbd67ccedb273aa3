// SPDX-License-Identifier: Apache-2.0
#include "vtkSMAnamorphDeformProxy.h"

#include <cmath>
#include <string_view>
#include <vector>

#include "deformation_frame.h"
#include "vtkObjectFactory.h"
#include "vtkSMProperty.h"
#include "vtkSMPropertyHelper.h"

using namespace anamorph_paraview;

vtkStandardNewMacro(vtkSMAnamorphDeformProxy);

namespace {

/// Holds a flag up.
struct WhileLoading {
    explicit WhileLoading(bool& held) : flag(held), before(held) { flag = true; }
    ~WhileLoading() { flag = before; }
    WhileLoading(const WhileLoading&) = delete;
    WhileLoading& operator=(const WhileLoading&) = delete;

    bool& flag;
    bool before;
};

}  // namespace

vtkSMAnamorphDeformProxy::vtkSMAnamorphDeformProxy() = default;
vtkSMAnamorphDeformProxy::~vtkSMAnamorphDeformProxy() = default;

void vtkSMAnamorphDeformProxy::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
}

int vtkSMAnamorphDeformProxy::ReadXMLAttributes(vtkSMSessionProxyManager* manager, vtkPVXMLElement* element) {
    const int read = this->Superclass::ReadXMLAttributes(manager, element);
    this->InStep = false;
    return read;
}

void vtkSMAnamorphDeformProxy::SetPropertyModifiedFlag(const char* name, int flag) {
    this->Superclass::SetPropertyModifiedFlag(name, flag);
    if (flag == 0 || this->InStep) return;
    this->InStep = true;
    const std::string_view changed = name;
    if (changed == "SelectedCenter") this->WriteCenter();
    if (changed == "SelectedCorner") this->WriteExtent();
    if (changed == "SelectedVector") this->WriteVector();
    for (const char* followed : {"SelectedCenter", "SelectedDeformation", "Deformations", "Input",
                                 "ParameterMode", "AutomaticPlane", "Origin", "Axis1", "Axis2"})
        if (changed == followed) this->ShowRow();
    this->InStep = false;
    if (changed == "ImportFile" || changed == "ExportFile") this->FilesPending = true;
}

int vtkSMAnamorphDeformProxy::LoadXMLState(vtkPVXMLElement* element, vtkSMProxyLocator* locator) {
    const WhileLoading loading(this->InStep);
    return this->Superclass::LoadXMLState(element, locator);
}

void vtkSMAnamorphDeformProxy::LoadState(const vtkSMMessage* message, vtkSMProxyLocator* locator) {
    const WhileLoading loading(this->InStep);
    this->Superclass::LoadState(message, locator);
}

void vtkSMAnamorphDeformProxy::UpdateVTKObjects() {
    this->Superclass::UpdateVTKObjects();
    if (!this->FilesPending) return;
    vtkSMPropertyHelper import_file(this, "ImportFile"), export_file(this, "ExportFile");
    if (*import_file.GetAsString() != '\0') {
        vtkSMProperty* list = this->GetProperty("DeformationsInfo");
        this->UpdatePropertyInformation(list);
        const std::vector<double> rows = vtkSMPropertyHelper(list).GetDoubleArray();
        vtkSMPropertyHelper(this, "Deformations").Set(rows.data(), static_cast<unsigned int>(rows.size()));
    }
    // What is done once is not done again by a state or an undo.
    import_file.Set("");
    export_file.Set("");
    this->FilesPending = false;
    this->Superclass::UpdateVTKObjects();
}

namespace {

/// The row that is selected, and the plane it is on. `complete` is false where there is none, or the plane is
/// not known yet: then both sides stay as they are.
struct Selection {
    explicit Selection(vtkSMProxy* proxy)
        : deformations(proxy, "Deformations", true),
          center(proxy, "SelectedCenter", true),
          corner(proxy, "SelectedCorner", true),
          vector(proxy, "SelectedVector", true) {
        const unsigned int columns = columns_of(proxy->GetProperty("Deformations"));
        const int selected = vtkSMPropertyHelper(proxy, "SelectedDeformation", true).GetAsInt();
        const std::optional<Frame> known = frame_of(proxy);
        if (columns < kLeastColumns || selected < 0 || !known) return;
        frame = *known;
        row = static_cast<unsigned int>(selected) * columns;
        complete = deformations.GetNumberOfElements() >= row + columns && center.GetNumberOfElements() == 3 &&
                   corner.GetNumberOfElements() == 3 && vector.GetNumberOfElements() == 3;
    }
    double value(unsigned int column) const { return deformations.GetAsDouble(row + column); }
    void set_value(unsigned int column, double value) { deformations.Set(row + column, value); }
    Point parameters(const vtkSMPropertyHelper& handle) const {
        return frame.parameters({handle.GetAsDouble(0), handle.GetAsDouble(1), handle.GetAsDouble(2)});
    }

    Frame frame;
    vtkSMPropertyHelper deformations, center, corner, vector;
    unsigned int row = 0;
    bool complete = false;
};

}  // namespace

void vtkSMAnamorphDeformProxy::ShowRow() {
    Selection selection(this);
    if (!selection.complete) return;
    const double u = selection.value(kCenter), v = selection.value(kCenter + 1);
    // Handles are on the plane, or where they have been put across it.
    const double height = this->HandlesPut ? selection.parameters(selection.center)[2] : 0;
    const Point center = selection.frame.point(u, v, height);
    const Point corner =
        selection.frame.point(u + selection.value(kExtent), v + selection.value(kExtent + 1), height);
    selection.center.Set(center.data(), 3);
    selection.corner.Set(corner.data(), 3);
    for (unsigned int i = 0; i < 3; ++i) selection.vector.Set(i, selection.value(kVector + i));
}

void vtkSMAnamorphDeformProxy::WriteCenter() {
    Selection selection(this);
    if (!selection.complete) return;
    this->HandlesPut = true;
    const Point center = selection.parameters(selection.center);
    for (unsigned int i = 0; i < 2; ++i) selection.set_value(kCenter + i, center[i]);
}

void vtkSMAnamorphDeformProxy::WriteExtent() {
    Selection selection(this);
    if (!selection.complete) return;
    const Point corner = selection.parameters(selection.corner);
    for (unsigned int i = 0; i < 2; ++i)
        selection.set_value(kExtent + i, std::fabs(corner[i] - selection.value(kCenter + i)));
}

void vtkSMAnamorphDeformProxy::WriteVector() {
    Selection selection(this);
    if (!selection.complete) return;
    for (unsigned int i = 0; i < 3; ++i) selection.set_value(kVector + i, selection.vector.GetAsDouble(i));
}
