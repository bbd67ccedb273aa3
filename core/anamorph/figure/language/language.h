// SPDX-License-Identifier: Apache-2.0
// The language of figures, for people: every word with its operands, its meaning and an example that runs.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace anamorph::figure {

/// A word of the language.
struct LanguageWord {
    std::string word, operands, meaning;
    std::string example;  ///< a whole script
};

/// All words, in the order in which a shortened one is looked up.
std::vector<LanguageWord> language_words();

/// The list of all words, or all about one, which may be shortened. Throws Error where there is no such word.
std::string language_page(std::string_view word = {});

}  // namespace anamorph::figure
