// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphReliefSource
 * @brief   A plane raised by a picture, the start of facial relief (Oka 1987, section 4.1).
 *
 * The picture is the optional input, or is read from a file. The point over the position (x, y) of the
 * picture, in pixels from the centre of the first, is
 *
 *     P = Origin + s (Point1 - Origin) + t (Point2 - Origin) + (HeightScale h(x, y) + HeightOffset) N,
 *
 * where s = x / (width - 1), t = y / (height - 1), N is the plane's unit normal (Point1 - Origin) x (Point2 -
 * Origin), and h is a component of the picture, or its luminance: floating point as it is, whole numbers as
 * fractions of the largest one of their type (255 is 1). Rows go up, as in all of VTK's pictures.
 *
 * The output is a vtkStructuredGrid: it has no cells to store, is cut into pieces by rows and columns without
 * seams, and stays a grid for filters that make use of that (vtkAnamorphDeform). Surface views and filters
 * take it; vtkDataSetSurfaceFilter makes it a vtkPolyData. It has the array Height (the distance from the
 * plane) and texture coordinates ((x + 1/2) / width, (y + 1/2) / height), with which the picture as a texture
 * lies exactly on its heights. A point has the same bits in any piece and for any number of threads.
 */
#ifndef vtkAnamorphReliefSource_h
#define vtkAnamorphReliefSource_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkAlgorithm.h"           // for the reader of the file
#include "vtkImageData.h"           // for the picture
#include "vtkSmartPointer.h"        // for the same
#include "vtkStructuredGridAlgorithm.h"

#include <string>  // for the name of the file

class ANAMORPHFILTERS_EXPORT vtkAnamorphReliefSource : public vtkStructuredGridAlgorithm {
  public:
    static vtkAnamorphReliefSource* New();
    vtkTypeMacro(vtkAnamorphReliefSource, vtkStructuredGridAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The values of Component. */
    enum { LUMINANCE = -1 };

    ///@{
    /**
     * The name of the picture's file, in any format that VTK's image readers know. It is not read if there is an
     * input. A file that was written anew is read again after Modified().
     */
    void SetFileName(const char* name);
    const char* GetFileName() { return this->FileName.c_str(); }
    ///@}

    ///@{
    /**
     * The corner of the picture's first pixel, the end of its first row and the end of its first column, as
     * in vtkPlaneSource. The default is the unit square around the origin of the x-y-plane.
     */
    vtkSetVector3Macro(Origin, double);
    vtkGetVector3Macro(Origin, double);
    vtkSetVector3Macro(Point1, double);
    vtkGetVector3Macro(Point1, double);
    vtkSetVector3Macro(Point2, double);
    vtkGetVector3Macro(Point2, double);
    /** Sets the three to a rectangle around the origin of the x-y-plane. */
    void SetSize(double width, double height);
    ///@}

    ///@{
    /** Whether an edge of the plane is shortened, around its middle, so that pixels are square. On by default. */
    vtkSetMacro(KeepAspect, bool);
    vtkGetMacro(KeepAspect, bool);
    vtkBooleanMacro(KeepAspect, bool);
    ///@}

    ///@{
    /** The height of h = 1 over that of h = 0. The default is 0.1. */
    vtkSetMacro(HeightScale, double);
    vtkGetMacro(HeightScale, double);
    ///@}

    ///@{
    /** The height of h = 0 over the plane. The default is 0. */
    vtkSetMacro(HeightOffset, double);
    vtkGetMacro(HeightOffset, double);
    ///@}

    ///@{
    /**
     * The component that is the height, counted from 0, or LUMINANCE (the default): 0.2126 R + 0.7152 G + 0.0722 B
     * of the numbers as stored; for pictures with less than three components, the first.
     */
    vtkSetClampMacro(Component, int, LUMINANCE, VTK_INT_MAX);
    vtkGetMacro(Component, int);
    ///@}

    ///@{
    /**
     * The approximate number of pixels from point to point, from 1 (the default). Points are evenly spread from the
     * first pixel to the last; they are on pixels if this divides width - 1 and height - 1, else heights are
     * interpolated (bilinearly).
     */
    vtkSetClampMacro(SampleRate, int, 1, VTK_INT_MAX);
    vtkGetMacro(SampleRate, int);
    ///@}

    ///@{
    /** Numbers of points along rows and columns, from 2; 0 (the default) leaves it to SampleRate. */
    vtkSetVector2Macro(Resolution, int);
    vtkGetVector2Macro(Resolution, int);
    ///@}

    ///@{
    /** Smoothing of the heights: standard deviation of a Gaussian, in pixels, from 0 (none, the default) to
     * 100. */
    vtkSetClampMacro(Smoothing, double, 0.0, 100.0);
    vtkGetMacro(Smoothing, double);
    ///@}

    ///@{
    /** Whether there are normals, from differences of neighbouring points. Off by default. */
    vtkSetMacro(GenerateNormals, bool);
    vtkGetMacro(GenerateNormals, bool);
    vtkBooleanMacro(GenerateNormals, bool);
    ///@}

    ///@{
    /** The precision of points: vtkAlgorithm::SINGLE_PRECISION (the default) or DOUBLE_PRECISION. */
    vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DOUBLE_PRECISION);
    vtkGetMacro(OutputPointsPrecision, int);
    ///@}

  protected:
    vtkAnamorphReliefSource();
    ~vtkAnamorphReliefSource() override;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphReliefSource(const vtkAnamorphReliefSource&) = delete;
    void operator=(const vtkAnamorphReliefSource&) = delete;

    vtkInformation* PictureInformation(vtkInformationVector** inputs);
    vtkImageData* Picture(vtkInformationVector** inputs);
    void ReaderFails();
    void CheckReader();

    std::string FileName;
    double Origin[3] = {-0.5, -0.5, 0};
    double Point1[3] = {0.5, -0.5, 0};
    double Point2[3] = {-0.5, 0.5, 0};
    bool KeepAspect = true;
    double HeightScale = 0.1;
    double HeightOffset = 0;
    int Component = LUMINANCE;
    int SampleRate = 1;
    int Resolution[2] = {0, 0};
    double Smoothing = 0;
    bool GenerateNormals = false;
    int OutputPointsPrecision = SINGLE_PRECISION;
    vtkSmartPointer<vtkAlgorithm> Reader;  ///< the reader of FileName
    long long FileTime = 0;                ///< the time when the file that it reads was written
    bool ReaderFailed = false;             ///< the reader made an error; not all readers set an error code
};

#endif
