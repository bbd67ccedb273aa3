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
 *
 * A second input, port 1, is optional: heights around each body, an image as textures are, whose brightness, the mean of up to three
 * components, turns normals (Blinn 1978). Solid textures and what stands for bodies in outlines are those of `.figure` recipes, whose rows
 * (anamorph/operation/figure_look.h) say defaults and ranges. Images of the style OUTLINE have the field array "anamorph:max_error", how far
 * lines may be from bodies' outlines, in pixels, and where bodies are left out "anamorph:left_out", their names.
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

    /** The values of Solid. */
    enum { NONE, WOOD, MARBLE, CHECKER, FORMULA };

    ///@{
    /**
     * Of style SHADED, a color at every point of a body, as if it were cut out of a block. NONE, the default; WOOD: rings about the y axis,
     * eight to a scale; MARBLE: veins, one to a scale; CHECKER: cubes of half a scale; FORMULA: by SolidRed, SolidGreen and SolidBlue.
     */
    vtkSetClampMacro(Solid, int, NONE, FORMULA);
    vtkGetMacro(Solid, int);
    /** The length that the formulas of Solid call scale, in units, 0.001 to 1e6; 100 by default. */
    vtkSetMacro(SolidScale, double);
    vtkGetMacro(SolidScale, double);
    /** A pixel's color is the mean at this number of points of it either way, 1 to 16; 4 by default; 1 without Antialias. */
    vtkSetMacro(SolidSamples, int);
    vtkGetMacro(SolidSamples, int);
    ///@}

    ///@{
    /**
     * Of FORMULA: red, green and blue from 0 to 1, formulas of x, y and z, the point in the body's own axes from its centre in units, z away
     * from the observer of a script as scripts have it, of own_red, own_green and own_blue, the body's color, of scale and of frame, the
     * input's time to the nearest whole number. By default, and where they are empty, the body's own color. SolidDefinitions makes names for
     * all three, as in k=0.3;c=cos(k).
     */
    void SetSolidRed(const char* text) { this->SetText(this->SolidRed, text); }
    const char* GetSolidRed() { return this->SolidRed.c_str(); }
    void SetSolidGreen(const char* text) { this->SetText(this->SolidGreen, text); }
    const char* GetSolidGreen() { return this->SolidGreen.c_str(); }
    void SetSolidBlue(const char* text) { this->SetText(this->SolidBlue, text); }
    const char* GetSolidBlue() { return this->SolidBlue.c_str(); }
    void SetSolidDefinitions(const char* text) { this->SetText(this->SolidDefinitions, text); }
    const char* GetSolidDefinitions() { return this->SolidDefinitions.c_str(); }
    ///@}

    ///@{
    /** The heights of style SHADED, which lie on bodies by TextureMapping. */
    void SetBumpConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }
    /** How high brightness 1 of these is, in units, -1e6 to 1e6; 10 by default. */
    vtkSetMacro(BumpScale, double);
    vtkGetMacro(BumpScale, double);
    ///@}

    /** The values of Outlines. */
    enum { LIMBS, LEVELS, BOXES, CONTOURS, CYLINDERS };

    ///@{
    /**
     * What stands for bodies in the style OUTLINE. LIMBS, the default: their outlines. LEVELS: each figure, of which the string
     * array Figure says the names, is a dot, sticks, boxes or contours, the first that is within OutlineTolerance of these (Fetter). BOXES. CONTOURS: across each body's longest
     * axis, as few as hold OutlineTolerance. CYLINDERS: with shadow lines, circular arcs, clip and crease, nothing hidden (Willmert).
     */
    vtkSetClampMacro(Outlines, int, LIMBS, CYLINDERS);
    vtkGetMacro(Outlines, int);
    /** Of LEVELS and CONTOURS: how far what stands for bodies may be from their outlines, in pixels, 0.001 to 1e6; 1 by default. */
    vtkSetMacro(OutlineTolerance, double);
    vtkGetMacro(OutlineTolerance, double);
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

    int FillInputPortInformation(int port, vtkInformation* information) override;
    int FillOutputPortInformation(int port, vtkInformation* information) override;
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    void Draw(vtkPolyData* input, vtkDataObject* output, anamorph_vtk::Execution& execution) override;

  private:
    vtkAnamorphFigureImage(const vtkAnamorphFigureImage&) = delete;
    void operator=(const vtkAnamorphFigureImage&) = delete;

    anamorph::figure::FigureLook GetLook() const;
    void SetOwnLook(anamorph::figure::FigureLook& look) const;
    vtkImageData* Heights() const;
    void SetText(std::string& member, const char* text);
    void AskedExtent(int extent[6]);

    int Style = SHADED;
    int Lighting = RASEL;
    bool Antialias = true;
    int TextureMapping = LATLONG;
    int Solid = NONE, SolidSamples, Outlines = LIMBS;
    double SolidScale, BumpScale, OutlineTolerance;
    std::string SolidRed, SolidGreen, SolidBlue, SolidDefinitions;
    std::vector<std::pair<std::string, vtkSmartPointer<vtkImageData>>> Textures;
};

#endif
