// SPDX-License-Identifier: Apache-2.0
#include "projection_text.h"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <limits>
#include <numbers>

#include "anamorph/error.h"
#include "anamorph/machine/machine_text.h"
#include "anamorph/number/glsl_number.h"
#include "anamorph/projector/panorama_glsl.h"
#include "mosaic_text.h"
#include "shadow_map.h"
#include "shadow_rays.h"
#include "vtkAlgorithm.h"
#include "vtkAnamorphPanoramaProjector.h"
#include "vtkAnamorphProjectionShader.h"
#include "vtkImageData.h"
#include "vtkPointData.h"
#include "vtkTexture.h"

namespace anamorph_vtk {
namespace {

using Shader = vtkAnamorphProjectionShader;

/// Tables with a larger bound in texels are not read: near a pole residuals have none.
constexpr double kMostBound = 0.25;

/// Is a table all there is to read in a group's field of view? Its formula goes on across the seam of a panorama that does not
/// close, where the texel is none, and behind a picture that does not see all.
bool is_readable(const anamorph::ProjectionGroup& group, const anamorph::Chart& chart,
                 const anamorph::GroupOptions& field, double most_bound) {
    using anamorph::Interval;
    constexpr int kSquares = 16;
    const bool has_seam = chart.counted() == anamorph::Counted::azimuth && !chart.closed();
    const bool behind = -group.axes[2].z > std::cos(std::atan(field.x_max));
    if (!(group.bound <= most_bound) || (has_seam && behind)) return false;
    for (int k = 0; k < kSquares * kSquares; ++k) {
        const auto part = [](int at, double most) {
            return Interval(most * (2.0 * at / kSquares - 1), most * (2.0 * (at + 1) / kSquares - 1));
        };
        const anamorph::Ray<Interval> place{part(k % kSquares, field.x_max), part(k / kSquares, field.y_max),
                                            Interval(1)};
        if (!(chart.sees(transform(group.axes, place)).lo > 0)) return false;
    }
    return true;
}

std::string written(double value) {
    return anamorph::GlslNumber(value).written();
}
std::string numbered(const std::string& name, std::size_t projector) {
    return "anamorph" + name + std::to_string(projector);
}
std::string ray_name(std::size_t projector, const std::string& stage) {
    return numbered("Ray", projector) + stage + "Output";
}

/// The text with # for the projector's number.
std::string with_number(std::string text, std::size_t projector) {
    const std::string number = std::to_string(projector);
    for (std::size_t at = text.find('#'); at != std::string::npos; at = text.find('#', at))
        text.replace(at, 1, number);
    return text;
}

/// What a texel `colour` of a texture of so many components is in red, green, blue and alpha.
std::string rgba_of(int components) {
    if (components > 2) return "colour";
    return components == 1 ? "vec4(colour.rrr, 1.0)" : "vec4(colour.rrr, colour.g)";
}

/// Reads a panorama. Its last rows are not mixed with the first, which a texture that repeats would do.
std::string read_function(const PreparedPanorama& panorama) {
    const anamorph::Chart& chart = panorama.chart;
    return "vec4 anamorphRead#(vec2 at, vec2 alongA, vec2 alongB) {\n  vec2 size = vec2(" +
           written(chart.width()) + ", " + written(chart.height()) + "), flip = vec2(1.0, -1.0);\n  " +
           (chart.closed() ? "at.y = clamp(at.y, 0.5, size.y - 0.5);\n"
                           : "at = clamp(at, vec2(0.5), size - 0.5);\n") +
           "  vec4 colour = textureGrad(anamorphPanorama#, vec2(at.x, size.y - at.y) / size, flip * alongA / "
           "size, "
           "flip * alongB / size);\n  return " +
           rgba_of(panorama.thrown.components) + ";\n}\n";
}

/// How much counts towards borders: as anamorph::share_of() fades. Full circles have no border to the left and right, faces
/// and poles none at all.
std::string fade_function(const PreparedPanorama& panorama) {
    const anamorph::Chart& chart = panorama.chart;
    std::string text = "float anamorphFade#(vec2 at) {\n";
    if (!(panorama.thrown.fade > 0) || chart.pieces().size() > 1) return text + "  return 1.0;\n}\n";
    const std::string fade = written(panorama.thrown.fade);
    text += "  float within = " + fade + ";\n";
    if (!chart.closed())
        text += "  within = min(within, min(at.x, " + written(chart.width()) + " - at.x));\n";
    if (!chart.reaches_poles())
        text += "  within = min(within, min(at.y, " + written(chart.height()) + " - at.y));\n";
    return text + "  return max(within / " + fade + ", 0.0);\n}\n";
}

/// What every mode begins and ends with. Textures with mipmaps are read where all fragments come by, as levels of detail may be
/// chosen for several at once.
constexpr const char* kBegin = R"(
bool anamorphPaint#(vec3 r, vec3 a, vec3 b, out vec4 colour, out float part) {
  vec2 at = vec2(0.0), alongA = vec2(1.0, 0.0), alongB = vec2(0.0, 1.0);
  bool seen;
)";
constexpr const char* kEnd = R"(
  part = seen ? anamorphFade#(at) : 0.0;
  colour = anamorphRead#(at, alongA, alongB);
  return part > 0.0;
}
)";

/// By the panorama's own formula.
std::string direct_function() {
    return std::string(kBegin) + "  seen = anamorphThrown#(r, a, b, at, alongA, alongB);" + kEnd;
}

/// An array of matrices, one for each group.
template <class Matrix>
std::string matrices(const std::string& name, const PreparedPanorama& panorama, const Matrix& matrix) {
    const std::string type = "mat3[" + std::to_string(panorama.groups.size()) + "]";
    std::string text;
    for (const anamorph::ProjectionGroup& group : panorama.groups) {
        const glm::dmat3 m = matrix(group);
        text += text.empty() ? "mat3(" : ",\n  mat3(";
        for (int i = 0; i < 9; ++i) text += (i ? ", " : "") + written(m[i / 3][i % 3]);
        text += ")";
    }
    return "const " + type + " " + name + " = " + type + "(" + text + ");\n";
}

/// The group that a ray belongs to, nearest to its direction, and where the ray meets its projection plane, in fields of view
/// from -1 to 1; -1 where it is in none.
std::string group_function(const PreparedPanorama& panorama) {
    const std::string count = std::to_string(panorama.groups.size());
    return matrices("anamorphAxes#", panorama, [](const auto& group) { return group.axes; }) +
           "const vec2 anamorphField# = vec2(" + written(panorama.field.x_max) + ", " +
           written(panorama.field.y_max) + ");\nconst float anamorphCount# = " + count + R"(.0;
int anamorphGroup#(vec3 r, out vec2 place) {
  int best = 0;
  float most = 0.0;
  for (int g = 0; g < )" +
           count + R"(; ++g) {
    float along = dot(r, anamorphAxes#[g][2]);
    if (along > most) { most = along; best = g; }
  }
  vec3 p = r * anamorphAxes#[best];
  place = p.xy / p.z / anamorphField#;
  return most > 0.0 && max(abs(place.x), abs(place.y)) <= 1.0 ? best : -1;
}
)";
}

/// What a table says at a place of group g, counted in its texels from the middle of the first.
std::string table_function(const PreparedPanorama& panorama) {
    const std::string begin = "vec2 anamorphBump#(int g, vec2 size, vec2 node) {\n";
    if (!panorama.machine)
        return begin + R"(  node += 0.5;
  vec2 table = vec2(node.x, node.y + float(g) * size.y) / (size * vec2(1.0, anamorphCount#));
  return textureLod(anamorphTable#, table, 0.0).xy;
}
)";
    // As machine::MachineTexture reads, along rows first; in texels of the panorama.
    std::string scales;
    for (const anamorph::machine::BumpTable& table : panorama.bumps)
        scales += (scales.empty() ? "vec2(" : ",\n  vec2(") +
                  written(table.scale[0] * panorama.chart.width()) + ", " +
                  written(table.scale[1] * panorama.chart.height()) + ")";
    const std::string type = "vec2[" + std::to_string(panorama.bumps.size()) + "]";
    return "const " + type + " anamorphScale# = " + type + "(" + scales + ");\n" + begin +
           "  float unit = " + written(std::ldexp(1.0, panorama.machine->weight_bits)) + R"(;
  vec2 first = floor(node), weight = roundEven((node - first) * unit) / unit;
  ivec2 a = ivec2(first), b = min(a + 1, ivec2(size) - 1), row = ivec2(0, g * int(size.y));
  vec2 upper = mix(texelFetch(anamorphTable#, a + row, 0).xy, texelFetch(anamorphTable#, ivec2(b.x, a.y) + row, 0).xy, weight.x);
  vec2 lower = mix(texelFetch(anamorphTable#, ivec2(a.x, b.y) + row, 0).xy, texelFetch(anamorphTable#, b + row, 0).xy, weight.x);
  return mix(upper, lower, weight.y) * anamorphScale#[g];
}
)";
}

/// Kim 2003, 4.4.1: the linear part, perturbed by the table.
std::string residual_function(const PreparedPanorama& panorama) {
    const std::string size =
        "vec2(" + written(panorama.field.columns) + ", " + written(panorama.field.rows) + ")";
    const std::string right =
        panorama.chart.closed() ? "" : "at.x >= 0.0 && at.x <= " + written(panorama.chart.width()) + " && ";
    return table_function(panorama) +
           matrices("anamorphLinear#", panorama, [](const auto& group) { return group.linear; }) + R"(
vec2 anamorphTexel#(int g, vec3 r) {
  vec3 p = r * anamorphAxes#[g], linear = anamorphLinear#[g] * r;
  vec2 size = )" +
           size + R"(, node = clamp(p.xy / p.z / anamorphField# * 0.5 + 0.5, 0.0, 1.0) * (size - 1.0);
  return linear.xy / linear.z + anamorphBump#(g, size, node);
}
)" + kBegin +
           R"(
  vec2 place;
  int g = anamorphGroup#(r, place);
  if (g < 0) {
    seen = anamorphThrown#(r, a, b, at, alongA, alongB);
  } else {
    at = anamorphTexel#(g, r);
    alongA = anamorphTexel#(g, r + a) - at;
    alongB = anamorphTexel#(g, r + b) - at;
    seen = )" +
           right + "at.y >= 0.0 && at.y <= " + written(panorama.chart.height()) + ";\n  }" + kEnd;
}

/// Kim 2003, 4.4.2: the second pass.
std::string second_pass_function(const PreparedPanorama& panorama) {
    return kBegin + std::string(R"(
  vec2 place;
  int g = anamorphGroup#(r, place);
  seen = g < 0;
  if (seen) seen = anamorphThrown#(r, a, b, at, alongA, alongB);
  float size = )") +
           written(panorama.thrown.plane_size) + R"(;
  place = clamp(place * 0.5 + 0.5, 0.5 / size, 1.0 - 0.5 / size);
  vec4 thrown = textureLod(anamorphTable#, vec2(place.x, (place.y + float(max(g, 0))) / anamorphCount#), 0.0);
  vec4 read = anamorphRead#(at, alongA, alongB);
  part = g >= 0 ? thrown.a : seen ? anamorphFade#(at) : 0.0;
  colour = g >= 0 ? vec4(thrown.rgb / max(part, 1e-6), 1.0) : read;
  return part > )" +
           (panorama.thrown.fade > 0 ? "0.0" : "0.5") + ";\n}\n";
}

/// All functions of a projector.
std::string functions(const PreparedPanorama& panorama, bool rays, std::size_t i) {
    const ThrownPanorama& thrown = panorama.thrown;
    if (thrown.circles > 1)
        return with_number(
            fade_function(panorama) + mosaic_function(panorama.chart, {.circles = thrown.circles},
                                                      thrown.circle_radius, thrown.mipmaps,
                                                      rgba_of(thrown.components)),
            i);
    std::string text = panorama_glsl(panorama.chart, numbered("Thrown", i)) + read_function(panorama) +
                       fade_function(panorama);
    if (panorama.groups.empty())
        text += direct_function();
    else
        text += group_function(panorama) + (panorama.thrown.mode == Shader::RESIDUAL
                                                ? residual_function(panorama)
                                                : second_pass_function(panorama));
    if (panorama.thrown.shadow_size > 0)
        text += rays ? traced_function() : hidden_function(panorama.thrown.shadow_size);
    return with_number(text, i);
}

/// A fragment's sum over projectors; a share as anamorph::share_of() has it.
std::string fragment_code(std::size_t projector, bool alone, bool shadows) {
    const std::string lit =
        shadows ? " && !anamorphHidden#(anamorphFrame# * r, anamorphFrame# * cross(a, b))" : "";
    const std::string share =
        alone ? "part" : "part * abs(dot(normalize(r), normalize(cross(a, b)))) / dot(r, r)";
    return with_number(R"(
  {
    vec3 r = anamorphRay#VSOutput, a = dFdx(r), b = dFdy(r);
    vec4 colour;
    float part;
    if (anamorphPaint#(r, a, b, colour, part))" +
                           lit + R"() {
      float share = )" + share +
                           R"(;
      anamorphSum += share * colour;
      anamorphAll += share;
    }
  }
)",
                       projector);
}

}  // namespace

std::string texture_name(std::size_t projector) {
    return numbered("Panorama", projector);
}
std::string table_name(std::size_t projector) {
    return numbered("Table", projector);
}
std::string shadow_name(std::size_t projector) {
    return numbered("Shadow", projector);
}
std::string matrix_name(std::size_t projector) {
    return numbered("Matrix", projector);
}
std::string origin_name(std::size_t projector) {
    return numbered("Origin", projector);
}
std::string away_name(std::size_t projector) {
    return numbered("Away", projector);
}
std::string viewer_name(std::size_t projector) {
    return numbered("Viewer", projector);
}
std::string frame_name(std::size_t projector) {
    return numbered("Frame", projector);
}

ThrownPanorama thrown_by(vtkAnamorphPanoramaProjector& projector, vtkAnamorphProjectionShader& shader) {
    vtkTexture* texture = projector.GetPanorama();
    if (vtkAlgorithm* producer = texture ? texture->GetInputAlgorithm() : nullptr) producer->Update();
    vtkImageData* image = texture ? texture->GetInput() : nullptr;
    if (!image || image->GetNumberOfPoints() == 0 || !image->GetPointData()->GetScalars())
        throw anamorph::Error("Panorama", "none", "must be a texture with an image as its input");
    ThrownPanorama thrown;
    thrown.chart = {anamorph::kProjections[projector.GetProjection()],
                    projector.GetFieldOfView(),
                    projector.GetVerticalFieldOfView(),
                    projector.GetPanniniDistance(),
                    projector.GetProjectionAlpha(),
                    projector.GetLens() ? projector.GetLens() : ""};
    thrown.width = image->GetDimensions()[0];
    thrown.height = image->GetDimensions()[1];
    thrown.fade = projector.GetFade();
    if (projector.GetOccluders()) thrown.shadow_size = projector.GetShadowSize();
    thrown.mode = shader.GetMode();
    thrown.circles = projector.GetCircles();
    thrown.mipmaps = thrown.circles > 1 && texture->GetMipmap();
    thrown.circle_radius = projector.GetCircleRadius();
    if (thrown.mode == Shader::DIRECT) return thrown;
    if (thrown.mode == Shader::RESIDUAL) thrown.machine = shader.GetMachine();
    thrown.directions = shader.GetNumberOfDirections();
    thrown.vertical_reach = shader.GetVerticalReach();
    (thrown.mode == Shader::RESIDUAL ? thrown.table_size : thrown.plane_size) =
        thrown.mode == Shader::RESIDUAL ? shader.GetTableSize() : shader.GetPlaneSize();
    return thrown;
}

anamorph::ProjectorPose pose_of(vtkAnamorphPanoramaProjector& projector) {
    const auto vector = [](const double* v) { return glm::dvec3(v[0], v[1], v[2]); };
    return {vector(projector.GetPosition()), vector(projector.GetDirection()), vector(projector.GetViewUp())};
}

namespace {

anamorph::Chart chart_of(const ThrownPanorama& thrown) {
    if (thrown.height % thrown.circles != 0)
        throw anamorph::Error("Circles", std::to_string(thrown.circles),
                              "must divide the panorama's height, " + std::to_string(thrown.height));
    return thrown.chart.of({thrown.width, thrown.height / thrown.circles});
}

/// Refuses what concentric mosaics leave no meaning to.
void check_mosaics(const PreparedPanorama& panorama) {
    const ThrownPanorama& thrown = panorama.thrown;
    anamorph::check_slit_panorama(panorama.chart);
    if (!(thrown.circle_radius > 0 && std::isfinite(thrown.circle_radius)))
        throw anamorph::Error("CircleRadius", anamorph::shortest(thrown.circle_radius),
                              "must be a finite number above 0");
    if (thrown.mode != Shader::DIRECT)
        throw anamorph::Error("Mode", thrown.mode == Shader::RESIDUAL ? "residual" : "multipass",
                              "must be direct for concentric mosaics");
    if (thrown.shadow_size > 0)
        throw anamorph::Error("Occluders", "given",
                              "must be none for concentric mosaics: what hides a point from their slits "
                              "hides it from the viewer");
    if (thrown.most_rows > 0 && thrown.height > thrown.most_rows)
        throw anamorph::Error("Panorama", std::to_string(thrown.height) + " rows",
                              "must have no more than " + std::to_string(thrown.most_rows) +
                                  ", the most that a texture may have here");
}

}  // namespace

PreparedPanorama::PreparedPanorama(const ThrownPanorama& panorama)
    : thrown(panorama), chart(chart_of(panorama)) {
    if (thrown.circles > 1) check_mosaics(*this);
    if (thrown.mode == Shader::DIRECT) return;
    const bool residual = thrown.mode == Shader::RESIDUAL;
    if (residual && chart.pieces().size() > 1)
        throw anamorph::Error("Mode", "residual", "must be direct or multipass for a panorama with faces");
    if (residual && !thrown.machine.empty()) {
        machine = anamorph::machine::bump_unit_from_text(thrown.machine);
        anamorph::machine::check_on_scene(*machine, chart);
    }
    const int count = machine ? machine->planes.count : thrown.directions;
    // So wide that neighbours overlap by a hair; two face each other, and never meet.
    field.x_max = count > 2 ? std::tan(std::numbers::pi / count) * (1 + 0x1p-10) : 1;
    field.y_max = machine ? 1 : thrown.vertical_reach;
    if (machine && machine->planes.x_max > 0) field.x_max = machine->planes.x_max;
    if (machine && machine->planes.y_max > 0) field.y_max = machine->planes.y_max;
    field.columns = field.rows = machine ? machine->size : residual ? thrown.table_size : 2;
    // Tables lie one above the other.
    if (residual && thrown.most_rows > 0 && field.rows > thrown.most_rows / count)
        throw anamorph::Error(
            machine ? "machine: size" : "TableSize", std::to_string(field.rows),
            "times the number of directions must be no more than " + std::to_string(thrown.most_rows));
    groups = anamorph::ProjectionGroups(anamorph::Projector(chart),
                                        anamorph::ProjectionGroups::level_directions(count), field)
                 .groups();
    // Of a machine that is what it shows.
    const double most_bound = machine ? std::numeric_limits<double>::max() : kMostBound;
    if (residual)
        groups.erase(
            std::remove_if(groups.begin(), groups.end(),
                           [&](const auto& group) { return !is_readable(group, chart, field, most_bound); }),
            groups.end());
    if (machine && groups.empty())
        throw anamorph::Error("machine", thrown.machine,
                              "must have a projection plane that the panorama covers");
    if (machine) make_bumps();
}

/// Residuals in texture coordinates, as bump maps have them.
void PreparedPanorama::make_bumps() {
    const double width = chart.width(), height = chart.height();
    for (const anamorph::ProjectionGroup& group : groups) {
        anamorph::machine::BumpTexels residuals;
        residuals.reserve(group.residuals.size());
        for (const auto& r : group.residuals) residuals.push_back({r[0] / width, r[1] / height});
        bumps.push_back(anamorph::machine::bump_table(residuals, machine->texel, machine->scaled));
        const auto error =
            anamorph::machine::reading_error(residuals, bumps.back(), field.columns, machine->weight_bits);
        bump_error = std::max(bump_error, std::hypot(error[0] * width, error[1] * height));
    }
}

double PreparedPanorama::bound() const {
    double most = 0;
    for (const anamorph::ProjectionGroup& group : groups) most = std::max(most, group.bound);
    return most + bump_error;
}

ProjectionText projection_text(const PreparedPanoramas& panoramas, const std::vector<bool>& rays, bool hide) {
    ProjectionText text;
    text.fragment_functions = anamorph::panorama_glsl_prelude();
    text.fragment_code = "  vec4 anamorphSum = vec4(0.0);\n  float anamorphAll = 0.0;\n";
    for (std::size_t i = 0; i < panoramas.size(); ++i) {
        const std::string to_fragments = ray_name(i, "VS"), from_geometry = ray_name(i, "GS");
        text.vertex_declarations += "out vec3 " + to_fragments + ";\n";
        text.vertex_code +=
            "  " + to_fragments + " = (" + matrix_name(i) + " * gl_Position).xyz + " + origin_name(i) + ";\n";
        text.geometry_declarations += "in vec3 " + to_fragments + "[];\nout vec3 " + from_geometry + ";\n";
        text.geometry_code += "  " + from_geometry + " = " + to_fragments + "[i];\n";
        text.fragment_declarations += "in vec3 " + to_fragments + ";\n";
        text.fragment_functions += functions(*panoramas[i], rays[i], i);
        text.fragment_code += fragment_code(i, panoramas.size() == 1, panoramas[i]->thrown.shadow_size > 0);
    }
    text.fragment_code += "  if (anamorphAll > 0.0) gl_FragData[0] *= anamorphSum / anamorphAll;\n";
    if (hide) text.fragment_code += "  else discard;\n";
    return text;
}

std::string plane_text(const PreparedPanorama& panorama) {
    const std::string text = R"(//VTK::System::Dec
in vec2 texCoord;
//VTK::Output::Dec
uniform sampler2D anamorphPanorama#;
)" + std::string(anamorph::panorama_glsl_prelude()) +
                             panorama_glsl(panorama.chart, numbered("Thrown", 0)) + read_function(panorama) +
                             fade_function(panorama) + direct_function() + group_function(panorama) + R"(
void main() {
  float row = texCoord.y * anamorphCount#;
  int g = int(min(row, anamorphCount# - 0.5));
  vec2 place = (vec2(texCoord.x, row - float(g)) * 2.0 - 1.0) * anamorphField#;
  mat3 axes = anamorphAxes#[g];
  vec2 texel = 2.0 * anamorphField# / )" +
                             written(panorama.thrown.plane_size) + R"(;
  vec3 r = axes[0] * place.x + axes[1] * place.y + axes[2];
  vec4 colour;
  float part;
  bool seen = anamorphPaint#(r, axes[0] * texel.x, axes[1] * texel.y, colour, part);
  gl_FragData[0] = seen ? vec4(colour.rgb * part, part) : vec4(0.0);
}
)";
    return with_number(text, 0);
}

}  // namespace anamorph_vtk
