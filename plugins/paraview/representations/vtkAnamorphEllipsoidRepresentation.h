// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphEllipsoidRepresentation
 * @brief   Points as ellipsoids in ParaView's render views, drawn by vtkAnamorphEllipsoidMapper.
 *
 * It is a vtkGeometryRepresentation of all points of the data instead of their surface: colors, lights,
 * transforms, blocks and selection of points are those of any other representation. There is no coarser level of
 * detail, since none is faster.
 */
#ifndef vtkAnamorphEllipsoidRepresentation_h
#define vtkAnamorphEllipsoidRepresentation_h

#include "AnamorphRepresentationsModule.h"  // for the export macro
#include "vtkGeometryRepresentation.h"
#include "vtkSmartPointer.h"  // for textures

#include <string>  // for their names
#include <vector>  // for both

class vtkAnamorphEllipsoidMapper;
class vtkTexture;

class ANAMORPHREPRESENTATIONS_EXPORT vtkAnamorphEllipsoidRepresentation : public vtkGeometryRepresentation {
  public:
    static vtkAnamorphEllipsoidRepresentation* New();
    vtkTypeMacro(vtkAnamorphEllipsoidRepresentation, vtkGeometryRepresentation);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /** Properties of the vtkAnamorphEllipsoidMapper. */
    void SetShape(int shape);
    void SetAxesArray(const char* name);
    void SetOrientationArray(const char* name);
    void SetTensorArray(const char* name);
    void SetScaleFactor(double factor);
    void SetProbability(double probability);
    void SetStyle(int style);
    void SetInteractiveBodies(int count);
    void SetTextureArray(const char* name);
    void SetTextureMapping(int mapping);
    ///@}

    ///@{
    /** Textures of bodies, and their names; as many of them have one as there are names. */
    void AddTexture(vtkTexture* texture);
    void RemoveAllTextures();
    void SetNumberOfTextureNames(int count);
    void SetTextureName(int i, const char* name);
    ///@}

    /** Does nothing: points have the ids that they have in the data. */
    void SetArrayIdNames(const char*, const char*) override {}

    int ProcessViewRequest(vtkInformationRequestKey* request, vtkInformation* input,
                           vtkInformation* output) override;

  protected:
    vtkAnamorphEllipsoidRepresentation();
    ~vtkAnamorphEllipsoidRepresentation() override;

  private:
    vtkAnamorphEllipsoidRepresentation(const vtkAnamorphEllipsoidRepresentation&) = delete;
    void operator=(const vtkAnamorphEllipsoidRepresentation&) = delete;

    vtkAnamorphEllipsoidMapper* Ellipsoids();
    void ShowBlocksOf(vtkDataObject* data, bool blocks_changed);
    void GiveTextures();

    vtkDataObject* Shown = nullptr;  // compared, and nothing else
    vtkMTimeType ShownTime = 0;
    std::vector<vtkSmartPointer<vtkTexture>> Textures;
    std::vector<std::string> TextureNames;
};

#endif
