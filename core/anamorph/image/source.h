// SPDX-License-Identifier: Apache-2.0
// The sources of a resampler's texels: an image in memory, a file behind a cache, a pyramid over either.
#pragma once

#include "anamorph/geometry/size.h"
#include "anamorph/image/view.h"

namespace anamorph {

inline constexpr int kMaxSide = 1 << 20;  ///< the largest width and height of a picture, in pixels

class SummedAreas;

/// The texels of a picture of size `to` that have some of a box of the same picture of size `from`.
Box texels_over(const Box& box, const Size& from, const Size& to) noexcept;
Box texels_within(const Box& box, const Size& from,
                  const Size& to) noexcept;  ///< those that have nothing else

/// One resolution of a source: the size of its picture, and the texels that there are.
struct SourceLevel {
    Size size;
    /// The picture's texels, (0, 0) to (width - 1, height - 1), and those that stand for themselves beyond its edges.
    Box extent;
    /// Those of them of which no part is missing: on a coarser level the outermost ones may be faded.
    Box whole;

    SourceLevel(const Size& picture, const Box& all, const Box& unfaded)
        : size(picture), extent(all), whole(unfaded) {}  ///< some of whose texels may be faded
    SourceLevel(const Size& picture, const Box& all) : SourceLevel(picture, all, all) {}  ///< all whole
    /// A level of which nothing stands beyond the edges.
    SourceLevel(const Size& picture) : SourceLevel(picture, {0, 0, picture.width, picture.height}) {}
};

/// The pixels of one image at one or more resolutions, level 0 the finest. Reading is thread safe.
class Source {
  public:
    virtual ~Source() = default;

    virtual PixelType type() const noexcept = 0;
    virtual int channels() const noexcept = 0;
    /// The channel by which colour is to be weighted while filtering (alpha that is not yet multiplied in); -1 where
    /// all channels are to be filtered as they are.
    virtual int unassociated_alpha() const noexcept { return -1; }
    virtual int levels() const noexcept = 0;
    /// The size of a level.
    virtual Size size(int level) const noexcept = 0;
    /// The texels of a level that can be read: those of the picture, and of an image that has pixels beyond its edges
    /// (overscan: a data window larger than the display window) the smallest rectangle around both. Texels of it that the
    /// image lacks are 0.
    virtual Box extent(int level) const noexcept { return SourceLevel(size(level)).extent; }
    /// The texels of level 0 that the image has itself (its data window): a rectangle inside the extent, which may be smaller
    /// than the picture or lie beyond its edges.
    virtual Box data_window() const noexcept { return extent(0); }
    /// A level's size, and its texels.
    SourceLevel level(int level) const noexcept;

    /// Copies the texels of `box`, which lies inside the level's extent, to `texels`: packed pixels of type(), rows
    /// `row_stride` bytes apart. False where they cannot be read; the source keeps the reason for its owner.
    virtual bool read(int level, const Box& box, std::byte* texels,
                      std::ptrdiff_t row_stride) const noexcept = 0;

    /// The pixels of a level where they stand in memory as a whole and none stand beyond its edges, else null. Only
    /// boxes that prepare() was called for are certain to hold their texels.
    virtual const ConstImageView* view(int level) const noexcept {
        static_cast<void>(level);
        return nullptr;
    }

    /// Makes the texels of `box`, which lies inside the level, ready to be read through view(level). False
    /// where they cannot be read.
    virtual bool prepare(int level, const Box& box) const noexcept {
        static_cast<void>(level), static_cast<void>(box);
        return true;
    }

    /// The summed-area tables of a level, made when they are first asked for and kept. Null where the source has none, or where
    /// they could not be made.
    virtual const SummedAreas* summed_areas(int level) const noexcept {
        static_cast<void>(level);
        return nullptr;
    }
};

/// An image in memory, not owned.
class MemorySource final : public Source {
  public:
    /// `unassociated_alpha`: the result of Source::unassociated_alpha().
    explicit MemorySource(const ConstImageView& image, int unassociated_alpha = -1)
        : m_image(image), m_alpha(unassociated_alpha) {}
    PixelType type() const noexcept override { return m_image.type; }
    int channels() const noexcept override { return m_image.channels; }
    int unassociated_alpha() const noexcept override { return m_alpha; }
    int levels() const noexcept override { return 1; }
    Size size(int) const noexcept override { return {m_image.width, m_image.height}; }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;
    const ConstImageView* view(int) const noexcept override { return &m_image; }

  private:
    ConstImageView m_image;
    int m_alpha;
};

}  // namespace anamorph
