// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphPanoramaProjection
 * @brief throw a panorama onto the surfaces of a scene
 *
 * Projective texture mapping with a panorama (Kim 2003, chapter 4), of any projection: points get the texture coordinates
 * of what a projector at Position, turned towards Direction, throws onto them (eq. 4.1 for cylindrical panoramas).
 * Triangles are cut until texture coordinates, interpolated linearly across each (with perspective correction in a
 * renderer), are off by at most Tolerance texels: the bound is proven for all of a triangle, not sampled. They are cut along
 * the seam behind the projector, along faces of cubes, and at the borders of the panorama. About poles, where rows of texels
 * become points, it is the direction that is off by at most Tolerance texels of the panorama's middle. A side is cut by a
 * rule that depends on its ends alone, so that surfaces stay without cracks in any pieces, on any ranks and threads.
 *
 * Input: any data set, of which the surface is taken, or multiblock data and collections of partitioned data sets. The first
 * output is what is painted: triangles with texture coordinates "PanoramaCoordinates" (u to the right, v up, 0 to 1). The
 * second is the rest, with the cell array "Painting": 1 beside the panorama, 2 hidden, 3 without a direction (next to the
 * centre, on the axis of a cylinder, not finite). Together they are the surface. Point arrays are interpolated, cell arrays
 * copied; lines and vertices are dropped.
 *
 * With Occlusion, what lies behind something else as seen by the projector is not painted: the input hides itself, and so
 * does what comes in on the second input. Triangles are cut along the borders of shadows and at their corners, wherever they
 * lie in a cell, however small they are: what is left on the wrong side is narrower than an eighth of Tolerance, or of a texel
 * if that is less. Where borders of many shadows meet, what is smaller than Tolerance or a texel is not divided and counts as
 * hidden. What is nearer to a point than 2^-16 of its distance does not hide it, nor do blanked cells.
 *
 * Field arrays on both outputs: "anamorph:tol"; "anamorph:max_error", the largest bound in use, in texels;
 * "anamorph:no_direction", the number of triangles without one. They count what this rank has of a leaf.
 */
#ifndef vtkAnamorphPanoramaProjection_h
#define vtkAnamorphPanoramaProjection_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkDataObjectAlgorithm.h"
#include "vtkSmartPointer.h"  // for the members

class vtkMultiProcessController;
class vtkPolyData;

class ANAMORPHFILTERS_EXPORT vtkAnamorphPanoramaProjection : public vtkDataObjectAlgorithm {
  public:
    static vtkAnamorphPanoramaProjection* New();
    vtkTypeMacro(vtkAnamorphPanoramaProjection, vtkDataObjectAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /// The order of the core's list.
    enum Projections {
        EQUIRECTANGULAR = 0,
        CYLINDRICAL,
        RECTILINEAR,
        FISHEYE,
        EQUISOLID,
        STEREOGRAPHIC,
        MERCATOR,
        CUBEMAP,
        CUBEMAP_3X2,
        CUBECROSS,
        EAC,
        PANNINI,
        ORTHOGRAPHIC,
        SINUSOIDAL,
        HAMMER,
        DUAL_FISHEYE,
        OCTAHEDRAL
    };
    ///@{
    /**
     * The projection of the panorama. Default: EQUIRECTANGULAR.
     */
    vtkSetClampMacro(Projection, int, EQUIRECTANGULAR, OCTAHEDRAL);
    vtkGetMacro(Projection, int);
    ///@}

    ///@{
    /**
     * The panorama's size in texels, in which errors count. Default: 4096 x 2048.
     */
    vtkSetMacro(PanoramaWidth, int);
    vtkGetMacro(PanoramaWidth, int);
    vtkSetMacro(PanoramaHeight, int);
    vtkGetMacro(PanoramaHeight, int);
    ///@}

    ///@{
    /**
     * Degrees that the panorama's width covers, or each of its faces; 0: what its projection has by default. Default: 0.
     */
    vtkSetMacro(FieldOfView, double);
    vtkGetMacro(FieldOfView, double);
    ///@}

    ///@{
    /**
     * The distance d of Pannini's projection, which others do not read. Default: 1.
     */
    vtkSetMacro(PanniniDistance, double);
    vtkGetMacro(PanniniDistance, double);
    ///@}

    ///@{
    /**
     * Distortion of the lens that the panorama was taken through: MODEL:name=value,name=value with ptlens, brown, 3de4 or
     * kb4. Default: none.
     */
    vtkSetStringMacro(Lens);
    vtkGetStringMacro(Lens);
    ///@}

    ///@{
    /**
     * The centre of the panorama; where its middle is thrown; and upwards, which may be aslant. Defaults: (0, 0, 0),
     * (0, 0, -1), (0, 1, 0).
     */
    vtkSetVector3Macro(Position, double);
    vtkGetVector3Macro(Position, double);
    vtkSetVector3Macro(Direction, double);
    vtkGetVector3Macro(Direction, double);
    vtkSetVector3Macro(ViewUp, double);
    vtkGetVector3Macro(ViewUp, double);
    ///@}

    ///@{
    /**
     * How far from its texel a point may be painted, in texels. Default: 0.125.
     */
    vtkSetMacro(Tolerance, double);
    vtkGetMacro(Tolerance, double);
    ///@}

    ///@{
    /**
     * Whether what the projector does not see stays unpainted. Default: on.
     */
    vtkSetMacro(Occlusion, bool);
    vtkGetMacro(Occlusion, bool);
    vtkBooleanMacro(Occlusion, bool);
    ///@}

    /**
     * What else casts shadows.
     */
    void SetOccluderConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }

    ///@{
    /**
     * Shares what casts shadows, and the size of the scene, between all ranks. Every rank has to execute then. Default: the
     * global controller; may be null.
     */
    void SetController(vtkMultiProcessController* controller);
    vtkMultiProcessController* GetController();
    ///@}

  protected:
    vtkAnamorphPanoramaProjection();
    ~vtkAnamorphPanoramaProjection() override;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int FillOutputPortInformation(int port, vtkInformation* info) override;
    int RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                               vtkInformationVector* outputs) override;
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphPanoramaProjection(const vtkAnamorphPanoramaProjection&) = delete;
    void operator=(const vtkAnamorphPanoramaProjection&) = delete;

    struct Run;

    int Projection = EQUIRECTANGULAR, PanoramaWidth = 4096, PanoramaHeight = 2048;
    double FieldOfView = 0, PanniniDistance = 1;
    char* Lens = nullptr;
    double Position[3] = {0, 0, 0}, Direction[3] = {0, 0, -1}, ViewUp[3] = {0, 1, 0};
    double Tolerance = 0.125;
    bool Occlusion = true;
    vtkSmartPointer<vtkMultiProcessController> Controller;
};

#endif
