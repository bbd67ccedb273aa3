// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphDeformationList.h"

#include <algorithm>
#include <limits>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/error.h"
#include "deformation_numbers.h"
#include "execution.h"
#include "vtkObjectFactory.h"
#include "vtkTable.h"

vtkObjectFactoryNewMacro(vtkAnamorphDeformationList);

namespace {

using Numbers = vtkAnamorphDeformationList::Numbers;
using anamorph_vtk::kNothing;

constexpr int kMost = static_cast<int>(anamorph::kMaxDeformations);
constexpr int kPlain = anamorph_vtk::kDepth;  ///< the numbers without those of the depth

/// Compares bits, so that NaN equals itself and setting it again changes nothing.
bool same(const Numbers& a, const Numbers& b) {
    return a.Name == b.Name && std::equal(a.begin(), a.end(), b.begin(),
                                          [](double x, double y) { return x == y || (x != x && y != y); });
}

}  // namespace

vtkAnamorphDeformationList::vtkAnamorphDeformationList() = default;
vtkAnamorphDeformationList::~vtkAnamorphDeformationList() = default;

void vtkAnamorphDeformationList::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "NumberOfDeformations: " << this->GetNumberOfDeformations() << "\n";
    for (const Numbers& numbers : this->List) {
        os << indent.GetNextIndent();
        for (const double number : numbers) os << " " << number;
        os << " " << numbers.Name << "\n";
    }
}

bool vtkAnamorphDeformationList::IsPosition(int position, int end) {
    if (position >= 0 && position < end) return true;
    vtkErrorMacro(<< "position=" << position
                  << (end > 0 ? ": must be an integer from 0 to " + std::to_string(end - 1)
                              : std::string(": the list is empty")));
    return false;
}

void vtkAnamorphDeformationList::SetNumberOfDeformations(int number) {
    if (number < 0 || number > kMost) {
        vtkErrorMacro(<< "NumberOfDeformations=" << number << ": must be an integer from 0 to " << kMost);
        return;
    }
    if (number == this->GetNumberOfDeformations()) return;
    this->List.resize(static_cast<std::size_t>(number), kNothing);
    this->Modified();
}

int vtkAnamorphDeformationList::GetNumberOfDeformations() {
    return static_cast<int>(this->List.size());
}

int vtkAnamorphDeformationList::AddDeformation(double center_u, double center_v, double extent_u,
                                               double extent_v, double x, double y, double z, double kernel,
                                               double enabled) {
    this->InsertDeformation(this->GetNumberOfDeformations(), center_u, center_v, extent_u, extent_v, x, y, z,
                            kernel, enabled);
    return this->GetNumberOfDeformations() - 1;
}

void vtkAnamorphDeformationList::InsertDeformation(int position, double center_u, double center_v,
                                                   double extent_u, double extent_v, double x, double y,
                                                   double z, double kernel, double enabled) {
    if (!this->IsPosition(position, std::min(this->GetNumberOfDeformations() + 1, kMost))) return;
    Numbers numbers = kNothing;
    std::ranges::copy(std::array{center_u, center_v, extent_u, extent_v, x, y, z, kernel, enabled},
                      numbers.begin());
    this->List.insert(this->List.begin() + position, numbers);
    this->Modified();
}

void vtkAnamorphDeformationList::SetDeformation(int position, double center_u, double center_v,
                                                double extent_u, double extent_v, double x, double y,
                                                double z, double kernel, double enabled) {
    if (!this->IsPosition(position, this->GetNumberOfDeformations())) return;
    this->SetNumbers(position, 0, {center_u, center_v, extent_u, extent_v, x, y, z, kernel, enabled});
}

void vtkAnamorphDeformationList::SetDeformationEnabled(int position, bool enabled) {
    if (!this->IsPosition(position, this->GetNumberOfDeformations())) return;
    double& place = this->List[static_cast<std::size_t>(position)][8];
    if (place == (enabled ? 1 : 0)) return;
    place = enabled ? 1 : 0;
    this->Modified();
}

bool vtkAnamorphDeformationList::GetDeformationEnabled(int position) {
    return this->IsPosition(position, this->GetNumberOfDeformations()) &&
           this->List[static_cast<std::size_t>(position)][8] == 1;
}

void vtkAnamorphDeformationList::MoveDeformation(int from, int to) {
    const int end = this->GetNumberOfDeformations();
    if (!this->IsPosition(from, end) || !this->IsPosition(to, end) || from == to) return;
    const auto begin = this->List.begin();
    if (from < to)
        std::rotate(begin + from, begin + from + 1, begin + to + 1);
    else
        std::rotate(begin + to, begin + from, begin + from + 1);
    this->Modified();
}

void vtkAnamorphDeformationList::RemoveDeformation(int position) {
    if (!this->IsPosition(position, this->GetNumberOfDeformations())) return;
    this->List.erase(this->List.begin() + position);
    this->Modified();
}

void vtkAnamorphDeformationList::RemoveAllDeformations() {
    this->SetNumberOfDeformations(0);
}

void vtkAnamorphDeformationList::GetDeformation(int position, double numbers[9]) {
    std::fill(numbers, numbers + kPlain, std::numeric_limits<double>::quiet_NaN());
    if (!this->IsPosition(position, this->GetNumberOfDeformations())) return;
    const Numbers& place = this->List[static_cast<std::size_t>(position)];
    std::copy_n(place.begin(), kPlain, numbers);
}

double* vtkAnamorphDeformationList::GetDeformation(int position) {
    this->GetDeformation(position, this->Answer);
    return this->Answer;
}

void vtkAnamorphDeformationList::SetDepth(int position, double center_w, double extent_w, double side) {
    if (!this->IsPosition(position, kMost)) return;
    if (position >= this->GetNumberOfDeformations()) this->SetNumberOfDeformations(position + 1);
    this->SetNumbers(position, kPlain, {center_w, extent_w, side});
}

void vtkAnamorphDeformationList::SetNumberOfDepths(int number) {
    for (int i = std::max(number, 0); i < this->GetNumberOfDeformations(); ++i) this->SetDepth(i, 0, 0, 0);
}

int vtkAnamorphDeformationList::GetNumberOfDepths() {
    const auto last = std::find_if(this->List.rbegin(), this->List.rend(), [](const Numbers& numbers) {
        return std::any_of(numbers.begin() + kPlain, numbers.begin() + anamorph_vtk::kOrientation,
                           [](double n) { return n != 0; });
    });
    return static_cast<int>(this->List.rend() - last);
}

double* vtkAnamorphDeformationList::GetDepth(int position) {
    return this->GetNumbers(position, kPlain, anamorph_vtk::kOrientation);
}

void vtkAnamorphDeformationList::SetOrientation(int position, double w, double x, double y, double z) {
    if (this->IsPosition(position, this->GetNumberOfDeformations()))
        this->SetNumbers(position, anamorph_vtk::kOrientation, {w, x, y, z});
}

double* vtkAnamorphDeformationList::GetOrientation(int position) {
    return this->GetNumbers(position, anamorph_vtk::kOrientation, anamorph_vtk::kMirror);
}

void vtkAnamorphDeformationList::SetMirror(int position, double mirror, double at) {
    if (this->IsPosition(position, this->GetNumberOfDeformations()))
        this->SetNumbers(position, anamorph_vtk::kMirror, {mirror, at});
}

double* vtkAnamorphDeformationList::GetMirror(int position) {
    return this->GetNumbers(position, anamorph_vtk::kMirror, anamorph_vtk::kNumbers);
}

void vtkAnamorphDeformationList::SetName(int position, const char* name) {
    if (!this->IsPosition(position, this->GetNumberOfDeformations())) return;
    std::string& place = this->List[static_cast<std::size_t>(position)].Name;
    const std::string given = name ? name : "";
    if (place == given) return;
    place = given;
    this->Modified();
}

std::string vtkAnamorphDeformationList::GetName(int position) {
    if (!this->IsPosition(position, this->GetNumberOfDeformations())) return "";
    return this->List[static_cast<std::size_t>(position)].Name;
}

void vtkAnamorphDeformationList::SetNumbers(int position, int first, const std::vector<double>& numbers) {
    Numbers& place = this->List[static_cast<std::size_t>(position)];
    Numbers changed = place;
    std::copy(numbers.begin(), numbers.end(), changed.begin() + first);
    if (same(place, changed)) return;
    place = changed;
    this->Modified();
}

/// Some numbers of a deformation; NaN where it is not in the list.
double* vtkAnamorphDeformationList::GetNumbers(int position, int first, int end) {
    std::fill(this->Answer + first, this->Answer + end, std::numeric_limits<double>::quiet_NaN());
    if (this->IsPosition(position, this->GetNumberOfDeformations()))
        std::copy_n(this->List[static_cast<std::size_t>(position)].begin() + first, end - first,
                    this->Answer + first);
    return this->Answer + first;
}

int vtkAnamorphDeformationList::ReadFile(const char* name) {
    return anamorph_vtk::guarded(this, [&] {
        this->List = anamorph_vtk::read_deformations(name ? name : "");
        this->Modified();
    });
}

int vtkAnamorphDeformationList::WriteFile(const char* name) {
    return anamorph_vtk::guarded(this,
                                 [&] { anamorph_vtk::write_deformations(name ? name : "", this->List); });
}

int vtkAnamorphDeformationList::ReadTable(vtkTable* table) {
    return anamorph_vtk::guarded(this, [&] {
        if (!table) throw anamorph::Error("there is no table");
        this->List = anamorph_vtk::numbers_in(table);
        this->Modified();
    });
}

void vtkAnamorphDeformationList::WriteTable(vtkTable* table) {
    anamorph_vtk::guarded(this, [&] {
        if (!table) throw anamorph::Error("there is no table");
        anamorph_vtk::put_numbers(this->List, table);
    });
}

void vtkAnamorphDeformationList::DeepCopy(vtkAnamorphDeformationList* other) {
    if (!other ||
        std::equal(this->List.begin(), this->List.end(), other->List.begin(), other->List.end(), same))
        return;
    this->List = other->List;
    this->Modified();
}
