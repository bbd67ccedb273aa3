// SPDX-License-Identifier: Apache-2.0
#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <iostream>

namespace anamorph::command {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(500), kPeriod = std::chrono::milliseconds(100);

}  // namespace

Progress::Progress(std::function<int()> total)
    : m_total_of(std::move(total)),
      m_terminal(isatty(STDERR_FILENO) == 1),
      m_next(std::chrono::steady_clock::now() + kPatience) {}

Progress::~Progress() {
    clear();
}

void Progress::advance() {
    ++m_done;
    if (!m_terminal || std::chrono::steady_clock::now() < m_next) return;
    if (m_total < 0) m_total = m_total_of();
    std::string bar;
    if (m_total > 0) {
        constexpr int width = 40;
        const auto full =
            static_cast<std::size_t>(static_cast<long long>(width) * std::min(m_done, m_total) / m_total);
        bar.append("[").append(full, '#').append(width - full, ' ').append("] of ");
        bar.append(std::to_string(m_total)).append(" ");
    }
    std::cerr << "\r" << bar << "frames: " << m_done << std::flush;
    m_shown = true;
    m_next = std::chrono::steady_clock::now() + kPeriod;
}

void Progress::clear() {
    if (m_shown) std::cerr << "\r\033[K" << std::flush;
    m_shown = false;
}

}  // namespace anamorph::command
