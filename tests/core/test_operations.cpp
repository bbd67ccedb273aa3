// SPDX-License-Identifier: Apache-2.0
// Every operation of the registry, whatever there is.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "anamorph/operation/operation.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::test_operations {
namespace {

using testing::HasSubstr;

/// The side files of an example.
class ExampleFiles final : public SideFileReader {
  public:
    explicit ExampleFiles(const Operation& operation) : m_files(operation.example.files) {}
    std::string text(const std::string& name) const override {
        for (const auto& [file, text] : m_files)
            if (file == name) return text;
        throw Error("there is no file " + name);
    }
    std::unique_ptr<SideImage> image(const std::string&, const std::string& name) const override {
        throw Error("there is no image " + name);
    }

  private:
    std::vector<std::pair<std::string, std::string>> m_files;
};

/// An operation's example, of sources of one size.
class ExamplePictures {
  public:
    explicit ExamplePictures(const Operation& operation, const std::vector<Assignment>& more = {})
        : m_reader(operation), m_values(*operation.parameters) {
        m_values.assign(parse_recipe_name("?" + operation.example.arguments).assignments);
        m_values.assign(more);
        for (const Parameter& p : *operation.parameters)
            if ((p.type == ParameterType::image || p.type == ParameterType::file) && m_values.given(p.name))
                m_files[p.name] = {m_values.text(p.name), ""};
        SourceImage source;
        source.facts.width = kSource.width;
        source.facts.height = kSource.height;
        source.channels = kChannels;
        m_sources.resize(operation.least_sources, source);
        m_pictures = operation.read({m_values, m_sources, m_files, m_reader});
    }

    const Pictures& operator*() const { return *m_pictures; }
    const Pictures* operator->() const { return m_pictures.get(); }

    /// Pixels of a part of a picture, as float; its sources are of noise.
    std::vector<float> draw(const PictureRequest& request, const Box& box) const {
        const int channels = request.pixels == PixelKind::point    ? 2
                             : request.pixels == PixelKind::vector ? 3
                             : request.pixels == PixelKind::value  ? 1
                             : m_sources.empty()                   ? static_cast<int>(request.channels.size())
                                                                   : kChannels;
        std::vector<std::vector<float>> texels;
        std::vector<MemorySource> images;
        for (std::size_t i = 0; i < m_sources.size(); ++i) texels.push_back(noise(i));
        for (std::vector<float>& t : texels)
            images.emplace_back(packed_view(reinterpret_cast<const std::byte*>(t.data()), PixelType::float32,
                                            kSource.width, kSource.height, kChannels));
        std::vector<const Source*> sources;
        for (const MemorySource& image : images) sources.push_back(&image);
        std::vector<float> pixels(static_cast<std::size_t>(box.width() * box.height() * channels));
        EXPECT_TRUE(
            request.solve()->draw(sources, box,
                                  packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32,
                                              box.width(), box.height(), channels),
                                  serial_for));
        return pixels;
    }

  private:
    static constexpr Size kSource = {48, 24};
    static constexpr int kChannels = 5;  // as of an image with AOVs

    static std::vector<float> noise(std::size_t seed) {
        std::vector<float> values(static_cast<std::size_t>(kSource.width * kSource.height * kChannels));
        for (std::size_t i = 0; i < values.size(); ++i)
            values[i] = static_cast<float>((i * 7919 + seed * 31) % 1009) / 1009;
        return values;
    }

    ExampleFiles m_reader;
    ParameterValues m_values;
    SideFiles m_files;
    std::vector<SourceImage> m_sources;
    std::unique_ptr<const Pictures> m_pictures;
};

TEST(Operations, HaveNamesAndSources) {
    std::set<std::string> names;
    for (const Operation* operation : operations()) {
        SCOPED_TRACE(operation->name);
        EXPECT_TRUE(names.insert(operation->name).second);
        EXPECT_EQ(find_operation(operation->name), operation);
        EXPECT_THAT(operation_names(), HasSubstr(operation->name));
        EXPECT_FALSE(operation->title.empty());
        EXPECT_LE(operation->least_sources, operation->sources.size());
        // What a source or a side file is called is the name of a row.
        for (const std::string& key : operation->sources) {
            const auto row = std::find_if(operation->parameters->begin(), operation->parameters->end(),
                                          [&](const Parameter& p) { return p.name == key; });
            ASSERT_NE(row, operation->parameters->end()) << key;
            EXPECT_EQ(row->type, ParameterType::image) << key;
        }
    }
    EXPECT_EQ(find_operation("none"), nullptr);
}

TEST(Operations, TooFewAndTooManySourcesAreRefused) {
    for (const Operation* operation : operations()) {
        const ExampleFiles files(*operation);
        const ParameterValues values(*operation->parameters);
        const auto message = [&](std::size_t count) -> std::string {
            try {
                operation->read({values, std::vector<SourceImage>(count), {}, files});
            } catch (const Error& error) {
                return error.what();
            }
            return "no error";
        };
        const std::size_t least = operation->least_sources, most = operation->sources.size();
        EXPECT_THAT(message(most + 1),
                    HasSubstr("sources=" + std::to_string(most + 1) + ": " + operation->name));
        if (least > 0) {
            EXPECT_THAT(message(least - 1), HasSubstr("sources=" + std::to_string(least - 1) + ": "));
        }
    }
}

TEST(Operations, ExamplesAreDrawnTheSameWholeAndInParts) {
    for (const Operation* operation : operations()) {
        SCOPED_TRACE(operation->name);
        const ExamplePictures pictures(*operation);
        const PictureRequest request = *pictures->picture(0, 0);
        const Box whole = {0, 0, request.size.width, request.size.height};
        const std::vector<float> pixels = pictures.draw(request, whole);
        ASSERT_FALSE(pixels.empty());
        EXPECT_GT(*std::max_element(pixels.begin(), pixels.end()),
                  *std::min_element(pixels.begin(), pixels.end()));
        const Box part = {5, 3, whole.x1 - 2, whole.y1 - 4};
        const std::vector<float> cut = pictures.draw(request, part);
        const std::size_t channels = pixels.size() / static_cast<std::size_t>(whole.x1 * whole.y1);
        for (int y = part.y0; y < part.y1; ++y)
            EXPECT_TRUE(std::equal(
                cut.begin() + (y - part.y0) * part.width() * static_cast<std::ptrdiff_t>(channels),
                cut.begin() + (y - part.y0 + 1) * part.width() * static_cast<std::ptrdiff_t>(channels),
                pixels.begin() + (y * whole.x1 + part.x0) * static_cast<std::ptrdiff_t>(channels)));
        for (const Attribute& reached : request.solve()->reached(serial_for))
            EXPECT_TRUE(reached.name.starts_with("anamorph:")) << reached.name;
    }
}

TEST(Operations, AMosaicSaysItsDistortionWhereTheNearestThingIsKnown) {
    // Seen from half a radius off the centre, in that direction, what is r from the centre has 1 - 0.5 / r for the 1 - 0.5 / 4 of the
    // depth: it is off most at the nearest distance, 1.2, or infinitely far.
    const auto said = [](const std::vector<Assignment>& more) {
        std::optional<double> value;
        for (const Attribute& a :
             ExamplePictures(*find_operation("mosaic"), more)->picture(0, 0)->solve()->reached(serial_for))
            if (a.name == "anamorph:vertical_distortion") value = std::get<double>(a.value);
        return value;
    };
    EXPECT_NEAR(said({{"nearest", "1.2"}}).value_or(0), 1.0 / 3, 1e-3);
    EXPECT_NEAR(said({}).value_or(0), 1.0 / 7, 1e-3);
}

TEST(Operations, LevelsEndWithOnePixelOrOneFace) {
    for (const Operation* operation : operations()) {
        SCOPED_TRACE(operation->name);
        const ExamplePictures pictures(*operation);
        Size size = pictures->picture(0, 0)->size;
        int level = 1;
        for (; pictures->picture(0, level); ++level) {
            const Size next = pictures->picture(0, level)->size;
            EXPECT_EQ(next, (Size{std::max(1, size.width / 2), std::max(1, size.height / 2)}));
            size = next;
        }
        EXPECT_EQ(size, (Size{1, 1}));
        EXPECT_EQ(level, 6);  // of 48 x 24
    }
}

/// Another value of a row than its default.
std::string other_value(const Parameter& p) {
    switch (p.type) {
        case ParameterType::choice:
            return p.choices[p.choices[0] == p.default_value ? 1 : 0];
        case ParameterType::toggle:
            return p.default_value == "1" ? "0" : "1";
        case ParameterType::extent:
        case ParameterType::whole:
            return "3";
        case ParameterType::number:
            return p.minimum < 0.25 ? "0.25" : shortest(p.minimum + 0.25);
        case ParameterType::numbers:
            return "0.25,0.75";
        default:
            return "other";
    }
}

TEST(OperationKey, DiffersWithEveryKeyOfEveryOperation) {
    for (const Operation* operation : operations()) {
        std::vector<SourceImage> images(operation->least_sources);
        for (SourceImage& image : images) {
            image.facts.width = 64, image.facts.height = 32;
            image.channels = 3;
            image.color_space = "sRGB";
        }
        std::set<std::string> keys;
        const auto add = [&](const std::vector<Assignment>& assignments, const std::vector<SourceImage>& of,
                             const SideFiles& files) {
            ParameterValues values(*operation->parameters);
            values.assign(assignments);
            return keys.insert(operation_key(*operation, values, of, files)).second;
        };
        EXPECT_TRUE(add({}, images, {}));
        EXPECT_FALSE(add({}, images, {}));
        for (const Parameter& p : *operation->parameters) {
            const bool source = std::find(operation->sources.begin(), operation->sources.end(), p.name) !=
                                operation->sources.end();
            // The picture is the same for other pixels of the same size: they have a key of their own.
            EXPECT_EQ(add({{p.name, other_value(p)}}, images, {}), !source)
                << operation->name << " " << p.name;
            if (p.type == ParameterType::file || (p.type == ParameterType::image && !source)) {
                EXPECT_TRUE(add({}, images, {{p.name, {"f", "1"}}})) << p.name;
                EXPECT_TRUE(add({}, images, {{p.name, {"f", "2"}}})) << p.name;
            }
        }
        for (std::size_t i = 0; i < images.size(); ++i) {
            const auto with = [&](const auto& change) {
                std::vector<SourceImage> others = images;
                change(others[i]);
                return add({}, others, {});
            };
            EXPECT_TRUE(with([](SourceImage& s) { s.facts.width = 65; }));
            EXPECT_TRUE(with([](SourceImage& s) { s.facts.height = 33; }));
            EXPECT_TRUE(with([](SourceImage& s) { s.facts.projection = Projection::fisheye; }));
            EXPECT_TRUE(with([](SourceImage& s) { s.facts.fov = 100; }));
            EXPECT_TRUE(with([](SourceImage& s) { s.channels = 4; }));
            EXPECT_TRUE(with([](SourceImage& s) { s.color_space = "linear"; }));
            EXPECT_TRUE(with([](SourceImage& s) { s.alpha = 3; }));
        }
    }
}

}  // namespace
}  // namespace anamorph::test_operations
