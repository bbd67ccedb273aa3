// SPDX-License-Identifier: Apache-2.0
// The looks of the blocks of composite data.
#pragma once

#include <array>
#include <map>
#include <optional>

class vtkCompositeDataDisplayAttributes;
class vtkDataObject;

namespace anamorph_vtk {

struct BlockLook {
    bool visible = true;
    std::optional<std::array<double, 3>> color;  ///< in place of the block's scalars and material
    double opacity = 1;

    bool is_plain() const { return visible && !color && opacity == 1; }
};

/// The looks of the leaves that are not plain: each has what is said of it, or of the nearest node that it is
/// in.
std::map<vtkDataObject*, BlockLook> block_looks(vtkDataObject* data,
                                                vtkCompositeDataDisplayAttributes* attributes);

}  // namespace anamorph_vtk
