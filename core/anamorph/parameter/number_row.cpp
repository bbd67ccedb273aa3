// SPDX-License-Identifier: Apache-2.0
#include "anamorph/parameter/number_row.h"

#include <cmath>

#include "anamorph/parameter/parameter.h"

namespace anamorph {

bool NumberRow::holds(double value) const {
    if (!std::isfinite(value) || (integer && value != std::floor(value))) return false;
    const bool low = ends == closed ? value >= least : value > least;
    return low && (ends == between ? value < most : value <= most);
}

std::string NumberRow::range() const {
    const std::string kind = integer ? "an integer" : "a number";
    if (most == kNoEnd && least == -kNoEnd) return "a finite number";
    if (most == kNoEnd) return kind + (ends == closed ? " of at least " : " above ") + shortest(least);
    if (ends == closed) return kind + " from " + shortest(least) + " to " + shortest(most);
    return kind + " above " + shortest(least) + (ends == between ? " and below " : " and at most ") +
           shortest(most);
}

void NumberRow::check(double value, const char* parameter) const {
    if (!holds(value)) throw Error(parameter ? parameter : name, shortest(value), "must be " + range());
}

}  // namespace anamorph
