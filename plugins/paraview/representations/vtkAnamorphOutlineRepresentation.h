// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphOutlineRepresentation
 * @brief   The outlines of figures as ParaView's view sees them, hidden lines found (Chapman 1986, section 2).
 *
 * vtkAnamorphFigureOutline makes them for the view's camera and size.
 */
#ifndef vtkAnamorphOutlineRepresentation_h
#define vtkAnamorphOutlineRepresentation_h

#include "vtkAnamorphFigureRepresentation.h"

class vtkAnamorphFigureOutline;

class ANAMORPHREPRESENTATIONS_EXPORT vtkAnamorphOutlineRepresentation
    : public vtkAnamorphFigureRepresentation {
  public:
    static vtkAnamorphOutlineRepresentation* New();
    vtkTypeMacro(vtkAnamorphOutlineRepresentation, vtkAnamorphFigureRepresentation);

    ///@{
    /** Properties of the vtkAnamorphFigureOutline. */
    void SetHidden(int hidden);
    void SetCrossings(bool crossings);
    void SetConnected(bool connected);
    void SetTolerance(double tolerance);
    ///@}

  protected:
    vtkAnamorphOutlineRepresentation();
    ~vtkAnamorphOutlineRepresentation() override;

    vtkAnamorphFigureAlgorithm* GetFilter() override;

  private:
    vtkAnamorphOutlineRepresentation(const vtkAnamorphOutlineRepresentation&) = delete;
    void operator=(const vtkAnamorphOutlineRepresentation&) = delete;

    vtkNew<vtkAnamorphFigureOutline> Outline;
};

#endif
