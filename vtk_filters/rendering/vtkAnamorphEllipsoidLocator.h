// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphEllipsoidLocator
 * @brief   Finds the ellipsoid that a line meets, for vtkCellPicker.
 *
 * Its data set is the input of a vtkAnamorphEllipsoidMapper, or a block of it; vtkAnamorphEllipsoidMapper::AddLocators()
 * makes them. IntersectWithLine() finds, exactly, where a line meets the first of the bodies that the
 * mapper draws, and the cell that the body's point is in first; points that are in no cell are not found. It
 * takes time in proportion to the number of bodies. The other searches of vtkAbstractCellLocator are not offered.
 */
#ifndef vtkAnamorphEllipsoidLocator_h
#define vtkAnamorphEllipsoidLocator_h

#include "AnamorphRenderingModule.h"  // for the export macro
#include "vtkAbstractCellLocator.h"
#include "vtkWeakPointer.h"  // for the mapper

class vtkAnamorphEllipsoidMapper;

class ANAMORPHRENDERING_EXPORT vtkAnamorphEllipsoidLocator : public vtkAbstractCellLocator {
  public:
    static vtkAnamorphEllipsoidLocator* New();
    vtkTypeMacro(vtkAnamorphEllipsoidLocator, vtkAbstractCellLocator);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /** The mapper that draws the bodies; it is not kept alive. None by default: no body is found. */
    void SetMapper(vtkAnamorphEllipsoidMapper* mapper);
    vtkAnamorphEllipsoidMapper* GetMapper();
    ///@}

    using vtkAbstractCellLocator::IntersectWithLine;
    /** Returns 1 if the line meets a body, at `t` on the way from p1 to p2 and at x. `tol` is not used; `cell` may be null. */
    int IntersectWithLine(const double p1[3], const double p2[3], double tol, double& t, double x[3],
                          double pcoords[3], int& subId, vtkIdType& cellId, vtkGenericCell* cell) override;

    ///@{
    /** Do nothing: there is no structure to build, to free or to show. */
    void BuildLocator() override {}
    void FreeSearchStructure() override {}
    void GenerateRepresentation(int, vtkPolyData*) override {}
    ///@}

  protected:
    vtkAnamorphEllipsoidLocator();
    ~vtkAnamorphEllipsoidLocator() override;

  private:
    vtkAnamorphEllipsoidLocator(const vtkAnamorphEllipsoidLocator&) = delete;
    void operator=(const vtkAnamorphEllipsoidLocator&) = delete;

    vtkWeakPointer<vtkAnamorphEllipsoidMapper> Mapper;
};

#endif
