// SPDX-License-Identifier: Apache-2.0
// The picture of an operation over ImageBufs, opened once and drawn as often as one likes, any part of it.
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <memory>
#include <string>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/operation/operation.h"
#include "anamorph/parallel_for.h"
#include "anamorph/side_files.h"
#include "anamorph/source_stack.h"

namespace anamorph {

/// A picture of ImageBufs, which must outlive it. Thread safe once it is made.
class BufferPicture {
  public:
    /// A source: an image, or what another picture draws. Where that can be done the maps of both are joined, and its source is
    /// sampled once (chain/joined.h); else it is drawn first.
    struct SourceInput {
        const OIIO::ImageBuf* image = nullptr;
        std::shared_ptr<const BufferPicture> picture = {};
    };

    /// Opens a picture. `values` name side files, some of which may be in memory: their images must outlive the picture. `subimage`: of
    /// an operation that makes several pictures. `parallel_for`: for a source that is drawn first. Throws Error.
    BufferPicture(const Operation& operation, const ParameterValues& values,
                  const std::vector<SourceInput>& sources, const ParallelFor& parallel_for,
                  const MemoryFiles& in_memory = {}, int subimage = 0);

    /// The windows, channels, type and metadata of the whole picture, and what it says beforehand.
    const OIIO::ImageSpec& spec() const { return m_spec; }
    /// What the picture holds: colour, points or other numbers.
    PixelKind pixels() const { return m_request.pixels; }
    int subimages() const { return m_pictures->frames(); }
    /// What was reached over the whole picture: anamorph:max_error and so on.
    Attributes reached(const ParallelFor& parallel_for) const { return m_picture->reached(parallel_for); }
    /// What it says of itself before anything is drawn: the tolerance, lenses that were looked up, what a chain was joined of.
    const Attributes& said() const { return m_said; }
    /// The picture's maps; null where it is none of maps.
    const Picture* of_maps() const { return m_picture->of_maps(); }

    /// Fills a region of dst, whose display window is the picture's: dst has pixels in memory, and the region's channels are
    /// channels of both. Throws Error.
    void fill(OIIO::ImageBuf& dst, const OIIO::ROI& roi, const ParallelFor& parallel_for) const;

  private:
    /// Joins the picture with that of its first source. Returns the reason where it cannot be done.
    std::string join(const BufferPicture& inner);
    /// A picture as the image that is drawn of it, kept here.
    const OIIO::ImageBuf& drawn(const BufferPicture& inner, const ParallelFor& parallel_for);

    ParameterValues m_values;
    std::vector<SourceInput> m_sources;
    std::vector<std::unique_ptr<OIIO::ImageBuf>> m_drawn;
    std::unique_ptr<const Pictures> m_pictures;
    PictureRequest m_request;
    std::unique_ptr<const SolvedPicture> m_picture;
    std::string m_chain;    ///< "pano", or what was joined: "pano of lens"
    std::string m_space;    ///< the color space that sources are filtered in
    bool m_stored = false;  ///< are the pixels those of a source as it stores them?
    OIIO::ImageSpec m_spec;
    Attributes m_said;
    std::shared_ptr<const SourceStacks> m_stacks;
};

}  // namespace anamorph
