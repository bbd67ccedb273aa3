// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/concentric_glsl.h"

#include <glm/matrix.hpp>

#include "anamorph/chart/chart_glsl.h"

namespace anamorph {
namespace {

Ray<GlslNumber> ray_given(GlslText& text) {
    return {text.input("r.x"), text.input("r.y"), text.input("r.z")};
}

std::string offset_function(const std::string& name) {
    GlslText text;
    const GlslNumber offset = ConcentricMap::offset_of(ray_given(text), text.input("p.x"), text.input("p.y"));
    return "float " + name + "Offset(vec3 r, vec2 p) {\n" + text.lines() + "  return " + offset.written() +
           ";\n}\n";
}

/// As ConcentricStack::weight() has it.
std::string circle_functions(const ConcentricStack& stack, const std::string& name) {
    if (stack.circles == 1)
        return "float " + name +
               "First(float offset, out float weight) {\n  weight = 0.0;\n  return 0.0;\n}\nfloat " + name +
               "Radius(float circle) {\n  return 0.0;\n}\n";
    const std::string gaps = GlslNumber(stack.circles - 1).written();
    return "float " + name +
           "First(float offset, out float weight) {\n  float place = clamp((offset + 1.0) / 2.0, 0.0, 1.0) "
           "* " +
           gaps + ", first = min(floor(place), " + gaps +
           " - 1.0);\n  weight = place - first;\n  return first;\n}\nfloat " + name +
           "Radius(float circle) {\n  return 2.0 * circle / " + gaps + " - 1.0;\n}\n";
}

std::string texel_function(const Chart& panorama, double depth, const std::string& name) {
    GlslText text;
    const GlslNumber radius = text.input("slit"), root = sqrt(GlslNumber(1) - square(radius));
    const Ray<GlslNumber> ray =
        ConcentricMap::slit_ray<GlslNumber>(ray_given(text), text.input("p.x"), text.input("p.y"), 1 / depth,
                                            {radius, root, GlslNumber(1) / root});
    const auto constant = [](const GlslNumber& part) { return GlslJet::variable(part, 0, 0); };
    const Branch& branch = panorama.branch(0);
    const Point<GlslJet> at =
        panorama.local_point(transform(glm::transpose(branch.axes),
                                       Ray<GlslJet>{constant(ray.x), constant(ray.y), constant(ray.z)}),
                             branch);
    return "vec2 " + name + "Texel(vec3 r, vec2 p, float slit) {\n" + text.lines() + "  return vec2(" +
           at.x.c[0].written() + ", " + at.y.c[0].written() + ");\n}\n";
}

}  // namespace

std::string concentric_glsl(const Chart& panorama, const ConcentricStack& stack, const std::string& name) {
    return offset_function(name) + circle_functions(stack, name) +
           texel_function(panorama, stack.depth, name);
}

}  // namespace anamorph
