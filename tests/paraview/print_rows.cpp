// SPDX-License-Identifier: Apache-2.0
// Prints the core's rows of numbers, one a line, for tests in other languages: name, default, ends, which of them
// are refused, and whether the number is an integer.
#include <iostream>

#include "anamorph/deform/deform_rows.h"
#include "anamorph/drape/drape_rows.h"
#include "anamorph/figure/figure_rows.h"
#include "anamorph/parameter.h"
#include "anamorph/projector/projector_rows.h"

namespace {

void print(const anamorph::NumberRow& row) {
    using anamorph::shortest;
    std::cout << row.name << ' ' << shortest(row.standard) << ' ' << shortest(row.least) << ' '
              << shortest(row.most) << ' ' << (row.ends != anamorph::NumberRow::closed) << ' '
              << (row.ends == anamorph::NumberRow::between) << ' ' << row.integer << '\n';
}

}  // namespace

int main() {
    for (const anamorph::NumberRow& row : anamorph::kDeformRows) print(row);
    for (const anamorph::NumberRow& row : anamorph::kDrapeRows) print(row);
    for (const anamorph::NumberRow& row : anamorph::kFigureRows) print(row);
    for (const anamorph::NumberRow& row : anamorph::kProjectorRows) print(row);
}
