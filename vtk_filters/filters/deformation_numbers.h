// SPDX-License-Identifier: Apache-2.0
// Deformations as the eighteen numbers, and the name, of vtkAnamorphDeformationList, in tables and files. Functions throw
// anamorph::Error.
#pragma once

#include <string>
#include <vector>

#include "anamorph/deform/deformation_entry.h"
#include "vtkAnamorphDeformationList.h"

class vtkTable;

namespace anamorph_vtk {

using Numbers = vtkAnamorphDeformationList::Numbers;
constexpr int kNumbers = static_cast<int>(std::tuple_size_v<Numbers::Array>);
constexpr int kDepth = 9, kSide = 11, kOrientation = 12, kMirror = 16;
/// The numbers of a deformation that moves nothing.
inline const Numbers kNothing = {{0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 0, 0}, ""};

/// Makes deformations of numbers. An error names what is wrong with an entry: "deformation 3: extent=0: must
/// be ...".
std::vector<anamorph::DeformationEntry> checked_entries(const std::vector<Numbers>& list);
/// The same, with the images of those that have one behind them.
anamorph::DeformationsWithImages checked_deformations(const std::vector<Numbers>& list,
                                                      const anamorph::MirrorSteps& steps = {});

Numbers numbers_of(const anamorph::DeformationEntry& entry);

std::vector<Numbers> read_deformations(const std::string& file_name);
void write_deformations(const std::string& file_name, const std::vector<Numbers>& list);

std::vector<Numbers> numbers_in(vtkTable* table);
void put_numbers(const std::vector<Numbers>& list, vtkTable* table);

}  // namespace anamorph_vtk
