// SPDX-License-Identifier: Apache-2.0
#include "card_view.h"

#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkDataObject.h>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkShaderProperty.h>
#include <vtkUniforms.h>

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <numbers>

#include "anamorph/number/glsl_number.h"
#include "anamorph/projector/concentric_glsl.h"
#include "anamorph/projector/panorama_glsl.h"
#include "shown.h"

namespace anamorph_viewer {
namespace {

constexpr double kRadians = std::numbers::pi / 180;
/// A corner that lies flatter along the projection plane is too far away.
constexpr double kLeastAhead = 0.05;
constexpr const char* kPosition = "//VTK::PositionVC::Dec";
constexpr const char* kPositionImpl = "//VTK::PositionVC::Impl";
constexpr const char* kTextureDec = "//VTK::TCoord::Dec";
constexpr const char* kTextureImpl = "//VTK::TCoord::Impl";
constexpr const char* kLast = "//VTK::DepthPeeling::Impl";
constexpr const char* kPlace = "anamorphPlace";
constexpr const char* kViewpoint = "anamorphViewpoint";

/// From the core's frame of rays, y downwards and z forward, to VTK's, and back.
glm::dvec3 turned_over(const glm::dvec3& ray) {
    return {ray.x, -ray.y, -ray.z};
}

/// In the frame of rays: turns azimuths to the right.
glm::dmat3 turn_about_y(double azimuth) {
    const double c = std::cos(azimuth), s = std::sin(azimuth);
    return {{c, 0, -s}, {0, 1, 0}, {s, 0, c}};
}

/// Reads the residual, then the picture: rows beyond its border show nothing, and the last ones are not mixed with the first.
std::string reading_code(const anamorph::Chart& chart) {
    const auto number = [](double value) { return "float(" + std::to_string(value) + ")"; };
    const std::string half_row = number(0.5 / chart.height()), half_column = number(0.5 / chart.width());
    return "  vec2 anamorphAt = anamorphPlaceVSOutput.xy + textureLod(anamorphResiduals, "
           "anamorphPlaceVSOutput.zw, 0.0).rg;\n"
           "  bool anamorphSeen = anamorphAt.y >= 0.0 && anamorphAt.y <= 1.0" +
           std::string(chart.closed() ? "" : " && anamorphAt.x >= 0.0 && anamorphAt.x <= 1.0") +
           ";\n  vec2 anamorphX = dFdx(anamorphAt), anamorphY = dFdy(anamorphAt);\n"
           "  anamorphAt.y = clamp(anamorphAt.y, " +
           half_row + ", 1.0 - " + half_row + ");\n" +
           (chart.closed()
                ? ""
                : "  anamorphAt.x = clamp(anamorphAt.x, " + half_column + ", 1.0 - " + half_column + ");\n") +
           "  vec4 anamorphRead = textureGrad(anamorphPicture, anamorphAt, anamorphX, anamorphY);\n"
           "  gl_FragData[0] = anamorphSeen ? vec4(anamorphRead.rgb, 1.0) : vec4(0.0, 0.0, 0.0, 1.0);\n";
}

/// Of a line of sight the two circles beside it, each by its own texel; the panoramas stand one above the other.
std::string circles_code(const anamorph::Chart& chart, const anamorph::ConcentricStack& stack) {
    const auto number = [](double value) { return anamorph::GlslNumber(value).written(); };
    return "  vec3 anamorphRay = anamorphPlaceVSOutput.xyz, anamorphSum = vec3(0.0);\n"
           "  anamorphRay /= max(max(abs(anamorphRay.x), abs(anamorphRay.y)), abs(anamorphRay.z));\n"
           // Straight up or down there is no horizontal direction.
           "  if (dot(anamorphRay.xz, anamorphRay.xz) < 1e-12) anamorphRay.x = 1e-6;\n"
           "  float anamorphWeight;\n  float anamorphFirst = "
           "anamorphSlitFirst(anamorphSlitOffset(anamorphRay, "
           "anamorphViewpoint), anamorphWeight);\n  for (int i = 0; i < " +
           std::to_string(std::min(stack.circles, 2)) +
           "; ++i) {\n    float circle = anamorphFirst + float(i);\n    vec2 size = vec2(" +
           number(chart.width()) + ", " + number(chart.height()) +
           ");\n    vec2 at = anamorphSlitTexel(anamorphRay, anamorphViewpoint, anamorphSlitRadius(circle) "
           "* " +
           number(1 / stack.depth) +
           ");\n    bool seen = at.y >= 0.0 && at.y <= size.y;\n    at.y = clamp(at.y, 0.5, size.y - 0.5) + "
           "circle * size.y;\n    at /= size * vec2(1.0, " +
           number(stack.circles) +
           ");\n    vec3 column = textureLod(anamorphPicture, vec2(at.x, 1.0 - at.y), 0.0).rgb;\n"
           "    if (seen) anamorphSum += (i == 0 ? 1.0 - anamorphWeight : anamorphWeight) * column;\n  }\n"
           "  gl_FragData[0] = vec4(anamorphSum, 1.0);\n";
}

vtkSmartPointer<vtkImageData> image_of(int width, int height, int channels) {
    const auto image = vtkSmartPointer<vtkImageData>::New();
    image->SetDimensions(width, height, 1);
    image->AllocateScalars(VTK_FLOAT, channels);
    return image;
}

}  // namespace

CardView::CardView(const ViewedPanorama& panorama) : CardView(panorama.card_picture(), panorama.is_hdr()) {}

CardView::CardView(const CardPicture& picture, bool hdr)
    : m_chart(picture.chart), m_held(anamorph::rotation(picture.held)), m_hdr(hdr), m_stack(picture.stack) {
    set_picture(picture);
    m_mapper->SetInputData(m_mesh);
    m_actor->SetMapper(m_mapper);
    m_actor->GetProperty()->LightingOff();
    m_projector->SetPanorama(m_texture);
    m_projector->SetProjection(static_cast<int>(m_chart.projection()));
    m_projector->SetFieldOfView(m_chart.fov());
    m_projector->SetVerticalFieldOfView(m_chart.vertical().fov);
    m_projector->SetPanniniDistance(m_chart.distance().d);
    m_projector->SetProjectionAlpha(m_chart.distance().e);
    m_projector->SetLens(m_chart.lens() ? m_chart.lens()->model().text().c_str() : nullptr);
    m_projector->SetOrientation(picture.held.yaw, picture.held.pitch, picture.held.roll);
    m_shader->AddProjector(m_projector);
    m_shader->HideUnpaintedOn();
    vtkShaderProperty* shaders = m_actor->GetShaderProperty();
    shaders->AddFragmentShaderReplacement(kLast, true, std::string(shown_glsl()) + kLast, false);
}

void CardView::set_picture(const CardPicture& picture) {
    m_texture->SetInputData(card_image(picture.texels, VTK_FLOAT));
    for (vtkTexture* texture : {m_texture.Get(), m_residuals.Get()}) {
        texture->SetColorModeToDirectScalars();
        texture->InterpolateOn();
    }
    m_texture->SetMipmap(!m_stack);  // levels would mix circles
    m_texture->RepeatOn();
    m_residuals->RepeatOff();
    m_residuals->EdgeClampOn();
}

bool CardView::look(const View& view, const anamorph::Size& size, bool per_vertex, double gain,
                    vtkRenderer* renderer, const glm::dvec2& viewpoint) {
    const glm::dmat3 turn = anamorph::rotation({view.yaw, view.pitch, 0});
    const double across = std::tan(view.fov / 2 * kRadians), down = across * size.height / size.width;
    vtkCamera* camera = renderer->GetActiveCamera();
    const glm::dvec3 ahead = turned_over(turn[2]), up = turned_over(-turn[1]);
    camera->SetPosition(0, 0, 0);
    camera->SetFocalPoint(ahead.x, ahead.y, ahead.z);
    camera->SetViewUp(up.x, up.y, up.z);
    camera->SetViewAngle(2 * std::atan(down) / kRadians);
    camera->SetClippingRange(0.1, 1000);
    // A little more than the window, so that it is covered to its last pixel.
    Corners rays;
    for (std::size_t k = 0; k < 4; ++k)
        rays[k] =
            turn * glm::dvec3((k == 0 || k == 3 ? -1.01 : 1.01) * across, (k < 2 ? 1.01 : -1.01) * down, 1);
    set_gain(gain);
    if (m_stack) {
        set_rectangle(rays);
        be_of_circles();
        const float at[] = {static_cast<float>(viewpoint.x), static_cast<float>(viewpoint.y)};
        m_actor->GetShaderProperty()->GetFragmentCustomUniforms()->SetUniform2f(kViewpoint, at);
        return false;
    }
    const bool has_trapezoid = per_vertex && set_trapezoid(rays, turn[2]);
    if (!has_trapezoid) {
        m_bound = 0;
        set_rectangle(rays);
    }
    be_per_vertex(has_trapezoid);
    return has_trapezoid;
}

void CardView::set_rectangle(const Corners& rays) {
    Corners points;
    std::array<std::array<double, 4>, 4> places{};
    for (std::size_t k = 0; k < 4; ++k) {
        points[k] = turned_over(rays[k]);
        places[k] = {rays[k].x, rays[k].y, rays[k].z, 0};
    }
    set_corners(points, places);
}

/// Section 4.5.1.
bool CardView::set_trapezoid(const Corners& rays, const glm::dvec3& ahead) {
    if (m_chart.pieces().size() > 1) return false;
    const glm::dmat3 to_panorama = glm::transpose(m_held);
    const glm::dvec3 middle = to_panorama * ahead;
    if (!(std::hypot(middle.x, middle.z) > 1e-6)) return false;
    const double azimuth = std::atan2(middle.x, middle.z);
    const glm::dvec3 d(std::sin(azimuth), 0, std::cos(azimuth)), e(d.z, 0, -d.x);
    anamorph::GroupOptions field;
    field.x_max = field.y_max = 0;
    std::array<glm::dvec2, 4> at;
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec3 ray = to_panorama * rays[k];
        const double forward = glm::dot(ray, d);
        if (!(forward > kLeastAhead * glm::length(ray))) return false;
        at[k] = {glm::dot(ray, e) / forward, ray.y / forward};
        field.x_max = std::max(field.x_max, std::fabs(at[k].x));
        field.y_max = std::max(field.y_max, std::fabs(at[k].y));
    }
    const anamorph::ProjectionGroup& group = group_of(azimuth, field);
    if (!(group.bound <= kMostError)) return false;
    Corners points;
    std::array<std::array<double, 4>, 4> places;
    for (std::size_t k = 0; k < 4; ++k) {
        const glm::dvec3 on_plane = d + e * at[k].x + glm::dvec3(0, at[k].y, 0);
        const glm::dvec3 linear = group.linear * on_plane;
        const auto node = [](double x, double most, int count) {
            return ((x / most + 1) / 2 * (count - 1) + 0.5) / count;
        };
        points[k] = turned_over(m_held * on_plane);
        places[k] = {linear.x / linear.z / m_chart.width(), 1 - linear.y / linear.z / m_chart.height(),
                     node(at[k].x, m_field.x_max, m_field.columns),
                     node(at[k].y, m_field.y_max, m_field.rows)};
    }
    set_corners(points, places);
    m_bound = group.bound;
    return true;
}

/// A table serves until the view no longer fits in it, or it is much too large; and, where azimuths are counted, for all
/// directions: only its linear part goes along.
const anamorph::ProjectionGroup& CardView::group_of(double azimuth, const anamorph::GroupOptions& field) {
    const auto fits = [](double most, double asked) { return asked <= most && most <= 2 * asked; };
    const bool known = m_group && fits(m_field.x_max, field.x_max) && fits(m_field.y_max, field.y_max);
    const bool same_everywhere = m_chart.counted() == anamorph::Counted::azimuth && m_chart.closed();
    if (known && azimuth == m_azimuth) return *m_group;
    if (known && same_everywhere) {
        // linear.x is texel x times r . d: the third row of the sum is r . d, that is d.
        const double texels = (azimuth - m_azimuth) / (2 * std::numbers::pi) * m_chart.period();
        glm::dmat3& linear = m_group->linear;
        linear = linear * turn_about_y(m_azimuth - azimuth);
        for (int c = 0; c < 3; ++c) linear[c][0] += texels * linear[c][2];
    } else {
        m_field = field;
        m_field.x_max *= 1.25;
        m_field.y_max *= 1.25;
        const glm::dvec3 d(std::sin(azimuth), 0, std::cos(azimuth));
        m_group = anamorph::ProjectionGroups(anamorph::Projector(m_chart), {d}, m_field).groups().front();
        set_residuals();
    }
    m_azimuth = azimuth;
    return *m_group;
}

void CardView::set_residuals() {
    const auto image = image_of(m_field.columns, m_field.rows, 3);
    auto* to = static_cast<float*>(image->GetScalarPointer());
    for (const std::array<float, 2>& r : m_group->residuals) {
        *to++ = r[0] / static_cast<float>(m_chart.width());
        *to++ = -r[1] / static_cast<float>(m_chart.height());
        *to++ = 0;
    }
    m_residuals->SetInputData(image);
}

void CardView::set_corners(const Corners& points, const std::array<std::array<double, 4>, 4>& places) {
    vtkNew<vtkPoints> corners;
    vtkNew<vtkFloatArray> coordinates;
    vtkNew<vtkCellArray> cells;
    coordinates->SetName(kPlace);
    coordinates->SetNumberOfComponents(4);
    for (std::size_t k = 0; k < 4; ++k) {
        corners->InsertNextPoint(points[k].x, points[k].y, points[k].z);
        coordinates->InsertNextTuple(places[k].data());
    }
    const vtkIdType ids[] = {0, 1, 2, 3};
    cells->InsertNextCell(4, ids);
    m_mesh->SetPoints(corners);
    m_mesh->SetPolys(cells);
    m_mesh->GetPointData()->Initialize();
    m_mesh->GetPointData()->AddArray(coordinates);
    m_mesh->Modified();
}

void CardView::be_per_vertex(bool per_vertex) {
    if (m_per_vertex == per_vertex) return;
    m_per_vertex = per_vertex;
    vtkShaderProperty* shaders = m_actor->GetShaderProperty();
    vtkProperty* property = m_actor->GetProperty();
    if (!per_vertex) {
        m_mapper->RemoveAllVertexAttributeMappings();
        shaders->ClearVertexShaderReplacement(kPosition, true);
        shaders->ClearVertexShaderReplacement(kPositionImpl, true);
        shaders->ClearFragmentShaderReplacement(kPosition, true);
        shaders->ClearFragmentShaderReplacement(kTextureImpl, true);
        property->RemoveAllTextures();
        m_shader->AddTo(m_actor);
        return;
    }
    m_shader->RemoveFrom(m_actor);
    property->SetTexture("anamorphPicture", m_texture);
    property->SetTexture("anamorphResiduals", m_residuals);
    map_places("", reading_code(m_chart));
}

void CardView::be_of_circles() {
    if (m_per_vertex) return;
    m_per_vertex = false;
    m_actor->GetProperty()->SetTexture("anamorphPicture", m_texture);
    map_places(std::string(anamorph::panorama_glsl_prelude()) +
                   anamorph::concentric_glsl(m_chart, *m_stack, "anamorphSlit"),
               circles_code(m_chart, *m_stack));
}

/// Hands the places of corners to fragments, whose colours `code` finds.
void CardView::map_places(const std::string& functions, const std::string& code) {
    vtkShaderProperty* shaders = m_actor->GetShaderProperty();
    m_mapper->MapDataArrayToVertexAttribute(kPlace, kPlace, vtkDataObject::FIELD_ASSOCIATION_POINTS, -1);
    const auto after = [](const char* tag, const std::string& added) {
        return std::string(tag) + "\n" + added;
    };
    shaders->AddVertexShaderReplacement(
        kPosition, true, after(kPosition, "in vec4 anamorphPlace;\nout vec4 anamorphPlaceVSOutput;\n"),
        false);
    shaders->AddVertexShaderReplacement(
        kPositionImpl, true, after(kPositionImpl, "  anamorphPlaceVSOutput = anamorphPlace;\n"), false);
    shaders->AddFragmentShaderReplacement(kPosition, true,
                                          after(kPosition, "in vec4 anamorphPlaceVSOutput;\n"), false);
    if (!functions.empty())
        shaders->AddFragmentShaderReplacement(kTextureDec, true, after(kTextureDec, functions), false);
    shaders->AddFragmentShaderReplacement(kTextureImpl, true, code, false);
}

void CardView::set_gain(double gain) {
    const bool as_it_is = !m_hdr && gain == 1;
    const float values[] = {as_it_is ? 0.0F : static_cast<float>(gain), m_hdr ? 1.0F : 0.0F};
    m_actor->GetShaderProperty()->GetFragmentCustomUniforms()->SetUniform2f(kShownGain, values);
}

}  // namespace anamorph_viewer
