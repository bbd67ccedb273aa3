// SPDX-License-Identifier: Apache-2.0
#include "frame_range.h"

#include <algorithm>
#include <charconv>
#include <filesystem>

namespace anamorph::command {
using namespace figure;
namespace {

/// Takes a whole number from the beginning of a text.
std::optional<int> take_number(std::string_view& text) {
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || number < 0) return std::nullopt;
    text.remove_prefix(static_cast<std::size_t>(end - text.data()));
    return number;
}

bool take(std::string_view& text, char c) {
    if (text.empty() || text.front() != c) return false;
    text.remove_prefix(1);
    return true;
}

std::string padded(int number, std::size_t width) {
    const std::string digits = std::to_string(number);
    return std::string(width > digits.size() ? width - digits.size() : 0, '0') + digits;
}

}  // namespace

std::optional<FrameRange> parse_frame_range(std::string_view text) {
    if (text == "all") return FrameRange{true};
    const auto first = take_number(text);
    if (!first) return std::nullopt;
    FrameRange range{false, *first, *first, 1};
    if (take(text, '-')) {
        const auto last = take_number(text);
        if (!last || *last < *first) return std::nullopt;
        range.last = *last;
        if (take(text, 'x')) {
            const auto step = take_number(text);
            if (!step || *step < 1) return std::nullopt;
            range.step = *step;
        }
    }
    return text.empty() ? std::optional(range) : std::nullopt;
}

int FrameRange::count(Motion& motion) const {
    return all ? motion.frame_count() : (last - first) / step + 1;
}

void FrameRange::for_each(Motion& motion, const std::function<void(const FigureFrame&)>& body) const {
    if (all) {
        motion.for_each_frame([&](const FigureFrame& frame) {
            body(frame);
            return true;
        });
        return;
    }
    for (long long f = first; f <= last; f += step) body(motion.frame(static_cast<int>(f)));
}

std::string numbered_name(const std::string& pattern, int number) {
    constexpr std::size_t kDigits = 4;
    if (const std::size_t word = pattern.find(kFrameWord); word != std::string::npos)
        return pattern.substr(0, word) + padded(number, kDigits) + pattern.substr(word + kFrameWord.size());
    const std::size_t hash = pattern.find('#');
    if (hash != std::string::npos) {
        const std::size_t end = std::min(pattern.find_first_not_of('#', hash), pattern.size());
        return pattern.substr(0, hash) + padded(number, end - hash) + pattern.substr(end);
    }
    const std::size_t percent = pattern.find('%');
    if (percent != std::string::npos) {
        const std::size_t end = pattern.find_first_not_of("0123456789", percent + 1);
        if (end != std::string::npos && pattern[end] == 'd' && end - percent < 4) {
            const std::string width = pattern.substr(percent + 1, end - percent - 1);
            return pattern.substr(0, percent) + padded(number, width.empty() ? 0 : std::stoul(width)) +
                   pattern.substr(end + 1);
        }
    }
    const std::filesystem::path path(pattern);
    return (path.parent_path() / path.stem()).string() + "." + padded(number, kDigits) +
           path.extension().string();
}

}  // namespace anamorph::command
