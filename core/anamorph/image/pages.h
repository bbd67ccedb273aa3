// SPDX-License-Identifier: Apache-2.0
// Memory for pictures of which only parts may ever be needed.
#pragma once

#include <sys/mman.h>

#include <cstddef>
#include <cstdlib>
#include <new>

namespace anamorph {

/// Memory that reads as zeros and, where it is more than a few pages, takes room page by page, when written to. Throws std::bad_alloc.
class Pages {
  public:
    explicit Pages(std::size_t size) : m_size(size) {
        if (size <= kFew) {
            m_data = std::calloc(1, size);
            if (!m_data) throw std::bad_alloc();
            return;
        }
        m_data =
            ::mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
        if (m_data == MAP_FAILED) throw std::bad_alloc();
#ifdef MADV_HUGEPAGE
        // Huge pages are faster, but a tile's rows lie far apart, and in a large level each would take a page
        // of its own.
        ::madvise(m_data, size, size <= kHuge ? MADV_HUGEPAGE : MADV_NOHUGEPAGE);
#endif
    }
    ~Pages() {
        if (m_size <= kFew)
            std::free(m_data);
        else
            ::munmap(m_data, m_size);
    }
    Pages(const Pages&) = delete;
    Pages& operator=(const Pages&) = delete;

    std::byte* data() const {
        return static_cast<std::byte*>(m_data);
    }

  private:
    // The system takes longer to give and to take back a page than small pictures take to draw.
    static constexpr std::size_t kFew = std::size_t{1} << 16;
    static constexpr std::size_t kHuge = std::size_t{128} << 20;

    std::size_t m_size;
    void* m_data;
};

}  // namespace anamorph
