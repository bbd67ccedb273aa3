// SPDX-License-Identifier: Apache-2.0
#include "drape_inputs.h"

#include <algorithm>
#include <limits>
#include <memory>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/error.h"
#include "vtkDataArray.h"
#include "vtkDataSetAttributes.h"
#include "vtkImageData.h"
#include "vtkPoints.h"
#include "vtkStructuredGrid.h"
#include "vtkUnsignedCharArray.h"

namespace anamorph_vtk {
namespace {

using anamorph::Error;

bool is_floating(vtkDataArray* array) {
    return array->GetDataType() == VTK_FLOAT || array->GetDataType() == VTK_DOUBLE;
}

/// The sides of points that are one layer of rows, in any of the three planes.
anamorph::Size layer_of(vtkDataSet* data, const std::string& input) {
    int sides[3] = {0, 0, 0};
    if (auto* grid = vtkStructuredGrid::SafeDownCast(data))
        grid->GetDimensions(sides);
    else if (auto* image = vtkImageData::SafeDownCast(data))
        image->GetDimensions(sides);
    if (data->GetNumberOfPoints() < 1) throw Error("the input " + input + " has no points");
    if (std::count_if(sides, sides + 3, [](int side) { return side > 1; }) > 2)
        throw Error("the input " + input + " has several layers of points, but must have 1");
    // What has one point only is as well of the side before.
    const int width = sides[0] > 1 || sides[1] == 1 || sides[2] == 1 ? sides[0] : sides[1];
    return {width, static_cast<int>(data->GetNumberOfPoints() / width)};
}

}  // namespace

/// Gives the texels that stand in the map.
class DrapeInputs::Image final : public anamorph::SideImage {
  public:
    explicit Image(const Texels& texels) : m_texels(texels) {}
    anamorph::Size size() const override { return m_texels.size; }
    int channels() const override { return m_texels.channels; }
    std::vector<float> read(int count) override {
        const auto all = static_cast<std::size_t>(m_texels.channels), some = static_cast<std::size_t>(count);
        std::vector<float> first;
        first.reserve(m_texels.values.size() / all * some);
        for (std::size_t i = 0; i < m_texels.values.size(); i += all)
            for (std::size_t c = 0; c < some; ++c) first.push_back(m_texels.values[i + c]);
        return first;
    }

  private:
    const Texels& m_texels;
};

void DrapeInputs::put(const char* key, const char* input, vtkDataSet* data, vtkDataArray* array,
                      bool scaled) {
    const anamorph::Size size = layer_of(data, input);
    if (!array || array->GetNumberOfTuples() != data->GetNumberOfPoints())
        throw Error(std::string("the input ") + input + " has no point array of numbers");
    const double scale = scaled && !is_floating(array) ? array->GetDataTypeMax() : 1;
    // Points that are hidden are none.
    vtkUnsignedCharArray* ghosts = data->GetPointGhostArray();
    Texels texels{size, array->GetNumberOfComponents(), {}};
    texels.values.reserve(static_cast<std::size_t>(array->GetNumberOfValues()));
    for (int row = size.height - 1; row >= 0; --row)
        for (vtkIdType i = vtkIdType{row} * size.width; i < vtkIdType{row + 1} * size.width; ++i) {
            const bool hidden = ghosts && (ghosts->GetValue(i) & vtkDataSetAttributes::HIDDENPOINT) != 0;
            for (int c = 0; c < texels.channels; ++c)
                texels.values.push_back(hidden ? std::numeric_limits<float>::quiet_NaN()
                                               : static_cast<float>(array->GetComponent(i, c) / scale));
        }
    m_texels[key] = std::move(texels);
    m_files[key] = {array->GetName() ? array->GetName() : input, "", true};
}

void DrapeInputs::put_positions(vtkDataSet* data, vtkDataArray* array) {
    auto* grid = vtkStructuredGrid::SafeDownCast(data);
    if (grid) array = grid->GetPoints() ? grid->GetPoints()->GetData() : nullptr;
    if (array && !is_floating(array))
        throw Error(std::string("the positions are of type ") + array->GetDataTypeAsString() +
                    ", but must be of type float or double");
    this->put("positions", "Positions", data, array, false);
}

void DrapeInputs::put_heights(vtkDataSet* data, vtkDataArray* array) {
    this->put("height", "Height", data, array, true);
}

void DrapeInputs::put_deformations(const std::vector<Numbers>& list) {
    if (list.empty()) return;
    m_deformations = anamorph::entries_json(checked_entries(list));
    m_files["deform"] = {"deformations", "", false};
}

std::string DrapeInputs::text(const std::string&) const {
    return m_deformations;
}

std::unique_ptr<anamorph::SideImage> DrapeInputs::image(const std::string& key, const std::string&) const {
    return std::make_unique<Image>(m_texels.at(key));
}

}  // namespace anamorph_vtk
