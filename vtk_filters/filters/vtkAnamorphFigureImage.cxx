// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphFigureImage.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/source.h"
#include "anamorph/operation/figure_look.h"
#include "anamorph/parameter/parameter.h"
#include "attribute_fields.h"
#include "drawn_image.h"
#include "execution.h"
#include "figure_data.h"
#include "figure_lines.h"
#include "image_texture.h"
#include "input_times.h"
#include "property_names.h"
#include "vtkCompositeDataSet.h"
#include "vtkFloatArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkUnsignedCharArray.h"

vtkObjectFactoryNewMacro(vtkAnamorphFigureImage);

namespace {

using anamorph::figure::FigureStyle;

constexpr int kMostSide = 1 << 16;

/// A picture with its pyramid.
struct Texture {
    anamorph_vtk::ImageTexture image;
    anamorph::MemorySource base;
    anamorph::Pyramid pyramid;

    Texture(vtkImageData* data, const std::string& name)
        : image(data, data->GetPointData()->GetScalars(), name),
          base(image.view(), anamorph_vtk::alpha_of(image.view().channels)),
          pyramid(base, 1, 1) {}
};

/// The properties that have another name than their row.
const std::map<std::string, std::string>& other_names() {
    static const std::map<std::string, std::string> names = {{"red", "SolidRed"},
                                                             {"green", "SolidGreen"},
                                                             {"blue", "SolidBlue"},
                                                             {"let", "SolidDefinitions"},
                                                             {"outline_tol", "OutlineTolerance"}};
    return names;
}

/// The word of a choice of the core's table.
const std::string& word_of(const char* row, int choice) {
    for (const anamorph::Parameter& parameter : anamorph::figure_look_table())
        if (parameter.name == row) return parameter.choices[static_cast<std::size_t>(choice)];
    throw anamorph::Error(std::string("there is no row ") + row);
}

/// The strings of points; null where there are none.
vtkStringArray* strings_of(vtkPolyData* data, const char* name) {
    auto* strings = vtkStringArray::SafeDownCast(data->GetPointData()->GetAbstractArray(name));
    return strings && strings->GetNumberOfTuples() == data->GetNumberOfPoints() ? strings : nullptr;
}

/// The number of the frame that a time is; 0 where there is none.
int frame_number(vtkPolyData* data) {
    constexpr double kMost = 1e6;
    vtkInformation* information = data->GetInformation();
    if (!information->Has(vtkDataObject::DATA_TIME_STEP())) return 0;
    const double time = information->Get(vtkDataObject::DATA_TIME_STEP());
    return std::isfinite(time) ? static_cast<int>(std::lround(std::min(std::max(time, -kMost), kMost))) : 0;
}

/// The bodies of a data set as a frame, in their colors. `own_axes`: something lies on bodies by their own axes.
anamorph::figure::FigureFrame frame_of(vtkPolyData* data, const anamorph_vtk::Bodies& bodies, bool own_axes) {
    vtkStringArray *textures = strings_of(data, "Texture"), *figures = strings_of(data, "Figure");
    vtkDataArray* offsets = data->GetPointData()->GetArray("TextureOffset");
    if (offsets &&
        (offsets->GetNumberOfComponents() != 2 || offsets->GetNumberOfTuples() != data->GetNumberOfPoints()))
        offsets = nullptr;
    anamorph::figure::FigureFrame frame;
    frame.number = frame_number(data);
    std::map<std::string, int> numbers;  // of figures
    auto* colors = vtkUnsignedCharArray::SafeDownCast(data->GetPointData()->GetArray("Color"));
    if (colors &&
        (colors->GetNumberOfComponents() < 3 || colors->GetNumberOfTuples() != data->GetNumberOfPoints()))
        colors = nullptr;
    for (std::size_t i = 0; i < bodies.shapes.size(); ++i) {
        anamorph::figure::Body body;
        body.shape = bodies.shapes[i];
        body.name = bodies.names[i];
        if (colors)
            for (int c = 0; c < 3; ++c) body.color[c] = colors->GetTypedComponent(bodies.ids[i], c);
        if (textures) body.texture = textures->GetValue(bodies.ids[i]);
        if (figures) {
            const std::string figure = figures->GetValue(bodies.ids[i]);
            const auto [place, is_new] = numbers.emplace(figure, static_cast<int>(frame.figures.size()));
            if (is_new) frame.figures.push_back(figure);
            body.figure = place->second;
        }
        // What lies on bodies does in NUDES' space, where z is negated: so is their own z axis, seen from here.
        if (own_axes) body.shape.rotation[2] = -body.shape.rotation[2];
        if (offsets) offsets->GetTuple(bodies.ids[i], &body.texture_offset.x);
        frame.bodies.push_back(std::move(body));
    }
    frame.joints = bodies.joints;
    return frame;
}

/// An array of so many components, which becomes the image's scalars.
template <class Array>
Array* new_scalars(vtkImageData* image, const char* name, int components) {
    vtkNew<Array> array;
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(image->GetNumberOfPoints());
    image->GetPointData()->SetScalars(array);
    return array;
}

unsigned char byte_of(double value) {
    return static_cast<unsigned char>(std::lround(255 * std::min(std::max(value, 0.0), 1.0)));
}

/// Red, green, blue and alpha of a pixel, whose color is multiplied by its alpha.
void write_color(const float* from, unsigned char* to) {
    const double alpha = from[3];
    for (int c = 0; c < 3; ++c) to[c] = alpha > 0 ? byte_of(from[c] / alpha) : 0;
    to[3] = byte_of(alpha);
}

}  // namespace

vtkAnamorphFigureImage::vtkAnamorphFigureImage() {
    this->SetNumberOfInputPorts(2);
    const anamorph::ParameterValues defaults(anamorph::figure_look_table());
    this->SolidScale = defaults.number("solid_scale");
    this->SolidSamples = defaults.whole("solid_samples");
    this->BumpScale = defaults.number("bump_scale");
    this->OutlineTolerance = defaults.number("outline_tol");
}

vtkAnamorphFigureImage::~vtkAnamorphFigureImage() = default;

void vtkAnamorphFigureImage::AddTexture(const char* name, vtkImageData* image) {
    if (!name || !image) return;
    this->Textures.emplace_back(name, image);
    this->Modified();
}

void vtkAnamorphFigureImage::RemoveAllTextures() {
    if (this->Textures.empty()) return;
    this->Textures.clear();
    this->Modified();
}

void vtkAnamorphFigureImage::SetText(std::string& member, const char* text) {
    const std::string given = text ? text : "";
    if (given == member) return;
    member = given;
    this->Modified();
}

/// Null where there are none.
vtkImageData* vtkAnamorphFigureImage::Heights() const {
    auto* self = const_cast<vtkAnamorphFigureImage*>(this);
    return self->GetNumberOfInputConnections(1) > 0
               ? vtkImageData::SafeDownCast(self->GetInputDataObject(1, 0))
               : nullptr;
}

vtkImageData* vtkAnamorphFigureImage::GetOutput() {
    return vtkImageData::SafeDownCast(this->GetOutputDataObject(0));
}

int vtkAnamorphFigureImage::FillInputPortInformation(int port, vtkInformation* information) {
    if (port == 0) return this->Superclass::FillInputPortInformation(port, information);
    information->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
    information->Set(INPUT_IS_OPTIONAL(), 1);
    return 1;
}

int vtkAnamorphFigureImage::FillOutputPortInformation(int, vtkInformation* information) {
    information->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkImageData");
    return 1;
}

int vtkAnamorphFigureImage::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                               vtkInformationVector* outputs) {
    vtkInformation* output = outputs->GetInformationObject(0);
    anamorph_vtk::tell_times({inputs, 2}, output);
    const int extent[6] = {0, this->ViewSize[0] - 1, 0, this->ViewSize[1] - 1, 0, 0};
    output->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    const double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0};
    output->Set(vtkDataObject::SPACING(), spacing, 3);
    output->Set(vtkDataObject::ORIGIN(), origin, 3);
    output->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
    // Filters behind it make room for such numbers, as Draw() gives them.
    const bool colors = this->Style != DEPTH && this->Style != BODY_ID;
    vtkDataObject::SetPointDataActiveScalarInfo(
        output, colors ? VTK_UNSIGNED_CHAR : (this->Style == DEPTH ? VTK_FLOAT : VTK_INT), colors ? 4 : 1);
    return 1;
}

int vtkAnamorphFigureImage::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                                vtkInformationVector*) {
    // A part of the image shows all bodies that are there.
    anamorph_vtk::ask_for_all({inputs, 2});
    return 1;
}

/// The pixels that are asked for: of a collection, all.
void vtkAnamorphFigureImage::AskedExtent(int extent[6]) {
    const int whole[6] = {0, this->ViewSize[0] - 1, 0, this->ViewSize[1] - 1, 0, 0};
    std::copy_n(whole, 6, extent);
    vtkInformation* output = this->GetOutputInformation(0);
    if (vtkCompositeDataSet::SafeDownCast(this->GetInputDataObject(0, 0)) ||
        !output->Has(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT()))
        return;
    output->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT(), extent);
}

/// How the figures are drawn: textured, where the style is shaded and there are textures.
anamorph::figure::FigureLook vtkAnamorphFigureImage::GetLook() const {
    static constexpr FigureStyle kStyles[] = {FigureStyle::shaded, FigureStyle::outline, FigureStyle::stick,
                                              FigureStyle::depth, FigureStyle::id};
    using anamorph::figure::BodyMapping, anamorph::figure::Lighting;
    static constexpr Lighting kLightings[] = {Lighting::rasel, Lighting::lambert, Lighting::blinn};
    static constexpr BodyMapping kMappings[] = {BodyMapping::latlong, BodyMapping::mirrored,
                                                BodyMapping::linear, BodyMapping::octahedral};
    anamorph::figure::FigureLook look;
    look.style = kStyles[this->Style];
    look.light.lighting = kLightings[this->Lighting];
    look.light.toward = anamorph::figure::usual_light(look.light.lighting);
    look.antialias = this->Antialias;
    look.mapping = kMappings[this->TextureMapping];
    try {
        this->SetOwnLook(look);
    } catch (const anamorph::Error& error) {
        throw anamorph_vtk::of_property(error, other_names());
    }
    if (this->Style != SHADED || this->Textures.empty()) return look;
    look.style = FigureStyle::textured;
    for (const auto& texture : this->Textures) look.textures.push_back(texture.first);
    return look;
}

/// Solid textures, heights and what stands for bodies, by the core's rows. Properties that the style has no use for are checked as well.
void vtkAnamorphFigureImage::SetOwnLook(anamorph::figure::FigureLook& look) const {
    anamorph::ParameterValues all(anamorph::figure_look_table()), of_style = all;
    const auto set = [&](const char* row, const auto& value, bool is_of_style) {
        all.set(row, value);
        if (is_of_style) of_style.set(row, value);
    };
    const auto set_text = [&](const char* row, const std::string& text) {
        if (!text.empty()) set(row, text, look.style == FigureStyle::shaded && this->Solid == FORMULA);
    };
    const bool has_solid = look.style == FigureStyle::shaded && this->Solid != NONE;
    const bool has_heights = look.style == FigureStyle::shaded && this->Heights();
    const bool is_outline = look.style == FigureStyle::outline;
    set("solid", word_of("solid", this->Solid), has_solid);
    set("solid_scale", this->SolidScale, has_solid);
    set("solid_samples", static_cast<double>(this->SolidSamples), has_solid);
    set_text("red", this->SolidRed);
    set_text("green", this->SolidGreen);
    set_text("blue", this->SolidBlue);
    set_text("let", this->SolidDefinitions);
    set("bump_scale", this->BumpScale, has_heights);
    set("outlines", word_of("outlines", this->Outlines), is_outline);
    set("outline_tol", this->OutlineTolerance,
        is_outline && (this->Outlines == LEVELS || this->Outlines == CONTOURS));
    anamorph::read_figure_relief(of_style, has_heights, look);
    anamorph::read_figure_outlines(of_style, look);
}

void vtkAnamorphFigureImage::Draw(vtkPolyData* input, vtkDataObject* output,
                                  anamorph_vtk::Execution& execution) {
    anamorph::figure::View view = this->ViewOf(input);
    const int width = this->ViewSize[0], height = this->ViewSize[1];
    if (width > kMostSide || height > kMostSide)
        throw anamorph::Error("ViewSize", std::to_string(std::max(width, height)),
                              "must be an integer from 1 to " + std::to_string(kMostSide));
    view.middle += 0.5 * glm::dvec2(width, height);
    const anamorph::figure::FigureLook look = this->GetLook();
    // In the order of their names.
    std::vector<std::unique_ptr<Texture>> textures;
    std::vector<const anamorph::Source*> sources;
    for (const std::string& name : look.textures) {
        textures.push_back(std::make_unique<Texture>(this->Textures[sources.size()].second,
                                                     "texture " + anamorph::printable(name)));
        sources.push_back(&textures.back()->pyramid);
    }
    if (look.bumps) {
        textures.push_back(std::make_unique<Texture>(this->Heights(), "Bump"));
        sources.push_back(&textures.back()->pyramid);
    }
    const bool own_axes = look.style == FigureStyle::textured || look.solid || look.bumps;
    const anamorph_vtk::Bodies bodies(input);
    const anamorph::figure::FigurePicture picture(frame_of(input, bodies, own_axes), view, {width, height},
                                                  look, execution.stage(0, 0.3));
    const int channels = anamorph::figure::channels_of(look.style);
    int extent[6];
    this->AskedExtent(extent);
    auto* image = vtkImageData::SafeDownCast(output);
    if (extent[0] > extent[1] || extent[2] > extent[3]) return;
    const anamorph::Box box{extent[0], height - 1 - extent[3], extent[1] + 1, height - extent[2]};
    std::vector<float> pixels(static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height()) *
                              static_cast<std::size_t>(channels));
    picture.draw(box,
                 anamorph::packed_view(reinterpret_cast<std::byte*>(pixels.data()),
                                       anamorph::PixelType::float32, box.width(), box.height(), channels),
                 execution.stage(0.3, 0.9), sources);
    image->SetExtent(extent);
    image->SetOrigin(0, 0, 0);
    image->SetSpacing(1, 1, 1);
    // Rows from the bottom up.
    const auto each_pixel = [&](const auto& write) {
        for (int y = 0; y < box.height(); ++y)
            for (int x = 0; x < box.width(); ++x)
                write(vtkIdType{y} * box.width() + x,
                      &pixels[(static_cast<std::size_t>(box.height() - 1 - y) *
                                   static_cast<std::size_t>(box.width()) +
                               static_cast<std::size_t>(x)) *
                              static_cast<std::size_t>(channels)]);
    };
    if (this->Style == DEPTH) {
        float* to = new_scalars<vtkFloatArray>(image, "Depth", 1)->GetPointer(0);
        each_pixel([&](vtkIdType i, const float* from) { to[i] = *from; });
    } else if (this->Style == BODY_ID) {
        int* to = new_scalars<vtkIntArray>(image, "BodyId", 1)->GetPointer(0);
        each_pixel([&](vtkIdType i, const float* from) {
            const auto body = static_cast<std::size_t>(*from);
            to[i] = body == 0 ? -1 : static_cast<int>(bodies.ids[body - 1]);
        });
    } else {
        unsigned char* to = new_scalars<vtkUnsignedCharArray>(image, "Colors", 4)->GetPointer(0);
        each_pixel([&](vtkIdType i, const float* from) { write_color(from, to + 4 * i); });
    }
    if (this->Style != OUTLINE) return;
    anamorph_vtk::add_field({"anamorph:max_error", picture.line_error()}, image);
    std::string left_out;
    for (const std::string& name : picture.left_out()) left_out += (left_out.empty() ? "" : ", ") + name;
    if (!left_out.empty()) anamorph_vtk::add_field({"anamorph:left_out", left_out}, image);
}

void vtkAnamorphFigureImage::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    static const char* const styles[] = {"shaded", "outline", "stick", "depth", "body id"};
    static const char* const lightings[] = {"rasel", "lambert", "blinn"};
    static const char* const mappings[] = {"latlong", "mirrored", "linear", "octahedral"};
    os << indent << "Style: " << styles[this->Style] << "\n"
       << indent << "Lighting: " << lightings[this->Lighting] << "\n"
       << indent << "Antialias: " << this->Antialias << "\n"
       << indent << "Textures: " << this->Textures.size() << "\n"
       << indent << "TextureMapping: " << mappings[this->TextureMapping] << "\n"
       << indent << "Solid: " << word_of("solid", this->Solid) << "\n"
       << indent << "SolidScale: " << this->SolidScale << "\n"
       << indent << "SolidSamples: " << this->SolidSamples << "\n";
    const auto print_text = [&](const char* name, const std::string& text) {
        os << indent << name << ": " << (text.empty() ? "(none)" : text) << "\n";
    };
    print_text("SolidRed", this->SolidRed);
    print_text("SolidGreen", this->SolidGreen);
    print_text("SolidBlue", this->SolidBlue);
    print_text("SolidDefinitions", this->SolidDefinitions);
    os << indent << "BumpScale: " << this->BumpScale << "\n"
       << indent << "Outlines: " << word_of("outlines", this->Outlines) << "\n"
       << indent << "OutlineTolerance: " << this->OutlineTolerance << "\n";
}
