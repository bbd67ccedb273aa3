// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphFigureImage
 * @brief   A picture of figures, every view ray exact, without OpenGL (Chapman 1986, section 2.9).
 *
 * The output is an image of ViewSize pixels, the first at the lower left, with one array of its points: Colors
 * (red, green, blue and alpha, unsigned char, sRGB; color is not multiplied by alpha) of the styles SHADED,
 * OUTLINE and STICK; Depth (float: from the eye, without perspective from the plane through the middle of the
 * view, in units, 1e30 where there is no body); or BodyId (int: the point of the input, -1 where there is
 * none).
 *
 * Colors are the mean of 16 x 16 rays where a pixel shows more than one body or an edge; nothing is
 * tessellated. Bodies have the colors of the point array Color (3 unsigned chars), or a default one. Bodies
 * hide each other within one input; blocks of composite data become an image each. With AddTexture(), bodies whose string array
 * Texture has the name of one show it, moved by TextureOffset (2 texels): the style textured of `.figure`
 * recipes. A pixel has the same bits in any
 * part of the image that is asked for.
 */
#ifndef vtkAnamorphFigureImage_h
#define vtkAnamorphFigureImage_h

#include "vtkAnamorphFigureAlgorithm.h"
#include "vtkImageData.h"     // of textures
#include "vtkSmartPointer.h"  // for them

#include <string>   // for their names
#include <utility>  // for both
#include <vector>   // for all

namespace anamorph {
// VTK's wrappers read no nested names here.
namespace figure {
struct FigureLook;
}
}  // namespace anamorph

class ANAMORPHFILTERS_EXPORT vtkAnamorphFigureImage : public vtkAnamorphFigureAlgorithm {
  public:
    static vtkAnamorphFigureImage* New();
    vtkTypeMacro(vtkAnamorphFigureImage, vtkAnamorphFigureAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The image that is the output. */
    vtkImageData* GetOutput();

    /** The values of Style. */
    enum { SHADED, OUTLINE, STICK, DEPTH, BODY_ID };
    /** The values of Lighting. */
    enum { RASEL, LAMBERT, BLINN };

    ///@{
    /** The style in which figures are drawn. SHADED by default. */
    vtkSetClampMacro(Style, int, SHADED, BODY_ID);
    vtkGetMacro(Style, int);
    ///@}

    ///@{
    /**
     * How bodies are lit. RASEL, the default: softly from one pole of a body to the other, from above. LAMBERT,
     * BLINN: from over the observer's left shoulder.
     */
    vtkSetClampMacro(Lighting, int, RASEL, BLINN);
    vtkGetMacro(Lighting, int);
    ///@}

    ///@{
    /**
     * Textures of the style SHADED, by their names: images of one slice whose scalars are 1 to 4 components of unsigned
     * char, unsigned short or float; of 2 and of 4 the last one is alpha, by which the colors are multiplied.
     */
    void AddTexture(const char* name, vtkImageData* image);
    void RemoveAllTextures();
    ///@}

    /** The values of TextureMapping. */
    enum { LATLONG, MIRRORED, LINEAR, OCTAHEDRAL };

    ///@{
    /** How textures are mapped onto bodies (vtkAnamorphEllipsoidMapper::SetTextureMapping). LATLONG by default. */
    vtkSetClampMacro(TextureMapping, int, LATLONG, OCTAHEDRAL);
    vtkGetMacro(TextureMapping, int);
    ///@}

    ///@{
    /** Whether colors are means over pixels. On by default; off: colors are those in the middles of pixels. */
    vtkSetMacro(Antialias, bool);
    vtkGetMacro(Antialias, bool);
    vtkBooleanMacro(Antialias, bool);
    ///@}

  protected:
    vtkAnamorphFigureImage();
    ~vtkAnamorphFigureImage() override;

    int FillOutputPortInformation(int port, vtkInformation* information) override;
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    void Draw(vtkPolyData* input, vtkDataObject* output, anamorph_vtk::Execution& execution) override;

  private:
    vtkAnamorphFigureImage(const vtkAnamorphFigureImage&) = delete;
    void operator=(const vtkAnamorphFigureImage&) = delete;

    anamorph::figure::FigureLook GetLook() const;
    void AskedExtent(int extent[6]);

    int Style = SHADED;
    int Lighting = RASEL;
    bool Antialias = true;
    int TextureMapping = LATLONG;
    std::vector<std::pair<std::string, vtkSmartPointer<vtkImageData>>> Textures;
};

#endif
