// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <mutex>
#include <string>

namespace anamorph::command {

/// A bar with the time that is left, on the standard error where that is a terminal, once work has taken half a second. Thread safe.
class Progress {
  public:
    /// `total` says how many of `unit` there are to do, or 0 where that is not known; it is asked when the bar is first shown.
    explicit Progress(std::function<long long()> total, std::string unit = "frames");
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void advance(long long done = 1);
    /// Makes way for a line of text.
    void clear();

  private:
    using Clock = std::chrono::steady_clock;

    std::mutex m_mutex;
    std::function<long long()> m_total_of;
    std::string m_unit;
    bool m_terminal, m_shown = false;
    long long m_done = 0, m_total = -1;
    Clock::time_point m_begin, m_next;
};

}  // namespace anamorph::command
