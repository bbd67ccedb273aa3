// SPDX-License-Identifier: Apache-2.0
#include "anamorph/parameter/suggestion.h"

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <string_view>
#include <utility>

namespace anamorph {
namespace {

/// How many letters have to be put in, taken out, replaced or swapped with the next to make one word of another (Damerau and Levenshtein,
/// no letter twice).
std::size_t edits(std::string_view from, std::string_view to) {
    // Of beginnings of `from`, one letter longer each, to all beginnings of `to`.
    std::vector<std::size_t> before, above, row(to.size() + 1);
    std::iota(row.begin(), row.end(), std::size_t{0});
    for (std::size_t i = 1; i <= from.size(); ++i) {
        before = std::exchange(above, row);
        row[0] = i;
        for (std::size_t j = 1; j <= to.size(); ++j) {
            row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (from[i - 1] != to[j - 1])});
            if (i > 1 && j > 1 && from[i - 1] == to[j - 2] && from[i - 2] == to[j - 1])
                row[j] = std::min(row[j], before[j - 2] + 1);
        }
    }
    return row.back();
}

}  // namespace

std::string perhaps(const std::string& word, const std::vector<std::string>& words) {
    constexpr std::size_t kLongest = 64;
    if (word.size() > kLongest) return {};
    const std::string* best = nullptr;
    std::size_t fewest = word.size() / 3 + 1;
    for (const std::string& other : words)
        if (const std::size_t count = edits(word, other); count < fewest) fewest = count, best = &other;
    return best ? ", perhaps " + *best + " is meant" : "";
}

}  // namespace anamorph
