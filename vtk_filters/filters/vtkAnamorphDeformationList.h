// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphDeformationList
 * @brief an editable list of bumps that deform a surface
 *
 * A deformation moves the point of a surface that has the parameters (u, v) by V F, where F is 1 at the
 * centre and falls off with the extent (Oka 1987, eq. 4.1 and 4.2). It is nine numbers, in this order:
 *
 *     center_u center_v extent_u extent_v x y z kernel enabled
 *
 * Centre and extent are in the units of the parameters, V = (x, y, z) in those of the points. Kernel is 0
 * (Gaussian: F = exp(-r^2)) or 1 (Wendland's C2 function: F = (1 - r)^4 (4 r + 1) up to r = 1, then 0), where
 * r is 1 on the ellipse whose half axes are the extents. Enabled is 1 or 0.
 *
 * The order of the list does not matter to the surface. Numbers are taken as they are; what executes the list
 * (vtkAnamorphDeform, vtkAnamorphDeformTransform) refuses those that make no sense: extents that are not
 * positive, numbers that are not finite.
 */
#ifndef vtkAnamorphDeformationList_h
#define vtkAnamorphDeformationList_h

#include <array>   // for a deformation
#include <string>  // for names
#include <vector>  // for the list

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkObject.h"

class vtkTable;

class ANAMORPHFILTERS_EXPORT vtkAnamorphDeformationList : public vtkObject {
  public:
    static vtkAnamorphDeformationList* New();
    vtkTypeMacro(vtkAnamorphDeformationList, vtkObject);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    enum Kernels { GAUSSIAN = 0, WENDLAND_C2 = 1 };
    enum Sides { BOTH_SIDES = 0, FRONT = 1, BACK = 2 };

    ///@{
    /**
     * The number of deformations, from 0 to 2^20. New ones move nothing.
     */
    void SetNumberOfDeformations(int number);
    int GetNumberOfDeformations();
    ///@}

    ///@{
    /**
     * Edits of the list. Positions count from 0; a position that is not in the list is an error, and changes
     * nothing. AddDeformation returns the position of the new deformation. MoveDeformation moves the one at
     * `from` to `to`.
     */
    int AddDeformation(double center_u, double center_v, double extent_u, double extent_v, double x, double y,
                       double z, double kernel = 0, double enabled = 1);
    void InsertDeformation(int position, double center_u, double center_v, double extent_u, double extent_v,
                           double x, double y, double z, double kernel = 0, double enabled = 1);
    void SetDeformation(int position, double center_u, double center_v, double extent_u, double extent_v,
                        double x, double y, double z, double kernel = 0, double enabled = 1);
    void SetDeformationEnabled(int position, bool enabled);
    bool GetDeformationEnabled(int position);
    void MoveDeformation(int from, int to);
    void RemoveDeformation(int position);
    void RemoveAllDeformations();
    ///@}

    ///@{
    /**
     * The nine numbers of a deformation. The pointer is valid until the next call.
     */
    void GetDeformation(int position, double numbers[9]);
    double* GetDeformation(int position) VTK_SIZEHINT(9);
    ///@}

    ///@{
    /**
     * The depth of a deformation: three more numbers, center_w extent_w side, all 0 of a new one. With an extent_w that is
     * not 0, ((w - center_w) / extent_w)^2 is added to r^2, where w is the depth of the point: it moves what is near in depth
     * alone. Side is 0 (both), 1 (front: where the surface's normal is within 90 degrees of V, in full within 60) or 2
     * (back, as the front of -V). SetDepth at a position beyond the list appends deformations that move nothing;
     * SetNumberOfDepths makes those from `number` on 0. The pointer is valid until the next call.
     */
    void SetDepth(int position, double center_w, double extent_w, double side = 0);
    void SetNumberOfDepths(int number);
    /** The number of deformations up to the last one with a depth or side. */
    int GetNumberOfDepths();
    double* GetDepth(int position) VTK_SIZEHINT(3);
    ///@}

    ///@{
    /**
     * The frame of a deformation that has a depth, a quaternion w x y z of any length but 0: its extents go along the
     * directions that it turns u, v and w into. 1 0 0 0, that of a new one, is no turn. The pointer is valid until the next call.
     */
    void SetOrientation(int position, double w, double x, double y, double z);
    double* GetOrientation(int position) VTK_SIZEHINT(4);
    ///@}

    enum Mirrors { NO_MIRROR = 0, MIRROR_U = 1, MIRROR_V = 2 };
    ///@{
    /**
     * The mirror image of a deformation: two numbers, mirror and at. With MIRROR_U it counts again beyond the line u = at, with
     * MIRROR_V beyond v = at, with V mirrored as points of the plane are, or, where there is none, in x, or y. One that is its own image
     * counts once. The pointer is valid until the next call.
     */
    void SetMirror(int position, double mirror, double at);
    double* GetMirror(int position) VTK_SIZEHINT(2);
    ///@}

    ///@{
    /**
     * The name of a deformation, for people; none is empty. GetName of a position that is not in the list is empty too.
     */
    void SetName(int position, const char* name);
    std::string GetName(int position);
    ///@}

    ///@{
    /**
     * Read and write the list as a file, CSV if its name ends in .csv, else JSON. A file that is written reads
     * back to the bit. Return 1, or 0 after an error; reading then leaves the list as it is.
     */
    int ReadFile(const char* name);
    int WriteFile(const char* name);
    ///@}

    ///@{
    /**
     * Read and write the list as a table with the columns named above; kernel (a number, or gaussian or wendland_c2)
     * and enabled may be missing, and so may center_w, extent_w and side (a number, or both, front or back), orientation_w to orientation_z, mirror (a number, or none, u or v), mirror_at and name. ReadTable returns 1, or 0 after an error, which leaves the list as it is.
     */
    int ReadTable(vtkTable* table);
    void WriteTable(vtkTable* table);
    ///@}

    void DeepCopy(vtkAnamorphDeformationList* other);

#ifndef __VTK_WRAP__
    /// The nine numbers, the three of the depth, the four of the orientation and the two of the mirror; and the name.
    struct Numbers : std::array<double, 18> {
        using Array = std::array<double, 18>;
        std::string Name;
        bool operator==(const Numbers& other) const {
            return static_cast<const Array&>(*this) == other && this->Name == other.Name;
        }
    };
    const std::vector<Numbers>& GetAll() const {
        return this->List;
    }
#endif

  protected:
    vtkAnamorphDeformationList();
    ~vtkAnamorphDeformationList() override;

  private:
    vtkAnamorphDeformationList(const vtkAnamorphDeformationList&) = delete;
    void operator=(const vtkAnamorphDeformationList&) = delete;

    bool IsPosition(int position, int end);

    void SetNumbers(int position, int first, const std::vector<double>& numbers);
    double* GetNumbers(int position, int first, int end);

    std::vector<Numbers> List;
    double Answer[18] = {};
};

#endif
