// SPDX-License-Identifier: Apache-2.0
// What holds for every JSON that is read.
#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "anamorph/deform/deformation_file.h"
#include "anamorph/deform/key_frames_file.h"
#include "anamorph/error.h"
#include "anamorph/machine/machine_text.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/morph/features_file.h"

namespace anamorph::test_json_file {
using namespace machine;
namespace {

std::string refusal_of(const std::function<void()>& read) {
    try {
        read();
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

/// The last one would be taken in silence.
TEST(JsonFile, AKeyStandsOnceInAnObject) {
    const auto twice = [](const char* file, const char* key) {
        return std::string(file) + ": \"" + key + "\" is given twice: must be given once";
    };
    EXPECT_EQ(refusal_of([] {
                  parse_key_frames_json(R"({"keys": {"turn": [[0, 0], [9, 1]], "turn": [[0, 1], [9, 2]]}})",
                                        "film.json");
              }),
              twice("film.json", "turn"));
    EXPECT_EQ(refusal_of([] { parse_key_frames_json(R"({"keys": {}, "keys": {}})", "film.json"); }),
              twice("film.json", "keys"));
    EXPECT_EQ(refusal_of([] { block_machine_from_text(R"({"block": 4, "segment": 8, "block": 16})"); }),
              twice("machine", "block"));
    // However it is written, and whatever it holds.
    EXPECT_EQ(refusal_of([] { bump_unit_from_text(R"({"size": 64, "\u0073ize": 64})"); }),
              twice("machine", "size"));
    EXPECT_EQ(refusal_of([] { shader_unit_from_text("{\"a\\nb\": {}, \"a\\nb\": []}"); }),
              twice("machine", "a?b"));
    EXPECT_EQ(refusal_of([] { parse_mesh_json(R"({"columns": 1, "rows": 1, "columns": 2})", "mesh.json"); }),
              twice("mesh.json", "columns"));
    EXPECT_EQ(refusal_of([] {
                  parse_features_json(R"({"features": [{"line": [[0, 0, 1, 0], [0, 0, 2, 0]], "line": []}]})",
                                      "face.json");
              }),
              twice("face.json", "line"));
    EXPECT_EQ(refusal_of([] {
                  parse_deformations_json(R"({"deformations": [{"vector": [0, 0, 1], "vector": [0, 0, 2]}]})",
                                          "bumps.json");
              }),
              twice("bumps.json", "vector"));
    // The same key in another object is another one.
    EXPECT_EQ(refusal_of([] {
                  parse_features_json(
                      R"({"features": [{"line": [[0,0,1,0], [0,0,2,0]]}, {"line": [[0,0,1,0], [0,1,1,1]]}]})",
                      "face.json");
              }),
              "");
}

}  // namespace
}  // namespace anamorph::test_json_file
