// SPDX-License-Identifier: Apache-2.0
// All points of any data set, with their arrays and a vertex each. (vtkConvertToPointCloud of VTK 9.2 crashes where a
// data set is empty, as it is on most ranks.)
#pragma once

#include "vtkPolyDataAlgorithm.h"

class PointsOfData : public vtkPolyDataAlgorithm {
  public:
    static PointsOfData* New();
    vtkTypeMacro(PointsOfData, vtkPolyDataAlgorithm);

  protected:
    int FillInputPortInformation(int port, vtkInformation* information) override;
    int RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) override;
};
