// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphSourceProxy
 * @brief   A proxy of a filter that says so when a list of rows is given numbers that are not whole rows.
 *
 * ParaView gives the filter the whole rows of a property with number_of_elements_per_command, and drops the rest in
 * silence.
 */
#ifndef vtkSMAnamorphSourceProxy_h
#define vtkSMAnamorphSourceProxy_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMSourceProxy.h"

#include <set>     // for properties
#include <string>  // for their names

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphSourceProxy : public vtkSMSourceProxy {
  public:
    static vtkSMAnamorphSourceProxy* New();
    vtkTypeMacro(vtkSMAnamorphSourceProxy, vtkSMSourceProxy);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** Says for each list that has changed whether its rows are whole. */
    void UpdateVTKObjects() override;

  protected:
    vtkSMAnamorphSourceProxy();
    ~vtkSMAnamorphSourceProxy() override;

    void SetPropertyModifiedFlag(const char* name, int flag) override;

  private:
    vtkSMAnamorphSourceProxy(const vtkSMAnamorphSourceProxy&) = delete;
    void operator=(const vtkSMAnamorphSourceProxy&) = delete;

    std::set<std::string> Changed;
};

#endif
