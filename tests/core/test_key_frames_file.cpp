// SPDX-License-Identifier: Apache-2.0
// Key frames from files, and the films of the operation drape that follow them.
#include "anamorph/deform/key_frames_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <variant>

#include "anamorph/operation/operation.h"

namespace anamorph::test_key_frames_file {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string error_of(const std::string& text) {
    try {
        parse_key_frames_json(text, "keys.json");
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

TEST(KeyFramesFile, HoldsNumbersByName) {
    const auto keys = parse_key_frames_json(
        R"({"keys": {"turn": [[0, 0.25], [8, 0.75]], "camera": [[2, 0, 0, 2], [4, 1, 0, 4]]}, "interpolation": "linear"})",
        "keys.json");
    ASSERT_EQ(keys.size(), 2u);
    EXPECT_EQ(keys[0].name, "camera");
    EXPECT_THAT(keys[0].frames.at(3), ElementsAre(0.5, 0, 3));
    EXPECT_EQ(keys[1].name, "turn");
    EXPECT_THAT(keys[1].frames.at(2), ElementsAre(0.375));
    EXPECT_THAT(keys[1].frames.at(100), ElementsAre(0.75));
}

TEST(KeyFramesFile, SaysWhatIsWrong) {
    EXPECT_THAT(error_of("["), HasSubstr("keys.json: is no JSON"));
    EXPECT_THAT(error_of("{}"), HasSubstr("keys.json: must be an object with keys"));
    EXPECT_THAT(error_of(R"({"keys": {}, "more": 1})"), HasSubstr("must be an object with keys"));
    EXPECT_THAT(error_of(R"({"keys": {}, "interpolation": "best"})"),
                HasSubstr("interpolation: must be one of step, linear"));
    EXPECT_THAT(error_of(R"({"keys": {"turn": []}})"), HasSubstr("turn: must be a list of 1 to"));
    EXPECT_THAT(error_of(R"({"keys": {"turn": [[1]]}})"), HasSubstr("turn: a key frame must be"));
    EXPECT_THAT(error_of(R"({"keys": {"turn": [[0, "a"]]}})"), HasSubstr("turn: a key frame must be"));
    EXPECT_THAT(error_of(R"({"keys": {"turn": [[1, 0], [1, 1]]}})"), HasSubstr("times must ascend"));
}

/// One text for all files.
class OneFile final : public SideFileReader {
  public:
    explicit OneFile(std::string text) : m_text(std::move(text)) {}
    std::string text(const std::string&) const override { return m_text; }
    std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
        throw Error("there is no image " + name);
    }

  private:
    std::string m_text;
};

constexpr Size kScreen = {24, 16};

/// A film of .drape by key frames.
class Film {
  public:
    Film(const std::string& keys, const std::string& arguments)
        : m_values(*find_operation("drape")->parameters) {
        m_values.assign(parse_recipe_name("?" + arguments).assignments);
        if (!keys.empty()) m_files["keys"] = {"keys.json", ""};
        SourceImage source;
        source.facts.width = kScreen.width;
        source.facts.height = kScreen.height;
        source.channels = 1;
        m_pictures = find_operation("drape")->read({m_values, {source}, m_files, OneFile(keys)});
    }
    const Pictures& operator*() const { return *m_pictures; }
    int frames() const { return m_pictures->frames(); }
    int number(int i) const {
        const PictureRequest picture = *m_pictures->picture(i, 0);
        for (const Attribute& a : picture.says)
            if (a.name == "anamorph:frame") return std::get<int>(a.value);
        return -1;
    }
    /// Where a frame's picture points.
    std::vector<float> points(int i) const {
        std::vector<float> pixels(static_cast<std::size_t>(2 * kScreen.width * kScreen.height));
        EXPECT_TRUE(m_pictures->picture(i, 0)->solve()->draw(
            {}, {0, 0, kScreen.width, kScreen.height},
            packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, kScreen.width,
                        kScreen.height, 2),
            serial_for));
        return pixels;
    }

  private:
    ParameterValues m_values;
    SideFiles m_files;
    std::unique_ptr<const Pictures> m_pictures;
};

const char* const kKeys =
    R"({"keys": {"turn": [[0, 0.2], [4, 0.6]], "rotate": [[0, 0, 0, 0], [4, 0, 40, 0]]}, "interpolation": "linear"})";
const char* const kPage = "surface=page_turn&output=stmap";

TEST(DrapeFilm, FramesAreThePicturesOfTheirNumbers) {
    const Film film(kKeys, kPage);
    ASSERT_EQ(film.frames(), 5);
    for (int i = 0; i < 5; ++i) EXPECT_EQ(film.number(i), i);
    EXPECT_EQ(film.points(0), Film("", std::string(kPage) + "&turn=0.2").points(0));
    EXPECT_EQ(film.points(1), Film("", std::string(kPage) + "&turn=0.3&rotate=0,10,0").points(0));
    EXPECT_EQ(film.points(4), Film("", std::string(kPage) + "&turn=0.6&rotate=0,40,0").points(0));
    const Film one(kKeys, std::string(kPage) + "&frame=2"), more(kKeys, std::string(kPage) + "&frames=9");
    EXPECT_EQ(one.frames(), 1);
    EXPECT_EQ(one.number(0), 2);
    EXPECT_EQ(one.points(0), film.points(2));
    EXPECT_EQ(more.frames(), 9);
    EXPECT_EQ(more.points(8), film.points(4));
}

TEST(DrapeFilm, RefusesWhatIsNoNumberOfThePicture) {
    const auto error = [](const std::string& keys, const std::string& arguments = "") {
        try {
            Film(keys, arguments);
        } catch (const Error& e) {
            return std::string(e.what());
        }
        return std::string();
    };
    EXPECT_THAT(error(R"({"keys": {"none": [[0, 1]]}})"), HasSubstr("none: is no key of numbers"));
    EXPECT_THAT(error(R"({"keys": {"filter": [[0, 1]]}})"), HasSubstr("filter: is no key of numbers"));
    EXPECT_THAT(error(R"({"keys": {"turn": [[0, 0.5], [3, 1.5]]}})"), HasSubstr("frame 2: turn=1.16"));
    EXPECT_THAT(error(R"({"keys": {"turn": [[0, 0.5, 0.5]]}})"), HasSubstr("frame 0: turn"));
    EXPECT_THAT(error(R"({"keys": {"camera": [[0, 1, 1]]}})"), HasSubstr("frame 0: camera"));
    EXPECT_THAT(error(R"({"keys": {"camera": [[0, 0, 0, 2], [8, 0, 0, -2]]}, "interpolation": "linear"})"),
                HasSubstr("frame 4: camera=0,0,0"));
    EXPECT_THAT(error(R"({"keys": {"turn": [[0, 0.5], [1e9, 1]]}})"), HasSubstr("frames is not given"));
    EXPECT_THAT(error("", "frame=1&frames=2"), HasSubstr("must not be given together"));
}

}  // namespace
}  // namespace anamorph::test_key_frames_file
