// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphProjectionBake.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <functional>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/projector/projection_bake.h"
#include "anamorph/projector/projector_rows.h"
#include "automatic_plane.h"
#include "execution.h"
#include "input_times.h"
#include "scene_shadow.h"
#include "vtkCommunicator.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataObjectTree.h"
#include "vtkDataObjectTreeIterator.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkObjectFactoryNewMacro(vtkAnamorphProjectionBake);

struct vtkAnamorphProjectionBake::Projectors {
    std::vector<anamorph::ProjectorPose> all;
};

namespace {

/// Calls `body` with every mesh in a data object, which may be null.
void for_meshes(vtkDataObject* data, const std::function<void(vtkPolyData*)>& body) {
    if (auto* composite = vtkCompositeDataSet::SafeDownCast(data)) {
        const auto leaves = vtk::TakeSmartPointer(composite->NewIterator());
        for (leaves->InitTraversal(); !leaves->IsDoneWithTraversal(); leaves->GoToNextItem())
            for_meshes(leaves->GetCurrentDataObject(), body);
    } else if (auto* mesh = vtkPolyData::SafeDownCast(data)) {
        body(mesh);
    }
}

/// The pixels of an image, rows from the top.
std::vector<float> pixels_of(vtkImageData* image, vtkDataArray* scalars) {
    int size[3];
    image->GetDimensions(size);
    const int channels = scalars->GetNumberOfComponents();
    std::vector<float> pixels;
    pixels.reserve(static_cast<std::size_t>(scalars->GetNumberOfTuples() * channels));
    for (int j = size[1] - 1; j >= 0; --j)
        for (int i = 0; i < size[0]; ++i)
            for (int c = 0; c < channels; ++c)
                pixels.push_back(static_cast<float>(scalars->GetComponent(vtkIdType{j} * size[0] + i, c)));
    return pixels;
}

/// Tells filters behind this one what numbers a texture of these panoramas has, if theirs are known.
void tell_pixels(vtkInformationVector* panoramas, vtkInformation* output) {
    int type = VTK_UNSIGNED_CHAR, channels = 0;
    for (int i = 0; i < panoramas->GetNumberOfInformationObjects(); ++i) {
        vtkInformation* scalars = vtkDataObject::GetActiveFieldInformation(
            panoramas->GetInformationObject(i), vtkDataObject::FIELD_ASSOCIATION_POINTS,
            vtkDataSetAttributes::SCALARS);
        if (!scalars || !scalars->Has(vtkDataObject::FIELD_ARRAY_TYPE()) ||
            !scalars->Has(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS()))
            return;
        if (scalars->Get(vtkDataObject::FIELD_ARRAY_TYPE()) != VTK_UNSIGNED_CHAR) type = VTK_FLOAT;
        channels = scalars->Get(vtkDataObject::FIELD_NUMBER_OF_COMPONENTS());
    }
    if (channels > 0) vtkDataObject::SetPointDataActiveScalarInfo(output, type, channels + 1);
}

/// Which entries are not 0 on any rank, where all have as many.
std::vector<int> on_any_rank(const std::vector<int>& own, vtkMultiProcessController* controller) {
    const int count = static_cast<int>(own.size()), counts[] = {count, -count};
    int least[2] = {};
    controller->AllReduce(counts, least, 2, vtkCommunicator::MIN_OP);
    if (least[0] != -least[1]) throw anamorph::Error("the mesh must have the same blocks on all ranks");
    std::vector<int> any(own);
    controller->AllReduce(own.data(), any.data(), count, vtkCommunicator::MAX_OP);
    return any;
}

/// The rows of every texture of composite data that the piece has which is asked for; where there are more pieces than rows, none.
struct RowsOfPiece {
    int first = 0, end;

    RowsOfPiece(int height, vtkInformation* output) : end(height) {
        using Pipeline = vtkStreamingDemandDrivenPipeline;
        const int pieces = output->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()),
                  piece = output->Get(Pipeline::UPDATE_PIECE_NUMBER());
        if (pieces < 2) return;
        const auto begin = [&](int k) {
            return static_cast<int>(std::int64_t{height} * std::clamp(k, 0, pieces) / pieces);
        };
        first = begin(piece);
        end = begin(piece + 1);
    }
};

void add_field_value(vtkDataObject* object, const char* name, std::int64_t value) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->InsertNextValue(static_cast<double>(value));
    object->GetFieldData()->AddArray(array);
}

}  // namespace

/// One execution of the filter.
struct vtkAnamorphProjectionBake::Run {
    vtkAnamorphProjectionBake& filter;
    vtkInformationVector* images;
    anamorph::ParallelFor parallel_for;
    anamorph::BakeOptions options = {};
    bool bytes = true;
    std::vector<std::vector<float>> pixels = {};
    anamorph_vtk::TriangleList shadow_casters = {};
    std::vector<anamorph::Occluders> occluders = {};
    std::vector<anamorph::ThrownPicture> pictures = {};
    std::vector<anamorph::BakedTriangle> mesh = {};
    bool has_coordinates = true;
    bool own_rows = false;

    /// Of a mesh of triangles.
    void take_mesh(vtkPolyData* triangles);
    /// Whether ranks are asked for rows of which each is one rank's: then they make those, and have no others. What
    /// they are asked for is then in `options`.
    void find_rows(const int* extent);
    /// Puts the meshes of all ranks, as far as they reach into the rows that are held, in the place of this one's.
    void share_mesh();
    void take_pictures();
    void list_occluders(vtkPolyData* triangles, vtkDataObject* others);
    void cast_shadows();
    /// Every rank makes some of the rows, and gets those of the others unless it is asked for its own.
    anamorph::BakedTexture bake_with_others();
    anamorph::BakedTexture bake();
    /// All of it, to a part of an image.
    void bake_to(vtkPolyData* of, vtkDataObject* others, const int* extent, vtkImageData* output);
    void share_rows(anamorph::BakedTexture& texture) const;
    void share_counts(anamorph::BakedTexture& texture) const;
    void hand_over(const anamorph::BakedTexture& texture, const int* extent, vtkImageData* output) const;
};

void vtkAnamorphProjectionBake::Run::take_mesh(vtkPolyData* triangles) {
    vtkDataArray* coordinates = triangles->GetPointData()->GetTCoords();
    const bool known = coordinates && coordinates->GetNumberOfComponents() >= 2;
    anamorph_vtk::for_shown(triangles, [&](const vtkIdType* ids) {
        has_coordinates = known;
        if (!known) return;
        anamorph::BakedTriangle t;
        for (std::size_t k = 0; k < 3; ++k) {
            triangles->GetPoint(ids[k], &t.points[k].x);
            t.coordinates[k] = {coordinates->GetComponent(ids[k], 0), coordinates->GetComponent(ids[k], 1)};
        }
        mesh.push_back(t);
    });
}

void vtkAnamorphProjectionBake::Run::find_rows(const int* extent) {
    const int height = options.size.height;
    if (height < 1) return;
    // Rows of an image run up, those of a texture down.
    const int begin = std::clamp(height - 1 - extent[3], 0, height),
              end = std::clamp(height - extent[2], begin, height);
    std::vector<int> asked(static_cast<std::size_t>(height), 0), ranks(asked);
    if (extent[0] <= extent[1]) std::fill(asked.begin() + begin, asked.begin() + end, 1);
    filter.Controller->AllReduce(asked.data(), ranks.data(), height, vtkCommunicator::SUM_OP);
    own_rows = std::all_of(ranks.begin(), ranks.end(), [](int of) { return of == 1; });
    if (!own_rows) return;
    options.begin_row = begin;
    options.end_row = extent[0] <= extent[1] ? end : begin;
}

void vtkAnamorphProjectionBake::Run::share_mesh() {
    const std::vector<anamorph::BakedTriangle> own = std::move(mesh);
    mesh.clear();
    vtkMultiProcessController* controller = filter.Controller;
    // The rows that a triangle may paint, and one more on either side, as far as they are held.
    const auto reaches = [&](const anamorph::BakedTriangle& t) {
        if (!own_rows) return true;
        double low = HUGE_VAL, high = -HUGE_VAL;
        for (const auto& c : t.coordinates) {
            low = std::min(low, (1 - c.y) * options.size.height);
            high = std::max(high, (1 - c.y) * options.size.height);
        }
        return !(high + options.margin + 2 < options.begin_row || low - options.margin - 2 > options.end_row);
    };
    // One rank's after the other's, so that no rank holds more than one of them beside its own.
    constexpr std::size_t kNumbers = 15;
    for (int rank = 0; rank < controller->GetNumberOfProcesses(); ++rank) {
        vtkIdType count = rank == controller->GetLocalProcessId() ? static_cast<vtkIdType>(own.size()) : 0;
        controller->Broadcast(&count, 1, rank);
        // Some at a time: their numbers are counted with int.
        constexpr vtkIdType kMost = 1 << 18;
        std::vector<double> numbers;
        for (vtkIdType first = 0; first < count; first += kMost) {
            const auto some = static_cast<std::size_t>(std::min(kMost, count - first));
            numbers.assign(some * kNumbers, 0);
            double* to = numbers.data();
            if (rank == controller->GetLocalProcessId())
                for (std::size_t i = 0; i < some; ++i) {
                    const anamorph::BakedTriangle& t = own[static_cast<std::size_t>(first) + i];
                    for (std::size_t k = 0; k < 3; ++k)
                        for (const double number : {t.points[k].x, t.points[k].y, t.points[k].z,
                                                    t.coordinates[k].x, t.coordinates[k].y})
                            *to++ = number;
                }
            controller->Broadcast(numbers.data(), static_cast<vtkIdType>(numbers.size()), rank);
            for (std::size_t i = 0; i < some; ++i) {
                const double* from = &numbers[i * kNumbers];
                anamorph::BakedTriangle t;
                for (std::size_t k = 0; k < 3; ++k, from += 5) {
                    t.points[k] = {from[0], from[1], from[2]};
                    t.coordinates[k] = {from[3], from[4]};
                }
                if (reaches(t)) mesh.push_back(t);
            }
        }
    }
}

void vtkAnamorphProjectionBake::Run::take_pictures() {
    const auto count = static_cast<std::size_t>(images->GetNumberOfInformationObjects());
    const auto& poses = filter.Poses->all;
    if (count != poses.size())
        throw anamorph::Error("projectors", std::to_string(poses.size()),
                              "must be as many as there are panoramas, " + std::to_string(count));
    for (std::size_t i = 0; i < count; ++i) {
        auto* image = vtkImageData::GetData(images, static_cast<int>(i));
        vtkDataArray* scalars = image ? image->GetPointData()->GetScalars() : nullptr;
        if (!scalars || scalars->GetNumberOfTuples() == 0)
            throw anamorph::Error("panorama", std::to_string(i), "must be an image with scalars");
        if (image->GetDimensions()[2] != 1)
            throw anamorph::Error(
                "panorama", std::to_string(i),
                "has " + std::to_string(image->GetDimensions()[2]) + " slices, but must have 1");
        const int channels = scalars->GetNumberOfComponents();
        if (i > 0 && channels != options.channels)
            throw anamorph::Error("panorama", std::to_string(i),
                                  "must have as many components as the others");
        options.channels = channels;
        bytes = bytes && scalars->GetDataType() == VTK_UNSIGNED_CHAR;
        int size[3];
        image->GetDimensions(size);
        const anamorph::ThrownChart thrown{anamorph::kProjections[filter.Projection],
                                           filter.FieldOfView,
                                           filter.VerticalFieldOfView,
                                           filter.PanniniDistance,
                                           filter.ProjectionAlpha,
                                           filter.Lens ? filter.Lens : ""};
        const anamorph::Chart chart = thrown.of({size[0], size[1]});
        pixels.push_back(pixels_of(image, scalars));
        pictures.push_back({anamorph::Projector(chart, poses[i]), nullptr});
    }
    for (std::size_t i = 0; i < count; ++i) pictures[i].pixels = pixels[i].data();
}

void vtkAnamorphProjectionBake::Run::list_occluders(vtkPolyData* triangles, vtkDataObject* others) {
    anamorph_vtk::append_triangles(triangles, shadow_casters);
    for_meshes(others, [&](vtkPolyData* other) {
        anamorph_vtk::append_triangles(anamorph_vtk::triangulated(other), shadow_casters);
    });
    if (anamorph_vtk::distributed(filter.Controller))
        shadow_casters = anamorph_vtk::of_all_ranks(shadow_casters, filter.Controller);
}

void vtkAnamorphProjectionBake::Run::cast_shadows() {
    for (const anamorph::ThrownPicture& picture : pictures)
        occluders.emplace_back(shadow_casters, picture.projector.pose().position);
    for (std::size_t i = 0; i < pictures.size(); ++i) pictures[i].occluders = &occluders[i];
}

anamorph::BakedTexture vtkAnamorphProjectionBake::Run::bake() {
    if (!has_coordinates)
        throw anamorph::Error("mesh", "no texture coordinates",
                              "must have them at its points, 2 numbers each");
    take_pictures();
    if (filter.Occlusion) cast_shadows();
    return anamorph::bake(mesh, pictures, options, parallel_for);
}

anamorph::BakedTexture vtkAnamorphProjectionBake::Run::bake_with_others() {
    vtkMultiProcessController* controller = filter.Controller;
    anamorph::BakedTexture texture;
    std::exception_ptr failure;
    if (!own_rows) {
        options.first_row = controller->GetLocalProcessId();
        options.row_step = controller->GetNumberOfProcesses();
    }
    try {
        texture = bake();
    } catch (...) {
        failure = std::current_exception();
    }
    // Who fails must not leave the others waiting.
    const int channels = failure ? 0 : options.channels, own[] = {channels, -channels};
    int least[2] = {};
    controller->AllReduce(own, least, 2, vtkCommunicator::MIN_OP);
    if (failure) std::rethrow_exception(failure);
    if (least[0] == 0) throw anamorph::Error("another rank could not bake its part of the texture");
    if (least[0] != -least[1]) throw anamorph::Error("panoramas must be the same on all ranks");
    if (!own_rows) share_rows(texture);
    share_counts(texture);
    return texture;
}

void vtkAnamorphProjectionBake::Run::share_rows(anamorph::BakedTexture& texture) const {
    // Some rows at a time: their numbers are counted with int.
    constexpr int kMostNumbers = 1 << 26;
    vtkMultiProcessController* controller = filter.Controller;
    const int ranks = controller->GetNumberOfProcesses(), rank = controller->GetLocalProcessId(),
              row_length = options.size.width * (options.channels + 1),
              most_rows = std::max(1, kMostNumbers / row_length);
    const auto row_of = [&](int j) { return texture.pixels.begin() + std::ptrdiff_t{j} * row_length; };
    for (int top = 0; top < options.size.height; top += most_rows) {
        const int bottom = std::min(top + most_rows, options.size.height);
        const auto rows = [&](int of, const auto& body) {
            for (int j = top + ((of - top) % ranks + ranks) % ranks; j < bottom; j += ranks) body(j);
        };
        std::vector<vtkIdType> counts(static_cast<std::size_t>(ranks)), offsets(counts.size());
        vtkIdType total = 0;
        for (int r = 0; r < ranks; ++r) {
            const auto at = static_cast<std::size_t>(r);
            offsets[at] = total;
            rows(r, [&](int) { counts[at] += row_length; });
            total += counts[at];
        }
        // One more, so that there is an address.
        std::vector<float> mine, all(static_cast<std::size_t>(total) + 1);
        rows(rank, [&](int j) { mine.insert(mine.end(), row_of(j), row_of(j) + row_length); });
        mine.push_back(0);
        controller->AllGatherV(mine.data(), all.data(), counts[static_cast<std::size_t>(rank)], counts.data(),
                               offsets.data());
        auto next = all.begin();
        for (int r = 0; r < ranks; ++r)
            rows(r, [&](int j) {
                std::copy(next, next + row_length, row_of(j));
                next += row_length;
            });
    }
}

void vtkAnamorphProjectionBake::Run::share_counts(anamorph::BakedTexture& texture) const {
    vtkMultiProcessController* controller = filter.Controller;
    const long long own[] = {texture.painted, texture.unseen};
    long long sums[2] = {};
    controller->AllReduce(own, sums, 2, vtkCommunicator::SUM_OP);
    texture.painted = sums[0];
    texture.unseen = sums[1];
}

void vtkAnamorphProjectionBake::Run::hand_over(const anamorph::BakedTexture& texture, const int* extent,
                                               vtkImageData* output) const {
    const int channels = options.channels + 1, width = options.size.width, height = options.size.height;
    output->SetExtent(extent[0], extent[1], extent[2], extent[3], 0, 0);
    output->AllocateScalars(bytes ? VTK_UNSIGNED_CHAR : VTK_FLOAT, channels);
    vtkDataArray* scalars = output->GetPointData()->GetScalars();
    scalars->SetName("Texture");
    vtkIdType next = 0;
    for (int row = extent[2]; row <= extent[3]; ++row)
        for (int i = extent[0]; i <= extent[1]; ++i, ++next)
            for (int c = 0; c < channels; ++c) {
                const float value =
                    texture.pixels[(static_cast<std::size_t>(height - 1 - row - options.begin_row) *
                                        static_cast<std::size_t>(width) +
                                    static_cast<std::size_t>(i)) *
                                       static_cast<std::size_t>(channels) +
                                   static_cast<std::size_t>(c)];
                const double coverage = bytes && c == channels - 1 ? 255 : 1;
                const double out = value * coverage;
                scalars->SetComponent(next, c, bytes ? std::floor(out + 0.5) : out);
            }
    add_field_value(output, "anamorph:painted", texture.painted);
    add_field_value(output, "anamorph:unseen", texture.unseen);
}

void vtkAnamorphProjectionBake::Run::bake_to(vtkPolyData* of, vtkDataObject* others, const int* extent,
                                             vtkImageData* output) {
    options.size = {filter.Width, filter.Height};
    options.fade = filter.Fade;
    options.margin = filter.Margin;
    const vtkSmartPointer<vtkPolyData> triangles = anamorph_vtk::triangulated(of);
    const bool shared = anamorph_vtk::distributed(filter.Controller);
    if (shared) find_rows(extent);
    take_mesh(triangles);
    if (shared) share_mesh();
    if (filter.Occlusion) list_occluders(triangles, others);
    hand_over(shared ? bake_with_others() : bake(), extent, output);
}

void vtkAnamorphProjectionBake::BakeBlocks(vtkDataObjectTree* meshes, vtkInformationVector** inputs,
                                           vtkInformation* output, vtkDataObjectTree* textures) {
    textures->CopyStructure(meshes);
    const auto leaves = vtk::TakeSmartPointer(meshes->NewTreeIterator());
    leaves->SkipEmptyNodesOff();
    std::vector<int> has_mesh;
    for (leaves->InitTraversal(); !leaves->IsDoneWithTraversal(); leaves->GoToNextItem())
        has_mesh.push_back(vtkPolyData::SafeDownCast(leaves->GetCurrentDataObject()) != nullptr);
    if (anamorph_vtk::distributed(this->Controller)) has_mesh = on_any_rank(has_mesh, this->Controller);
    anamorph_vtk::Execution execution(this);
    const auto count = static_cast<double>(has_mesh.size());
    const RowsOfPiece rows(this->Height, output);
    const int extent[] = {0, this->Width - 1, rows.first, rows.end - 1, 0, 0};
    std::size_t k = 0;
    for (leaves->InitTraversal(); !leaves->IsDoneWithTraversal(); leaves->GoToNextItem(), ++k) {
        if (has_mesh[k] == 0) continue;
        vtkSmartPointer<vtkPolyData> mesh = vtkPolyData::SafeDownCast(leaves->GetCurrentDataObject());
        if (!mesh) mesh = vtkSmartPointer<vtkPolyData>::New();
        const vtkNew<vtkImageData> texture;
        const auto at = static_cast<double>(k);
        Run run{*this, inputs[1], execution.stage(at / count, (at + 1) / count)};
        run.bake_to(mesh, vtkDataObject::GetData(inputs[2]), extent, texture);
        textures->SetDataSet(leaves, texture);
    }
}

vtkAnamorphProjectionBake::vtkAnamorphProjectionBake()
    : Poses(std::make_unique<Projectors>()), Controller(vtkMultiProcessController::GetGlobalController()) {
    this->SetNumberOfInputPorts(3);
}

vtkAnamorphProjectionBake::~vtkAnamorphProjectionBake() {
    this->SetLens(nullptr);
}

void vtkAnamorphProjectionBake::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "NumberOfProjectors: " << this->Poses->all.size() << "\n"
       << indent << "Projection: " << anamorph::name_of(anamorph::kProjections[this->Projection]) << "\n"
       << indent << "FieldOfView: " << this->FieldOfView << "\n"
       << indent << "VerticalFieldOfView: " << this->VerticalFieldOfView << "\n"
       << indent << "PanniniDistance: " << this->PanniniDistance << "\n"
       << indent << "ProjectionAlpha: " << this->ProjectionAlpha << "\n"
       << indent << "Lens: " << (this->Lens ? this->Lens : "(none)") << "\n"
       << indent << "Width: " << this->Width << "\n"
       << indent << "Height: " << this->Height << "\n"
       << indent << "Fade: " << this->Fade << "\n"
       << indent << "Margin: " << this->Margin << "\n"
       << indent << "Occlusion: " << this->Occlusion << "\n"
       << indent << "Controller: " << this->Controller.Get() << "\n";
}

void vtkAnamorphProjectionBake::SetController(vtkMultiProcessController* controller) {
    if (controller == this->Controller) return;
    this->Controller = controller;
    this->Modified();
}

vtkMultiProcessController* vtkAnamorphProjectionBake::GetController() {
    return this->Controller;
}

void vtkAnamorphProjectionBake::AddProjector(double x, double y, double z, double dx, double dy, double dz,
                                             double ux, double uy, double uz) {
    this->Poses->all.push_back({{x, y, z}, {dx, dy, dz}, {ux, uy, uz}});
    this->Modified();
}

void vtkAnamorphProjectionBake::RemoveAllProjectors() {
    if (this->Poses->all.empty()) return;
    this->Poses->all.clear();
    this->Modified();
}

int vtkAnamorphProjectionBake::GetNumberOfProjectors() {
    return static_cast<int>(this->Poses->all.size());
}

int vtkAnamorphProjectionBake::FillInputPortInformation(int port, vtkInformation* info) {
    info->Set(INPUT_REQUIRED_DATA_TYPE(), port == 1 ? "vtkImageData" : "vtkPolyData");
    if (port == 1) info->Set(INPUT_IS_REPEATABLE(), 1);
    info->Set(INPUT_IS_OPTIONAL(), 1);  // has_inputs() tells of the first two in our own words
    // Of meshes, ranks take the same block at the same time; all blocks cast shadows at once.
    if (port != 1) info->Append(INPUT_REQUIRED_DATA_TYPE(), "vtkCompositeDataSet");
    return 1;
}

int vtkAnamorphProjectionBake::FillOutputPortInformation(int, vtkInformation* info) {
    info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataObject");
    return 1;
}

vtkTypeBool vtkAnamorphProjectionBake::ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                                                      vtkInformationVector* outputs) {
    if (!anamorph_vtk::has_inputs(this, {"the mesh", "the panorama"})) return 0;
    if (request->Has(vtkDemandDrivenPipeline::REQUEST_DATA_OBJECT())) {
        vtkDataObject* input = vtkDataObject::GetData(inputs[0]);
        const vtkNew<vtkImageData> image;
        anamorph_vtk::make_output(outputs->GetInformationObject(0),
                                  vtkDataObjectTree::SafeDownCast(input) ? input : image.Get());
        return 1;
    }
    return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkAnamorphProjectionBake::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                                  vtkInformationVector* outputs) {
    vtkInformation* info = outputs->GetInformationObject(0);
    const int extent[6] = {0, std::max(this->Width, 1) - 1, 0, std::max(this->Height, 1) - 1, 0, 0};
    info->Set(vtkStreamingDemandDrivenPipeline::WHOLE_EXTENT(), extent, 6);
    tell_pixels(inputs[1], info);
    anamorph_vtk::tell_times({inputs, 3}, info);
    return 1;
}

int vtkAnamorphProjectionBake::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                                   vtkInformationVector*) {
    using Pipeline = vtkStreamingDemandDrivenPipeline;
    // All of every panorama, whatever is asked for.
    for (int i = 0; i < inputs[1]->GetNumberOfInformationObjects(); ++i) {
        vtkInformation* info = inputs[1]->GetInformationObject(i);
        info->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
        info->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
        if (info->Has(Pipeline::WHOLE_EXTENT()))
            info->Set(Pipeline::UPDATE_EXTENT(), info->Get(Pipeline::WHOLE_EXTENT()), 6);
    }
    // And all of every mesh, of which ranks share out their pieces.
    if (anamorph_vtk::distributed(this->Controller)) return 1;
    for (const int port : {0, 2})
        if (vtkInformation* info = inputs[port]->GetInformationObject(0)) {
            info->Set(Pipeline::UPDATE_PIECE_NUMBER(), 0);
            info->Set(Pipeline::UPDATE_NUMBER_OF_PIECES(), 1);
            info->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
        }
    return 1;
}

int vtkAnamorphProjectionBake::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                           vtkInformationVector* outputs) {
    vtkInformation* info = outputs->GetInformationObject(0);
    vtkDataObject *input = vtkDataObject::GetData(inputs[0]), *output = vtkDataObject::GetData(info);
    const auto execute = [&] {
        if (auto* meshes = vtkDataObjectTree::SafeDownCast(input)) {
            this->BakeBlocks(meshes, inputs, info, vtkDataObjectTree::SafeDownCast(output));
        } else {
            anamorph_vtk::Execution execution(this);
            Run run{*this, inputs[1], execution.stage(0, 1)};
            run.bake_to(vtkPolyData::SafeDownCast(input), vtkDataObject::GetData(inputs[2]),
                        info->Get(vtkStreamingDemandDrivenPipeline::UPDATE_EXTENT()),
                        vtkImageData::SafeDownCast(output));
        }
        anamorph_vtk::hand_over_time({inputs, 3}, output);
    };
    return anamorph_vtk::guarded(this, execute, {output});
}
