// SPDX-License-Identifier: Apache-2.0
#include "figures.h"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "anamorph/deform.h"
#include "anamorph/figure.h"
#include "anamorph/parallel.h"
#include "anamorph/parameter/parameter.h"
#include "lock.h"
#include "script_source.h"

namespace py = pybind11;

namespace anamorph {
namespace {

using figure::FigureFrame;
using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;

figure::Dialect dialect_of(bool strict) {
    return strict ? figure::Dialect::strict : figure::Dialect::classic;
}

/// An array of `rows` times the numbers that `put(row, to)` writes, `columns` of them.
template <class Put>
py::array_t<double> table(std::size_t rows, const std::vector<py::ssize_t>& columns, const Put& put) {
    std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(rows)};
    shape.insert(shape.end(), columns.begin(), columns.end());
    py::array_t<double> all(shape);
    const std::size_t step = rows == 0 ? 0 : static_cast<std::size_t>(all.size()) / rows;
    double* to = all.mutable_data();
    for (std::size_t i = 0; i < rows; ++i, to += step) put(i, to);
    return all;
}

void put(const glm::dvec3& v, double* to) {
    for (int k = 0; k < 3; ++k) to[k] = v[k];
}

/// The bodies of a frame, a property an array.
class Frame {
  public:
    explicit Frame(FigureFrame frame) : m_frame(std::move(frame)) {}

    const FigureFrame& frame() const { return m_frame; }
    std::vector<std::string> names() const {
        std::vector<std::string> names;
        for (const figure::Body& body : m_frame.bodies) names.push_back(body.name);
        return names;
    }
    std::vector<int> figure_of() const {
        std::vector<int> of;
        for (const figure::Body& body : m_frame.bodies) of.push_back(body.figure);
        return of;
    }
    py::array_t<double> centers() const {
        return table(m_frame.bodies.size(), {3},
                     [&](std::size_t i, double* to) { put(m_frame.bodies[i].shape.center, to); });
    }
    py::array_t<double> axes() const {
        return table(m_frame.bodies.size(), {3},
                     [&](std::size_t i, double* to) { put(m_frame.bodies[i].shape.axes, to); });
    }
    py::array_t<double> colors() const {
        return table(m_frame.bodies.size(), {3},
                     [&](std::size_t i, double* to) { put(m_frame.bodies[i].color, to); });
    }
    py::array_t<double> rotations() const {
        return table(m_frame.bodies.size(), {3, 3}, [&](std::size_t i, double* to) {
            // By rows; glm's matrices have columns.
            for (int row = 0; row < 3; ++row)
                for (int column = 0; column < 3; ++column)
                    to[3 * row + column] = m_frame.bodies[i].shape.rotation[column][row];
        });
    }
    using JointTuple = std::tuple<std::string, int, int, std::array<double, 3>>;
    std::vector<JointTuple> joints() const {
        std::vector<JointTuple> joints;
        for (const figure::Joint& j : m_frame.joints)
            joints.emplace_back(j.name, j.first, j.second,
                                std::array<double, 3>{j.position.x, j.position.y, j.position.z});
        return joints;
    }
    /// (body, kind, points) of each line.
    py::list outlines(double width, double height, double tol, const std::string& hidden,
                      bool crossings) const {
        static const std::map<std::string, figure::HiddenLines> kHidden{
            {"remove", figure::HiddenLines::remove}, {"keep", figure::HiddenLines::dash}};
        const auto how = kHidden.find(hidden);
        if (how == kHidden.end()) throw Error("hidden", printable(hidden), "must be one of remove, keep");
        figure::kDrawingTolRow.check(tol);
        figure::DrawingOptions options;
        options.hidden = how->second;
        options.tol = tol;
        options.crossings = crossings;
        const figure::Drawing drawing = [&] {
            const Unlocked unlocked;
            return draw(m_frame, view_in(m_frame, {width, height}), {width, height}, options,
                        default_parallel_for());
        }();
        py::list lines;
        for (const figure::Stroke& stroke : drawing.strokes)
            lines.append(py::make_tuple(stroke.position,
                                        stroke.kind == figure::StrokeKind::hidden ? "hidden" : "visible",
                                        table(stroke.points.size(), {2}, [&](std::size_t i, double* to) {
                                            to[0] = stroke.points[i].x;
                                            to[1] = stroke.points[i].y;
                                        })));
        return lines;
    }

  private:
    FigureFrame m_frame;
};

/// A script that is performed, or a motion of a file; one thread after the other.
class SharedMotion {
  public:
    explicit SharedMotion(std::unique_ptr<figure::Motion> motion) : m_motion(std::move(motion)) {}
    static SharedMotion of_text(const std::string& text, const std::string& name, bool strict) {
        figure::ScriptOptions options;
        options.dialect = dialect_of(strict);
        return SharedMotion(std::make_unique<figure::Performance>(parse_program(text, name, options)));
    }
    static SharedMotion of_file(const std::string& path, bool strict) {
        return SharedMotion(command::open_motion({path, {}, dialect_of(strict)}, {}));
    }

    template <class Body>
    auto with(const Body& body) {
        const Unlocked unlocked;
        const std::lock_guard lock(*m_mutex);
        return body(*m_motion);
    }

  private:
    std::unique_ptr<std::mutex> m_mutex = std::make_unique<std::mutex>();
    std::unique_ptr<figure::Motion> m_motion;
};

void expect(const char* name, const Doubles& array, py::ssize_t rows, py::ssize_t columns) {
    if (array.ndim() != 2 || array.shape(1) != columns || (rows >= 0 && array.shape(0) != rows))
        throw Error(std::string(name) + ": must be an array of " +
                    (rows >= 0 ? std::to_string(rows) + " rows and " : "") + std::to_string(columns) +
                    " columns");
}

/// Points that a list of bumps, the text of a JSON file, moves; and how far a coordinate may be off.
std::pair<py::array_t<double>, double> deform(const std::string& bumps, const Doubles& uv,
                                              const Doubles& base) {
    expect("uv", uv, -1, 2);
    expect("points", base, uv.shape(0), 3);
    py::array_t<double> moved({uv.shape(0), py::ssize_t{3}});
    double* to = moved.mutable_data();
    double bound = 0;
    {
        const Unlocked unlocked;
        const std::vector<Deformation> list = with_images(parse_entries_json(bumps, "deformations")).list;
        std::vector<glm::dvec2> places(static_cast<std::size_t>(uv.shape(0)));
        for (std::size_t i = 0; i < places.size(); ++i) places[i] = {uv.data()[2 * i], uv.data()[2 * i + 1]};
        DeformedPoints surface(places);
        surface.apply(difference({}, list));
        surface.write(base.data(), to, default_parallel_for());
        bound = surface.error_bound();
    }
    return {moved, bound};
}

py::array_t<double> mix(const std::vector<Doubles>& shapes, const std::vector<double>& weights,
                        bool normalized) {
    if (shapes.empty()) throw Error("shapes: must be at least one");
    std::vector<const double*> data;
    for (const Doubles& shape : shapes) {
        if (shape.size() != shapes[0].size()) throw Error("shapes: must all have as many numbers");
        data.push_back(shape.data());
    }
    py::array_t<double> mixed(shapes[0].size());
    double* to = mixed.mutable_data();
    const Unlocked unlocked;
    inbetween<double>(data, weights, normalized ? WeightSum::normalized : WeightSum::checked,
                      shapes[0].size(), 1, to, default_parallel_for());
    return mixed;
}

}  // namespace

void bind_figures(py::module_& m) {
    py::class_<Frame>(m, "Frame")
        .def_property_readonly("number", [](const Frame& f) { return f.frame().number; })
        .def_property_readonly("figures", [](const Frame& f) { return f.frame().figures; })
        .def_property_readonly("names", &Frame::names)
        .def_property_readonly("figure_of", &Frame::figure_of)
        .def_property_readonly("centers", &Frame::centers)
        .def_property_readonly("axes", &Frame::axes)
        .def_property_readonly("rotations", &Frame::rotations)
        .def_property_readonly("colors", &Frame::colors)
        .def_property_readonly("joints", &Frame::joints)
        .def("outlines", &Frame::outlines);
    py::class_<SharedMotion>(m, "Motion")
        .def_static("of_text", &SharedMotion::of_text)
        .def_static("of_file", &SharedMotion::of_file)
        .def("first",
             [](SharedMotion& s) {
                 return s.with([](figure::Motion& motion) { return motion.first_frame(); });
             })
        .def("last",
             [](SharedMotion& s) {
                 return s.with([](figure::Motion& motion) { return motion.last_frame(); });
             })
        .def("step",
             [](SharedMotion& s) {
                 return s.with([](figure::Motion& motion) { return motion.frame_step(); });
             })
        .def("rate",
             [](SharedMotion& s) {
                 return s.with([](figure::Motion& motion) { return motion.frames_per_second(); });
             })
        .def("warnings",
             [](SharedMotion& s) { return s.with([](figure::Motion& motion) { return motion.warnings(); }); })
        .def("frame", [](SharedMotion& s, int number) {
            return s.with([&](figure::Motion& motion) { return Frame(motion.frame(number)); });
        });
    m.def("deform", &deform);
    m.def("inbetween", &mix);
}

}  // namespace anamorph
