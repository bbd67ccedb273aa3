// SPDX-License-Identifier: Apache-2.0
// Shared by the readers of JSON files.
#pragma once

#include <nlohmann/json.hpp>

#include "anamorph/text_file.h"

namespace anamorph::text_file {

using Json = nlohmann::json;

/// The value that a file holds. Throws Error naming the file.
inline Json parse_json(std::string_view text, std::string_view file) {
    // A file that is nothing but brackets must not fill the memory.
    constexpr int kDepth = 8;
    try {
        return Json::parse(text, [&](int depth, Json::parse_event_t, const Json&) {
            if (depth > kDepth)
                fail(file, "", "brackets stand more than " + std::to_string(kDepth) + " deep");
            return true;
        });
    } catch (const Json::exception& error) {
        // The reader's own prefix is left out.
        const std::string_view what = error.what();
        const std::size_t end = what.find("] ");
        fail(file, "", "is no JSON: " + excerpt(end == std::string_view::npos ? what : what.substr(end + 2)));
    }
}

}  // namespace anamorph::text_file
