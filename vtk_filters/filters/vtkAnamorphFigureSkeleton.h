// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphFigureSkeleton
 * @brief   Figures as sticks or as spheres, with a level of detail (Chapman 1986, section 2).
 *
 * Sticks are lines in space: the longest axis of each body, or lines from joint to joint (a body with two
 * joints is one between them, others are lines from their centre to each; joints are those of the field
 * data). Spheres are vertices with the array Radius: the largest spheres inside a body along its limb, of
 * which no point of its surface is further away than Tolerance (Badler's bubbles). Radius is 0 elsewhere.
 *
 * Detail says how much of a body is worth drawing in the view: NONE behind the observer, DOT where its
 * outline is nowhere wider than LevelOfDetail, LINE where it is so in one direction, ELLIPSE up to 16 times
 * as wide, and BODY. Bodies that are dots are vertices at their centres, and of what is NONE there is
 * nothing.
 *
 * The cells' arrays are Detail, Radius, BodyId (the point of the input), and the arrays of the input's points
 * but Axes and Orientation.
 */
#ifndef vtkAnamorphFigureSkeleton_h
#define vtkAnamorphFigureSkeleton_h

#include "vtkAnamorphFigureAlgorithm.h"

class ANAMORPHFILTERS_EXPORT vtkAnamorphFigureSkeleton : public vtkAnamorphFigureAlgorithm {
  public:
    static vtkAnamorphFigureSkeleton* New();
    vtkTypeMacro(vtkAnamorphFigureSkeleton, vtkAnamorphFigureAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The values of Mode. */
    enum { AXES, JOINTS, SPHERES };
    /** The values of the array Detail. */
    enum { NONE, DOT, LINE, ELLIPSE, BODY };

    ///@{
    /** What figures are drawn as. AXES is the default. */
    vtkSetClampMacro(Mode, int, AXES, SPHERES);
    vtkGetMacro(Mode, int);
    ///@}

    ///@{
    /** The width in pixels of the view up to which a body is a dot; 0 (the default): all is BODY. */
    vtkSetMacro(LevelOfDetail, double);
    vtkGetMacro(LevelOfDetail, double);
    ///@}

    ///@{
    /** The maximum distance of the surface from the spheres, in units; positive. The default is 1. */
    vtkSetMacro(Tolerance, double);
    vtkGetMacro(Tolerance, double);
    ///@}

    ///@{
    /** The precision of points: vtkAlgorithm::SINGLE_PRECISION or DOUBLE_PRECISION (the default). */
    vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DOUBLE_PRECISION);
    vtkGetMacro(OutputPointsPrecision, int);
    ///@}

  protected:
    vtkAnamorphFigureSkeleton();
    ~vtkAnamorphFigureSkeleton() override;

    void Draw(vtkPolyData* input, vtkDataObject* output, anamorph_vtk::Execution& execution) override;

  private:
    vtkAnamorphFigureSkeleton(const vtkAnamorphFigureSkeleton&) = delete;
    void operator=(const vtkAnamorphFigureSkeleton&) = delete;

    int Mode = AXES;
    double LevelOfDetail = 0;
    double Tolerance = 1;
    int OutputPointsPrecision = DOUBLE_PRECISION;
};

#endif
