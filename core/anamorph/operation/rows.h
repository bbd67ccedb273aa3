// SPDX-License-Identifier: Apache-2.0
// The rows that the parameter tables of pictures share, and how rows are written.
#pragma once

#include <algorithm>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/parameter.h"

namespace anamorph::rows {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Parameter choice(const char* name, std::string value, std::vector<std::string> choices,
                 const std::string& doc);
Parameter number(const char* name, const char* unit, std::string value, double least, double most,
                 const std::string& doc);
/// The same without the minimum itself.
Parameter above(Parameter number);
Parameter whole(const char* name, const char* unit, std::string value, int least, int most,
                const std::string& doc);
Parameter numbers(const char* name, double least, const std::string& doc);
Parameter text(const char* name, const std::string& doc);
Parameter image(const char* name, const std::string& doc);
Parameter file(const char* name, const std::string& doc);

Parameter size(const std::string& doc);
Parameter tile();
Parameter mip();
Parameter filter();
Parameter tol();
Parameter colorspace(const std::string& doc);

/// Width and height asked for by `size`: those of `natural` where none is, its shape where only a width is
/// given.
Size size_of(const ParameterValues& values, const Size& natural);

/// What was chosen of a list in the order of its enumeration.
template <class Enumeration>
Enumeration chosen(const ParameterValues& values, std::string_view name,
                   const std::vector<std::string>& names) {
    const auto found = std::find(names.begin(), names.end(), values.text(name));
    return static_cast<Enumeration>(found - names.begin());
}

/// In the order of anamorph::Filter.
const std::vector<std::string>& filters();

}  // namespace anamorph::rows
