// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphArrayDomain
 * @brief   Inputs that have an array of a name, or texture coordinates.
 *
 * A vtkSMInputArrayDomain that asks for the array of its attribute array_name as well, or, where active_tcoords is 1, for active
 * texture coordinates, of any of the numbers of components that it allows: menus offer filters of figures where there are figures.
 */
#ifndef vtkSMAnamorphArrayDomain_h
#define vtkSMAnamorphArrayDomain_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMInputArrayDomain.h"

#include <string>  // for the name

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphArrayDomain : public vtkSMInputArrayDomain {
  public:
    static vtkSMAnamorphArrayDomain* New();
    vtkTypeMacro(vtkSMAnamorphArrayDomain, vtkSMInputArrayDomain);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    int IsInDomain(vtkSMProperty* property) override;

  protected:
    vtkSMAnamorphArrayDomain();
    ~vtkSMAnamorphArrayDomain() override;

    int ReadXMLAttributes(vtkSMProperty* property, vtkPVXMLElement* element) override;

  private:
    vtkSMAnamorphArrayDomain(const vtkSMAnamorphArrayDomain&) = delete;
    void operator=(const vtkSMAnamorphArrayDomain&) = delete;

    std::string ArrayName;  ///< empty: texture coordinates
};

#endif
