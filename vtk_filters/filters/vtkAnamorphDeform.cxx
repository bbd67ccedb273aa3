// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphDeform.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/deform/formula_displacement.h"
#include "anamorph/error.h"
#include "anamorph/formula/formula_text.h"
#include "anamorph/parameter/parameter.h"
#include "automatic_plane.h"
#include "default_bump.h"
#include "deform_overlay.h"
#include "deformation_numbers.h"
#include "deformed_mesh.h"
#include "execution.h"
#include "explicit_points.h"
#include "input_times.h"
#include "subdivided.h"
#include "vtkAnamorphDeformationList.h"
#include "vtkCompositeDataIterator.h"
#include "vtkDataObjectTree.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

vtkObjectFactoryNewMacro(vtkAnamorphDeform);

namespace {

using anamorph::Deformation;
using anamorph::Error;
using anamorph::FormulaDisplacement;
using anamorph_vtk::DeformedMesh;
using anamorph_vtk::distributed;
using anamorph_vtk::kNumbers;
using anamorph_vtk::Numbers;

/// A leaf of the input, with explicit points, and that of the output, a shallow copy of it.
struct Leaf {
    vtkSmartPointer<vtkPointSet> in;
    vtkPointSet* out;
};

/// The deformations of the tables of all ranks: those of one if all that have any have the same.
std::vector<Numbers> of_all_ranks(const std::vector<Numbers>& own, bool failed,
                                  vtkMultiProcessController* controller) {
    const auto ranks = static_cast<std::size_t>(controller->GetNumberOfProcesses());
    const vtkIdType count = failed ? -1 : static_cast<vtkIdType>(kNumbers * own.size());
    std::vector<vtkIdType> counts(ranks), offsets(ranks);
    controller->AllGather(&count, counts.data(), 1);
    vtkIdType total = 0;
    for (std::size_t r = 0; r < ranks; ++r) {
        if (counts[r] < 0)
            throw Error("the table of deformations of rank " + std::to_string(r) + " is refused");
        offsets[r] = total;
        total += counts[r];
    }
    std::vector<double> flat, all(static_cast<std::size_t>(total) + 1);
    for (const Numbers& numbers : own) flat.insert(flat.end(), numbers.begin(), numbers.end());
    flat.push_back(0);  // so that there is an address
    controller->AllGatherV(flat.data(), all.data(), count, counts.data(), offsets.data());
    std::vector<std::vector<Numbers>> lists;
    for (std::size_t r = 0; r < ranks; ++r) {
        std::vector<Numbers> list(static_cast<std::size_t>(counts[r]) / kNumbers);
        for (std::size_t i = 0; i < list.size(); ++i)
            std::copy_n(all.begin() + offsets[r] + static_cast<std::ptrdiff_t>(kNumbers * i), kNumbers,
                        list[i].begin());
        if (!list.empty()) lists.push_back(std::move(list));
    }
    if (lists.empty()) return {};
    if (std::all_of(lists.begin(), lists.end(), [&](const auto& list) { return list == lists[0]; }))
        return lists[0];
    std::vector<Numbers> joined;
    for (const auto& list : lists) joined.insert(joined.end(), list.begin(), list.end());
    return joined;
}

std::vector<Numbers> table_of(vtkTable* table, vtkMultiProcessController* controller) {
    if (!distributed(controller)) return anamorph_vtk::numbers_in(table);
    std::vector<Numbers> own;
    std::string failure;
    try {
        own = anamorph_vtk::numbers_in(table);
    } catch (const std::exception& error) {
        failure = error.what();
    }
    try {
        return of_all_ranks(own, !failure.empty(), controller);
    } catch (const Error&) {
        if (!failure.empty()) throw Error(failure);
        throw;
    }
}

/// A deformation of a filter's own list; none beyond it, or after an error.
std::optional<Deformation> deformation_of(vtkAnamorphDeform* filter, int position) {
    const std::vector<Numbers>& all = filter->GetDeformationList()->GetAll();
    std::optional<Deformation> found;
    if (position < 0 || static_cast<std::size_t>(position) >= all.size()) return found;
    anamorph_vtk::guarded(filter, [&] {
        found = anamorph_vtk::checked_entries({all[static_cast<std::size_t>(position)]})[0].deformation;
    });
    return found;
}

/// The unit of fixed point for a list: fine enough that rounding is far below the cutoff, coarse enough for
/// the list to stay in range, and one of few, so that an edit hardly ever changes it.
double resolution_for(const std::vector<Deformation>& list) {
    double most = 0;
    std::size_t count = 0;
    for (const Deformation& d : list) {
        if (!d.enabled || d.vector == glm::dvec3(0.0)) continue;
        ++count;
        for (int c = 0; c < 3; ++c) most = std::max(most, std::fabs(d.vector[c]));
    }
    if (most == 0) return 0x1p-40;
    // V <= 2^48 units, and 2^14 of them fit. From 1/256 to 256 it is 2^-40.
    int exponent = 0, many = 0;
    std::frexp(most, &exponent);
    while ((count >> (14 + many)) > 0) ++many;
    constexpr int kStep = 16, kUsual = 8;
    const int steps = static_cast<int>(std::ceil((exponent + many - kUsual) / static_cast<double>(kStep)));
    return std::ldexp(1., std::clamp(kStep * steps + kUsual - 48, -500, 500));
}

/// A formula as the core reads it. Throws Error that names the filter's property.
FormulaDisplacement formula_of(const anamorph::DisplacementText& text, double frame) {
    static const std::map<std::string, std::string> kProperties = {
        {"x", "FormulaX"}, {"y", "FormulaY"}, {"z", "FormulaZ"}, {"let", "FormulaDefinitions"}};
    try {
        return FormulaDisplacement(parse_displacement(text, frame));
    } catch (const Error& error) {
        const auto property = kProperties.find(error.parameter());
        const std::string said = error.what();
        if (property == kProperties.end())
            throw Error("FormulaX, FormulaY and FormulaZ" + said.substr(said.find(": ")));
        throw Error(property->second + said.substr(property->first.size()));
    }
}

/// How far a list and a formula together may err.
double error_of_both(const anamorph::DisplacementSum& sum, const anamorph::FormulaOffsets& offsets) {
    // The sum becomes a double, and so does the whole. Then come a few operations on what is not negative.
    const double rounding = 2 * 0x1p-53 * (sum.most() + offsets.most);
    return (sum.error_bound() + offsets.error_bound + rounding) * (1 + 0x1p-49);
}

glm::dvec3 vector(const double* v) {
    return {v[0], v[1], v[2]};
}

void put(glm::dvec3 v, double* to) {
    for (int c = 0; c < 3; ++c) to[c] = v[c];
}

/// The numbers [begin, end) of all rows.
vtkSmartPointer<vtkDoubleArray> columns_of(const std::vector<Numbers>& list, int begin, int end) {
    auto columns = vtkSmartPointer<vtkDoubleArray>::New();
    columns->SetNumberOfComponents(end - begin);
    for (const Numbers& numbers : list) columns->InsertNextTuple(numbers.data() + begin);
    return columns;
}

void add_field_value(vtkDataObject* object, const char* name, double value) {
    // The container is shared with the input, the arrays stay so.
    vtkNew<vtkFieldData> fields;
    if (vtkFieldData* old = object->GetFieldData()) fields->PassData(old);
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->InsertNextValue(value);
    fields->AddArray(array);
    object->SetFieldData(fields);
}

}  // namespace

struct vtkAnamorphDeform::Kept {
    /// What is moved in place of a leaf, which stays while that does: a grid with explicit points, or a surface with more.
    struct Made {
        vtkMTimeType time = 0;
        int subdivisions = 0;
        vtkSmartPointer<vtkPointSet> points;
    };

    std::vector<std::unique_ptr<DeformedMesh>> meshes;  ///< by leaf
    std::vector<Made> made;                             ///< by leaf
    anamorph_vtk::AutomaticPlane plane;
    std::vector<vtkSmartPointer<vtkPointSet>> deformed, undeformed;  ///< by leaf
    anamorph::ParameterPlane used_plane;
    bool on_plane = false;

    vtkSmartPointer<vtkPointSet> to_be_moved(vtkDataObject* data, std::size_t leaf, int subdivisions) {
        auto* points = vtkPointSet::SafeDownCast(data);
        if (!vtkPolyData::SafeDownCast(data)) subdivisions = 0;
        if (points && subdivisions == 0) return points;
        if (made.size() <= leaf) made.resize(leaf + 1);
        // Times are given once only, so that of the leaf tells it from others too.
        const vtkMTimeType time = anamorph_vtk::time_of_points(data);
        if (made[leaf].time != time || made[leaf].subdivisions != subdivisions) {
            made[leaf] = {};
            made[leaf] = {time, subdivisions,
                          points ? anamorph_vtk::subdivided(points, subdivisions)
                                 : anamorph_vtk::with_explicit_points(data)};
        }
        return made[leaf].points;
    }
};

vtkAnamorphDeform::vtkAnamorphDeform()
    : DeformationList(vtkSmartPointer<vtkAnamorphDeformationList>::New()),
      Controller(vtkMultiProcessController::GetGlobalController()),
      Meshes(std::make_unique<Kept>()) {
    this->SetNumberOfInputPorts(2);
    this->SetNumberOfOutputPorts(2);
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                                 vtkDataSetAttributes::TCOORDS);
}

vtkAnamorphDeform::~vtkAnamorphDeform() {
    this->SetFileName(nullptr);
}

void vtkAnamorphDeform::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    const auto write = [&](const char* name, const double* v) {
        os << indent << name << ": " << v[0] << " " << v[1] << " " << v[2] << "\n";
    };
    os << indent << "FileName: " << (this->FileName ? this->FileName : "(none)") << "\n"
       << indent << "FormulaX: " << this->FormulaX << "\n"
       << indent << "FormulaY: " << this->FormulaY << "\n"
       << indent << "FormulaZ: " << this->FormulaZ << "\n"
       << indent << "FormulaDefinitions: " << this->FormulaDefinitions << "\n"
       << indent << "Frame: " << this->Frame << "\n"
       << indent << "ParameterMode: " << (this->ParameterMode == PLANE ? "Plane" : "Texture coordinates")
       << "\n"
       << indent << "AutomaticPlane: " << this->AutomaticPlane << "\n";
    write("Origin", this->Origin);
    write("Axis1", this->Axis1);
    write("Axis2", this->Axis2);
    write("UsedOrigin", this->UsedOrigin);
    write("UsedAxis1", this->UsedAxis1);
    write("UsedAxis2", this->UsedAxis2);
    os << indent << "Cutoff: " << this->Cutoff << "\n"
       << indent << "Subdivisions: " << this->Subdivisions << "\n"
       << indent << "ComputeFolds: " << this->ComputeFolds << "\n"
       << indent << "LeastJacobian: " << this->LeastJacobian << "\n"
       << indent << "ComputeNormals: " << this->ComputeNormals << "\n"
       << indent << "ComputeDisplacement: " << this->ComputeDisplacement << "\n"
       << indent << "GenerateOverlay: " << this->GenerateOverlay << "\n"
       << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n"
       << indent << "ErrorBound: " << this->ErrorBound << "\n"
       << indent << "NumberOfPointsComputed: " << this->NumberOfPointsComputed << "\n"
       << indent << "NumberOfUndefinedPoints: " << this->NumberOfUndefinedPoints << "\n"
       << indent << "SelectedDeformation: " << this->SelectedDeformation << "\n"
       << indent << "PickedPoint: " << this->PickedPoint[0] << " " << this->PickedPoint[1] << " "
       << this->PickedPoint[2] << "\n"
       << indent << "Controller: " << this->Controller.Get() << "\n"
       << indent << "DeformationList:\n";
    this->DeformationList->PrintSelf(os, indent.GetNextIndent());
}

void vtkAnamorphDeform::SetDeformationList(vtkAnamorphDeformationList* list) {
    if (!list || list == this->DeformationList) return;
    this->DeformationList = list;
    this->Modified();
}

vtkAnamorphDeformationList* vtkAnamorphDeform::GetDeformationList() {
    return this->DeformationList;
}
void vtkAnamorphDeform::SetNumberOfDeformations(int number) {
    this->DeformationList->SetNumberOfDeformations(number);
}
int vtkAnamorphDeform::GetNumberOfDeformations() {
    return this->DeformationList->GetNumberOfDeformations();
}
int vtkAnamorphDeform::AddDeformation(double center_u, double center_v, double extent_u, double extent_v,
                                      double x, double y, double z, double kernel, double enabled) {
    return this->DeformationList->AddDeformation(center_u, center_v, extent_u, extent_v, x, y, z, kernel,
                                                 enabled);
}
void vtkAnamorphDeform::InsertDeformation(int position, double center_u, double center_v, double extent_u,
                                          double extent_v, double x, double y, double z, double kernel,
                                          double enabled) {
    this->DeformationList->InsertDeformation(position, center_u, center_v, extent_u, extent_v, x, y, z,
                                             kernel, enabled);
}
void vtkAnamorphDeform::SetDeformation(int position, double center_u, double center_v, double extent_u,
                                       double extent_v, double x, double y, double z, double kernel,
                                       double enabled) {
    this->DeformationList->SetDeformation(position, center_u, center_v, extent_u, extent_v, x, y, z, kernel,
                                          enabled);
}
double* vtkAnamorphDeform::GetDeformation(int position) {
    return this->DeformationList->GetDeformation(position);
}
void vtkAnamorphDeform::SetDeformationEnabled(int position, bool enabled) {
    this->DeformationList->SetDeformationEnabled(position, enabled);
}
bool vtkAnamorphDeform::GetDeformationEnabled(int position) {
    return this->DeformationList->GetDeformationEnabled(position);
}
void vtkAnamorphDeform::MoveDeformation(int from, int to) {
    this->DeformationList->MoveDeformation(from, to);
}
void vtkAnamorphDeform::RemoveDeformation(int position) {
    this->DeformationList->RemoveDeformation(position);
}
void vtkAnamorphDeform::RemoveAllDeformations() {
    this->DeformationList->RemoveAllDeformations();
}

void vtkAnamorphDeform::SetDepth(int position, double center_w, double extent_w, double side) {
    this->DeformationList->SetDepth(position, center_w, extent_w, side);
}
void vtkAnamorphDeform::SetNumberOfDepths(int number) {
    this->DeformationList->SetNumberOfDepths(number);
}
int vtkAnamorphDeform::GetNumberOfDepths() {
    return this->DeformationList->GetNumberOfDepths();
}
double* vtkAnamorphDeform::GetDepth(int position) {
    return this->DeformationList->GetDepth(position);
}

void vtkAnamorphDeform::SetOrientation(int position, double w, double x, double y, double z) {
    this->DeformationList->SetOrientation(position, w, x, y, z);
}
double* vtkAnamorphDeform::GetOrientation(int position) {
    return this->DeformationList->GetOrientation(position);
}
void vtkAnamorphDeform::SetMirror(int position, double mirror, double at) {
    this->DeformationList->SetMirror(position, mirror, at);
}
double* vtkAnamorphDeform::GetMirror(int position) {
    return this->DeformationList->GetMirror(position);
}
void vtkAnamorphDeform::SetDeformationName(int position, const char* name) {
    this->DeformationList->SetName(position, name);
}
std::string vtkAnamorphDeform::GetDeformationName(int position) {
    return this->DeformationList->GetName(position);
}

int vtkAnamorphDeform::AnchorDeformation(int position) {
    const int selected = this->SelectedDeformation;
    this->SetSelectedDeformation(position);
    this->FindAnchor();
    const double* anchor = this->SelectedAnchor;
    this->SelectedDeformation = selected;
    const double* numbers = this->GetDeformation(position);
    if (anchor[1] == 0) {
        vtkErrorMacro(<< "position=" << position
                      << ": no part of the surface is over the deformation's centre, by the last execution; "
                         "there must be one, and the parameters be those of a plane");
        return 0;
    }
    const double side = this->GetDepth(position)[2];
    this->SetDeformation(position, numbers[0], numbers[1], numbers[2], numbers[3], anchor[6], anchor[7],
                         anchor[8], numbers[7], numbers[8]);
    this->SetDepth(position, anchor[0], anchor[1], side);
    this->SetOrientation(position, anchor[2], anchor[3], anchor[4], anchor[5]);
    return 1;
}

int vtkAnamorphDeform::AddDefaultDeformation() {
    this->FindDefault();
    const double* d = this->DefaultDeformation;
    if (d[2] == 0) {
        vtkErrorMacro(
            "there is no surface to put a deformation on, by the last execution: it must have points");
        return -1;
    }
    const int position = this->AddDeformation(d[0], d[1], d[2], d[3], d[4], d[5], d[6], d[7], d[8]);
    this->SetDepth(position, d[9], d[10], d[11]);
    this->SetOrientation(position, d[12], d[13], d[14], d[15]);
    if (d[16] > 0) this->SetSubdivisions(static_cast<int>(d[16]));
    return position;
}

vtkDoubleArray* vtkAnamorphDeform::GetAllDeformations() {
    this->AllDeformations = columns_of(this->DeformationList->GetAll(), 0, 9);
    return this->AllDeformations;
}

vtkDoubleArray* vtkAnamorphDeform::GetAllDepths() {
    this->AllDepths =
        columns_of(this->DeformationList->GetAll(), anamorph_vtk::kDepth, anamorph_vtk::kOrientation);
    return this->AllDepths;
}

void vtkAnamorphDeform::SetTableFrame(int position, double w, double x, double y, double z, double mirror,
                                      double at, double name) {
    // As rows of depths, they may come first.
    if (position >= 0 && position < static_cast<int>(anamorph::kMaxDeformations) &&
        position >= this->GetNumberOfDeformations())
        this->SetNumberOfDeformations(position + 1);
    this->SetOrientation(position, w, x, y, z);
    this->SetMirror(position, mirror, at);
    const auto index = static_cast<std::size_t>(std::max(position, 0));
    if (this->NameNumbers.size() <= index) this->NameNumbers.resize(index + 1, 0);
    if (this->NameNumbers[index] == name) return;
    this->NameNumbers[index] = name;
    this->Modified();
}

void vtkAnamorphDeform::SetNumberOfFrames(int number) {
    for (int i = std::max(number, 0); i < this->GetNumberOfDeformations(); ++i) {
        this->SetOrientation(i, 1, 0, 0, 0);
        this->SetMirror(i, 0, 0);
        if (static_cast<std::size_t>(i) < this->NameNumbers.size()) this->SetDeformationName(i, "");
    }
    if (static_cast<std::size_t>(std::max(number, 0)) < this->NameNumbers.size())
        this->NameNumbers.resize(static_cast<std::size_t>(std::max(number, 0)));
}

int vtkAnamorphDeform::GetNumberOfFrames() {
    const std::vector<Numbers>& all = this->DeformationList->GetAll();
    const auto last = std::find_if(all.rbegin(), all.rend(), [](const Numbers& numbers) {
        constexpr int kFirst = anamorph_vtk::kOrientation;
        return !numbers.Name.empty() ||
               !std::equal(numbers.begin() + kFirst, numbers.end(), anamorph_vtk::kNothing.begin() + kFirst);
    });
    return static_cast<int>(all.rend() - last);
}

vtkDoubleArray* vtkAnamorphDeform::GetAllFrames() {
    this->AllFrames = columns_of(this->DeformationList->GetAll(), anamorph_vtk::kOrientation, kNumbers);
    vtkDoubleArray* const six = this->AllFrames;
    auto seven = vtkSmartPointer<vtkDoubleArray>::New();
    seven->SetNumberOfComponents(7);
    for (int i = 0, named = 0; i < this->GetNumberOfDeformations(); ++i) {
        double row[7];
        six->GetTuple(i, row);
        row[6] = this->GetDeformationName(i).empty() ? 0 : ++named;
        seven->InsertNextTuple(row);
    }
    this->AllFrames = seven;
    return this->AllFrames;
}

void vtkAnamorphDeform::SetTableName(int index, const char* name) {
    if (index < 0 || index >= static_cast<int>(anamorph::kMaxDeformations)) return;
    const auto at = static_cast<std::size_t>(index);
    if (this->TableNames.size() <= at) this->TableNames.resize(at + 1);
    this->SetText(this->TableNames[at], name);
}

void vtkAnamorphDeform::SetNumberOfTableNames(int number) {
    const auto size = static_cast<std::size_t>(std::max(number, 0));
    if (size == this->TableNames.size()) return;
    this->TableNames.resize(size);
    this->Modified();
}

vtkStringArray* vtkAnamorphDeform::GetAllNames() {
    this->AllNames = vtkSmartPointer<vtkStringArray>::New();
    for (const Numbers& numbers : this->DeformationList->GetAll())
        if (!numbers.Name.empty()) this->AllNames->InsertNextValue(numbers.Name);
    return this->AllNames;
}

/// Gives the rows of a table the names that they have numbers of. Throws Error.
void vtkAnamorphDeform::NameDeformations() {
    const auto rows =
        std::min(this->NameNumbers.size(), static_cast<std::size_t>(this->GetNumberOfDeformations()));
    for (std::size_t i = 0; i < rows; ++i) {
        const double number = this->NameNumbers[i];
        if (!(number >= 0 && number <= static_cast<double>(this->TableNames.size())) ||
            number != std::floor(number))
            throw Error("deformation " + std::to_string(i) + ": name=" + anamorph::shortest(number) +
                        ": must be a whole number from 0 (none) to that of names, " +
                        std::to_string(this->TableNames.size()));
        this->SetDeformationName(
            static_cast<int>(i),
            number == 0 ? "" : this->TableNames[static_cast<std::size_t>(number) - 1].c_str());
    }
}

int vtkAnamorphDeform::ReadDeformations(const char* name) {
    if (!name || !*name) return 1;
    this->NameNumbers.clear();
    return this->DeformationList->ReadFile(name);
}

int vtkAnamorphDeform::WriteDeformations(const char* name) {
    const bool first = !this->Controller || this->Controller->GetLocalProcessId() == 0;
    if (!first || !name || !*name) return 1;
    return anamorph_vtk::guarded(this, [&] { this->NameDeformations(); }) &&
           this->DeformationList->WriteFile(name);
}

void vtkAnamorphDeform::SetText(std::string& member, const char* text) {
    const std::string given = text ? text : "";
    if (given == member) return;
    member = given;
    this->Modified();
}

void vtkAnamorphDeform::SetController(vtkMultiProcessController* controller) {
    if (controller == this->Controller) return;
    this->Controller = controller;
    this->Modified();
}

vtkMultiProcessController* vtkAnamorphDeform::GetController() {
    return this->Controller;
}

void vtkAnamorphDeform::FreezePlane() {
    this->SetOrigin(this->UsedOrigin);
    this->SetAxis1(this->UsedAxis1);
    this->SetAxis2(this->UsedAxis2);
    this->AutomaticPlaneOff();
}

vtkMTimeType vtkAnamorphDeform::GetMTime() {
    return std::max(this->Superclass::GetMTime(), this->DeformationList->GetMTime());
}

vtkPolyData* vtkAnamorphDeform::GetOverlay() {
    return vtkPolyData::SafeDownCast(this->GetOutputDataObject(1));
}

template <std::size_t Count, class Search>
void vtkAnamorphDeform::Find(double (&numbers)[Count], bool on_plane, const Search& search) {
    const Kept& kept = *this->Meshes;
    std::fill_n(numbers, Count, 0.0);
    const std::optional<Deformation> bump =
        kept.on_plane == on_plane ? deformation_of(this, this->SelectedDeformation) : std::nullopt;
    anamorph_vtk::take_best(numbers, Count, bump ? search(*bump, kept) : anamorph_vtk::kNowhere,
                            this->Controller);
}

void vtkAnamorphDeform::FindHeights() {
    this->Find(this->SelectedHeights, true, [this](const Deformation& bump, const Kept& kept) {
        return anamorph_vtk::find_heights(bump, kept.meshes, kept.deformed, kept.used_plane,
                                          this->SelectedHeights);
    });
}

void vtkAnamorphDeform::FindFrame() {
    this->Find(this->SelectedFrame, false, [this](const Deformation& bump, const Kept& kept) {
        return anamorph_vtk::find_frame(bump.center, kept.meshes, kept.undeformed, kept.deformed,
                                        this->SelectedFrame);
    });
}

void vtkAnamorphDeform::FindAnchor() {
    this->Find(this->SelectedAnchor, true, [this](const Deformation& bump, const Kept& kept) {
        return anamorph_vtk::find_anchor(bump, kept.meshes, kept.undeformed, kept.used_plane,
                                         this->SelectedAnchor);
    });
}

void vtkAnamorphDeform::FindDefault() {
    std::fill_n(this->DefaultDeformation, 17, 0.0);
    const Kept& kept = *this->Meshes;
    anamorph_vtk::guarded(this, [&] {
        const auto found = anamorph_vtk::find_default_bump(
            kept.meshes, kept.undeformed, kept.on_plane ? &kept.used_plane : nullptr, this->Controller);
        if (!found) return;
        const Numbers numbers = anamorph_vtk::numbers_of({found->bump});
        std::copy_n(numbers.begin(), 16, this->DefaultDeformation);
        // On top of those that the meshes have already.
        this->DefaultDeformation[16] =
            found->subdivisions == 0
                ? 0
                : std::min(this->Subdivisions + found->subdivisions, anamorph_vtk::kMostSubdivisions);
        const bool first = !this->Controller || this->Controller->GetLocalProcessId() == 0;
        if (first && found->subdivisions == 0 && found->points < anamorph_vtk::DefaultBump::kEnough)
            vtkWarningMacro(
                << "the mesh is coarse: it has " << found->points
                << " of its points within the extents of the deformation that it gets first, which "
                   "pulls them out. A finer mesh shows it round, by a higher resolution of its source or, of "
                   "polygons "
                   "alone, by Subdivisions");
    });
}

void vtkAnamorphDeform::FindSelected() {
    this->FindHeights();
    this->FindFrame();
}

double* vtkAnamorphDeform::GetSelectedHeights() {
    if (!anamorph_vtk::distributed(this->Controller)) this->FindHeights();
    return this->SelectedHeights;
}

double* vtkAnamorphDeform::GetSelectedFrame() {
    if (!anamorph_vtk::distributed(this->Controller)) this->FindFrame();
    return this->SelectedFrame;
}

double* vtkAnamorphDeform::GetSelectedAnchor() {
    if (!anamorph_vtk::distributed(this->Controller)) this->FindAnchor();
    return this->SelectedAnchor;
}

void vtkAnamorphDeform::PickAt(double x, double y, double z) {
    this->Pick({x, y, z}, std::nullopt);
}

void vtkAnamorphDeform::PickOnLine(double from_x, double from_y, double from_z, double to_x, double to_y,
                                   double to_z) {
    constexpr double none = std::numeric_limits<double>::quiet_NaN();
    const auto met = anamorph_vtk::find_on_line({from_x, from_y, from_z}, {to_x, to_y, to_z},
                                                this->Meshes->undeformed, this->Meshes->deformed)
                         .value_or(anamorph_vtk::MetPoint{glm::dvec3(none), none});
    this->Pick({met.point.x, met.point.y, met.point.z}, met.along);
}

void vtkAnamorphDeform::Pick(const std::array<double, 3>& at, std::optional<double> distance) {
    const anamorph_vtk::PickedPlace place = anamorph_vtk::find_place(
        {at[0], at[1], at[2]}, this->Meshes->meshes, this->Meshes->undeformed, this->Meshes->deformed);
    const double depth =
        place.found && this->Meshes->on_plane ? this->Meshes->used_plane.depth(place.point) : 0;
    // The point, u, v, w, and 1 where there is one.
    double picked[7] = {
        at[0], at[1], at[2], place.parameters.x, place.parameters.y, depth, place.found ? 1.0 : 0.0};
    anamorph_vtk::take_best(picked, 7, place.found ? distance.value_or(place.square) : anamorph_vtk::kNowhere,
                            this->Controller);
    std::copy_n(picked, 3, this->PickedPoint);
    std::copy_n(picked + 3, 4, this->PickedParameters);
}

double* vtkAnamorphDeform::GetPickedParameters() {
    return this->PickedParameters;
}

vtkTypeBool vtkAnamorphDeform::ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                                              vtkInformationVector* outputs) {
    if (!anamorph_vtk::has_inputs(this, {"the surface"})) return 0;
    return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkAnamorphDeform::FillInputPortInformation(int port, vtkInformation* info) {
    if (port == 0) {
        anamorph_vtk::require_points(info);
    } else {
        info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkTable");
    }
    info->Set(INPUT_IS_OPTIONAL(), 1);  // has_inputs() tells of the surface in our own words
    return 1;
}

int vtkAnamorphDeform::FillOutputPortInformation(int port, vtkInformation* info) {
    info->Set(vtkDataObject::DATA_TYPE_NAME(), port == 0 ? "vtkDataObject" : "vtkPolyData");
    return 1;
}

int vtkAnamorphDeform::RequestDataObject(vtkInformation*, vtkInformationVector** inputs,
                                         vtkInformationVector* outputs) {
    vtkDataObject* input = vtkDataObject::GetData(inputs[0]);
    if (!input) return 0;
    return anamorph_vtk::guarded(this, [&] {
        anamorph_vtk::make_output_of_points(outputs->GetInformationObject(0), input, "the surface");
        anamorph_vtk::make_output(outputs->GetInformationObject(1), vtkNew<vtkPolyData>());
    });
}

int vtkAnamorphDeform::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                          vtkInformationVector* outputs) {
    for (int port = 0; port < 2; ++port)
        anamorph_vtk::tell_times({inputs, 2}, outputs->GetInformationObject(port));
    return 1;
}

int vtkAnamorphDeform::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                           vtkInformationVector*) {
    using Pipeline = vtkStreamingDemandDrivenPipeline;
    // Cells beyond a cut have corners at its points.
    vtkInformation* input = inputs[0]->GetInformationObject(0);
    const std::vector<Numbers>& own = this->DeformationList->GetAll();
    const bool sided = std::any_of(own.begin(), own.end(), [](const Numbers& n) { return n[11] != 0; });
    if ((this->ComputeNormals || sided) && input && input->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) > 1)
        input->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(),
                   input->Get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS()) + 1);
    // Deformations reach across pieces.
    if (vtkInformation* table = inputs[1]->GetInformationObject(0)) {
        table->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
        table->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
        table->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
    }
    return 1;
}

int vtkAnamorphDeform::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                   vtkInformationVector* outputs) {
    const auto execute = [&] {
        try {
            this->Execute(inputs, outputs);
            for (int port = 0; port < 2; ++port)
                anamorph_vtk::hand_over_time({inputs, 2}, vtkDataObject::GetData(outputs, port));
        } catch (...) {
            this->Meshes->meshes.clear();
            this->Meshes->deformed.clear();
            this->Meshes->made.clear();
            throw;
        }
    };
    return anamorph_vtk::guarded(this, execute,
                                 {vtkDataObject::GetData(outputs, 0), vtkDataObject::GetData(outputs, 1)});
}

/// One execution of the filter, step by step.
struct vtkAnamorphDeform::Run {
    vtkAnamorphDeform& filter;
    vtkInformationVector* outputs;
    std::vector<Leaf> leaves = {};
    anamorph_vtk::DeformSettings settings = {};
    std::vector<Deformation> list = {};     ///< with images
    std::vector<std::size_t> entries = {};  ///< which of those that were given each is
    std::optional<FormulaDisplacement> formula = {};
    anamorph::DisplacementSum sum{{}};  ///< of the list

    void copy_leaves(vtkDataObject* input);
    void choose_plane();
    /// The filter's own deformations, those of its file, and `more`.
    void gather_deformations(const std::vector<Numbers>& more);
    void read_formula();
    void settle_precision();
    void deform_leaves();
    /// Says of a leaf what is known of its displacement. mesh: null where there are no points.
    void report(vtkPointSet* out, const DeformedMesh* mesh);
    void tell_folds(const DeformedMesh::Jacobian& least);
    void tell_missed() const;
    void draw_overlay_of_meshes();
};

void vtkAnamorphDeform::Run::copy_leaves(vtkDataObject* input) {
    vtkDataObject* output = vtkDataObject::GetData(outputs, 0);
    const auto add = [&](vtkDataObject* in, vtkPointSet* out) {
        leaves.push_back({filter.Meshes->to_be_moved(in, leaves.size(), filter.Subdivisions), out});
        out->ShallowCopy(leaves.back().in);
    };
    if (auto* tree = vtkDataObjectTree::SafeDownCast(input)) {
        auto* copies = vtkDataObjectTree::SafeDownCast(output);
        copies->CopyStructure(tree);
        if (vtkFieldData* fields = tree->GetFieldData()) copies->GetFieldData()->PassData(fields);
        const auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(tree->NewIterator());
        for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem()) {
            vtkDataObject* leaf = iterator->GetCurrentDataObject();
            if (const auto points = anamorph_vtk::new_point_set_like(leaf)) {
                add(leaf, points);
                copies->SetDataSet(iterator, points);
            } else {
                const auto copy = vtkSmartPointer<vtkDataObject>::Take(leaf->NewInstance());
                copy->ShallowCopy(leaf);
                copies->SetDataSet(iterator, copy);
            }
        }
    } else {
        add(input, vtkPointSet::SafeDownCast(output));
    }
    filter.Meshes->meshes.resize(leaves.size());
    filter.Meshes->made.resize(leaves.size());
}

void vtkAnamorphDeform::Run::choose_plane() {
    settings.on_plane = filter.ParameterMode == PLANE;
    if (settings.on_plane && filter.AutomaticPlane) {
        if (!distributed(filter.Controller) &&
            outputs->GetInformationObject(0)->Get(
                vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES()) > 1)
            throw Error(
                "AutomaticPlane=1: one piece of the data does not tell the bounds of all; set Origin, "
                "Axis1 and Axis2, or execute all pieces under a controller");
        std::vector<vtkPointSet*> meshes;
        for (const Leaf& leaf : leaves) meshes.push_back(leaf.in);
        settings.plane = filter.Meshes->plane.of(meshes, filter.Controller);
    } else {
        filter.Meshes->plane.forget();
        if (settings.on_plane)
            settings.plane = {vector(filter.Origin), vector(filter.Axis1), vector(filter.Axis2)};
    }
    put(settings.plane.origin(), filter.UsedOrigin);
    put(settings.plane.axis_u(), filter.UsedAxis1);
    put(settings.plane.axis_v(), filter.UsedAxis2);
}

void vtkAnamorphDeform::Run::gather_deformations(const std::vector<Numbers>& more) {
    filter.NameDeformations();
    std::vector<Numbers> numbers = filter.DeformationList->GetAll();
    if (filter.FileName && *filter.FileName) {
        const std::vector<Numbers> file = anamorph_vtk::read_deformations(filter.FileName);
        numbers.insert(numbers.end(), file.begin(), file.end());
    }
    numbers.insert(numbers.end(), more.begin(), more.end());
    anamorph::MirrorSteps steps;
    const anamorph::ParameterPlane& plane = settings.plane;
    if (settings.on_plane) steps = {plane.axis_u(), plane.gradient_u(), plane.axis_v(), plane.gradient_v()};
    anamorph::DeformationsWithImages all = anamorph_vtk::checked_deformations(numbers, steps);
    list = std::move(all.list);
    entries = std::move(all.entry);
}

void vtkAnamorphDeform::Run::read_formula() {
    if (!std::isfinite(filter.Frame))
        throw Error("Frame", anamorph::shortest(filter.Frame), "must be a finite number");
    if (filter.FormulaX.empty() && filter.FormulaY.empty() && filter.FormulaZ.empty()) return;
    formula = formula_of({filter.FormulaX, filter.FormulaY, filter.FormulaZ, filter.FormulaDefinitions},
                         filter.Frame);
}

void vtkAnamorphDeform::Run::settle_precision() {
    settings.options.cutoff = filter.Cutoff;
    settings.options.resolution = resolution_for(list);
    settings.precision = filter.OutputPointsPrecision;
    settings.displacement = filter.ComputeDisplacement;
    settings.normals = filter.ComputeNormals;
    sum = anamorph::DisplacementSum(settings.options);
    sum.apply(difference({}, list));
    filter.ErrorBound = sum.error_bound();
}

void vtkAnamorphDeform::Run::report(vtkPointSet* out, const DeformedMesh* mesh) {
    double bound = sum.error_bound();
    if (formula) {
        const anamorph::FormulaOffsets none;
        const anamorph::FormulaOffsets& offsets = mesh ? mesh->offsets() : none;
        bound = error_of_both(sum, offsets);
        add_field_value(out, "anamorph:undefined_points", static_cast<double>(offsets.undefined));
        filter.NumberOfUndefinedPoints += offsets.undefined;
        filter.ErrorBound = std::max(filter.ErrorBound, bound);
    }
    add_field_value(out, "anamorph:error_bound", bound);
}

void vtkAnamorphDeform::Run::deform_leaves() {
    anamorph_vtk::Execution execution(&filter);
    DeformedMesh::Jacobian least;
    const auto lesser = [](const DeformedMesh::Jacobian& a, const DeformedMesh::Jacobian& b) {
        return b.determinant < a.determinant ? b : a;
    };
    if (filter.ComputeFolds && !settings.on_plane)
        throw Error("ComputeFolds", "1",
                    "the parameters must be those of a plane: texture coordinates move no space");
    double total = 0, done = 0;
    for (const Leaf& leaf : leaves) total += static_cast<double>(leaf.in->GetNumberOfPoints());
    const double share = filter.GenerateOverlay ? 0.9 : 1;
    for (std::size_t i = 0; i < leaves.size(); ++i) {
        auto& [in, out] = leaves[i];
        std::unique_ptr<DeformedMesh>& mesh = filter.Meshes->meshes[i];
        const double count = static_cast<double>(in->GetNumberOfPoints());
        vtkDataArray* coordinates =
            settings.on_plane || count == 0 ? nullptr : filter.GetInputArrayToProcess(0, in);
        if (count == 0 || (mesh && !mesh->fits(in, coordinates, settings))) mesh = nullptr;
        if (!mesh) mesh = DeformedMesh::make(in, coordinates, settings);
        if (mesh) {
            const double begin = done / total * share, end = (done + count) / total * share;
            const double middle = formula ? begin + (end - begin) * 0.3 : begin;
            mesh->set_formula(formula, execution.stage(begin, middle));
            filter.NumberOfPointsComputed += mesh->deform(list, out, execution, middle, end);
            if (filter.ComputeFolds)
                least = lesser(least, mesh->write_jacobians(out, execution.stage(end, end)));
            done += count;
        }
        report(out, mesh.get());
    }
    tell_folds(least);
    tell_missed();
}

/// Warns of bumps that the mesh is around but has no point in: they lie between the points, where nothing moves, or hardly. Meshes of
/// many points are not looked through.
void vtkAnamorphDeform::Run::tell_missed() const {
    constexpr double kMostTests = 1 << 22;
    double points = 0;
    for (const auto& mesh : filter.Meshes->meshes)
        if (mesh) points += static_cast<double>(mesh->parameters().size());
    if (points * static_cast<double>(list.size()) > kMostTests) return;
    std::string missed;
    for (std::size_t k = 0; k < list.size(); ++k) {
        const Deformation& bump = list[k];
        if (!bump.enabled || bump.has_frame() || bump.vector == glm::dvec3(0.0)) continue;
        bool met = false;
        glm::dvec2 least(HUGE_VAL), most(-HUGE_VAL);
        for (const auto& mesh : filter.Meshes->meshes) {
            if (!mesh) continue;
            for (const glm::dvec2& at : mesh->parameters()) {
                const glm::dvec2 from = (at - bump.center) / bump.extent;
                met = met || glm::dot(from, from) <= 1;
                least = glm::min(least, from);
                most = glm::max(most, from);
            }
        }
        if (met || !(least.x < 0 && least.y < 0 && most.x > 0 && most.y > 0)) continue;
        missed += (missed.empty() ? "" : ", ") + std::to_string(entries[k] + 1);
    }
    if (missed.empty()) return;
    vtkWarningWithObjectMacro(
        &filter, << "the mesh has no points within the extents of deformations " << missed
                 << " (the first is 1), which lie between its points and show little or nothing: a finer "
                    "mesh shows them, by a higher resolution of its source or, of polygons, by Subdivisions");
}

void vtkAnamorphDeform::Run::tell_folds(const DeformedMesh::Jacobian& least) {
    filter.LeastJacobian = 1;
    put(glm::dvec3(0.0), filter.LeastJacobianPoint);
    if (!filter.ComputeFolds || std::isinf(least.determinant)) return;
    filter.LeastJacobian = least.determinant;
    put(least.point, filter.LeastJacobianPoint);
    if (least.determinant > 0) return;
    const auto text = [](double x) { return anamorph::shortest(x); };
    vtkWarningWithObjectMacro(&filter, << "the deformations fold space, worst at x=" << text(least.point.x)
                                       << ", y=" << text(least.point.y) << ", z=" << text(least.point.z)
                                       << ", where their Jacobian determinant is " << text(least.determinant)
                                       << ": there is no single inverse");
}

void vtkAnamorphDeform::Run::draw_overlay_of_meshes() {
    auto* overlay = vtkPolyData::GetData(outputs, 1);
    overlay->Initialize();
    if (!filter.GenerateOverlay) return;
    std::vector<anamorph_vtk::OverlayMesh> meshes;
    for (std::size_t i = 0; i < leaves.size(); ++i)
        if (filter.Meshes->meshes[i])
            meshes.push_back(
                {leaves[i].in, &filter.Meshes->meshes[i]->parameters(), &filter.Meshes->meshes[i]->depths()});
    const bool whole = settings.on_plane && !distributed(filter.Controller);
    draw_overlay(list, entries, settings.options, formula, meshes, whole ? &settings.plane : nullptr,
                 overlay);
}

void vtkAnamorphDeform::Execute(vtkInformationVector** inputs, vtkInformationVector* outputs) {
    this->NumberOfPointsComputed = 0;
    this->NumberOfUndefinedPoints = 0;
    this->Meshes->undeformed.clear();
    this->Meshes->deformed.clear();  // so that the meshes alone hold the points that they write
    Run run{*this, outputs};
    const auto input = anamorph_vtk::without_levels(vtkDataObject::GetData(inputs[0]));
    run.copy_leaves(input);
    // What all ranks do together comes first: one that then fails does not keep the others waiting.
    const std::vector<Numbers> more = table_of(vtkTable::GetData(inputs[1]), this->Controller);
    run.choose_plane();
    run.gather_deformations(more);
    run.read_formula();
    run.settle_precision();
    run.deform_leaves();
    run.draw_overlay_of_meshes();
    for (const Leaf& leaf : run.leaves) {
        // Their points alone: who has the output may change its arrays.
        this->Meshes->deformed.push_back(vtkSmartPointer<vtkPointSet>::Take(leaf.out->NewInstance()));
        this->Meshes->deformed.back()->SetPoints(leaf.out->GetPoints());
        this->Meshes->undeformed.push_back(vtkSmartPointer<vtkPointSet>::Take(leaf.in->NewInstance()));
        this->Meshes->undeformed.back()->CopyStructure(leaf.in);
    }
    this->Meshes->on_plane = run.settings.on_plane;
    this->Meshes->used_plane = run.settings.plane;
}
