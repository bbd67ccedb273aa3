// SPDX-License-Identifier: Apache-2.0
#include "figure_lines.h"

#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkPointData.h"
#include "vtkPolyData.h"
#include "vtkStringArray.h"

namespace anamorph_vtk {

Bodies::Bodies(vtkPolyData* data) {
    const FigureData figures(data);
    auto* of_points = vtkStringArray::SafeDownCast(data->GetPointData()->GetAbstractArray("Name"));
    if (of_points && of_points->GetNumberOfValues() < figures.size()) of_points = nullptr;
    for (vtkIdType i = 0; i < figures.size(); ++i)
        if (const auto shape = figures.ellipsoid(i)) {
            shapes.push_back(*shape);
            ids.push_back(i);
            names.push_back(of_points ? std::string(of_points->GetValue(i)) : std::to_string(i));
        }
    std::vector<int> position(static_cast<std::size_t>(figures.size()), -1);
    for (std::size_t i = 0; i < ids.size(); ++i)
        position[static_cast<std::size_t>(ids[i])] = static_cast<int>(i);
    for (anamorph::figure::Joint joint : joints_of(data)) {
        joint.first = position[static_cast<std::size_t>(joint.first)];
        joint.second = position[static_cast<std::size_t>(joint.second)];
        if (joint.first >= 0 && joint.second >= 0) joints.push_back(joint);
    }
}

LineWriter::LineWriter(vtkPolyData* input, int precision, std::vector<const char*> names)
    : m_input(input), m_names(std::move(names)) {
    m_points->SetDataType(precision == 1 ? VTK_DOUBLE : VTK_FLOAT);
}

void LineWriter::add(const std::vector<glm::dvec3>& points, vtkIdType body,
                     const std::vector<double>& numbers) {
    if (points.empty()) return;
    const bool closed = points.size() > 3 && points.front() == points.back();
    const vtkIdType first = m_points->GetNumberOfPoints(),
                    count = static_cast<vtkIdType>(points.size()) - (closed ? 1 : 0);
    for (vtkIdType i = 0; i < count; ++i) {
        const glm::dvec3& p = points[static_cast<std::size_t>(i)];
        m_points->InsertNextPoint(p.x, p.y, p.z);
    }
    Cells& cells = points.size() == 1 ? m_vertices : m_lines;
    cells.cells->InsertNextCell(static_cast<int>(points.size()));
    for (vtkIdType i = 0; i < count; ++i) cells.cells->InsertCellPoint(first + i);
    if (closed) cells.cells->InsertCellPoint(first);
    cells.bodies.push_back(body);
    cells.numbers.push_back(numbers);
}

void LineWriter::write(vtkPolyData* output) {
    output->SetPoints(m_points);
    output->SetVerts(m_vertices.cells);
    output->SetLines(m_lines.cells);
    vtkCellData* data = output->GetCellData();
    allocate_cell_data(m_input, output->GetNumberOfCells(), data);
    vtkNew<vtkIdTypeArray> bodies;
    bodies->SetName("BodyId");
    std::vector<vtkNew<vtkDoubleArray>> numbers(m_names.size());
    for (std::size_t k = 0; k < m_names.size(); ++k) numbers[k]->SetName(m_names[k]);
    for (const Cells* cells : {&m_vertices, &m_lines})  // in the order of vtkPolyData's cells
        for (std::size_t i = 0; i < cells->bodies.size(); ++i) {
            data->CopyData(m_input->GetPointData(), cells->bodies[i], bodies->GetNumberOfTuples());
            bodies->InsertNextValue(cells->bodies[i]);
            for (std::size_t k = 0; k < m_names.size(); ++k)
                numbers[k]->InsertNextValue(cells->numbers[i][k]);
        }
    data->AddArray(bodies);
    for (const auto& array : numbers) data->AddArray(array);
}

}  // namespace anamorph_vtk
