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
 * Three more inputs are optional. Positions, port 1: a surface that is sampled, one layer of points over the whole of
 * the texture, interpolated by smooth cubics; the points of a vtkStructuredGrid, or an array of three components, float
 * or double, of a vtkImageData (PositionsArrayName; by default the scalars). Rows go up, as the
 * texture's. Height, port 2: a vtkImageData by whose brightness, the mean of up to three components of an array
 * (HeightArrayName), surfaces with smooth normals are raised along these: floating point as it is,
 * whole numbers as fractions of the largest of their type. Deformations, port 3: a table of bumps that
 * move the surface, with the columns of vtkAnamorphDeformationList; u and v run from 0 to 1 over the texture. Hidden
 * points, and such that are no numbers, are holes; then the field array "anamorph:missing" says how many, and where
 * the first is, in rows counted from the uppermost.
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

#include <array>   // for a light
#include <memory>  // for the surface that is kept
#include <string>  // for the name of the file
#include <vector>  // for the lights

namespace anamorph {
class Camera;
class DrapeSurfaces;
class ParameterValues;
struct DrapeOptions;
struct Size;
}  // namespace anamorph

class ANAMORPHFILTERS_EXPORT vtkAnamorphDrape : public vtkImageAlgorithm {
  public:
    static vtkAnamorphDrape* New();
    vtkTypeMacro(vtkAnamorphDrape, vtkImageAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The values of Surface. */
    enum { PLANE, CYLINDER, SPHERE, TORUS, PAGE_TURN, WAVES, RIPPLES, POSITIONS };
    /** The values of Filter. */
    enum { NEAREST, BILINEAR, BICUBIC, ANTIALIAS, PYRAMID, SUMMED_AREA };
    /** The values of Style. */
    enum { COLOR, TEXTURE_COORDINATES, DEPTH, NORMAL };
    /** The values of Shading. */
    enum { NONE, GOURAUD, PHONG };

    ///@{
    /** The optional inputs. */
    void SetPositionsConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
    void SetHeightConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }
    void SetDeformationsConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(3, output); }
    ///@}

    ///@{
    /**
     * The surface that the texture lies on: PLANE, the default; CYLINDER, about the y axis; SPHERE, about the
     * origin, with all latitudes; TORUS, about the y axis; PAGE_TURN: a sheet curls round a cylinder that rolls
     * over it; WAVES, RIPPLES: plane and circular; POSITIONS: that of the input Positions.
     */
    vtkSetClampMacro(Surface, int, PLANE, POSITIONS);
    vtkGetMacro(Surface, int);
    ///@}

    ///@{
    /**
     * Weights of the surfaces that Surface is blended with, point by point (Oka 1987, eq. 4.3), from PLANE to
     * POSITIONS, -1e6 to 1e6; what they lack to 1 is the weight of Surface itself, whose own counts for nothing. All
     * are 0 by default. There are no others.
     */
    void SetBlendWeight(int surface, double weight);
    vtkSetVectorMacro(BlendWeights, double, 8);
    vtkGetVectorMacro(BlendWeights, double, 8);
    ///@}

    ///@{
    /** The point arrays that are read of the inputs Positions and Height. By default their scalars. */
    void SetPositionsArrayName(const char* name) { this->SetText(this->PositionsArrayName, name); }
    const char* GetPositionsArrayName() { return this->PositionsArrayName.c_str(); }
    void SetHeightArrayName(const char* name) { this->SetText(this->HeightArrayName, name); }
    const char* GetHeightArrayName() { return this->HeightArrayName.c_str(); }
    ///@}

    ///@{
    /** How far brightness 1 of the input Height raises the surface, -1000 to 1000; 0.1 by default. */
    vtkSetMacro(HeightScale, double);
    vtkGetMacro(HeightScale, double);
    /** Its heights are smoothed by a Gaussian of that standard deviation, in texels, 0 to 100; 1 by default. */
    vtkSetMacro(HeightSmooth, double);
    vtkGetMacro(HeightSmooth, double);
    ///@}

    ///@{
    /**
     * A file of deformations, JSON or CSV as vtkAnamorphDeformationList has them, beside those of the input. It is
     * read whenever the filter executes.
     */
    void SetDeformationFileName(const char* name) { this->SetText(this->DeformationFileName, name); }
    const char* GetDeformationFileName() { return this->DeformationFileName.c_str(); }
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
     * footprint, and of samples at silhouettes and borders. PYRAMID and SUMMED_AREA: the same with means over
     * the least rectangle around the footprint (Oka 1987, fig. 2.6), of a level of a pyramid (Williams 1983),
     * or of all texels, from a table of their sums (Crow 1984).
     */
    vtkSetClampMacro(Filter, int, NEAREST, SUMMED_AREA);
    vtkGetMacro(Filter, int);
    ///@}

    ///@{
    /** Red, green, blue and alpha behind the surface, where 1 is the largest whole number of the texture's type.
     * Of a texture of one or two components the first is its color. 0 by default. */
    vtkSetVector4Macro(Background, double);
    vtkGetVector4Macro(Background, double);
    ///@}

    ///@{
    /** NONE, the default; GOURAUD: by the light at the corners of patches; PHONG: by the normals there. */
    vtkSetClampMacro(Shading, int, NONE, PHONG);
    vtkGetMacro(Shading, int);
    ///@}

    ///@{
    /**
     * Directions towards lights at infinity, in space, of any length but 0. Both sides of the surface are lit alike, by
     * lights on the viewer's. By default there is one, (0, 0, 1), as are those that are added. An index that is not
     * in the list is an error.
     */
    void SetNumberOfLights(int count);
    int GetNumberOfLights() { return static_cast<int>(this->Lights.size()); }
    void SetLight(int index, double x, double y, double z);
    double* GetLight(int index) VTK_SIZEHINT(3);
    ///@}

    ///@{
    /** The share of the color that is seen without light, 0 to 1000; 0.2 by default. */
    vtkSetMacro(Ambient, double);
    vtkGetMacro(Ambient, double);
    /** The share of the color that light adds, 0 to 1000; 0.8 by default. */
    vtkSetMacro(Diffuse, double);
    vtkGetMacro(Diffuse, double);
    /** Highlights that light adds, 0 to 1000; 0 by default. */
    vtkSetMacro(Specular, double);
    vtkGetMacro(Specular, double);
    /** Their exponent, 0 to 100000; 20 by default. */
    vtkSetMacro(Shininess, double);
    vtkGetMacro(Shininess, double);
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

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphDrape(const vtkAnamorphDrape&) = delete;
    void operator=(const vtkAnamorphDrape&) = delete;

    /// A number of a row of the operation's table.
    struct Number;
    static const std::vector<Number>& Numbers();
    /// Surfaces and their patches.
    struct Kept;

    anamorph::ParameterValues Values() const;
    bool UsesPositions() const;
    bool IsLight(int index);
    void SetText(std::string& member, const char* text);
    const anamorph::DrapeSurfaces& SurfacesOf(const anamorph::ParameterValues& values,
                                              vtkInformationVector** inputs, double aspect);
    anamorph::DrapeOptions Options(const anamorph::ParameterValues& values, int components) const;
    anamorph::Camera CameraOf(const anamorph::Size& screen) const;
    anamorph::Size Screen() const;
    void Draw(vtkInformationVector** inputs, const int* extent, vtkImageData* output);

    int Surface = PLANE;
    double BlendWeights[8] = {0, 0, 0, 0, 0, 0, 0, 0};
    std::string PositionsArrayName, HeightArrayName, DeformationFileName;
    // Defaults are those of the operation's table.
    double Angle, Radius, Tube, Amplitude, Wavelength, Phase, Direction, Turn;
    double HeightScale, HeightSmooth, Tolerance, Ambient, Diffuse, Specular, Shininess;
    int ViewSize[2] = {500, 500};
    double CameraPosition[3] = {0, 0, 2};
    double CameraFocalPoint[3] = {0, 0, 0};
    double CameraViewUp[3] = {0, 1, 0};
    bool CameraParallelProjection = false;
    double CameraParallelScale = 0.5;
    double CameraViewAngle = 30;
    int Filter = ANTIALIAS;
    double Background[4] = {0, 0, 0, 0};
    int Shading = NONE;
    std::vector<std::array<double, 3>> Lights;
    int Style = COLOR;
    double MaxError = 0;
    std::unique_ptr<Kept> KeptSurfaces;
};

#endif
