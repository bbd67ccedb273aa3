// SPDX-License-Identifier: Apache-2.0
#include "values.h"

#include <pybind11/numpy.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "anamorph/parameter/parameter.h"

namespace py = pybind11;

namespace anamorph {
namespace {

/// Throws what Python has raised, unless it is a TypeError, of which something better can be said.
void clear_type_error() {
    if (!PyErr_ExceptionMatches(PyExc_TypeError)) throw py::error_already_set();
    PyErr_Clear();
}

/// The name of a value's type, without its module.
std::string type_name(const py::handle& value) {
    return py::type::of(value).attr("__name__").cast<std::string>();
}

/// A key as a recipe has it: from_ is `from`, which is a word of Python.
std::string key_of(const py::str& keyword) {
    std::string key = bytes_of(keyword, "a key");
    if (key.empty() || key.back() != '_') return key;
    std::string word = key.substr(0, key.size() - 1);
    return in_python("keyword", "iskeyword")(word).cast<bool>() ? word : key;
}

const Parameter* row_of(const Operation& operation, const std::string& key) {
    const ParameterTable& table = *operation.parameters;
    const auto found =
        std::find_if(table.begin(), table.end(), [&](const Parameter& row) { return row.name == key; });
    return found == table.end() ? nullptr : &*found;
}

bool is_path(const py::handle& value) {
    return py::isinstance<py::str>(value) || py::hasattr(value, "__fspath__");
}

/// Refuses a source that is given as a key, but for the name of a file that gathers its sources itself.
void check_is_no_source(const Operation& operation, const std::string& key, const py::handle& value) {
    const std::vector<std::string>& sources = operation.sources;
    if (std::find(sources.begin(), sources.end(), key) == sources.end()) return;
    if (key == operation.main_file && is_path(value)) return;
    std::string order;
    for (const std::string& source : sources) order += (order.empty() ? "" : ", ") + source;
    throw Error(key, "<" + type_name(value) + ">",
                "sources are no keys: must be given first, in the order " + order);
}

/// Is it a float or an int of Python, or a kind of them? Most values are.
bool is_number(const py::handle& value) {
    return PyFloat_Check(value.ptr()) || PyLong_Check(value.ptr());
}

/// A number in the fewest digits that Python reads back as the same.
std::string number_text(const std::string& key, const py::handle& value) {
    if (PyFloat_Check(value.ptr())) {
        const std::unique_ptr<char, decltype(&PyMem_Free)> text(
            PyOS_double_to_string(PyFloat_AS_DOUBLE(value.ptr()), 'r', 0, Py_DTSF_ADD_DOT_0, nullptr),
            &PyMem_Free);
        if (!text) throw py::error_already_set();
        return text.get();
    }
    if (PyLong_Check(value.ptr())) {
        int overflow = 0;
        const long long number = PyLong_AsLongLongAndOverflow(value.ptr(), &overflow);
        if (overflow == 0) return std::to_string(number);
    }
    return in_python("anamorph._checks", "number_text")(key, value).cast<std::string>();
}

/// The numbers of a list, a tuple or an array of any shape.
std::string numbers_text(const std::string& key, const py::handle& values, char separator) {
    py::object parts = py::reinterpret_borrow<py::object>(values);
    if (py::isinstance<py::array>(values) || !std::all_of(parts.begin(), parts.end(), is_number))
        parts = in_python("anamorph._checks", "flat_list")(values);
    std::string text;
    for (const py::handle& part : parts) {
        if (!text.empty()) text += separator;
        text += number_text(key, part);
    }
    return text;
}

/// May a value be what a JSON file holds? Of images that is said with the key.
bool takes_json(const Parameter& row) {
    return row.type == ParameterType::file ||
           (row.type == ParameterType::image && row.documentation.find(".json") != std::string::npos);
}

/// Adds a value as a recipe has it. What is no text, but stands for a file, gets a name.
std::string text_of(const Parameter* row, const std::string& key, const py::handle& value, CallValues& to) {
    const ParameterType type = row ? row->type : ParameterType::text;
    const bool is_image = type == ParameterType::image, is_file = type == ParameterType::file;
    const bool is_list = py::isinstance<py::list>(value);
    const bool has_numbers = is_list || py::isinstance<py::tuple>(value) || py::isinstance<py::array>(value);
    if (py::isinstance<py::str>(value)) return bytes_of(py::reinterpret_borrow<py::str>(value), key);
    if (!has_numbers && !is_number(value) && py::hasattr(value, "__fspath__")) {
        const py::object path = in_python("os", "fspath")(value);
        if (!py::isinstance<py::str>(path))
            throw py::type_error(key + " is a path of bytes: must be one of str");
        return bytes_of(path, key);
    }
    const bool is_json = is_list || py::isinstance<py::dict>(value);
    if (is_image && (is_number(value) || (is_json && !takes_json(*row))))
        throw py::type_error(key + " is a " + type_name(value) +
                             ": must be an image: the name of a file, an array, an Image or a Picture");
    if (is_json && (is_image || is_file)) {
        std::string name = "<" + key + ">.json";
        to.texts[name] = in_python("anamorph._checks", "json_of")(key, value).cast<std::string>();
        return name;
    }
    if (is_image && !py::isinstance(value, in_python("numbers", "Number"))) {
        std::string name = "<" + key + ">";
        to.images[name] = in_python("anamorph", "_source_of")(value, key);
        return name;
    }
    if (is_file)
        throw py::type_error(key + " is a " + type_name(value) +
                             ": must be the name of a file, or the dict or list that a JSON file holds");
    if (has_numbers) return numbers_text(key, value, type == ParameterType::extent ? 'x' : ',');
    return number_text(key, value);
}

}  // namespace

py::object in_python(const char* module, const char* function) {
    return py::module_::import(module).attr(function);
}

CallValues values_of(const Operation& operation, const py::dict& keywords) {
    CallValues values;
    values.assignments.reserve(keywords.size());
    for (const auto& [keyword, value] : keywords) {
        if (value.is_none()) continue;
        std::string key = key_of(py::reinterpret_borrow<py::str>(keyword));
        check_is_no_source(operation, key, value);
        std::string text = text_of(row_of(operation, key), key, value, values);
        values.assignments.push_back({std::move(key), std::move(text)});
    }
    return values;
}

std::string bytes_of(const py::str& text, const std::string& parameter) {
    Py_ssize_t size = 0;
    std::string bytes;
    if (const char* const utf8 = PyUnicode_AsUTF8AndSize(text.ptr(), &size)) {
        bytes.assign(utf8, static_cast<std::size_t>(size));
    } else {
        // A name of a file that is no UTF-8.
        PyErr_Clear();
        bytes = text.attr("encode")("utf-8", "surrogateescape").cast<std::string>();
    }
    if (bytes.find('\0') != std::string::npos)
        throw Error(parameter, printable(bytes), "must have no NUL character");
    return bytes;
}

int integer(const std::string& name, const py::handle& value) {
    const py::object number = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
    if (!number) {
        clear_type_error();
        throw py::type_error(name + "=" + py::repr(value).cast<std::string>() + ": must be an integer");
    }
    int overflow = 0;
    const long long found = PyLong_AsLongLongAndOverflow(number.ptr(), &overflow);
    if (overflow != 0 || found < std::numeric_limits<int>::min() || found > std::numeric_limits<int>::max())
        throw py::value_error(name + "=" + py::str(number).cast<std::string>() +
                              ": must be an integer of 32 bits");
    return static_cast<int>(found);
}

py::tuple integers(const std::string& name, const py::handle& values, std::size_t count) {
    const py::object all = py::reinterpret_steal<py::object>(PySequence_Tuple(values.ptr()));
    if (!all) clear_type_error();
    if (!all || py::len(all) != count)
        throw py::value_error(name + ": must be " + std::to_string(count) + " integers");
    py::tuple found(count);
    for (std::size_t i = 0; i < count; ++i)
        found[i] = integer(name, py::reinterpret_borrow<py::tuple>(all)[i]);
    return found;
}

}  // namespace anamorph
