// SPDX-License-Identifier: Apache-2.0
// The stages between images and a picture drawn from them: turned upright, in the working colour space that
// was asked for, in a pyramid.
#pragma once

#include <OpenImageIO/imageio.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/image_source.h"
#include "anamorph/operation/operation.h"
#include "anamorph/parallel_for.h"

namespace anamorph {

/// The colour space to filter in that was asked for; empty where no colour is drawn or none can be asked for.
std::string filtering_space(const ParameterValues& values, PixelKind pixels);

/// An image with all of these stages. Reading is thread safe.
class SourceStack {
  public:
    /// A function that makes the stage of an operation over those before it; null where it has none.
    using OverSource = std::function<std::unique_ptr<Source>(const Source&)>;
    /// Builds the stages. `spec`: that of the image as it is stored. `colorspace` may be empty. Throws Error.
    SourceStack(std::unique_ptr<Source> image, const OIIO::ImageSpec& spec, const SourceFaces& faces,
                const std::string& colorspace, const OverSource& over);
    ~SourceStack();

    const Source& top() const { return *m_top; }
    /// The stage that coarser levels are made of where the image has none.
    const Source& full() const { return *m_full; }
    /// Those levels made of another source, which has the sizes of full(). Keeps a reference.
    std::unique_ptr<Source> levels_over(const Source& source) const;
    /// The file that is read; null where there are several, or none.
    const CacheSource* file() const;
    const WorkingSpace* space() const { return m_space.get(); }
    /// The reason that the last failed read failed; empty where none did.
    std::string error() const;

  private:
    std::unique_ptr<Source> m_image, m_upright, m_working, m_over, m_pyramid;
    std::shared_ptr<const WorkingSpace> m_space;
    SourceFaces m_faces;
    const Source *m_full, *m_top;
};

/// The sources of pictures, as many as the operation takes, null where one is missing.
using SourceStacks = std::vector<std::unique_ptr<const SourceStack>>;
SourceStacks make_source_stacks(std::vector<std::unique_ptr<Source>> images,
                                const std::vector<OIIO::ImageSpec>& specs, const Pictures& pictures,
                                const std::string& colorspace);

/// Fills `view` with the pixels of `box`, in the first source's own colour space. Throws Error when a source
/// cannot be read.
void draw_picture(const SolvedPicture& picture, const SourceStacks& stacks, const Box& box,
                  const ImageView& view, const ParallelFor& parallel_for);

}  // namespace anamorph
