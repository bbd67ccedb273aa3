// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphImageMorph
 * @brief an image on the way to another, along lines that both have
 *
 * Feature morphing (Beier and Neely 1992; Kim 2003, section 5.6): lines that correspond to each other in two images say where each part
 * of them goes; both are warped to lines in between, and blended, every pixel within Tolerance, which is proven. The first two
 * inputs are the images, each a vtkImageData of one slice with 1 to 4 components of unsigned char, unsigned short or float, of which
 * the second or fourth is alpha; both of the same type. Of the second one the array is taken that has the name of the first one's, or else its
 * scalars. The other two inputs are the lines, vtkPolyData in the coordinates of the first and of the second image: as many lines in both, in the same
 * order, each with as many points. Any filter or widget may move them. In their place FileName may name a file of features. Without either
 * the images are blended as they are.
 *
 * Extent, spacing, origin and direction are those of the first image, and so are type and names of the array. An image of another
 * size is taken to show the same, scaled. The field array "anamorph:max_error" says what was reached.
 */
#ifndef vtkAnamorphImageMorph_h
#define vtkAnamorphImageMorph_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkImageAlgorithm.h"

class vtkAlgorithmOutput;

class ANAMORPHFILTERS_EXPORT vtkAnamorphImageMorph : public vtkImageAlgorithm {
  public:
    static vtkAnamorphImageMorph* New();
    vtkTypeMacro(vtkAnamorphImageMorph, vtkImageAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /// The second image: a vtkImageData.
    void SetOtherConnection(vtkAlgorithmOutput* output);
    ///@{
    /**
     * The lines over the first image, and those over the second: vtkPolyData, optional.
     */
    void SetLinesConnection(vtkAlgorithmOutput* output);
    void SetOtherLinesConnection(vtkAlgorithmOutput* output);
    ///@}

    ///@{
    /**
     * A file of features in place of the lines: .json, .csv or .svg, whose coordinates are pixels from the upper left. Default: none.
     */
    vtkSetFilePathMacro(FileName);
    vtkGetFilePathMacro(FileName);
    ///@}

    ///@{
    /**
     * How far the shape is on the way: 0 is the first image's, 1 the second one's. Default: 0.5.
     */
    vtkSetClampMacro(Shape, double, 0, 1);
    vtkGetMacro(Shape, double);
    ///@}

    ///@{
    /**
     * How far the color is on the way where ColorFollowsShape is off. Default: 0.5.
     */
    vtkSetClampMacro(Color, double, 0, 1);
    vtkGetMacro(Color, double);
    ///@}

    ///@{
    /**
     * Is the color as far on the way as the shape? Default: yes.
     */
    vtkSetMacro(ColorFollowsShape, bool);
    vtkGetMacro(ColorFollowsShape, bool);
    vtkBooleanMacro(ColorFollowsShape, bool);
    ///@}

    ///@{
    /**
     * The numbers a, b and p of a line's weight (length^p / (a + distance))^b (Kim 2003, eq. 5.11): the smaller a, the closer lines are followed; b is how
     * fast a line's influence falls off, and p how much more long lines count. Defaults: 1, 2 and 0.5.
     */
    vtkSetClampMacro(WeightA, double, 0, 1e6);
    vtkGetMacro(WeightA, double);
    vtkSetClampMacro(WeightB, double, 0, 16);
    vtkGetMacro(WeightB, double);
    vtkSetClampMacro(WeightP, double, 0, 16);
    vtkGetMacro(WeightP, double);
    ///@}

    ///@{
    /**
     * Holds the images' border by lines of this weight; 0: only where the file of features says so. Default: 0.
     */
    vtkSetClampMacro(PinBorder, double, 0, VTK_DOUBLE_MAX);
    vtkGetMacro(PinBorder, double);
    ///@}

    enum Interpolations { NEAREST = 0, LINEAR = 1, CUBIC = 2, ANTIALIAS = 3 };
    ///@{
    /**
     * How the images are interpolated between pixels; ANTIALIAS is linear where a map magnifies, and averages where it shrinks.
     * Default: ANTIALIAS.
     */
    vtkSetClampMacro(Interpolation, int, NEAREST, ANTIALIAS);
    vtkGetMacro(Interpolation, int);
    ///@}

    ///@{
    /**
     * The most by which what a pixel shows of either image may be off, in pixels of it, at least 0. Default: 0.01.
     */
    vtkSetClampMacro(Tolerance, double, 0, VTK_DOUBLE_MAX);
    vtkGetMacro(Tolerance, double);
    ///@}

    /// The proven bound of the last execution, in pixels of the images.
    vtkGetMacro(MaxError, double);

  protected:
    vtkAnamorphImageMorph();
    ~vtkAnamorphImageMorph() override;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                               vtkInformationVector* outputs) override;
    int RequestInformation(vtkInformation*, vtkInformationVector** inputs,
                           vtkInformationVector* outputs) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

  private:
    vtkAnamorphImageMorph(const vtkAnamorphImageMorph&) = delete;
    void operator=(const vtkAnamorphImageMorph&) = delete;

    void Draw(vtkInformationVector** inputs, const int* extent, vtkImageData* output);

    char* FileName = nullptr;
    int Interpolation = ANTIALIAS;
    bool ColorFollowsShape = true;
    double Shape = 0.5, Color = 0.5, WeightA = 1, WeightB = 2, WeightP = 0.5, PinBorder = 0, Tolerance = 0.01,
           MaxError = 0;
};

#endif
