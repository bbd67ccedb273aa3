// SPDX-License-Identifier: Apache-2.0
#include "picture_writer.h"

#include <OpenImageIO/filesystem.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <future>
#include <memory>
#include <string_view>
#include <utility>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/open_image.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/picture_tiles.h"
#include "output_file.h"

namespace anamorph::command {

using OIIO::ImageSpec;

namespace {

/// The words that OpenImageIO's writer of a format knows, and the numbers that may follow them: it passes over what it does not know.
struct Packings {
    std::string_view format;
    std::vector<std::string_view> words;
    int least, most;
};
const Packings* packings_of(std::string_view format) {
    static const std::vector<Packings> all = {
        {"png", {"zip", "filtered", "huffman", "rle", "fixed"}, 0, 9},
        {"openexr", {"zip", "zips", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab", "rle", "none"}, 0, 10000},
        {"tiff", {"zip", "lzw", "packbits", "jpeg", "ccittrle", "none"}, 0, 100},
        {"jpeg", {"jpeg"}, 1, 100},
        {"webp", {"webp", "lossless"}, 0, 100},
        {"heif", {"heic", "avif"}, 0, 100},
    };
    const auto found =
        std::find_if(all.begin(), all.end(), [&](const Packings& p) { return p.format == format; });
    return found == all.end() ? nullptr : &*found;
}

/// "zip:4" as its word and its number, -1 where there is none. Throws Error where a format does not know it.
std::pair<std::string, int> packing_of(const std::string& text, std::string_view format) {
    const Packings* const known = packings_of(format);
    if (!known)
        throw Error("--compression", printable(text),
                    "must not be given for a file of the format " + std::string(format));
    const std::size_t colon = std::min(text.find(':'), text.size());
    const std::string word = text.substr(0, colon);
    int number = -1;
    if (colon < text.size()) {
        const char *const first = text.data() + colon + 1, *const end = text.data() + text.size();
        if (std::from_chars(first, end, number).ptr != end) number = -1;
    }
    const bool has_word = std::find(known->words.begin(), known->words.end(), word) != known->words.end();
    const bool has_number = colon == text.size() || (known->least <= number && number <= known->most);
    if (has_word && has_number) return {word, number};
    std::string words;
    for (const std::string_view each : known->words) words += (words.empty() ? "" : ", ") + std::string(each);
    throw Error("--compression", printable(text),
                "must be one of " + words + " for the format " + std::string(format) +
                    ", alone or with a number from " + std::to_string(known->least) + " to " +
                    std::to_string(known->most) + ", such as " + std::string(known->words[0]) + ":4");
}

void set_compression(const OIIO::ImageOutput& out, const PictureFile& file, ImageSpec& spec) {
    const std::string_view format = out.format_name();
    if (format != "png") {
        if (file.compression) {
            packing_of(*file.compression, format);
            spec.attribute("compression", *file.compression);
        }
        return;
    }
    const auto [word, level] = packing_of(file.compression.value_or("rle"), format);
    spec.attribute("compression", word == "zip" ? "default" : word);
    if (level >= 0) spec.attribute("png:compressionLevel", level);
}

/// Has a format numbers of the type float, in any number of channels?
bool holds_float(std::string_view format) {
    return format == "openexr" || format == "tiff" || format == "fits";
}

/// A file that is no plain one to OpenImageIO: into such libjpeg writes by itself, and ends the program where there is no room.
class OwnFile final : public OIIO::Filesystem::IOFile {
  public:
    explicit OwnFile(std::FILE* file) : IOFile(file, Write) {}
    const char* proxytype() const override { return "anamorph"; }
};

/// A writer, and its file where its format is one whose writer does not notice that it is cut off: that is then seen here. Other writers may
/// need to read what they wrote, as that of TIFF does.
class WatchedWriter {
  public:
    WatchedWriter(std::unique_ptr<OIIO::ImageOutput> out, const std::string& path) : m_out(std::move(out)) {
        const std::string_view format = m_out->format_name();
        if ((format != "png" && format != "jpeg") || !m_out->supports("ioproxy") ||
            !std::filesystem::is_regular_file(path))
            return;
        m_file = std::fopen(path.c_str(), "w+b");
        if (!m_file) return;
        m_proxy = std::make_unique<OwnFile>(m_file);
        if (!m_out->set_ioproxy(m_proxy.get())) end();
    }
    ~WatchedWriter() {
        m_out.reset();
        end();
    }
    WatchedWriter(const WatchedWriter&) = delete;
    WatchedWriter& operator=(const WatchedWriter&) = delete;

    OIIO::ImageOutput& out() const { return *m_out; }
    bool watches() const { return m_file != nullptr; }
    /// Ends the writer, and says whether all that it wrote is in the file that is watched.
    bool close() {
        m_out.reset();
        const bool failed = m_file && std::ferror(m_file) != 0;
        return end() && !failed;
    }

  private:
    bool end() {
        m_proxy.reset();
        std::FILE* const file = std::exchange(m_file, nullptr);
        return !file || std::fclose(file) == 0;
    }

    std::FILE* m_file = nullptr;
    std::unique_ptr<OwnFile> m_proxy;
    std::unique_ptr<OIIO::ImageOutput> m_out;
};

/// Why a file could not be written, where OpenImageIO has no word for it.
std::string why_cut_off(const std::string& file) {
    const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
    constexpr std::uintmax_t kNext = 1 << 20;
    std::error_code unknown;
    const std::filesystem::space_info space = std::filesystem::space(folder, unknown);
    return !unknown && space.available < kNext ? std::strerror(ENOSPC)
                                               : "it cannot be written as far as it goes";
}

std::string why_not(const OIIO::ImageOutput& out, const std::string& file) {
    const std::string why = out.geterror();
    return why.empty() ? why_cut_off(file) : why;
}

/// Is the last row in a file? Not every writer of OpenImageIO sees that it is cut off.
bool has_last_row(const std::string& path, const std::string& format, const ImageSpec& spec) {
    const std::unique_ptr<OIIO::ImageInput> file = open_image(path);
    if (!file) return !OIIO::ImageInput::create(format);  // not all that is written can be read
    std::vector<std::byte> row(file->spec().scanline_bytes(true));
    return file->spec().height == spec.height &&
           file->read_native_scanline(0, 0, file->spec().y + spec.height - 1, 0, row.data());
}

/// Writes the rows of tiles that `rows` makes: each while the next is made, where there are threads for it.
void write_rows(OIIO::ImageOutput& out, const ImageSpec& spec, const std::string& output,
                const std::function<void(std::int64_t row, std::vector<std::byte>& pixels)>& rows) {
    const TileGrid tiles = tiles_of(spec);
    const OIIO::TypeDesc format = spec.channelformats.empty() ? spec.format : OIIO::TypeDesc();
    const bool behind = OIIO::get_int_attribute("threads") != 1;
    std::array<std::vector<std::byte>, 2> buffers;
    std::future<void> written;  // ends before what it reads
    for (std::int64_t row = 0; row < tiles.rows(); ++row) {
        std::vector<std::byte>& pixels = buffers[behind ? static_cast<std::size_t>(row % 2) : 0];
        pixels.resize(spec.pixel_bytes(true) * static_cast<std::size_t>(spec.width) * TileGrid::kSide);
        rows(row, pixels);
        if (written.valid()) written.get();
        const int y = static_cast<int>(row) * TileGrid::kSide,
                  end = std::min(spec.height, y + TileGrid::kSide);
        const auto write = [&out, &spec, &output, &pixels, format, y, end] {
            if (!out.write_scanlines(spec.y + y, spec.y + end, 0, format, pixels.data()))
                throw Error(printable(output) + ": " + why_not(out, output));
        };
        // Where no thread is to be had, get() does it.
        if (behind)
            written = std::async(std::launch::async | std::launch::deferred, write);
        else
            write();
    }
    if (written.valid()) written.get();
}

/// Does a name end as files of films do?
bool is_film(const std::string& name) {
    const std::string ending = OIIO::Strutil::lower(OIIO::Filesystem::extension(name));
    return ending == ".mp4" || ending == ".mov" || ending == ".mkv" || ending == ".avi" || ending == ".webm";
}

}  // namespace

void write_picture(const ImageSpec& picture, const PictureFile& file,
                   const std::function<void(std::int64_t row, std::vector<std::byte>& pixels)>& rows) {
    const std::string& output = file.name;
    ImageSpec spec = picture;
    spec.tile_width = spec.tile_height = 0;
    std::unique_ptr<OIIO::ImageOutput> out = OIIO::ImageOutput::create(output);
    if (!out && is_film(output))
        throw Error("--output", printable(output),
                    "must be a picture: films are drawn as numbered ones, turn.{frame}.png, of which ffmpeg "
                    "makes one");
    if (!out) throw Error(OIIO::geterror());
    set_compression(*out, file, spec);
    const std::string format = out->format_name();
    if (file.in_float && !holds_float(format))
        throw Error("--output", printable(output),
                    "must be of a format that holds float, such as .exr or .tif");
    OutputFile whole(output);
    const std::string path = whole.path();
    WatchedWriter writer(std::move(out), path);
    if (!writer.out().open(path, spec)) throw Error(printable(output) + ": " + writer.out().geterror());
    write_rows(writer.out(), spec, output, rows);
    if (!writer.out().close()) throw Error(printable(output) + ": " + why_not(writer.out(), output));
    const bool watched = writer.watches();
    // OpenImageIO's writer of EXR leaves the file of an environment open until it ends itself, for further levels.
    if (!writer.close() || (!watched && !has_last_row(path, format, spec)))
        throw Error(printable(output) + ": " + why_cut_off(output));
    whole.close();
}

}  // namespace anamorph::command
