// SPDX-License-Identifier: Apache-2.0
// What a fuzz target allows: no crash, no hang, and nothing thrown but an Error of one line.
#pragma once

#include <cstdlib>
#include <iostream>
#include <string>

#include "anamorph/error.h"

namespace anamorph::fuzz {

/// May allocations fail? Where not, replay.cpp lets none fail.
inline bool memory_may_fail = true;
/// The number of bodies that ran to their ends.
inline long accepted = 0;

inline void require(bool holds, const char* what) {
    if (holds) return;
    std::cerr << "broken: " << what << "\n";
    std::abort();
}

/// Runs `body`; any exception but Error ends the program.
template <class Body>
void expect_no_failure_but_error(Body&& body) {
    try {
        body();
        ++accepted;
    } catch (const Error& error) {
        const std::string message = error.what();
        require(!message.empty(), "an error has a message");
        require(message.find_first_of("\r\n") == std::string::npos, "a message is one line");
    }
}

}  // namespace anamorph::fuzz
