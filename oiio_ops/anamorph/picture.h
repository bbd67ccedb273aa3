// SPDX-License-Identifier: Apache-2.0
// A picture with its sources, in the working colour space that was asked for.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>
#include <vector>

#include "anamorph/image_source.h"
#include "anamorph/operation.h"
#include "anamorph/parallel_for.h"

namespace anamorph {

/// The colour space to filter in that was asked for; empty where no colour is drawn.
std::string filtering_space(const ParameterValues& values, PixelKind pixels);

/// What stands between a file and the resampler: the image, turned upright, its working space, its pyramid.
/// Reading is thread safe.
class SourceStack {
  public:
    /// `spec`: of the image as it is stored. `colorspace` may be empty. Throws Error.
    SourceStack(std::unique_ptr<Source> image, const OIIO::ImageSpec& spec, const Operation::Faces& faces,
                const std::string& colorspace);
    ~SourceStack();

    const Source& top() const { return *m_top; }
    const WorkingSpace* space() const { return m_space.get(); }
    /// What the last failed read failed of; empty where none did.
    std::string error() const;

  private:
    std::unique_ptr<Source> m_image, m_upright, m_working, m_pyramid;
    std::shared_ptr<const WorkingSpace> m_space;
    const Source* m_top;
};

/// The sources of a picture, as many as the operation takes.
using SourceStacks = std::vector<std::unique_ptr<const SourceStack>>;
SourceStacks make_source_stacks(std::vector<std::unique_ptr<Source>> images,
                                const std::vector<OIIO::ImageSpec>& specs, const Operation::Faces& faces,
                                const std::string& colorspace);

/// Keeps references to both.
class Picture {
  public:
    Picture(const Drawing& drawing, const SourceStacks& sources);

    /// Fills `view` with the pixels of `box`, in the first source's own colour space. Throws Error when a
    /// source cannot be read.
    void draw(const Box& box, const ImageView& view, const ParallelFor& parallel_for) const;

  private:
    void draw_raw(const Box& box, const ImageView& view, const ParallelFor& parallel_for) const;

    const Drawing& m_drawing;
    const SourceStacks& m_sources;
    std::vector<const Source*> m_tops;
};

}  // namespace anamorph
