// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphFigureRepresentation
 * @brief   What a filter makes of figures for ParaView's view, as it sees them.
 *
 * Before a view is rendered, the filter of the derived class is given its camera and its size: what is drawn follows the
 * camera. Points are those of figures, with arrays Axes and Orientation; colors of points become those of their
 * cells. Nothing of it is selected: a cell's id is that of no point.
 */
#ifndef vtkAnamorphFigureRepresentation_h
#define vtkAnamorphFigureRepresentation_h

#include "AnamorphRepresentationsModule.h"  // for the export macro
#include "vtkGeometryRepresentation.h"
#include "vtkNew.h"  // for the bodies

class vtkAnamorphEllipsoidMapper;
class vtkAnamorphFigureAlgorithm;

class ANAMORPHREPRESENTATIONS_EXPORT vtkAnamorphFigureRepresentation : public vtkGeometryRepresentation {
  public:
    vtkAbstractTypeMacro(vtkAnamorphFigureRepresentation, vtkGeometryRepresentation);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** Does nothing: a cell's id is that of no point. */
    void SetPickable(int) override {}

    int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* input,
                           vtkInformation* output) override;

  protected:
    vtkAnamorphFigureRepresentation();
    ~vtkAnamorphFigureRepresentation() override;

    /// The filter that draws the figures, always the same.
    virtual vtkAnamorphFigureAlgorithm* GetFilter() = 0;

    void UpdateColoringParameters() override;

  private:
    vtkAnamorphFigureRepresentation(const vtkAnamorphFigureRepresentation&) = delete;
    void operator=(const vtkAnamorphFigureRepresentation&) = delete;

    void Draw(vtkDataObject* figures);

    vtkNew<vtkAnamorphEllipsoidMapper> Bodies;  // for their bounds
};

#endif
