// SPDX-License-Identifier: Apache-2.0
// The cheapest input there can be: tiles of one colour. What a host gets from it is the most that any plugin
// gives. Names: WIDTHxHEIGHT.constant (tiles) and WIDTHxHEIGHT.lines.constant (scanlines), float RGB.
#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>

namespace {

class ConstantInput final : public OIIO::ImageInput {
    using ImageInput::read_native_scanlines;
    using ImageInput::read_native_tiles;

  public:
    const char* format_name() const override { return "constant"; }
    bool valid_file(const std::string& name) const override {
        return OIIO::Strutil::iends_with(name, ".constant");
    }
    bool open(const std::string& name, OIIO::ImageSpec& spec) override {
        int width = 0, height = 0;
        if (!valid_file(name) || std::sscanf(name.c_str(), "%dx%d", &width, &height) != 2) {
            errorfmt("not WIDTHxHEIGHT.constant");
            return false;
        }
        m_spec = OIIO::ImageSpec(width, height, 3, OIIO::TypeFloat);
        if (!OIIO::Strutil::contains(name, ".lines.")) m_spec.tile_width = m_spec.tile_height = 256;
        spec = m_spec;
        return true;
    }
    bool close() override { return true; }
    bool read_native_scanline(int, int, int, int, void* data) override { return fill(m_spec.width, data); }
    bool read_native_scanlines(int, int, int ybegin, int yend, int, void* data) override {
        return fill(std::int64_t{m_spec.width} * (yend - ybegin), data);
    }
    bool read_native_tile(int, int, int, int, int, void* data) override {
        return fill(std::int64_t{m_spec.tile_width} * m_spec.tile_height, data);
    }
    bool read_native_tiles(int, int, int xbegin, int xend, int ybegin, int yend, int, int,
                           void* data) override {
        return fill(std::int64_t{xend - xbegin} * (yend - ybegin), data);
    }

  private:
    static bool fill(std::int64_t pixels, void* data) {
        std::fill_n(static_cast<float*>(data), pixels * 3, 0.5f);
        return true;
    }
};

}  // namespace

OIIO_PLUGIN_EXPORTS_BEGIN
OIIO_EXPORT int constant_imageio_version = OIIO_PLUGIN_VERSION;
OIIO_EXPORT const char* constant_imageio_library_version() {
    return "constant";
}
OIIO_EXPORT OIIO::ImageInput* constant_input_imageio_create() {
    return new ConstantInput;
}
OIIO_EXPORT const char* constant_input_extensions[] = {"constant", nullptr};
OIIO_PLUGIN_EXPORTS_END
