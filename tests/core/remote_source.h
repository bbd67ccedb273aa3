// SPDX-License-Identifier: Apache-2.0
// A source that is not at hand as a whole, for tests.
#pragma once

#include <gtest/gtest.h>

#include "anamorph/image/source.h"

namespace anamorph::test {

/// Hides that a source stands in memory, counts its reads, and fails on demand.
class Remote final : public Source {
  public:
    explicit Remote(const MemorySource& source) : m_source(source) {}
    PixelType type() const noexcept override { return m_source.type(); }
    int channels() const noexcept override { return m_source.channels(); }
    int unassociated_alpha() const noexcept override { return m_source.unassociated_alpha(); }
    int levels() const noexcept override { return 1; }
    Size size(int level) const noexcept override { return m_source.size(level); }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override {
        const Size all = m_source.size(level);
        EXPECT_FALSE(box.empty());
        EXPECT_TRUE(box.x0 >= 0 && box.y0 >= 0 && box.x1 <= all.width && box.y1 <= all.height);
        ++reads;
        return !fails && m_source.read(level, box, texels, row_stride);
    }

    mutable int reads = 0;
    bool fails = false;

  private:
    const MemorySource& m_source;
};

}  // namespace anamorph::test
