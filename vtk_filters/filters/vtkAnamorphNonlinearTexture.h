// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphNonlinearTexture
 * @brief lay a texture on polygons by coordinates that are cubic within them
 *
 * A renderer interpolates texture coordinates linearly in each triangle: a picture on few polygons breaks at their sides. Here the
 * coordinates are nonlinear (Kim 2003, sections 5.3 and 7.2): along each side the Hermite cubic of the coordinates at its ends and of how
 * they change there, and within each triangle the cubic with these sides. So the picture bends smoothly from polygon to polygon, of
 * which there need not be more. The slopes at a point are fitted to the coordinates of the points about it, in the plane across the
 * normal; what is linear in a plane stays as it is.
 *
 * Input: a vtkPolyData with texture coordinates of two components, 0 to 1 over the texture. Polygons and strips are cut into triangles
 * first, lines and vertices are dropped. Output: its triangles, cut until the coordinates, interpolated linearly, are off by at most
 * Tolerance texels: that is proven, rounding included, not sampled. Sides are cut by a rule that knows their ends alone, so that there
 * are no cracks: where points are doubled, as for normals or at seams of the texture, and beside triangles with numbers that are none,
 * which have no bound. Points at one place with the same coordinates count as one, for slopes too; where coordinates differ, the texture
 * has a seam. In pieces the filter asks for a level of ghosts more, and triangles about a seam between pieces are cut as each piece
 * knows it.
 *
 * Points are double, and so are the coordinates, which keep their name; points of the input come first. Point arrays are interpolated
 * linearly, but for ids and ghosts, cell arrays copied. Field arrays: "anamorph:tol"; "anamorph:max_error", the largest bound in use, in
 * texels; "anamorph:not_finite", the number of triangles without a bound.
 */
#ifndef vtkAnamorphNonlinearTexture_h
#define vtkAnamorphNonlinearTexture_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkPolyDataAlgorithm.h"

class ANAMORPHFILTERS_EXPORT vtkAnamorphNonlinearTexture : public vtkPolyDataAlgorithm {
  public:
    static vtkAnamorphNonlinearTexture* New();
    vtkTypeMacro(vtkAnamorphNonlinearTexture, vtkPolyDataAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /**
     * The texture's size in texels, in which errors count, up to 1048576. Default: 1024 x 1024.
     */
    vtkSetMacro(TextureWidth, int);
    vtkGetMacro(TextureWidth, int);
    vtkSetMacro(TextureHeight, int);
    vtkGetMacro(TextureHeight, int);
    ///@}

    ///@{
    /**
     * How far texture coordinates may be from the cubic ones, in texels. Default: 0.125.
     */
    vtkSetMacro(Tolerance, double);
    vtkGetMacro(Tolerance, double);
    ///@}

  protected:
    vtkAnamorphNonlinearTexture() = default;
    ~vtkAnamorphNonlinearTexture() override = default;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                               vtkInformationVector* outputs) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphNonlinearTexture(const vtkAnamorphNonlinearTexture&) = delete;
    void operator=(const vtkAnamorphNonlinearTexture&) = delete;

    int TextureWidth = 1024, TextureHeight = 1024;
    double Tolerance = 0.125;
};

#endif
