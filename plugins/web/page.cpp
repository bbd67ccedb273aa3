// SPDX-License-Identifier: Apache-2.0
#include "page.h"

#include <algorithm>
#include <cstring>

#include "anamorph/error.h"
#include "anamorph/image/picture.h"
#include "anamorph/image/picture_tiles.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/view.h"
#include "anamorph/parameter/parameter.h"
#include "sample.h"

namespace anamorph {

const Operation& lens_operation();
const Operation& map_operation();
const Operation& pano_operation();
const Operation& warp_operation();

namespace web {
namespace {

constexpr int kChannels = 3;

/// The texts that the page has, for recipes that name files.
class Texts final : public SideFileReader {
  public:
    explicit Texts(const std::map<std::string, std::string>& files) : m_files(files) {}
    std::string text(const std::string& name) const override {
        const auto found = m_files.find(name);
        if (found == m_files.end()) throw Error("the page has no file " + printable(name));
        return found->second;
    }
    bool exists(const std::string& name) const override { return m_files.contains(name); }
    std::unique_ptr<SideImage> image(const std::string& key, const std::string& name) const override {
        throw Error(key, printable(name), "must be no image: the page opens one alone");
    }

  private:
    const std::map<std::string, std::string>& m_files;
};

const Operation* operation_named(std::string_view name) {
    for (const Operation* operation : page_operations())
        if (operation->name == name) return operation;
    throw Error("recipe", printable(name), "must be one of pano, lens, map, warp, and what follows a ?");
}

}  // namespace

const std::vector<const Operation*>& page_operations() {
    static const std::vector<const Operation*> all = {&pano_operation(), &lens_operation(), &map_operation(),
                                                      &warp_operation()};
    return all;
}

Page::Page() = default;
Page::~Page() = default;

void Page::take_image(const std::uint8_t* rgba, const Size& size) {
    check_picture_size("image", size);
    const auto count = static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height);
    m_picture.reset();
    m_pyramid.reset();
    m_over.reset();
    m_source_pixels.resize(count * kChannels);
    m_source_size = size;
    std::uint8_t* to = m_source_pixels.data();
    for (std::size_t i = 0; i < count; ++i, to += kChannels) {
        const std::uint8_t* const from = rgba + 4 * i;
        to[0] = from[0], to[1] = from[1], to[2] = from[2];
    }
    m_image =
        std::make_unique<MemorySource>(packed_view(reinterpret_cast<const std::byte*>(m_source_pixels.data()),
                                                   PixelType::uint8, size.width, size.height, kChannels));
}

void Page::take_sample(int height) {
    const std::vector<std::uint8_t> rgba = sample_panorama(height);
    take_image(rgba.data(), {2 * height, height});
}

void Page::plan(const std::string& recipe) {
    m_picture.reset();
    if (!m_image) throw Error("there is no image yet");
    const std::size_t mark = std::min(recipe.find('?'), recipe.size());
    const Operation* const operation = operation_named(std::string_view(recipe).substr(0, mark));
    ParameterValues values(*operation->parameters);
    values.assign(parse_recipe_name(recipe.substr(mark)).assignments);
    SideFiles files;
    for (const LinkedFile& file : operation->named_files(values))
        files[file.key] = {file.name, "", file.image};

    SourceImage image;
    image.facts.width = m_source_size.width;
    image.facts.height = m_source_size.height;
    image.facts.channel_names = {"R", "G", "B"};
    image.channels = kChannels;
    const std::unique_ptr<const Pictures> pictures =
        operation->read({values, {image}, files, Texts(m_files)});
    const std::optional<PictureRequest> request = pictures->picture(0, 0);
    if (!request || pictures->frames() != 1) throw Error("a recipe of the page must be one picture");
    if (request->pixels != PixelKind::color || !request->channels.empty() || request->adds_alpha)
        throw Error("a recipe of the page must show colours without alpha");
    if (request->display) throw Error("a recipe of the page must have no pixels beyond its edges");

    // What is made of the image is kept, as long as it would be the same.
    const SourceFaces faces = pictures->faces();
    std::unique_ptr<const Source> over = pictures->over_source(0, *m_image);
    if (!m_pyramid || over || m_over || faces.columns != m_faces.columns || faces.rows != m_faces.rows) {
        m_pyramid.reset();
        m_over = std::move(over);
        m_pyramid = std::make_unique<Pyramid>(m_over ? *m_over : *m_image, faces.columns, faces.rows);
        m_faces = faces;
    }
    std::unique_ptr<const SolvedPicture> picture = request->solve();
    m_size = request->size;
    m_says = request->says;
    for (const Attribute& attribute : picture->reached(serial_for)) m_says.push_back(attribute);
    m_picture = std::move(picture);
}

void Page::draw(int y0, int y1, std::uint8_t* rgba) const {
    if (!m_picture) throw Error("there is no picture yet");
    const auto width = static_cast<std::size_t>(m_size.width);
    // Packed in the lower end of the rows that they are to fill, and taken apart from the last on.
    auto* const packed = reinterpret_cast<std::byte*>(rgba);
    if (!m_picture->draw({m_pyramid.get()}, {0, y0, m_size.width, y1},
                         packed_view(packed, PixelType::uint8, m_size.width, y1 - y0, kChannels), serial_for))
        throw Error("the image cannot be read");
    for (std::size_t i = width * static_cast<std::size_t>(y1 - y0); i-- > 0;) {
        const std::uint8_t pixel[] = {rgba[3 * i], rgba[3 * i + 1], rgba[3 * i + 2], 255};
        std::memcpy(rgba + 4 * i, pixel, sizeof(pixel));
    }
}

PictureHash Page::hash(const std::uint8_t* rgba) const {
    FileHasher hasher;
    hasher.add_picture({m_size.width, m_size.height, PixelType::uint8, {"R", "G", "B"}},
                       [&](const Box& box, std::byte* pixels) {
                           for (int y = box.y0; y < box.y1; ++y)
                               for (int x = box.x0; x < box.x1; ++x, pixels += kChannels)
                                   std::copy_n(reinterpret_cast<const std::byte*>(rgba) +
                                                   4 * (std::ptrdiff_t{y} * m_size.width + x),
                                               kChannels, pixels);
                       });
    return hasher.hash();
}

}  // namespace web
}  // namespace anamorph
