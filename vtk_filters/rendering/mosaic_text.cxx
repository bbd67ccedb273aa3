// SPDX-License-Identifier: Apache-2.0
#include "mosaic_text.h"

#include <algorithm>
#include <bit>

#include "anamorph/number/glsl_number.h"
#include "anamorph/projector/concentric_glsl.h"

namespace anamorph_vtk {
namespace {

std::string written(double value) {
    return anamorph::GlslNumber(value).written();
}

/// Reads a panorama of the stack. Levels are read up to the last one in which no row is a mean of two panoramas, and so far from the
/// upper and lower edges that none are mixed.
std::string read_function(const anamorph::Chart& chart, int circles, bool mipmaps, const std::string& rgba) {
    const int levels = mipmaps ? std::countr_zero(static_cast<unsigned>(chart.height())) : 0;
    return "vec4 anamorphColumn#(vec2 at, vec2 alongA, vec2 alongB, float circle) {\n  vec2 size = vec2(" +
           written(chart.width()) + ", " + written(chart.height()) +
           ");\n  float texels = max(length(alongA), length(alongB));\n"
           "  float level = texels > 1.0 ? min(log2(texels), " +
           written(levels) +
           ") : 0.0, edge = 0.5 * exp2(ceil(level));\n"
           "  at.y = circle * size.y + clamp(at.y, edge, size.y - edge);\n"
           "  vec2 all = size * vec2(1.0, " +
           written(circles) +
           ");\n  vec4 colour = textureLod(anamorphPanorama#, vec2(at.x, all.y - at.y) / all, level);\n  "
           "return " +
           rgba + ";\n}\n";
}

/// What the slit of a circle shows of a point: its texel.
constexpr const char* kPlace = R"(vec2 anamorphPlace#(vec3 p, float radius) {
  return anamorphSlit#Texel(p, vec2(0.0), clamp(radius / length(p.xz), -0.9999999, 0.9999999));
}
)";

/// Points are in radii. The line of sight, as seen from above, touches a circle, and the slits of the two circles beside it that show the
/// point are mixed. It has to lie beyond the circles, and beyond where the line touches.
constexpr const char* kPaint = R"(
bool anamorphPaint#(vec3 r, vec3 a, vec3 b, out vec4 colour, out float part) {
  vec3 p = r / anamorphRadius#, sight = p * anamorphViewer#.w - anamorphViewer#.xyz;
  sight /= max(max(abs(sight.x), abs(sight.y)), max(abs(sight.z), 1e-30));
  if (dot(sight.xz, sight.xz) < 1e-12) sight.xz = p.xz;
  float offset = anamorphSlit#Offset(sight, anamorphViewer#.w > 0.0 ? anamorphViewer#.xz : p.xz), weight;
  float first = anamorphSlit#First(offset, weight);
  bool sees = dot(p.xz, p.xz) > 1.0 && dot(p.xz, sight.xz) > 0.0 && abs(offset) <= 1.000001;
  colour = vec4(0.0);
  part = 0.0;
  for (int i = 0; i < anamorphSlits#; ++i) {
    float circle = first + float(i), radius = anamorphSlit#Radius(circle);
    vec2 at = anamorphPlace#(p, radius);
    vec2 alongA = anamorphPlace#(p + a / anamorphRadius#, radius) - at;
    vec2 alongB = anamorphPlace#(p + b / anamorphRadius#, radius) - at;
    alongA.x -= anamorphTurn# * roundEven(alongA.x / anamorphTurn#);
    alongB.x -= anamorphTurn# * roundEven(alongB.x / anamorphTurn#);
    vec4 column = anamorphColumn#(at, alongA, alongB, circle);
    if (!sees || !(at.y >= 0.0 && at.y <= anamorphRows#)) continue;
    float share = (i == 0 ? 1.0 - weight : weight) * anamorphFade#(at);
    colour += share * column;
    part += share;
  }
  if (part > 0.0) colour /= part;
  return part > 0.0;
}
)";

}  // namespace

std::string mosaic_function(const anamorph::Chart& panorama, const anamorph::ConcentricStack& stack,
                            double radius, bool mipmaps, const std::string& rgba) {
    return anamorph::concentric_glsl(panorama, stack, "anamorphSlit#") +
           read_function(panorama, stack.circles, mipmaps, rgba) +
           "const float anamorphRadius# = " + written(radius) +
           ", anamorphTurn# = " + written(panorama.width()) +
           ", anamorphRows# = " + written(panorama.height()) +
           ";\nconst int anamorphSlits# = " + std::to_string(std::min(stack.circles, 2)) + ";\n" + kPlace +
           kPaint;
}

}  // namespace anamorph_vtk
