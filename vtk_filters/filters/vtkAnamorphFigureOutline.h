// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphFigureOutline
 * @brief   The outlines of figures for a view, hidden lines found (Chapman 1986, section 2).
 *
 * The limb of an ellipsoid, where view rays touch it, is an ellipse in space. The output has it as polylines
 * along its visible and hidden arcs, in space: where they are when seen from the view that they were made
 * for. The ends of arcs are exact; the picture of a chord is no further than Tolerance pixels from that of
 * the limb, proven as in anamorph/figure/outline/outline.h.
 *
 * The cells' arrays are Visible (1 or 0), BodyId (the point of the input), and the arrays of the input's
 * points but Axes and Orientation. Bodies hide each other within one input; blocks of composite data do not.
 */
#ifndef vtkAnamorphFigureOutline_h
#define vtkAnamorphFigureOutline_h

#include "vtkAnamorphFigureAlgorithm.h"

class ANAMORPHFILTERS_EXPORT vtkAnamorphFigureOutline : public vtkAnamorphFigureAlgorithm {
  public:
    static vtkAnamorphFigureOutline* New();
    vtkTypeMacro(vtkAnamorphFigureOutline, vtkAnamorphFigureAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The values of Hidden. */
    enum { REMOVED, KEPT, TRANSPARENT };

    ///@{
    /**
     * How hidden arcs are treated. REMOVED, the default: they are not in the output. KEPT: they are, and Visible tells
     * them apart. TRANSPARENT: nothing hides anything.
     */
    vtkSetClampMacro(Hidden, int, REMOVED, TRANSPARENT);
    vtkGetMacro(Hidden, int);
    ///@}

    ///@{
    /** Whether the curves in which bodies pass through each other are drawn too. Off by default. */
    vtkSetMacro(Crossings, bool);
    vtkGetMacro(Crossings, bool);
    vtkBooleanMacro(Crossings, bool);
    ///@}

    ///@{
    /**
     * Whether the outline of a body is connected to that of its neighbour at a joint along their common tangents, and
     * the arcs of both between these are left out. Joints are those of the field data. Off by default.
     */
    vtkSetMacro(Connected, bool);
    vtkGetMacro(Connected, bool);
    vtkBooleanMacro(Connected, bool);
    ///@}

    ///@{
    /** The maximum chord error, in pixels of the view; positive. The default is 0.1. */
    vtkSetMacro(Tolerance, double);
    vtkGetMacro(Tolerance, double);
    ///@}

    ///@{
    /** The precision of points: vtkAlgorithm::SINGLE_PRECISION or DOUBLE_PRECISION (the default). */
    vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DOUBLE_PRECISION);
    vtkGetMacro(OutputPointsPrecision, int);
    ///@}

  protected:
    vtkAnamorphFigureOutline();
    ~vtkAnamorphFigureOutline() override;

    void Draw(vtkPolyData* input, vtkDataObject* output, anamorph_vtk::Execution& execution) override;

  private:
    vtkAnamorphFigureOutline(const vtkAnamorphFigureOutline&) = delete;
    void operator=(const vtkAnamorphFigureOutline&) = delete;

    int Hidden = REMOVED;
    bool Crossings = false, Connected = false;
    double Tolerance = 0.1;
    int OutputPointsPrecision = DOUBLE_PRECISION;
};

#endif
