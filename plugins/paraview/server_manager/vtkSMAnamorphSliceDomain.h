// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphSliceDomain
 * @brief   Inputs that are a picture: images of one slice.
 *
 * A vtkSMDomain that looks at the extent alone, so that menus do not offer filters of pictures for volumes. It is no vtkSMInputArrayDomain, of which they
 * would say that an array is missing.
 */
#ifndef vtkSMAnamorphSliceDomain_h
#define vtkSMAnamorphSliceDomain_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMDomain.h"

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphSliceDomain : public vtkSMDomain {
  public:
    static vtkSMAnamorphSliceDomain* New();
    vtkTypeMacro(vtkSMAnamorphSliceDomain, vtkSMDomain);
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
