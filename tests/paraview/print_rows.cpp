// SPDX-License-Identifier: Apache-2.0
// Prints the core's rows of numbers, one a line, for tests in other languages: name, default, ends, which of them
// are refused, and whether the number is an integer. Choices are lines that start with "menu": name, values.
#include <iostream>
#include <string>

#include "anamorph/deform/deform_rows.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/operation/figure_look.h"
#include "anamorph/operation/operation.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/projector/projector_rows.h"
#include "anamorph/surface/drape_rows.h"
#include "anamorph/surface/texture_rows.h"

namespace {

void print(const anamorph::NumberRow& row) {
    using anamorph::shortest;
    std::cout << row.name << ' ' << shortest(row.standard) << ' ' << shortest(row.least) << ' '
              << shortest(row.most) << ' ' << (row.ends != anamorph::NumberRow::closed) << ' '
              << (row.ends == anamorph::NumberRow::between) << ' ' << row.integer << '\n';
}

/// The numbers that have a default, and the choices, of an operation; `whole`: its whole numbers too.
void print(const std::string& operation, const anamorph::ParameterTable& table, bool whole) {
    for (const anamorph::Parameter& row : table) {
        const std::string name = operation + "_" + row.name;
        const bool is_whole = row.type == anamorph::ParameterType::whole;
        if ((row.type == anamorph::ParameterType::number || (whole && is_whole)) &&
            !row.default_value.empty())
            std::cout << name << ' ' << row.default_value << ' ' << anamorph::shortest(row.minimum) << ' '
                      << anamorph::shortest(row.maximum) << ' ' << row.above_minimum << " 0 " << is_whole
                      << '\n';
        if (row.type != anamorph::ParameterType::choice) continue;
        std::cout << "menu " << name;
        for (const std::string& word : row.choices) std::cout << ' ' << word;
        std::cout << '\n';
    }
}

}  // namespace

int main() {
    for (const anamorph::NumberRow& row : anamorph::kDeformRows) print(row);
    print("drape", *anamorph::find_operation("drape")->parameters, false);
    print("figure", anamorph::figure_look_table(), true);
    print(anamorph::surface::kDrapeParallelScaleRow);
    for (const anamorph::NumberRow& row : anamorph::figure::kFigureRows) print(row);
    for (const anamorph::NumberRow& row : anamorph::kProjectorRows) print(row);
    for (const anamorph::NumberRow& row : anamorph::surface::kTextureRows) print(row);
}
