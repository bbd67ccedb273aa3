// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphPanoramaProjection.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/geometry/size.h"
#include "anamorph/projector/projected_triangles.h"
#include "anamorph/projector/projector_rows.h"
#include "automatic_plane.h"
#include "cell_corners.h"
#include "execution.h"
#include "input_times.h"
#include "painted_mesh.h"
#include "panorama_picture.h"
#include "scene_shadow.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkCommunicator.h"
#include "vtkCompositeDataIterator.h"
#include "vtkDataObjectTree.h"
#include "vtkDataSet.h"
#include "vtkDataSetSurfaceFilter.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkUnsignedCharArray.h"

vtkObjectFactoryNewMacro(vtkAnamorphPanoramaProjection);

namespace {

using anamorph::PaintedTriangle;
using anamorph::Painting;
using anamorph_vtk::distributed;
using anamorph_vtk::TriangleList;

static_assert(std::size(anamorph::kProjections) == vtkAnamorphPanoramaProjection::NumberOfProjections);

/// The surface of a data set, in triangles.
vtkSmartPointer<vtkPolyData> triangles_of(vtkDataSet* data) {
    vtkSmartPointer<vtkPolyData> surface = vtkPolyData::SafeDownCast(data);
    if (!surface && data->GetNumberOfCells() > 0) {
        const auto copy = vtkSmartPointer<vtkDataSet>::Take(data->NewInstance());
        copy->ShallowCopy(data);
        if (auto* points = vtkPointSet::SafeDownCast(data)) anamorph_vtk::check_corners(points);
        vtkNew<vtkDataSetSurfaceFilter> filter;
        filter->SetInputData(copy);
        filter->Update();
        surface = filter->GetOutput();
    }
    if (!surface || surface->GetNumberOfCells() == 0) return vtkSmartPointer<vtkPolyData>::New();
    return anamorph_vtk::triangulated(surface);
}

/// The data sets of an input, in order.
std::vector<vtkDataSet*> leaves_of(vtkDataObject* input) {
    std::vector<vtkDataSet*> leaves;
    if (auto* tree = vtkDataObjectTree::SafeDownCast(input)) {
        const auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(tree->NewIterator());
        for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
            if (auto* leaf = vtkDataSet::SafeDownCast(iterator->GetCurrentDataObject()))
                leaves.push_back(leaf);
    } else if (auto* data = vtkDataSet::SafeDownCast(input))
        leaves.push_back(data);
    return leaves;
}

/// Puts meshes in the places of the data sets of a tree, or gives the one to a mesh.
void hand_out(vtkDataObject* input, const std::vector<vtkSmartPointer<vtkPolyData>>& meshes,
              vtkDataObject* output) {
    auto* tree = vtkDataObjectTree::SafeDownCast(input);
    if (!tree) {
        if (!meshes.empty()) output->ShallowCopy(meshes[0]);
        return;
    }
    auto* copies = vtkDataObjectTree::SafeDownCast(output);
    copies->CopyStructure(tree);
    if (vtkFieldData* fields = tree->GetFieldData()) copies->GetFieldData()->PassData(fields);
    std::size_t next = 0;
    const auto iterator = vtkSmartPointer<vtkCompositeDataIterator>::Take(tree->NewIterator());
    for (iterator->InitTraversal(); !iterator->IsDoneWithTraversal(); iterator->GoToNextItem())
        if (vtkDataSet::SafeDownCast(iterator->GetCurrentDataObject()))
            copies->SetDataSet(iterator, meshes[next++]);
}

void add_field_value(vtkDataObject* object, const char* name, double value) {
    vtkNew<vtkDoubleArray> array;
    array->SetName(name);
    array->InsertNextValue(value);
    object->GetFieldData()->AddArray(array);
}

glm::dvec3 vector(const double* v) {
    return {v[0], v[1], v[2]};
}

}  // namespace

vtkAnamorphPanoramaProjection::vtkAnamorphPanoramaProjection()
    : Controller(vtkMultiProcessController::GetGlobalController()) {
    this->SetNumberOfInputPorts(2);
    this->SetNumberOfOutputPorts(2);
}

vtkAnamorphPanoramaProjection::~vtkAnamorphPanoramaProjection() {
    this->SetLens(nullptr);
}

void vtkAnamorphPanoramaProjection::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    const auto write = [&](const char* name, const double* v) {
        os << indent << name << ": " << v[0] << " " << v[1] << " " << v[2] << "\n";
    };
    os << indent << "Projection: " << anamorph::name_of(anamorph::kProjections[this->Projection]) << "\n"
       << indent << "PanoramaWidth: " << this->PanoramaWidth << "\n"
       << indent << "PanoramaHeight: " << this->PanoramaHeight << "\n"
       << indent << "FieldOfView: " << this->FieldOfView << "\n"
       << indent << "VerticalFieldOfView: " << this->VerticalFieldOfView << "\n"
       << indent << "PanniniDistance: " << this->PanniniDistance << "\n"
       << indent << "ProjectionAlpha: " << this->ProjectionAlpha << "\n"
       << indent << "Lens: " << (this->Lens ? this->Lens : "(none)") << "\n";
    write("Position", this->Position);
    write("Direction", this->Direction);
    write("ViewUp", this->ViewUp);
    os << indent << "Tolerance: " << this->Tolerance << "\n"
       << indent << "Occlusion: " << this->Occlusion << "\n"
       << indent << "Picture: " << (this->Picture.empty() ? "(none)" : this->Picture) << "\n"
       << indent << "TimeBudget: " << this->TimeBudget << "\n"
       << indent << "UsedTolerance: " << this->UsedTolerance << "\n"
       << indent << "Controller: " << this->Controller.Get() << "\n";
}

void vtkAnamorphPanoramaProjection::SetTimeBudget(double seconds) {
    if (!(seconds > 0)) seconds = 0;
    if (seconds == this->TimeBudget) return;
    this->TimeBudget = seconds;
    this->Modified();
}

void vtkAnamorphPanoramaProjection::SetController(vtkMultiProcessController* controller) {
    if (controller == this->Controller) return;
    this->Controller = controller;
    this->Modified();
}

vtkMultiProcessController* vtkAnamorphPanoramaProjection::GetController() {
    return this->Controller;
}

vtkTypeBool vtkAnamorphPanoramaProjection::ProcessRequest(vtkInformation* request,
                                                          vtkInformationVector** inputs,
                                                          vtkInformationVector* outputs) {
    if (!anamorph_vtk::has_inputs(this, {"the scene"})) return 0;
    return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkAnamorphPanoramaProjection::FillInputPortInformation(int, vtkInformation* info) {
    // Trees first: the pipeline then leaves the leaves to us, as they hide each other.
    info->Remove(INPUT_REQUIRED_DATA_TYPE());
    info->Append(INPUT_REQUIRED_DATA_TYPE(), "vtkDataObjectTree");
    info->Append(INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet");
    info->Set(INPUT_IS_OPTIONAL(), 1);  // has_inputs() tells of the scene in our own words
    return 1;
}

int vtkAnamorphPanoramaProjection::FillOutputPortInformation(int, vtkInformation* info) {
    info->Set(vtkDataObject::DATA_TYPE_NAME(), "vtkDataObject");
    return 1;
}

int vtkAnamorphPanoramaProjection::RequestDataObject(vtkInformation*, vtkInformationVector** inputs,
                                                     vtkInformationVector* outputs) {
    vtkDataObject* input = vtkDataObject::GetData(inputs[0]);
    if (!input) return 0;
    const bool tree = vtkDataObjectTree::SafeDownCast(input) != nullptr;
    const vtkNew<vtkPolyData> mesh;
    for (int port = 0; port < 2; ++port)
        anamorph_vtk::make_output(outputs->GetInformationObject(port), tree ? input : mesh.Get());
    return 1;
}

int vtkAnamorphPanoramaProjection::RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                                                      vtkInformationVector* outputs) {
    for (int port = 0; port < 2; ++port)
        anamorph_vtk::tell_times({inputs, 2}, outputs->GetInformationObject(port));
    return 1;
}

int vtkAnamorphPanoramaProjection::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                                       vtkInformationVector*) {
    using Pipeline = vtkStreamingDemandDrivenPipeline;
    // The surface of a volume is not that of its pieces.
    vtkInformation* input = inputs[0]->GetInformationObject(0);
    if (input && input->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) > 1 &&
        !vtkPolyData::SafeDownCast(input->Get(vtkDataObject::DATA_OBJECT())))
        input->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(),
                   input->Get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS()) + 1);
    return 1;
}

/// The file that was read last; it is read again where it has been written since.
struct vtkAnamorphPanoramaProjection::LoadedPicture {
    std::string path;
    std::filesystem::file_time_type written;
    anamorph_vtk::PanoramaPicture picture;
};

/// One execution of the filter, step by step.
struct vtkAnamorphPanoramaProjection::Run {
    vtkAnamorphPanoramaProjection& filter;
    anamorph_vtk::Execution execution{&filter};
    std::vector<vtkSmartPointer<vtkPolyData>> scene = {}, painted = {}, rest = {};
    std::optional<anamorph::Occluders> shadow = {};
    std::unique_ptr<anamorph::ScenePainter> painter = {};
    const anamorph_vtk::PanoramaPicture* picture = nullptr;
    anamorph::Size size{filter.PanoramaWidth, filter.PanoramaHeight};
    double tol = 0;

    void take_scene(vtkDataObject* input, vtkDataObject* occluders);
    void cast_shadows(const std::vector<vtkSmartPointer<vtkPolyData>>& occluders);
    void read_picture();
    void make_painter();
    /// Cuts all at one tolerance, for progress from a number to another. Returns the seconds that the slowest rank took.
    double paint_all(double at, double begin, double end);
    /// Cuts until Tolerance is held, or the next cut would exceed the time.
    void paint_within_budget();
    /// The size of the scene that all ranks have and the way to the projector: lengths compare with it.
    double scene_size() const;
    void paint(vtkPolyData* mesh, double begin, double end);
    void hand_over(vtkPolyData* mesh, const std::vector<std::vector<PaintedTriangle>>& pieces,
                   const anamorph::PaintedCounts& counts);
};

void vtkAnamorphPanoramaProjection::Run::take_scene(vtkDataObject* input, vtkDataObject* occluders) {
    for (vtkDataSet* leaf : leaves_of(input)) scene.push_back(triangles_of(leaf));
    if (!filter.Occlusion) return;
    std::vector<vtkSmartPointer<vtkPolyData>> all = scene;
    for (vtkDataSet* leaf : leaves_of(occluders)) all.push_back(triangles_of(leaf));
    cast_shadows(all);
}

void vtkAnamorphPanoramaProjection::Run::cast_shadows(
    const std::vector<vtkSmartPointer<vtkPolyData>>& occluders) {
    TriangleList triangles;
    for (vtkPolyData* mesh : occluders) anamorph_vtk::append_triangles(mesh, triangles);
    if (distributed(filter.Controller)) triangles = anamorph_vtk::of_all_ranks(triangles, filter.Controller);
    shadow.emplace(triangles, vector(filter.Position));
}

double vtkAnamorphPanoramaProjection::Run::scene_size() const {
    // Less the least, and the most: both are found as maxima.
    double far[6];
    for (int i = 0; i < 3; ++i) far[i] = -(far[3 + i] = filter.Position[i]);
    for (vtkPolyData* mesh : scene)
        for (vtkIdType p = 0; p < mesh->GetNumberOfPoints(); ++p) {
            double x[3];
            mesh->GetPoint(p, x);
            for (int i = 0; i < 3 && std::isfinite(x[0] + x[1] + x[2]); ++i) {
                far[i] = std::max(far[i], -x[i]);
                far[3 + i] = std::max(far[3 + i], x[i]);
            }
        }
    if (distributed(filter.Controller)) {
        double all[6];
        filter.Controller->AllReduce(far, all, 6, vtkCommunicator::MAX_OP);
        std::copy(all, all + 6, far);
    }
    return std::max({far[0] + far[3], far[1] + far[4], far[2] + far[5]});
}

void vtkAnamorphPanoramaProjection::Run::make_painter() {
    const anamorph::ThrownChart thrown{anamorph::kProjections[filter.Projection],
                                       filter.FieldOfView,
                                       filter.VerticalFieldOfView,
                                       filter.PanniniDistance,
                                       filter.ProjectionAlpha,
                                       filter.Lens ? filter.Lens : ""};
    const anamorph::Chart panorama = thrown.of({size.width, size.height});
    const anamorph::Projector projector(
        panorama, {vector(filter.Position), vector(filter.Direction), vector(filter.ViewUp)});
    anamorph::ProjectionOptions options;
    options.tol = tol;
    options.smallest = std::min(scene_size(), 1e300) * 0x1p-22;
    for (vtkPolyData* mesh : scene)
        options.single =
            options.single || (mesh->GetPoints() && mesh->GetPoints()->GetDataType() == VTK_FLOAT);
    if (shadow) options.occluders = &*shadow;
    painter = std::make_unique<anamorph::ScenePainter>(projector, options);
}

void vtkAnamorphPanoramaProjection::Run::paint(vtkPolyData* mesh, double begin, double end) {
    const vtkIdType cells = mesh->GetNumberOfPolys();
    std::vector<std::vector<PaintedTriangle>> pieces(static_cast<std::size_t>(cells));
    std::vector<anamorph::PaintedCounts> counts(static_cast<std::size_t>(cells));
    const double middle = begin + (end - begin) * 0.75;
    vtkCellArray* polygons = mesh->GetPolys();
    const auto paint_cell = [&](std::int64_t cell) {
        vtkNew<vtkIdList> ids;
        polygons->GetCellAtId(cell, ids);
        std::array<glm::dvec3, 3> corners;
        for (std::size_t i = 0; i < 3; ++i)
            mesh->GetPoints()->GetPoint(ids->GetId(static_cast<int>(i)), &corners[i].x);
        const auto at = static_cast<std::size_t>(cell);
        counts[at] = painter->paint(corners, pieces[at]);
    };
    if (cells > 0) execution.stage(begin, middle)(cells, paint_cell);
    anamorph::PaintedCounts sum;
    for (const anamorph::PaintedCounts& one : counts) sum += one;
    hand_over(mesh, pieces, sum);
    execution.progress(end);
}

void vtkAnamorphPanoramaProjection::Run::hand_over(vtkPolyData* mesh,
                                                   const std::vector<std::vector<PaintedTriangle>>& pieces,
                                                   const anamorph::PaintedCounts& counts) {
    anamorph_vtk::PaintedMesh with(mesh, &size), without(mesh, nullptr);
    vtkNew<vtkUnsignedCharArray> why;
    why->SetName("Painting");
    for (std::size_t cell = 0; cell < pieces.size(); ++cell) {
        const auto id = static_cast<vtkIdType>(cell);
        vtkIdType count = 0;
        const vtkIdType* ids = nullptr;
        mesh->GetPolys()->GetCellAtId(id, count, ids);
        const std::array<vtkIdType, 3> corners{ids[0], ids[1], ids[2]};
        for (const PaintedTriangle& piece : pieces[cell]) {
            const bool is_painted = piece.painting == Painting::painted;
            (is_painted ? with : without).add(piece, id, corners);
            if (!is_painted) why->InsertNextValue(static_cast<unsigned char>(piece.painting));
        }
    }
    for (auto* to : {&painted, &rest}) {
        to->push_back(vtkSmartPointer<vtkPolyData>::New());
        (to == &painted ? with : without).finish(to->back());
        add_field_value(to->back(), "anamorph:tol", tol);
        add_field_value(to->back(), "anamorph:max_error", counts.max_error);
        add_field_value(to->back(), "anamorph:no_direction", static_cast<double>(counts.no_direction));
    }
    rest.back()->GetCellData()->AddArray(why);
    if (picture) picture->add_to(painted.back()->GetFieldData());
}

void vtkAnamorphPanoramaProjection::Run::read_picture() {
    if (filter.Picture.empty()) return;
    std::error_code ignored;
    const auto written = std::filesystem::last_write_time(filter.Picture, ignored);
    if (!filter.Loaded || filter.Loaded->path != filter.Picture || filter.Loaded->written != written)
        filter.Loaded = std::make_shared<const LoadedPicture>(
            LoadedPicture{filter.Picture, written, anamorph_vtk::PanoramaPicture(filter.Picture)});
    picture = &filter.Loaded->picture;
    size = picture->size();
}

double vtkAnamorphPanoramaProjection::Run::paint_all(double at, double begin, double end) {
    const auto start = std::chrono::steady_clock::now();
    tol = at;
    painted.clear();
    rest.clear();
    make_painter();
    const double share = (end - begin) / static_cast<double>(std::max<std::size_t>(scene.size(), 1));
    for (std::size_t i = 0; i < scene.size(); ++i)
        paint(scene[i], begin + share * static_cast<double>(i), begin + share * static_cast<double>(i + 1));
    double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (distributed(filter.Controller)) {
        double most = seconds;
        filter.Controller->AllReduce(&seconds, &most, 1, vtkCommunicator::MAX_OP);
        seconds = most;
    }
    return seconds;
}

void vtkAnamorphPanoramaProjection::Run::paint_within_budget() {
    constexpr double kFirst = 4096, kStep = 4;
    double at = filter.Tolerance, begin = 0, spent = 0;
    const double most = anamorph::kProjectionTolRow.most;
    if (filter.TimeBudget > 0 && at > 0) at = std::max(at, std::min(at * kFirst, most));
    for (;;) {
        const bool last = at == filter.Tolerance;
        const double end = last ? 1 : (1 + begin) / 2;
        const double seconds = paint_all(at, begin, end);
        spent += seconds;
        begin = end;
        // Errors go with the square of a triangle's size: a quarter of the tolerance takes four times as many triangles.
        if (last || !(spent + kStep * seconds <= filter.TimeBudget)) break;
        at = std::max(filter.Tolerance, at / kStep);
    }
    filter.UsedTolerance = tol;
    execution.progress(1);
}

int vtkAnamorphPanoramaProjection::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                               vtkInformationVector* outputs) {
    vtkDataObject* input = vtkDataObject::GetData(inputs[0]);
    const auto execute = [&] {
        Run run{*this};
        run.take_scene(input, vtkDataObject::GetData(inputs[1]));
        run.read_picture();
        run.paint_within_budget();
        hand_out(input, run.painted, vtkDataObject::GetData(outputs, 0));
        hand_out(input, run.rest, vtkDataObject::GetData(outputs, 1));
        for (int port = 0; port < 2; ++port)
            anamorph_vtk::hand_over_time({inputs, 2}, vtkDataObject::GetData(outputs, port));
    };
    return anamorph_vtk::guarded(this, execute,
                                 {vtkDataObject::GetData(outputs, 0), vtkDataObject::GetData(outputs, 1)});
}
