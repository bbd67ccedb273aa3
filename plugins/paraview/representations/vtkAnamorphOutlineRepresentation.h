// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphOutlineRepresentation
 * @brief   The outlines of figures as ParaView's view sees them, hidden lines found (Chapman 1986, section 2).
 *
 * Before a view is rendered, vtkAnamorphFigureOutline makes the outlines for its camera and its size: they
 * follow the camera. Points are those of figures, with arrays Axes and Orientation; colors of points become
 * those of their outlines. Outlines are not selected.
 */
#ifndef vtkAnamorphOutlineRepresentation_h
#define vtkAnamorphOutlineRepresentation_h

#include "AnamorphRepresentationsModule.h"  // for the export macro
#include "vtkGeometryRepresentation.h"
#include "vtkNew.h"  // for what makes the outlines

class vtkAnamorphEllipsoidMapper;
class vtkAnamorphFigureOutline;

class ANAMORPHREPRESENTATIONS_EXPORT vtkAnamorphOutlineRepresentation : public vtkGeometryRepresentation {
  public:
    static vtkAnamorphOutlineRepresentation* New();
    vtkTypeMacro(vtkAnamorphOutlineRepresentation, vtkGeometryRepresentation);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /** As of vtkAnamorphFigureOutline. */
    void SetHidden(int hidden);
    void SetCrossings(bool crossings);
    void SetConnected(bool connected);
    void SetTolerance(double tolerance);
    ///@}

    /** Nothing: a line's id is that of no point. */
    void SetPickable(int) override {}

    int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* input,
                           vtkInformation* output) override;

  protected:
    vtkAnamorphOutlineRepresentation();
    ~vtkAnamorphOutlineRepresentation() override;

    void UpdateColoringParameters() override;

  private:
    vtkAnamorphOutlineRepresentation(const vtkAnamorphOutlineRepresentation&) = delete;
    void operator=(const vtkAnamorphOutlineRepresentation&) = delete;

    void MakeOutlines(vtkDataObject* figures);

    vtkNew<vtkAnamorphFigureOutline> Outline;
    vtkNew<vtkAnamorphEllipsoidMapper> Bodies;  // for their bounds
};

#endif
