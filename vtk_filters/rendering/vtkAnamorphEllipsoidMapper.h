// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphEllipsoidMapper
 * @brief   Draws points as ellipsoids, exact at every pixel, without triangles (ray casting).
 *
 * Each point of a data set, or of the data sets of composite data, is an ellipsoid around it. Its shape comes
 * from arrays of the points:
 *
 * - AXES, the default: half the lengths of its axes (AxesArray, 3 components) and a quaternion w, x, y, z that
 *   turns them (OrientationArray, 4 components; none if the name is empty), as vtkAnamorphFigureReader writes
 *   them.
 * - TENSOR: the unit sphere under a matrix (TensorArray, 9 components row by row, or 6 of a symmetric one in
 *   VTK's order XX, YY, ZZ, XY, YZ, XZ), as of diffusion tensors and of vtkTensorGlyph.
 * - COVARIANCE: the same array is the matrix C of the surface x^T C^-1 x = 1, as of displacements of atoms
 *   (ORTEP): half axes are the roots of the eigenvalues. With Probability 0.5, or ScaleFactor 1.5382, an atom is within with a
 *   probability of 50%.
 *
 * A point is left out, and counted by GetNumberOfSkippedPoints(), where a number is not finite, the
 * quaternion is zero, or an axis is not longer than 1e-10 of the body's longest. Hidden (blanked) points and
 * ghosts are left out, too.
 *
 * A pixel shows what the view ray through its middle meets first, at its depth: bodies pass through each
 * other and through whatever else is in the scene. Perspective and parallel views are exact; other
 * projections (oblique ones) are not supported. Multisampling does not smooth edges; FXAA does. Where the
 * near plane or a clipping plane of the mapper cuts a body open, its far side is seen from within, as is all
 * around a camera that is within one.
 *
 * Materials, lights, scalars (of points, or of the cells that they are in first), clipping planes, opacity
 * and hardware selection are those of VTK; a selection finds the ids of the points, or of these cells. A
 * texture of the actor is laid around every body as by vtkAnamorphFigureGeometry. Representation (wireframe,
 * points), edges, and culling do nothing.
 *
 * Style PRINCIPAL_ELLIPSES draws the three sections of each body across its axes as lines 2 pixels wide, and OCTANT
 * cuts out the octant that looks toward the eye as well, whose three faces are hatched, as ORTEP has it. What is behind the octant shows through;
 * depths and selections are those of what is left, and IntersectWithLine() takes the body whole. Where the eye or a cut is within
 * a body, that one is whole.
 *
 * While the window is interacted with (its DesiredUpdateRate is 1 or more) the InteractiveBodies largest are drawn, if there
 * are more. Pictures that stand still, and selections, have all of them.
 *
 * With OcclusionCulling, bodies that others certainly hide, or that are beside the picture, are found by the processor's threads before each frame and not
 * drawn. The picture has the same bits. Of those that are left, as many are drawn as they are, while the window is interacted with too, if they are not more
 * than InteractiveBodies. It pays where OpenGL is software: there AUTOMATIC, the default, does so for 20000 bodies and more. Where bodies
 * are seen through or cut open (opacity, textures with alpha, clipping planes, a camera within, OCTANT), and in selections, nothing is left out.
 *
 * Bodies have textures of their own where AddTexture() gave any: TextureArray says which one, by name as
 * vtkAnamorphFigureReader does, or by number. They lie on a body as the script's do where core's renderer draws them
 * (style textured of `.figure` recipes): the formulas of TextureMapping are the same ones. Colors are lit
 * like those of bodies, and the body's own color shows through where a texture is transparent.
 *
 * Pickers: vtkPropPicker and vtkHardwareSelector draw, and find what is seen. vtkCellPicker meets the cells of
 * the input, which here are points: give it this mapper's locators, by AddLocators(), and it finds the cell of
 * the body that is seen, the point (GetPointId()), and where the body is met. Of composite data, vtkCellPicker only looks into a
 * block where the line passes its points' box, widened by SetTolerance(): let that be as wide as bodies reach
 * beyond their points. Points in no cell are found by IntersectWithLine() alone.
 */
#ifndef vtkAnamorphEllipsoidMapper_h
#define vtkAnamorphEllipsoidMapper_h

#include "AnamorphRenderingModule.h"  // for the export macro
#include "vtkOpenGLPolyDataMapper.h"

#include <functional>  // for what is drawn several times
#include <memory>      // for what it draws
#include <string>      // for names of arrays

class vtkCellPicker;
class vtkCompositeDataDisplayAttributes;
class vtkTexture;

class ANAMORPHRENDERING_EXPORT vtkAnamorphEllipsoidMapper : public vtkOpenGLPolyDataMapper {
  public:
    static vtkAnamorphEllipsoidMapper* New();
    vtkTypeMacro(vtkAnamorphEllipsoidMapper, vtkOpenGLPolyDataMapper);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The input is a vtkDataSet or vtkCompositeDataSet. */
    void SetInputData(vtkDataObject* data) { this->SetInputDataInternal(0, data); }

    /** Draws what `mapper` draws, in its way: shares its input, and its textures and display attributes themselves. */
    void ShallowCopy(vtkAbstractMapper* mapper) override;

    /** The values of Shape. */
    enum { AXES, TENSOR, COVARIANCE };

    ///@{
    /** How the arrays give the shapes of bodies, as described above. AXES by default. */
    vtkSetClampMacro(Shape, int, AXES, COVARIANCE);
    vtkGetMacro(Shape, int);
    ///@}

    ///@{
    /** The name of the array of half axes. "Axes" by default. */
    void SetAxesArray(const char* name);
    const char* GetAxesArray() { return this->AxesArray.c_str(); }
    ///@}

    ///@{
    /** The name of the array of quaternions; empty: bodies are not turned. "Orientation" by default. */
    void SetOrientationArray(const char* name);
    const char* GetOrientationArray() { return this->OrientationArray.c_str(); }
    ///@}

    ///@{
    /** The name of the array of tensors. Empty by default. */
    void SetTensorArray(const char* name);
    const char* GetTensorArray() { return this->TensorArray.c_str(); }
    ///@}

    ///@{
    /** The factor by which all bodies are scaled about their centers; positive. The default is 1. */
    vtkSetMacro(ScaleFactor, double);
    vtkGetMacro(ScaleFactor, double);
    ///@}

    ///@{
    /** With COVARIANCE, the probability with which a body holds its point: between 0 and 1, or 0, the default, for the roots of the eigenvalues. */
    vtkSetMacro(Probability, double);
    vtkGetMacro(Probability, double);
    ///@}

    /** The values of Style. */
    enum { PLAIN, PRINCIPAL_ELLIPSES, OCTANT };

    ///@{
    /** How bodies look, as described above. PLAIN by default. */
    vtkSetClampMacro(Style, int, PLAIN, OCTANT);
    vtkGetMacro(Style, int);
    ///@}

    ///@{
    /** How many bodies, the largest, are drawn while the window is interacted with; 0: all. The default is 250000. */
    vtkSetClampMacro(InteractiveBodies, int, 0, VTK_INT_MAX);
    vtkGetMacro(InteractiveBodies, int);
    ///@}

    /** The values of OcclusionCulling. */
    enum { AUTOMATIC, NEVER, ALWAYS };

    ///@{
    /** Whether bodies that are hidden are found before they are drawn, as described above. AUTOMATIC by default. */
    vtkSetClampMacro(OcclusionCulling, int, AUTOMATIC, ALWAYS);
    vtkGetMacro(OcclusionCulling, int);
    ///@}

    /** The number of bodies that were drawn last, those that others of them hide among them. */
    vtkIdType GetNumberOfDrawnBodies();

    ///@{
    /**
     * Adds a texture for bodies, the next in number from 0 on, and its name, which may be empty. The texture itself says
     * whether it is interpolated and has mipmaps; it has to repeat (vtkTexture::RepeatOn, the default) for LATLONG.
     */
    void AddTexture(vtkTexture* texture, const char* name = "");
    void RemoveAllTextures();
    int GetNumberOfTextures();
    ///@}

    ///@{
    /**
     * The name of the array of the points that says which texture a body has: names, or numbers; a body without one has its
     * color. "Texture" by default.
     */
    void SetTextureArray(const char* name);
    const char* GetTextureArray() { return this->TextureArray.c_str(); }
    ///@}

    ///@{
    /** The name of the array of 2 texels, right and down, by which a body's texture is moved. "TextureOffset" by default. */
    void SetTextureOffsetArray(const char* name);
    const char* GetTextureOffsetArray() { return this->TextureOffsetArray.c_str(); }
    ///@}

    /** The values of TextureMapping. */
    enum { LATLONG, MIRRORED, LINEAR, OCTAHEDRAL };

    ///@{
    /**
     * How a texture is mapped onto a body, its middle towards the observer of an unturned one. LATLONG, the default: once
     * around, the seam at the back. MIRRORED: over the front, mirrored over the back. LINEAR: stripes stay straight.
     * OCTAHEDRAL: without a pole.
     */
    vtkSetClampMacro(TextureMapping, int, LATLONG, OCTAHEDRAL);
    vtkGetMacro(TextureMapping, int);
    ///@}

    ///@{
    /**
     * Finds where a line from `from` to `to`, in the coordinates of the data, first meets a body of `block`, the input or one
     * of its blocks. Returns the point of `block`, -1 if there is none, and sets `t` to the place along the line, 0 to 1, and
     * `cell` to the first cell that the point is in, -1 if it is in none. Where the line begins in a body, it meets it where it
     * leaves. Clipping planes are ignored.
     */
    vtkIdType IntersectWithLine(vtkDataSet* block, const double from[3], const double to[3], double& t,
                                vtkIdType& cell);
    /** Gives a picker vtkAnamorphEllipsoidLocators of the input's blocks as they are now, which find what
     * IntersectWithLine() does. */
    void AddLocators(vtkCellPicker* picker);
    ///@}

    ///@{
    /**
     * Which blocks of composite data are visible, their colors (instead of those of scalars and of the material) and their
     * opacities. None by default: all are alike.
     */
    void SetCompositeDataDisplayAttributes(vtkCompositeDataDisplayAttributes* attributes);
    vtkCompositeDataDisplayAttributes* GetCompositeDataDisplayAttributes();
    ///@}

    /** The modification time, that of the blocks' attributes included. */
    vtkMTimeType GetMTime() override;
    bool HasOpaqueGeometry() override;
    bool HasTranslucentPolygonalGeometry() override;

    /** The number of points that made no ellipsoid when the bounds were computed, or the picture drawn, last. */
    vtkIdType GetNumberOfSkippedPoints();

    void Render(vtkRenderer* renderer, vtkActor* actor) override;
    void RenderPiece(vtkRenderer* renderer, vtkActor* actor) override;
    void ReleaseGraphicsResources(vtkWindow* window) override;
    /** Does nothing: for a selection the ids themselves are drawn. */
    void ProcessSelectorPixelBuffers(vtkHardwareSelector*, std::vector<unsigned int>&, vtkProp*) override {}

  protected:
    vtkAnamorphEllipsoidMapper();
    ~vtkAnamorphEllipsoidMapper() override;

    using Shaders = std::map<vtkShader::Type, vtkShader*>;

    int FillInputPortInformation(int port, vtkInformation* information) override;
    int CanUseTextureMapForColoring(vtkDataObject*) override { return 0; }  // a body has one color
    void ComputeBounds() override;
    bool GetNeedToRebuildBufferObjects(vtkRenderer* renderer, vtkActor* actor) override;
    bool GetNeedToRebuildShaders(vtkOpenGLHelper& helper, vtkRenderer* renderer, vtkActor* actor) override;
    void BuildBufferObjects(vtkRenderer* renderer, vtkActor* actor) override;
    void UpdateMaximumPointCellIds(vtkRenderer* renderer, vtkActor* actor) override;
    void RenderPieceDraw(vtkRenderer* renderer, vtkActor* actor) override;
    void GetShaderTemplate(Shaders shaders, vtkRenderer* renderer, vtkActor* actor) override;
    void ReplaceShaderColor(Shaders shaders, vtkRenderer* renderer, vtkActor* actor) override;
    void ReplaceShaderNormal(Shaders shaders, vtkRenderer* renderer, vtkActor* actor) override;
    void ReplaceShaderPicking(Shaders shaders, vtkRenderer* renderer, vtkActor* actor) override;
    void ReplaceShaderPositionVC(Shaders shaders, vtkRenderer* renderer, vtkActor* actor) override;
    void ReplaceShaderTCoord(Shaders shaders, vtkRenderer* renderer, vtkActor* actor) override;
    void ReplaceShaderClip(Shaders, vtkRenderer*, vtkActor*) override {}
    void ReplaceShaderEdges(Shaders, vtkRenderer*, vtkActor*) override {}
    void ReplaceShaderCoincidentOffset(Shaders, vtkRenderer*, vtkActor*) override {}
    void SetMapperShaderParameters(vtkOpenGLHelper& helper, vtkRenderer* renderer, vtkActor* actor) override;
    void SetCameraShaderParameters(vtkOpenGLHelper& helper, vtkRenderer* renderer, vtkActor* actor) override;

  private:
    vtkAnamorphEllipsoidMapper(const vtkAnamorphEllipsoidMapper&) = delete;
    void operator=(const vtkAnamorphEllipsoidMapper&) = delete;

    void LeaveWindow();
    bool GatherBodies();
    void ColorBodies(vtkActor* actor);
    bool IsFaded();
    bool IsNear(vtkRenderer* renderer, vtkActor* actor);
    void FindVariant(vtkRenderer* renderer, vtkActor* actor);
    bool ChooseBodies(vtkRenderer* renderer, vtkActor* actor);
    bool IsCulled(vtkRenderer* renderer, vtkActor* actor);
    void CullBodies(vtkRenderer* renderer, vtkActor* actor);
    void DrawTextured(vtkRenderer* renderer, const std::function<void()>& draw);
    void SetTexture(vtkShaderProgram* program);
    void SetClips(vtkOpenGLHelper& helper, vtkActor* actor, const double* view_to_data);

    int Shape = AXES;
    std::string AxesArray = "Axes", OrientationArray = "Orientation", TensorArray;
    double ScaleFactor = 1, Probability = 0;
    int Style = PLAIN, InteractiveBodies = 250000, OcclusionCulling = AUTOMATIC;
    std::string TextureArray = "Texture", TextureOffsetArray = "TextureOffset";
    int TextureMapping = LATLONG;

    struct Drawing;
    std::unique_ptr<Drawing> Current;
};

#endif
