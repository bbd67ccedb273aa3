// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphSurfaceRepresentation
 * @brief   The ellipsoids of figures as triangles, as many as ParaView's view needs (Chapman 1986, section 2).
 *
 * vtkAnamorphFigureGeometry makes them for the view's camera and size: what is near gets more than what is far.
 */
#ifndef vtkAnamorphSurfaceRepresentation_h
#define vtkAnamorphSurfaceRepresentation_h

#include "vtkAnamorphFigureRepresentation.h"

class vtkAnamorphFigureGeometry;

class ANAMORPHREPRESENTATIONS_EXPORT vtkAnamorphSurfaceRepresentation
    : public vtkAnamorphFigureRepresentation {
  public:
    static vtkAnamorphSurfaceRepresentation* New();
    vtkTypeMacro(vtkAnamorphSurfaceRepresentation, vtkAnamorphFigureRepresentation);

    /** Properties of the vtkAnamorphFigureGeometry, in pixels of the view. */
    void SetTolerance(double tolerance);

  protected:
    vtkAnamorphSurfaceRepresentation();
    ~vtkAnamorphSurfaceRepresentation() override;

    vtkAnamorphFigureAlgorithm* GetFilter() override;

  private:
    vtkAnamorphSurfaceRepresentation(const vtkAnamorphSurfaceRepresentation&) = delete;
    void operator=(const vtkAnamorphSurfaceRepresentation&) = delete;

    vtkNew<vtkAnamorphFigureGeometry> Geometry;
};

#endif
