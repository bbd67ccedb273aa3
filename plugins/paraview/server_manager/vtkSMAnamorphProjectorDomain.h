// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphProjectorDomain
 * @brief   Where a new projector stands, and where it looks.
 *
 * The default of a property of three numbers, by the attribute `of`: Position is the centre of the input's bounds. Where the
 * input is flat it is half its diagonal before that, and Direction looks at it; otherwise Direction, and ViewUp unless that would be
 * along Direction, keep the defaults of their XML.
 */
#ifndef vtkSMAnamorphProjectorDomain_h
#define vtkSMAnamorphProjectorDomain_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMDoubleRangeDomain.h"

#include <string>  // for the name

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphProjectorDomain : public vtkSMDoubleRangeDomain {
  public:
    static vtkSMAnamorphProjectorDomain* New();
    vtkTypeMacro(vtkSMAnamorphProjectorDomain, vtkSMDoubleRangeDomain);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    int SetDefaultValues(vtkSMProperty* property, bool use_unchecked_values) override;

  protected:
    vtkSMAnamorphProjectorDomain();
    ~vtkSMAnamorphProjectorDomain() override;

    int ReadXMLAttributes(vtkSMProperty* property, vtkPVXMLElement* element) override;

  private:
    vtkSMAnamorphProjectorDomain(const vtkSMAnamorphProjectorDomain&) = delete;
    void operator=(const vtkSMAnamorphProjectorDomain&) = delete;

    std::string Of;
};

#endif
