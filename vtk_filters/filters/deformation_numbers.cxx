// SPDX-License-Identifier: Apache-2.0
#include "deformation_numbers.h"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "text_of_file.h"
#include "vtkDoubleArray.h"
#include "vtkNew.h"
#include "vtkStringArray.h"
#include "vtkTable.h"
#include "vtkVariant.h"

namespace anamorph_vtk {
namespace {

using anamorph::Deformation;
using anamorph::DeformationEntry;
using anamorph::DeformationKernel;
using anamorph::DeformationMirror;
using anamorph::DeformationSide;
using anamorph::Error;

constexpr const char* kColumns[kNumbers] = {"center_u",
                                            "center_v",
                                            "extent_u",
                                            "extent_v",
                                            "x",
                                            "y",
                                            "z",
                                            "kernel",
                                            "enabled",
                                            "center_w",
                                            "extent_w",
                                            "side",
                                            "orientation_w",
                                            "orientation_x",
                                            "orientation_y",
                                            "orientation_z",
                                            "mirror",
                                            "mirror_at"};
constexpr const char* kName = "name";
constexpr int kNeededColumns = 7, kKernel = 7;

DeformationEntry entry_of(const Numbers& n) {
    if (n[7] != 0 && n[7] != 1)
        throw Error("kernel", anamorph::shortest(n[7]), "must be 0 (gaussian) or 1 (wendland_c2)");
    if (n[8] != 0 && n[8] != 1) throw Error("enabled", anamorph::shortest(n[8]), "must be 0 or 1");
    if (n[11] != 0 && n[11] != 1 && n[11] != 2)
        throw Error("side", anamorph::shortest(n[11]), "must be 0 (both), 1 (front) or 2 (back)");
    if (n[kMirror] != 0 && n[kMirror] != 1 && n[kMirror] != 2)
        throw Error("mirror", anamorph::shortest(n[kMirror]), "must be 0 (none), 1 (u) or 2 (v)");
    const Deformation d{{n[4], n[5], n[6]},
                        {n[0], n[1]},
                        {n[2], n[3]},
                        n[7] == 0 ? DeformationKernel::gaussian : DeformationKernel::wendland_c2,
                        n[8] == 1,
                        n[9],
                        n[10],
                        static_cast<DeformationSide>(static_cast<int>(n[11])),
                        {n[12], n[13], n[14], n[15]}};
    DeformationEntry entry(d);
    entry.mirror = static_cast<DeformationMirror>(static_cast<int>(n[kMirror]));
    entry.mirror_at = n[kMirror + 1];
    entry.name = n.Name;
    check_entry(entry);
    return entry;
}

/// A cell of a table as a number.
double number_in(const vtkVariant& cell, int column) {
    const bool named = (column == kKernel || column == kSide || column == kMirror) && cell.IsString() &&
                       !cell.ToString().empty() &&
                       std::isalpha(static_cast<unsigned char>(cell.ToString()[0]));
    if (named && column == kKernel)
        return anamorph::kernel_named(cell.ToString()) == DeformationKernel::gaussian ? 0 : 1;
    if (named && column == kMirror) return static_cast<int>(anamorph::mirror_named(cell.ToString()));
    if (named) return static_cast<int>(anamorph::side_named(cell.ToString()));
    bool valid = false;
    const double number = cell.ToDouble(&valid);
    if (!valid) throw Error("\"" + anamorph::printable(cell.ToString()) + "\" is not a number");
    return number;
}

}  // namespace

std::vector<DeformationEntry> checked_entries(const std::vector<Numbers>& list) {
    std::vector<DeformationEntry> entries;
    entries.reserve(list.size());
    for (std::size_t i = 0; i < list.size(); ++i) try {
            entries.push_back(entry_of(list[i]));
        } catch (const Error& error) {
            throw Error("deformation " + std::to_string(i) + ": " + error.what());
        }
    return entries;
}

anamorph::DeformationsWithImages checked_deformations(const std::vector<Numbers>& list,
                                                      const anamorph::MirrorSteps& steps) {
    return with_images(checked_entries(list), steps);
}

Numbers numbers_of(const DeformationEntry& entry) {
    const Deformation& d = entry.deformation;
    return {{d.center.x, d.center.y, d.extent.x, d.extent.y, d.vector.x, d.vector.y, d.vector.z,
             d.kernel == DeformationKernel::gaussian ? 0. : 1., d.enabled ? 1. : 0., d.center_w, d.extent_w,
             static_cast<double>(d.side), d.orientation.x, d.orientation.y, d.orientation.z, d.orientation.w,
             static_cast<double>(entry.mirror), entry.mirror_at},
            entry.name};
}

std::vector<Numbers> read_deformations(const std::string& file_name) {
    std::vector<Numbers> list;
    for (const DeformationEntry& entry : anamorph::parse_entries_file(text_of_file(file_name), file_name))
        list.push_back(numbers_of(entry));
    return list;
}

void write_deformations(const std::string& file_name, const std::vector<Numbers>& list) {
    const std::vector<DeformationEntry> entries = checked_entries(list);
    const bool csv = file_name.size() >= 4 && file_name.substr(file_name.size() - 4) == ".csv";
    std::ofstream file(file_name, std::ios::binary);
    file << (csv ? entries_csv(entries) : entries_json(entries));
    file.close();
    if (!file) throw Error(file_name + ": cannot be written");
}

std::vector<Numbers> numbers_in(vtkTable* table) {
    std::vector<Numbers> list;
    if (!table || table->GetNumberOfColumns() == 0) return list;
    vtkAbstractArray* columns[kNumbers];
    for (int c = 0; c < kNumbers; ++c) {
        columns[c] = table->GetColumnByName(kColumns[c]);
        if (!columns[c] && c < kNeededColumns)
            throw Error(std::string("the table of deformations has no column ") + kColumns[c]);
        if (columns[c] && columns[c]->GetNumberOfComponents() != 1)
            throw Error(std::string("the table of deformations: column ") + kColumns[c] + " has " +
                        std::to_string(columns[c]->GetNumberOfComponents()) + " components, but must have 1");
    }
    vtkAbstractArray* const names = table->GetColumnByName(kName);
    const vtkIdType rows = columns[0]->GetNumberOfTuples();
    for (int c = 1; c <= kNumbers; ++c)
        if (vtkAbstractArray* column = c < kNumbers ? columns[c] : names;
            column && column->GetNumberOfTuples() != rows)
            throw Error(std::string("the table of deformations: column ") +
                        (c < kNumbers ? kColumns[c] : kName) + " has " +
                        std::to_string(column->GetNumberOfTuples()) + " rows, column " + kColumns[0] +
                        " has " + std::to_string(rows) + ": the columns must have equally many");
    if (rows > static_cast<vtkIdType>(anamorph::kMaxDeformations))
        throw Error("the table of deformations has " + std::to_string(rows) +
                    " rows, but must have at most " + std::to_string(anamorph::kMaxDeformations));
    for (vtkIdType row = 0; row < rows; ++row) {
        Numbers numbers = kNothing;
        for (int c = 0; c < kNumbers; ++c) try {
                if (columns[c])
                    numbers[static_cast<std::size_t>(c)] = number_in(columns[c]->GetVariantValue(row), c);
            } catch (const Error& error) {
                throw Error("the table of deformations: row " + std::to_string(row) + ", column " +
                            kColumns[c] + ": " + error.what());
            }
        if (names) numbers.Name = names->GetVariantValue(row).ToString();
        list.push_back(numbers);
    }
    return list;
}

void put_numbers(const std::vector<Numbers>& list, vtkTable* table) {
    table->Initialize();
    const auto has = [&](int begin, int end) {
        return std::any_of(list.begin(), list.end(), [&](const Numbers& numbers) {
            return !std::equal(numbers.begin() + begin, numbers.begin() + end, kNothing.begin() + begin);
        });
    };
    const bool named =
        std::any_of(list.begin(), list.end(), [](const Numbers& n) { return !n.Name.empty(); });
    const int columns = has(kOrientation, kNumbers) ? kNumbers
                        : has(kDepth, kOrientation) ? kOrientation
                                                    : kDepth;
    for (int c = 0; c < columns; ++c) {
        vtkNew<vtkDoubleArray> column;
        column->SetName(kColumns[c]);
        for (const Numbers& numbers : list) column->InsertNextValue(numbers[static_cast<std::size_t>(c)]);
        table->AddColumn(column);
    }
    if (!named) return;
    vtkNew<vtkStringArray> names;
    names->SetName(kName);
    for (const Numbers& numbers : list) names->InsertNextValue(numbers.Name);
    table->AddColumn(names);
}

}  // namespace anamorph_vtk
