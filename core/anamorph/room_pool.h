// SPDX-License-Identifier: Apache-2.0
// Room for work, left by one task to the next.
#pragma once

#include <memory>
#include <mutex>
#include <new>
#include <utility>
#include <vector>

namespace anamorph {

/// A pool of rooms that are in no use. Thread safe.
template <class Room>
class RoomPool {
  public:
    /// Takes a room as it was left, or the one that `make` makes.
    template <class Make>
    std::unique_ptr<Room> take(const Make& make) {
        {
            const std::lock_guard lock(m_mutex);
            if (!m_free.empty()) {
                std::unique_ptr<Room> room = std::move(m_free.back());
                m_free.pop_back();
                return room;
            }
        }
        return make();
    }
    std::unique_ptr<Room> take() {
        return take([] { return std::make_unique<Room>(); });
    }
    /// Gives a room back; where there is no memory to remember it by, it is freed.
    void give_back(std::unique_ptr<Room> room) noexcept try {
        const std::lock_guard lock(m_mutex);
        m_free.push_back(std::move(room));
    } catch (const std::bad_alloc&) {
    }

  private:
    std::mutex m_mutex;
    std::vector<std::unique_ptr<Room>> m_free;
};

}  // namespace anamorph
