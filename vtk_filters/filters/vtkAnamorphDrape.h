// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphDrape
 * @brief   A picture laid on a surface in space and seen by a camera, without OpenGL (Oka 1987, section 2).
 *
 * The input is the texture: a vtkImageData of one slice whose point array (by default the scalars) has 1 to 4
 * components of unsigned char, unsigned short or float. A second of two components, and a fourth of four, is
 * alpha, by which color is not multiplied.
 *
 * Undeformed, the texture is 1 high, about the origin, in the plane z = 0, with x to the right and y up; its
 * pixels are square. The surface is cut into patches whose points are seen within Tolerance pixels from where
 * they belong, which is proven, and without cracks. Patches are kept for other views of the same surface.
 *
 * The output is an image of ViewSize pixels, the first at the lower left, with one array of its points: Colors
 * (components and type of the texture); TextureCoordinates (float, as VTK's, (-1, -1) where nothing is seen);
 * Depth (float: the distance ahead of the camera, 1e30 where nothing is seen); or Normals (float: of the
 * surface, of unit length, on the viewer's side, 0 where nothing is seen). A pixel has the same bits in any part
 * of the image that is asked for and for any number of threads.
 */
#ifndef vtkAnamorphDrape_h
#define vtkAnamorphDrape_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkImageAlgorithm.h"

#include <memory>  // for the surface that is kept

namespace anamorph {
class Camera;
struct SharedTree;
struct Size;
}  // namespace anamorph

class ANAMORPHFILTERS_EXPORT vtkAnamorphDrape : public vtkImageAlgorithm {
  public:
    static vtkAnamorphDrape* New();
    vtkTypeMacro(vtkAnamorphDrape, vtkImageAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The values of Surface. */
    enum { PLANE, CYLINDER, SPHERE, TORUS, PAGE_TURN, WAVES, RIPPLES };
    /** The values of Filter. */
    enum { NEAREST, BILINEAR, BICUBIC, ANTIALIAS };
    /** The values of Style. */
    enum { COLOR, TEXTURE_COORDINATES, DEPTH, NORMAL };

    ///@{
    /**
     * The surface that the texture lies on: PLANE, the default; CYLINDER, about the y axis; SPHERE, about the
     * origin, with all latitudes; TORUS, about the y axis; PAGE_TURN: a sheet curls round a cylinder that rolls
     * over it; WAVES, RIPPLES: plane and circular.
     */
    vtkSetClampMacro(Surface, int, PLANE, RIPPLES);
    vtkGetMacro(Surface, int);
    ///@}

    ///@{
    /** Degrees, of CYLINDER, SPHERE and TORUS: the part of a turn that is covered, 0.01 to 360; 180 by default. */
    vtkSetMacro(Angle, double);
    vtkGetMacro(Angle, double);
    ///@}

    ///@{
    /**
     * Radius of the surface, 0.001 to 1000, or 0, the default: 0.5 (SPHERE, TORUS), 0.1 (PAGE_TURN), and for a
     * CYLINDER such that the texture keeps its width.
     */
    vtkSetClampMacro(Radius, double, 0, 1000);
    vtkGetMacro(Radius, double);
    ///@}

    ///@{
    /** Radius of a TORUS's tube, 0.001 to 1000; 0.2 by default. */
    vtkSetMacro(Tube, double);
    vtkGetMacro(Tube, double);
    ///@}

    ///@{
    /** Of WAVES and RIPPLES: how high they are, -1000 to 1000; 0.05 by default. */
    vtkSetMacro(Amplitude, double);
    vtkGetMacro(Amplitude, double);
    /** Their length, 0.01 to 1000; 0.5 by default. */
    vtkSetMacro(Wavelength, double);
    vtkGetMacro(Wavelength, double);
    /** How far they have gone, in wavelengths, -1000 to 1000; 0 by default. */
    vtkSetMacro(Phase, double);
    vtkGetMacro(Phase, double);
    ///@}

    ///@{
    /**
     * Degrees, counterclockwise from the x axis, -360 to 360: where WAVES go, and where the part of a page that
     * turns lies. 0 by default.
     */
    vtkSetMacro(Direction, double);
    vtkGetMacro(Direction, double);
    ///@}

    ///@{
    /** How far a page is turned, 0 to 1; 0.5 by default. */
    vtkSetMacro(Turn, double);
    vtkGetMacro(Turn, double);
    ///@}

    ///@{
    /** Width and height of the image in pixels, 1 to 65536. The default is 500 x 500. */
    vtkSetVector2Macro(ViewSize, int);
    vtkGetVector2Macro(ViewSize, int);
    ///@}

    ///@{
    /** The camera, as in vtkCamera. Coordinates are numbers from -1e6 to 1e6. The default looks from (0, 0, 2)
     * at the origin. What is nearer than a thousandth of the distance to the focal point is not seen. */
    vtkSetVector3Macro(CameraPosition, double);
    vtkGetVector3Macro(CameraPosition, double);
    vtkSetVector3Macro(CameraFocalPoint, double);
    vtkGetVector3Macro(CameraFocalPoint, double);
    vtkSetVector3Macro(CameraViewUp, double);
    vtkGetVector3Macro(CameraViewUp, double);
    vtkSetMacro(CameraParallelProjection, bool);
    vtkGetMacro(CameraParallelProjection, bool);
    vtkBooleanMacro(CameraParallelProjection, bool);
    /** Half the height of the view, in units, 1e-6 to 1e6; of parallel projection. */
    vtkSetMacro(CameraParallelScale, double);
    vtkGetMacro(CameraParallelScale, double);
    /** The angle of the view from its bottom to its top, degrees, between 0 and 180; of perspective. */
    vtkSetMacro(CameraViewAngle, double);
    vtkGetMacro(CameraViewAngle, double);
    ///@}

    ///@{
    /** How far, in pixels of the image, a point may be drawn from where it belongs, 0.001 to 1000; 0.125 by
     * default. */
    vtkSetMacro(Tolerance, double);
    vtkGetMacro(Tolerance, double);
    ///@}

    ///@{
    /**
     * How the texture is read: NEAREST, BILINEAR, BICUBIC, or ANTIALIAS, the default: means over a pixel's
     * footprint, and of samples at silhouettes and borders.
     */
    vtkSetClampMacro(Filter, int, NEAREST, ANTIALIAS);
    vtkGetMacro(Filter, int);
    ///@}

    ///@{
    /** Red, green, blue and alpha behind the surface, where 1 is the largest whole number of the texture's type.
     * Of a texture of one or two components the first is its color. 0 by default. */
    vtkSetVector4Macro(Background, double);
    vtkGetVector4Macro(Background, double);
    ///@}

    ///@{
    /** What is drawn. COLOR by default. */
    vtkSetClampMacro(Style, int, COLOR, NORMAL);
    vtkGetMacro(Style, int);
    ///@}

    /** The largest proven bound of the distance, in pixels, by which points of the last image are off. */
    vtkGetMacro(MaxError, double);

  protected:
    vtkAnamorphDrape();
    ~vtkAnamorphDrape() override;

    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphDrape(const vtkAnamorphDrape&) = delete;
    void operator=(const vtkAnamorphDrape&) = delete;

    /// A surface and its patches.
    struct Kept;

    std::shared_ptr<anamorph::SharedTree> TreeOf(double aspect);
    anamorph::Camera CameraOf(const anamorph::Size& screen) const;
    anamorph::Size Screen() const;
    void Draw(vtkImageData* texture, vtkDataArray* texels, const int* extent, vtkImageData* output);

    int Surface = PLANE;
    double Angle = 180;
    double Radius = 0;
    double Tube = 0.2;
    double Amplitude = 0.05;
    double Wavelength = 0.5;
    double Phase = 0;
    double Direction = 0;
    double Turn = 0.5;
    int ViewSize[2] = {500, 500};
    double CameraPosition[3] = {0, 0, 2};
    double CameraFocalPoint[3] = {0, 0, 0};
    double CameraViewUp[3] = {0, 1, 0};
    bool CameraParallelProjection = false;
    double CameraParallelScale = 0.5;
    double CameraViewAngle = 30;
    double Tolerance = 0.125;
    int Filter = ANTIALIAS;
    double Background[4] = {0, 0, 0, 0};
    int Style = COLOR;
    double MaxError = 0;
    std::unique_ptr<Kept> KeptSurface;
};

#endif
