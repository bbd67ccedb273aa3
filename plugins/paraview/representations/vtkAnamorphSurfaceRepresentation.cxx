// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphSurfaceRepresentation.h"

#include "vtkAnamorphFigureGeometry.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkAnamorphSurfaceRepresentation);

vtkAnamorphSurfaceRepresentation::vtkAnamorphSurfaceRepresentation() {
    this->Geometry->SetToleranceMode(vtkAnamorphFigureGeometry::PIXELS);
}

vtkAnamorphSurfaceRepresentation::~vtkAnamorphSurfaceRepresentation() = default;

vtkAnamorphFigureAlgorithm* vtkAnamorphSurfaceRepresentation::GetFilter() {
    return this->Geometry;
}

void vtkAnamorphSurfaceRepresentation::SetTolerance(double tolerance) {
    this->Geometry->SetTolerance(tolerance);
}
