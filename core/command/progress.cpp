// SPDX-License-Identifier: Apache-2.0
#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <utility>

namespace anamorph::command {
namespace {

constexpr auto kPatience = std::chrono::milliseconds(500), kPeriod = std::chrono::milliseconds(100);

/// "0:07", "12:30", "1:02:03"
std::string clock_text(double seconds) {
    const auto all = static_cast<long long>(std::ceil(seconds));
    const auto two = [](long long n) { return (n < 10 ? "0" : "") + std::to_string(n); };
    const long long hours = all / 3600, minutes = all / 60 % 60;
    return (hours > 0 ? std::to_string(hours) + ":" + two(minutes) : std::to_string(minutes)) + ":" +
           two(all % 60);
}

}  // namespace

Progress::Progress(std::function<long long()> total, std::string unit)
    : m_total_of(std::move(total)),
      m_unit(std::move(unit)),
      m_terminal(isatty(STDERR_FILENO) == 1),
      m_begin(Clock::now()),
      m_next(m_begin + kPatience) {}

Progress::~Progress() {
    clear();
}

void Progress::advance(long long done) {
    const std::lock_guard lock(m_mutex);
    m_done += done;
    const Clock::time_point now = Clock::now();
    if (!m_terminal || now < m_next) return;
    if (m_total < 0) m_total = m_total_of();
    std::string text;
    if (m_total > 0 && m_done <= m_total) {
        constexpr long long kWidth = 40;
        const auto full = static_cast<std::size_t>(kWidth * m_done / m_total);
        // What is left takes as long, each, as what is done did.
        const double seconds = std::chrono::duration<double>(now - m_begin).count();
        const double left = seconds / static_cast<double>(m_done) * static_cast<double>(m_total - m_done);
        text = "[" + std::string(full, '#') + std::string(kWidth - full, ' ') + "] " +
               std::to_string(m_done) + " of " + std::to_string(m_total) + " " + m_unit + ", " +
               clock_text(left) + " left";
    } else {
        text = std::to_string(m_done) + " " + m_unit;
    }
    std::cerr << "\r\033[K" << text << std::flush;
    m_shown = true;
    m_next = now + kPeriod;
}

void Progress::clear() {
    const std::lock_guard lock(m_mutex);
    if (m_shown) std::cerr << "\r\033[K" << std::flush;
    m_shown = false;
}

}  // namespace anamorph::command
