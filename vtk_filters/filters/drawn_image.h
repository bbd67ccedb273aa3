// SPDX-License-Identifier: Apache-2.0
// Filters that draw an image of other images, of which any part may show any other.
#pragma once

#include <span>

#include "anamorph/image/filter.h"
#include "image_texture.h"

class vtkAlgorithm;
class vtkDataArray;
class vtkInformationVector;

namespace anamorph {
class SolvedPicture;
}

namespace anamorph_vtk {

/// What a property Interpolation of 0 to 3 means: nearest, linear, cubic, antialias.
anamorph::Filter filter_of(int interpolation);

/// Asks, in RequestUpdateExtent(), for all of each input (the inputs are those of each port), which is no piece as the pipeline would cut it
/// for one of several ranks.
void ask_for_all(std::span<vtkInformationVector* const> inputs);

/// Draws the pixels of an extent, which is not empty, of a picture of textures as an output like `image`, the first of them. Its scalars are of the type, and have
/// the names, of `like`, the first texture's array; its field arrays, beside those of `image`, say what was reached. Returns the proven bound. Throws Error.
double draw_image(vtkAlgorithm* filter, const anamorph::SolvedPicture& picture,
                  std::span<const ImageTexture* const> textures, vtkImageData* image, vtkDataArray* like,
                  const int* extent, vtkImageData* output);

}  // namespace anamorph_vtk
