// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphDeformationDomain
 * @brief   What a new list of deformations begins with: one that shows.
 *
 * The default of the properties that a list consists of: what vtkAnamorphDeform::AddDefaultDeformation() makes on the input, each
 * property its part of it.
 */
#ifndef vtkSMAnamorphDeformationDomain_h
#define vtkSMAnamorphDeformationDomain_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMDoubleRangeDomain.h"

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphDeformationDomain : public vtkSMDoubleRangeDomain {
  public:
    static vtkSMAnamorphDeformationDomain* New();
    vtkTypeMacro(vtkSMAnamorphDeformationDomain, vtkSMDoubleRangeDomain);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    int SetDefaultValues(vtkSMProperty* property, bool use_unchecked_values) override;

  protected:
    vtkSMAnamorphDeformationDomain();
    ~vtkSMAnamorphDeformationDomain() override;

  private:
    vtkSMAnamorphDeformationDomain(const vtkSMAnamorphDeformationDomain&) = delete;
    void operator=(const vtkSMAnamorphDeformationDomain&) = delete;
};

#endif
