// SPDX-License-Identifier: Apache-2.0
// Coarser and coarser copies of an image, made where and when they are read.
#pragma once

#include <array>
#include <memory>
#include <mutex>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/image/source.h"

namespace anamorph {

/// The texels of a finer level that one texel of a coarser one averages, along one axis: 2 to 4, and how much each counts.
struct TexelSpan {
    int first, count;
    std::array<float, 4> weight;
};
/// Texel `i` of a level with `coarse` texels, made of one with `fine`.
TexelSpan span_of_texel(int i, int fine, int coarse) noexcept;

/// A source with levels: the base's own if it has more than one, else each level is half of the one before
/// (floor(w / 2) x floor(h / 2) texels), its texel i the average of [i r, (i + 1) r) with r
/// the ratio of the sizes. Levels have the base's pixel type, rounded to nearest even, so that a level of
/// uint8 adds a third of a step (standard deviation) at most; unassociated alpha weighs colour while
/// averaging, and is as unassociated in the result. Where the base goes on beyond the edges of its picture, so do
/// the levels; what their outermost texels have beyond the base's is 0.
///
/// Levels are made in tiles when first read, kTile texels wide and as high as kTile rows of the base, or kLeastTileHeight: a file that has
/// to be decoded row by row is, up to the last row that counts. Memory is used for tiles that were read. Any order of
/// reading and any number of threads give the same bits.
class Pyramid final : public Source {
  public:
    static constexpr int kTile = 128;
    static constexpr int kLeastTileHeight = 4;
    /// The smallest width and height, in texels, of a level but the base, or of its pieces.
    static constexpr int kLeast = 4;

    /// An image of `columns` x `rows` pieces that must not mix (the faces of a cube) has levels only as long as the
    /// sizes of the pieces are even. The base is kept by reference. Throws std::bad_alloc.
    explicit Pyramid(const Source& base, int columns = 1, int rows = 1);
    ~Pyramid() override;
    Pyramid(const Pyramid&) = delete;
    Pyramid& operator=(const Pyramid&) = delete;

    PixelType type() const noexcept override { return m_base.type(); }
    int channels() const noexcept override { return m_base.channels(); }
    int unassociated_alpha() const noexcept override { return m_base.unassociated_alpha(); }
    int levels() const noexcept override { return m_base.levels() + static_cast<int>(m_made.size()); }
    Size size(int level) const noexcept override;
    Box extent(int level) const noexcept override;
    Box data_window() const noexcept override { return m_base.data_window(); }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;
    const ConstImageView* view(int level) const noexcept override;
    bool prepare(int level, const Box& box) const noexcept override;
    const SummedAreas* summed_areas(int level) const noexcept override;

  private:
    struct Level;

    bool made(int level) const noexcept { return level >= m_base.levels(); }
    const Level& at(int level) const noexcept {
        return *m_made[static_cast<std::size_t>(level - m_base.levels())];
    }
    bool make_tile(int level, const Box& tile) const;

    const Source& m_base;
    std::vector<std::unique_ptr<Level>> m_made;
    mutable std::mutex m_summing;
    mutable std::vector<std::unique_ptr<const SummedAreas>>
        m_sums;  ///< of each level, where they were asked for
};

}  // namespace anamorph
