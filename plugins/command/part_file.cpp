// SPDX-License-Identifier: Apache-2.0
#include "part_file.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::command {

using OIIO::ImageSpec;

namespace {

const char* const kFirstLine = "anamorph part 1";

std::string manifest_of(const std::string& file) {
    return file + ".tiles";
}

/// Throws unless `file` is a part or may become one: what else stands there is somebody's.
void expect_part_or_nothing(const std::string& file) {
    const std::string name = manifest_of(file), first = kFirstLine;
    std::ifstream manifest(name, std::ios::binary);
    std::string begin(first.size(), '\0');
    manifest.read(begin.data(), std::ssize(begin));
    begin.resize(static_cast<std::size_t>(manifest.gcount()));
    if (!first.starts_with(begin))
        throw Error(printable(name) + " is there, and no part of a picture: must be another name");
    std::error_code none;
    if (!manifest.is_open() && std::filesystem::file_size(file, none) > 0 && !none)
        throw Error(printable(file) + " is there, and no part of a picture, which has a " +
                    printable(std::filesystem::path(name).filename().string()) + ": must be another name");
}

/// A recipe's name as one line.
std::string one_line(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return static_cast<unsigned char>(c) < ' '; }, ' ');
    return text;
}

std::string digits_of(const std::string& text) {
    PictureHasher hasher;
    hasher.add(text);
    return hash_digits(hasher.hash());
}

/// What stands in a manifest before its tiles.
struct PartHead {
    std::string recipe, state;
    Share share;
    ImageSpec spec;

    std::string text() const {
        const std::string xml = spec.to_xml();
        const TileGrid tiles = tiles_of(spec);
        return std::string(kFirstLine) + "\nrecipe " + recipe + "\nstate " + state + "\npart " +
               std::to_string(share.index) + " " + std::to_string(share.count) + "\nspec " +
               std::to_string(xml.size()) + "\n" + xml + "\ntiles " +
               std::to_string(share.end(tiles.count()) - share.begin(tiles.count())) + "\n";
    }
};

/// A manifest that was read.
struct Manifest {
    PartHead head;
    std::int64_t begin = 0, end = 0;   ///< tiles of the part
    std::vector<PictureHash> written;  ///< hashes of those that are there
    bool ends_whole = false;           ///< with a whole line
};

class ManifestReader {
  public:
    ManifestReader(const std::string& file, const std::string& text) : m_file(file), m_text(text) {}

    Manifest read() {
        Manifest m;
        if (line() != kFirstLine) refuse("it does not begin with \"" + std::string(kFirstLine) + "\"");
        m.head.recipe = after("recipe ");
        m.head.state = after("state ");
        std::istringstream numbers(after("part "));
        if (!(numbers >> m.head.share.index >> m.head.share.count) || m.head.share.index < 1 ||
            m.head.share.index > m.head.share.count || m.head.share.count > kMostParts)
            refuse("its part is none of I of N");
        read_spec(m.head.spec);
        const TileGrid tiles = tiles_of(m.head.spec);
        m.begin = m.head.share.begin(tiles.count());
        m.end = m.head.share.end(tiles.count());
        if (after("tiles ") != std::to_string(m.end - m.begin))
            refuse("it has another number of tiles than its part");
        while (m_text.find('\n', m_at) != std::string::npos) {
            const std::int64_t i = m.begin + std::ssize(m.written);
            const std::string tile = line(), number = std::to_string(i) + " ";
            if (!tile.starts_with(number) || i >= m.end) refuse("its tiles do not follow each other");
            m.written.push_back(hash_from_digits(tile.substr(number.size()),
                                                 m_file + ": the hash of tile " + std::to_string(i)));
        }
        m.ends_whole = m_at == m_text.size();
        return m;
    }

  private:
    [[noreturn]] void refuse(const std::string& why) const {
        throw Error(printable(m_file) + " is no part of a picture: " + why);
    }
    std::string line() {
        const std::size_t end = m_text.find('\n', m_at);
        if (end == std::string::npos) refuse("it ends too early");
        const std::string found = m_text.substr(m_at, end - m_at);
        m_at = end + 1;
        return found;
    }
    std::string after(const std::string& word) {
        const std::string found = line();
        if (!found.starts_with(word)) refuse("a line does not begin with \"" + word + "\"");
        return found.substr(word.size());
    }
    void read_spec(ImageSpec& spec) {
        const std::string bytes = after("spec ");
        std::size_t size = 0;
        const auto [end, error] = std::from_chars(bytes.data(), bytes.data() + bytes.size(), size);
        if (error != std::errc() || *end != '\0' || size > m_text.size() - m_at) refuse("it ends too early");
        spec.from_xml(m_text.substr(m_at, size).c_str());
        m_at += size;
        constexpr int kMost = 1 << 20, kMostChannels = 4096;
        if (!line().empty() || spec.width < 1 || spec.width > kMost || spec.height < 1 ||
            spec.height > kMost || spec.nchannels < 1 || spec.nchannels > kMostChannels ||
            spec.format.size() < 1)
            refuse("it says no picture");
    }

    std::string m_file;
    const std::string& m_text;
    std::size_t m_at = 0;
};

std::string text_of(const std::string& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) throw Error(printable(file) + ": there is no such file");
    std::ostringstream text;
    text << in.rdbuf();
    return text.str();
}

Manifest read_manifest(const std::string& file) {
    const std::string name = manifest_of(file), text = text_of(name);
    return ManifestReader(name, text).read();
}

std::size_t bytes_of(const ImageSpec& spec, const Box& box) {
    return spec.pixel_bytes(true) * static_cast<std::size_t>(box.width()) *
           static_cast<std::size_t>(box.height());
}

/// A file that is open for reading and writing.
class OpenFile {
  public:
    OpenFile(const std::string& name, int flags)
        : m_name(name), m_file(open(name.c_str(), flags | O_CLOEXEC, 0666)) {
        if (m_file < 0) fail();
    }
    ~OpenFile() { ::close(m_file); }
    OpenFile(const OpenFile&) = delete;
    OpenFile& operator=(const OpenFile&) = delete;

    [[noreturn]] void fail() const { throw Error(printable(m_name) + ": " + std::strerror(errno)); }
    /// Nobody else may write it.
    void lock() const {
        if (flock(m_file, LOCK_EX | LOCK_NB) != 0)
            throw Error(printable(m_name) + ": another process is drawing it");
    }
    void cut(std::size_t bytes) const {
        if (ftruncate(m_file, static_cast<off_t>(bytes)) != 0 ||
            lseek(m_file, static_cast<off_t>(bytes), SEEK_SET) < 0)
            fail();
    }
    void write(const void* data, std::size_t bytes) const {
        for (const auto* at = static_cast<const std::byte*>(data); bytes > 0;) {
            const ssize_t done = ::write(m_file, at, bytes);
            if (done < 0 && errno == EINTR) continue;
            if (done <= 0) fail();
            at += done;
            bytes -= static_cast<std::size_t>(done);
        }
    }
    /// False where the file ends before.
    bool read(void* data, std::size_t bytes) const {
        for (auto* at = static_cast<std::byte*>(data); bytes > 0;) {
            const ssize_t done = ::read(m_file, at, bytes);
            if (done < 0 && errno == EINTR) continue;
            if (done < 0) fail();
            if (done == 0) return false;
            at += done;
            bytes -= static_cast<std::size_t>(done);
        }
        return true;
    }
    void finish() const {
        if (fsync(m_file) != 0 && errno != EINVAL) fail();
    }

  private:
    std::string m_name;
    int m_file;
};

/// How many of the tiles that a manifest names stand in the file with their hashes, from the first on, and how many bytes they are.
std::pair<std::size_t, std::size_t> intact(const OpenFile& file, const Manifest& m) {
    const TileGrid tiles = tiles_of(m.head.spec);
    std::vector<std::byte> pixels;
    std::size_t bytes = 0;
    for (std::size_t k = 0; k < m.written.size(); ++k) {
        const Box box = tiles.box(m.begin + static_cast<std::int64_t>(k));
        pixels.resize(bytes_of(m.head.spec, box));
        const std::size_t row = pixels.size() / static_cast<std::size_t>(box.height());
        if (!file.read(pixels.data(), pixels.size()) ||
            hashed_picture(m.head.spec).hash_of_tile(pixels.data(), row, box.width(), box.height()) !=
                m.written[k])
            return {k, bytes};
        bytes += pixels.size();
    }
    return {m.written.size(), bytes};
}

std::string tile_line(std::int64_t i, const PictureHash& hash) {
    return std::to_string(i) + " " + hash_digits(hash) + "\n";
}

/// What is left of a part that was begun: how many tiles of it need not be drawn again. Both files are cut there.
std::int64_t take_up(const PartHead& head, const OpenFile& pixels, const OpenFile& manifest,
                     const std::string& text, const std::string& name) {
    const std::string begin = head.text();
    if (text.starts_with(begin)) {
        Manifest m = ManifestReader(name, text).read();
        const auto [tiles, bytes] = intact(pixels, m);
        std::string lines = begin;
        for (std::size_t k = 0; k < tiles; ++k)
            lines += tile_line(m.begin + static_cast<std::int64_t>(k), m.written[k]);
        manifest.cut(lines.size());
        pixels.cut(bytes);
        return static_cast<std::int64_t>(tiles);
    }
    pixels.cut(0);
    manifest.cut(0);
    manifest.write(begin.data(), begin.size());
    return 0;
}

/// The only picture of a recipe.
ImageSpec single_spec(PictureReader& picture, const std::string& recipe) {
    if (picture.subimages() != 1)
        throw Error(printable(recipe) + " has " + std::to_string(picture.subimages()) +
                    " pictures: must be one (frame=, or subimage= of a source of several parts)");
    return picture.spec(0);
}

/// Copies a box that was read, packed, to where it stands among whole rows.
void copy_to_rows(const ImageSpec& spec, const Box& box, const std::byte* from,
                  std::vector<std::byte>& rows) {
    const std::size_t pixel = spec.pixel_bytes(true), bytes = pixel * static_cast<std::size_t>(box.width()),
                      stride = pixel * static_cast<std::size_t>(spec.width);
    std::byte* to = rows.data() + pixel * static_cast<std::size_t>(box.x0);
    for (int y = box.y0; y < box.y1; ++y, from += bytes, to += stride) std::memcpy(to, from, bytes);
}

}  // namespace

Share share_of(const std::string& text) {
    Share share;
    const char *at = text.data(), *stop = at + text.size();
    const auto first = std::from_chars(at, stop, share.index);
    bool right = first.ec == std::errc() && first.ptr != stop && *first.ptr == '/';
    if (right) {
        const auto second = std::from_chars(first.ptr + 1, stop, share.count);
        right = second.ec == std::errc() && second.ptr == stop;
    }
    if (!right || share.index < 1 || share.index > share.count || share.count > kMostParts)
        throw Error("--part", printable(text),
                    "must be I/N, N from 1 to " + std::to_string(kMostParts) + " and I from 1 to N");
    return share;
}

std::int64_t draw_part(const std::string& recipe, const Share& share, const std::string& file) {
    const std::unique_ptr<PictureReader> picture = open_picture(recipe);
    PartHead head{one_line(recipe), digits_of(recipe + "\n" + picture->state()), share,
                  single_spec(*picture, recipe)};
    const ImageSpec& spec = head.spec;
    const TileGrid tiles = tiles_of(spec);
    const std::string name = manifest_of(file);
    expect_part_or_nothing(file);
    const OpenFile pixels(file, O_RDWR | O_CREAT);
    pixels.lock();
    const OpenFile manifest(name, O_RDWR | O_CREAT);
    const std::int64_t begin = share.begin(tiles.count()), end = share.end(tiles.count());
    const std::int64_t there = take_up(head, pixels, manifest, text_of(name), name);
    std::vector<std::byte> drawn, tile;
    for (std::int64_t i = begin + there, n = 0; i < end; i += n) {
        n = tiles.together(i, end);
        const Box box = tiles.box(i, n);
        drawn.resize(bytes_of(spec, box));
        picture->read(0, box, drawn.data());
        const std::size_t pixel = spec.pixel_bytes(true),
                          stride = pixel * static_cast<std::size_t>(box.width());
        for (std::int64_t k = 0; k < n; ++k) {
            const Box part = tiles.box(i + k);
            const std::size_t row = pixel * static_cast<std::size_t>(part.width());
            tile.resize(row * static_cast<std::size_t>(part.height()));
            const std::byte* from = drawn.data() + pixel * static_cast<std::size_t>(part.x0 - box.x0);
            for (int y = 0; y < part.height(); ++y)
                std::memcpy(tile.data() + row * static_cast<std::size_t>(y),
                            from + stride * static_cast<std::size_t>(y), row);
            // A line of the manifest says that its tile is there.
            pixels.write(tile.data(), tile.size());
            const std::string line = tile_line(
                i + k, hashed_picture(spec).hash_of_tile(tile.data(), row, part.width(), part.height()));
            manifest.write(line.data(), line.size());
        }
    }
    pixels.finish();
    manifest.finish();
    return end - begin - there;
}

PictureHash join_parts(std::vector<std::string> files, const PictureFile& output) {
    std::vector<Manifest> parts;
    for (const std::string& file : files) parts.push_back(read_manifest(file));
    std::vector<std::size_t> order(parts.size());
    for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
        return parts[a].head.share.index < parts[b].head.share.index;
    });
    const Manifest& first = parts.at(order[0]);
    const ImageSpec spec = first.head.spec;
    const std::string text = hashed_picture(spec).text();
    for (std::size_t k = 0; k < order.size(); ++k) {
        const Manifest& m = parts[order[k]];
        const std::string name = printable(files[order[k]]);
        if (m.head.share.count != first.head.share.count || m.head.recipe != first.head.recipe ||
            hashed_picture(m.head.spec).text() != text)
            throw Error(name + " is a part of another picture than " + printable(files[order[0]]));
        if (m.head.state != first.head.state)
            throw Error(name +
                        " was drawn when the recipe or its files, by their names, sizes and times, were "
                        "others than for " +
                        printable(files[order[0]]) + ": must be drawn anew");
        if (m.head.share.index != static_cast<int>(k) + 1)
            throw Error(m.head.share.index == static_cast<int>(k)
                            ? name + " is part " + std::to_string(k) + " a second time"
                            : "part " + std::to_string(k + 1) + " of " + std::to_string(m.head.share.count) +
                                  " is missing");
        if (std::ssize(m.written) != m.end - m.begin)
            throw Error(name + " is not finished: it has " + std::to_string(m.written.size()) + " of " +
                        std::to_string(m.end - m.begin) + " tiles");
        if (!m.ends_whole) throw Error(name + " is no part of a picture: something follows its last tile");
    }
    if (static_cast<int>(order.size()) != first.head.share.count)
        throw Error("part " + std::to_string(order.size() + 1) + " of " +
                    std::to_string(first.head.share.count) + " is missing");

    const TileGrid tiles = tiles_of(spec);
    FileHasher hasher;
    hasher.begin(hashed_picture(spec));
    std::size_t part = 0;
    std::unique_ptr<OpenFile> file;
    std::int64_t at = 0;
    std::vector<std::byte> tile;
    const auto next_tile = [&]() -> Box {
        while (!file || at == parts[order[part]].end) {
            if (file) ++part;
            file = std::make_unique<OpenFile>(files[order[part]], O_RDONLY);
        }
        const Manifest& m = parts[order[part]];
        const Box box = tiles.box(at);
        tile.resize(bytes_of(spec, box));
        const PictureHash& said = m.written[static_cast<std::size_t>(at - m.begin)];
        if (!file->read(tile.data(), tile.size()) ||
            hashed_picture(spec).hash_of_tile(tile.data(),
                                              tile.size() / static_cast<std::size_t>(box.height()),
                                              box.width(), box.height()) != said)
            throw Error(printable(files[order[part]]) + ": tile " + std::to_string(at) +
                        " has not the hash " + hash_digits(said) + ": the file was changed or cut off");
        hasher.add(said);
        ++at;
        return box;
    };
    if (output.name.empty()) {
        while (at < tiles.count()) next_tile();
        return hasher.hash();
    }
    write_picture(spec, output, [&](std::int64_t, std::vector<std::byte>& rows) {
        for (std::int64_t k = 0; k < tiles.columns(); ++k) {
            const Box box = next_tile();
            copy_to_rows(spec, box, tile.data(), rows);
        }
    });
    return hasher.hash();
}

void draw_picture_file(PictureReader& picture, int subimage, const PictureFile& output,
                       const std::function<void(std::int64_t tiles)>& done) {
    const ImageSpec spec = picture.spec(subimage);
    const TileGrid tiles = tiles_of(spec);
    std::vector<std::byte> drawn;
    write_picture(spec, output, [&](std::int64_t row, std::vector<std::byte>& rows) {
        const std::int64_t end = (row + 1) * tiles.columns();
        for (std::int64_t i = row * tiles.columns(), n = 0; i < end; i += n) {
            n = tiles.together(i, end);
            const Box box = tiles.box(i, n);
            drawn.resize(bytes_of(spec, box));
            picture.read(subimage, box, drawn.data());
            copy_to_rows(spec, box, drawn.data(), rows);
            done(n);
        }
    });
}

}  // namespace anamorph::command
