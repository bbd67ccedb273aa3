// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphSliceDomain
 * @brief   Inputs that are a picture: images of one slice, with point arrays.
 *
 * A vtkSMInputArrayDomain that looks at the extent as well: menus do not offer filters of pictures for volumes.
 */
#ifndef vtkSMAnamorphSliceDomain_h
#define vtkSMAnamorphSliceDomain_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMInputArrayDomain.h"

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphSliceDomain : public vtkSMInputArrayDomain {
  public:
    static vtkSMAnamorphSliceDomain* New();
    vtkTypeMacro(vtkSMAnamorphSliceDomain, vtkSMInputArrayDomain);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    int IsInDomain(vtkSMProperty* property) override;

  protected:
    vtkSMAnamorphSliceDomain();
    ~vtkSMAnamorphSliceDomain() override;

  private:
    vtkSMAnamorphSliceDomain(const vtkSMAnamorphSliceDomain&) = delete;
    void operator=(const vtkSMAnamorphSliceDomain&) = delete;
};

#endif
