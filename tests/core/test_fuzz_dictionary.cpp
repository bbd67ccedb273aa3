// SPDX-License-Identifier: Apache-2.0
// The fuzz targets' dictionary has every key and choice of every operation.
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "anamorph/operation/operation.h"

namespace anamorph::test_fuzz_dictionary {
namespace {

/// What stands between the marks of tests/fuzz/fuzz.dict.
std::string listed_words() {
    std::ifstream file(ANAMORPH_FUZZ_DICTIONARY);
    std::stringstream text;
    text << file.rdbuf();
    const std::string all = text.str(), begin = "# words of recipes: begin\n",
                      end = "# words of recipes: end\n";
    const std::size_t from = all.find(begin), to = all.find(end);
    if (from == std::string::npos || to == std::string::npos) return {};
    return all.substr(from + begin.size(), to - from - begin.size());
}

TEST(FuzzDictionary, HasTheWordsOfEveryOperation) {
    std::set<std::string> words;
    for (const Operation* operation : operations()) {
        words.insert("." + operation->name + "?");
        for (const Parameter& p : *operation->parameters) {
            words.insert(p.name + "=");
            words.insert(p.choices.begin(), p.choices.end());
        }
    }
    std::string lines;
    for (const std::string& word : words) lines += "\"" + word + "\"\n";
#ifdef ANAMORPH_TOYS
    EXPECT_NE(listed_words(), lines) << "the dictionary has no toys, and the test is to notice";
#else
    EXPECT_EQ(listed_words(), lines) << "tests/fuzz/fuzz.dict is to have between its marks:\n\n" << lines;
#endif
}

}  // namespace
}  // namespace anamorph::test_fuzz_dictionary
