// SPDX-License-Identifier: Apache-2.0
#include "drawn_image.h"

#include <cstddef>
#include <deque>
#include <variant>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/operation/operation.h"
#include "attribute_fields.h"
#include "execution.h"
#include "vtkAlgorithm.h"
#include "vtkDataArray.h"
#include "vtkFieldData.h"
#include "vtkImageData.h"
#include "vtkInformation.h"
#include "vtkInformationVector.h"
#include "vtkPointData.h"
#include "vtkStreamingDemandDrivenPipeline.h"

namespace anamorph_vtk {
namespace {

using Executive = vtkStreamingDemandDrivenPipeline;

/// A texture with its levels.
struct Levels {
    explicit Levels(const ImageTexture& texture)
        : base(texture.view(), alpha_of(texture.view().channels)), all(base) {}
    anamorph::MemorySource base;
    anamorph::Pyramid all;
};

}  // namespace

anamorph::Filter filter_of(int interpolation) {
    using anamorph::Filter;
    constexpr Filter kFilters[] = {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::antialias};
    return kFilters[interpolation];
}

void ask_for_all(std::span<vtkInformationVector* const> inputs) {
    for (vtkInformationVector* const port : inputs) {
        vtkInformation* info = port->GetInformationObject(0);
        if (!info) continue;
        if (info->Has(Executive::WHOLE_EXTENT()))
            info->Set(Executive::UPDATE_EXTENT(), info->Get(Executive::WHOLE_EXTENT()), 6);
        info->Set(Executive::UPDATE_PIECE_NUMBER(), 0);
        info->Set(Executive::UPDATE_NUMBER_OF_PIECES(), 1);
        info->Set(Executive::UPDATE_NUMBER_OF_GHOST_LEVELS(), 0);
    }
}

double draw_image(vtkAlgorithm* filter, const anamorph::SolvedPicture& picture,
                  std::span<const ImageTexture* const> textures, vtkImageData* image, vtkDataArray* like,
                  const int* extent, vtkImageData* output) {
    const int* whole = image->GetExtent();
    output->CopyStructure(image);
    output->SetExtent(extent[0], extent[1], extent[2], extent[3], whole[4], whole[5]);
    output->GetFieldData()->PassData(image->GetFieldData());
    const anamorph::ConstImageView& first = textures[0]->view();
    const auto array =
        vtkSmartPointer<vtkDataArray>::Take(vtkDataArray::CreateDataArray(textures[0]->type()));
    array->SetName(like->GetName());
    array->SetNumberOfComponents(first.channels);
    for (int c = 0; c < first.channels; ++c)
        if (const char* const component = like->GetComponentName(c)) array->SetComponentName(c, component);
    array->SetNumberOfTuples(output->GetNumberOfPoints());
    output->GetPointData()->SetScalars(array);

    Execution execution(filter);
    std::deque<Levels> levels;
    std::vector<const anamorph::Source*> sources;
    for (const ImageTexture* const texture : textures) sources.push_back(&levels.emplace_back(*texture).all);
    const anamorph::Box box{extent[0] - whole[0], whole[3] - extent[3], extent[1] + 1 - whole[0],
                            whole[3] + 1 - extent[2]};
    if (!picture.draw(sources, box,
                      turned_over(static_cast<std::byte*>(array->GetVoidPointer(0)), first.type, box.width(),
                                  box.height(), first.channels),
                      execution.stage(0.05, 0.95)))
        throw anamorph::Error("what is to be drawn cannot be read");
    double bound = 0;
    for (const anamorph::Attribute& attribute : picture.reached(execution.stage(0.95, 1))) {
        if (attribute.name.starts_with("anamorph:")) add_field(attribute, output);
        if (attribute.name == "anamorph:max_error") bound = std::get<double>(attribute.value);
    }
    return bound;
}

}  // namespace anamorph_vtk
