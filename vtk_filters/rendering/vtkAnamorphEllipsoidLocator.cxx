// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphEllipsoidLocator.h"

#include <algorithm>

#include "vtkAnamorphEllipsoidMapper.h"
#include "vtkDataSet.h"
#include "vtkGenericCell.h"
#include "vtkObjectFactory.h"

vtkObjectFactoryNewMacro(vtkAnamorphEllipsoidLocator);

vtkAnamorphEllipsoidLocator::vtkAnamorphEllipsoidLocator() = default;
vtkAnamorphEllipsoidLocator::~vtkAnamorphEllipsoidLocator() = default;

void vtkAnamorphEllipsoidLocator::SetMapper(vtkAnamorphEllipsoidMapper* mapper) {
    if (this->Mapper == mapper) return;
    this->Mapper = mapper;
    this->Modified();
}

vtkAnamorphEllipsoidMapper* vtkAnamorphEllipsoidLocator::GetMapper() {
    return this->Mapper;
}

int vtkAnamorphEllipsoidLocator::IntersectWithLine(const double p1[3], const double p2[3], double, double& t,
                                                   double x[3], double pcoords[3], int& subId,
                                                   vtkIdType& cellId, vtkGenericCell* cell) {
    cellId = -1;
    subId = 0;
    if (!this->Mapper || !this->DataSet) return 0;
    const vtkIdType point = this->Mapper->IntersectWithLine(this->DataSet, p1, p2, t, cellId);
    if (cellId < 0) return 0;
    for (int k = 0; k < 3; ++k) {
        x[k] = p1[k] + t * (p2[k] - p1[k]);
        pcoords[k] = 0;
    }
    if (!cell) return 1;
    // Where the point is in its cell: pickers ask for the point next to that.
    this->DataSet->GetCell(cellId, cell);
    const vtkIdType at = cell->GetPointIds()->IsId(point);
    const double* places = cell->IsPrimaryCell() ? cell->GetParametricCoords() : nullptr;
    if (places)
        std::copy_n(places + 3 * at, 3, pcoords);
    else
        subId = static_cast<int>(at);
    return 1;
}

void vtkAnamorphEllipsoidLocator::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "Mapper: " << this->Mapper.GetPointer() << "\n";
}
