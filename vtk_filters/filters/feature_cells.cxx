// SPDX-License-Identifier: Apache-2.0
#include "feature_cells.h"

#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/morph/features_file.h"
#include "image_texture.h"
#include "vtkCellArray.h"
#include "vtkIdList.h"
#include "vtkImageData.h"
#include "vtkNew.h"
#include "vtkPolyData.h"

namespace anamorph_vtk {
namespace {

using anamorph::Error;
using Vertices = std::vector<anamorph::Point<double>>;

constexpr const char* kNames[2] = {"first", "second"};

/// `name`: the line's and the image's.
Vertices vertices_of(vtkPolyData* lines, vtkIdType line, vtkImageData* image, const std::string& name) {
    vtkNew<vtkIdList> ids;
    lines->GetLines()->GetCellAtId(line, ids);
    const vtkIdType count = lines->GetNumberOfPoints();
    Vertices vertices;
    for (vtkIdType i = 0; i < ids->GetNumberOfIds(); ++i) {
        const vtkIdType id = ids->GetId(i);
        if (id < 0 || id >= count)
            throw Error(name + " goes through point " + std::to_string(id) + ": the points are " +
                        (count > 0 ? "0 to " + std::to_string(count - 1) : "none"));
        double at[3];
        lines->GetPoint(id, at);
        vertices.push_back(pixel_place(image, image->GetExtent(), at));
    }
    return vertices;
}

}  // namespace

std::shared_ptr<anamorph::Features> features_of(vtkPolyData* const lines[2], vtkImageData* const images[2]) {
    auto features = std::make_shared<anamorph::Features>(2);
    if (!lines[0] && !lines[1]) return features;
    for (int k = 0; k < 2; ++k)
        if (!lines[k])
            throw Error(std::string("the lines over the ") + kNames[k] +
                        " image are not given: must be as many as over the other");
    const vtkIdType count = lines[0]->GetNumberOfLines(), other = lines[1]->GetNumberOfLines();
    if (count != other)
        throw Error("there are " + std::to_string(count) + " lines over the first image and " +
                    std::to_string(other) + " over the second: must be as many");
    for (vtkIdType i = 0; i < count; ++i) {
        const std::string name = "line " + std::to_string(i + 1);
        std::vector<Vertices> vertices;
        for (int k = 0; k < 2; ++k)
            vertices.push_back(
                vertices_of(lines[k], i, images[k], name + " over the " + kNames[k] + " image"));
        if (vertices[0].size() != vertices[1].size())
            throw Error(name + " has " + std::to_string(vertices[0].size()) +
                        " points over the first image and " + std::to_string(vertices[1].size()) +
                        " over the second: must have as many");
        features->add_polyline(vertices, 1, name);
        anamorph::check_feature_count(*features, "the lines", name);
    }
    return features;
}

}  // namespace anamorph_vtk
