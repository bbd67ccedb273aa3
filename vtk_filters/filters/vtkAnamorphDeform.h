// SPDX-License-Identifier: Apache-2.0
#ifndef vtkAnamorphDeform_h
#define vtkAnamorphDeform_h

#include "AnamorphFiltersModule.h"
#include "vtkPassInputTypeAlgorithm.h"

class ANAMORPHFILTERS_EXPORT vtkAnamorphDeform : public vtkPassInputTypeAlgorithm {
  public:
    static vtkAnamorphDeform* New();
    vtkTypeMacro(vtkAnamorphDeform, vtkPassInputTypeAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

  protected:
    vtkAnamorphDeform();
    ~vtkAnamorphDeform() override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphDeform(const vtkAnamorphDeform&) = delete;
    void operator=(const vtkAnamorphDeform&) = delete;
};

#endif
