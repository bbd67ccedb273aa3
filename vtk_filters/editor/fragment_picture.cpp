// SPDX-License-Identifier: Apache-2.0
#include "fragment_picture.h"

#include <vtkCellArray.h>
#include <vtkDataObject.h>
#include <vtkFloatArray.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkShaderProperty.h>
#include <vtkUniforms.h>

#include <algorithm>

#include "anamorph/mesh/mesh_glsl.h"
#include "anamorph/morph/feature_glsl.h"
#include "anamorph/number/glsl_number.h"
#include "anamorph/operation/morph.h"
#include "anamorph/operation/warp.h"
#include "card_texels.h"
#include "shown.h"

namespace anamorph_editor {

using anamorph::Box;
using anamorph::Filter;
using anamorph::Size;
using anamorph::Wrap;
using anamorph_viewer::refuse_card;

namespace {

constexpr const char* kPosition = "//VTK::PositionVC::Dec";
constexpr const char* kPositionImpl = "//VTK::PositionVC::Impl";
constexpr const char* kTextureDec = "//VTK::TCoord::Dec";
constexpr const char* kTextureImpl = "//VTK::TCoord::Impl";
constexpr const char* kLast = "//VTK::DepthPeeling::Impl";
constexpr const char* kCorner = "anamorphCorner";
constexpr const char* kPane = "anamorphPane";
constexpr const char* kScale = "anamorphScale";
constexpr const char* kWeight = "anamorphWeight";
constexpr const char* kSecond = "anamorphSecond";
constexpr const char* kImageNames[] = {"anamorphImageA", "anamorphImageB"};
/// Vectors of a cell: eight of its patch, its parameters, its first pixel.
constexpr int kCellVectors = 10;

std::string cell_name(int k, bool in_fragment) {
    return "anamorphCell" + std::to_string(k) + (in_fragment ? "Out" : "");
}
std::string whole(int number) {
    return std::to_string(number);
}

/// The drawn pixel that a fragment lies in. anamorphPane: the left and lower edge of the pane in the window, its height, and the pixels
/// of the window that a drawn one is wide; anamorphCorner: the drawn pixel in the pane's upper left corner.
constexpr const char* kPixel = R"(
  vec2 anamorphInPane = floor(gl_FragCoord.xy - anamorphPane.xy);
  anamorphInPane.y = anamorphPane.z - 1.0 - anamorphInPane.y;
  vec2 anamorphPixel = anamorphCorner + floor((anamorphInPane + 0.5) / anamorphPane.w);
)";

/// The texel that stands at a place beyond an image's edges, as Border::resolve() has it.
std::string texel_function(const std::string& image, const Size& size, Wrap wrap) {
    std::string text = "vec3 " + image + "Texel(ivec2 at) {\n  ivec2 size = ivec2(" + whole(size.width) +
                       ", " + whole(size.height) + ");\n";
    if (wrap == Wrap::clamp) text += "  at = clamp(at, ivec2(0), size - 1);\n";
    if (wrap == Wrap::periodic) text += "  at = at - size * ivec2(floor(vec2(at) / vec2(size)));\n";
    if (wrap == Wrap::mirror)
        text +=
            "  at = at - 2 * size * ivec2(floor(vec2(at) / vec2(2 * size)));\n"
            "  at = min(at, 2 * size - 1 - at);\n";
    // Also what rounding of the quotients left beyond.
    text +=
        "  bool none = any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size));\n"
        "  at = clamp(at, ivec2(0), size - 1);\n  vec3 color = texelFetch(" +
        image + ", ivec2(at.x, size.y - 1 - at.y), 0).rgb;\n  return ";
    return text + (wrap == Wrap::black ? "none ? vec3(0.0) : " : "") + "color;\n}\n";
}

/// Reads an image at a place in its texels; `alongX` and `alongY` lead to the next fragments.
std::string read_function(const std::string& image, const Size& size, Filter filter, Wrap wrap) {
    const std::string begin = "vec3 " + image + "Read(vec2 at, vec2 alongX, vec2 alongY) {\n";
    const std::string limits = wrap == Wrap::periodic || wrap == Wrap::mirror
                                   ? ""
                                   : "  at = clamp(at, vec2(-4.0), vec2(" + whole(size.width + 4) + ", " +
                                         whole(size.height + 4) + "));\n";
    if (anamorph::averages(filter))
        return begin + "  vec2 size = vec2(" + whole(size.width) + ", " + whole(size.height) +
               "), flip = vec2(1.0, -1.0);\n  return textureGrad(" + image +
               ", vec2(at.x, size.y - at.y) / size, flip * alongX / size, flip * alongY / size).rgb;\n}\n";
    if (filter == Filter::nearest)
        return texel_function(image, size, wrap) + begin + limits + "  return " + image +
               "Texel(ivec2(floor(at)));\n}\n";
    return texel_function(image, size, wrap) + begin + limits +
           "  at -= 0.5;\n  vec2 first = floor(at), part = at - first;\n  ivec2 i = ivec2(first);\n"
           "  vec3 upper = mix(" +
           image + "Texel(i), " + image + "Texel(i + ivec2(1, 0)), part.x);\n  vec3 lower = mix(" + image +
           "Texel(i + ivec2(0, 1)), " + image +
           "Texel(i + ivec2(1, 1)), part.x);\n  return mix(upper, lower, part.y);\n}\n";
}

/// The source point of a fragment, by `call` with `#` for the pixel, and its differences to those of the next pixels, where they are
/// read. Where pixels of the window show the same drawn one, these are not the next fragments'. A shader has no more of it than is needed:
/// software renderers run through both sides of a branch.
std::string point_code(const std::string& type, const std::string& call, bool averages, bool magnified) {
    const auto at = [&](const char* pixel) {
        std::string text = call;
        text.replace(text.find('#'), 1, pixel);
        return text;
    };
    const std::string none = type + "(0.0)";
    const std::string along_x = !averages   ? none
                                : magnified ? at("anamorphPixel + vec2(1.0, 0.0)") + " - anamorphAt"
                                            : "dFdx(anamorphAt)",
                      along_y = !averages   ? none
                                : magnified ? at("anamorphPixel + vec2(0.0, 1.0)") + " - anamorphAt"
                                            : "-dFdy(anamorphAt)";
    return "  " + type + " anamorphAt = " + at("anamorphPixel") + ", anamorphX = " + along_x +
           ", anamorphY = " + along_y + ";\n";
}

/// How a recipe reads its images, and that a card does so.
struct Reading {
    Filter filter;
    Wrap wrap;
};

void check_output(anamorph::Output output, bool other) {
    if (output != anamorph::Output::color || other) refuse_card("another output than color");
}

Reading warp_reading(const DrawnRecipe& recipe) {
    const anamorph::WarpRequest request =
        anamorph::read_warp_request(recipe.values(), recipe.image(0).size());
    const anamorph::MeshWarpOptions& options = request.options;
    check_output(options.output, options.folds || options.draws_mesh);
    if (request.machine) refuse_card("scheme=hardware");
    if (options.scheme == anamorph::WarpScheme::residual) refuse_card("scheme=residual");
    return {options.filter, options.wrap == Wrap::automatic ? Wrap::black : options.wrap};
}

Reading morph_reading(const DrawnRecipe& recipe) {
    const anamorph::MorphRequest request =
        anamorph::read_morph_request(recipe.values(), {recipe.image(0).size(), recipe.image(1).size()});
    check_output(request.options.output, request.options.lines || request.options.picture);
    if (request.machine) refuse_card("scheme=hardware");
    return {request.options.filter,
            request.options.wrap == Wrap::automatic ? Wrap::clamp : request.options.wrap};
}

Reading reading_of(const DrawnRecipe& recipe) {
    const Reading reading = recipe.images() == 1 ? warp_reading(recipe) : morph_reading(recipe);
    if (reading.filter != Filter::nearest && reading.filter != Filter::bilinear &&
        !anamorph::averages(reading.filter))
        refuse_card("by filters other than nearest, bilinear and those that average");
    return reading;
}

int texture_wrap(Wrap wrap) {
    return wrap == Wrap::clamp      ? vtkTexture::ClampToEdge
           : wrap == Wrap::periodic ? vtkTexture::Repeat
           : wrap == Wrap::mirror   ? vtkTexture::MirroredRepeat
                                    : vtkTexture::ClampToBorder;
}

}  // namespace

FragmentPicture::FragmentPicture(Pane& pane, const DrawnRecipe& recipe) : m_pane(pane) {
    const Reading reading = reading_of(recipe);
    m_filter = reading.filter;
    m_wrap = reading.wrap;
    load(recipe);
    m_mapper->SetInputData(m_data);
    m_actor->SetMapper(m_mapper);
    m_actor->GetProperty()->LightingOff();
    // It always fills its pane, whatever the camera, which has nothing else to show.
    m_actor->UseBoundsOff();
    m_pane.renderer()->AddActor(m_actor);
}

FragmentPicture::~FragmentPicture() {
    m_pane.renderer()->RemoveActor(m_actor);
}

void FragmentPicture::load(const DrawnRecipe& recipe) {
    const bool bytes = recipe.type() == anamorph::PixelType::uint8;
    for (std::size_t i = 0; i < recipe.images(); ++i) {
        const anamorph_viewer::CardTexels texels = anamorph_viewer::card_texels(recipe.stack(i));
        m_images.push_back(recipe.image(i).size());
        m_texels.push_back(texels.size);
        vtkTexture* const texture = m_textures[i];
        texture->SetInputData(anamorph_viewer::card_image(texels, bytes ? VTK_UNSIGNED_CHAR : VTK_FLOAT));
        texture->SetColorModeToDirectScalars();
        texture->SetInterpolate(anamorph::averages(m_filter));
        texture->SetMipmap(anamorph::averages(m_filter));
        // Mesa's software renderer takes no gradients where it filters so.
        texture->SetMaximumAnisotropicFiltering(1);
        texture->SetWrap(texture_wrap(m_wrap));
        m_actor->GetProperty()->SetTexture(kImageNames[i], texture);
    }
    const float shown[] = {recipe.is_hdr() ? 1.0F : 0.0F, 1.0F};
    m_actor->GetShaderProperty()->GetFragmentCustomUniforms()->SetUniform2f(anamorph_viewer::kShownGain,
                                                                            shown);
}

void FragmentPicture::set_shaders(const std::string& vertex_declarations, const std::string& vertex_code,
                                  const std::string& fragment_declarations, const std::string& functions,
                                  const std::string& code) {
    const std::string all = vertex_declarations + fragment_declarations + functions + code;
    if (all == m_shaders) return;
    m_shaders = all;
    vtkShaderProperty* const shaders = m_actor->GetShaderProperty();
    shaders->ClearAllShaderReplacements();
    std::string read;
    for (std::size_t i = 0; i < m_texels.size(); ++i)
        read += read_function(kImageNames[i], m_texels[i], m_filter, m_wrap);
    const auto after = [](const char* tag, const std::string& text) {
        return std::string(tag) + "\n" + text;
    };
    shaders->AddVertexShaderReplacement(
        kPosition, true, after(kPosition, "in vec4 anamorphPlace;\n" + vertex_declarations), false);
    shaders->AddVertexShaderReplacement(
        kPositionImpl, true, after(kPositionImpl, vertex_code + "  gl_Position = anamorphPlace;\n"), false);
    shaders->AddFragmentShaderReplacement(kPosition, true, after(kPosition, fragment_declarations), false);
    shaders->AddFragmentShaderReplacement(kTextureDec, true, after(kTextureDec, read + functions), false);
    shaders->AddFragmentShaderReplacement(kTextureImpl, true, kPixel + code, false);
    shaders->AddFragmentShaderReplacement(kLast, true, std::string(anamorph_viewer::shown_glsl()) + kLast,
                                          false);
}

void FragmentPicture::set_frame() {
    vtkRenderer* const renderer = m_pane.renderer();
    const int *const corner = renderer->GetOrigin(), *const size = renderer->GetSize();
    const float pane[] = {float(corner[0]), float(corner[1]), float(size[1]), float(m_pane.magnified())};
    const float first[] = {float(m_pane.first_pixel()[0]), float(m_pane.first_pixel()[1])};
    vtkUniforms* const uniforms = m_actor->GetShaderProperty()->GetFragmentCustomUniforms();
    uniforms->SetUniform4f(kPane, pane);
    uniforms->SetUniform2f(kCorner, first);
}

void FragmentPicture::set_rectangles(const Rectangles& rectangles) {
    const int* const size = m_pane.renderer()->GetSize();
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> cells;
    vtkNew<vtkFloatArray> places;
    places->SetName("anamorphPlace");
    places->SetNumberOfComponents(4);
    std::vector<std::size_t> shown;
    for (std::size_t i = 0; i < rectangles.boxes.size(); ++i) {
        const Box box = anamorph::intersection(rectangles.boxes[i], m_pane.pixels().box);
        if (box.empty()) continue;
        shown.push_back(i);
        cells->InsertNextCell(4);
        for (const auto& [x, y] :
             {std::pair(box.x0, box.y1), {box.x1, box.y1}, {box.x1, box.y0}, {box.x0, box.y0}}) {
            const double across = 2.0 * (x - m_pane.first_pixel()[0]) * m_pane.magnified() / size[0] - 1,
                         down = 2.0 * (y - m_pane.first_pixel()[1]) * m_pane.magnified() / size[1] - 1;
            cells->InsertCellPoint(points->InsertNextPoint(across, -down, 0));
            places->InsertNextTuple4(across, -down, 0, 1);
        }
    }
    m_data->SetPoints(points);
    m_data->SetPolys(cells);
    m_data->GetPointData()->Initialize();
    m_data->GetPointData()->AddArray(places);
    m_mapper->RemoveAllVertexAttributeMappings();
    const auto map = [&](const char* name) {
        m_mapper->MapDataArrayToVertexAttribute(name, name, vtkDataObject::FIELD_ASSOCIATION_POINTS, -1);
    };
    map("anamorphPlace");
    for (const auto& [name, vectors] : rectangles.arrays) {
        vtkNew<vtkFloatArray> array;
        array->SetName(name.c_str());
        array->SetNumberOfComponents(4);
        for (const std::size_t i : shown)
            for (int corner = 0; corner < 4; ++corner) array->InsertNextTypedTuple(vectors[i].data());
        m_data->GetPointData()->AddArray(array);
        map(name.c_str());
    }
    m_data->Modified();
}

void FragmentPicture::draw(const anamorph::Mesh& mesh) {
    Rectangles rectangles;
    for (int k = 0; k < kCellVectors; ++k) rectangles.arrays.push_back({cell_name(k, false), {}});
    for (const anamorph::CellFragments& cell : anamorph::cell_fragments(mesh)) {
        rectangles.boxes.push_back(cell.pixels);
        for (std::size_t k = 0; k < 8; ++k)
            rectangles.arrays[k].second.push_back(
                {cell.patch[4 * k], cell.patch[4 * k + 1], cell.patch[4 * k + 2], cell.patch[4 * k + 3]});
        rectangles.arrays[8].second.push_back(cell.parameters);
        rectangles.arrays[9].second.push_back({float(cell.pixels.x0), float(cell.pixels.y0), 0, 0});
    }
    set_rectangles(rectangles);
    std::string declared, written, read, patch;
    for (int k = 0; k < kCellVectors; ++k) {
        const std::string in = cell_name(k, false), out = cell_name(k, true);
        declared += "in vec4 " + in + ";\nflat out vec4 " + out + ";\n";
        written += "  " + out + " = " + in + ";\n";
        read += "flat in vec4 " + out + ";\n";
        if (k < 8) patch += (k ? ", " : "") + out;
    }
    const bool averages = anamorph::averages(m_filter), magnified = m_pane.magnified() > 1;
    const std::string point = "anamorphWarp(vec4[8](" + patch + "), " + cell_name(8, true) + ", " +
                              cell_name(9, true) + ".xy, anamorphScale, #)";
    const anamorph::GlslNumber x(double(m_texels[0].width) / m_images[0].width),
        y(double(m_texels[0].height) / m_images[0].height);
    set_shaders(declared, written, read, anamorph::mesh_glsl("anamorphWarp"),
                point_code("vec2", point, averages, magnified) + "  vec2 anamorphLevel = vec2(" +
                    x.written() + ", " + y.written() +
                    ");\n  gl_FragData[0] = vec4(anamorphImageARead(anamorphAt * anamorphLevel, anamorphX * "
                    "anamorphLevel, anamorphY * anamorphLevel), 1.0);\n");
    set_frame();
    const float scale[] = {float(mesh.scale().x), float(mesh.scale().y)};
    m_actor->GetShaderProperty()->GetFragmentCustomUniforms()->SetUniform2f(kScale, scale);
    m_bound = anamorph::mesh_glsl_bound(mesh);
}

void FragmentPicture::draw(const anamorph::FeatureMap& map, double second, bool is_quick) {
    const std::vector<std::array<float, 4>> lines = anamorph::line_uniforms(map, {0, 1});
    set_rectangles({{{0, 0, map.target().width, map.target().height}}, {}});
    const double exponent = anamorph::own_exponent(map.weights().b);
    const bool averages = anamorph::averages(m_filter), magnified = m_pane.magnified() > 1;
    std::string levels;
    for (std::size_t i = 0; i < 2; ++i)
        for (const double of :
             {double(m_texels[i].width) / m_images[i].width, double(m_texels[i].height) / m_images[i].height})
            levels += (levels.empty() ? "" : ", ") + anamorph::GlslNumber(of).written();
    set_shaders(
        "", "", "", anamorph::feature_glsl("anamorphMorph", map.size(), exponent),
        point_code("vec4", "anamorphMorph(# + 0.5, anamorphWeight, anamorphScale)", averages, magnified) +
            "  vec4 anamorphLevel = vec4(" + levels +
            ");\n  anamorphAt *= anamorphLevel;\n  anamorphX *= anamorphLevel;\n  anamorphY *= "
            "anamorphLevel;\n  gl_FragData[0] = vec4(mix(anamorphImageARead(anamorphAt.xy, anamorphX.xy, "
            "anamorphY.xy), anamorphImageBRead(anamorphAt.zw, anamorphX.zw, anamorphY.zw), "
            "anamorphSecond), 1.0);\n");
    set_frame();
    vtkUniforms* const uniforms = m_actor->GetShaderProperty()->GetFragmentCustomUniforms();
    const float scale[] = {float(map.scale(0).x), float(map.scale(0).y), float(map.scale(1).x),
                           float(map.scale(1).y)};
    const float weight[] = {float(map.weights().a), float(map.weights().b)};
    uniforms->SetUniform4f(kScale, scale);
    uniforms->SetUniform2f(kWeight, weight);
    uniforms->SetUniformf(kSecond, float(second));
    uniforms->SetUniform4fv("anamorphMorphLines", static_cast<int>(lines.size()),
                            reinterpret_cast<const float(*)[4]>(lines.data()));
    constexpr std::size_t kQuick = 64, kStill = 2048;
    m_bound = anamorph::feature_glsl_bound(map, {0, 1}, is_quick ? kQuick : kStill);
}

}  // namespace anamorph_editor
