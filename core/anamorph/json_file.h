// SPDX-License-Identifier: Apache-2.0
// Shared by the readers of JSON files.
#pragma once

#include <nlohmann/json.hpp>
#include <set>
#include <string>
#include <vector>

#include "anamorph/text_file.h"

namespace anamorph::text_file {

using Json = nlohmann::json;

/// The value that a file holds. Throws Error naming the file, and the key that stands twice in an object.
inline Json parse_json(std::string_view text, std::string_view file) {
    // A file that is nothing but brackets must not fill the memory.
    constexpr int kDepth = 8;
    // Of the objects that are open, the outermost first.
    std::vector<std::set<std::string>> keys;
    const auto check_keys = [&](Json::parse_event_t event, const Json& value) {
        if (event == Json::parse_event_t::object_start) keys.emplace_back();
        if (event == Json::parse_event_t::object_end) keys.pop_back();
        if (event == Json::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
            fail(file, "",
                 "\"" + excerpt(value.get<std::string>()) + "\" is given twice: must be given once");
    };
    try {
        return Json::parse(text, [&](int depth, Json::parse_event_t event, const Json& value) {
            if (depth > kDepth)
                fail(file, "", "brackets stand more than " + std::to_string(kDepth) + " deep");
            check_keys(event, value);
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
