// SPDX-License-Identifier: Apache-2.0
// What building an operation throws.
#pragma once

#include <stdexcept>
#include <string>

namespace anamorph {

/// A parameter was given a value it cannot take. `what()` is one line: "fov=200: must be ...".
class Error : public std::runtime_error {
  public:
    /// Constructs the error of one parameter. `rule` says what the value must be: "must be a number from 0 to 8".
    Error(const std::string& parameter, const std::string& value, const std::string& rule)
        : std::runtime_error(parameter + "=" + value + ": " + rule), m_parameter(parameter) {}
    /// Constructs the error of a failure that no single parameter caused; parameter() is then empty.
    explicit Error(const std::string& message) : std::runtime_error(message) {}
    /// The error of a parameter that must be given. `rest` is what follows "fov is not given": ": must be a number".
    static Error not_given(const std::string& parameter, const std::string& rest) {
        Error error(parameter + " is not given" + rest);
        error.m_parameter = parameter;
        return error;
    }

    const std::string& parameter() const noexcept { return m_parameter; }

  private:
    std::string m_parameter;
};

}  // namespace anamorph
