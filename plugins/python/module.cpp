// SPDX-License-Identifier: Apache-2.0
// The part of the Python module that is C++: what arrays.h has, for numpy's arrays. Names, defaults and checks of types are those of
// anamorph/__init__.py.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <iterator>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <variant>
#include <vector>

#include "anamorph/operation/rows.h"
#include "anamorph/parallel.h"
#include "anamorph/version.h"
#include "arrays.h"
#include "figures.h"

namespace py = pybind11;

namespace anamorph {
namespace {

/// Pairs of keys and texts.
using Texts = std::vector<std::pair<std::string, std::string>>;
/// An array whose pixels have rows, columns and channels.
using Pixels = py::array;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// The types that arrays and OpenImageIO's images have in common, by numpy's kind and size.
struct PixelFormat {
    char kind;
    py::ssize_t size;
    OIIO::TypeDesc type;
    const char* name;
};
const PixelFormat kFormats[] = {
    {'u', 1, OIIO::TypeDesc::UINT8, "uint8"},    {'u', 2, OIIO::TypeDesc::UINT16, "uint16"},
    {'u', 4, OIIO::TypeDesc::UINT32, "uint32"},  {'i', 1, OIIO::TypeDesc::INT8, "int8"},
    {'i', 2, OIIO::TypeDesc::INT16, "int16"},    {'i', 4, OIIO::TypeDesc::INT32, "int32"},
    {'f', 2, OIIO::TypeDesc::HALF, "float16"},   {'f', 4, OIIO::TypeDesc::FLOAT, "float32"},
    {'f', 8, OIIO::TypeDesc::DOUBLE, "float64"},
};

std::vector<std::string> dtypes() {
    std::vector<std::string> names;
    for (const PixelFormat& format : kFormats) names.emplace_back(format.name);
    return names;
}

const char* dtype_of(OIIO::TypeDesc type) {
    for (const PixelFormat& format : kFormats)
        if (format.type == type) return format.name;
    return "float32";
}

/// The pixels of an array of three axes, whose channels stand next to each other.
ArrayPixels pixels_of(const Pixels& array, void* data) {
    for (const PixelFormat& format : kFormats)
        if (array.dtype().kind() == format.kind && array.itemsize() == format.size)
            return {data,           format.type,      array.shape(1),  array.shape(0),
                    array.shape(2), array.strides(1), array.strides(0)};
    throw py::type_error("the dtype of an array is none of those that pictures have");
}

/// An array as a source. It keeps the array.
struct ModuleSource {
    py::object array;
    std::shared_ptr<const ArraySource> source;
};

using Window = std::array<int, 4>;  ///< x0, y0, x1, y1
using Metadata = std::vector<std::pair<std::string, std::variant<int, double, std::string>>>;

ModuleSource array_source(const Pixels& array, const std::vector<std::string>& channels, bool unassociated,
                          std::pair<int, int> corner, const Window& display, const Metadata& metadata) {
    ArrayFacts facts{channels,
                     unassociated,
                     corner.first,
                     corner.second,
                     Box{display[0], display[1], display[2], display[3]},
                     {}};
    for (const auto& [name, value] : metadata) facts.metadata.push_back({name, value});
    // Sources are only read.
    void* data = const_cast<void*>(array.data());
    return {array, std::make_shared<const ArraySource>(pixels_of(array, data), facts)};
}

/// A loop that now and then, on the thread that called it, asks Python whether it is to be interrupted.
ParallelFor interruptible(const ParallelFor& parallel_for) {
    using Clock = std::chrono::steady_clock;
    const auto asked = std::make_shared<Clock::time_point>(Clock::now());
    return [parallel_for, asked, caller = std::this_thread::get_id()](
               std::int64_t count, const std::function<void(std::int64_t)>& body) {
        parallel_for(count, [&](std::int64_t i) {
            body(i);
            if (std::this_thread::get_id() != caller || Clock::now() - *asked < std::chrono::milliseconds(50))
                return;
            const py::gil_scoped_acquire lock;
            if (PyErr_CheckSignals() != 0) throw py::error_already_set();
            *asked = Clock::now();
        });
    };
}

py::dict dict_of(const Attributes& attributes) {
    py::dict dict;
    for (const Attribute& attribute : attributes) dict[attribute.name.c_str()] = py::cast(attribute.value);
    return dict;
}

/// A picture, and the arrays that it reads.
class ModulePicture {
  public:
    using Input = std::variant<const ModuleSource*, const ModulePicture*>;
    ModulePicture(const std::string& operation, const Texts& values, const std::vector<Input>& sources,
                  const std::map<std::string, std::string>& texts,
                  const std::map<std::string, const ModuleSource*>& images, int subimage, int threads) {
        std::vector<Assignment> assignments;
        for (const auto& [key, value] : values) assignments.push_back({key, value});
        std::vector<ArrayPicture::Input> inputs;
        for (const Input& source : sources) {
            if (const auto* const* picture = std::get_if<const ModulePicture*>(&source)) {
                inputs.push_back({nullptr, (*picture)->m_picture});
                m_arrays.insert(m_arrays.end(), (*picture)->m_arrays.begin(), (*picture)->m_arrays.end());
            } else {
                inputs.push_back({keep(*std::get<const ModuleSource*>(source)), nullptr});
            }
        }
        ArrayFiles files{texts, {}};
        for (const auto& [name, image] : images) files.images[name] = keep(*image);
        const py::gil_scoped_release unlock;
        m_picture = std::make_shared<const ArrayPicture>(operation, assignments, inputs, files, subimage,
                                                         interruptible(default_parallel_for(threads)));
    }

    const OIIO::ImageSpec& spec() const { return m_picture->spec(); }
    std::string kind() const {
        switch (m_picture->pixels()) {
            case PixelKind::color:
                return "color";
            case PixelKind::point:
                return "point";
            case PixelKind::vector:
                return "vector";
            case PixelKind::value:
                break;
        }
        return "value";
    }
    /// The arrays that are read.
    py::list arrays() const {
        py::list list;
        for (const py::object& array : m_arrays)
            if (!array.is_none()) list.append(array);
        return list;
    }
    int subimages() const { return m_picture->subimages(); }
    py::dict said() const { return dict_of(m_picture->said()); }
    py::dict reached(int threads) const {
        const Attributes attributes = [&] {
            const py::gil_scoped_release unlock;
            return m_picture->reached(interruptible(default_parallel_for(threads)));
        }();
        return dict_of(attributes);
    }

    void draw(Pixels to, int x, int y, int threads, const std::optional<py::function>& progress) const {
        const ArrayPixels pixels = pixels_of(to, to.mutable_data());
        std::function<void(int)> call;
        if (progress)
            call = [&](int rows) {
                const py::gil_scoped_acquire lock;
                (*progress)(rows);
            };
        const py::gil_scoped_release unlock;
        m_picture->draw(pixels, x, y, interruptible(default_parallel_for(threads)), call);
    }

    py::array_t<double> source_points(const Doubles& x, const Doubles& y, int threads) const {
        py::array_t<double> found({py::ssize_t{2}, x.size()});
        double* to = found.mutable_data();
        const PointArrays points{x.data(), y.data(), x.size()};
        const py::gil_scoped_release unlock;
        m_picture->source_points(points, to, to + points.count, interruptible(default_parallel_for(threads)));
        return found;
    }
    py::array_t<double> jacobians(const Doubles& x, const Doubles& y, int threads) const {
        py::array_t<double> found({x.size(), py::ssize_t{4}});
        double* to = found.mutable_data();
        const PointArrays points{x.data(), y.data(), x.size()};
        const py::gil_scoped_release unlock;
        m_picture->jacobians(points, to, interruptible(default_parallel_for(threads)));
        return found;
    }

  private:
    std::shared_ptr<const ArraySource> keep(const ModuleSource& source) {
        m_arrays.push_back(source.array);
        return source.source;
    }

    std::vector<py::object> m_arrays;  ///< what the picture reads, directly and by others
    std::shared_ptr<const ArrayPicture> m_picture;
};

const char* word_of(ParameterType type) {
    switch (type) {
        case ParameterType::number:
            return "number";
        case ParameterType::whole:
            return "whole";
        case ParameterType::toggle:
            return "toggle";
        case ParameterType::choice:
            return "choice";
        case ParameterType::extent:
            return "extent";
        case ParameterType::numbers:
            return "numbers";
        case ParameterType::image:
            return "image";
        case ParameterType::file:
            return "file";
        case ParameterType::text:
            break;
    }
    return "text";
}

py::dict dict_of(const Operation& operation) {
    py::list keys;
    for (const Parameter& p : *operation.parameters) {
        py::dict key;
        key["name"] = p.name;
        key["type"] = word_of(p.type);
        key["unit"] = p.unit;
        key["default"] = p.default_value;
        key["choices"] = p.choices;
        key["accepted"] = p.accepted();
        key["documentation"] = p.documentation;
        key["definitions"] = p.definitions;
        key["of_recipes"] = std::find(std::begin(rows::kKeysOfRecipes), std::end(rows::kKeysOfRecipes),
                                      p.name) != std::end(rows::kKeysOfRecipes);
        keys.append(key);
    }
    py::dict dict;
    dict["name"] = operation.name;
    dict["title"] = operation.title;
    dict["sources"] = operation.sources;
    dict["least_sources"] = operation.least_sources;
    dict["main_file"] = operation.main_file;
    dict["keys"] = keys;
    return dict;
}

Window window(int x, int y, int width, int height) {
    return {x, y, x + width, y + height};
}

/// Hands errors on as anamorph.Error, which names the parameter.
void throw_as(const py::handle& type, const Error& error) {
    // Names of files may be no text.
    const py::object words = py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(error.what(), static_cast<py::ssize_t>(std::strlen(error.what())), "replace"));
    const py::object raised = type(words);
    raised.attr("parameter") = error.parameter();
    PyErr_SetObject(type.ptr(), raised.ptr());
}

}  // namespace
}  // namespace anamorph

PYBIND11_MODULE(_core, m) {
    using namespace anamorph;
    static PyObject* const error_type = PyErr_NewExceptionWithDoc(
        "anamorph.Error",
        "A parameter or an image that cannot be taken: `parameter` is the key that is to blame, or empty.",
        PyExc_ValueError, py::dict(py::arg("parameter") = "").ptr());
    m.attr("Error") = py::reinterpret_borrow<py::object>(error_type);
    py::register_exception_translator([](std::exception_ptr failure) {
        try {
            if (failure) std::rethrow_exception(failure);
        } catch (const Error& error) {
            throw_as(error_type, error);
        }
    });

    m.attr("version") = version();
    m.attr("dtypes") = dtypes();
    m.def("operations", [] {
        py::list list;
        for (const Operation* operation : operations()) list.append(dict_of(*operation));
        return list;
    });

    py::class_<ModuleSource>(m, "Source");
    m.def("array_source", &array_source);
    m.def("file_source", [](const std::string& file) {
        return ModuleSource{py::none(), std::make_shared<const ArraySource>(file)};
    });

    py::class_<ModulePicture>(m, "Picture")
        .def(py::init<const std::string&, const Texts&, const std::vector<ModulePicture::Input>&,
                      const std::map<std::string, std::string>&,
                      const std::map<std::string, const ModuleSource*>&, int, int>())
        .def_property_readonly("kind", &ModulePicture::kind)
        .def_property_readonly("arrays", &ModulePicture::arrays)
        .def_property_readonly("subimages", &ModulePicture::subimages)
        .def_property_readonly("dtype", [](const ModulePicture& p) { return dtype_of(p.spec().format); })
        .def_property_readonly("channels", [](const ModulePicture& p) { return p.spec().channelnames; })
        .def_property_readonly("window",
                               [](const ModulePicture& p) {
                                   const OIIO::ImageSpec& s = p.spec();
                                   return window(s.x, s.y, s.width, s.height);
                               })
        .def_property_readonly("display",
                               [](const ModulePicture& p) {
                                   const OIIO::ImageSpec& s = p.spec();
                                   return window(s.full_x, s.full_y, s.full_width, s.full_height);
                               })
        .def_property_readonly("said", &ModulePicture::said)
        .def("reached", &ModulePicture::reached)
        .def("draw", &ModulePicture::draw)
        .def("source_points", &ModulePicture::source_points)
        .def("jacobians", &ModulePicture::jacobians);
    bind_figures(m);
}
