// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphDeformationDomain
 * @brief   What a new deformation looks like: in the middle of the input, of a size that can be seen.
 *
 * The default of a list of deformations: one, at the centre of the input's bounds, whose extents are a sixth
 * of its sizes and whose vector, along the normal of the plane, is a tenth of its diagonal.
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
