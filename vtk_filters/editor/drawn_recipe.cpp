// SPDX-License-Identifier: Apache-2.0
#include "drawn_recipe.h"

#include <OpenImageIO/imagecache.h>
#include <OpenImageIO/thread.h>

#include <cmath>

#include "anamorph/file_names.h"
#include "anamorph/image_source.h"
#include "anamorph/metadata.h"
#include "anamorph/orientation.h"
#include "anamorph/parallel.h"
#include "anamorph/parameter/text_file.h"
#include "anamorph/side_files.h"
#include "recipe.h"
#include "shown.h"

namespace anamorph_editor {

using anamorph::Box;
using anamorph::Error;
using anamorph::PixelType;
using anamorph::printable;

namespace {

/// The image as it stands, by a mesh of one cell.
constexpr const char* kUnmoved =
    R"({"columns": 1, "rows": 1, "units": "fractions", "vertices": [[0, 0], [1, 0], [0, 1], [1, 1]]})";

/// The name by which the operation is told of the text: whatever the file's format, it is JSON.
std::string json_name(const std::string& file) {
    return file.ends_with(".json") ? file : file + ".json";
}

/// The keys that one picture in a window has no use for.
void refuse_keys(const anamorph::ParameterValues& values) {
    for (const char* key : {"subimage", "frames", "overscan"})
        if (values.knows(key) && values.given(key))
            throw Error(key, printable(values.text(key)), "must not be given: the window draws one picture");
}

/// Values of `channels` channels to red, green and blue.
template <class Value, class Shown>
void convert_row(const Value* from, int channels, int width, unsigned char* to, const Shown& shown) {
    // One channel, and grey with alpha, is grey; a source point is red and green.
    const int step[] = {0, channels < 3 ? 0 : 1, channels < 3 ? 0 : 2};
    for (int x = 0; x < width; ++x, from += channels, to += 3)
        for (int c = 0; c < 3; ++c) to[c] = shown(from[step[c]]);
}

}  // namespace

std::string saved_file(const std::string& asked, const std::string& own,
                       const std::vector<std::string>& endings) {
    if (asked.empty()) return own;
    std::string words;
    for (std::size_t i = 0; i < endings.size(); ++i) {
        if (anamorph::text_file::ends_with(asked, endings[i])) return asked;
        words += (i == 0 ? "" : i + 1 < endings.size() ? ", " : " or ") + endings[i];
    }
    throw Error("--save", printable(asked), "must be a " + words + " file");
}

double ReadyPicture::max_error() const {
    const anamorph::Picture* picture = m_solved->of_maps();
    return picture ? picture->reached(anamorph::default_parallel_for()).max_error : NAN;
}

DrawnRecipe::DrawnRecipe(const std::string& name, const std::string& edited)
    : DrawnRecipe(anamorph::RecipeReader().load(name), edited) {}

DrawnRecipe::DrawnRecipe(const anamorph::Recipe& recipe, const std::string& edited)
    : m_operation(recipe.operation), m_values(recipe.values), m_files(recipe.files), m_edited(edited) {
    refuse_keys(m_values);
    if (!m_values.knows(edited))
        throw Error("a recipe of ." + m_operation->name + " has no " + edited + ": must be one that has");
    const auto file = m_files.find(edited);
    if (file == m_files.end())
        throw Error::not_given(edited, ": must be the name of the file that is edited");
    m_edited_file = file->second.name;
    file->second = {json_name(m_edited_file), ""};
    for (const std::string& key : m_operation->sources) {
        const auto found = m_files.find(key);
        if (found != m_files.end()) m_image_files.push_back(found->second.name);
    }
    open(m_image_files);
}

DrawnRecipe::DrawnRecipe(const DrawnRecipe& of, std::size_t image)
    : m_operation(anamorph::find_operation("warp")),
      m_values(*m_operation->parameters),
      m_files{{"mesh", {"unmoved.json", ""}}},
      m_edited("mesh"),
      m_image_files{of.m_image_files[image]} {
    open(m_image_files);
}

void DrawnRecipe::open(const std::vector<std::string>& files) {
    std::vector<std::unique_ptr<anamorph::Source>> images;
    std::vector<OIIO::ImageSpec> specs;
    for (const std::string& file : files) {
        anamorph::check_file_name("src", file);
        auto image = std::make_unique<anamorph::CacheSource>(OIIO::ImageCache::create(true), file, 0, 0);
        image->keep_rows();
        if (specs.empty()) m_type = image->type();
        specs.push_back(image->spec());
        m_known.push_back(anamorph::source_image(anamorph::upright(specs.back())));
        images.push_back(std::move(image));
    }
    struct NoFaces final : anamorph::Pictures {
        std::optional<anamorph::PictureRequest> picture(int, int) const override { return {}; }
    };
    m_stacks = anamorph::make_source_stacks(std::move(images), specs, NoFaces(),
                                            anamorph::filtering_space(m_values, anamorph::PixelKind::color));
}

ReadyPicture DrawnRecipe::ready(const std::string& text, const anamorph::Size& size) const {
    anamorph::ParameterValues values = m_values;
    if (size.width > 0) values.set("size", size);
    const std::string& given = text.empty() ? kUnmoved : text;
    const std::string& name = m_files.at(m_edited).name;
    // The text that is edited stands for its file.
    const anamorph::MemoryFiles edited{{{name, given}}};
    const anamorph::MemoryFileReader reader(edited);
    const auto pictures = m_operation->read({values, m_known, m_files, reader});
    ReadyPicture ready;
    ready.m_request = *pictures->picture(0, 0);
    ready.m_solved = ready.m_request.solve();
    return ready;
}

void DrawnRecipe::draw(const ReadyPicture& picture, const Box& box, ScreenPixels& to) const {
    if (box.empty()) return;
    const bool bytes = m_type == PixelType::uint8 && picture.m_request.pixels == anamorph::PixelKind::color;
    const bool colors = picture.m_request.pixels == anamorph::PixelKind::color;
    const PixelType type = bytes ? PixelType::uint8 : PixelType::float32;
    const int channels = colors ? m_known[0].channels + (picture.m_request.adds_alpha ? 1 : 0)
                         : picture.m_request.pixels == anamorph::PixelKind::point ? 2
                                                                                  : 1;
    const std::size_t row = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(channels) *
                            static_cast<std::size_t>(anamorph::size_of(type));
    std::vector<std::byte> pixels(row * static_cast<std::size_t>(box.height()));
    anamorph::draw_picture(*picture.m_solved, m_stacks, box,
                           anamorph::packed_view(pixels.data(), type, box.width(), box.height(), channels),
                           anamorph::default_parallel_for());
    const bool hdr = colors && this->is_hdr();
    anamorph::default_parallel_for()(box.height(), [&](std::int64_t row_number) {
        const int y = static_cast<int>(row_number);
        const std::byte* from = pixels.data() + row * static_cast<std::size_t>(y);
        unsigned char* const rgb = to.at(box.x0, box.y0 + y);
        if (bytes)
            convert_row(reinterpret_cast<const unsigned char*>(from), channels, box.width(), rgb,
                        [](unsigned char v) { return v; });
        else
            convert_row(reinterpret_cast<const float*>(from), channels, box.width(), rgb,
                        [&](float v) { return anamorph_viewer::shown_quickly(v, hdr); });
    });
}

}  // namespace anamorph_editor
