// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphPanoramaView.h"

#include <algorithm>
#include <string>

#include "anamorph/error.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/operation/pano.h"
#include "anamorph/operation/rows.h"
#include "anamorph/projector/projector_rows.h"
#include "attribute_fields.h"
#include "drawn_image.h"
#include "execution.h"
#include "image_texture.h"
#include "vtkDataArray.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkObjectFactoryNewMacro(vtkAnamorphPanoramaView);

namespace {

using Executive = vtkStreamingDemandDrivenPipeline;

constexpr int kMostViewSize = 1 << 16;
const char* const kName = "the panorama";

void check_size(const int* size) {
    for (int k = 0; k < 2; ++k)
        if (size[k] < 1 || size[k] > kMostViewSize)
            throw anamorph::Error("ViewSize", std::to_string(size[k]),
                                  "must be an integer from 1 to " + std::to_string(kMostViewSize));
}

/// Is a key of recipes not of a filter, which has one input, no pictures of pictures and no color spaces?
bool is_of_recipes(const std::string& key) {
    namespace rows = anamorph::rows;
    return key == "concatenate" || key == "colorspace" ||
           std::find(std::begin(rows::kKeysOfRecipes), std::end(rows::kKeysOfRecipes), key) !=
               std::end(rows::kKeysOfRecipes);
}

/// The lines of a text whose parts are separated by "&".
std::vector<anamorph::Assignment> parse_keys(const char* keys) {
    std::string lines = keys ? keys : "";
    std::replace(lines.begin(), lines.end(), '&', '\n');
    return anamorph::parse_recipe(lines);
}

/// Checks that none of what is given names a file or is a recipe's alone. Throws Error.
void check_keys(const anamorph::ParameterValues& values) {
    const auto is_refused = [&](const anamorph::Parameter& p) {
        return p.type == anamorph::ParameterType::image || p.type == anamorph::ParameterType::file ||
               is_of_recipes(p.name);
    };
    for (const anamorph::Parameter& p : values.table())
        if (values.given(p.name) && is_refused(p))
            throw anamorph::Error(p.name, anamorph::printable(values.text(p.name)),
                                  "must be given in recipes only");
}

/// No key of a view names a file.
class NoFiles final : public anamorph::SideFileReader {
    std::string text(const std::string& name) const override { refuse(name); }
    std::unique_ptr<anamorph::SideImage> image(const std::string&, const std::string& name) const override {
        refuse(name);
    }
    [[noreturn]] static void refuse(const std::string& name) {
        throw anamorph::Error("file \"" + anamorph::printable(name) + "\" cannot be read by a filter");
    }
};

/// The name of the array of an output.
std::string array_name(const anamorph::ParameterValues& values, anamorph::PixelKind pixels) {
    return pixels == anamorph::PixelKind::color ? "Colors" : values.text("output");
}

}  // namespace

vtkAnamorphPanoramaView::vtkAnamorphPanoramaView() {
    this->SetInputArrayToProcess(0, 0, 0, vtkDataObject::FIELD_ASSOCIATION_POINTS,
                                 vtkDataSetAttributes::SCALARS);
}
vtkAnamorphPanoramaView::~vtkAnamorphPanoramaView() {
    this->SetLens(nullptr);
    this->SetKeys(nullptr);
}

void vtkAnamorphPanoramaView::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Projection: " << anamorph::name_of(anamorph::kProjections[this->Projection]) << "\n";
    os << indent << "FieldOfView: " << this->FieldOfView << "\n";
    os << indent << "VerticalFieldOfView: " << this->VerticalFieldOfView << "\n";
    os << indent << "PanniniDistance: " << this->PanniniDistance << "\n";
    os << indent << "ProjectionAlpha: " << this->ProjectionAlpha << "\n";
    os << indent << "Lens: " << (this->Lens ? this->Lens : "none") << "\n";
    os << indent << "Yaw: " << this->Yaw << "\n";
    os << indent << "Pitch: " << this->Pitch << "\n";
    os << indent << "Roll: " << this->Roll << "\n";
    os << indent << "ViewAngle: " << this->ViewAngle << "\n";
    os << indent << "ViewSize: " << this->ViewSize[0] << " " << this->ViewSize[1] << "\n";
    os << indent << "Tolerance: " << this->Tolerance << "\n";
    os << indent << "Keys: " << (this->Keys ? this->Keys : "none") << "\n";
    os << indent << "MaxError: " << this->MaxError << "\n";
}

/// What is known of a panorama before its texels are.
struct vtkAnamorphPanoramaView::Source {
    anamorph::Size size;
    int channels;
};

/// A view, ready to be drawn.
struct vtkAnamorphPanoramaView::View {
    anamorph::ParameterValues values;
    std::unique_ptr<const anamorph::Pictures> pictures;
    anamorph::PictureRequest request;

    /// How many components a view of so many has.
    int components(int of_panorama) const {
        switch (request.pixels) {
            case anamorph::PixelKind::color:
                return of_panorama + (request.adds_alpha ? 1 : 0);
            case anamorph::PixelKind::point:
                return 2;
            case anamorph::PixelKind::vector:
                return 3;
            case anamorph::PixelKind::value:
                break;
        }
        return 1;
    }
    bool shows_color() const { return request.pixels == anamorph::PixelKind::color; }
    /// The view's extent in VTK's image, whose rows go up from the lower edge of the display window.
    void extent(int* all) const {
        const anamorph::Box shown = request.shown();
        all[0] = -shown.x0;
        all[1] = request.size.width - shown.x0 - 1;
        all[2] = shown.y1 - request.size.height;
        all[3] = shown.y1 - 1;
        all[4] = all[5] = 0;
    }
};

vtkAnamorphPanoramaView::View vtkAnamorphPanoramaView::MakeView(const Source& panorama) const {
    check_size(this->ViewSize);
    anamorph::ParameterValues keys(*anamorph::pano_operation().parameters);
    keys.assign(parse_keys(this->Keys));
    check_keys(keys);
    const auto is_given = [&](const char* key) { return keys.given(key); };
    anamorph::ParameterValues values(*anamorph::pano_operation().parameters);
    const anamorph::Projection projection = anamorph::kProjections[this->Projection];
    anamorph::kPanniniDistanceRow.check(this->PanniniDistance, "srcd");
    anamorph::kProjectionAlphaRow.check(this->ProjectionAlpha, "srce");
    anamorph::kVerticalFieldOfViewRow.check(this->VerticalFieldOfView, "srcvfov");
    if (!is_given("from")) {
        values.set("from", std::string(anamorph::name_of(projection)));
        const int numbers = anamorph::numbers_of(projection);
        if (numbers > 0 && !is_given("srcd")) values.set("srcd", this->PanniniDistance);
        if (numbers > 1 && !is_given("srce")) values.set("srce", this->ProjectionAlpha);
    }
    if (!is_given("to") && !is_given("fov") && !is_given("vfov") && !is_given("focal"))
        values.set("fov", this->ViewAngle);
    for (const auto& [key, value] : {std::pair{"yaw", this->Yaw},
                                     {"pitch", this->Pitch},
                                     {"roll", this->Roll},
                                     {"tol", this->Tolerance}})
        if (!is_given(key)) values.set(key, value);
    if (!is_given("size")) values.set("size", anamorph::Size{this->ViewSize[0], this->ViewSize[1]});
    if (this->FieldOfView != 0 && !is_given("srcfov") && !is_given("srcfocal"))
        values.set("srcfov", this->FieldOfView);
    if (this->VerticalFieldOfView != 0 && !is_given("srcvfov"))
        values.set("srcvfov", this->VerticalFieldOfView);
    if (this->Lens && *this->Lens && !is_given("srclens")) values.set("srclens", this->Lens);
    values.assign(parse_keys(this->Keys));

    anamorph::SourceImage source;
    source.facts.width = panorama.size.width;
    source.facts.height = panorama.size.height;
    source.channels = panorama.channels;
    source.alpha = anamorph_vtk::alpha_of(panorama.channels);
    source.facts.has_alpha = source.alpha >= 0;
    const std::vector<anamorph::SourceImage> sources{source};
    auto pictures = anamorph::pano_operation().read({values, sources, {}, NoFiles()});
    anamorph::PictureRequest request = *pictures->picture(0, 0);
    if (std::max(request.size.width, request.size.height) > kMostViewSize)
        throw anamorph::Error(request.sized_by,
                              std::to_string(request.size.width) + "x" + std::to_string(request.size.height),
                              "must be at most " + std::to_string(kMostViewSize) + " each way");
    return {std::move(values), std::move(pictures), std::move(request)};
}

int vtkAnamorphPanoramaView::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                                vtkInformationVector* outputs) {
    const auto tell = [&] {
        vtkInformation* array = this->GetInputArrayFieldInformation(0, inputs);
        const bool known = array && array->Has(vtkDataObject::FIELD_ARRAY_TYPE()) &&
                           array->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS());
        int whole[6] = {0, 0, 0, 0, 0, 0};
        vtkInformation* input = inputs[0]->GetInformationObject(0);
        const bool has_size = input && input->Has(Executive::WHOLE_EXTENT());
        if (has_size) input->Get(Executive::WHOLE_EXTENT(), whole);
        const int components = known ? array->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()) : -1;
        int extent[6] = {0, this->ViewSize[0] - 1, 0, this->ViewSize[1] - 1, 0, 0};
        int type = known ? array->Get(vtkDataObject::FIELD_ARRAY_TYPE()) : -1, told = components;
        check_size(this->ViewSize);
        // Without keys the view is as large as it is said to be, whatever the panorama is, which is then checked when it is drawn.
        if (this->Keys && *this->Keys && has_size && whole[1] >= whole[0] && whole[3] >= whole[2]) {
            const View view = this->MakeView(
                {{whole[1] - whole[0] + 1, whole[3] - whole[2] + 1}, components > 0 ? components : 3});
            view.extent(extent);
            if (!view.shows_color()) type = VTK_FLOAT;
            if (!view.shows_color() || components > 0) told = view.components(components);
        }
        vtkInformation* output = outputs->GetInformationObject(0);
        output->Set(Executive::WHOLE_EXTENT(), extent, 6);
        output->Set(CAN_PRODUCE_SUB_EXTENT(), 1);
        const double spacing[3] = {1, 1, 1}, origin[3] = {0, 0, 0},
                     direction[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};
        output->Set(vtkDataObject::SPACING(), spacing, 3);
        output->Set(vtkDataObject::ORIGIN(), origin, 3);
        output->Set(vtkDataObject::DIRECTION(), direction, 9);
        vtkDataObject::SetPointDataActiveScalarInfo(output, type, told);
    };
    return anamorph_vtk::guarded(this, tell, {vtkDataObject::GetData(outputs)});
}

int vtkAnamorphPanoramaView::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                                 vtkInformationVector*) {
    // Any part of a view may show any part of the panorama.
    anamorph_vtk::ask_for_all({inputs, 1});
    return 1;
}

int vtkAnamorphPanoramaView::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                         vtkInformationVector* outputs) {
    vtkImageData* output = vtkImageData::GetData(outputs);
    output->Initialize();
    this->MaxError = 0;
    return anamorph_vtk::guarded(this,
                                 [&] {
                                     int asked[6];
                                     outputs->GetInformationObject(0)->Get(Executive::UPDATE_EXTENT(), asked);
                                     this->Draw(inputs, asked, output);
                                 },
                                 {output});
}

/// Draws the pixels of an extent of the view.
void vtkAnamorphPanoramaView::Draw(vtkInformationVector** inputs, const int* extent, vtkImageData* output) {
    if (extent[0] > extent[1] || extent[2] > extent[3]) return;
    const anamorph_vtk::ImageTexture panorama(vtkImageData::GetData(inputs[0]),
                                              this->GetInputArrayToProcess(0, inputs), kName);
    const int channels = panorama.view().channels;
    const View view = this->MakeView({panorama.size(), channels});
    int whole[6];
    view.extent(whole);

    output->SetExtent(extent[0], extent[1], extent[2], extent[3], 0, 0);
    output->SetOrigin(0, 0, 0);
    output->SetSpacing(1, 1, 1);
    output->GetFieldData()->PassData(vtkImageData::GetData(inputs[0])->GetFieldData());
    const int components = view.components(channels);
    const auto array = vtkSmartPointer<vtkDataArray>::Take(
        vtkDataArray::CreateDataArray(view.shows_color() ? panorama.type() : VTK_FLOAT));
    array->SetName(array_name(view.values, view.request.pixels).c_str());
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(output->GetNumberOfPoints());
    output->GetPointData()->SetScalars(array);

    anamorph_vtk::Execution execution(this);
    const std::unique_ptr<const anamorph::SolvedPicture> picture = view.request.solve();
    const anamorph::MemorySource base(panorama.view(), anamorph_vtk::alpha_of(channels));
    const std::unique_ptr<anamorph::Source> over = view.pictures->over_source(0, base);
    const anamorph::SourceFaces faces = view.pictures->faces();
    const anamorph::Pyramid source(over ? *over : static_cast<const anamorph::Source&>(base), faces.columns,
                                   faces.rows);
    const anamorph::Box box{extent[0] - whole[0], whole[3] - extent[3], extent[1] + 1 - whole[0],
                            whole[3] + 1 - extent[2]};
    const anamorph::PixelType type = view.shows_color() ? panorama.view().type : anamorph::PixelType::float32;
    if (!picture->draw({&source}, box,
                       anamorph_vtk::turned_over(static_cast<std::byte*>(array->GetVoidPointer(0)), type,
                                                 box.width(), box.height(), components),
                       execution.stage(0.05, 0.95)))
        throw anamorph::Error("the panorama cannot be read");
    for (const anamorph::Attributes& all : {view.request.says, picture->reached(execution.stage(0.95, 1))})
        for (const anamorph::Attribute& attribute : all) {
            if (attribute.name.starts_with("anamorph:")) anamorph_vtk::add_field(attribute, output);
            if (attribute.name == "anamorph:max_error") this->MaxError = std::get<double>(attribute.value);
        }
}
