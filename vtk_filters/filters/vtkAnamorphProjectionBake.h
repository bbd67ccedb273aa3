// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphProjectionBake
 * @brief panoramas thrown onto a mesh, blended, and kept in its own texture
 *
 * The projection of vtkAnamorphPanoramaProjection (Kim 2003, chapter 4) as an image for a mesh that has texture coordinates:
 * the centre of every texel is a point of the mesh, and what projectors throw there is read by the exact formula, in double.
 * Several projectors are blended by angle and distance: each has a share as its rays lie close at the point, the cosine of
 * the angle to the surface over the square of the distance, which fades to 0 at borders of its panorama. With Occlusion a
 * ray to every texel tells what a projector does not see: the mesh hides itself, and so does the third input. What is nearer
 * than 2^-16 of the distance does not. Hidden (blanked) cells are not painted and hide nothing.
 *
 * Input 0 is the mesh (of composite data each mesh is baked by itself, into a texture of its own), with texture coordinates
 * from 0 to 1; where triangles share texels, the first one has them. Input 1 takes one image for each projector, in their order, all with the same number of components; they are read bilinearly.
 * The output is an image that VTK's writers write: the components of the panoramas, and one that says where there is
 * something, 0 or 1 (255 for bytes). It has bytes if all panoramas have, and float otherwise.
 *
 * On several ranks, each has a part of the mesh. Where they are asked for parts of the texture that make up all of it, each rank holds
 * those rows alone, and of the mesh what reaches into them; where they are asked for more, each makes some rows, and gets the others'. What
 * casts shadows is held by every rank. Of composite data, a piece that is asked for is as many of the rows of every texture, the first piece those
 * at the bottom.
 *
 * Field arrays: "anamorph:painted", the number of texels painted; "anamorph:unseen", of those of the mesh that no projector
 * throws anything on.
 */
#ifndef vtkAnamorphProjectionBake_h
#define vtkAnamorphProjectionBake_h

#include <memory>  // for the members

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkAnamorphPanoramaProjection.h"
#include "vtkImageAlgorithm.h"
#include "vtkSmartPointer.h"  // for the members

class vtkDataObjectTree;
class vtkMultiProcessController;

class ANAMORPHFILTERS_EXPORT vtkAnamorphProjectionBake : public vtkImageAlgorithm {
  public:
    static vtkAnamorphProjectionBake* New();
    vtkTypeMacro(vtkAnamorphProjectionBake, vtkImageAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /**
     * The projectors: position, direction of the panorama's middle, and upwards. There has to be one for each panorama.
     */
    void AddProjector(double x, double y, double z, double dx, double dy, double dz, double ux, double uy,
                      double uz);
    void RemoveAllProjectors();
    int GetNumberOfProjectors();
    ///@}

    ///@{
    /**
     * The projection of the panoramas, as vtkAnamorphPanoramaProjection counts them. Default: 0, equirectangular.
     */
    vtkSetClampMacro(Projection, int, 0, vtkAnamorphPanoramaProjection::NumberOfProjections - 1);
    vtkGetMacro(Projection, int);
    ///@}

    ///@{
    /**
     * The horizontal field of view of a panorama, or of each of its faces, in degrees; 0: the projection's default. Default: 0.
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
     * The distortion of the lens that the panoramas were taken through: MODEL:name=value,name=value with ptlens, brown, 3de4, kb4,
     * division, poly or ocam. Default: none.
     */
    vtkSetStringMacro(Lens);
    vtkGetStringMacro(Lens);
    ///@}

    ///@{
    /**
     * The width and height of the texture in texels. Default: 1024 x 1024.
     */
    vtkSetMacro(Width, int);
    vtkGetMacro(Width, int);
    vtkSetMacro(Height, int);
    vtkGetMacro(Height, int);
    ///@}

    ///@{
    /**
     * The width, in texels of a panorama, over which it fades at its borders. Default: 32.
     */
    vtkSetMacro(Fade, double);
    vtkGetMacro(Fade, double);
    ///@}

    ///@{
    /**
     * The width, in texels, of a margin around triangles that is painted, too, for filters that read across borders.
     * Default: 1.
     */
    vtkSetMacro(Margin, double);
    vtkGetMacro(Margin, double);
    ///@}

    ///@{
    /**
     * Whether points that a projector does not see receive nothing from it. Default: on.
     */
    vtkSetMacro(Occlusion, bool);
    vtkGetMacro(Occlusion, bool);
    vtkBooleanMacro(Occlusion, bool);
    ///@}

    /**
     * Adds a panorama.
     */
    void AddPanoramaConnection(vtkAlgorithmOutput* output) { this->AddInputConnection(1, output); }
    void RemoveAllPanoramaConnections() { this->RemoveAllInputConnections(1); }
    /**
     * The third input, which casts shadows, too: a mesh, or all meshes of composite data.
     */
    void SetOccluderConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(2, output); }

    ///@{
    /**
     * Shares the mesh and what casts shadows between all ranks: every rank then makes every so many rows of the texture, gets
     * those of the others, and gives what it is asked for. Every rank has to execute, with all panoramas and, of composite
     * data, the same blocks, of which any may be empty; where one cannot, none gives anything. Default: the global controller; may be null.
     */
    void SetController(vtkMultiProcessController* controller);
    vtkMultiProcessController* GetController();
    ///@}

    vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                               vtkInformationVector* outputs) override;

  protected:
    vtkAnamorphProjectionBake();
    ~vtkAnamorphProjectionBake() override;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int FillOutputPortInformation(int port, vtkInformation* info) override;
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphProjectionBake(const vtkAnamorphProjectionBake&) = delete;
    void operator=(const vtkAnamorphProjectionBake&) = delete;

    struct Projectors;
    struct Run;

    /// Bakes a texture for every mesh of composite data.
    void BakeBlocks(vtkDataObjectTree* meshes, vtkInformationVector** inputs, vtkInformation* output,
                    vtkDataObjectTree* textures);

    std::unique_ptr<Projectors> Poses;
    int Projection = 0, Width = 1024, Height = 1024;
    double FieldOfView = 0, PanniniDistance = 1, VerticalFieldOfView = 0, ProjectionAlpha = 0.5, Fade = 32,
           Margin = 1;
    char* Lens = nullptr;
    bool Occlusion = true;
    vtkSmartPointer<vtkMultiProcessController> Controller;
};

#endif
