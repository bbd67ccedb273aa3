// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <functional>
#include <string>

namespace anamorph::command {

/// A bar on the standard error, where that is a terminal, once work has taken half a second.
class Progress {
  public:
    /// `total` says how much there is to do, or 0 where that is not known; it is asked when the bar is
    /// first shown.
    explicit Progress(std::function<int()> total);
    ~Progress();
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    void advance();
    /// Makes way for a line of text.
    void clear();

  private:
    std::function<int()> m_total_of;
    bool m_terminal, m_shown = false;
    int m_done = 0, m_total = -1;
    std::chrono::steady_clock::time_point m_next;
};

}  // namespace anamorph::command
