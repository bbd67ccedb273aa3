// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphSubdivisionDomain
 * @brief   How often a surface is subdivided for the bump that a new list of deformations begins with.
 *
 * The default is what vtkAnamorphDeform::AddDefaultDeformation() makes of it on the input, and 0 with another list.
 */
#ifndef vtkSMAnamorphSubdivisionDomain_h
#define vtkSMAnamorphSubdivisionDomain_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMIntRangeDomain.h"

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphSubdivisionDomain : public vtkSMIntRangeDomain {
  public:
    static vtkSMAnamorphSubdivisionDomain* New();
    vtkTypeMacro(vtkSMAnamorphSubdivisionDomain, vtkSMIntRangeDomain);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    int SetDefaultValues(vtkSMProperty* property, bool use_unchecked_values) override;

  protected:
    vtkSMAnamorphSubdivisionDomain();
    ~vtkSMAnamorphSubdivisionDomain() override;

  private:
    vtkSMAnamorphSubdivisionDomain(const vtkSMAnamorphSubdivisionDomain&) = delete;
    void operator=(const vtkSMAnamorphSubdivisionDomain&) = delete;
};

#endif
