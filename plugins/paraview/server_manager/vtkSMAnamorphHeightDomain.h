// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkSMAnamorphHeightDomain
 * @brief   Any number, by default the factor with which a relief rises by a tenth of its plane.
 *
 * A vtkSMDoubleRangeDomain without ends for the factor of heights of vtkAnamorphReliefSource, whose plane is 1 long: its default is 0.1 over
 * the range of the numbers that are the height, from the least to the greatest, as filters take them: whole numbers as fractions of the
 * largest one of their type, which make pictures, count as 0 to 1. So do numbers that are all the same or not known.
 *
 * Required properties: "Input", and of that "Array" and "Component".
 */
#ifndef vtkSMAnamorphHeightDomain_h
#define vtkSMAnamorphHeightDomain_h

#include "AnamorphServerManagerModule.h"  // for the export macro
#include "vtkSMDoubleRangeDomain.h"

class vtkPVArrayInformation;

class ANAMORPHSERVERMANAGER_EXPORT vtkSMAnamorphHeightDomain : public vtkSMDoubleRangeDomain {
  public:
    static vtkSMAnamorphHeightDomain* New();
    vtkTypeMacro(vtkSMAnamorphHeightDomain, vtkSMDoubleRangeDomain);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    void Update(vtkSMProperty* property) override;
    int SetDefaultValues(vtkSMProperty* property, bool use_unchecked_values) override;

  protected:
    vtkSMAnamorphHeightDomain();
    ~vtkSMAnamorphHeightDomain() override;

  private:
    vtkSMAnamorphHeightDomain(const vtkSMAnamorphHeightDomain&) = delete;
    void operator=(const vtkSMAnamorphHeightDomain&) = delete;

    vtkPVArrayInformation* Heights();
};

#endif
