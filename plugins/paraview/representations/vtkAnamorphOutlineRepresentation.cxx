// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphOutlineRepresentation.h"

#include "vtkAnamorphFigureOutline.h"
#include "vtkObjectFactory.h"

vtkStandardNewMacro(vtkAnamorphOutlineRepresentation);

vtkAnamorphOutlineRepresentation::vtkAnamorphOutlineRepresentation() = default;
vtkAnamorphOutlineRepresentation::~vtkAnamorphOutlineRepresentation() = default;

vtkAnamorphFigureAlgorithm* vtkAnamorphOutlineRepresentation::GetFilter() {
    return this->Outline;
}

void vtkAnamorphOutlineRepresentation::SetHidden(int hidden) {
    this->Outline->SetHidden(hidden);
}

void vtkAnamorphOutlineRepresentation::SetCrossings(bool crossings) {
    this->Outline->SetCrossings(crossings);
}

void vtkAnamorphOutlineRepresentation::SetConnected(bool connected) {
    this->Outline->SetConnected(connected);
}

void vtkAnamorphOutlineRepresentation::SetTolerance(double tolerance) {
    this->Outline->SetTolerance(tolerance);
}
