// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphFigureGeometry
 * @brief   The ellipsoids of figures as surfaces, within a tolerance (Chapman 1986, section 2).
 *
 * Each point of the input (see vtkAnamorphFigureReader) becomes triangles with the exact normals of the
 * ellipsoid at its vertices, and texture coordinates. No point of a triangle is further from its ellipsoid
 * than Tolerance; the cell array ChordalBound has the bound that is proven. The arrays of the input's points
 * but Axes and Orientation are the cells' arrays, with BodyId, the point of the input.
 *
 * The vertices are X(t, p) = c + R (a_x cos t sin p, a_y sin t, a_z cos t cos p) on a grid with steps h and
 * k, t from the bottom up. In NUDES' space (before z is negated, see vtkAnamorphFigureReader) p = 0 is the
 * body's own +z, where a figure faces. Texture coordinates are u = 1/2 - p / (2 pi), v = 1/2 + t / pi, so the
 * middle of a picture is in front and it is not mirrored, seen from outside; it is cut behind.
 *
 * The bound: of a triangle within one cell of the grid, each point is a weighted mean of its vertices X(t_i,
 * p_i). With the means t and p of the parameters, Taylor's theorem and the largest second derivatives |X_tt|
 * = m <= max(a), |X_tp| and |X_pp| <= n = max(a_x, a_z), it is no further from X(t, p) than (m h^2 + 2 n h k
 * + n k^2) / 8, since the variance of numbers in an interval is at most a quarter of its length squared.
 * Points in single precision are rounded besides.
 *
 * In a tolerance of pixels, the same moves a point of the picture by at most that; in perspective where it is
 * seen, not nearer than a thousandth of the distance to the camera's focal point. Each body gets what its nearest
 * point asks for; a camera on a large one, or within it, asks for as much as its distance from the surface does.
 */
#ifndef vtkAnamorphFigureGeometry_h
#define vtkAnamorphFigureGeometry_h

#include "vtkAnamorphFigureAlgorithm.h"

class ANAMORPHFILTERS_EXPORT vtkAnamorphFigureGeometry : public vtkAnamorphFigureAlgorithm {
  public:
    static vtkAnamorphFigureGeometry* New();
    vtkTypeMacro(vtkAnamorphFigureGeometry, vtkAnamorphFigureAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The values of ToleranceMode. */
    enum { UNITS, PIXELS };

    ///@{
    /** The unit of the tolerance: UNITS of the scene, the default, or PIXELS of the view. */
    vtkSetClampMacro(ToleranceMode, int, UNITS, PIXELS);
    vtkGetMacro(ToleranceMode, int);
    ///@}

    ///@{
    /**
     * The maximum distance of a surface from its ellipsoid; positive. The default is 0.25. More than 4,194,304
     * triangles are refused, which is some 0.8 GB; the message says which tolerance needs no more.
     */
    vtkSetMacro(Tolerance, double);
    vtkGetMacro(Tolerance, double);
    ///@}

    ///@{
    /** The precision of points: vtkAlgorithm::SINGLE_PRECISION (the default) or DOUBLE_PRECISION. */
    vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DOUBLE_PRECISION);
    vtkGetMacro(OutputPointsPrecision, int);
    ///@}

  protected:
    vtkAnamorphFigureGeometry();
    ~vtkAnamorphFigureGeometry() override;

    void Draw(vtkPolyData* input, vtkDataObject* data, anamorph_vtk::Execution& execution) override;

  private:
    vtkAnamorphFigureGeometry(const vtkAnamorphFigureGeometry&) = delete;
    void operator=(const vtkAnamorphFigureGeometry&) = delete;

    int ToleranceMode = UNITS;
    double Tolerance = 0.25;
    int OutputPointsPrecision = SINGLE_PRECISION;
};

#endif
