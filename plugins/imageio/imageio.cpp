// SPDX-License-Identifier: Apache-2.0
// The OpenImageIO plugin: inputs for recipes (NAME.pano, NAME.pano?key=value&... and so on, one extension an operation) and
// for images in memory (NAME.anabuf), and the output that puts them there.
#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imageio.h>
#include <OpenImageIO/sysutil.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <memory>
#include <mutex>
#include <vector>

#include "anamorph/metadata.h"
#include "anamorph/parallel.h"
#include "anamorph/version.h"
#include "buffer_store.h"
#include "content.h"
#include "recipe.h"
#include "recipe_content.h"

namespace anamorph {
namespace {

using OIIO::ImageInput;
using OIIO::ImageOutput;
using OIIO::ImageSpec;

/// The name of the file and of its exports, too. It is not "anamorph": OpenImageIO takes an attribute whose
/// name begins with a format's for that format's own, and keeps anamorph:tol out of files of any other.
const char* const kFormat = "anamorph_recipes";

/// The name of the program that has loaded us.
const std::string& program() {
    static const auto& name =
        *new std::string(OIIO::Filesystem::filename(OIIO::Sysutil::this_program_path()));
    return name;
}

/// Does the program write what it reads in tiles of the same size? Others read by tiles, and only as far as they need.
bool copies_tiles() {
    return program() == "oiiotool" || program() == "iconvert";
}

/// oiiotool before 3.0 answers "File does not exist" where a name that is not on disk fails to open, whatever
/// the reason was; so there the reason is said here, once.
void explain_to_oiiotool(const std::string& name, const std::string& reason) {
#if OIIO_VERSION < 30000
    static auto& mutex = *new std::mutex;
    static auto& last = *new std::string;
    if (program() != "oiiotool" || OIIO::Filesystem::exists(name)) return;
    const std::lock_guard lock(mutex);
    if (last != reason) std::fprintf(stderr, "anamorph: %s\n", reason.c_str());
    last = reason;
#else
    static_cast<void>(name), static_cast<void>(reason);
#endif
}

std::string joined_extensions() {
    std::string text;
    for (const Operation* operation : operations()) {
        text += "." + operation->name + ", ";
        for (const std::string& ending : operation->endings) text += "." + ending + ", ";
    }
    return text + std::string(kBufferExtension);
}

/// Counts how deep this thread is inside calls of ours: what fails in an inner one is told by the outer one.
class Inside {
  public:
    Inside() { ++count(); }
    ~Inside() { --count(); }
    Inside(const Inside&) = delete;
    Inside& operator=(const Inside&) = delete;
    static int depth() { return count(); }

  private:
    static int& count() {
        static thread_local int depth = 0;
        return depth;
    }
};

class FileInput final : public ImageInput {
    // Newer versions of OpenImageIO have more overloads of these.
    using ImageInput::read_native_scanlines;
    using ImageInput::read_native_tiles;
    using ImageInput::valid_file;

  public:
    ~FileInput() override { close(); }

    const char* format_name() const override { return kFormat; }

    int supports(OIIO::string_view feature) const override {
#if OIIO_VERSION >= 30000
        // Before 3.0 a host that is told so aborts where open() fails.
        if (feature == "procedural") return true;
#endif
        return feature == "arbitrary_metadata" || feature == "exif" || feature == "iptc" ||
               feature == "mipmap" || feature == "multiimage";
    }

    bool valid_file(const std::string& name) const override {
        return operation_of(name) || has_extension(name, kBufferExtension);
    }

    bool open(const std::string& name, ImageSpec& spec) override {
        return open(name, spec, ImageSpec());
    }

    bool open(const std::string& name, ImageSpec& spec, const ImageSpec& config) override {
        // The extension first: OpenImageIO offers names of all kinds.
        if (!valid_file(name)) return failed("not a " + joined_extensions() + " name");
        const Inside inside;
        try {
            const PoolWorker worker;
            close();
            const Operation* operation = operation_of(name);
            std::shared_ptr<const Content> content =
                operation ? open_recipe(name, assignments_of(config.extra_attribs, operation->name + ":"))
                          : open_buffer(name);
            const lock_guard lock(*this);
            m_content = std::move(content);
            m_subimage = m_level = 0;
            // What another picture of ours reads is read as far as it needs.
            m_in_scanlines = Inside::depth() == 1 && copies_tiles() && m_content->prefers_scanlines();
            m_spec = spec = shown_spec(m_content->spec(0, 0));
            return true;
        } catch (const std::exception& e) {
            const std::string reason = message_of(e, "\"" + printable(name) + "\"");
            if (Inside::depth() == 1) explain_to_oiiotool(name, reason);
            return failed(reason);
        }
    }

    bool close() override {
        const lock_guard lock(*this);
        m_content.reset();
        m_subimage = m_level = -1;
        m_spec = ImageSpec();
        return true;
    }

    int current_subimage() const override {
        const lock_guard lock(*this);
        return m_subimage;
    }
    int current_miplevel() const override {
        const lock_guard lock(*this);
        return m_level;
    }

    bool seek_subimage(int subimage, int miplevel) override {
        const lock_guard lock(*this);
        bool is_there = false;
        // A part of a source is looked at when it is asked for.
        const bool done = guarded([&] {
            if (!m_content || !has_level(*m_content, subimage, miplevel)) return;
            is_there = true;
            if (subimage != m_subimage || miplevel != m_level)
                m_spec = shown_spec(m_content->spec(subimage, miplevel));
            m_subimage = subimage;
            m_level = miplevel;
        });
        return done && is_there;
    }

    bool read_native_scanline(int subimage, int miplevel, int y, int, void* data) override {
        return guarded([&] { read_rows(subimage, miplevel, y, y + 1, data); });
    }
    bool read_native_scanlines(int subimage, int miplevel, int ybegin, int yend, int, void* data) override {
        return guarded([&] { read_rows(subimage, miplevel, ybegin, yend, data); });
    }
    bool read_native_scanlines(int subimage, int miplevel, int ybegin, int yend, int, int chbegin, int chend,
                               void* data) override {
        // Some rows at a time, all channels at once: the default does it row by row.
        return guarded([&] {
            const std::shared_ptr<const Content> open = content();
            const ImageSpec& spec = level_spec(*open, subimage, miplevel);
            if (chbegin < 0 || chend > spec.nchannels || chbegin >= chend)
                throw Error("channels " + std::to_string(chbegin) + " to " + std::to_string(chend) +
                            ": must be from 0 to " + std::to_string(spec.nchannels));
            if (chend - chbegin == spec.nchannels) return read_rows(subimage, miplevel, ybegin, yend, data);
            constexpr int kRows = 256;
            const std::size_t pixel = spec.pixel_bytes(true), part = spec.pixel_bytes(chbegin, chend, true);
            const std::size_t before = chbegin > 0 ? spec.pixel_bytes(0, chbegin, true) : 0;
            const std::size_t row = pixel * static_cast<std::size_t>(spec.width);
            std::vector<std::byte> all(row * kRows);
            auto* to = static_cast<std::byte*>(data);
            for (int y = ybegin; y < yend; y += kRows) {
                const int end = std::min(yend, y + kRows);
                read_rows(subimage, miplevel, y, end, all.data());
                const std::byte* from = all.data() + before;
                for (std::size_t n = row * static_cast<std::size_t>(end - y) / pixel; n > 0; --n) {
                    std::memcpy(to, from, part);
                    to += part;
                    from += pixel;
                }
            }
        });
    }
    bool read_native_tile(int subimage, int miplevel, int x, int y, int, void* data) override {
        // A tile's buffer is always a whole one.
        return guarded([&] {
            const std::shared_ptr<const Content> open = content();
            const ImageSpec& spec = level_spec(*open, subimage, miplevel);
            if (spec.tile_width == 0 || m_in_scanlines) throw Error("the picture has no tiles (tile=0)");
            read_box(*open, subimage, miplevel, {x, y, x + spec.tile_width, y + spec.tile_height}, data);
        });
    }
    bool read_native_tiles(int subimage, int miplevel, int xbegin, int xend, int ybegin, int yend, int, int,
                           void* data) override {
        return guarded([&] {
            const std::shared_ptr<const Content> open = content();
            level_spec(*open, subimage, miplevel);
            read_box(*open, subimage, miplevel, {xbegin, ybegin, xend, yend}, data);
        });
    }

  private:
    void read_rows(int subimage, int miplevel, int begin, int end, void* data) const {
        const std::shared_ptr<const Content> open = content();
        const ImageSpec& spec = level_spec(*open, subimage, miplevel);
        if (end > spec.y + spec.height)
            throw Error("rows up to " + std::to_string(end) + ": must be up to " +
                        std::to_string(spec.y + spec.height));
        read_box(*open, subimage, miplevel, {spec.x, begin, spec.x + spec.width, end}, data);
    }

    /// `box` in the file's coordinates.
    static void read_box(const Content& content, int subimage, int miplevel, const Box& box, void* data) {
        const ImageSpec& spec = content.spec(subimage, miplevel);
        const Box local{box.x0 - spec.x, box.y0 - spec.y, box.x1 - spec.x, box.y1 - spec.y};
        if (local.empty() || local.x0 < 0 || local.y0 < 0 || local.x0 >= spec.width ||
            local.y0 >= spec.height)
            throw Error("pixels " + std::to_string(box.width()) + "x" + std::to_string(box.height()) + "+" +
                        std::to_string(box.x0) + "+" + std::to_string(box.y0) + " lie outside the image of " +
                        std::to_string(spec.width) + "x" + std::to_string(spec.height));
        content.read(subimage, miplevel, local, static_cast<std::byte*>(data));
    }

    std::shared_ptr<const Content> content() const {
        const lock_guard lock(*this);
        if (!m_content) throw Error("the file is not open");
        return m_content;
    }
    static bool has_level(const Content& content, int subimage, int miplevel) {
        return subimage >= 0 && subimage < content.subimages() && miplevel >= 0 &&
               miplevel < content.levels(subimage);
    }
    static const ImageSpec& level_spec(const Content& content, int subimage, int miplevel) {
        if (!has_level(content, subimage, miplevel))
            throw Error("subimage " + std::to_string(subimage) + ", MIP level " + std::to_string(miplevel) +
                        ": there are " + std::to_string(content.subimages()) + " and " +
                        std::to_string(content.levels(0)));
        return content.spec(subimage, miplevel);
    }

    bool failed(const std::string& message) {
        errorfmt("anamorph: {}", message);
        return false;
    }
    template <class Body>
    bool guarded(const Body& body) {
        const Inside inside;
        try {
            const PoolWorker worker;
            body();
            return true;
        } catch (const std::exception& e) {
            return failed(message_of(e, "the picture"));
        }
    }

    ImageSpec shown_spec(const ImageSpec& spec) const {
        ImageSpec shown = spec;
        if (m_in_scanlines) shown.tile_width = shown.tile_height = 0;
        return shown;
    }

    std::shared_ptr<const Content> m_content;
    int m_subimage = -1, m_level = -1;
    bool m_in_scanlines = false;
};

class BufferOutput final : public ImageOutput {
  public:
    ~BufferOutput() override { close(); }

    const char* format_name() const override { return kFormat; }

    int supports(OIIO::string_view feature) const override {
        // Procedural: hosts do not rename a file that is none.
        for (const char* has :
             {"procedural", "alpha", "nchannels", "random_access", "rewrite", "displaywindow", "origin",
              "negativeorigin", "arbitrary_metadata", "exif", "iptc"})
            if (feature == has) return true;
        return false;
    }

    bool open(const std::string& name, const ImageSpec& spec, OpenMode mode) override {
        if (mode != Create) return failed("an image in memory has one subimage and one level");
        if (spec.deep || spec.depth > 1) return failed("must be a flat image");
        if (spec.width < 1 || spec.height < 1 || spec.nchannels < 1) return failed("the image has no pixels");
        m_name = name;
        m_spec = spec;
        m_spec.channelformats.clear();
        m_spec.tile_width = m_spec.tile_height = 0;
        m_image = std::make_shared<OIIO::ImageBuf>(m_spec, OIIO::InitializePixels::Yes);
        if (m_image->localpixels()) return true;
        m_image.reset();
        return failed("no memory for the image");
    }

    bool write_scanline(int y, int, OIIO::TypeDesc format, const void* data,
                        OIIO::stride_t xstride) override {
        if (!m_image) return failed("the file is not open");
        const OIIO::ROI row(m_spec.x, m_spec.x + m_spec.width, y, y + 1);
        return m_image->set_pixels(row, format, data, xstride) || failed(m_image->geterror());
    }

    bool close() override {
        if (m_image) store_buffer(m_name, std::move(m_image));
        m_image.reset();
        return true;
    }

  private:
    bool failed(const std::string& message) {
        errorfmt("anamorph: {}", message);
        return false;
    }

    std::string m_name;
    std::shared_ptr<OIIO::ImageBuf> m_image;
};

}  // namespace

/// As OpenImageIO reads them: names one after the other, and null after the last.
struct Extensions {
    static constexpr std::size_t kMost = 64;
    const char* names[kMost] = {};

    Extensions() {
        std::size_t count = 0;
        const auto add = [&](const std::string& name) {
            if (count + 1 < kMost) names[count++] = name.c_str();
        };
        static const std::string buffers(kBufferExtension.substr(1));
        for (const Operation* operation : operations()) add(operation->name);
        add(buffers);
        for (const Operation* operation : operations())
            for (const std::string& ending : operation->endings) add(ending);
    }
};

}  // namespace anamorph

OIIO_PLUGIN_EXPORTS_BEGIN

OIIO_EXPORT int anamorph_recipes_imageio_version = OIIO_PLUGIN_VERSION;

OIIO_EXPORT const char* anamorph_recipes_imageio_library_version() {
    static const std::string text = std::string("Anamorph ") + anamorph::version();
    return text.c_str();
}

OIIO_EXPORT OIIO::ImageInput* anamorph_recipes_input_imageio_create() {
    return new anamorph::FileInput;
}
OIIO_EXPORT anamorph::Extensions anamorph_recipes_input_extensions;

OIIO_EXPORT OIIO::ImageOutput* anamorph_recipes_output_imageio_create() {
    return new anamorph::BufferOutput;
}
OIIO_EXPORT const char* anamorph_recipes_output_extensions[] = {"anabuf", nullptr};

OIIO_PLUGIN_EXPORTS_END
