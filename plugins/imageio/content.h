// SPDX-License-Identifier: Apache-2.0
// The content of an open input: the pixels of one or more subimages and MIP levels, whoever makes them.
#pragma once

#include <OpenImageIO/imageio.h>

#include <cstddef>

#include "anamorph/chart/chart.h"

namespace anamorph {

/// The pixels and headers that an input shows. Thread safe.
class Content {
  public:
    virtual ~Content() = default;

    virtual int subimages() const { return 1; }
    virtual int levels(int subimage) const = 0;
    virtual const OIIO::ImageSpec& spec(int subimage, int level) const = 0;
    /// Reads the pixels of `box`, from the corner of the data window, packed, in the spec's format. The box
    /// may reach over the right and lower edge (0 there). Throws Error.
    virtual void read(int subimage, int level, const Box& box, std::byte* pixels) const = 0;
};

}  // namespace anamorph
