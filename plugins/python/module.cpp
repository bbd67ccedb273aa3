// SPDX-License-Identifier: Apache-2.0
// The part of the Python module that is C++: what arrays.h has, for numpy's arrays. Names, defaults and checks of types are those of
// anamorph/__init__.py.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <iterator>
#include <memory>
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
#include "lock.h"
#include "values.h"

namespace py = pybind11;

namespace anamorph {
namespace {

/// An array whose pixels have rows, columns and, of three axes, channels.
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

/// numpy's dtypes of kFormats; made once, and never let go of, as Python may be gone before.
const std::vector<py::dtype>& numpy_dtypes() {
    static const auto* const all = [] {
        auto* const made = new std::vector<py::dtype>;
        for (const PixelFormat& format : kFormats) made->emplace_back(format.name);
        return made;
    }();
    return *all;
}

py::dtype dtype_of(OIIO::TypeDesc type) {
    for (std::size_t i = 0; i < std::size(kFormats); ++i)
        if (kFormats[i].type == type) return numpy_dtypes()[i];
    return numpy_dtypes()[std::size(kFormats) - 2];  // float32
}

/// The format of an array; null where it is none that pictures have, or of another byte order than this machine's.
const PixelFormat* format_of(const Pixels& array) {
    const py::dtype dtype = array.dtype();
    const char order = dtype.byteorder();
    if (order != '=' && order != '|') return nullptr;
    for (const PixelFormat& format : kFormats)
        if (dtype.kind() == format.kind && array.itemsize() == format.size) return &format;
    return nullptr;
}

/// Throws a TypeError or ValueError of Python, which names the array, unless it has pixels.
void check_pixels(const Pixels& array, const std::string& name) {
    const auto say = [](const py::handle& value) { return py::str(value).cast<std::string>(); };
    if (!format_of(array)) {
        std::string names;
        for (const PixelFormat& format : kFormats)
            names += (names.empty() ? "" : ", ") + std::string(format.name);
        throw py::type_error(name + " has the dtype " + say(array.dtype()) + ": must be one of " + names);
    }
    if (array.ndim() != 2 && array.ndim() != 3)
        throw py::value_error(name + " has the shape " + say(array.attr("shape")) +
                              ": must be (height, width) or (height, width, channels)");
    if (array.size() == 0)
        throw py::value_error(name + " has the shape " + say(array.attr("shape")) + ": must have pixels");
}

py::ssize_t channels_of(const Pixels& array) {
    return array.ndim() == 3 ? array.shape(2) : 1;
}

/// Do the channels of a pixel stand next to each other, and pixels and rows behind each other, aligned?
bool is_plain(const Pixels& array) {
    const PixelFormat* const format = format_of(array);
    const py::ssize_t size = array.itemsize(), channels = channels_of(array), rows = array.strides(0),
                      columns = array.strides(1);
    if (!format || !(array.flags() & py::detail::npy_api::NPY_ARRAY_ALIGNED_)) return false;
    // Pixels that are only moved are moved four bytes at a time where that fits.
    const bool converted = format->type == OIIO::TypeDesc::UINT8 || format->type == OIIO::TypeDesc::UINT16 ||
                           format->type == OIIO::TypeDesc::HALF || format->type == OIIO::TypeDesc::FLOAT;
    if (!converted && (rows | columns | reinterpret_cast<std::intptr_t>(array.data())) % 4 != 0) return false;
    return (channels == 1 || array.strides(2) == size) && columns >= channels * size && rows >= 0 &&
           (rows >= columns * array.shape(1) || array.shape(0) == 1);
}

/// The pixels of a plain array.
ArrayPixels pixels_of(const Pixels& array, void* data) {
    if (const PixelFormat* const format = format_of(array))
        return {data,
                format->type,
                array.shape(1),
                array.shape(0),
                channels_of(array),
                array.strides(1),
                array.strides(0)};
    throw py::type_error("the dtype of an array is none of those that pictures have");
}

/// An array as a source, which keeps it, or a file. `flat`: do pictures of it that have one channel have two axes?
struct ModuleSource {
    py::object array;
    std::shared_ptr<const ArraySource> source;
    bool flat = true;
};

using Window = std::array<int, 4>;  ///< x0, y0, x1, y1
using Metadata = std::vector<std::pair<std::string, std::variant<int, double, std::string>>>;

ModuleSource source_with(const Pixels& given, const ArrayFacts& facts, bool flat) {
    const Pixels array = is_plain(given) ? given : Pixels(given.attr("copy")());
    // Sources are only read.
    void* data = const_cast<void*>(array.data());
    return {array, std::make_shared<const ArraySource>(pixels_of(array, data), facts), flat};
}

ModuleSource array_source(const Pixels& array, const std::string& name) {
    check_pixels(array, name);
    return source_with(array, {}, array.ndim() == 2);
}

/// An Image, whose pixels are checked.
ModuleSource image_source(const Pixels& array, const std::vector<std::string>& channels, bool unassociated,
                          std::pair<int, int> corner, const Window& display, const Metadata& metadata,
                          bool flat) {
    ArrayFacts facts{channels,
                     unassociated,
                     corner.first,
                     corner.second,
                     Box{display[0], display[1], display[2], display[3]},
                     {}};
    for (const auto& [name, value] : metadata) facts.metadata.push_back({name, value});
    return source_with(array, facts, flat);
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
            const Locked locked;
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

const Operation& operation_of(const py::object& given) {
    if (!py::isinstance<py::str>(given))
        throw py::type_error("operation=" + py::repr(given).cast<std::string>() + ": must be a str, one of " +
                             operation_names());
    const std::string name = bytes_of(given, "operation");
    if (const Operation* const operation = find_operation(name)) return *operation;
    throw Error("operation", printable(name), "must be one of " + operation_names());
}

/// How many threads a caller asks for: None and 0 are all.
int threads_of(const py::object& given) {
    const int threads = given.is_none() ? 0 : integer("threads", given);
    if (threads < 0) throw py::value_error("threads=" + std::to_string(threads) + ": must be at least 0");
    return threads;
}

/// An error of a picture that could not be opened, and the key that is to blame.
struct OpenError {
    Error error;
    std::string key;
};

/// The key whose name or whose file's name an error begins with, as those of what a file holds do; else what the error says.
std::string key_to_blame(const Error& error, const std::vector<Assignment>& given) {
    const std::string words = error.what();
    for (const auto& [key, value] : given)
        if (words.rfind(key + ":", 0) == 0 || words.rfind(printable(value) + ":", 0) == 0) return key;
    return error.parameter();
}

/// A picture, and the arrays that it reads.
class ModulePicture {
  public:
    /// As the module's class Picture is made: by the arguments of a caller.
    ModulePicture(const py::object& given, const py::tuple& sources, const py::dict& keywords,
                  const py::object& subimage, const py::object& threads)
        : m_threads(threads_of(threads)) {
        const Operation& operation = operation_of(given);
        const CallValues values = values_of(operation, keywords);
        std::vector<ArrayPicture::Input> inputs;
        for (const py::handle& source : sources) {
            const bool first = inputs.empty();
            inputs.push_back(input_of(source, first));
        }
        ArrayFiles files{values.texts, {}};
        for (const auto& [key, image] : values.images)
            files.images[key] = keep(image.cast<const ModuleSource&>());
        const int number = subimage.is_none() ? 0 : integer("subimage", subimage);
        const Unlocked unlocked;
        try {
            m_picture = std::make_shared<const ArrayPicture>(operation, values.assignments, inputs, files,
                                                             number, parallel_for());
        } catch (const Error& error) {
            throw OpenError{error, key_to_blame(error, values.assignments)};
        }
    }

    const OIIO::ImageSpec& spec() const { return m_picture->spec(); }
    /// The arrays that are read.
    py::list arrays() const {
        py::list list;
        for (const py::object& array : m_arrays)
            if (!array.is_none()) list.append(array);
        return list;
    }
    int subimages() const { return m_picture->subimages(); }
    py::dict said() const { return dict_of(m_picture->said()); }
    py::dict reached() const {
        const Attributes attributes = [&] {
            const Unlocked unlocked;
            return m_picture->reached(parallel_for());
        }();
        return dict_of(attributes);
    }

    Window window() const {
        const OIIO::ImageSpec& s = spec();
        return {s.x, s.y, s.x + s.width, s.y + s.height};
    }
    /// What is to be drawn, (x0, y0, x1, y1): all, or what a caller gives.
    Window region(const py::object& roi) const {
        if (roi.is_none()) return window();
        const auto box = integers("roi", roi, 4).cast<Window>();
        if (box[2] <= box[0] || box[3] <= box[1])
            throw py::value_error("roi=" + py::str(roi).cast<std::string>() +
                                  ": must be (x0, y0, x1, y1) with x0 < x1 and y0 < y1");
        return box;
    }
    /// The shape of an array of it.
    std::vector<py::ssize_t> shape(const Window& box) const {
        const py::ssize_t channels = spec().nchannels;
        std::vector<py::ssize_t> shape{py::ssize_t{box[3]} - box[1], py::ssize_t{box[2]} - box[0], channels};
        if (channels == 1 && (m_flat || m_picture->pixels() != PixelKind::color)) shape.pop_back();
        return shape;
    }
    Pixels draw(const py::object& roi, const py::object& progress) const {
        const Window box = region(roi);
        Pixels pixels(dtype_of(spec().format), shape(box));
        draw_to(pixels, box[0], box[1], progress);
        return pixels;
    }
    void draw_to(Pixels to, int x, int y, const py::object& progress) const {
        const ArrayPixels pixels = pixels_of(to, to.mutable_data());
        std::function<void(int)> call;
        if (!progress.is_none() && !PyCallable_Check(progress.ptr()))
            throw py::type_error("progress must be callable");
        if (!progress.is_none())
            call = [&](int rows) {
                const Locked locked;
                progress(rows);
            };
        const Unlocked unlocked;
        m_picture->draw(pixels, x, y, parallel_for(), call);
    }

    py::array_t<double> source_points(const Doubles& x, const Doubles& y) const {
        py::array_t<double> found({py::ssize_t{2}, x.size()});
        double* to = found.mutable_data();
        const PointArrays points{x.data(), y.data(), x.size()};
        const Unlocked unlocked;
        m_picture->source_points(points, to, to + points.count, parallel_for());
        return found;
    }
    py::array_t<double> jacobians(const Doubles& x, const Doubles& y) const {
        py::array_t<double> found({x.size(), py::ssize_t{4}});
        double* to = found.mutable_data();
        const PointArrays points{x.data(), y.data(), x.size()};
        const Unlocked unlocked;
        m_picture->jacobians(points, to, parallel_for());
        return found;
    }

  private:
    ArrayPicture::Input input_of(const py::handle& source, bool first) {
        if (py::isinstance<Pixels>(source)) {
            const ModuleSource opened = array_source(py::reinterpret_borrow<Pixels>(source), "a source");
            if (first) m_flat = opened.flat;
            return {keep(opened), nullptr};
        }
        const py::object opened = in_python("anamorph", "_opened")(source);
        if (py::isinstance<ModulePicture>(opened)) {
            const auto& picture = opened.cast<const ModulePicture&>();
            m_arrays.insert(m_arrays.end(), picture.m_arrays.begin(), picture.m_arrays.end());
            if (first) m_flat = picture.m_flat;
            return {nullptr, picture.m_picture};
        }
        const auto& image = opened.cast<const ModuleSource&>();
        if (first) m_flat = image.flat;
        return {keep(image), nullptr};
    }
    std::shared_ptr<const ArraySource> keep(const ModuleSource& source) {
        m_arrays.push_back(source.array);
        return source.source;
    }
    ParallelFor parallel_for() const { return interruptible(default_parallel_for(m_threads)); }

    int m_threads;
    bool m_flat = true;                ///< has an array of one channel two axes?
    std::vector<py::object> m_arrays;  ///< what the picture reads, directly and by others
    std::shared_ptr<const ArrayPicture> m_picture;
};

/// Opens a picture and draws it, as a call of an operation does: in one step, since each takes microseconds from Python.
Pixels apply(const py::object& operation, const py::tuple& sources, const py::dict& keywords,
             const py::object& subimage, const py::object& threads, const py::object& roi,
             const py::object& progress) {
    return ModulePicture(operation, sources, keywords, subimage, threads).draw(roi, progress);
}

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

/// Hands an error on as anamorph.Error, which names the parameter.
void throw_as(const py::handle& type, const Error& error, const std::string& parameter) {
    // What is given in place of a file has a name that no caller gave (values.cpp).
    std::string what = error.what();
    const std::string name = "<" + parameter + ">.json";
    for (std::size_t at = 0; (at = what.find(name, at)) != std::string::npos; at += parameter.size())
        what.replace(at, name.size(), parameter);
    // Names of files may be no text.
    const py::object words = py::reinterpret_steal<py::object>(
        PyUnicode_DecodeUTF8(what.data(), static_cast<py::ssize_t>(what.size()), "replace"));
    const py::object raised = type(words);
    raised.attr("parameter") = parameter;
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
        } catch (const OpenError& failed) {
            throw_as(error_type, failed.error, failed.key);
        } catch (const Error& error) {
            throw_as(error_type, error, error.parameter());
        }
    });

    m.attr("version") = version();
    numpy_dtypes();
    m.def("check_pixels", &check_pixels);
    m.def("is_plain", &is_plain);
    m.def(
        "encoded",
        [](const py::str& text, const py::str& name) {
            return py::bytes(bytes_of(text, bytes_of(name, "a name")));
        },
        py::arg("text"), py::arg("name") = "a key");
    m.def("integer", &integer);
    m.def("integers", &integers);
    m.def("operations", [] {
        py::list list;
        for (const Operation* operation : operations()) list.append(dict_of(*operation));
        return list;
    });

    py::class_<ModuleSource>(m, "Source");
    m.def("array_source", &array_source);
    m.def("image_source", &image_source);
    m.def("file_source", [](const std::string& file) {
        return ModuleSource{py::none(), std::make_shared<const ArraySource>(file)};
    });

    py::class_<ModulePicture>(m, "Picture")
        .def(py::init<const py::object&, const py::tuple&, const py::dict&, const py::object&,
                      const py::object&>())
        .def_property_readonly("arrays", &ModulePicture::arrays)
        .def_property_readonly("subimages", &ModulePicture::subimages)
        .def_property_readonly("dtype", [](const ModulePicture& p) { return dtype_of(p.spec().format); })
        .def_property_readonly(
            "channels", [](const ModulePicture& p) { return py::tuple(py::cast(p.spec().channelnames)); })
        .def_property_readonly("window",
                               [](const ModulePicture& p) { return py::tuple(py::cast(p.window())); })
        .def_property_readonly("display",
                               [](const ModulePicture& p) {
                                   const OIIO::ImageSpec& s = p.spec();
                                   return py::make_tuple(s.full_x, s.full_y, s.full_x + s.full_width,
                                                         s.full_y + s.full_height);
                               })
        .def_property_readonly("said", &ModulePicture::said)
        .def("region",
             [](const ModulePicture& p, const py::object& roi) { return py::tuple(py::cast(p.region(roi))); })
        .def("shape",
             [](const ModulePicture& p, const Window& box) { return py::tuple(py::cast(p.shape(box))); })
        .def("reached", &ModulePicture::reached)
        .def("draw", &ModulePicture::draw)
        .def("draw_to", &ModulePicture::draw_to)
        .def("source_points", &ModulePicture::source_points)
        .def("jacobians", &ModulePicture::jacobians);
    m.def("apply", &apply);
    bind_figures(m);
}
