// SPDX-License-Identifier: Apache-2.0
#include "property_names.h"

#include <cctype>

namespace anamorph_vtk {
namespace {

/// "height_smooth" as "HeightSmooth".
std::string camel_case(const std::string& row) {
    std::string name;
    bool first = true;
    for (const char c : row) {
        if (c != '_') name += first ? static_cast<char>(std::toupper(static_cast<unsigned char>(c))) : c;
        first = c == '_';
    }
    return name;
}

}  // namespace

anamorph::Error of_property(const anamorph::Error& error, const std::map<std::string, std::string>& others) {
    std::string row = error.parameter();
    // Of a machine's text as a whole: "machine: is no JSON".
    if (row.empty() && std::string(error.what()).rfind("machine:", 0) == 0) row = "machine";
    if (row.empty() || std::isupper(static_cast<unsigned char>(row[0]))) return error;
    const auto other = others.find(row);
    return anamorph::Error((other == others.end() ? camel_case(row) : other->second) +
                           std::string(error.what()).substr(row.size()));
}

anamorph::Error of_known_property(const anamorph::Error& error,
                                  const std::map<std::string, std::string>& names) {
    return names.count(error.parameter()) ? of_property(error, names) : error;
}

}  // namespace anamorph_vtk
