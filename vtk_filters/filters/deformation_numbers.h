// SPDX-License-Identifier: Apache-2.0
// Deformations as the twelve numbers of vtkAnamorphDeformationList, in tables and files. Functions throw
// anamorph::Error.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "anamorph/deform/deformation.h"

class vtkTable;

namespace anamorph_vtk {

constexpr int kNumbers = 12;
using Numbers = std::array<double, kNumbers>;
/// The numbers of a deformation that moves nothing.
inline constexpr Numbers kNothing = {0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0};

/// Makes deformations of numbers. An error names what is wrong with an entry: "deformation 3: extent=0: must
/// be ...".
std::vector<anamorph::Deformation> checked_deformations(const std::vector<Numbers>& list);

Numbers numbers_of(const anamorph::Deformation& deformation);

std::vector<Numbers> read_deformations(const std::string& file_name);
void write_deformations(const std::string& file_name, const std::vector<Numbers>& list);

std::vector<Numbers> numbers_in(vtkTable* table);
void put_numbers(const std::vector<Numbers>& list, vtkTable* table);

}  // namespace anamorph_vtk
