// SPDX-License-Identifier: Apache-2.0
// Shared by the readers of feature files: messages of one line, numbers, limits.
#pragma once

#include <charconv>
#include <string>
#include <string_view>

#include "anamorph/error.h"
#include "anamorph/map/features_file.h"

namespace anamorph::features_text {

/// Text from a file, fit for a message: no line breaks, not endless.
inline std::string excerpt(std::string_view text) {
    constexpr std::size_t kMost = 60;
    std::string out(text.substr(0, kMost));
    for (char& c : out)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = '?';
    return text.size() > kMost ? out + "..." : out;
}

[[noreturn]] inline void fail(std::string_view file, const std::string& entry, const std::string& what) {
    throw Error(excerpt(file) + ": " + (entry.empty() ? "" : entry + ": ") + what);
}

/// Runs `body`; what it throws gets the file and the entry in front.
template <class Body>
void in_entry(std::string_view file, const std::string& entry, const Body& body) {
    try {
        body();
    } catch (const Error& error) {
        fail(file, entry, error.what());
    }
}

inline void check_size(std::string_view text, std::string_view file) {
    if (text.size() > kMaxFeaturesText)
        fail(file, "", "allowed are files up to " + std::to_string(kMaxFeaturesText >> 20) + " MB");
}

inline void check_count(const Features& features, std::string_view file, const std::string& entry) {
    if (features.size() > kMaxFeatures)
        fail(file, entry, "allowed are up to " + std::to_string(kMaxFeatures) + " lines");
}

/// A decimal number at the front of `text`, which is shortened by it; false where there is none.
inline bool take_number(std::string_view& text, double& value) {
    const char* from = text.data();
    const char* end = from + text.size();
    if (from != end && *from == '+') ++from;
    const auto [to, error] = std::from_chars(from, end, value);
    if (error != std::errc()) return false;
    text.remove_prefix(static_cast<std::size_t>(to - text.data()));
    return true;
}

}  // namespace anamorph::features_text
