// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/files/scene_file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/gtc/quaternion.hpp>
#include <initializer_list>
#include <iterator>
#include <numbers>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/body/surface_steps.h"
#include "anamorph/figure/body/window_fit.h"
#include "anamorph/number/portable.h"
#include "anamorph/parameter/gltf_buffer.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"
#include "anamorph/version.h"

namespace anamorph::figure {
namespace {

using gltf::Json;

constexpr SurfaceSteps kUsualSteps{24, 48};
constexpr long long kMostTriangles = 1LL << 22;  ///< of all bodies
constexpr double kMetresPerUnit = 1.0 / 500;

/// A sphere of radius 1 about the origin; its points are their normals. Corners of triangles go round
/// against the clock as seen from outside, in right-handed space.
struct UnitSphere {
    std::vector<glm::dvec3> points;
    std::vector<std::array<std::uint32_t, 3>> triangles;

    explicit UnitSphere(const SurfaceSteps& steps) {
        const int rows = steps.rows, columns = steps.columns;
        points.push_back({0, 1, 0});
        for (int row = 1; row < rows; ++row)
            for (int column = 0; column < columns; ++column) {
                const double polar = std::numbers::pi * row / rows,
                             turn = 2 * std::numbers::pi * column / columns;
                points.push_back(
                    {std::sin(polar) * std::cos(turn), std::cos(polar), std::sin(polar) * std::sin(turn)});
            }
        points.push_back({0, -1, 0});
        const int last = static_cast<int>(points.size()) - 1;
        const auto at = [&](int row, int column) {
            if (row == 0) return 0;
            return row == rows ? last : 1 + (row - 1) * columns + column % columns;
        };
        const auto add = [&](int a, int b, int c) {
            triangles.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b),
                                 static_cast<std::uint32_t>(c)});
        };
        for (int row = 0; row < rows; ++row)
            for (int column = 0; column < columns; ++column) {
                if (row > 0) add(at(row, column), at(row, column + 1), at(row + 1, column));
                if (row < rows - 1) add(at(row, column + 1), at(row + 1, column + 1), at(row + 1, column));
            }
    }
};

std::vector<std::uint32_t> corners_of(const UnitSphere& sphere) {
    std::vector<std::uint32_t> corners;
    for (const auto& triangle : sphere.triangles)
        corners.insert(corners.end(), triangle.begin(), triangle.end());
    return corners;
}

/// The steps of each body, of the given half-axes.
std::vector<SurfaceSteps> steps_of(const std::vector<Body>& bodies, const std::vector<glm::dvec3>& axes,
                                   std::optional<double> tolerance) {
    if (!tolerance) return std::vector<SurfaceSteps>(bodies.size(), kUsualSteps);
    kSurfaceTolRow.check(*tolerance, "tol");
    std::vector<SurfaceSteps> all;
    long long triangles = 0;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const auto steps = surface_steps(axes[i], *tolerance);
        if (steps) triangles += 2LL * (steps->rows - 1) * steps->columns;
        if (!steps || triangles > kMostTriangles)
            throw Error("tol", shortest(*tolerance),
                        "is too small for " + text_file::excerpt(bodies[i].name) + ": must take at most " +
                            std::to_string(kMostSurfaceSteps) + " steps around a body and " +
                            std::to_string(kMostTriangles) + " triangles in all");
        all.push_back(*steps);
    }
    return all;
}

float as_float(double value) {
    const auto narrow = static_cast<float>(value);
    if (!std::isfinite(narrow))
        throw Error("a number of the figures, " + shortest(value) + ", does not fit float");
    return narrow;
}

void append(std::vector<float>& values, std::initializer_list<double> more) {
    for (const double value : more) values.push_back(as_float(value));
}

/// What a body does over the frames.
struct Track {
    std::vector<float> translation, rotation, scale;
};

Track track_of(std::span<const FigureFrame> frames, std::size_t body) {
    Track track;
    glm::dquat before(1, 0, 0, 0);
    for (const FigureFrame& frame : frames) {
        const Ellipsoid p = mirrored(frame.bodies[body].shape);
        const glm::dvec3 center = kMetresPerUnit * p.center, axes = kMetresPerUnit * p.axes;
        glm::dquat turn = glm::normalize(glm::quat_cast(p.rotation));
        // q and -q are the same turn; the nearer one is the shorter way.
        if (glm::dot(turn, before) < 0) turn = -turn;
        before = turn;
        append(track.translation, {center.x, center.y, center.z});
        append(track.rotation, {turn.x, turn.y, turn.z, turn.w});
        append(track.scale, {axes.x, axes.y, axes.z});
    }
    return track;
}

bool changes(const std::vector<float>& values, std::size_t width) {
    return !std::equal(values.begin() + static_cast<std::ptrdiff_t>(width), values.end(), values.begin());
}

double linear_of_srgb(double c) {
    return c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
}

/// The parts of a glTF file.
class Scene {
  public:
    Scene(std::span<const FigureFrame> frames, double frames_per_second, std::optional<double> tolerance)
        : m_frames(frames), m_steps(steps_of(frames[0].bodies, largest_axes(frames), tolerance)) {
        std::vector<float> times;
        for (std::size_t i = 0; i < frames.size(); ++i)
            times.push_back(as_float(static_cast<double>(i) / frames_per_second));
        for (const SurfaceSteps& steps : m_steps) add_sphere(steps);
        if (frames.size() > 1) m_times = m_buffer.add_floats(times, 1, true);
        add_figures();
        for (std::size_t body = 0; body < frames[0].bodies.size(); ++body) add_body(body);
    }

    std::string file() {
        Json json;
        json["scene"] = 0;
        json["scenes"] = Json::array({Json{{"nodes", m_roots}}});
        json["nodes"] = m_nodes;
        if (!m_meshes.empty()) {
            json["meshes"] = m_meshes;
            json["materials"] = m_materials;
        }
        if (!m_channels.empty())
            json["animations"] =
                Json::array({Json{{"name", "motion"}, {"channels", m_channels}, {"samplers", m_samplers}}});
        return gltf::glb(json, m_buffer);
    }

  private:
    void add_figures() {
        for (const std::string& name : m_frames[0].figures) {
            m_roots.push_back(m_nodes.size());
            m_nodes.push_back({{"name", name}});
        }
    }

    void add_body(std::size_t index) {
        const Body& body = m_frames[0].bodies[index];
        const Track track = track_of(m_frames, index);
        const auto first = [](const std::vector<float>& values, int width) {
            return std::vector<float>(values.begin(), values.begin() + width);
        };
        const std::size_t node = m_nodes.size();
        m_nodes.push_back({{"name", body.name},
                           {"mesh", mesh_of(body.color, m_steps[index])},
                           {"translation", first(track.translation, 3)},
                           {"rotation", first(track.rotation, 4)},
                           {"scale", first(track.scale, 3)}});
        const auto figure = static_cast<std::size_t>(body.figure);
        if (figure < m_frames[0].figures.size())
            m_nodes[figure]["children"].push_back(node);
        else
            m_roots.push_back(node);
        animate(node, "translation", track.translation, 3);
        animate(node, "rotation", track.rotation, 4);
        animate(node, "scale", track.scale, 3);
    }

    void animate(std::size_t node, const char* path, const std::vector<float>& values, int width) {
        if (!changes(values, static_cast<std::size_t>(width))) return;
        m_channels.push_back({{"sampler", m_samplers.size()}, {"target", {{"node", node}, {"path", path}}}});
        m_samplers.push_back({{"input", m_times},
                              {"output", m_buffer.add_floats(values, width, false)},
                              {"interpolation", "LINEAR"}});
    }

    /// The largest half-axes of each body: whatever lies between frames has none longer.
    static std::vector<glm::dvec3> largest_axes(std::span<const FigureFrame> frames) {
        std::vector<glm::dvec3> axes(frames[0].bodies.size(), glm::dvec3(0.0));
        for (const FigureFrame& frame : frames)
            for (std::size_t i = 0; i < axes.size(); ++i)
                axes[i] = glm::max(axes[i], frame.bodies[i].shape.axes);
        return axes;
    }

    /// A sphere's accessors.
    struct Sphere {
        int rows = 0, columns = 0, points = 0, triangles = 0;
    };
    const Sphere* sphere_of(const SurfaceSteps& steps) const {
        const auto found = std::find_if(m_spheres.begin(), m_spheres.end(), [&](const Sphere& s) {
            return s.rows == steps.rows && s.columns == steps.columns;
        });
        return found == m_spheres.end() ? nullptr : &*found;
    }
    void add_sphere(const SurfaceSteps& steps) {
        if (sphere_of(steps)) return;
        const UnitSphere sphere(steps);
        std::vector<float> points;
        for (const glm::dvec3& p : sphere.points) append(points, {p.x, p.y, p.z});
        const int point_accessor = m_buffer.add_floats(points, 3, true, gltf::kArrayBuffer);
        m_spheres.push_back({steps.rows, steps.columns, point_accessor,
                             m_buffer.add_indices(corners_of(sphere), sphere.points.size())});
    }

    /// The sphere of these steps in a color.
    std::size_t mesh_of(const glm::dvec3& color, const SurfaceSteps& steps) {
        const Sphere& sphere = *sphere_of(steps);
        const MeshKey key{material_of(color), &sphere - m_spheres.data()};
        const auto found = std::find(m_mesh_keys.begin(), m_mesh_keys.end(), key);
        const auto index = static_cast<std::size_t>(found - m_mesh_keys.begin());
        if (found != m_mesh_keys.end()) return index;
        m_mesh_keys.push_back(key);
        m_meshes.push_back(
            {{"primitives",
              Json::array({Json{{"attributes", {{"POSITION", sphere.points}, {"NORMAL", sphere.points}}},
                                {"indices", sphere.triangles},
                                {"material", key.first}}})}});
        return index;
    }

    std::size_t material_of(const glm::dvec3& color) {
        const auto found = std::find(m_colors.begin(), m_colors.end(), color);
        const auto index = static_cast<std::size_t>(found - m_colors.begin());
        if (found != m_colors.end()) return index;
        m_colors.push_back(color);
        const auto part = [&](int c) { return linear_of_srgb(std::clamp(color[c] / 255, 0.0, 1.0)); };
        m_materials.push_back({{"pbrMetallicRoughness",
                                {{"baseColorFactor", {part(0), part(1), part(2), 1.0}},
                                 {"metallicFactor", 0.0},
                                 {"roughnessFactor", 0.7}}}});
        return index;
    }

    /// The material and the sphere of a mesh.
    using MeshKey = std::pair<std::size_t, std::ptrdiff_t>;

    std::span<const FigureFrame> m_frames;
    std::vector<SurfaceSteps> m_steps;  ///< of the bodies
    gltf::Buffer m_buffer;
    int m_times = 0;
    std::vector<glm::dvec3> m_colors;
    std::vector<Sphere> m_spheres;
    std::vector<MeshKey> m_mesh_keys;
    Json m_roots = Json::array(), m_nodes = Json::array(), m_meshes = Json::array(),
         m_materials = Json::array(), m_channels = Json::array(), m_samplers = Json::array();
};

}  // namespace

std::string glb_file(std::span<const FigureFrame> frames, double frames_per_second,
                     std::optional<double> tolerance) {
    if (frames.empty() || frames[0].bodies.empty()) throw Error("there is no figure to write");
    for (const FigureFrame& frame : frames) {
        const bool same =
            std::equal(frame.bodies.begin(), frame.bodies.end(), frames[0].bodies.begin(),
                       frames[0].bodies.end(), [](const Body& a, const Body& b) { return a.name == b.name; });
        if (!same)
            throw Error("frame " + std::to_string(frame.number) + " has other bodies than frame " +
                        std::to_string(frames[0].number) + ": glTF must have the same in all");
    }
    return Scene(frames, frames_per_second, tolerance).file();
}

namespace {

/// Rows of numbers as text, with as many digits as it takes to read them back.
class Rows {
  public:
    explicit Rows(std::string& text) : m_text(text) {}

    void add(std::string_view what, const glm::dvec3& v) {
        m_text += what;
        for (int c = 0; c < 3; ++c) put(v[c]);
    }
    void add_corner(std::size_t index) {
        put(index);
        m_text += "//";
        m_text.append(m_number, m_end);
    }
    void end() { m_text += '\n'; }

  private:
    template <class T>
    void put(T value) {
        m_end = to_chars(m_number, std::end(m_number), value).ptr;
        m_text += ' ';
        m_text.append(m_number, m_end);
    }

    std::string& m_text;
    char m_number[32] = {}, *m_end = m_number;
};

}  // namespace

std::string obj_file(const FigureFrame& frame, std::optional<double> tolerance) {
    std::vector<glm::dvec3> axes;
    for (const Body& body : frame.bodies) axes.push_back(body.shape.axes);
    const std::vector<SurfaceSteps> steps = steps_of(frame.bodies, axes, tolerance);
    std::optional<UnitSphere> made;  // the last, which the next body mostly is, too
    SurfaceSteps made_of;
    std::string text =
        "# Anamorph " + std::string(version()) + ", frame " + std::to_string(frame.number) + "\n";
    Rows rows(text);
    std::size_t first = 1;
    for (std::size_t i = 0; i < frame.bodies.size(); ++i) {
        const Body& body = frame.bodies[i];
        if (!made || steps[i].rows != made_of.rows || steps[i].columns != made_of.columns)
            made.emplace(made_of = steps[i]);
        const UnitSphere& sphere = *made;
        const Ellipsoid p = mirrored(body.shape);
        text += "o " + body.name + "\n";
        std::string color;
        Rows(color).add("", glm::clamp(body.color / 255.0, 0.0, 1.0));
        for (const glm::dvec3& point : sphere.points) {
            rows.add("v", p.center + p.rotation * (p.axes * point));
            text += color;
            rows.end();
        }
        for (const glm::dvec3& point : sphere.points) {
            // Of a flat body, the direction that is left of the gradient.
            const glm::dvec3 gradient =
                point / glm::max(p.axes, glm::dvec3(1e-9 * std::max({p.axes.x, p.axes.y, p.axes.z, 1e-300})));
            rows.add("vn", p.rotation * glm::normalize(gradient));
            rows.end();
        }
        for (const auto& triangle : sphere.triangles) {
            text += 'f';
            for (const std::uint32_t corner : triangle) rows.add_corner(first + corner);
            rows.end();
        }
        // As much for each of the others, whose corners have more digits.
        if (first == 1) text.reserve(text.size() / 4 * 5 * frame.bodies.size());
        first += sphere.points.size();
    }
    return text;
}

namespace {

/// VTK's space is right-handed: z is negated, and turns go the other way about the mirrored axis.
glm::dvec3 in_vtk(const glm::dvec3& p) {
    return {p.x, p.y, -p.z};
}

/// The elements of a .vtp file.
class VtpText {
  public:
    std::string text;

    void open(std::string_view element) { text.append("<").append(element).append(">\n"); }
    void close(std::string_view element) { text.append("</").append(element).append(">\n"); }

    /// `values(row)`: the numbers of a row.
    template <class Values>
    void array(std::string_view type, std::string_view name, std::size_t rows, std::size_t components,
               const Values& values) {
        begin(type, name, rows, components);
        for (std::size_t row = 0; row < rows; ++row)
            for (const auto value : values(row)) put(value);
        text += "\n</DataArray>\n";
    }
    /// Bytes, each string with a 0 at its end.
    template <class Name>
    void strings(std::string_view name, std::size_t rows, const Name& name_of) {
        begin("String", name, rows, 1);
        for (std::size_t row = 0; row < rows; ++row) {
            for (const char c : name_of(row)) put(int{static_cast<unsigned char>(c)});
            put(0);
        }
        text += "\n</DataArray>\n";
    }

  private:
    void begin(std::string_view type, std::string_view name, std::size_t rows, std::size_t components) {
        text.append("<DataArray type=\"").append(type).append("\" Name=\"").append(name);
        text += "\" NumberOfComponents=\"" + std::to_string(components) + "\" NumberOfTuples=\"" +
                std::to_string(rows) + "\" format=\"ascii\">\n";
    }
    template <class T>
    void put(T value) {
        char number[32];
        text.append(number, to_chars(number, std::end(number), value).ptr) += ' ';
    }
};

using Three = std::array<double, 3>;

Three three(const glm::dvec3& v) {
    return {v.x, v.y, v.z};
}

void add_bodies(VtpText& to, const FigureFrame& frame) {
    const auto body = [&](std::size_t i) -> const Body& { return frame.bodies[i]; };
    const std::size_t count = frame.bodies.size();
    to.open("PointData Scalars=\"Color\"");
    to.array("Float64", "Axes", count, 3, [&](std::size_t i) { return three(body(i).shape.axes); });
    to.array("Float64", "Orientation", count, 4, [&](std::size_t i) {
        const glm::dquat q = glm::quat_cast(body(i).shape.rotation);
        return std::array{q.w, -q.x, -q.y, q.z};
    });
    to.array("UInt8", "Color", count, 3, [&](std::size_t i) {
        const glm::dvec3 c = glm::round(glm::clamp(body(i).color, 0.0, 255.0));
        return std::array{static_cast<int>(c.r), static_cast<int>(c.g), static_cast<int>(c.b)};
    });
    to.strings("Texture", count, [&](std::size_t i) { return body(i).texture; });
    to.array("Float64", "TextureOffset", count, 2, [&](std::size_t i) {
        return std::array{body(i).texture_offset.x, body(i).texture_offset.y};
    });
    to.strings("Name", count, [&](std::size_t i) { return body(i).name; });
    to.strings("Figure", count, [&](std::size_t i) {
        const auto figure = static_cast<std::size_t>(body(i).figure);
        return figure < frame.figures.size() ? frame.figures[figure] : std::string();
    });
    to.close("PointData");
    to.open("Points");
    to.array("Float64", "Points", count, 3,
             [&](std::size_t i) { return three(in_vtk(body(i).shape.center)); });
    to.close("Points");
    to.open("Verts");
    to.array("Int64", "connectivity", count, 1, [](std::size_t i) { return std::array{i}; });
    to.array("Int64", "offsets", count, 1, [](std::size_t i) { return std::array{i + 1}; });
    to.close("Verts");
}

void add_joints_and_view(VtpText& to, const FigureFrame& frame) {
    const std::size_t count = frame.joints.size();
    to.open("FieldData");
    to.array("Int64", "JointBodies", count, 2, [&](std::size_t i) {
        return std::array{frame.joints[i].first, frame.joints[i].second};
    });
    to.array("Float64", "JointPosition", count, 3,
             [&](std::size_t i) { return three(in_vtk(frame.joints[i].position)); });
    to.strings("JointName", count, [&](std::size_t i) { return frame.joints[i].name; });
    to.array("Float64", "ViewCenter", 1, 3, [&](std::size_t) { return three(in_vtk(frame.place)); });
    to.array("Float64", "ViewRotation", 1, 9, [&](std::size_t) {
        std::array<double, 9> rows;
        for (int k = 0; k < 9; ++k)
            rows[static_cast<std::size_t>(k)] = (k % 3 == 2 ? -1 : 1) * frame.observer[k % 3][k / 3];
        return rows;
    });
    to.close("FieldData");
}

}  // namespace

std::string vtp_file(const FigureFrame& frame) {
    VtpText to;
    const std::string count = std::to_string(frame.bodies.size());
    to.open("?xml version=\"1.0\"?");
    to.open("VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"");
    to.open("PolyData");
    add_joints_and_view(to, frame);
    to.open("Piece NumberOfPoints=\"" + count + "\" NumberOfVerts=\"" + count + "\"");
    add_bodies(to, frame);
    for (const char* element : {"Piece", "PolyData", "VTKFile"}) to.close(element);
    return to.text;
}

}  // namespace anamorph::figure
