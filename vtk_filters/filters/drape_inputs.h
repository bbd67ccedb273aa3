// SPDX-License-Identifier: Apache-2.0
// The side files of the operation drape, of what vtkAnamorphDrape has on its inputs.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "anamorph/operation/side_files.h"
#include "deformation_numbers.h"

class vtkDataArray;
class vtkDataSet;

namespace anamorph_vtk {

/// Side files made of inputs. Each put_...() takes what is there now, and throws Error.
class DrapeInputs final : public anamorph::SideFileReader {
  public:
    /// Takes the points of a vtkStructuredGrid, or an array of a vtkImageData.
    void put_positions(vtkDataSet* data, vtkDataArray* array);
    /// Takes an array of a vtkImageData: floating point as it is, whole numbers as fractions of the largest
    /// of their type.
    void put_heights(vtkDataSet* data, vtkDataArray* array);
    /// Takes a list of deformations; without entries there is no such file.
    void put_deformations(const std::vector<Numbers>& list);

    const anamorph::SideFiles& files() const { return m_files; }
    std::string text(const std::string& name) const override;
    std::unique_ptr<anamorph::SideImage> image(const std::string& key,
                                               const std::string& name) const override;

  private:
    /// Texels in rows that go down.
    struct Texels {
        anamorph::Size size;
        int channels;
        std::vector<float> values;
    };
    class Image;

    void put(const char* key, const char* input, vtkDataSet* data, vtkDataArray* array, bool scaled);

    anamorph::SideFiles m_files;
    std::map<std::string, Texels> m_texels;  ///< images by key
    std::string m_deformations;
};

}  // namespace anamorph_vtk
