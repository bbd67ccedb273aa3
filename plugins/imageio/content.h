// SPDX-License-Identifier: Apache-2.0
// The content of an open input: the pixels of one or more subimages and MIP levels, whoever makes them.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>
#include <memory>
#include <optional>
#include <string>

#include "anamorph/chart/chart.h"
#include "anamorph/operation/operation.h"
#include "anamorph/source_stack.h"

namespace anamorph {

/// A picture that another recipe may join with its own, and what it is drawn from.
struct JoinSource {
    std::shared_ptr<const SolvedPicture> picture;
    Box shown;  ///< the display window, in pixels of the picture
    std::shared_ptr<const SourceStacks> stacks;
    /// The same as they are stored, where some of their channels are moved so; else null.
    std::shared_ptr<const SourceStacks> stored_stacks;
    std::string space;    ///< the color space that they are filtered in
    bool stored = false;  ///< are their pixels those that are stored, of any types?
    std::string key;      ///< where it is the same, the picture and its sources are
    std::string chain;    ///< "pano", or what was joined: "pano of lens"
    float tol = 0;        ///< that of all that was joined
};

/// The pixels and headers that an input shows. Thread safe.
class Content {
  public:
    virtual ~Content() = default;

    virtual int subimages() const { return 1; }
    virtual int levels(int subimage) const = 0;
    virtual const OIIO::ImageSpec& spec(int subimage, int level) const = 0;
    /// The same without what all of the picture has to be planned for (anamorph:max_error and others).
    virtual const OIIO::ImageSpec& header(int subimage, int level) const { return spec(subimage, level); }
    /// Reads the pixels of `box`, from the corner of the data window, packed, in the spec's format. The box
    /// may reach over the right and lower edge (0 there). Throws Error.
    virtual void read(int subimage, int level, const Box& box, std::byte* pixels) const = 0;
    /// Are there no tiles in what it is made of, and were none asked for? Programs that write it as it is had better be told of
    /// none.
    virtual bool prefers_scanlines() const { return false; }
    /// What another recipe may join a subimage with; nothing where it is no picture.
    virtual std::optional<JoinSource> join_source(int) const { return {}; }
};

}  // namespace anamorph
