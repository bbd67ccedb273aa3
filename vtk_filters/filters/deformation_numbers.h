// SPDX-License-Identifier: Apache-2.0
// Deformations as the nine numbers of vtkAnamorphDeformationList, in tables and files. Functions throw
// anamorph::Error.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anamorph/deform/deformation.h"

class vtkTable;

namespace anamorph_vtk {

using Numbers = std::array<double, 9>;

/// Makes deformations of numbers. An error names what is wrong with an entry: "deformation 3: extent=0: must
/// be ...".
std::vector<anamorph::Deformation> checked_deformations(const std::vector<Numbers>& list);

Numbers numbers_of(const anamorph::Deformation& deformation);

std::vector<Numbers> read_deformations(const std::string& file_name);
void write_deformations(const std::string& file_name, const std::vector<Numbers>& list);

std::vector<Numbers> numbers_in(vtkTable* table);
void put_numbers(const std::vector<Numbers>& list, vtkTable* table);

}  // namespace anamorph_vtk
