// SPDX-License-Identifier: Apache-2.0
// What building an operation throws, and the two callbacks through which a host lends threads.
#pragma once

#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>

namespace anamorph {

/// A parameter was given a value it cannot take. `what()` is one line: "fov=200: allowed is ...".
class Error : public std::runtime_error {
  public:
    Error(const std::string& parameter, const std::string& value, const std::string& allowed)
        : std::runtime_error(parameter + "=" + value + ": " + allowed), m_parameter(parameter) {}
    /// A failure that no single parameter caused.
    explicit Error(const std::string& message) : std::runtime_error(message) {}

    const std::string& parameter() const noexcept { return m_parameter; }

  private:
    std::string m_parameter;
};

/// Calls `body(i)` once for every i in [0, count), in any order, on any threads, and waits for all.
/// The core starts no thread of its own: a host passes its own pool here.
using ParallelFor = std::function<void(std::int64_t count, const std::function<void(std::int64_t)>& body)>;

/// The loop without threads.
inline void serial_for(std::int64_t count, const std::function<void(std::int64_t)>& body) {
    for (std::int64_t i = 0; i < count; ++i) body(i);
}

}  // namespace anamorph
