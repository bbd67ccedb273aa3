// SPDX-License-Identifier: Apache-2.0
/**
 * @class vtkAnamorphSplatReader
 * @brief Gaussian splats of .ply files as points with the axes and turns of ellipsoids
 *
 * Reads files as programs of 3D Gaussian splatting write them (Kerbl et al. 2023): little-endian PLY whose vertices have x, y, z, scale_0 to scale_2,
 * the logarithms of the standard deviations, rot_0 to rot_3, a quaternion w, x, y, z of any length, f_dc_0 to f_dc_2, the
 * constant spherical harmonic of the color, and opacity, of which the logistic function is taken. Of these, color and opacity may be missing.
 *
 * Output: vertices with the point arrays Axes (the standard deviations, float), Orientation (a unit quaternion, float) and Color (unsigned char,
 * red, green, blue and opacity, the scalars), as vtkAnamorphEllipsoidMapper draws them; its ScaleFactor says how many deviations
 * large. Colors of other directions (f_rest_0 and so on) and all other properties are left out. Points are float, as in the file.
 */
#ifndef vtkAnamorphSplatReader_h
#define vtkAnamorphSplatReader_h

#include "AnamorphFiltersModule.h"  // for the export macro
#include "vtkPolyDataAlgorithm.h"

class ANAMORPHFILTERS_EXPORT vtkAnamorphSplatReader : public vtkPolyDataAlgorithm {
  public:
    static vtkAnamorphSplatReader* New();
    vtkTypeMacro(vtkAnamorphSplatReader, vtkPolyDataAlgorithm);
    void PrintSelf(ostream& os, vtkIndent indent) override;

    ///@{
    /** The file. Default: none. */
    vtkSetStringMacro(FileName);
    vtkGetStringMacro(FileName);
    ///@}

    /** Whether a file is one of splats: 1 or 0, by its head. */
    int CanReadFile(const char* name);

  protected:
    vtkAnamorphSplatReader();
    ~vtkAnamorphSplatReader() override;

    int RequestData(vtkInformation*, vtkInformationVector**, vtkInformationVector* outputs) override;

  private:
    vtkAnamorphSplatReader(const vtkAnamorphSplatReader&) = delete;
    void operator=(const vtkAnamorphSplatReader&) = delete;

    char* FileName = nullptr;
};

#endif
