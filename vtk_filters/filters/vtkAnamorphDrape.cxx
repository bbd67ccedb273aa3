// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphDrape.h"

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <string>
#include <utility>

#include "anamorph/drape/drape.h"
#include "anamorph/drape/drape_rows.h"
#include "anamorph/error.h"
#include "anamorph/figure/figure_rows.h"
#include "anamorph/map/surface.h"
#include "anamorph/parameter.h"
#include "anamorph/render/pyramid.h"
#include "anamorph/render/source.h"
#include "execution.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkObjectFactoryNewMacro(vtkAnamorphDrape);

namespace {

using anamorph::Error;
using anamorph::PixelType;
using Executive = vtkStreamingDemandDrivenPipeline;

constexpr int kMostViewSize = 1 << 16;
constexpr float kFar = 1e30f;  ///< the depth where nothing is seen
constexpr anamorph::NumberRow kCoordinateRow{"coordinate", 0, -1e6, 1e6};

const char* const kFilters[] = {"nearest", "bilinear", "bicubic", "antialias"};
const char* const kStyles[] = {"color", "texture coordinates", "depth", "normal"};

/// The same error, naming the property of the filter that the core's parameter comes from.
Error of_property(const Error& error) {
    const std::pair<const char*, const char*> names[] = {
        {"camera", "CameraPosition"}, {"up", "CameraViewUp"}, {"tol", "Tolerance"}};
    for (const auto& [parameter, property] : names)
        if (error.parameter() == parameter)
            return Error(property + std::string(error.what()).substr(error.parameter().size()));
    return error;
}

glm::dvec3 point(const char* name, const double* v) {
    for (int k = 0; k < 3; ++k) kCoordinateRow.check(v[k], name);
    return {v[0], v[1], v[2]};
}

/// The channel of alpha, or -1.
int alpha_of(int components) {
    return components % 2 == 0 ? components - 1 : -1;
}

/// Of a picture's numbers. Throws Error.
PixelType pixel_type(vtkDataArray* array) {
    switch (array->GetDataType()) {
        case VTK_UNSIGNED_CHAR:
            return PixelType::uint8;
        case VTK_UNSIGNED_SHORT:
            return PixelType::uint16;
        case VTK_FLOAT:
            return PixelType::float32;
        default:
            throw Error(std::string("the texture's numbers are of type ") + array->GetDataTypeAsString() +
                        ", but must be of type unsigned char, unsigned short or float");
    }
}

/// Packed pixels whose rows go up, as rows that go down.
template <class Byte>
anamorph::BasicView<Byte> turned_over(Byte* data, PixelType type, int width, int height, int channels) {
    auto view = anamorph::packed_view(data, type, width, height, channels);
    view.data += (height - 1) * view.row_stride;
    view.row_stride = -view.row_stride;
    return view;
}

/// The texture's pixels as the core reads them.
class Texture {
  public:
    /// Throws Error.
    Texture(vtkImageData* image, vtkDataArray* array) : m_array(array) {
        int size[3];
        image->GetDimensions(size);
        if (image->GetNumberOfPoints() < 1) throw Error("the texture has no pixels");
        if (size[2] != 1)
            throw Error("the texture has " + std::to_string(size[2]) + " slices, but must have 1");
        if (std::max(size[0], size[1]) > anamorph::kMaxSide)
            throw Error("the texture is " + std::to_string(std::max(size[0], size[1])) +
                        " pixels wide or high, but must be at most " + std::to_string(anamorph::kMaxSide));
        if (!array || array->GetNumberOfTuples() != image->GetNumberOfPoints())
            throw Error("the texture has no point array to draw");
        const int components = array->GetNumberOfComponents();
        if (components < 1 || components > 4)
            throw Error("the texture has " + std::to_string(components) +
                        " components, but must have 1 to 4");
        const PixelType type = pixel_type(array);
        if (!array->HasStandardMemoryLayout()) {
            m_array.TakeReference(vtkDataArray::CreateDataArray(array->GetDataType()));
            m_array->DeepCopy(array);
        }
        m_view = turned_over(static_cast<const std::byte*>(m_array->GetVoidPointer(0)), type, size[0],
                             size[1], components);
    }

    const anamorph::ConstImageView& view() const { return m_view; }
    anamorph::Size size() const { return {m_view.width, m_view.height}; }
    int type() const { return m_array->GetDataType(); }

  private:
    vtkSmartPointer<vtkDataArray> m_array;
    anamorph::ConstImageView m_view;
};

/// The array of an image that is drawn.
struct Drawn {
    const char* name;
    int type, components;
};

Drawn drawn_by(int style, int texture_type, int texture_components) {
    switch (style) {
        case vtkAnamorphDrape::TEXTURE_COORDINATES:
            return {"TextureCoordinates", VTK_FLOAT, 2};
        case vtkAnamorphDrape::DEPTH:
            return {"Depth", VTK_FLOAT, 1};
        case vtkAnamorphDrape::NORMAL:
            return {"Normals", VTK_FLOAT, 3};
        default:
            return {"Colors", texture_type, texture_components};
    }
}

/// What the core says of nothing, and its texture coordinates, as VTK says them.
void say_as_vtk(int style, float* values, vtkIdType pixels) {
    for (vtkIdType i = 0; i < pixels; ++i) {
        if (style == vtkAnamorphDrape::DEPTH && std::isinf(values[i])) values[i] = kFar;
        if (style == vtkAnamorphDrape::TEXTURE_COORDINATES && values[2 * i + 1] >= 0)
            values[2 * i + 1] = 1 - values[2 * i + 1];
    }
}

anamorph::DrapeOptions options_of(int style, int filter, double tolerance, const double* background,
                                  int components) {
    anamorph::kDrapeTolRow.check(tolerance, "Tolerance");
    anamorph::DrapeOptions options;
    options.tol = tolerance;
    options.filter = static_cast<anamorph::Filter>(filter);
    if (style == vtkAnamorphDrape::TEXTURE_COORDINATES) options.output = anamorph::Output::stmap;
    if (style == vtkAnamorphDrape::DEPTH) options.own = anamorph::DrapeOutput::depth;
    if (style == vtkAnamorphDrape::NORMAL) options.own = anamorph::DrapeOutput::normal;
    for (int c = 0; c < 4; ++c)
        if (!std::isfinite(background[c]))
            throw Error("Background", anamorph::shortest(background[c]), "must be finite numbers");
    options.alpha = alpha_of(components);
    for (int c = 0; c < components; ++c)
        options.background.push_back(static_cast<float>(background[c == options.alpha ? 3 : c]));
    return options;
}

}  // namespace

struct vtkAnamorphDrape::Kept {
    anamorph::SurfaceSum sum;
    std::shared_ptr<anamorph::SharedTree> tree;
};

vtkAnamorphDrape::vtkAnamorphDrape() {
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                                 vtkDataSetAttributes::SCALARS);
}

vtkAnamorphDrape::~vtkAnamorphDrape() = default;

/// Throws anamorph::Error.
anamorph::Size vtkAnamorphDrape::Screen() const {
    for (const int size : this->ViewSize) {
        anamorph::kViewSizeRow.check(size, "ViewSize");
        if (size > kMostViewSize)
            throw Error("ViewSize", std::to_string(size),
                        "must be an integer from 1 to " + std::to_string(kMostViewSize));
    }
    return {this->ViewSize[0], this->ViewSize[1]};
}

/// The patches of the surface of a texture whose width is `aspect` times its height. Throws anamorph::Error.
std::shared_ptr<anamorph::SharedTree> vtkAnamorphDrape::TreeOf(double aspect) {
    if (this->Radius != 0) anamorph::kDrapeRadiusRow.check(this->Radius, "Radius");
    anamorph::kDrapeAngleRow.check(this->Angle, "Angle");
    anamorph::kDrapeTubeRow.check(this->Tube, "Tube");
    anamorph::kDrapeAmplitudeRow.check(this->Amplitude, "Amplitude");
    anamorph::kDrapeWavelengthRow.check(this->Wavelength, "Wavelength");
    anamorph::kDrapePhaseRow.check(this->Phase, "Phase");
    anamorph::kDrapeDirectionRow.check(this->Direction, "Direction");
    anamorph::kDrapeTurnRow.check(this->Turn, "Turn");
    anamorph::SurfaceSum sum;
    sum.parts = {{static_cast<std::size_t>(this->Surface), 1}};
    sum.shape = {aspect,           this->Radius, this->Angle,     this->Tube, this->Amplitude,
                 this->Wavelength, this->Phase,  this->Direction, this->Turn};
    if (!this->KeptSurface || this->KeptSurface->sum != sum)
        this->KeptSurface.reset(
            new Kept{sum, std::make_shared<anamorph::SharedTree>(anamorph::make_surface(sum))});
    return this->KeptSurface->tree;
}

/// Throws anamorph::Error.
anamorph::Camera vtkAnamorphDrape::CameraOf(const anamorph::Size& screen) const {
    anamorph::kDrapeParallelScaleRow.check(this->CameraParallelScale, "CameraParallelScale");
    anamorph::kViewAngleRow.check(this->CameraViewAngle, "CameraViewAngle");
    // The core's cameras measure a view by its width, VTK's by its height.
    const double aspect = static_cast<double>(screen.width) / screen.height,
                 half_degree = anamorph::kPi / 360;
    anamorph::CameraPose pose;
    pose.position = point("CameraPosition", this->CameraPosition);
    pose.target = point("CameraFocalPoint", this->CameraFocalPoint);
    pose.up = point("CameraViewUp", this->CameraViewUp);
    pose.perspective = !this->CameraParallelProjection;
    pose.fov = std::atan(aspect * std::tan(this->CameraViewAngle * half_degree)) / half_degree;
    pose.extent = 2 * this->CameraParallelScale * aspect;
    return {pose, glm::dmat3(1.0), glm::dvec3(0.0), screen};
}

int vtkAnamorphDrape::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                         vtkInformationVector* outputs) {
    const auto tell = [&] {
        const anamorph::Size screen = this->Screen();
        vtkInformation* output = outputs->GetInformationObject(0);
        output->Set(Executive::WHOLE_EXTENT(), 0, screen.width - 1, 0, screen.height - 1, 0, 0);
        output->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
        const double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0},
                     direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        output->Set(vtkDataObject::SPACING(), spacing, 3);
        output->Set(vtkDataObject::ORIGIN(), origin, 3);
        output->Set(vtkDataObject::DIRECTION(), direction, 9);
        vtkInformation* texture = this->GetInputArrayFieldInformation(0, inputs);
        const bool known = texture && texture->Has(vtkDataObject::FIELD_ARRAY_TYPE()) &&
                           texture->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS());
        const Drawn drawn =
            drawn_by(this->Style, known ? texture->Get(vtkDataObject::FIELD_ARRAY_TYPE()) : -1,
                     known ? texture->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()) : -1);
        vtkDataObject::SetPointDataActiveScalarInfo(output, drawn.type, drawn.components);
    };
    return anamorph_vtk::guarded(this, tell, {vtkDataObject::GetData(outputs)});
}

int vtkAnamorphDrape::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                          vtkInformationVector*) {
    vtkInformation* texture = inputs[0]->GetInformationObject(0);
    if (!texture || !texture->Has(Executive::WHOLE_EXTENT())) return 1;
    // All of it, which is no piece as the pipeline would cut it.
    texture->Set(Executive::UPDATE_PIECE_NUMBER(), 0);
    texture->Set(Executive::UPDATE_NUMBER_OF_PIECES(), 1);
    texture->Set(Executive::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
    texture->Set(Executive::UPDATE_EXTENT(), texture->Get(Executive::WHOLE_EXTENT()), 6);
    return 1;
}

int vtkAnamorphDrape::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                  vtkInformationVector* outputs) {
    vtkImageData* texture = vtkImageData::GetData(inputs[0]);
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->Initialize();
    this->MaxError = 0;
    const auto draw = [&] {
        try {
            int asked[6];
            outputs->GetInformationObject(0)->Get(Executive::UPDATE_EXTENT(), asked);
            this->Draw(texture, this->GetInputArrayToProcess(0, inputs), asked, output);
        } catch (const Error& error) {
            throw of_property(error);
        }
    };
    return anamorph_vtk::guarded(this, draw, {output});
}

/// Draws the pixels of an extent of the image.
void vtkAnamorphDrape::Draw(vtkImageData* texture, vtkDataArray* texels, const int* extent,
                            vtkImageData* output) {
    if (extent[0] > extent[1] || extent[2] > extent[3]) return;
    const anamorph::Size screen = this->Screen();
    const Texture pixels(texture, texels);
    const int channels = pixels.view().channels;
    const anamorph::DrapeOptions options =
        options_of(this->Style, this->Filter, this->Tolerance, this->Background, channels);
    anamorph_vtk::Execution execution(this);
    execution.progress(0.01);
    const anamorph::Drape drape(this->TreeOf(static_cast<double>(pixels.size().width) / pixels.size().height),
                                this->CameraOf(screen), pixels.size(), options);
    execution.progress(0.3);

    const Drawn drawn = drawn_by(this->Style, pixels.type(), channels);
    output->SetExtent(extent[0], extent[1], extent[2], extent[3], 0, 0);
    output->SetOrigin(0, 0, 0);
    output->SetSpacing(1, 1, 1);
    const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(drawn.type));
    array->SetName(drawn.name);
    array->SetNumberOfComponents(drawn.components);
    array->SetNumberOfTuples(output->GetNumberOfPoints());
    output->GetPointData()->SetScalars(array);

    const anamorph::MemorySource base(pixels.view(), alpha_of(channels));
    const anamorph::Pyramid source(base);
    const anamorph::Box box{extent[0], screen.height - 1 - extent[3], extent[1] + 1,
                            screen.height - extent[2]};
    if (!drape.draw(&source, box,
                    turned_over(static_cast<std::byte*>(array->GetVoidPointer(0)), pixel_type(array),
                                box.width(), box.height(), drawn.components),
                    execution.stage(0.3, 0.95)))
        throw Error("the texture cannot be read");
    if (this->Style != COLOR)
        say_as_vtk(this->Style, static_cast<float*>(array->GetVoidPointer(0)), array->GetNumberOfTuples());
    this->MaxError = drape.max_error();
}

void vtkAnamorphDrape::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    const auto print = [&](const char* name, const double* v, int count) {
        os << indent << name << ":";
        for (int i = 0; i < count; ++i) os << " " << v[i];
        os << "\n";
    };
    os << indent << "Surface: " << anamorph::surface_names()[static_cast<std::size_t>(this->Surface)] << "\n"
       << indent << "Angle: " << this->Angle << "\n"
       << indent << "Radius: " << this->Radius << "\n"
       << indent << "Tube: " << this->Tube << "\n"
       << indent << "Amplitude: " << this->Amplitude << "\n"
       << indent << "Wavelength: " << this->Wavelength << "\n"
       << indent << "Phase: " << this->Phase << "\n"
       << indent << "Direction: " << this->Direction << "\n"
       << indent << "Turn: " << this->Turn << "\n"
       << indent << "ViewSize: " << this->ViewSize[0] << " " << this->ViewSize[1] << "\n";
    print("CameraPosition", this->CameraPosition, 3);
    print("CameraFocalPoint", this->CameraFocalPoint, 3);
    print("CameraViewUp", this->CameraViewUp, 3);
    os << indent << "CameraParallelProjection: " << this->CameraParallelProjection << "\n"
       << indent << "CameraParallelScale: " << this->CameraParallelScale << "\n"
       << indent << "CameraViewAngle: " << this->CameraViewAngle << "\n"
       << indent << "Tolerance: " << this->Tolerance << "\n"
       << indent << "Filter: " << kFilters[this->Filter] << "\n";
    print("Background", this->Background, 4);
    os << indent << "Style: " << kStyles[this->Style] << "\n"
       << indent << "MaxError: " << this->MaxError << "\n";
}
