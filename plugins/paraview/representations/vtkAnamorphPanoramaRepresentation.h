// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphPanoramaRepresentation
 * @brief   Surfaces with a panorama thrown onto them in ParaView's render views, by vtkAnamorphProjectionShader.
 *
 * It is a vtkGeometryRepresentation in all else: what a fragment receives is multiplied with its color.
 */
#ifndef vtkAnamorphPanoramaRepresentation_h
#define vtkAnamorphPanoramaRepresentation_h

#include "AnamorphRepresentationsModule.h"  // for the export macro
#include "vtkGeometryRepresentation.h"
#include "vtkNew.h"  // for the members

class vtkAnamorphPanoramaProjector;
class vtkAnamorphProjectionShader;
class vtkTexture;

class ANAMORPHREPRESENTATIONS_EXPORT vtkAnamorphPanoramaRepresentation : public vtkGeometryRepresentation {
  public:
    static vtkAnamorphPanoramaRepresentation* New();
    vtkTypeMacro(vtkAnamorphPanoramaRepresentation, vtkGeometryRepresentation);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The picture. It is made to interpolate, to repeat, and to have mipmaps. */
    void SetPanorama(vtkTexture* panorama);

    ///@{
    /** As of vtkAnamorphPanoramaProjector. */
    void SetPanoramaProjection(int projection);
    void SetPanoramaFieldOfView(double degrees);
    void SetPanoramaPanniniDistance(double d);
    void SetPanoramaLens(const char* lens);
    void SetProjectorPosition(double x, double y, double z);
    void SetProjectorDirection(double x, double y, double z);
    void SetProjectorViewUp(double x, double y, double z);
    ///@}

    ///@{
    /** As of vtkAnamorphProjectionShader. */
    void SetProjectionMode(int mode);
    void SetHideUnpainted(bool hide);
    ///@}

  protected:
    vtkAnamorphPanoramaRepresentation();
    ~vtkAnamorphPanoramaRepresentation() override;

  private:
    vtkAnamorphPanoramaRepresentation(const vtkAnamorphPanoramaRepresentation&) = delete;
    void operator=(const vtkAnamorphPanoramaRepresentation&) = delete;

    vtkNew<vtkAnamorphPanoramaProjector> Projector;
    vtkNew<vtkAnamorphProjectionShader> Shader;
};

#endif
