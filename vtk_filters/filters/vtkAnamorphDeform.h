// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphDeform
 * @brief deform a surface by an editable list of bumps and by a formula
 *
 * Free-form deformation of Oka 1987, section 4.1: the point of the surface that has the parameters (u, v)
 * moves by sum_i V_i F((u, v), c_i, a_i) (eq. 4.1), F a Gaussian (eq. 4.2) or a compact kernel. The list is
 * this filter's own (the methods below; vtkAnamorphDeformationList says what the nine numbers of a
 * deformation are), and those of a file and of a table on the second input beside it. A formula of u and v
 * that is text may move the points as well, with bumps or without.
 *
 * Parameters are texture coordinates (the point array chosen with SetInputArrayToProcess(0, 0, 0, 0, name),
 * or the active ones), or those of a plane: p = Origin + u Axis1 + v Axis2 + a part across both. With
 * AutomaticPlane, u and v are the two of x, y and z in which the whole data (all blocks, all ranks of the
 * Controller) are largest: centres are then points of that plane, and extents lengths. The two stay while the
 * data have the same points and cells by number and connectivity, so that bumps do not jump when a surface
 * turns, unless the surface has become flat along one of them; an execution without AutomaticPlane forgets
 * them.
 *
 * Input: any vtkPointSet; image data and rectilinear grids, which come out as structured grids with explicit
 * points; multiblock data and collections of partitioned data sets, and AMR, which comes out as a multiblock of its
 * levels. Leaves of other types are passed on. Points that have no finite parameters stay. What comes out shares all arrays but the points,
 * their normals and the Displacement array. Cell normals are dropped, and point normals unless ComputeNormals
 * is on. Normals are exact (from the kernels' derivatives) for a plane's parameters if the input has normals
 * or lies in the plane; otherwise the surface's own tangents are those of its cells (and the displacement's
 * derivatives exact), which needs ghost cells where a surface is cut into pieces: one level more is
 * requested.
 *
 * Sums are in fixed point: the same bits for any order and history of the list, number of threads and cut
 * into pieces. While input and settings stay, only what an edit of the list reaches is computed again.
 * GetErrorBound() and the field array "anamorph:error_bound" of each data set say how far a component of the
 * displacement can be from eq. (4.1) plus the formula, before it is rounded to the type of the points.
 *
 * What the formula gives is added to the sum in double. Where it has no value, or none that double holds, it
 * does not move a point: the field array "anamorph:undefined_points" of each data set says how many these are.
 * Where rounding decides on which side of a jump a point is, the bound is as large as the jump. Normals take
 * what has no derivative, as the tip of a cone, for level.
 *
 * The second output, with GenerateOverlay, is the paper's Fig. 4.1: a + at each centre and the oval of its
 * extent, on the deformed surface. Cell arrays: Deformation (position in the list), Enabled.
 */
#ifndef vtkAnamorphDeform_h
#define vtkAnamorphDeform_h

#include <array>     // for what is picked
#include <memory>    // for the implementation
#include <optional>  // for what is picked
#include <string>    // for the formulas
#include <vector>    // for names

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkPassInputTypeAlgorithm.h"
#include "vtkSmartPointer.h"  // for the members

class vtkAnamorphDeformationList;
class vtkDoubleArray;
class vtkMultiProcessController;
class vtkPolyData;
class vtkStringArray;

class ANAMORPHFILTERS_EXPORT vtkAnamorphDeform : public vtkPassInputTypeAlgorithm {
  public:
    static vtkAnamorphDeform* New();
    vtkTypeMacro(vtkAnamorphDeform, vtkPassInputTypeAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /**
     * The list of deformations. Another object may be set, to be shared with another
     * filter or a transform.
     */
    void SetDeformationList(vtkAnamorphDeformationList* list);
    vtkAnamorphDeformationList* GetDeformationList();
    void SetNumberOfDeformations(int number);
    int GetNumberOfDeformations();
    int AddDeformation(double center_u, double center_v, double extent_u, double extent_v, double x, double y,
                       double z, double kernel = 0, double enabled = 1);
    void InsertDeformation(int position, double center_u, double center_v, double extent_u, double extent_v,
                           double x, double y, double z, double kernel = 0, double enabled = 1);
    void SetDeformation(int position, double center_u, double center_v, double extent_u, double extent_v,
                        double x, double y, double z, double kernel = 0, double enabled = 1);
    double* GetDeformation(int position) VTK_SIZEHINT(9);
    void SetDeformationEnabled(int position, bool enabled);
    bool GetDeformationEnabled(int position);
    void MoveDeformation(int from, int to);
    void RemoveDeformation(int position);
    void RemoveAllDeformations();
    /**
     * The depth and the side of a deformation (vtkAnamorphDeformationList::SetDepth). The depth w of a point is its distance
     * from the plane of (u, v), to the side of Axis1 x Axis2 (of the automatic plane: along x, y or z), or the third component
     * of texture coordinates; normals are those of the undeformed surface: its own, or else those of its cells.
     */
    void SetDepth(int position, double center_w, double extent_w, double side = 0);
    void SetNumberOfDepths(int number);
    int GetNumberOfDepths();
    double* GetDepth(int position) VTK_SIZEHINT(3);
    /**
     * The frame, the mirror image and the name of a deformation (vtkAnamorphDeformationList::SetOrientation and those that follow).
     */
    void SetOrientation(int position, double w, double x, double y, double z);
    double* GetOrientation(int position) VTK_SIZEHINT(4);
    void SetMirror(int position, double mirror, double at);
    double* GetMirror(int position) VTK_SIZEHINT(2);
    void SetDeformationName(int position, const char* name);
    std::string GetDeformationName(int position);
    /**
     * Anchors a deformation to the undeformed surface of the last execution, on the plane: to what is there over
     * its centre, of several parts the one nearest in depth. It gets its depth, a frame whose third direction is the surface's normal, an extent in depth, the lesser of the two along
     * the plane, if it has none, and V, whose length stays, along the normal, or against it where V is. Returns 1, or 0 after an error.
     * All ranks of the controller call it together, and take the best of all their parts.
     */
    int AnchorDeformation(int position);
    /**
     * Adds a deformation that shows on the surface of the last execution without knowing it: a tenth of its diagonal high and a sixth of
     * its lengths wide, outwards, on the side of an eye that looks from where x, y and z are large. Where one part of the surface
     * alone is over the middle of the plane it is there, straight on the plane; elsewhere, as on closed surfaces, it has a depth and a
     * frame as AnchorDeformation() gives them, so that the far side stays. Where a mesh of polygons has hardly a point within its extents,
     * Subdivisions becomes what it takes; on other such meshes it is put onto the nearest point, and a warning says how few it has. In texture coordinates it has no depth. Returns its position, or -1 after an error: where there are no
     * points. All ranks of the controller call it together.
     */
    int AddDefaultDeformation();
    ///@}

    ///@{
    /**
     * For hosts of tables and files: the list's numbers, nine components each, and those of depths, three; the list read from a file, or
     * written to one (by rank 0). Without a name they do nothing. They return 1, or 0 after an error.
     */
    vtkDoubleArray* GetAllDeformations();
    vtkDoubleArray* GetAllDepths();
    /**
     * The same of a table with frames, seven numbers a row: the orientation, mirror and at, and the number of the name in a list of names,
     * counted from 1 (0: none). SetNumberOfFrames makes rows from `number` on as those of new deformations. A number that has
     * no name is an error when the filter executes or the list is written.
     */
    void SetTableFrame(int position, double w, double x, double y, double z, double mirror, double at,
                       double name);
    void SetNumberOfFrames(int number);
    /** The number of deformations up to the last one with a frame, a mirror image or a name. */
    int GetNumberOfFrames();
    vtkDoubleArray* GetAllFrames();
    void SetTableName(int index, const char* name);
    void SetNumberOfTableNames(int number);
    int GetNumberOfTableNames() { return static_cast<int>(this->TableNames.size()); }
    vtkStringArray* GetAllNames();
    int ReadDeformations(const char* name);
    int WriteDeformations(const char* name);
    ///@}

    ///@{
    /**
     * A file of deformations (JSON or CSV) that are added to the list. It is read when the filter executes.
     * Default: none.
     */
    vtkSetStringMacro(FileName);
    vtkGetStringMacro(FileName);
    ///@}

    /**
     * A vtkTable of deformations that are added to the list, with columns as in
     * vtkAnamorphDeformationList::ReadTable. Of several ranks, tables that are the same count once.
     */
    void SetTableConnection(vtkAlgorithmOutput* output) { this->SetInputConnection(1, output); }

    ///@{
    /**
     * The formulas, as text, of what is added to x, y and z of a point: of u and v, the parameters in which the
     * centres of bumps are given, and of frame, which is Frame; formula/formula_text.h says how they are
     * written. An empty formula, the default, is 0. FormulaDefinitions defines names for all three, as in
     * k=0.3;c=cos(k); it is not read while all three are empty.
     */
    void SetFormulaX(const char* text) { this->SetText(this->FormulaX, text); }
    const char* GetFormulaX() { return this->FormulaX.c_str(); }
    void SetFormulaY(const char* text) { this->SetText(this->FormulaY, text); }
    const char* GetFormulaY() { return this->FormulaY.c_str(); }
    void SetFormulaZ(const char* text) { this->SetText(this->FormulaZ, text); }
    const char* GetFormulaZ() { return this->FormulaZ.c_str(); }
    void SetFormulaDefinitions(const char* text) { this->SetText(this->FormulaDefinitions, text); }
    const char* GetFormulaDefinitions() { return this->FormulaDefinitions.c_str(); }
    ///@}

    ///@{
    /**
     * The value of frame in the formulas, finite. Default: 0.
     */
    vtkSetMacro(Frame, double);
    vtkGetMacro(Frame, double);
    ///@}

    enum ParameterModes { PLANE = 0, TEXTURE_COORDINATES = 1 };
    ///@{
    /**
     * The source of the parameters of a point. Default: PLANE.
     */
    vtkSetClampMacro(ParameterMode, int, PLANE, TEXTURE_COORDINATES);
    vtkGetMacro(ParameterMode, int);
    void SetParameterModeToPlane() { this->SetParameterMode(PLANE); }
    void SetParameterModeToTextureCoordinates() { this->SetParameterMode(TEXTURE_COORDINATES); }
    ///@}

    ///@{
    /**
     * Whether the plane is taken from the bounds of the data, which is not possible where pieces of the data
     * are streamed through one process. Default: on.
     */
    vtkSetMacro(AutomaticPlane, bool);
    vtkGetMacro(AutomaticPlane, bool);
    vtkBooleanMacro(AutomaticPlane, bool);
    ///@}

    ///@{
    /**
     * The plane, if it is not automatic. The axes are any two vectors that are not parallel; a step of Axis1 is 1
     * in u, a step of Axis2 is 1 in v. Defaults: (0, 0, 0), (1, 0, 0), (0, 1, 0).
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
     * The plane of the last execution. FreezePlane() keeps it for the next ones: it sets Origin, Axis1 and
     * Axis2 to it, and AutomaticPlane off.
     */
    void FreezePlane();
    vtkGetVector3Macro(UsedOrigin, double);
    vtkGetVector3Macro(UsedAxis1, double);
    vtkGetVector3Macro(UsedAxis2, double);
    ///@}

    ///@{
    /**
     * How often the triangles of a surface, whose polygons are cut into them, are cut into four before points are moved: coarse surfaces
     * show no bump without, and what comes out then has other points and cells than the input. For vtkPolyData of polygons alone, in which no edge
     * is of more than two triangles; other polygonal data are refused, and grids left as they are. From 0 to 10. Default: 0.
     */
    vtkSetClampMacro(Subdivisions, int, 0, 10);
    vtkGetMacro(Subdivisions, int);
    ///@}

    ///@{
    /**
     * The value below which Gaussians are cut off, from 0 (nowhere) to 0.5. Default: 1e-7.
     */
    vtkSetMacro(Cutoff, double);
    vtkGetMacro(Cutoff, double);
    ///@}

    ///@{
    /**
     * Whether the points get normals. Default: on.
     */
    vtkSetMacro(ComputeNormals, bool);
    vtkGetMacro(ComputeNormals, bool);
    vtkBooleanMacro(ComputeNormals, bool);
    ///@}

    ///@{
    /**
     * Whether the points get the array Displacement. Default: on.
     */
    vtkSetMacro(ComputeDisplacement, bool);
    vtkGetMacro(ComputeDisplacement, bool);
    vtkBooleanMacro(ComputeDisplacement, bool);
    ///@}

    ///@{
    /**
     * Whether the points get the array Jacobian: the determinant of the Jacobian of the map of space that the deformations and the formula
     * make, over the plane of the parameters. 1 is as it was; where it is 0 or less, space folds, and a warning says where it is least. That is of
     * the points alone: vtkAnamorphDeformTransform::GetFold() proves that there is no fold anywhere. Sides of deformations count as
     * they are at the point. Texture coordinates are refused. Default: off.
     */
    vtkSetMacro(ComputeFolds, bool);
    vtkGetMacro(ComputeFolds, bool);
    vtkBooleanMacro(ComputeFolds, bool);
    ///@}

    ///@{
    /**
     * The least determinant of the last execution with ComputeFolds on this rank, and the point of the undeformed surface that has it; 1
     * and (0, 0, 0) where there are no points.
     */
    vtkGetMacro(LeastJacobian, double);
    vtkGetVector3Macro(LeastJacobianPoint, double);
    ///@}

    ///@{
    /**
     * Whether the second output has the overlay. Default: off.
     */
    vtkSetMacro(GenerateOverlay, bool);
    vtkGetMacro(GenerateOverlay, bool);
    vtkBooleanMacro(GenerateOverlay, bool);
    vtkPolyData* GetOverlay();
    ///@}

    ///@{
    /**
     * The type of points, normals and displacements: vtkAlgorithm::SINGLE_PRECISION, DOUBLE_PRECISION, or
     * DEFAULT_PRECISION: that of the input's points, and double for whole numbers. Default:
     * DEFAULT_PRECISION.
     */
    vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DEFAULT_PRECISION);
    vtkGetMacro(OutputPointsPrecision, int);
    ///@}

    ///@{
    /**
     * The controller by which all ranks find one automatic plane and each other's tables of deformations. Every
     * rank has to execute then. Default: the global controller; may be null.
     */
    void SetController(vtkMultiProcessController* controller);
    vtkMultiProcessController* GetController();
    ///@}

    ///@{
    /**
     * Numbers of the last execution: how far a component of the displacement can be from eq. (4.1) plus the
     * formula, in any data set of this rank; how many points were computed; and at how many the formula has no
     * value.
     */
    vtkGetMacro(ErrorBound, double);
    vtkGetMacro(NumberOfPointsComputed, vtkIdType);
    vtkGetMacro(NumberOfUndefinedPoints, vtkIdType);
    ///@}

    ///@{
    /**
     * For handles of hosts: how far from the plane of (u, v) the deformed surface is at the centre, and at the centre plus the extent,
     * of a deformation of the filter's own list, by the last execution; at the centre, of several points over each other, where the
     * deformation moves it most. 0 where no point is moved by it, and for texture coordinates. Selecting another
     * deformation does not make the filter execute. The pointer is valid until the next call.
     *
     * Where the controller has several ranks, this is what FindSelected() found last, and the anchor what FindAnchor() did, which all of
     * them call together: on the part of the rank that has the best.
     *
     * For texture coordinates the frame is the plane that touches the surface at the deformation's centre, moved to where the deformed
     * surface is: nine numbers, the point at (u, v) = (0, 0) of it, and how far space goes where u and where v goes 1, fitted to
     * the points that are nearest in (u, v). It is all 0 where there are none, and for the plane.
     */
    void SetSelectedDeformation(int position) { this->SelectedDeformation = position < 0 ? 0 : position; }
    int GetSelectedDeformation() { return this->SelectedDeformation; }
    void FindSelected();
    double* GetSelectedHeights() VTK_SIZEHINT(2);
    double* GetSelectedFrame() VTK_SIZEHINT(9);
    /**
     * What AnchorDeformation() would make of the selected deformation: center_w, extent_w, the orientation and V; all 0 where there is no
     * surface near it.
     */
    void FindAnchor();
    double* GetSelectedAnchor() VTK_SIZEHINT(9);
    /**
     * What AddDefaultDeformation() would add, as FindDefault() found it, which all ranks of the controller call together: the nine numbers of a
     * deformation, its depth (three), its orientation (four), and Subdivisions; all 0 where there are no points.
     */
    void FindDefault();
    double* GetDefaultDeformation() VTK_SIZEHINT(17) { return this->DefaultDeformation; }
    /**
     * What is at the point of the deformed surface of the last execution that is nearest to the one given to PickAt(): u, v, the depth w
     * from the plane (0 for texture coordinates), and 1; all 0 where there is no surface. PickOnLine() takes the point where a line
     * first meets the deformed surface, or none (not a number). All ranks of the controller call these two together, and find
     * the nearest of all their parts. Picking does not make the filter execute.
     */
    void PickAt(double x, double y, double z);
    void PickOnLine(double from_x, double from_y, double from_z, double to_x, double to_y, double to_z);
    vtkGetVector3Macro(PickedPoint, double);
    double* GetPickedParameters() VTK_SIZEHINT(4);
    ///@}

    vtkMTimeType GetMTime() override;

  protected:
    vtkAnamorphDeform();
    ~vtkAnamorphDeform() override;

    int FillInputPortInformation(int port, vtkInformation* info) override;
    int FillOutputPortInformation(int port, vtkInformation* info) override;
    int RequestDataObject(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    vtkTypeBool ProcessRequest(vtkInformation* request, vtkInformationVector** inputs,
                               vtkInformationVector* outputs) override;
    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestUpdateExtent(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphDeform(const vtkAnamorphDeform&) = delete;
    void operator=(const vtkAnamorphDeform&) = delete;

    void Execute(vtkInformationVector** inputs, vtkInformationVector* outputs);
    void SetText(std::string& member, const char* text);
    void NameDeformations();
    /// Finds numbers about the selected deformation, of lists on the plane or of those in texture coordinates, on the rank that has the best.
    template <std::size_t Count, class Search>
    void Find(double (&numbers)[Count], bool on_plane, const Search& search);
    void FindHeights();
    void FindFrame();
    void Pick(const std::array<double, 3>& at, std::optional<double> distance);

    vtkSmartPointer<vtkAnamorphDeformationList> DeformationList;
    vtkSmartPointer<vtkDoubleArray> AllDeformations, AllDepths, AllFrames;
    vtkSmartPointer<vtkStringArray> AllNames;
    std::vector<double> NameNumbers;  ///< by position, of TableNames
    std::vector<std::string> TableNames;
    vtkSmartPointer<vtkMultiProcessController> Controller;
    char* FileName = nullptr;
    std::string FormulaX, FormulaY, FormulaZ, FormulaDefinitions;
    double Frame = 0;
    int ParameterMode = PLANE;
    bool AutomaticPlane = true;
    double Origin[3] = {0, 0, 0}, Axis1[3] = {1, 0, 0}, Axis2[3] = {0, 1, 0};
    double UsedOrigin[3] = {0, 0, 0}, UsedAxis1[3] = {1, 0, 0}, UsedAxis2[3] = {0, 1, 0};
    double Cutoff = 1e-7;
    bool ComputeNormals = true, ComputeDisplacement = true, GenerateOverlay = false;
    int OutputPointsPrecision = DEFAULT_PRECISION;
    int SelectedDeformation = 0;
    double SelectedHeights[2] = {}, SelectedFrame[9] = {}, SelectedAnchor[9] = {};
    double DefaultDeformation[17] = {};
    int Subdivisions = 0;
    double PickedPoint[3] = {}, PickedParameters[4] = {};
    bool ComputeFolds = false;
    double LeastJacobian = 1, LeastJacobianPoint[3] = {};
    double ErrorBound = 0;
    vtkIdType NumberOfPointsComputed = 0, NumberOfUndefinedPoints = 0;

    struct Kept;
    struct Run;
    std::unique_ptr<Kept> Meshes;
};

#endif
