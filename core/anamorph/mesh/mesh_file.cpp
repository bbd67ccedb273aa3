// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/mesh/sample_rows.h"
#include "anamorph/parameter/json_file.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

using text_file::excerpt;
using text_file::fail;
using text_file::Json;

/// A value as it stands in a message: its beginning, on one line.
std::string shown(const Json& value) {
    std::string text;
    if (value.is_array())
        text = "a list of " + std::to_string(value.size());
    else if (value.is_object())
        text = "an object";
    else
        text = value.text();
    if (text.size() > 40) text = text.substr(0, 40) + "...";
    return text;
}

/// An entry of the file: its value and its path from the top, for messages.
class Entry {
  public:
    Entry(const Json& value, std::string path) : m_value(value), m_path(std::move(path)) {}

    Json value() const { return m_value; }

    [[noreturn]] void refuse(const std::string& rule) const { throw Error(m_path, shown(m_value), rule); }

    Entry operator[](std::size_t i) const { return {m_value[i], m_path + "[" + std::to_string(i) + "]"}; }
    Entry at(const char* key) const {
        const std::string path = m_path + (m_path.ends_with(": ") ? "" : ".") + key;
        if (!m_value.contains(key)) throw Error(path + ": is missing");
        return {m_value.member(key), path};
    }
    bool has(const char* key) const { return m_value.contains(key); }

    /// An object with no keys but these.
    void expect_object(std::initializer_list<const char*> keys) const {
        if (!m_value.is_object()) refuse("must be an object");
        for (const auto& [key, value] : m_value.members()) {
            if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
            std::string known;
            for (const char* k : keys) known += (known.empty() ? "" : ", ") + std::string(k);
            throw Error(m_path + "\"" + excerpt(key) + "\": no such key; the keys are " + known);
        }
    }
    std::size_t expect_list(std::size_t most) const {
        if (!m_value.is_array()) refuse("must be a list");
        if (m_value.size() > most) refuse("must have at most " + std::to_string(most) + " entries");
        return m_value.size();
    }
    void expect_tuple(std::size_t size) const {
        if (!m_value.is_array() || m_value.size() != size)
            refuse("must be a list of " + std::to_string(size) + " numbers");
    }
    double number() const {
        if (!m_value.is_number()) refuse("must be a number");
        return m_value.number();
    }
    int whole(int least, int most) const {
        const double v = number();
        if (!(v >= least && v <= most && v == std::floor(v)))
            refuse("must be an integer from " + std::to_string(least) + " to " + std::to_string(most));
        return static_cast<int>(v);
    }
    /// The number of the word among `words`.
    std::size_t word(std::initializer_list<const char*> words) const {
        std::string known;
        std::size_t i = 0;
        for (const char* w : words) {
            if (m_value.is_string() && m_value.string() == w) return i;
            known += (i++ ? " or \"" : "\"") + std::string(w) + "\"";
        }
        refuse("must be " + known);
    }

  private:
    Json m_value;
    std::string m_path;
};

Units units_of(const Entry& top) {
    return top.has("units") && top.at("units").word({"pixels", "fractions"}) == 1 ? Units::fractions
                                                                                  : Units::pixels;
}

Point<double> position(const Entry& list, std::size_t first) {
    return {list[first].number(), list[first + 1].number()};
}

std::vector<double> lines(const Entry& top, const char* key) {
    std::vector<double> values;
    if (!top.has(key)) return values;
    const Entry list = top.at(key);
    const std::size_t count = list.expect_list(ControlMesh::kMaxCells + 1);
    for (std::size_t i = 0; i < count; ++i) values.push_back(list[i].number());
    return values;
}

ControlMesh::Level level(const Entry& entry) {
    entry.expect_object({"cells", "vertices"});
    ControlMesh::Level level;
    constexpr int kMost = 1 << 29;
    const Entry cells = entry.at("cells");
    const std::size_t cell_count = cells.expect_list(ControlMesh::kMaxVertices);
    for (std::size_t i = 0; i < cell_count; ++i) {
        const Entry cell = cells[i];
        cell.expect_tuple(2);
        level.cells.push_back({cell[0].whole(0, kMost), cell[1].whole(0, kMost)});
    }
    if (!entry.has("vertices")) return level;
    const Entry vertices = entry.at("vertices");
    const std::size_t vertex_count = vertices.expect_list(ControlMesh::kMaxVertices);
    for (std::size_t i = 0; i < vertex_count; ++i) {
        const Entry vertex = vertices[i];
        vertex.expect_tuple(4);
        level.vertices.push_back({vertex[0].whole(0, kMost), vertex[1].whole(0, kMost), position(vertex, 2)});
    }
    return level;
}

ControlMesh control_mesh(const Entry& top) {
    top.expect_object({"direction", "units", "columns", "rows", "vertices", "x", "y", "levels"});
    ControlMesh mesh;
    mesh.units = units_of(top);
    if (top.has("direction") && top.at("direction").word({"pull", "push"}) == 1)
        mesh.direction = Direction::push;
    mesh.columns = top.at("columns").whole(1, ControlMesh::kMaxCells);
    mesh.rows = top.at("rows").whole(1, ControlMesh::kMaxCells);
    const Entry vertices = top.at("vertices");
    const std::size_t count = vertices.expect_list(ControlMesh::kMaxVertices);
    const std::size_t across = static_cast<std::size_t>(mesh.columns) + 1,
                      needed = across * (static_cast<std::size_t>(mesh.rows) + 1);
    if (count != needed)
        vertices.refuse("must have (columns + 1) (rows + 1) = " + std::to_string(needed) + " entries");
    mesh.vertices.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Entry vertex = vertices[i];
        vertex.expect_tuple(2);
        mesh.vertices.push_back(position(vertex, 0));
    }
    mesh.x_lines = lines(top, "x");
    mesh.y_lines = lines(top, "y");
    if (top.has("levels")) {
        const Entry levels = top.at("levels");
        const std::size_t level_count = levels.expect_list(ControlMesh::kMaxLevels);
        for (std::size_t k = 0; k < level_count; ++k) mesh.levels.push_back(level(levels[k]));
    }
    return mesh;
}

ControlPoints control_points(const Entry& top) {
    top.expect_object({"units", "points", "polygons"});
    ControlPoints points;
    points.units = units_of(top);
    const Entry list = top.at("points");
    const std::size_t count = list.expect_list(ControlPoints::kMaxPoints);
    points.pairs.reserve(count);
    for (std::size_t i = 0; i < count; ++i) {
        const Entry pair = list[i];
        pair.expect_tuple(4);
        points.pairs.push_back({pair[0].number(), pair[1].number(), pair[2].number(), pair[3].number()});
    }
    if (!top.has("polygons")) return points;
    const Entry polygons = top.at("polygons");
    const std::size_t polygon_count = polygons.expect_list(ControlPoints::kMaxCorners / 3);
    points.polygons.resize(polygon_count);
    for (std::size_t n = 0; n < polygon_count; ++n) {
        const Entry polygon = polygons[n];
        const std::size_t corners = polygon.expect_list(ControlPoints::kMaxCorners);
        for (std::size_t k = 0; k < corners; ++k)
            points.polygons[n].push_back(polygon[k].whole(0, ControlPoints::kMaxPoints));
    }
    return points;
}

}  // namespace

WarpMap parse_mesh_json(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    const text_file::JsonFile file(text, name);
    const Json json = file.top();
    const Entry top(json, excerpt(name) + ": ");
    if (!json.is_object()) fail(name, "", "must be an object with \"vertices\" or \"points\"");
    if (top.has("points")) return {excerpt(name), control_points(top)};
    return {excerpt(name), control_mesh(top)};
}

namespace {

/// Writes numbers of a mesh as JSON has them.
class MeshWriter {
  public:
    const std::string& text() const { return m_text; }
    MeshWriter& operator<<(const char* text) {
        m_text += text;
        return *this;
    }
    MeshWriter& operator<<(int number) {
        m_text += std::to_string(number);
        return *this;
    }
    MeshWriter& operator<<(double number) {
        if (!std::isfinite(number)) throw Error("mesh: " + brief(number) + ": must be a finite number");
        m_text += shortest(number);
        return *this;
    }
    MeshWriter& operator<<(const Point<double>& p) { return *this << p.x << ", " << p.y; }
    /// A list, `across` entries a line.
    template <class List, class Entry>
    void list(const List& list, std::size_t across, const char* indent, const Entry& entry) {
        *this << "[";
        for (std::size_t i = 0; i < list.size(); ++i) {
            *this << (i == 0 ? "" : ",");
            if (i % across == 0 && list.size() > across)
                *this << "\n" << indent;
            else if (i > 0)
                *this << " ";
            entry(list[i]);
        }
        *this << "]";
    }

  private:
    std::string m_text;
};

void write_lines(MeshWriter& to, const char* key, const std::vector<double>& lines) {
    if (lines.empty()) return;
    to << ",\n  \"" << key << "\": ";
    to.list(lines, 16, "    ", [&](double line) { to << line; });
}

void write_level(MeshWriter& to, const ControlMesh::Level& level) {
    to << "\n    {\"cells\": ";
    to.list(level.cells, 16, "      ",
            [&](const ControlMesh::Cell& c) { to << "[" << c.column << ", " << c.row << "]"; });
    if (!level.vertices.empty()) {
        to << ",\n     \"vertices\": ";
        to.list(level.vertices, 4, "      ", [&](const ControlMesh::Vertex& v) {
            to << "[" << v.column << ", " << v.row << ", " << v.at << "]";
        });
    }
    to << "}";
}

}  // namespace

std::string mesh_json(const ControlMesh& mesh) {
    if (mesh.samples) throw Error("mesh: an ST-map has no JSON: must be a mesh");
    MeshWriter to;
    to << "{\n  \"direction\": " << (mesh.direction == Direction::push ? "\"push\"" : "\"pull\"")
       << ", \"units\": " << (mesh.units == Units::fractions ? "\"fractions\"" : "\"pixels\"")
       << ",\n  \"columns\": " << mesh.columns << ", \"rows\": " << mesh.rows << ",\n  \"vertices\": ";
    to.list(mesh.vertices, static_cast<std::size_t>(mesh.columns) + 1, "    ",
            [&](const Point<double>& vertex) { to << "[" << vertex << "]"; });
    write_lines(to, "x", mesh.x_lines);
    write_lines(to, "y", mesh.y_lines);
    if (!mesh.levels.empty()) {
        to << ",\n  \"levels\": [";
        for (std::size_t k = 0; k < mesh.levels.size(); ++k) {
            to << (k > 0 ? "," : "");
            write_level(to, mesh.levels[k]);
        }
        to << "]";
    }
    to << "\n}\n";
    return to.text();
}

WarpMap parse_points_csv(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    ControlPoints points;
    bool first = true;
    text_file::each_row(text, [&](std::string_view row, const std::string& label) {
        const bool title = first && row.find_first_of("0123456789") == std::string_view::npos;
        first = false;
        if (title) return;
        text_file::in_entry(name, label, [&] {
            const std::vector<std::string_view> fields = text_file::fields_of(row);
            if (fields.size() != 4)
                throw Error("must be four numbers x,y,u,v, not " + std::to_string(fields.size()));
            double v[4];
            for (std::size_t i = 0; i < 4; ++i) v[i] = text_file::number(fields[i]);
            points.pairs.push_back({v[0], v[1], v[2], v[3]});
        });
        if (points.pairs.size() > ControlPoints::kMaxPoints)
            fail(name, label, "must have at most " + std::to_string(ControlPoints::kMaxPoints) + " points");
    });
    return {excerpt(name), std::move(points)};
}

WarpMap parse_warp_file(std::string_view text, std::string_view name) {
    return text_file::ends_with(name, ".csv") ? parse_points_csv(text, name) : parse_mesh_json(text, name);
}

namespace {

/// The mesh of some columns and rows of an ST-map, but for its vertices.
ControlMesh stmap_lines(int width, int height, const std::vector<int>& columns, const std::vector<int>& rows,
                        std::string_view name) {
    ControlMesh mesh;
    mesh.units = Units::fractions;
    mesh.width = width;
    mesh.height = height;
    mesh.columns = static_cast<int>(columns.size()) - 1;
    mesh.rows = static_cast<int>(rows.size()) - 1;
    constexpr std::size_t kMost = kMostStMapVertices, kMostSide = kMostStMapSide;
    if (columns.size() > kMostSide || rows.size() > kMostSide || columns.size() * rows.size() > kMost)
        throw Error(excerpt(name),
                    std::to_string(columns.size()) + "x" + std::to_string(rows.size()) + " vertices",
                    "must be at most " + std::to_string(kMost) + ", at most " + std::to_string(kMostSide) +
                        " either way: take a larger step");
    for (const int x : columns) mesh.x_lines.push_back((x + 0.5) / width);
    for (const int y : rows) mesh.y_lines.push_back((y + 0.5) / height);
    return mesh;
}

/// Every step-th pixel of a row, and the last.
std::vector<int> pixels_taken(int size, int step) {
    std::vector<int> pixels;
    for (std::int64_t i = 0; i < size - 1; i += step) pixels.push_back(static_cast<int>(i));
    pixels.push_back(size - 1);
    return pixels;
}

void check_stmap(int width, int height, int step, std::string_view name) {
    if (width < 2 || height < 2)
        throw Error(excerpt(name), std::to_string(width) + "x" + std::to_string(height),
                    "an ST-map has at least 2 pixels either way");
    if (step < 1) throw Error("step", std::to_string(step), "must be an integer of at least 1");
}

void check_finite(const float* at, int x, int y, std::string_view name) {
    if (!std::isfinite(at[0]) || !std::isfinite(at[1]))
        throw Error(excerpt(name) + ": pixel [" + std::to_string(x) + ", " + std::to_string(y) + "]",
                    std::to_string(at[0]) + "," + std::to_string(at[1]),
                    "must be finite numbers, and alpha not 0; it is a hole where step is 1");
}

/// Makes holes of pixels that are not finite, and finds the largest magnitude of the others.
void find_holes(StSamples& samples) {
    samples.most = 0;
    for (std::size_t i = 0; i < samples.uv.size(); i += 2) {
        float& u = samples.uv[i];
        float& v = samples.uv[i + 1];
        if (std::isfinite(u) && std::isfinite(v)) {
            samples.most = std::max({samples.most, std::fabs(double{u}), std::fabs(double{v})});
        } else {
            u = v = NAN;
            ++samples.holes;
        }
    }
}

}  // namespace

WarpMap mesh_from_stmap(const float* uv, int width, int height, std::ptrdiff_t pixel_stride,
                        std::ptrdiff_t row_stride, int step, std::string_view name, bool v_up) {
    check_stmap(width, height, step, name);
    const std::vector<int> columns = pixels_taken(width, step), rows = pixels_taken(height, step);
    ControlMesh mesh = stmap_lines(width, height, columns, rows, name);
    mesh.vertices.reserve(columns.size() * rows.size());
    for (const int y : rows)
        for (const int x : columns) {
            const float* at = uv + y * row_stride + x * pixel_stride;
            check_finite(at, x, y, name);
            mesh.vertices.push_back({at[0], v_up ? 1 - double{at[1]} : at[1]});
        }
    return {excerpt(name), std::move(mesh)};
}

WarpMap mesh_from_stmap(std::vector<float> uv, int width, int height, std::string_view name, bool v_up) {
    check_stmap(width, height, 1, name);
    ControlMesh mesh = stmap_lines(width, height, pixels_taken(width, 1), pixels_taken(height, 1), name);
    const std::size_t numbers = 2 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (uv.size() != numbers)
        throw Error(excerpt(name), std::to_string(uv.size()) + " numbers",
                    "must be " + std::to_string(numbers));
    simd::SampleRange range;
    simd::extend_range(uv.data(), static_cast<std::ptrdiff_t>(numbers / 2), range);
    StSamples samples{std::move(uv), range.most()};
    if (!(samples.most < HUGE_VAL)) find_holes(samples);
    if (samples.holes == static_cast<std::int64_t>(numbers / 2))
        throw Error(excerpt(name) +
                    " has no pixel that comes from anywhere: must have u and v that are finite, and an alpha "
                    "that is not 0");
    samples.v_up = v_up;
    if (v_up) samples.most += 1;
    mesh.samples = std::make_shared<StSamples>(std::move(samples));
    return {excerpt(name), std::move(mesh)};
}

}  // namespace anamorph
