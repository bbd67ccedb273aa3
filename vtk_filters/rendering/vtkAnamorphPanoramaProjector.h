// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphPanoramaProjector
 * @brief a panorama that is thrown like a slide from its centre (Kim 2003, chapter 4)
 *
 * Says what is thrown and from where; vtkAnamorphProjectionShader throws it onto actors, vtkAnamorphPanoramaProjection onto
 * data. The panorama is a texture with an image as its input, whose size in texels counts. It should interpolate, and
 * repeat where it covers 360 degrees; with mipmaps it is smooth where it shrinks.
 */
#ifndef vtkAnamorphPanoramaProjector_h
#define vtkAnamorphPanoramaProjector_h

#include "AnamorphRenderingModule.h"  // for the export macro
#include "vtkObject.h"
#include "vtkSmartPointer.h"  // for the members

class vtkAlgorithmOutput;
class vtkPolyData;
class vtkTexture;
class vtkTrivialProducer;

class ANAMORPHRENDERING_EXPORT vtkAnamorphPanoramaProjector : public vtkObject {
  public:
    static vtkAnamorphPanoramaProjector* New();
    vtkTypeMacro(vtkAnamorphPanoramaProjector, vtkObject);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /**
     * The texture with the panorama. Default: none.
     */
    void SetPanorama(vtkTexture* panorama);
    vtkTexture* GetPanorama();
    ///@}

    ///@{
    /**
     * The projection of the panorama, by its place in the core's list (the values of vtkAnamorphPanoramaProjection) or by its
     * name, such as "equirectangular". A name that is none changes nothing. Default: 0, equirectangular.
     */
    void SetProjection(int projection);
    vtkGetMacro(Projection, int);
    void SetProjectionName(const char* name);
    const char* GetProjectionName();
    static int GetNumberOfProjections();
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
     * The centre of the panorama, in world coordinates; where its middle is thrown; and upwards, which may be aslant.
     * Defaults: (0, 0, 0), (0, 0, -1), (0, 1, 0).
     */
    vtkSetVector3Macro(Position, double);
    vtkGetVector3Macro(Position, double);
    vtkSetVector3Macro(Direction, double);
    vtkGetVector3Macro(Direction, double);
    vtkSetVector3Macro(ViewUp, double);
    vtkGetVector3Macro(ViewUp, double);
    ///@}

    /**
     * Sets Direction and ViewUp by degrees: yaw to the right of (0, 0, -1), pitch towards (0, 1, 0), roll clockwise. It is
     * rolled first, then pitched, then turned.
     */
    void SetOrientation(double yaw, double pitch, double roll);

    ///@{
    /**
     * The occluders between the projector and the scene, in world coordinates: the scene itself, too, if it is to hide itself.
     * Points behind them are not painted, as Shadows says. Default: none.
     */
    void SetOccluderConnection(vtkAlgorithmOutput* output);
    void SetOccluderData(vtkPolyData* mesh);
    /** The occluders, brought up to date; null where there are none. */
    vtkPolyData* GetOccluders();
    ///@}

    /// The ways to find whether a fragment is in shadow.
    enum ShadowModes {
        SHADOW_MAP = 0,  ///< by a map of distances around the projector, as fine as ShadowSize
        SHADOW_RAYS,  ///< by the ray to every fragment, which costs more and is exact but for the rounding of float
        SHADOW_RAYS_IN_STILLS  ///< by rays, but by the map while a window is interacted with
    };
    ///@{
    /**
     * Rays are followed through the tree of boxes around the occluders (anamorph::Occluders, whose decisions they repeat in
     * float), by the graphics hardware. What is nearer to a fragment than 2^-16 of its distance from the projector, or than
     * 2e-6 of that and the camera's distance from it, as measured across the occluder's plane, does not hide it; up to 4194304
     * triangles, and by the map where there are more. A window whose DesiredUpdateRate is 1 or more is being interacted with.
     * Default: SHADOW_MAP.
     */
    vtkSetClampMacro(Shadows, int, SHADOW_MAP, SHADOW_RAYS_IN_STILLS);
    vtkGetMacro(Shadows, int);
    void SetShadowsToMap() { this->SetShadows(SHADOW_MAP); }
    void SetShadowsToRays() { this->SetShadows(SHADOW_RAYS); }
    void SetShadowsToRaysInStills() { this->SetShadows(SHADOW_RAYS_IN_STILLS); }
    ///@}

    ///@{
    /**
     * Texels across each of the six faces of the map, each of which sees 90 degrees. A fragment is judged by what the middle of
     * its texel sees, with its surface continued there as a plane: on flat surfaces the border of a shadow is off by at most half
     * a texel across and half a texel down, as seen from the projector, 0.71 in all. What is nearer to a surface than 4 /
     * ShadowSize of its distance, which is the width of two texels there, does not hide it: shadows begin that far behind what
     * touches a surface. Where a surface turns away from the projector, as at a ball's terminator, its plane leaves it within a
     * texel, and the border is ragged by one, which lies long on the surface there. Where a driver's textures have no room for
     * three faces beside each other they are smaller. The map is drawn when the position or what is around changes, not when the
     * projector turns. Default: 1024.
     */
    vtkSetClampMacro(ShadowSize, int, 16, 4096);
    vtkGetMacro(ShadowSize, int);
    ///@}

    ///@{
    /**
     * The width, in texels, over which the panorama fades at its border where several projectors meet. Default: 0.
     */
    vtkSetMacro(Fade, double);
    vtkGetMacro(Fade, double);
    ///@}

    ///@{
    /**
     * The number of panoramas that stand one above the other in the texture. From 2 on they are concentric mosaics (Shum and He 1999; Kim
     * 2003, 7.2) as anamorph's .mosaic reads them: each of a full turn, seen through the slit of a camera on a circle about Position, in the plane
     * across ViewUp, along the circle's tangents; radii run evenly from -1 to 1 times CircleRadius. A point of the
     * scene is then seen as from the viewer: as seen from above, the line of sight touches a circle, and the slits of the two circles beside it that
     * show this point are mixed. As the scene says where the point is, its height is right whatever its distance. Points within
     * the outer circle, lines of sight that pass by it, and what lies before the place where they touch a circle receive
     * nothing; the height of the viewer above the plane does not count. They are thrown in mode DIRECT, without
     * occluders: what hides a point from the slits hides it from the viewer. Of mipmaps levels are read in which rows are of one panorama alone:
     * as many as its height can be halved without a rest. From 1 to 1024; what is beyond becomes the nearer of these, as of all numbers
     * of VTK that are clamped. Default: 1.
     */
    vtkSetClampMacro(Circles, int, 1, 1024);
    vtkGetMacro(Circles, int);
    ///@}

    ///@{
    /**
     * The radius of the outer circle in world coordinates, above 0. Default: 1.
     */
    vtkSetMacro(CircleRadius, double);
    vtkGetMacro(CircleRadius, double);
    ///@}

    ///@{
    /**
     * Whether concentric mosaics are seen from the camera, or else from Viewpoint, in world coordinates, wherever the camera
     * is. Defaults: on, (0, 0, 0).
     */
    vtkSetMacro(FollowCamera, bool);
    vtkGetMacro(FollowCamera, bool);
    vtkBooleanMacro(FollowCamera, bool);
    vtkSetVector3Macro(Viewpoint, double);
    vtkGetVector3Macro(Viewpoint, double);
    ///@}

  protected:
    vtkAnamorphPanoramaProjector();
    ~vtkAnamorphPanoramaProjector() override;

  private:
    vtkAnamorphPanoramaProjector(const vtkAnamorphPanoramaProjector&) = delete;
    void operator=(const vtkAnamorphPanoramaProjector&) = delete;

    vtkSmartPointer<vtkTexture> Panorama;
    vtkSmartPointer<vtkAlgorithmOutput> Occluders;
    vtkSmartPointer<vtkTrivialProducer> OccluderData;
    int Projection = 0, Shadows = SHADOW_MAP, ShadowSize = 1024;
    double FieldOfView = 0, VerticalFieldOfView = 0, PanniniDistance = 1, ProjectionAlpha = 0.5;
    char* Lens = nullptr;
    double Position[3] = {0, 0, 0}, Direction[3] = {0, 0, -1}, ViewUp[3] = {0, 1, 0};
    double Fade = 0;
    int Circles = 1;
    double CircleRadius = 1, Viewpoint[3] = {0, 0, 0};
    bool FollowCamera = true;
};

#endif
