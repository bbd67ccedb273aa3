// SPDX-License-Identifier: Apache-2.0
/**
 * @class   vtkAnamorphFigureReader
 * @brief   Performs a script of NUDES: figures made of ellipsoids that move (Chapman 1986, section 2).
 *
 * The output has a point for each ellipsoid, at its centre, and a vertex there. Arrays of the points are Axes
 * (half the lengths), Orientation (a quaternion w, x, y, z, as vtkGlyph3DMapper takes it), Color, Texture
 * (the name of its picture, or nothing), TextureOffset (texels), Name and Figure. The field data has the
 * joints (JointBodies, JointPosition, JointName) and how the script is seen (ViewCenter, and ViewRotation,
 * whose rows point to the right, up, and away). vtkAnamorphFigureGeometry, vtkAnamorphFigureOutline and
 * vtkAnamorphFigureSkeleton make surfaces, outlines and sticks of it.
 *
 * Lengths are those of the script: a window of 1000 x 1000 units with the ground at y = 0. NUDES' space is
 * left-handed, x to the right, y up and z away from the observer. VTK's is not, so z is negated: a camera
 * that looks along -z, y up, sees what NUDES shows.
 *
 * Times are numbers of frames; TIME_STEPS has the frames that the script shows (TIME_RANGE alone, if they are
 * more than a million). Asked for another time, the last frame before it is the output. Any frame may be
 * asked for, in any order, and is the same to the bit. A script that shows no frame is the figures at rest,
 * without times.
 *
 * What a file says that is not drawn as it says, such as an atom whose U is not positive definite, is a warning.
 *
 * Motions (.bvh) and crystal structures (.cif) become ellipsoids in the same window, and frames that were
 * written (.3) are read back.
 *
 * The file is read again after Modified(). All is in the first piece; others are empty.
 */
#ifndef vtkAnamorphFigureReader_h
#define vtkAnamorphFigureReader_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkPolyDataAlgorithm.h"

#include <memory>  // for the performance
#include <string>  // for names of files
#include <vector>  // for the same

class ANAMORPHFILTERS_EXPORT vtkAnamorphFigureReader : public vtkPolyDataAlgorithm {
  public:
    static vtkAnamorphFigureReader* New();
    vtkTypeMacro(vtkAnamorphFigureReader, vtkPolyDataAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    /** The values of Dialect. */
    enum { CLASSIC, STRICT };

    ///@{
    /** The script, whose includes are looked for in its folder, or a motion: .bvh, .cif, .3. */
    void SetFileName(const char* name);
    const char* GetFileName() { return this->FileName.c_str(); }
    ///@}

    /** Returns 1 if the file is a motion, or a text that can be read as a script (with errors, if it declares
    * ellipsoids). */
    virtual int CanReadFile(const char* name);

    ///@{
    /**
     * How scripts are read. CLASSIC, the default: as the programs of 2003 ran them. STRICT: as the language is documented; more
     * faults are errors, limits of joints hold, `ground` ends grounded.
     */
    vtkSetClampMacro(Dialect, int, CLASSIC, STRICT);
    vtkGetMacro(Dialect, int);
    ///@}

    ///@{
    /** Libraries of figures, files that are included ahead of the script. */
    void SetNumberOfLibraries(int count);
    int GetNumberOfLibraries() { return static_cast<int>(this->Libraries.size()); }
    void SetLibrary(int index, const char* name);
    const char* GetLibrary(int index);
    void AddLibrary(const char* name);
    void ClearLibraries() { this->SetNumberOfLibraries(0); }
    ///@}

    ///@{
    /** Whether there is a line for each joint, between the two ellipsoids that it connects. Off by default.
     */
    vtkSetMacro(Joints, bool);
    vtkGetMacro(Joints, bool);
    vtkBooleanMacro(Joints, bool);
    ///@}

    ///@{
    /**
     * The probability with which the ellipsoids of a .cif hold their atoms, between 0 and 1, as of ORTEP; 0.5, the default, is what pictures of
     * structures have. Atoms whose file gives no displacement stay small spheres.
     */
    vtkSetMacro(Probability, double);
    vtkGetMacro(Probability, double);
    ///@}

    ///@{
    /** The precision of points: vtkAlgorithm::SINGLE_PRECISION or DOUBLE_PRECISION (the default). */
    vtkSetClampMacro(OutputPointsPrecision, int, SINGLE_PRECISION, DOUBLE_PRECISION);
    vtkGetMacro(OutputPointsPrecision, int);
    ///@}

  protected:
    vtkAnamorphFigureReader();
    ~vtkAnamorphFigureReader() override;

    int RequestInformation(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;
    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector*) override;

  private:
    vtkAnamorphFigureReader(const vtkAnamorphFigureReader&) = delete;
    void operator=(const vtkAnamorphFigureReader&) = delete;

    struct Play;
    void Prepare();

    std::string FileName;
    int Dialect = CLASSIC;
    std::vector<std::string> Libraries;
    bool Joints = false;
    int OutputPointsPrecision = DOUBLE_PRECISION;
    double Probability = 0.5;
    std::unique_ptr<Play> Current;  ///< the performance of the script as it was read last
};

#endif
