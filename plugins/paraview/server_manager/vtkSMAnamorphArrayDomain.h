// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphArrayDomain
 * @brief   Inputs that have an array of a name, or texture coordinates.
 *
 * A vtkSMDomain that asks for the array of points of its attribute array_name, or, where active_tcoords is 1, for active
 * texture coordinates, with one of the numbers of components that number_of_components has, separated by commas: menus offer filters of
 * figures where there are figures. It is no vtkSMInputArrayDomain, of which they would say that any array is missing.
 */
#ifndef vtkSMAnamorphArrayDomain_h
#define vtkSMAnamorphArrayDomain_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMDomain.h"

#include <string>  // for the name
#include <vector>  // for the components

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphArrayDomain : public vtkSMDomain {
  public:
    static vtkSMAnamorphArrayDomain* New();
    vtkTypeMacro(vtkSMAnamorphArrayDomain, vtkSMDomain);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    int IsInDomain(vtkSMProperty* property) override;

  protected:
    vtkSMAnamorphArrayDomain();
    ~vtkSMAnamorphArrayDomain() override;

    int ReadXMLAttributes(vtkSMProperty* property, vtkPVXMLElement* element) override;

  private:
    vtkSMAnamorphArrayDomain(const vtkSMAnamorphArrayDomain&) = delete;
    void operator=(const vtkSMAnamorphArrayDomain&) = delete;

    std::string ArrayName;             ///< empty: texture coordinates
    std::vector<int> ComponentCounts;  ///< that are allowed
};

#endif
