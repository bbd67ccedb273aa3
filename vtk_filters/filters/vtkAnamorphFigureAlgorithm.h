// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphFigureAlgorithm
 * @brief   The base class of filters of figures that depend on a view.
 *
 * The input is that of vtkAnamorphFigureReader, or any vtkPolyData with the arrays Axes and Orientation. A
 * point with a number that is not finite, or that is hidden (blanked), makes nothing; cells of a ghost point
 * are ghost cells.
 */
#ifndef vtkAnamorphFigureAlgorithm_h
#define vtkAnamorphFigureAlgorithm_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkPolyDataAlgorithm.h"

namespace anamorph {
// VTK's wrappers read no nested names here.
namespace figure {
struct View;
}
}  // namespace anamorph
namespace anamorph_vtk {
class Execution;
}

class ANAMORPHFILTERS_EXPORT vtkAnamorphFigureAlgorithm : public vtkPolyDataAlgorithm {
  public:
    vtkAbstractTypeMacro(vtkAnamorphFigureAlgorithm, vtkPolyDataAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The values of ViewMode. */
    enum { SCRIPT, CAMERA };

    ///@{
    /**
     * How the figures are viewed. SCRIPT, the default: as NUDES shows them, orthographically, a window of 1000
     * units that is as high as ViewSize; the input's field data says where it is. CAMERA: as the camera below.
     */
    vtkSetClampMacro(ViewMode, int, SCRIPT, CAMERA);
    vtkGetMacro(ViewMode, int);
    ///@}

    ///@{
    /** Width and height of the picture in pixels. The default is 500 x 500. */
    vtkSetVector2Macro(ViewSize, int);
    vtkGetVector2Macro(ViewSize, int);
    ///@}

    ///@{
    /** The camera, as in vtkCamera. The default looks along -z at the middle of NUDES' window, which fills
     * the view. */
    vtkSetVector3Macro(CameraPosition, double);
    vtkGetVector3Macro(CameraPosition, double);
    vtkSetVector3Macro(CameraFocalPoint, double);
    vtkGetVector3Macro(CameraFocalPoint, double);
    vtkSetVector3Macro(CameraViewUp, double);
    vtkGetVector3Macro(CameraViewUp, double);
    vtkSetMacro(CameraParallelProjection, bool);
    vtkGetMacro(CameraParallelProjection, bool);
    vtkBooleanMacro(CameraParallelProjection, bool);
    /** Half the height of a view in parallel projection, in units. */
    vtkSetMacro(CameraParallelScale, double);
    vtkGetMacro(CameraParallelScale, double);
    /** The angle of a view in perspective from its bottom to its top, in degrees. */
    vtkSetMacro(CameraViewAngle, double);
    vtkGetMacro(CameraViewAngle, double);
    ///@}

  protected:
    vtkAnamorphFigureAlgorithm();
    ~vtkAnamorphFigureAlgorithm() override;

    /// The view of the input's ellipsoids. Throws anamorph::Error naming the property that is out of its range.
    anamorph::figure::View ViewOf(vtkPolyData* figures) const;
    /// Writes the output, which is of the type that the filter says. An exception becomes an error message and an empty
    /// output.
    virtual void Draw(vtkPolyData* input, vtkDataObject* output, anamorph_vtk::Execution& execution) = 0;

    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

    int ViewMode = SCRIPT;
    int ViewSize[2] = {500, 500};
    double CameraPosition[3] = {500, 500, 1500};
    double CameraFocalPoint[3] = {500, 500, -500};
    double CameraViewUp[3] = {0, 1, 0};
    bool CameraParallelProjection = false;
    double CameraParallelScale = 500;
    double CameraViewAngle = 30;

  private:
    vtkAnamorphFigureAlgorithm(const vtkAnamorphFigureAlgorithm&) = delete;
    void operator=(const vtkAnamorphFigureAlgorithm&) = delete;
};

#endif
