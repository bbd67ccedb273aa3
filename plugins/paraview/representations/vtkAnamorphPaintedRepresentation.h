// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphPaintedRepresentation
 * @brief   What vtkAnamorphPanoramaProjection has painted, with its panorama.
 *
 * It is a vtkGeometryRepresentation that shows the texels that come with the data ("anamorph:picture" and
 * "anamorph:picture_size") by their texture coordinates. Without these it shows lines of the panorama, 36 across and 18 down, on
 * colors that tell right from left and up from down. A texture that is set is shown instead of either. It is not colored by arrays.
 */
#ifndef vtkAnamorphPaintedRepresentation_h
#define vtkAnamorphPaintedRepresentation_h

#include "AnamorphRepresentationsModule.h"  // for the export macro
#include "vtkGeometryRepresentation.h"
#include "vtkNew.h"           // for the members
#include "vtkSmartPointer.h"  // for the texels

class vtkImageData;
class vtkTexture;
class vtkUnsignedCharArray;

class ANAMORPHREPRESENTATIONS_EXPORT vtkAnamorphPaintedRepresentation : public vtkGeometryRepresentation {
  public:
    static vtkAnamorphPaintedRepresentation* New();
    vtkTypeMacro(vtkAnamorphPaintedRepresentation, vtkGeometryRepresentation);
    void PrintSelf(ostream& os, vtkIndent indent) override;
    int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* input,
                           vtkInformation* output) override;

    void SetTexture(vtkTexture* texture) override;

  protected:
    vtkAnamorphPaintedRepresentation();
    ~vtkAnamorphPaintedRepresentation() override;

    void UpdateColoringParameters() override;

  private:
    vtkAnamorphPaintedRepresentation(const vtkAnamorphPaintedRepresentation&) = delete;
    void operator=(const vtkAnamorphPaintedRepresentation&) = delete;

    void TakePicture(vtkDataObject* shown);

    vtkNew<vtkImageData> Image;
    vtkNew<vtkTexture> Own;
    /// The texels that Image has; null: the lines.
    vtkSmartPointer<vtkUnsignedCharArray> Texels;
    bool Given = false;  ///< a texture is set
};

#endif
