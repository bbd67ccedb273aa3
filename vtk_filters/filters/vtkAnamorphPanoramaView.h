// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphPanoramaView
 * @brief a camera's view of a panorama, as an image
 *
 * What a camera in the centre of a panorama sees (Kim 2003, section 4.5), of any projection and lens, without OpenGL: the
 * operation pano of the core, within Tolerance of the exact texels, which is proven. The panorama is a vtkImageData of one slice,
 * its array 1 to 4 components of unsigned char, unsigned short or float, of which the second or fourth is alpha; the output has
 * an array "Colors" of the same type. Rows go up, as in all of VTK's images. Any part of the output, and any number of threads,
 * gives the same pixels. Keys has whatever else a recipe of the operation may say: another projection of the view, how the
 * panorama's camera was held, parts of panoramas, filters, overscan, coverage.
 *
 * Errors name the core's parameters: srcfov, srcvfov, srcd, srce, srclens (FieldOfView, VerticalFieldOfView, PanniniDistance,
 * ProjectionAlpha, Lens).
 */
#ifndef vtkAnamorphPanoramaView_h
#define vtkAnamorphPanoramaView_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkAnamorphPanoramaProjection.h"
#include "vtkImageAlgorithm.h"

class ANAMORPHFILTERS_EXPORT vtkAnamorphPanoramaView : public vtkImageAlgorithm {
  public:
    static vtkAnamorphPanoramaView* New();
    vtkTypeMacro(vtkAnamorphPanoramaView, vtkImageAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /**
     * The projection of the panorama, one of vtkAnamorphPanoramaProjection::Projections. Default: EQUIRECTANGULAR.
     */
    vtkSetClampMacro(Projection, int, 0, vtkAnamorphPanoramaProjection::NumberOfProjections - 1);
    vtkGetMacro(Projection, int);
    ///@}

    ///@{
    /**
     * The horizontal field of view of the panorama, or of each of its faces, in degrees; 0: the projection's default.
     * Default: 0.
     */
    vtkSetMacro(FieldOfView, double);
    vtkGetMacro(FieldOfView, double);
    ///@}

    ///@{
    /**
     * The vertical field of view of the panorama, in degrees, where its texels are not square, as of a whole sphere in a square
     * (180); 0: square texels. Default: 0.
     */
    vtkSetMacro(VerticalFieldOfView, double);
    vtkGetMacro(VerticalFieldOfView, double);
    ///@}

    ///@{
    /**
     * The number d of projections that have one, -0.999 to 1000, which others do not read: the distance of the Pannini
     * projection, xi of unified and double_sphere, beta of eucm. Default: 1.
     */
    vtkSetMacro(PanniniDistance, double);
    vtkGetMacro(PanniniDistance, double);
    ///@}

    ///@{
    /**
     * The number alpha of double_sphere and eucm, 0 to 1, which others do not read. Default: 0.5.
     */
    vtkSetMacro(ProjectionAlpha, double);
    vtkGetMacro(ProjectionAlpha, double);
    ///@}

    ///@{
    /**
     * The distortion of the lens that the panorama was taken through: MODEL:name=value,name=value with ptlens, brown, 3de4, kb4,
     * division, poly or ocam. Default: none.
     */
    vtkSetStringMacro(Lens);
    vtkGetStringMacro(Lens);
    ///@}

    ///@{
    /**
     * The orientation of the camera, in degrees: yaw to the right of the panorama's middle, pitch up, roll clockwise; it is
     * rolled first, then pitched, then turned. Default: 0.
     */
    vtkSetMacro(Yaw, double);
    vtkGetMacro(Yaw, double);
    vtkSetMacro(Pitch, double);
    vtkGetMacro(Pitch, double);
    vtkSetMacro(Roll, double);
    vtkGetMacro(Roll, double);
    ///@}

    ///@{
    /**
     * The horizontal field of view of the view, 0.01 to 179 degrees. Default: 90.
     */
    vtkSetClampMacro(ViewAngle, double, 0.01, 179);
    vtkGetMacro(ViewAngle, double);
    ///@}

    ///@{
    /**
     * The width and height of the view in pixels, each from 1 to 65536. Default: 500 x 500.
     */
    vtkSetVector2Macro(ViewSize, int);
    vtkGetVector2Macro(ViewSize, int);
    ///@}

    ///@{
    /**
     * The largest distance of the texel that a pixel shows from the exact one, in texels, up to 1e6; 0: exact. Default: 0.01.
     */
    vtkSetClampMacro(Tolerance, double, 0, 1e6);
    vtkGetMacro(Tolerance, double);
    ///@}

    ///@{
    /**
     * Further keys of a recipe .pano, "key=value&key=value", as in "srcpitch=-3&filter=sharp_bicubic&overscan=5%&alpha=1" or
     * "vfov=40". Where a key says what a property says too, the key counts; with to, fov, vfov or focal ViewAngle does not. Not
     * of those that name files, nor of parts, levels, tiles and color spaces. What lies beyond the view by overscan has indices
     * below 0, or beyond ViewSize. With alpha=1 the output has one component more, where the panorama has no alpha; with output
     * it is float, and its array has the name of that output. Default: none.
     */
    vtkSetStringMacro(Keys);
    vtkGetStringMacro(Keys);
    ///@}

    /**
     * The largest proven bound of that distance in the view that was drawn last, in texels.
     */
    vtkGetMacro(MaxError, double);

  protected:
    vtkAnamorphPanoramaView();
    ~vtkAnamorphPanoramaView() override;

    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphPanoramaView(const vtkAnamorphPanoramaView&) = delete;
    void operator=(const vtkAnamorphPanoramaView&) = delete;

    struct Source;
    struct View;
    /// The view of a panorama as it is known.
    View MakeView(const Source& panorama) const;
    void Draw(vtkInformationVector** inputs, const int* extent, vtkImageData* output);

    int Projection = vtkAnamorphPanoramaProjection::EQUIRECTANGULAR;
    double FieldOfView = 0, VerticalFieldOfView = 0, PanniniDistance = 1, ProjectionAlpha = 0.5;
    char* Lens = nullptr;
    char* Keys = nullptr;
    double Yaw = 0, Pitch = 0, Roll = 0, ViewAngle = 90;
    int ViewSize[2] = {500, 500};
    double Tolerance = 0.01, MaxError = 0;
};

#endif
