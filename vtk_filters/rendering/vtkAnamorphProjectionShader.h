// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphProjectionShader
 * @brief throws panoramas onto actors, fragment by fragment
 *
 * Projective texture mapping with panoramas of any projection (Kim 2003, chapter 4) on the mappers of polygons of VTK's OpenGL:
 * no texture coordinates, and no triangle is cut. What a fragment receives is multiplied with its colour after lighting, as
 * VTK does with textures; an ambient of 1 and a diffuse of 0 show the panorama as it is. What receives nothing keeps its own
 * colour, or is not drawn.
 *
 * It sets replacements and uniforms of the actor's vtkShaderProperty and textures of its vtkProperty, which no other actor
 * must share: after replacing one of these, call AddTo() again. Other replacements are kept, but not one of //VTK::TCoord::Impl in fragment shaders, which ours
 * replaces: a texture by texture coordinates does not show. Changes of projectors show in the next frame.
 *
 * Positions are taken from the renderer's camera, with matrices multiplied in double: far from the origin nothing trembles that
 * VTK draws calmly, and coordinates that a mapper shifts and scales do not matter.
 *
 * What stands before a fragment hides it (vtkAnamorphPanoramaProjector::SetOccluderConnection): by a map of distances, by default,
 * with borders of shadows off by up to 0.71 of its texels on flat surfaces, and about one, raggedly, where surfaces turn away from the
 * projector; or by rays, exactly but for the rounding of float (vtkAnamorphPanoramaProjector::SetShadows), always or in stills.
 *
 * Where several projectors meet, each has a share in proportion to the cosine of its rays to the surface's normal over the
 * square of the distance, as vtkAnamorphProjectionBake does it.
 */
#ifndef vtkAnamorphProjectionShader_h
#define vtkAnamorphProjectionShader_h

#include <memory>  // for the members
#include <string>  // for the machine

#include "AnamorphRenderingModule.h"  // for the export macro
#include "vtkObject.h"

class vtkActor;
class vtkAnamorphPanoramaProjector;
class vtkRenderer;
class vtkShaderProperty;

class ANAMORPHRENDERING_EXPORT vtkAnamorphProjectionShader : public vtkObject {
  public:
    static vtkAnamorphProjectionShader* New();
    vtkTypeMacro(vtkAnamorphProjectionShader, vtkObject);
    void PrintSelf(ostream& os, vtkIndent indent) override;
    vtkMTimeType GetMTime() override;

    /// The largest number of projectors at a time.
    static constexpr int MostProjectors = 8;

    ///@{
    /**
     * The projectors. Default: none.
     */
    void AddProjector(vtkAnamorphPanoramaProjector* projector);
    void RemoveProjector(vtkAnamorphPanoramaProjector* projector);
    void RemoveAllProjectors();
    int GetNumberOfProjectors();
    vtkAnamorphPanoramaProjector* GetProjector(int index);
    ///@}

    /// How a fragment finds its colour.
    enum Modes {
        DIRECT = 0,  ///< by the panorama's formula
        RESIDUAL,    ///< by a matrix, a division and a table of what is left (Kim 2003, 4.4.1)
        MULTIPASS    ///< from the panorama as it was drawn on projection planes before (Kim 2003, 4.4.2)
    };
    ///@{
    /**
     * Modes RESIDUAL and MULTIPASS divide what is around into level directions of projection. Fragments that are in the
     * field of view of none, above and below, are found as in mode DIRECT. RESIDUAL is for panoramas without faces, and tables
     * of which no bound of .25 texels is proven are not read. MULTIPASS samples a panorama twice, drops its transparency, and
     * has no mipmaps. Default: DIRECT.
     */
    void SetMode(int mode);
    vtkGetMacro(Mode, int);
    void SetModeToDirect() { this->SetMode(DIRECT); }
    void SetModeToResidual() { this->SetMode(RESIDUAL); }
    void SetModeToMultipass() { this->SetMode(MULTIPASS); }
    ///@}

    ///@{
    /**
     * The number of directions of projection, all around. Default: 4.
     */
    vtkSetClampMacro(NumberOfDirections, int, 3, 32);
    vtkGetMacro(NumberOfDirections, int);
    ///@}

    ///@{
    /**
     * The extent of a projection plane up and down, at a distance of 1: 1 is 45 degrees. Default: 1.
     */
    vtkSetMacro(VerticalReach, double);
    vtkGetMacro(VerticalReach, double);
    ///@}

    ///@{
    /**
     * The number of rows and of columns of a table of residuals. Default: 256.
     */
    vtkSetClampMacro(TableSize, int, 2, 4096);
    vtkGetMacro(TableSize, int);
    ///@}

    ///@{
    /**
     * In mode RESIDUAL, the hardware of 2003 whose bump maps the tables are (Kim 2003, 4.4), as docs/machines.md describes it:
     * embm-2003:projecting=pixel, and what differs from it, such as embm-2003:projecting=pixel,card=geforce4,planes=4,size=64. Texels
     * have the machine's format and scale, and are read with weights of its bits; it says how many projection planes there are, how
     * far they go, and how large tables are, in place of NumberOfDirections, VerticalReach and TableSize. One plane lies where the
     * panorama's middle is, and up to two go to 45 degrees, unless x_max and y_max say otherwise. Every table is read,
     * whatever its bound, which counts the format and the weights. What a card could not do is refused, and so are what a scene leaves
     * no choice of and panoramas that are neither equirectangular, cylindrical nor mercator. Other modes read no machine, and warn of one. Default: none.
     */
    void SetMachine(const char* text);
    const char* GetMachine() { return this->Machine.c_str(); }
    ///@}

    ///@{
    /**
     * The width and height of a projection plane in pixels. Default: 1024.
     */
    vtkSetClampMacro(PlaneSize, int, 16, 8192);
    vtkGetMacro(PlaneSize, int);
    ///@}

    /**
     * The largest distance, in mode RESIDUAL, of the texels that fragments of an actor found in the last frame from those of
     * the panorama's formula, in texels, proven but for the rounding of float; 0 in other modes.
     */
    double GetResidualBound(vtkActor* actor, int projector = 0);

    /**
     * The number of times that the shadow map of a projector has been drawn, and the tree of boxes for its rays been made, for
     * the window that an actor was last drawn in; 0 where there is none. Actors in one window share both.
     */
    int GetNumberOfShadowDraws(vtkActor* actor, int projector = 0);

    ///@{
    /**
     * Whether fragments that receive nothing are left out. Default: off.
     */
    vtkSetMacro(HideUnpainted, bool);
    vtkGetMacro(HideUnpainted, bool);
    vtkBooleanMacro(HideUnpainted, bool);
    ///@}

    ///@{
    /**
     * Add an actor onto which the projectors throw, or remove it. An actor takes part with one shader at a time.
     */
    void AddTo(vtkActor* actor);
    void RemoveFrom(vtkActor* actor);
    ///@}

  protected:
    vtkAnamorphProjectionShader();
    ~vtkAnamorphProjectionShader() override;

  private:
    vtkAnamorphProjectionShader(const vtkAnamorphProjectionShader&) = delete;
    void operator=(const vtkAnamorphProjectionShader&) = delete;

    void AddToAll();

    struct Internals;

    int Mode = DIRECT, NumberOfDirections = 4, TableSize = 256, PlaneSize = 1024;
    double VerticalReach = 1;
    std::string Machine;
    bool HideUnpainted = false;
    std::unique_ptr<Internals> Inside;
};

#endif
