// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphPanoramaRepresentation
 * @brief   Surfaces with a panorama thrown onto them in ParaView's render views, by vtkAnamorphProjectionShader.
 *
 * It is a vtkGeometryRepresentation in all else: what a fragment receives is multiplied with its color.
 *
 * With Occlusion the surfaces hide what lies behind them from the projector, blocks that are not shown included. Every rank
 * that draws gets the triangles of all ranks, so that a picture is the same on any number of them.
 */
#ifndef vtkAnamorphPanoramaRepresentation_h
#define vtkAnamorphPanoramaRepresentation_h

#include "AnamorphRepresentationsModule.h"  // for the export macro
#include "vtkGeometryRepresentation.h"
#include "vtkNew.h"  // for the members

class vtkAnamorphPanoramaProjector;
class vtkAnamorphProjectionShader;
class vtkMatrixToLinearTransform;
class vtkPolyData;
class vtkTexture;
class vtkTransformPolyDataFilter;

class ANAMORPHREPRESENTATIONS_EXPORT vtkAnamorphPanoramaRepresentation : public vtkGeometryRepresentation {
  public:
    static vtkAnamorphPanoramaRepresentation* New();
    vtkTypeMacro(vtkAnamorphPanoramaRepresentation, vtkGeometryRepresentation);
    void PrintSelf(ostream& os, vtkIndent indent) override;
    int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* input,
                           vtkInformation* output) override;

    /** The picture. It is made to interpolate, to repeat, and to have mipmaps. */
    void SetPanorama(vtkTexture* panorama);

    ///@{
    /** Properties of the vtkAnamorphPanoramaProjector. */
    void SetPanoramaProjection(int projection);
    void SetPanoramaFieldOfView(double degrees);
    void SetPanoramaVerticalFieldOfView(double degrees);
    void SetPanoramaPanniniDistance(double d);
    void SetPanoramaProjectionAlpha(double alpha);
    void SetPanoramaLens(const char* lens);
    void SetProjectorPosition(double x, double y, double z);
    void SetProjectorDirection(double x, double y, double z);
    void SetProjectorViewUp(double x, double y, double z);
    void SetShadows(int mode);
    void SetShadowSize(int texels);
    void SetCircles(int count);
    void SetCircleRadius(double radius);
    void SetFollowCamera(bool follow);
    void SetViewpoint(double x, double y, double z);
    ///@}

    /** Whether what is hidden from the projector stays unpainted. Default: off. */
    void SetOcclusion(bool occlusion);

    ///@{
    /** Properties of the vtkAnamorphProjectionShader. */
    void SetProjectionMode(int mode);
    void SetHideUnpainted(bool hide);
    ///@}

  protected:
    vtkAnamorphPanoramaRepresentation();
    ~vtkAnamorphPanoramaRepresentation() override;

  private:
    vtkAnamorphPanoramaRepresentation(const vtkAnamorphPanoramaRepresentation&) = delete;
    void operator=(const vtkAnamorphPanoramaRepresentation&) = delete;

    void SendOccluders(vtkInformation* view);
    void ReceiveOccluders(vtkInformation* view);

    vtkNew<vtkAnamorphPanoramaProjector> Projector;
    vtkNew<vtkAnamorphProjectionShader> Shader;
    bool Occlusion = false;
    /// The triangles of this rank, and the time when what they were made of changed.
    vtkNew<vtkPolyData> OwnTriangles;
    vtkMTimeType OwnTime = 0;
    /// The triangles of all ranks, by the way from the data to the world.
    vtkNew<vtkMatrixToLinearTransform> ToWorld;
    vtkNew<vtkTransformPolyDataFilter> Occluders;
};

#endif
