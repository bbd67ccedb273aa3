// SPDX-License-Identifier: Apache-2.0
// What callers of the Python module give, as the core takes it: keywords as the keys of recipes, whole numbers, texts.
#pragma once

#include <pybind11/pybind11.h>

#include <map>
#include <string>
#include <vector>

#include "anamorph/operation/operation.h"

namespace anamorph {

/// The keywords of a call.
struct CallValues {
    std::vector<Assignment> assignments;  ///< as a recipe has them
    std::map<std::string, std::string>
        texts;  ///< files that are not on disk, by the names that values give them
    std::map<std::string, pybind11::object> images = {};  ///< and images, each a Source of the module
};

/// The keywords of a call of an operation; those that are None are left out. Throws Error or a TypeError of Python.
CallValues values_of(const Operation& operation, const pybind11::dict& keywords);

/// A function that is written in Python: for what is rare.
pybind11::object in_python(const char* module, const char* function);

/// A text as bytes, since names of files may be any. Throws Error of `parameter` where it has a NUL character.
std::string bytes_of(const pybind11::str& text, const std::string& parameter);

/// A whole number of 32 bits. Throws a TypeError or ValueError of Python that names it.
int integer(const std::string& name, const pybind11::handle& value);
/// So many of them in a tuple, from anything that can be iterated.
pybind11::tuple integers(const std::string& name, const pybind11::handle& values, std::size_t count);

}  // namespace anamorph
