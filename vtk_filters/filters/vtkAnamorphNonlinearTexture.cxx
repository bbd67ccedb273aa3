// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphNonlinearTexture.h"

#include <string>

#include "anamorph/error.h"
#include "anamorph/surface/nonlinear_texture.h"
#include "attribute_fields.h"
#include "execution.h"
#include "scene_shadow.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDataSetAttributes.h"
#include "vtkDoubleArray.h"
#include "vtkFieldData.h"
#include "vtkIdList.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

vtkObjectFactoryNewMacro(vtkAnamorphNonlinearTexture);

namespace {

using anamorph::surface::CutMesh;
using anamorph::surface::TexturedMesh;

/// The texture coordinates of a mesh. Throws Error.
vtkDataArray* coordinates_of(vtkPolyData* mesh) {
    vtkDataArray* coordinates = mesh->GetPointData()->GetTCoords();
    if (!coordinates)
        throw anamorph::Error("the mesh has no texture coordinates: its points must have an array of them");
    const std::string name = coordinates->GetName() ? coordinates->GetName() : "texture coordinates";
    if (coordinates->GetNumberOfComponents() != 2)
        throw anamorph::Error(name, std::to_string(coordinates->GetNumberOfComponents()) + " components",
                              "must have 2 components");
    if (coordinates->GetNumberOfTuples() != mesh->GetNumberOfPoints())
        throw anamorph::Error(
            name, std::to_string(coordinates->GetNumberOfTuples()) + " tuples",
            "must have one for each of " + std::to_string(mesh->GetNumberOfPoints()) + " points");
    return coordinates;
}

/// A mesh of triangles as the core takes it.
TexturedMesh textured(vtkPolyData* triangles) {
    TexturedMesh mesh;
    vtkDataArray* coordinates = triangles->GetPointData()->GetTCoords();
    const vtkIdType points = triangles->GetNumberOfPoints();
    mesh.points.resize(static_cast<std::size_t>(points));
    mesh.texture.resize(mesh.points.size());
    for (vtkIdType i = 0; i < points; ++i) {
        const auto at = static_cast<std::size_t>(i);
        triangles->GetPoint(i, &mesh.points[at].x);
        mesh.texture[at] = {coordinates->GetComponent(i, 0), coordinates->GetComponent(i, 1)};
    }
    vtkCellArray* cells = triangles->GetPolys();
    for (vtkIdType i = 0; i < cells->GetNumberOfCells(); ++i) {
        vtkIdType count = 0;
        const vtkIdType* ids = nullptr;
        cells->GetCellAtId(i, count, ids);
        mesh.triangles.push_back({ids[0], ids[1], ids[2]});
    }
    return mesh;
}

/// A mesh that was cut as VTK has it, with the arrays of what it was cut of.
void hand_over(vtkPolyData* given, const TexturedMesh& mesh, const CutMesh& cut, vtkPolyData* output) {
    const vtkIdType old_points = given->GetNumberOfPoints();
    const vtkIdType all_points = old_points + static_cast<vtkIdType>(cut.points.size());
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(all_points);
    vtkDataArray* old_coordinates = given->GetPointData()->GetTCoords();
    vtkNew<vtkDoubleArray> coordinates;
    coordinates->SetName(old_coordinates->GetName());
    coordinates->SetNumberOfComponents(2);
    coordinates->SetNumberOfTuples(all_points);

    vtkPointData* arrays = output->GetPointData();
    arrays->CopyGlobalIdsOff();
    arrays->CopyPedigreeIdsOff();
    arrays->CopyTCoordsOff();
    arrays->CopyFieldOff(vtkDataSetAttributes::GhostArrayName());
    arrays->InterpolateAllocate(given->GetPointData(), all_points);
    vtkNew<vtkIdList> ids;
    for (vtkIdType i = 0; i < old_points; ++i) {
        const auto at = static_cast<std::size_t>(i);
        points->SetPoint(i, &mesh.points[at].x);
        coordinates->SetTuple2(i, mesh.texture[at].x, mesh.texture[at].y);
        arrays->CopyData(given->GetPointData(), i, i);
    }
    for (vtkIdType i = old_points; i < all_points; ++i) {
        const auto& point = cut.points[static_cast<std::size_t>(i - old_points)];
        points->SetPoint(i, &point.place.x);
        coordinates->SetTuple2(i, point.texture.x, point.texture.y);
        // Corners without a weight may have what is no number.
        ids->Reset();
        double weights[3];
        for (std::size_t k = 0; k < 3; ++k)
            if (point.weights[k] != 0) {
                weights[ids->GetNumberOfIds()] = point.weights[k];
                ids->InsertNextId(mesh.triangles[static_cast<std::size_t>(point.triangle)][k]);
            }
        arrays->InterpolatePoint(given->GetPointData(), i, ids, weights);
    }
    arrays->SetTCoords(coordinates);

    vtkNew<vtkCellArray> cells;
    vtkCellData* cell_arrays = output->GetCellData();
    cell_arrays->CopyGlobalIdsOff();
    cell_arrays->CopyAllocate(given->GetCellData(), static_cast<vtkIdType>(cut.triangles.size()));
    for (const CutMesh::Triangle& triangle : cut.triangles) {
        const vtkIdType corners[] = {triangle.points[0], triangle.points[1], triangle.points[2]};
        const vtkIdType id = cells->InsertNextCell(3, corners);
        cell_arrays->CopyData(given->GetCellData(), triangle.triangle, id);
    }
    output->SetPoints(points);
    output->SetPolys(cells);
}

}  // namespace

void vtkAnamorphNonlinearTexture::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "TextureWidth: " << this->TextureWidth << "\n"
       << indent << "TextureHeight: " << this->TextureHeight << "\n"
       << indent << "Tolerance: " << this->Tolerance << "\n";
}

int vtkAnamorphNonlinearTexture::FillInputPortInformation(int port, vtkInformation* info) {
    info->Set(INPUT_IS_OPTIONAL(), 1);  // has_inputs() tells of the mesh in our own words
    return this->Superclass::FillInputPortInformation(port, info);
}

vtkTypeBool vtkAnamorphNonlinearTexture::ProcessRequest(vtkInformation* request,
                                                        vtkInformationVector** inputs,
                                                        vtkInformationVector* outputs) {
    if (!anamorph_vtk::has_inputs(this, {"the mesh"})) return 0;
    return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkAnamorphNonlinearTexture::RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs,
                                                     vtkInformationVector* outputs) {
    using Pipeline = vtkStreamingDemandDrivenPipeline;
    vtkInformation *input = inputs[0]->GetInformationObject(0), *output = outputs->GetInformationObject(0);
    // Slopes at a point are fitted to all triangles about it.
    if (output->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) > 1)
        input->Set(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS(),
                   output->Get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS()) + 1);
    return 1;
}

int vtkAnamorphNonlinearTexture::RequestData(vtkInformation*, vtkInformationVector** inputs,
                                             vtkInformationVector* outputs) {
    using Pipeline = vtkStreamingDemandDrivenPipeline;
    vtkPolyData* input = vtkPolyData::GetData(inputs[0]);
    vtkPolyData* output = vtkPolyData::GetData(outputs);
    const auto execute = [&] {
        anamorph_vtk::Execution execution(this);
        const anamorph::Size size{this->TextureWidth, this->TextureHeight};
        anamorph::surface::check_texture(size, this->Tolerance);
        CutMesh cut;
        if (input->GetNumberOfPoints() > 0 && input->GetNumberOfCells() > 0) {
            coordinates_of(input);
            const vtkSmartPointer<vtkPolyData> triangles = anamorph_vtk::triangulated(input);
            TexturedMesh mesh = textured(triangles);
            execution.progress(0.1);
            mesh.slopes = anamorph::surface::fitted_slopes(mesh, execution.stage(0.1, 0.3));
            cut = cut_texture(mesh, size, this->Tolerance, execution.stage(0.3, 0.8));
            hand_over(triangles, mesh, cut, output);
        }
        output->GetFieldData()->PassData(input->GetFieldData());
        anamorph_vtk::add_field({"anamorph:tol", this->Tolerance}, output);
        anamorph_vtk::add_field({"anamorph:max_error", cut.max_error}, output);
        anamorph_vtk::add_field({"anamorph:not_finite", static_cast<int>(cut.not_finite)}, output);
        vtkInformation* asked = outputs->GetInformationObject(0);
        if (asked->Get(Pipeline::UPDATE_NUMBER_OF_PIECES()) > 1 &&
            asked->Get(Pipeline::UPDATE_NUMBER_OF_GHOST_LEVELS()) == 0)
            output->RemoveGhostCells();
        execution.progress(1);
    };
    return anamorph_vtk::guarded(this, execute, {output});
}
