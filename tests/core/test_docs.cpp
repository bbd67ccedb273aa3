// SPDX-License-Identifier: Apache-2.0
// The tables of keys in docs/ are those that the parameter tables make.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "anamorph/mesh/mesh_file.h"
#include "anamorph/morph/features_file.h"
#include "anamorph/operation/operation.h"
#include "anamorph/projector/tour_file.h"

namespace anamorph::test_docs {
namespace {

std::string between(const std::string& text, const std::string& begin, const std::string& end) {
    const std::size_t from = text.find(begin), to = text.find(end);
    if (from == std::string::npos || to == std::string::npos) return {};
    return text.substr(from + begin.size(), to - from - begin.size());
}

std::string page_of(const std::string& name) {
    std::ifstream file(ANAMORPH_DOCS "/" + name + ".md");
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

void expect_listed(const std::string& recipe, const anamorph::ParameterTable& table) {
    std::string page = anamorph::reference_page("", table);
    page.erase(0, page.find('|'));
    const std::string listed = between(page_of(recipe), "<!-- keys of " + recipe + ": begin -->\n\n",
                                       "\n<!-- keys of " + recipe + ": end -->");
#ifdef ANAMORPH_TOYS
    if (recipe == "toy" || recipe == "pano" || recipe == "mosaic" || recipe == "drape") {
        EXPECT_NE(listed, page) << "the pages have no toys, and the test is to notice";
        return;
    }
#endif
    EXPECT_EQ(listed, page) << "docs/" << recipe << ".md is to have between its marks:\n\n" << page;
}

TEST(Docs, ListsTheKeys) {
    for (const anamorph::Operation* operation : anamorph::operations())
        expect_listed(operation->name, *operation->parameters);
}

TEST(Docs, ItsFilesCanBeRead) {
    const auto block_with = [&](const std::string& key, const std::string& page) {
        const std::string text = page_of(page);
        const std::size_t inside = text.find("      \"" + key + "\"");
        const std::size_t begin = text.rfind("\n    {\n", inside), end = text.find("\n    }\n", inside);
        return text.substr(begin, end + 7 - begin);
    };
    const anamorph::WarpMap mesh = anamorph::parse_mesh_json(block_with("columns", "warp"), "docs");
    EXPECT_EQ(std::get<anamorph::ControlMesh>(mesh.shape).columns, 2);
    EXPECT_EQ(std::get<anamorph::ControlMesh>(mesh.shape).levels.size(), 1u);
    const anamorph::Features features =
        anamorph::parse_features_json(block_with("features", "morph"), "docs");
    EXPECT_EQ(features.shapes(), 2);
    EXPECT_GE(features.size(), 4u);
    EXPECT_EQ(features.border_weight(), 1);
    const anamorph::Tour tour = anamorph::parse_tour_json(block_with("panoramas", "vtk"), "docs");
    EXPECT_EQ(tour.at(tour.at(0).spots.at(0).target).file, "garden.exr");
}

}  // namespace
}  // namespace anamorph::test_docs
