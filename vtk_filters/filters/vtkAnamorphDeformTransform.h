// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphDeformTransform
 * @brief a list of bumps as a transform of space, with its inverse
 *
 * A point moves by sum_i V_i F((u, v), c_i, a_i) (Oka 1987, eq. 4.1), u and v being its coordinates on a
 * plane: p = Origin + u Axis1 + v Axis2 + a part across both. Everything above and below a point of the plane
 * moves along with it. vtkAnamorphDeformationList says what the list is; it can be shared with a
 * vtkAnamorphDeform. Works wherever a vtkWarpTransform does (vtkTransformFilter, vtkImageReslice).
 *
 * Derivatives are exact. The inverse is found by Newton's method for two unknowns, to the last places of
 * double (InverseTolerance and InverseIterations are not used); displacements across the plane invert
 * exactly. Where the map folds there is no single inverse: GetFold() looks for such a place, a warning says
 * so when an inverted transform is brought up to date, and GetNumberOfFailures() counts points for which none
 * was found.
 */
#ifndef vtkAnamorphDeformTransform_h
#define vtkAnamorphDeformTransform_h

#include <memory>  // for the implementation

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkSmartPointer.h"        // for the list
#include "vtkWarpTransform.h"

class vtkAnamorphDeformationList;

class ANAMORPHFILTERS_EXPORT vtkAnamorphDeformTransform : public vtkWarpTransform {
  public:
    static vtkAnamorphDeformTransform* New();
    vtkTypeMacro(vtkAnamorphDeformTransform, vtkWarpTransform);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /**
     * The list of deformations; one of the transform's own until another is set.
     */
    void SetDeformationList(vtkAnamorphDeformationList* list);
    vtkAnamorphDeformationList* GetDeformationList();
    ///@}

    ///@{
    /**
     * The plane of the parameters. A step of Axis1 is 1 in u, a step of Axis2 is 1 in v. Defaults: (0, 0, 0),
     * (1, 0, 0), (0, 1, 0).
     */
    vtkSetVector3Macro(Origin, double);
    vtkGetVector3Macro(Origin, double);
    vtkSetVector3Macro(Axis1, double);
    vtkGetVector3Macro(Axis1, double);
    vtkSetVector3Macro(Axis2, double);
    vtkGetVector3Macro(Axis2, double);
    ///@}

    enum FoldStates { NO_FOLD = 0, FOLD = 1, UNDECIDED = 2 };
    /**
     * Whether the map folds: NO_FOLD (proved), FOLD (somewhere its Jacobian determinant is not positive), or
     * UNDECIDED (it comes close to that, or the list is too long to tell).
     */
    int GetFold();
    /**
     * The parameters of a place where the map folds, after GetFold() has returned FOLD.
     */
    vtkGetVector2Macro(FoldParameters, double);
    /**
     * The number of points, since the transform was last changed, for which no inverse was found.
     */
    vtkIdType GetNumberOfFailures();

    vtkAbstractTransform* MakeTransform() override;
    vtkMTimeType GetMTime() override;

  protected:
    vtkAnamorphDeformTransform();
    ~vtkAnamorphDeformTransform() override;

    void ForwardTransformPoint(const float in[3], float out[3]) override;
    void ForwardTransformPoint(const double in[3], double out[3]) override;
    void ForwardTransformDerivative(const float in[3], float out[3], float derivative[3][3]) override;
    void ForwardTransformDerivative(const double in[3], double out[3], double derivative[3][3]) override;
    void InverseTransformPoint(const float in[3], float out[3]) override;
    void InverseTransformPoint(const double in[3], double out[3]) override;
    void InverseTransformDerivative(const float in[3], float out[3], float derivative[3][3]) override;
    void InverseTransformDerivative(const double in[3], double out[3], double derivative[3][3]) override;

    void InternalUpdate() override;
    void InternalDeepCopy(vtkAbstractTransform* transform) override;

  private:
    vtkAnamorphDeformTransform(const vtkAnamorphDeformTransform&) = delete;
    void operator=(const vtkAnamorphDeformTransform&) = delete;

    vtkSmartPointer<vtkAnamorphDeformationList> DeformationList;
    double Origin[3] = {0, 0, 0}, Axis1[3] = {1, 0, 0}, Axis2[3] = {0, 1, 0};
    double FoldParameters[2] = {0, 0};

    struct Map;
    std::unique_ptr<Map> Warp;
};

#endif
