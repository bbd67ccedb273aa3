// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphDrape.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <map>
#include <memory>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/source.h"
#include "anamorph/operation/block_drape.h"
#include "anamorph/operation/drape.h"
#include "anamorph/operation/drape_surface.h"
#include "anamorph/operation/rows.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/surface/drape.h"
#include "anamorph/surface/drape_rows.h"
#include "anamorph/surface/surface.h"
#include "attribute_fields.h"
#include "drape_inputs.h"
#include "drawn_image.h"
#include "execution.h"
#include "image_texture.h"
#include "input_times.h"
#include "property_names.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkStringArray.h"
#include "vtkTable.h"

vtkObjectFactoryNewMacro(vtkAnamorphDrape);

namespace {

using anamorph::Error;
using anamorph_vtk::alpha_of;
using anamorph_vtk::turned_over;
using Executive = vtkStreamingDemandDrivenPipeline;

constexpr int kMostViewSize = 1 << 16;
constexpr int kMostLights = 1024;
constexpr float kFar = 1e30f;  ///< the depth where nothing is seen
constexpr anamorph::NumberRow kCoordinateRow{"coordinate", 0, -1e6, 1e6};

const char* const kStyles[] = {"color", "texture coordinates", "depth", "normal", "coverage"};
// The operation's words for the values of Filter, Shading and Scheme.
constexpr std::array kFilters = {"nearest", "bilinear",    "bicubic",      "antialias",
                                 "pyramid", "summed_area", "sharp_bicubic"};
static_assert(kFilters.size() == vtkAnamorphDrape::SHARP_BICUBIC + 1);
constexpr std::array kShadings = {"none", "gouraud", "phong"};
static_assert(kShadings.size() == vtkAnamorphDrape::PHONG + 1);
constexpr std::array kSchemes = {"auto", "exact", "oka", "oka-z", "hardware"};
static_assert(kSchemes.size() == vtkAnamorphDrape::HARDWARE + 1);

// Header and core have been made of the same list.
static_assert(vtkAnamorphDrape::NumberOfSurfaces == 2
#define ANAMORPH_SURFACE(name, Type) +1
#include "anamorph/surface/shape/list.h"
#undef ANAMORPH_SURFACE
);

/// The operation's word for a value of Surface. There, that of the positions and that of formulas come last.
const std::string& surface_word(int surface) {
    static_assert(vtkAnamorphDrape::FORMULA == vtkAnamorphDrape::POSITIONS + 1);
    constexpr int kListed = vtkAnamorphDrape::NumberOfSurfaces - 2;
    const int index = surface < vtkAnamorphDrape::POSITIONS  ? surface
                      : surface <= vtkAnamorphDrape::FORMULA ? kListed + surface - vtkAnamorphDrape::POSITIONS
                                                             : surface - 2;
    return anamorph::surface::all_surface_names().at(static_cast<std::size_t>(index));
}

glm::dvec3 point(const char* name, const double* v) {
    for (int k = 0; k < 3; ++k) kCoordinateRow.check(v[k], name);
    return {v[0], v[1], v[2]};
}

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
        case vtkAnamorphDrape::COVERAGE:
            return {"Coverage", VTK_FLOAT, 1};
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

/// The point array of a name, by default the scalars; null where there is none.
vtkDataArray* array_of(vtkDataSet* data, const std::string& name) {
    if (!data) return nullptr;
    return name.empty() ? data->GetPointData()->GetScalars() : data->GetPointData()->GetArray(name.c_str());
}

/// The texture of the far side; none where there is none. Throws anamorph::Error.
std::optional<anamorph_vtk::ImageTexture> back_of(vtkImageData* image,
                                                  const anamorph_vtk::ImageTexture& front) {
    if (!image) return {};
    std::optional<anamorph_vtk::ImageTexture> back(std::in_place, image, image->GetPointData()->GetScalars(),
                                                   "the input Back");
    const int own = back->view().channels, of_front = front.view().channels;
    if (own != of_front)
        throw Error("Back", std::to_string(own) + " components",
                    "must have as many as the texture, " + std::to_string(of_front));
    if (back->type() != front.type()) throw Error("Back", "another type", "must be of the texture's type");
    return back;
}

/// A drape, by patches and blocks or by the machine, ready to draw.
class ReadyDrape {
  public:
    /// Throws anamorph::Error.
    ReadyDrape(const anamorph::DrapeSurfaces& surfaces, const anamorph::ParameterValues& values,
               const anamorph::surface::Camera& camera, const anamorph::Size& texture,
               const anamorph::surface::DrapeOptions& options) {
        const auto machine = anamorph::drape_machine(values, options);
        const anamorph::surface::SurfaceSum sum = surfaces.sum_of(values);
        const auto tree = surfaces.tree_of(sum);
        if (machine)
            m_by_machine = anamorph::solved_by_blocks(
                {*machine, sum, {tree, &tree->tree.surface()}, camera, texture, options, camera.screen()});
        else
            m_drape.emplace(tree, camera, texture, options);
    }

    /// Draws the pixels of a box. False where the texture cannot be read.
    bool draw(const anamorph::Source& texture, const anamorph::Source* back, const anamorph::Box& box,
              const anamorph::ImageView& view, const anamorph::ParallelFor& parallel_for) const {
        return m_drape ? m_drape->draw(&texture, box, view, parallel_for, nullptr, back)
                       : m_by_machine->draw({&texture}, box, view, parallel_for);
    }
    /// Adds what the machine says of its picture as fields, and returns the largest error.
    double say(vtkDataObject* output) const {
        if (m_drape) return m_drape->max_error();
        double largest = 0;
        for (const anamorph::Attribute& attribute : m_by_machine->reached(anamorph::serial_for))
            if (attribute.name == "anamorph:max_error")
                largest = std::get<double>(attribute.value);
            else
                anamorph_vtk::add_field(attribute, output);
        return largest;
    }

  private:
    std::optional<anamorph::surface::Drape> m_drape;
    std::unique_ptr<const anamorph::SolvedPicture> m_by_machine;
};

/// The properties that have another name than their row.
const std::map<std::string, std::string>& other_names() {
    static const std::map<std::string, std::string> names = {{"camera", "CameraPosition"},
                                                             {"up", "CameraViewUp"},
                                                             {"tol", "Tolerance"},
                                                             {"px", "FormulaX"},
                                                             {"py", "FormulaY"},
                                                             {"pz", "FormulaZ"},
                                                             {"let", "FormulaDefinitions"},
                                                             {"light", "Light"},
                                                             {"weights", "BlendWeights"}};
    return names;
}

}  // namespace

/// What inputs and files say of surfaces, and the patches of the last ones.
struct vtkAnamorphDrape::Kept {
    std::string key;
    anamorph::DrapeSurfaces surfaces;
};

struct vtkAnamorphDrape::Number {
    const char* name;
    const char* row;
    double vtkAnamorphDrape::*value;
};

const std::vector<vtkAnamorphDrape::Number>& vtkAnamorphDrape::Numbers() {
    using Self = vtkAnamorphDrape;
    static const std::vector<Number> all = {{"Angle", "angle", &Self::Angle},
                                            {"Radius", "radius", &Self::Radius},
                                            {"Tube", "tube", &Self::Tube},
                                            {"Amplitude", "amplitude", &Self::Amplitude},
                                            {"Wavelength", "wavelength", &Self::Wavelength},
                                            {"Phase", "phase", &Self::Phase},
                                            {"Direction", "direction", &Self::Direction},
                                            {"Turn", "turn", &Self::Turn},
                                            {"HeightScale", "height_scale", &Self::HeightScale},
                                            {"HeightSmooth", "height_smooth", &Self::HeightSmooth},
                                            {"Tolerance", "tol", &Self::Tolerance},
                                            {"Block", "block", &Self::Block},
                                            {"Overlap", "overlap", &Self::Overlap},
                                            {"Ambient", "ambient", &Self::Ambient},
                                            {"Diffuse", "diffuse", &Self::Diffuse},
                                            {"Specular", "specular", &Self::Specular},
                                            {"Shininess", "shininess", &Self::Shininess}};
    return all;
}

vtkAnamorphDrape::vtkAnamorphDrape() {
    this->SetNumberOfInputPorts(5);
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                                 vtkDataSetAttributes::SCALARS);
    // 0 stands for what has no default of its own.
    const anamorph::ParameterValues defaults(*anamorph::drape_operation().parameters);
    for (const Number& number : Numbers())
        this->*number.value = defaults.text(number.row).empty() ? 0 : defaults.number(number.row);
    this->SetNumberOfLights(1);
}

vtkAnamorphDrape::~vtkAnamorphDrape() = default;

void vtkAnamorphDrape::SetBlendWeight(int surface, double weight) {
    if (surface < 0 || surface >= NumberOfSurfaces) {
        vtkErrorMacro(<< "surface=" << surface << ": must be an integer from 0 to " << NumberOfSurfaces - 1);
        return;
    }
    double weights[NumberOfSurfaces];
    std::copy_n(this->BlendWeights, NumberOfSurfaces, weights);
    weights[surface] = weight;
    this->SetBlendWeights(weights);
}

void vtkAnamorphDrape::SetText(std::string& member, const char* text) {
    const std::string given = text ? text : "";
    if (given == member) return;
    member = given;
    this->Modified();
}

void vtkAnamorphDrape::SetNumberOfLights(int count) {
    if (count < 0 || count > kMostLights) {
        vtkErrorMacro(<< "NumberOfLights=" << count << ": must be an integer from 0 to " << kMostLights);
        return;
    }
    if (count == this->GetNumberOfLights()) return;
    this->Lights.resize(static_cast<std::size_t>(count), {0, 0, 1});
    this->Modified();
}

bool vtkAnamorphDrape::IsLight(int index) {
    if (index >= 0 && index < this->GetNumberOfLights()) return true;
    vtkErrorMacro(<< "light " << index << " is not in the list, which has " << this->GetNumberOfLights());
    return false;
}

void vtkAnamorphDrape::SetLight(int index, double x, double y, double z) {
    if (!this->IsLight(index)) return;
    const std::array<double, 3> light = {x, y, z};
    std::array<double, 3>& place = this->Lights[static_cast<std::size_t>(index)];
    if (place == light) return;
    place = light;
    this->Modified();
}

double* vtkAnamorphDrape::GetLight(int index) {
    return this->IsLight(index) ? this->Lights[static_cast<std::size_t>(index)].data() : nullptr;
}

vtkTypeBool vtkAnamorphDrape::ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                                             vtkInformationVector* outputs) {
    // There is an output, if an empty one, whatever is missing.
    if (!request->Has(Executive::REQUEST_DATA_OBJECT()) && !anamorph_vtk::has_inputs(this, {"the texture"}))
        return 0;
    return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkAnamorphDrape::FillInputPortInformation(int port, vtkInformation* info) {
    constexpr const char* kTypes[] = {"vtkImageData", "vtkStructuredGrid", "vtkImageData", "vtkTable",
                                      "vtkImageData"};
    info->Set(INPUT_REQUIRED_DATA_TYPE(), kTypes[port]);
    if (port == 1) info->Append(INPUT_REQUIRED_DATA_TYPE(), "vtkImageData");
    info->Set(INPUT_IS_OPTIONAL(), 1);  // has_inputs() tells of the first in our own words
    return 1;
}

/// Throws anamorph::Error.
anamorph::Size vtkAnamorphDrape::Screen() const {
    for (const int size : this->ViewSize) {
        anamorph::figure::kViewSizeRow.check(size, "ViewSize");
        if (size > kMostViewSize)
            throw Error("ViewSize", std::to_string(size),
                        "must be an integer from 1 to " + std::to_string(kMostViewSize));
    }
    return {this->ViewSize[0], this->ViewSize[1]};
}

bool vtkAnamorphDrape::Uses(int surface) const {
    return this->Surface == surface || this->BlendWeights[surface] != 0;
}

/// The properties as the operation's values, checked by its table. Throws anamorph::Error.
anamorph::ParameterValues vtkAnamorphDrape::Values() const {
    anamorph::ParameterValues values(*anamorph::drape_operation().parameters);
    values.set("surface", surface_word(this->Surface));
    values.set("filter", kFilters[static_cast<std::size_t>(this->Filter)]);
    values.set("shading", kShadings[static_cast<std::size_t>(this->Shading)]);
    values.set("scheme", kSchemes[static_cast<std::size_t>(this->Scheme)]);
    if (!this->Machine.empty()) values.set("machine", this->Machine);
    for (const Number& number : Numbers())
        if (number.value != &vtkAnamorphDrape::Radius || this->Radius != 0)
            values.set(number.row, this->*number.value);
    std::string blend;
    std::vector<double> weights, lights;
    for (int surface = 0; surface < NumberOfSurfaces; ++surface)
        if (surface != this->Surface && this->BlendWeights[surface] != 0) {
            blend += (blend.empty() ? "" : ",") + surface_word(surface);
            weights.push_back(this->BlendWeights[surface]);
        }
    if (!blend.empty()) {
        values.set("blend", blend);
        values.set("weights", weights);
    }
    for (const auto& light : this->Lights) lights.insert(lights.end(), light.begin(), light.end());
    if (!lights.empty()) values.set("light", lights);
    if (this->Uses(FORMULA)) {
        const auto say = [&](const char* row, const std::string& text) {
            if (!text.empty()) values.set(row, text);
        };
        say("px", this->FormulaX);
        say("py", this->FormulaY);
        say("pz", this->FormulaZ);
        say("let", this->FormulaDefinitions);
        values.set("frame", this->Frame);
    }
    return values;
}

/// The surfaces of a texture whose width is `aspect` times its height. Throws anamorph::Error.
const anamorph::DrapeSurfaces& vtkAnamorphDrape::SurfacesOf(const anamorph::ParameterValues& values,
                                                            vtkInformationVector** inputs, double aspect) {
    auto* positions = vtkDataSet::GetData(inputs[1]);
    auto* heights = vtkImageData::GetData(inputs[2]);
    if (!this->Uses(POSITIONS)) positions = nullptr;
    std::vector<anamorph_vtk::Numbers> bumps = anamorph_vtk::numbers_in(vtkTable::GetData(inputs[3]));
    if (!this->DeformationFileName.empty()) {
        const auto more = anamorph_vtk::read_deformations(this->DeformationFileName);
        bumps.insert(bumps.end(), more.begin(), more.end());
    }
    vtkDataArray* arrays[] = {array_of(positions, this->PositionsArrayName),
                              array_of(heights, this->HeightArrayName)};
    std::ostringstream key;
    key << anamorph::shortest(aspect) << " " << values.text("height_smooth");
    for (vtkObject* object : {static_cast<vtkObject*>(positions), static_cast<vtkObject*>(heights),
                              static_cast<vtkObject*>(arrays[0]), static_cast<vtkObject*>(arrays[1])})
        key << " " << object << " " << (object ? object->GetMTime() : 0);
    for (const anamorph_vtk::Numbers& bump : bumps)
        for (const double number : bump) key << " " << anamorph::shortest(number);
    if (!this->KeptSurfaces || this->KeptSurfaces->key != key.str()) {
        this->KeptSurfaces.reset();
        anamorph_vtk::DrapeInputs files;
        if (positions) files.put_positions(positions, arrays[0]);
        if (heights) files.put_heights(heights, arrays[1]);
        files.put_deformations(bumps);
        this->KeptSurfaces.reset(
            new Kept{key.str(), anamorph::DrapeSurfaces({values, {}, files.files(), files}, aspect)});
    }
    return this->KeptSurfaces->surfaces;
}

/// Throws anamorph::Error.
anamorph::surface::DrapeOptions vtkAnamorphDrape::Options(const anamorph::ParameterValues& values,
                                                          int components) const {
    anamorph::surface::DrapeOptions options;
    if (this->Scheme != HARDWARE)
        options.scheme = anamorph::rows::chosen<anamorph::surface::DrapeScheme>(values, "scheme");
    options.tol = values.number("tol");
    options.block = values.number("block");
    options.overlap = values.number("overlap");
    options.filter = anamorph::rows::chosen<anamorph::Filter>(values, "filter");
    if (this->Style == TEXTURE_COORDINATES) options.output = anamorph::Output::stmap;
    if (this->Style == COVERAGE) options.own = anamorph::surface::DrapeOutput::coverage;
    if (this->Style == DEPTH) options.own = anamorph::surface::DrapeOutput::depth;
    if (this->Style == NORMAL) options.own = anamorph::surface::DrapeOutput::normal;
    options.lighting = {
        anamorph::rows::chosen<anamorph::surface::DrapeShading>(values, "shading"),
        anamorph::drape_lights(this->Lights.empty() ? std::vector<double>{} : values.numbers("light")),
        values.number("ambient"),
        values.number("diffuse"),
        values.number("specular"),
        values.number("shininess")};
    for (int c = 0; c < 4; ++c)
        if (!std::isfinite(this->Background[c]))
            throw Error("Background", anamorph::shortest(this->Background[c]), "must be finite numbers");
    options.alpha = alpha_of(components);
    // Nothing behind is what the core draws fastest.
    const bool nothing = std::all_of(this->Background, this->Background + 4, [](double v) { return v == 0; });
    for (int c = 0; c < components && !nothing; ++c)
        options.background.push_back(static_cast<float>(this->Background[c == options.alpha ? 3 : c]));
    return options;
}

/// Throws anamorph::Error.
anamorph::surface::Camera vtkAnamorphDrape::CameraOf(const anamorph::Size& screen) const {
    anamorph::surface::kDrapeParallelScaleRow.check(this->CameraParallelScale, "CameraParallelScale");
    anamorph::figure::kViewAngleRow.check(this->CameraViewAngle, "CameraViewAngle");
    // The core's cameras measure a view by its width, VTK's by its height.
    const double aspect = static_cast<double>(screen.width) / screen.height,
                 half_degree = anamorph::surface::kPi / 360;
    anamorph::surface::CameraPose pose;
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
        anamorph_vtk::tell_times({inputs, 5}, output);
    };
    return anamorph_vtk::guarded(this, tell, {vtkDataObject::GetData(outputs)});
}

int vtkAnamorphDrape::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                          vtkInformationVector*) {
    anamorph_vtk::ask_for_all({inputs, static_cast<std::size_t>(this->GetNumberOfInputPorts())});
    return 1;
}

int vtkAnamorphDrape::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                  vtkInformationVector* outputs) {
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->Initialize();
    this->MaxError = 0;
    const auto draw = [&] {
        try {
            int asked[6];
            outputs->GetInformationObject(0)->Get(Executive::UPDATE_EXTENT(), asked);
            this->Draw(inputs, asked, output);
            anamorph_vtk::hand_over_time({inputs, 5}, output);
        } catch (const Error& error) {
            throw anamorph_vtk::of_property(error, other_names());
        }
    };
    return anamorph_vtk::guarded(this, draw, {output});
}

/// The machine draws the bare picture. Throws anamorph::Error.
void vtkAnamorphDrape::CheckMachine(const anamorph::surface::DrapeOptions& options, bool has_back) const {
    if (this->Scheme != HARDWARE) return;
    if (has_back) throw Error("Back", "given", "must not be connected with Scheme=hardware");
    if (options.own != anamorph::surface::DrapeOutput::shared)
        throw Error("Style", kStyles[this->Style],
                    "must be color or texture coordinates with Scheme=hardware");
    if (!options.background.empty()) {
        std::string text;
        for (const double value : this->Background)
            text += (text.empty() ? "" : ",") + anamorph::shortest(value);
        throw Error("Background", text, "must be 0,0,0,0 with Scheme=hardware");
    }
}

/// Draws the pixels of an extent of the image.
void vtkAnamorphDrape::Draw(vtkInformationVector** inputs, const int* extent, vtkImageData* output) {
    if (extent[0] > extent[1] || extent[2] > extent[3]) return;
    const anamorph::Size screen = this->Screen();
    const anamorph_vtk::ImageTexture pixels(vtkImageData::GetData(inputs[0]),
                                            this->GetInputArrayToProcess(0, inputs), "the texture");
    const int channels = pixels.view().channels;
    const anamorph::ParameterValues values = this->Values();
    anamorph::surface::DrapeOptions options = this->Options(values, channels);
    const std::optional<anamorph_vtk::ImageTexture> far_side =
        back_of(vtkImageData::GetData(inputs[4]), pixels);
    if (far_side) options.back = far_side->size();
    this->CheckMachine(options, far_side.has_value());
    anamorph_vtk::Execution execution(this);
    execution.progress(0.01);
    const anamorph::DrapeSurfaces& surfaces =
        this->SurfacesOf(values, inputs, static_cast<double>(pixels.size().width) / pixels.size().height);
    execution.progress(0.1);
    const ReadyDrape drape(surfaces, values, this->CameraOf(screen), pixels.size(), options);
    execution.progress(0.3);

    const Drawn drawn = drawn_by(this->Style, pixels.type(), channels);
    output->SetExtent(extent[0], extent[1], extent[2], extent[3], 0, 0);
    output->SetOrigin(0, 0, 0);
    output->SetSpacing(1, 1, 1);
    output->GetFieldData()->PassData(vtkImageData::GetData(inputs[0])->GetFieldData());
    const auto array = vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(drawn.type));
    array->SetName(drawn.name);
    array->SetNumberOfComponents(drawn.components);
    array->SetNumberOfTuples(output->GetNumberOfPoints());
    output->GetPointData()->SetScalars(array);

    const anamorph::MemorySource base(pixels.view(), alpha_of(channels));
    const anamorph::Pyramid source(base);
    std::optional<anamorph::MemorySource> back_base;
    std::optional<anamorph::Pyramid> back;
    if (far_side) back.emplace(back_base.emplace(far_side->view(), alpha_of(channels)));
    const anamorph::Box box{extent[0], screen.height - 1 - extent[3], extent[1] + 1,
                            screen.height - extent[2]};
    if (!drape.draw(source, back ? &*back : nullptr, box,
                    turned_over(static_cast<std::byte*>(array->GetVoidPointer(0)),
                                anamorph_vtk::pixel_type(array, "the texture"), box.width(), box.height(),
                                drawn.components),
                    execution.stage(0.3, 0.95)))
        throw Error("the texture cannot be read");
    if (this->Style != COLOR)
        say_as_vtk(this->Style, static_cast<float*>(array->GetVoidPointer(0)), array->GetNumberOfTuples());
    if (!surfaces.missing().empty())
        anamorph_vtk::add_field({"anamorph:missing", surfaces.missing()}, output);
    this->MaxError = drape.say(output);
}

void vtkAnamorphDrape::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    const auto print = [&](const char* name, const double* v, int count) {
        os << indent << name << ":";
        for (int i = 0; i < count; ++i) os << " " << v[i];
        os << "\n";
    };
    os << indent << "Surface: " << surface_word(this->Surface) << "\n";
    print("BlendWeights", this->BlendWeights, NumberOfSurfaces);
    for (const Number& number : Numbers()) print(number.name, &(this->*number.value), 1);
    const auto print_text = [&](const char* name, const std::string& text) {
        os << indent << name << ": " << (text.empty() ? "(none)" : text) << "\n";
    };
    print_text("PositionsArrayName", this->PositionsArrayName);
    print_text("HeightArrayName", this->HeightArrayName);
    print_text("DeformationFileName", this->DeformationFileName);
    print_text("FormulaX", this->FormulaX);
    print_text("FormulaY", this->FormulaY);
    print_text("FormulaZ", this->FormulaZ);
    print_text("FormulaDefinitions", this->FormulaDefinitions);
    print_text("Machine", this->Machine);
    os << indent << "Frame: " << this->Frame << "\n";
    os << indent << "ViewSize: " << this->ViewSize[0] << " " << this->ViewSize[1] << "\n";
    print("CameraPosition", this->CameraPosition, 3);
    print("CameraFocalPoint", this->CameraFocalPoint, 3);
    print("CameraViewUp", this->CameraViewUp, 3);
    os << indent << "CameraParallelProjection: " << this->CameraParallelProjection << "\n"
       << indent << "CameraParallelScale: " << this->CameraParallelScale << "\n"
       << indent << "CameraViewAngle: " << this->CameraViewAngle << "\n"
       << indent << "Scheme: " << kSchemes[static_cast<std::size_t>(this->Scheme)] << "\n"
       << indent << "Filter: " << kFilters[static_cast<std::size_t>(this->Filter)] << "\n";
    print("Background", this->Background, 4);
    os << indent << "Shading: " << kShadings[static_cast<std::size_t>(this->Shading)] << "\n";
    for (const auto& light : this->Lights) print("Light", light.data(), 3);
    os << indent << "Style: " << kStyles[this->Style] << "\n"
       << indent << "MaxError: " << this->MaxError << "\n";
}
