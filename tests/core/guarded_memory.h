// SPDX-License-Identifier: Apache-2.0
// Memory with forbidden pages before and behind it: what reads or writes past it ends the test.
#pragma once

#include <sys/mman.h>
#include <unistd.h>

#include <cstddef>
#include <new>

namespace anamorph::test {

class GuardedMemory {
  public:
    /// Reserves at least `size` bytes, whole pages.
    explicit GuardedMemory(std::size_t size = 1)
        : m_page(static_cast<std::size_t>(sysconf(_SC_PAGESIZE))),
          m_size((size + m_page - 1) / m_page * m_page) {
        void* pages =
            mmap(nullptr, m_size + 2 * m_page, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (pages == MAP_FAILED) throw std::bad_alloc();
        m_first = static_cast<std::byte*>(pages) + m_page;
        mprotect(m_first - m_page, m_page, PROT_NONE);
        mprotect(m_first + m_size, m_page, PROT_NONE);
    }
    ~GuardedMemory() { munmap(m_first - m_page, m_size + 2 * m_page); }
    GuardedMemory(const GuardedMemory&) = delete;
    GuardedMemory& operator=(const GuardedMemory&) = delete;

    std::byte* first() const { return m_first; }
    /// The last `size` bytes before the forbidden page.
    std::byte* last(std::size_t size) const { return m_first + m_size - size; }

  private:
    std::size_t m_page, m_size;
    std::byte* m_first = nullptr;
};

}  // namespace anamorph::test
