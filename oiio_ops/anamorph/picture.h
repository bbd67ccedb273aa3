// SPDX-License-Identifier: Apache-2.0
// A reprojection with its source, in the working colour space that was asked for.
#pragma once

#include <OpenImageIO/imageio.h>

#include <memory>
#include <string>

#include "anamorph/image/reproject_parameters.h"
#include "anamorph/image_source.h"

namespace anamorph {

/// The colour space to filter in that was asked for; empty where no colour is drawn.
std::string filtering_space(const ParameterValues& values, const ReprojectRequest& request);

/// What stands between a file and the resampler: the image, its working space, its pyramid. Reading is thread
/// safe.
class SourceStack {
  public:
    /// `colorspace` may be empty. Throws Error.
    SourceStack(std::unique_ptr<Source> image, const OIIO::ImageSpec& spec, const ReprojectRequest& request,
                const std::string& colorspace);
    ~SourceStack();

    const Source& top() const { return *m_top; }
    const WorkingSpace* space() const { return m_space.get(); }
    /// What the last failed read failed of.
    std::string error() const;

  private:
    std::unique_ptr<Source> m_image, m_working, m_pyramid;
    std::shared_ptr<const WorkingSpace> m_space;
    const Source* m_top;
};

/// Keeps references to both.
class Picture {
  public:
    Picture(const Reprojection& reprojection, const SourceStack& source)
        : m_reprojection(reprojection), m_source(source) {}

    int channels() const { return m_reprojection.channels(m_source.top()); }
    /// Fills `view` with the pixels of `box`, in the source's own colour space. Throws Error when the source
    /// cannot be read.
    void draw(const Box& box, const ImageView& view, const ParallelFor& parallel_for) const;

  private:
    void draw_raw(const Box& box, const ImageView& view, const ParallelFor& parallel_for) const;

    const Reprojection& m_reprojection;
    const SourceStack& m_source;
};

}  // namespace anamorph
