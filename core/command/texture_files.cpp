// SPDX-License-Identifier: Apache-2.0
#include "texture_files.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "anamorph/error.h"
#include "input_file.h"

#ifdef ANAMORPH_HAVE_CAIRO
#include <cairo.h>
#endif

namespace anamorph::command {
namespace {

namespace fs = std::filesystem;

/// Red, green, blue, multiplied by alpha, and alpha.
struct Pixels {
    int width = 0, height = 0;
    std::vector<float> values;
};

/// A PPM file of type P6 with 8 bits. Throws Error.
Pixels read_ppm(const std::string& name) {
    std::ifstream file(name, std::ios::binary);
    const std::string all{std::istreambuf_iterator<char>(file), {}};
    if (!all.starts_with("P6")) throw Error("is no PPM file of type P6");
    std::size_t at = 2;
    int header[3] = {};
    for (int& value : header) {
        for (; at < all.size() && (all[at] == '#' || std::isspace(static_cast<unsigned char>(all[at]))); ++at)
            if (all[at] == '#') at = std::min(all.find('\n', at), all.size() - 1);
        const auto [end, error] = std::from_chars(all.data() + at, all.data() + all.size(), value);
        if (error != std::errc()) throw Error("is cut off");
        at = static_cast<std::size_t>(end - all.data());
    }
    Pixels pixels{header[0], header[1], {}};
    if (std::min(header[0], header[1]) < 1 || std::max(header[0], header[1]) > kMaxSide || header[2] != 255)
        throw Error("must have 8 bits and up to " + std::to_string(kMaxSide) + " pixels either way");
    const std::size_t count = static_cast<std::size_t>(header[0]) * static_cast<std::size_t>(header[1]);
    if (all.size() < at + 1 || (all.size() - at - 1) / 3 < count) throw Error("is cut off");
    for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t c = 0; c < 3; ++c)
            pixels.values.push_back(static_cast<float>(static_cast<unsigned char>(all[at + 1 + 3 * i + c])) /
                                    255);
        pixels.values.push_back(1);
    }
    return pixels;
}

#ifdef ANAMORPH_HAVE_CAIRO
/// Throws Error.
Pixels read_png(const std::string& name) {
    const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
        cairo_image_surface_create_from_png(name.c_str()), cairo_surface_destroy);
    if (const cairo_status_t status = cairo_surface_status(surface.get()); status != CAIRO_STATUS_SUCCESS)
        throw Error(cairo_status_to_string(status));
    const cairo_format_t format = cairo_image_surface_get_format(surface.get());
    if (format != CAIRO_FORMAT_ARGB32 && format != CAIRO_FORMAT_RGB24) throw Error("must have 8 bits");
    Pixels pixels{
        cairo_image_surface_get_width(surface.get()), cairo_image_surface_get_height(surface.get()), {}};
    for (int y = 0; y < pixels.height; ++y) {
        const unsigned char* row = cairo_image_surface_get_data(surface.get()) +
                                   std::ptrdiff_t{y} * cairo_image_surface_get_stride(surface.get());
        for (int x = 0; x < pixels.width; ++x) {
            // 0xAARRGGBB of the machine's byte order.
            std::uint32_t texel;
            std::memcpy(&texel, row + std::ptrdiff_t{4} * x, sizeof texel);
            if (format == CAIRO_FORMAT_RGB24) texel |= 0xff000000u;
            for (const int shift : {16, 8, 0, 24})
                pixels.values.push_back(static_cast<float>(texel >> shift & 0xff) / 255);
        }
    }
    return pixels;
}
#endif

Pixels read_picture(const std::string& name) {
#ifdef ANAMORPH_HAVE_CAIRO
    std::ifstream file(name, std::ios::binary);
    if (file.get() == 0x89) return read_png(name);
#endif
    return read_ppm(name);
}

/// Empty where there is none.
std::string file_beside(const std::string& script, const std::string& name) {
    const fs::path base = fs::path(script).parent_path() / name;
    std::error_code error;
    for (const char* ending : {"", ".png", ".ppm"}) {
        fs::path path = base;
        path += ending;
        if (fs::is_regular_file(path, error)) return path.string();
    }
    return {};
}

}  // namespace

struct TextureFiles::Texture {
    explicit Texture(Pixels read)
        : pixels(std::move(read)),
          base(std::make_unique<MemorySource>(
              packed_view(reinterpret_cast<const std::byte*>(pixels.values.data()), PixelType::float32,
                          pixels.width, pixels.height, 4))),
          pyramid(*base) {}
    explicit Texture(figure::MraselMaps maps)
        : base(std::make_unique<figure::MraselMaps>(std::move(maps))), pyramid(*base) {}

    Pixels pixels;
    std::unique_ptr<const Source> base;
    Pyramid pyramid;
};

figure::MraselMaps read_maps(const std::string& name) {
    return figure::MraselMaps::read_from(name, [](const std::string& file) {
        const std::optional<std::string> bytes =
            read_file(file, false, figure::bytes_of_map(figure::kMraselSide));
        if (!bytes) throw Error("cannot read " + file);
        return *bytes;
    });
}

void TextureFiles::Delete::operator()(Texture* texture) const {
    delete texture;
}

TextureFiles::TextureFiles(const std::string& script, const std::vector<std::string>& names,
                           const std::function<void(const std::string& what)>& warn) {
    for (const std::string& name : names) {
        m_sources.push_back(nullptr);
        const std::string maps = (fs::path(script).parent_path() / name).string();
        std::error_code code;
        const bool are_maps = fs::is_regular_file(figure::mrasel_map_file(maps, figure::kMraselSide), code);
        const std::string file = are_maps ? maps : file_beside(script, name);
        if (file.empty()) {
            warn("the texture " + name + " is not there: bodies have their own color");
            continue;
        }
        try {
            m_textures.emplace_back(are_maps ? new Texture(read_maps(maps))
                                             : new Texture(read_picture(file)));
            m_sources.back() = &m_textures.back()->pyramid;
        } catch (const Error& error) {
            warn("the texture " + file + " cannot be read: " + error.what());
        }
    }
}

void TextureFiles::add(const std::string& file) {
    std::error_code code;
    if (!fs::is_regular_file(file, code)) throw Error("there is no such file");
    m_textures.emplace_back(new Texture(read_picture(file)));
    m_sources.push_back(&m_textures.back()->pyramid);
}

}  // namespace anamorph::command
