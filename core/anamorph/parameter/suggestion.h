// SPDX-License-Identifier: Apache-2.0
// What may have been meant by a word that is none of those that are allowed.
#pragma once

#include <string>
#include <vector>

namespace anamorph {

/// For a message: ", perhaps NAME is meant", of that of the words which is nearest by the letters that have to be put in, taken out,
/// replaced or swapped with the next; empty where none is near, or the word is longer than 64 letters.
std::string perhaps(const std::string& word, const std::vector<std::string>& words);

}  // namespace anamorph
