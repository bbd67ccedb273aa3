// SPDX-License-Identifier: Apache-2.0
// The last few values made, by key.
#pragma once

#include <cstddef>
#include <list>
#include <memory>
#include <mutex>
#include <string>

namespace anamorph {

/// Keeps values by their keys. Thread safe. Values live as long as someone uses them; the memo itself keeps
/// the last `capacity`.
template <class Value>
class Memo {
  public:
    explicit Memo(std::size_t capacity) : m_capacity(capacity) {}

    /// The value of `key`, made by make() -> shared_ptr<Value> if it is not among those kept.
    template <class Make>
    std::shared_ptr<Value> get(const std::string& key, const Make& make) {
        if (std::shared_ptr<Value> found = find(key)) return found;
        std::shared_ptr<Value> made = make();
        std::lock_guard lock(m_mutex);
        m_kept.push_front({key, made});
        if (m_kept.size() > m_capacity) m_kept.pop_back();
        return made;
    }

  private:
    struct Kept {
        std::string key;
        std::shared_ptr<Value> value;
    };

    std::shared_ptr<Value> find(const std::string& key) {
        std::lock_guard lock(m_mutex);
        for (auto i = m_kept.begin(); i != m_kept.end(); ++i)
            if (i->key == key) {
                m_kept.splice(m_kept.begin(), m_kept, i);
                return m_kept.front().value;
            }
        return nullptr;
    }

    const std::size_t m_capacity;
    std::mutex m_mutex;
    std::list<Kept> m_kept;
};

}  // namespace anamorph
