// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphImageWarp
 * @brief an image warped by a control mesh
 *
 * Image warping by a mesh (Kim 2003, chapter 5): between the vertices of a rectangular mesh the map is a bicubic Hermite patch with the
 * slopes of Catmull and Rom, and every pixel shows the point of the image that belongs there, within Tolerance, which is
 * proven. The first input is the image, a vtkImageData of one slice with 1 to 4 components of unsigned char, unsigned short
 * or float, of which the second or fourth is alpha. The second is the mesh: points, in any order, whose texture coordinates are those of a grid,
 * every u with every v, and say where in the image each belongs, 0 at its first pixel's centre and 1 at its last one's, as the bounds of
 * an image are; where they are, in the image's own coordinates, says where that goes. So a plane on the image's bounds warps nothing, and whatever moves it,
 * vtkAnamorphDeform or any other filter, moves the image. Off the image's plane moves nothing.
 *
 * Extent, spacing, origin and direction are those of the image, and so are type and names of the array. Beyond the outer lines of the
 * mesh the map goes on linearly; what comes from beyond the image is 0. Field arrays say what was reached: "anamorph:max_error", and
 * "anamorph:folded_fraction", how much of the picture lies where the mesh is folded.
 */
#ifndef vtkAnamorphImageWarp_h
#define vtkAnamorphImageWarp_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkImageAlgorithm.h"

class vtkAlgorithmOutput;
class vtkDataArray;
class vtkPointSet;

class ANAMORPHFILTERS_EXPORT vtkAnamorphImageWarp : public vtkImageAlgorithm {
  public:
    static vtkAnamorphImageWarp* New();
    vtkTypeMacro(vtkAnamorphImageWarp, vtkImageAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /// The control mesh: a vtkPointSet with texture coordinates.
    void SetMeshConnection(vtkAlgorithmOutput* output);

    enum Directions { PUSH = 0, PULL = 1 };
    ///@{
    /**
     * What the mesh's points say. PUSH: where what belongs to them goes. PULL: where what is shown there comes from, which needs no
     * inverse. Default: PUSH.
     */
    vtkSetClampMacro(Direction, int, PUSH, PULL);
    vtkGetMacro(Direction, int);
    ///@}

    ///@{
    /**
     * How far every point is moved: 0 not at all, 1 as given, any other number as far in proportion. Default: 1.
     */
    vtkSetMacro(Amount, double);
    vtkGetMacro(Amount, double);
    ///@}

    enum Interpolations { NEAREST = 0, LINEAR = 1, CUBIC = 2, ANTIALIAS = 3 };
    ///@{
    /**
     * How the image is interpolated between pixels; ANTIALIAS is linear where the warp magnifies, and averages where it shrinks.
     * Default: ANTIALIAS.
     */
    vtkSetClampMacro(Interpolation, int, NEAREST, ANTIALIAS);
    vtkGetMacro(Interpolation, int);
    ///@}

    ///@{
    /**
     * The most by which what a pixel shows may be off, in pixels of the image, at least 0. Default: 0.01.
     */
    vtkSetClampMacro(Tolerance, double, 0, VTK_DOUBLE_MAX);
    vtkGetMacro(Tolerance, double);
    ///@}

    /// The proven bound of the last execution, in pixels of the image.
    vtkGetMacro(MaxError, double);

  protected:
    vtkAnamorphImageWarp();
    ~vtkAnamorphImageWarp() override;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                               vtkInformationVector* outputs) override;
    int RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                           vtkInformationVector* outputs) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

  private:
    vtkAnamorphImageWarp(const vtkAnamorphImageWarp&) = delete;
    void operator=(const vtkAnamorphImageWarp&) = delete;

    void Draw(vtkImageData* input, vtkDataArray* array, vtkPointSet* mesh, const int* extent,
              vtkImageData* output);

    int Direction = PUSH, Interpolation = ANTIALIAS;
    double Amount = 1, Tolerance = 0.01, MaxError = 0;
};

#endif
