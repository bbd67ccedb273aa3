// SPDX-License-Identifier: Apache-2.0
// The README's table of keys is the one that the parameter table makes.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "anamorph/image/reproject_parameters.h"

namespace {

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
    const std::size_t from = text.find(begin), to = text.find(end);
    if (from == std::string::npos || to == std::string::npos) return {};
    return text.substr(from + begin.size(), to - from - begin.size());
}

TEST(Readme, ListsTheKeys) {
    std::ifstream file(ANAMORPH_README);
    std::stringstream text;
    text << file.rdbuf();

    std::string page = anamorph::reference_page("", anamorph::reproject_parameters());
    page.erase(0, page.find('|'));
    EXPECT_EQ(between(text.str(), "<!-- keys: begin -->\n\n", "\n<!-- keys: end -->"), page)
        << "README.md is to have between its marks:\n\n"
        << page;
}

}  // namespace
