// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/shapes_file.h"

#include <algorithm>
#include <cmath>

#include "anamorph/error.h"
#include "anamorph/number/hypot.h"
#include "anamorph/parameter/gltf_buffer.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

using Three = std::array<double, 3>;

float as_float(double value, const std::string& what) {
    const auto narrow = static_cast<float>(value);
    if (!std::isfinite(narrow)) throw Error(what, shortest(value), "must be finite as float");
    return narrow;
}

std::string numbered(const char* name, std::size_t i) {
    return std::string(name) + "[" + std::to_string(i) + "]";
}

std::vector<float> floats_of(const std::vector<Three>& values, const std::string& what) {
    std::vector<float> floats;
    floats.reserve(3 * values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        for (const double value : values[i])
            floats.push_back(as_float(value, what + " at point " + std::to_string(i)));
    return floats;
}

/// The offsets that lead from a base in float to a shape. Both are float where sums are read, so the offset counts from the
/// base as it is written.
std::vector<float> offsets_of(const std::vector<float>& base, const std::vector<Three>& shape,
                              const std::string& what) {
    std::vector<float> offsets(base.size());
    for (std::size_t i = 0; i < shape.size(); ++i)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t k = 3 * i + c;
            const double value = shape[i][c];
            offsets[k] = as_float(
                as_float(value, what + " at point " + std::to_string(i)) - static_cast<double>(base[k]),
                what + " at point " + std::to_string(i));
        }
    return offsets;
}

/// The largest distance between points and what a base and offsets to them add up to, in float.
double distance(const std::vector<Three>& points, const std::vector<float>& base,
                const std::vector<float>& offsets) {
    double largest = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        Three off;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t k = 3 * i + c;
            const double sum = static_cast<double>(base[k]) + (offsets.empty() ? 0 : offsets[k]);
            off[c] = static_cast<double>(static_cast<float>(sum)) - points[i][c];
        }
        largest = std::max(largest, hypot(off[0], off[1], off[2]));
    }
    return largest;
}

class ShapesWriter {
  public:
    explicit ShapesWriter(const BlendShapes& shapes) : m_shapes(shapes) {
        for (const ShapePart& part : shapes.parts) add_part(part);
        if (m_primitives.empty()) throw Error("there are no points to write");
        if (shapes.keys) add_keys(*shapes.keys);
    }

    ShapesFile file(const std::string& buffer_name) const {
        gltf::Json mesh{{"primitives", m_primitives}, {"extras", {{"targetNames", m_shapes.names}}}};
        if (!m_shapes.names.empty()) mesh["weights"] = first_weights();
        gltf::Json json{
            {"scene", 0},
            {"scenes", gltf::Json::array({gltf::Json{{"nodes", {0}}}})},
            {"nodes", gltf::Json::array({gltf::Json{{"name", m_shapes.parts.front().name}, {"mesh", 0}}})},
            {"meshes", gltf::Json::array({mesh})},
            // A surface is seen from both sides; others' default hides its back.
            {"materials", gltf::Json::array({gltf::Json{
                              {"doubleSided", true}, {"pbrMetallicRoughness", {{"metallicFactor", 0.0}}}}})}};
        if (!m_animation.is_null()) json["animations"] = gltf::Json::array({m_animation});
        ShapesFile file;
        file.max_error = m_max_error;
        if (buffer_name.empty()) {
            file.bytes = gltf::glb(json, m_buffer);
        } else {
            file.bytes = gltf::document(json, m_buffer, buffer_name);
            file.buffer = m_buffer.bytes;
        }
        return file;
    }

  private:
    void add_part(const ShapePart& part) {
        if (part.shapes.size() != m_shapes.names.size() + 1)
            throw Error("shapes of " + text_file::excerpt(part.name), std::to_string(part.shapes.size()),
                        "must be a base and " + std::to_string(m_shapes.names.size()) + " more");
        const ShapePoints& base = part.shapes.front();
        const std::size_t count = base.points.size();
        if (count == 0) return;
        bool normals = true;
        for (std::size_t i = 0; i < part.shapes.size(); ++i) {
            const ShapePoints& shape = part.shapes[i];
            if (shape.points.size() != count)
                throw Error(name_of(i), std::to_string(shape.points.size()) + " points",
                            "must be as many as the base has, " + std::to_string(count));
            normals = normals && shape.normals.size() == count;
        }
        const std::vector<float> points = floats_of(base.points, name_of(0));
        m_max_error = std::max(m_max_error, distance(base.points, points, {}));
        gltf::Json attributes{{"POSITION", m_buffer.add_floats(points, 3, true, gltf::kArrayBuffer)}};
        std::vector<float> directions;
        if (normals) {
            directions = floats_of(base.normals, "normals of " + name_of(0));
            attributes["NORMAL"] = m_buffer.add_floats(directions, 3, false, gltf::kArrayBuffer);
        }
        if (part.texture.size() == count) attributes["TEXCOORD_0"] = add_texture(part.texture);
        gltf::Json targets = gltf::Json::array();
        for (std::size_t i = 1; i < part.shapes.size(); ++i) {
            const ShapePoints& shape = part.shapes[i];
            const std::vector<float> offsets = offsets_of(points, shape.points, name_of(i));
            m_max_error = std::max(m_max_error, distance(shape.points, points, offsets));
            gltf::Json target{{"POSITION", m_buffer.add_floats(offsets, 3, true)}};
            if (normals)
                target["NORMAL"] = m_buffer.add_floats(
                    offsets_of(directions, shape.normals, "normals of " + name_of(i)), 3, false);
            targets.push_back(target);
        }
        constexpr int kPoints = 0, kLines = 1, kTriangles = 4;
        const auto add = [&](const std::vector<std::uint32_t>& indices, int mode) {
            gltf::Json primitive{{"attributes", attributes}, {"mode", mode}, {"material", 0}};
            if (!indices.empty()) primitive["indices"] = m_buffer.add_indices(indices, count);
            if (!targets.empty()) primitive["targets"] = targets;
            if (!part.name.empty()) primitive["extras"] = {{"name", part.name}};
            m_primitives.push_back(primitive);
        };
        if (!part.triangles.empty()) add(part.triangles, kTriangles);
        if (!part.lines.empty()) add(part.lines, kLines);
        const bool alone = part.triangles.empty() && part.lines.empty();
        if (!part.vertices.empty() || alone) add(part.vertices, kPoints);
    }

    /// In glTF v runs down.
    int add_texture(const std::vector<std::array<double, 2>>& texture) {
        std::vector<float> floats;
        for (std::size_t i = 0; i < texture.size(); ++i) {
            const std::string what = "texture coordinates at point " + std::to_string(i);
            floats.push_back(as_float(texture[i][0], what));
            floats.push_back(as_float(1 - texture[i][1], what));
        }
        return m_buffer.add_floats(floats, 2, false, gltf::kArrayBuffer);
    }

    std::vector<float> first_weights() const {
        std::vector<double> weights = m_shapes.weights;
        if (weights.empty() && m_shapes.keys) weights = m_shapes.keys->values().front();
        weights.resize(m_shapes.names.size(), 0.0);
        std::vector<float> floats;
        for (std::size_t i = 0; i < weights.size(); ++i)
            floats.push_back(as_float(weights[i], numbered("Weights", i)));
        return floats;
    }

    void add_keys(const KeyFrames& keys) {
        std::vector<float> times, values;
        for (const double time : keys.times()) {
            times.push_back(as_float(time, "a key's time"));
            if (times.back() < 0)
                throw Error("a key's time", shortest(time), "must be at least 0: so it is in glTF");
            if (times.size() > 1 && !(times.back() > times[times.size() - 2]))
                throw Error("a key's time", shortest(time), "is the same in float as the one before");
        }
        const bool cubic = m_shapes.interpolation == KeyInterpolation::catmull_rom ||
                           m_shapes.interpolation == KeyInterpolation::monotone_cubic;
        for (std::size_t k = 0; k < times.size(); ++k) {
            // Of splines the slope into a key, its value, and the slope out of it.
            const std::vector<double> slopes = cubic ? keys.slopes(k) : std::vector<double>();
            for (const std::vector<double>* some : {&slopes, &keys.values()[k], &slopes})
                for (const double value : *some) values.push_back(as_float(value, "a weight of the keys"));
        }
        const char* interpolation = cubic                                              ? "CUBICSPLINE"
                                    : m_shapes.interpolation == KeyInterpolation::step ? "STEP"
                                                                                       : "LINEAR";
        m_animation = {
            {"name", "weights"},
            {"channels",
             gltf::Json::array({gltf::Json{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}})},
            {"samplers", gltf::Json::array({gltf::Json{{"input", m_buffer.add_floats(times, 1, true)},
                                                       {"output", m_buffer.add_floats(values, 1, false)},
                                                       {"interpolation", interpolation}}})}};
    }

    std::string name_of(std::size_t shape) const {
        return shape == 0 ? "the base" : "shape " + text_file::excerpt(m_shapes.names[shape - 1]);
    }

    const BlendShapes& m_shapes;
    gltf::Buffer m_buffer;
    gltf::Json m_primitives = gltf::Json::array(), m_animation;
    double m_max_error = 0;
};

}  // namespace

ShapesFile shapes_file(const BlendShapes& shapes, const std::string& buffer_name) {
    if (shapes.keys && shapes.keys->size() != shapes.names.size())
        throw Error("keys", std::to_string(shapes.keys->size()) + " weights",
                    "must be as many as the shapes beside the base, " + std::to_string(shapes.names.size()));
    return ShapesWriter(shapes).file(buffer_name);
}

}  // namespace anamorph
