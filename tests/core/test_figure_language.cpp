// SPDX-License-Identifier: Apache-2.0
// What people are told of the language: of every word, by examples that run in both dialects.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "anamorph/figure/language/language.h"
#include "anamorph/figure/language/script_table.h"
#include "figure_cases.h"

namespace anamorph::test_figure_language {
using namespace figure;
namespace {

using namespace figure_cases;
using testing::HasSubstr;

TEST(FigureLanguage, EveryWordHasAMeaningAndAnExampleThatRuns) {
    const std::vector<LanguageWord> words = language_words();
    std::size_t alive = 0;
    for (const script_table::Entry& entry : script_table::entries())
        alive += entry.keyword != script_table::Keyword::dead;
    EXPECT_EQ(words.size(), alive);
    for (const LanguageWord& word : words) {
        SCOPED_TRACE(word.word);
        EXPECT_FALSE(word.meaning.empty());
        const auto begins = [&](const std::string& text) {
            return text.find(word.word + " ") != std::string::npos;
        };
        const bool nothing_to_show =
            word.word == "opacty" || word.word == "lghtng" || word.word == "include" || word.word == "stop";
        EXPECT_TRUE(nothing_to_show || begins(word.example));
        for (const Dialect dialect : {Dialect::classic, Dialect::strict}) {
            Performance performance(program_of(word.example, dialect));
            EXPECT_GE(all_frames(performance).size(), 1u);
        }
    }
}

TEST(FigureLanguage, PagesNameWords) {
    const std::string all = language_page();
    for (const LanguageWord& word : language_words())
        EXPECT_THAT("\n" + all, HasSubstr("\n" + word.word)) << word.word;
    EXPECT_THAT(language_page("bendby"), HasSubstr("bendby ellipsoid joint ellipsoid angle axis"));
    EXPECT_EQ(language_page("bendb"), language_page("bendby"));
    EXPECT_THAT(error_of([] { language_page("fly"); }), HasSubstr("\"fly\" is not a word of the language"));
}

}  // namespace
}  // namespace anamorph::test_figure_language
