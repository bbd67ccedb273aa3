// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphBlendShapeWriter.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>

#include "anamorph/deform/shapes_file.h"
#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "execution.h"
#include "explicit_points.h"
#include "vtkCellArray.h"
#include "vtkCellArrayIterator.h"
#include "vtkCompositeDataIterator.h"
#include "vtkCompositeDataSet.h"
#include "vtkDataArray.h"
#include "vtkDataSetSurfaceFilter.h"
#include "vtkErrorCode.h"
#include "vtkFieldData.h"
#include "vtkIdTypeArray.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkMultiBlockDataSet.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPolyData.h"
#include "vtkSmartPointer.h"
#include "vtkStreamingDemandDrivenPipeline.h"
#include "vtkTriangleFilter.h"

vtkObjectFactoryNewMacro(vtkAnamorphBlendShapeWriter);

namespace {

using anamorph::BlendShapes;
using anamorph::Error;
using anamorph::ShapePart;
using anamorph::ShapePoints;
using Executive = vtkStreamingDemandDrivenPipeline;

constexpr int kMostKeys = 1 << 20;

/// The data of one shape, and its name if it has one.
struct Shape {
    vtkDataObject* data;
    std::string name;
};

std::vector<Shape> shapes_of(vtkAlgorithm* writer) {
    std::vector<Shape> shapes;
    for (int i = 0; i < writer->GetNumberOfInputConnections(0); ++i)
        shapes.push_back({writer->GetInputDataObject(0, i), ""});
    auto* blocks = shapes.size() == 1 ? vtkMultiBlockDataSet::SafeDownCast(shapes[0].data) : nullptr;
    if (!blocks) return shapes;
    shapes.clear();
    for (unsigned int i = 0; i < blocks->GetNumberOfBlocks(); ++i) {
        const char* name =
            blocks->HasMetaData(i) ? blocks->GetMetaData(i)->Get(vtkCompositeDataSet::NAME()) : nullptr;
        shapes.push_back({blocks->GetBlock(i), name ? name : ""});
    }
    return shapes;
}

/// A part of a shape: the points of a data set, and its name among several.
struct Part {
    vtkSmartPointer<vtkPointSet> points;
    std::string name;
    unsigned int place;
};

std::vector<Part> parts_of(vtkDataObject* data, const std::string& shape) {
    std::vector<Part> parts;
    const auto add = [&](vtkDataObject* leaf, const std::string& name, unsigned int place) {
        parts.push_back({anamorph_vtk::with_explicit_points(leaf), name, place});
        if (!parts.back().points)
            throw Error(shape + " has a " + leaf->GetClassName() +
                        ", but must have point sets, image data or rectilinear grids");
    };
    auto* composite = vtkCompositeDataSet::SafeDownCast(data);
    if (!composite) {
        if (data) add(data, "", 0);
        return parts;
    }
    const auto at = vtk::TakeSmartPointer(composite->NewIterator());
    for (at->InitTraversal(); !at->IsDoneWithTraversal(); at->GoToNextItem()) {
        const char* name =
            at->HasCurrentMetaData() ? at->GetCurrentMetaData()->Get(vtkCompositeDataSet::NAME()) : nullptr;
        add(at->GetCurrentDataObject(), name ? name : "", at->GetCurrentFlatIndex());
    }
    return parts;
}

/// The surface of a data set in triangles, lines and points.
struct Surface {
    std::vector<vtkIdType> points;  ///< of the data set, those that the surface has
    std::vector<std::uint32_t> triangles, lines, vertices;
};

/// The points of cells of one size, by their new numbers; longer lines are taken apart.
std::vector<std::uint32_t> indices_of(vtkCellArray* cells, vtkIdType size,
                                      const std::vector<std::uint32_t>& numbers) {
    std::vector<std::uint32_t> indices;
    const auto at = vtk::TakeSmartPointer(cells->NewIterator());
    for (at->GoToFirstCell(); !at->IsDoneWithTraversal(); at->GoToNextCell()) {
        vtkIdType count;
        const vtkIdType* points;
        at->GetCurrentCell(count, points);
        const vtkIdType step = size == 2 ? 1 : size;
        for (vtkIdType first = 0; first + size <= count; first += step)
            for (vtkIdType k = 0; k < size; ++k)
                indices.push_back(numbers[static_cast<std::size_t>(points[first + k])]);
    }
    return indices;
}

Surface surface_of(vtkPointSet* data) {
    Surface surface;
    std::vector<std::uint32_t> numbers;  // of the surface's points, each once
    vtkSmartPointer<vtkPolyData> poly = vtkPolyData::SafeDownCast(data);
    if (poly) {
        for (vtkIdType i = 0; i < poly->GetNumberOfPoints(); ++i) {
            numbers.push_back(static_cast<std::uint32_t>(i));
            surface.points.push_back(i);
        }
    } else {
        vtkNew<vtkDataSetSurfaceFilter> filter;
        filter->SetInputData(data);
        filter->PassThroughPointIdsOn();
        filter->SetOriginalPointIdsName("anamorph:points");
        filter->Update();
        poly = filter->GetOutput();
        auto* ids = vtkIdTypeArray::SafeDownCast(poly->GetPointData()->GetAbstractArray("anamorph:points"));
        // Faces of a grid have points of their own, of the same place.
        std::map<vtkIdType, std::uint32_t> known;
        for (vtkIdType i = 0; ids && i < ids->GetNumberOfTuples(); ++i) {
            const auto [at, added] =
                known.emplace(ids->GetValue(i), static_cast<std::uint32_t>(surface.points.size()));
            if (added) surface.points.push_back(ids->GetValue(i));
            numbers.push_back(at->second);
        }
    }
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(poly);
    triangles->Update();
    surface.triangles = indices_of(triangles->GetOutput()->GetPolys(), 3, numbers);
    surface.lines = indices_of(triangles->GetOutput()->GetLines(), 2, numbers);
    surface.vertices = indices_of(triangles->GetOutput()->GetVerts(), 1, numbers);
    return surface;
}

std::vector<std::array<double, 3>> triples_of(vtkDataArray* array, const std::vector<vtkIdType>& points) {
    std::vector<std::array<double, 3>> triples;
    triples.reserve(points.size());
    for (const vtkIdType point : points) array->GetTuple(point, triples.emplace_back().data());
    return triples;
}

ShapePoints shape_points(vtkPointSet* data, const std::vector<vtkIdType>& points) {
    ShapePoints shape;
    if (points.empty()) return shape;
    shape.points = triples_of(data->GetPoints()->GetData(), points);
    vtkDataArray* normals = data->GetPointData()->GetNormals();
    if (normals && normals->GetNumberOfTuples() == data->GetNumberOfPoints())
        shape.normals = triples_of(normals, points);
    return shape;
}

/// One part in all shapes.
ShapePart part_in(const std::vector<std::vector<Part>>& parts, std::size_t number,
                  const std::vector<std::string>& names) {
    const Part& base = parts[0][number];
    ShapePart part;
    part.name = base.name;
    if (base.points->GetNumberOfPoints() > 0xfffffffeLL) throw Error("the base has too many points for glTF");
    const Surface surface = surface_of(base.points);
    for (std::size_t i = 0; i < parts.size(); ++i) {
        vtkPointSet* data = parts[i][number].points;
        if (data->GetNumberOfPoints() != base.points->GetNumberOfPoints() ||
            parts[i][number].place != base.place)
            throw Error(names[i] + " has " + std::to_string(data->GetNumberOfPoints()) + " points at block " +
                        std::to_string(base.place) + ", but must have " +
                        std::to_string(base.points->GetNumberOfPoints()) + ", as the base has");
        part.shapes.push_back(shape_points(data, surface.points));
    }
    vtkDataArray* texture = base.points->GetPointData()->GetTCoords();
    if (texture && texture->GetNumberOfComponents() >= 2)
        for (const vtkIdType point : surface.points)
            part.texture.push_back({texture->GetComponent(point, 0), texture->GetComponent(point, 1)});
    part.triangles = surface.triangles;
    part.lines = surface.lines;
    part.vertices = surface.vertices;
    return part;
}

/// The weights that a data set has been blended by, of so many shapes beside the base; none if it does not say.
std::vector<double> weights_of(vtkDataObject* data) {
    vtkDataArray* array = data ? data->GetFieldData()->GetArray("anamorph:weights") : nullptr;
    std::vector<double> weights;
    for (vtkIdType i = 0; array && i < array->GetNumberOfValues(); ++i)
        weights.push_back(array->GetComponent(i / array->GetNumberOfComponents(),
                                              static_cast<int>(i % array->GetNumberOfComponents())));
    return weights;
}

void write_bytes(const std::string& path, const std::string& bytes) {
    std::ofstream out(path, std::ios::binary);
    out.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    out.close();
    if (!out) throw Error("FileName", path, "it cannot be written");
}

std::string ending_of(const std::filesystem::path& path) {
    std::string ending = path.extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

/// Keys as frames of the shapes beside the base, of which there are `count`. The base has no weight of its own.
template <class Keys>
anamorph::KeyFrames frames_of(const Keys& keys, std::size_t count, anamorph::KeyInterpolation interpolation) {
    std::vector<anamorph::ShapeKey> rows;
    for (const auto& key : keys) rows.push_back({key.Time, key.Shape, key.Weight});
    anamorph::ShapeFrames frames =
        anamorph::frames_of_keys(rows, static_cast<int>(count) + 1, "Shape", "a shape");
    for (std::vector<double>& weights : frames.weights) weights.erase(weights.begin());
    return {frames.times, frames.weights, interpolation};
}

}  // namespace

vtkAnamorphBlendShapeWriter::vtkAnamorphBlendShapeWriter() = default;
vtkAnamorphBlendShapeWriter::~vtkAnamorphBlendShapeWriter() {
    delete[] this->FileName;
}

int vtkAnamorphBlendShapeWriter::FillInputPortInformation(int, vtkInformation* info) {
    info->Set(INPUT_REQUIRED_DATA_TYPE(), "vtkDataObject");
    info->Set(INPUT_IS_REPEATABLE(), 1);
    return 1;
}

void vtkAnamorphBlendShapeWriter::SetNumberOfShapeNames(int count) {
    const auto size = static_cast<std::size_t>(std::clamp(count, 0, kMostKeys));
    if (size == this->ShapeNames.size()) return;
    this->ShapeNames.resize(size);
    this->Modified();
}

void vtkAnamorphBlendShapeWriter::SetShapeName(int index, const char* name) {
    if (index < 0 || index >= kMostKeys) {
        vtkErrorMacro(<< "ShapeName index=" << index << ": must be an integer from 0 to " << kMostKeys - 1);
        return;
    }
    if (index >= this->GetNumberOfShapeNames()) this->SetNumberOfShapeNames(index + 1);
    std::string& at = this->ShapeNames[static_cast<std::size_t>(index)];
    if (at == (name ? name : "")) return;
    at = name ? name : "";
    this->Modified();
}

const char* vtkAnamorphBlendShapeWriter::GetShapeName(int index) {
    return index < 0 || index >= this->GetNumberOfShapeNames()
               ? ""
               : this->ShapeNames[static_cast<std::size_t>(index)].c_str();
}

void vtkAnamorphBlendShapeWriter::SetNumberOfKeys(int count) {
    const auto size = static_cast<std::size_t>(std::clamp(count, 0, kMostKeys));
    if (size == this->Keys.size()) return;
    this->Keys.resize(size);
    this->Modified();
}

void vtkAnamorphBlendShapeWriter::SetKeyNumbers(int index, double time, double shape, double weight) {
    if (index < 0 || index >= kMostKeys) {
        vtkErrorMacro(<< "Key index=" << index << ": must be an integer from 0 to " << kMostKeys - 1);
        return;
    }
    if (index >= this->GetNumberOfKeys()) this->SetNumberOfKeys(index + 1);
    const Key key{time, shape, weight};
    if (this->Keys[static_cast<std::size_t>(index)] == key) return;
    this->Keys[static_cast<std::size_t>(index)] = key;
    this->Modified();
}

void vtkAnamorphBlendShapeWriter::AddKey(double time, int shape, double weight) {
    this->SetKeyNumbers(this->GetNumberOfKeys(), time, shape, weight);
}

/// Where weights are those of the input's time steps, it is asked for each of them before anything is written.
vtkTypeBool vtkAnamorphBlendShapeWriter::ProcessRequest(vtkInformation* request,
                                                        vtkInformationVector** inputs,
                                                        vtkInformationVector* outputs) {
    const int count = inputs[0]->GetNumberOfInformationObjects();
    if (request->Has(vtkDemandDrivenPipeline::REQUEST_INFORMATION())) {
        this->Times.clear();
        this->TimeWeights.clear();
        vtkInformation* input = count == 1 ? inputs[0]->GetInformationObject(0) : nullptr;
        if (input && this->Keys.empty() && input->Has(Executive::TIME_STEPS())) {
            const double* steps = input->Get(Executive::TIME_STEPS());
            this->Times.assign(steps, steps + input->Length(Executive::TIME_STEPS()));
        }
    }
    if (request->Has(Executive::REQUEST_UPDATE_EXTENT()) && this->TimeWeights.size() < this->Times.size())
        inputs[0]->GetInformationObject(0)->Set(Executive::UPDATE_TIME_STEP(),
                                                this->Times[this->TimeWeights.size()]);
    return this->Superclass::ProcessRequest(request, inputs, outputs);
}

int vtkAnamorphBlendShapeWriter::RequestData(vtkInformation* request, vtkInformationVector** inputs,
                                             vtkInformationVector* outputs) {
    if (this->TimeWeights.size() < this->Times.size()) {
        this->TimeWeights.push_back(weights_of(this->GetInputDataObject(0, 0)));
        if (this->TimeWeights.back().empty()) this->Times.clear();  // none says its weights
        if (this->TimeWeights.size() < this->Times.size()) {
            request->Set(Executive::CONTINUE_EXECUTING(), 1);
            return 1;
        }
        request->Remove(Executive::CONTINUE_EXECUTING());
    }
    return this->Superclass::RequestData(request, inputs, outputs);
}

void vtkAnamorphBlendShapeWriter::WriteData() {
    const auto write = [&] {
        if (!this->FileName || !*this->FileName)
            throw Error("FileName", "", "must be the name of a .glb or .gltf");
        const std::filesystem::path path(this->FileName);
        const std::string ending = ending_of(path);
        if (ending != ".glb" && ending != ".gltf")
            throw Error("FileName", this->FileName, "must end in .glb or .gltf");
        auto* controller = vtkMultiProcessController::GetGlobalController();
        if (controller && controller->GetNumberOfProcesses() > 1)
            throw Error("blend shapes are written by one rank alone, not by " +
                        std::to_string(controller->GetNumberOfProcesses()));

        const std::vector<Shape> given = shapes_of(this);
        std::vector<std::string> names;
        std::vector<std::vector<Part>> parts;
        for (std::size_t i = 0; i < given.size(); ++i) {
            std::string name = this->GetShapeName(static_cast<int>(i));
            if (name.empty()) name = given[i].name;
            if (name.empty()) name = i == 0 ? "base" : "shape " + std::to_string(i);
            names.push_back(name);
            parts.push_back(parts_of(given[i].data, name));
            if (parts[i].size() != parts[0].size())
                throw Error(name + " has " + std::to_string(parts[i].size()) + " blocks, but must have " +
                            std::to_string(parts[0].size()) + ", as the base has");
        }
        BlendShapes shapes;
        shapes.interpolation = static_cast<anamorph::KeyInterpolation>(this->Interpolation);
        if (!names.empty()) shapes.names.assign(names.begin() + 1, names.end());
        for (std::size_t k = 0; !parts.empty() && k < parts[0].size(); ++k)
            shapes.parts.push_back(part_in(parts, k, names));
        if (shapes.parts.size() == 1 && shapes.parts[0].name.empty()) shapes.parts[0].name = names[0];

        const std::size_t count = shapes.names.size();
        if (!this->Keys.empty()) {
            shapes.keys = frames_of(this->Keys, count, shapes.interpolation);
        } else if (!this->Times.empty()) {
            shapes.keys.emplace(this->Times, this->TimeWeights, shapes.interpolation);
        } else if (this->GetNumberOfInputConnections(0) == 1) {
            shapes.weights = weights_of(this->GetInputDataObject(0, 0));
            if (!shapes.weights.empty() && shapes.weights.size() != count)
                throw Error("anamorph:weights", std::to_string(shapes.weights.size()) + " numbers",
                            "must be as many as the shapes beside the base, " + std::to_string(count));
        }
        const bool apart = ending == ".gltf";
        std::filesystem::path beside = path;
        beside.replace_extension(".bin");
        const anamorph::ShapesFile file =
            anamorph::shapes_file(shapes, apart ? beside.filename().string() : std::string());
        if (apart) write_bytes(beside.string(), file.buffer);
        write_bytes(path.string(), file.bytes);
        this->MaxError = file.max_error;
    };
    this->SetErrorCode(anamorph_vtk::guarded(this, write) ? vtkErrorCode::NoError
                                                          : vtkErrorCode::UnknownError);
}

void vtkAnamorphBlendShapeWriter::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "FileName: " << (this->FileName ? this->FileName : "") << "\n"
       << indent << "Interpolation: " << this->Interpolation << "\n"
       << indent << "MaxError: " << this->MaxError << "\n"
       << indent << "ShapeNames:";
    for (const std::string& name : this->ShapeNames) os << " \"" << name << "\"";
    os << "\n" << indent << "Keys (time, shape, weight):";
    for (const Key& key : this->Keys)
        os << " (" << key.Time << ", " << key.Shape << ", " << key.Weight << ")";
    os << "\n";
}
