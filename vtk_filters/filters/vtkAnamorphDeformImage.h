// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphDeformImage
 * @brief an image or a volume resampled through a list of bumps, or back through it
 *
 * The list moves space as vtkAnamorphDeformTransform has it, W(p) = p + sum_i V_i F((u, v), c_i, a_i) (Oka 1987, eq. 4.1), over the
 * plane of Origin, Axis1 and Axis2: the output at q is the input at W^-1(q), or, with Inverse, at W(q), which undoes it. Extent, spacing, origin and
 * direction are those of the input; all point arrays of numbers are resampled, but for ghosts, and cell arrays are dropped. Integers of 64 bits
 * are taken as double has them, and bits become unsigned char. W^-1 is found to the last places of double.
 *
 * What comes from beyond the input is Background. Where the list folds space several points go to one: the output has one
 * of them, or Background where none is found, which GetNumberOfFailures() and the field array "anamorph:failures" count; a warning says where
 * such a fold is. Bumps with depth or side, which do not move space, are refused.
 */
#ifndef vtkAnamorphDeformImage_h
#define vtkAnamorphDeformImage_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkImageAlgorithm.h"
#include "vtkSmartPointer.h"  // for the list

class vtkAnamorphDeformationList;

class ANAMORPHFILTERS_EXPORT vtkAnamorphDeformImage : public vtkImageAlgorithm {
  public:
    static vtkAnamorphDeformImage* New();
    vtkTypeMacro(vtkAnamorphDeformImage, vtkImageAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /**
     * The list of deformations; one of the filter's own until another is set. The methods are those of the list.
     */
    void SetDeformationList(vtkAnamorphDeformationList* list);
    vtkAnamorphDeformationList* GetDeformationList();
    void SetNumberOfDeformations(int number);
    int GetNumberOfDeformations();
    int AddDeformation(double center_u, double center_v, double extent_u, double extent_v, double x, double y,
                       double z, double kernel = 0, double enabled = 1);
    void SetDeformation(int position, double center_u, double center_v, double extent_u, double extent_v,
                        double x, double y, double z, double kernel = 0, double enabled = 1);
    ///@}

    ///@{
    /**
     * A file of deformations (JSON or CSV) that are added to the list. It is read when the filter executes. Default: none.
     */
    vtkSetStringMacro(FileName);
    vtkGetStringMacro(FileName);
    ///@}

    ///@{
    /**
     * The plane of the parameters. A step of Axis1 is 1 in u, a step of Axis2 is 1 in v. Defaults: (0, 0, 0), (1, 0, 0), (0, 1, 0).
     */
    vtkSetVector3Macro(Origin, double);
    vtkGetVector3Macro(Origin, double);
    vtkSetVector3Macro(Axis1, double);
    vtkGetVector3Macro(Axis1, double);
    vtkSetVector3Macro(Axis2, double);
    vtkGetVector3Macro(Axis2, double);
    ///@}

    ///@{
    /**
     * Whether the image is undeformed in place of deformed. Default: off.
     */
    vtkSetMacro(Inverse, bool);
    vtkGetMacro(Inverse, bool);
    vtkBooleanMacro(Inverse, bool);
    ///@}

    enum Interpolations { NEAREST = 0, LINEAR = 1, CUBIC = 2 };
    ///@{
    /**
     * How it is interpolated between the points of the input, as vtkImageInterpolator does, at places that it rounds to 2^-16 of the distance
     * of points. Default: LINEAR.
     */
    vtkSetClampMacro(Interpolation, int, NEAREST, CUBIC);
    vtkGetMacro(Interpolation, int);
    ///@}

    ///@{
    /**
     * The value of what comes from beyond the input, in all components, rounded and clamped to the type of the array. Default: 0.
     */
    vtkSetMacro(Background, double);
    vtkGetMacro(Background, double);
    ///@}

    /**
     * The number of points of the last execution for which no inverse was found.
     */
    vtkGetMacro(NumberOfFailures, vtkIdType);

    vtkMTimeType GetMTime() override;

  protected:
    vtkAnamorphDeformImage();
    ~vtkAnamorphDeformImage() override;

    vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                               vtkInformationVector* outputs) override;
    int FillInputPortInformation(int port, vtkInformation* info) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector** inputs, vtkInformationVector* outputs) override;

  private:
    vtkAnamorphDeformImage(const vtkAnamorphDeformImage&) = delete;
    void operator=(const vtkAnamorphDeformImage&) = delete;

    void Execute(vtkImageData* input, const int* extent, vtkImageData* output);

    vtkSmartPointer<vtkAnamorphDeformationList> DeformationList;
    char* FileName = nullptr;
    double Origin[3] = {0, 0, 0}, Axis1[3] = {1, 0, 0}, Axis2[3] = {0, 1, 0};
    bool Inverse = false;
    int Interpolation = LINEAR;
    double Background = 0;
    vtkIdType NumberOfFailures = 0;
};

#endif
