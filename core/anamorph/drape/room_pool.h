// SPDX-License-Identifier: Apache-2.0
// Room that is left by one view of a surface to the next.
#pragma once

#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace anamorph {

/// Rooms that are in no use. Thread safe.
template <class Room>
class RoomPool {
  public:
    /// As it was left, or a new one.
    std::unique_ptr<Room> take() {
        const std::lock_guard lock(m_mutex);
        if (m_free.empty()) return std::make_unique<Room>();
        std::unique_ptr<Room> room = std::move(m_free.back());
        m_free.pop_back();
        return room;
    }
    void give_back(std::unique_ptr<Room> room) {
        const std::lock_guard lock(m_mutex);
        m_free.push_back(std::move(room));
    }

  private:
    std::mutex m_mutex;
    std::vector<std::unique_ptr<Room>> m_free;
};

}  // namespace anamorph
