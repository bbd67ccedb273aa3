// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphFigureImage.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/source.h"
#include "anamorph/parameter/parameter.h"
#include "execution.h"
#include "figure_data.h"
#include "figure_lines.h"
#include "image_texture.h"
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

/// The bodies of a data set as a frame, in their colors.
anamorph::figure::FigureFrame frame_of(vtkPolyData* data, const anamorph_vtk::Bodies& bodies, bool textured) {
    auto* textures = vtkStringArray::SafeDownCast(data->GetPointData()->GetAbstractArray("Texture"));
    if (textures && textures->GetNumberOfTuples() != data->GetNumberOfPoints()) textures = nullptr;
    vtkDataArray* offsets = data->GetPointData()->GetArray("TextureOffset");
    if (offsets &&
        (offsets->GetNumberOfComponents() != 2 || offsets->GetNumberOfTuples() != data->GetNumberOfPoints()))
        offsets = nullptr;
    anamorph::figure::FigureFrame frame;
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
        // Textures lie on bodies in NUDES' space, where z is negated: so is their own z axis, seen from here.
        if (textured) body.shape.rotation[2] = -body.shape.rotation[2];
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

vtkAnamorphFigureImage::vtkAnamorphFigureImage() = default;
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

vtkImageData* vtkAnamorphFigureImage::GetOutput() {
    return vtkImageData::SafeDownCast(this->GetOutputDataObject(0));
}

int vtkAnamorphFigureImage::FillOutputPortInformation(int, vtkInformation* information) {
    information->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkImageData");
    return 1;
}

int vtkAnamorphFigureImage::RequestInformation(vtkInformation*, vtkInformationVector**,
                                               vtkInformationVector* outputs) {
    vtkInformation* output = outputs->GetInformationObject(0);
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
    if (vtkInformation* input = inputs[0]->GetInformationObject(0)) {
        input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_PIECE_NUMBER(), 0);
        input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_PIECES(), 1);
        input->Set(vtkStreamingDemandDrivenPipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
    }
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
    if (this->Style != SHADED || this->Textures.empty()) return look;
    look.style = FigureStyle::textured;
    look.mapping = kMappings[this->TextureMapping];
    for (const auto& texture : this->Textures) look.textures.push_back(texture.first);
    return look;
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
    const anamorph_vtk::Bodies bodies(input);
    const anamorph::figure::FigurePicture picture(
        frame_of(input, bodies, look.style == FigureStyle::textured), view, {width, height}, look,
        execution.stage(0, 0.3));
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
       << indent << "TextureMapping: " << mappings[this->TextureMapping] << "\n";
}
