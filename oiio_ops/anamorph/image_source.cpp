// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image_source.h"

#include "anamorph/metadata.h"
#include "anamorph/open_image.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/strutil.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <compare>
#include <cstring>
#include <map>
#include <set>
#include <string_view>
#include <tuple>

#include "anamorph/error.h"
#include "anamorph/file_names.h"
#include "anamorph/image/pixel.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

using OIIO::ImageCache;
using OIIO::ImageSpec;
using OIIO::TypeDesc;

/// The tiles of the process that a cache could not read. It says so once: later it hands them out, and what is in them is by chance.
class BrokenTiles {
  public:
    static BrokenTiles& instance() {
        static auto& tiles = *new BrokenTiles;
        return tiles;
    }
    /// A tile, by the number of its column and row. `file`: the name that the cache knows it by.
    struct Tile {
        OIIO::ustring file;
        int subimage, level, column, row;

        auto operator<=>(const Tile& other) const {
            const auto members = [](const Tile& t) {
                return std::tuple(t.file.c_str(), t.subimage, t.level, t.column, t.row);
            };
            return members(*this) <=> members(other);
        }
    };
    void add(const Tile& tile) {
        const std::lock_guard lock(m_mutex);
        m_tiles.insert(tile);
        m_any = true;
    }
    bool has(const Tile& tile) {
        if (!m_any) return false;
        const std::lock_guard lock(m_mutex);
        return m_tiles.contains(tile);
    }

  private:
    std::atomic<bool> m_any = false;
    std::mutex m_mutex;
    std::set<Tile> m_tiles;
};

/// One of a cache's thread records, borrowed. They are never destroyed: OpenImageIO 2.4 fails when one is and
/// its statistics are asked for afterwards.
class CacheThread {
  public:
    explicit CacheThread(const ImageCacheRef& cache) : m_pool(pool_of(&*cache)) {
        {
            std::lock_guard lock(m_pool.mutex);
            if (!m_pool.idle.empty()) {
                m_record = m_pool.idle.back();
                m_pool.idle.pop_back();
            }
        }
        if (!m_record) m_record = cache->create_thread_info();
        // Lets go of tiles that were purged since.
        m_record = cache->get_perthread_info(m_record);
    }
    ~CacheThread() {
        let_go();
        std::lock_guard lock(m_pool.mutex);
        m_pool.idle.push_back(m_record);
    }
    CacheThread(const CacheThread&) = delete;
    CacheThread& operator=(const CacheThread&) = delete;

    operator ImageCache::Perthread*() const { return m_record; }

    /// A record keeps the last two tiles that it was asked for. One that lies idle or waits while a tile is
    /// made by a recipe would keep them beyond the cache's limit of memory, at which OpenImageIO aborts when
    /// it is passed tenfold: two tiles of a pixel take their place.
    void let_go() const {
        for (ImageCache::ImageHandle* pixel : m_pool.pixels)
            if (ImageCache::Tile* tile =
                    pixel ? m_pool.cache->get_tile(pixel, m_record, 0, 0, 0, 0, 0) : nullptr)
                m_pool.cache->release_tile(tile);
    }

  private:
    struct Pool {
        ImageCache* cache = nullptr;
        std::mutex mutex;
        std::vector<ImageCache::Perthread*> idle;
        ImageCache::ImageHandle* pixels[2] = {};
    };
    static Pool& pool_of(ImageCache* cache) {
        static std::mutex mutex;
        static auto& pools = *new std::map<const ImageCache*, Pool>;
        std::lock_guard lock(mutex);
        Pool& pool = pools[cache];
        if (!pool.cache) {
            pool.cache = cache;
            for (const int i : {0, 1})
                pool.pixels[i] = cache->get_image_handle(OIIO::ustring(
                    "anamorph" + std::to_string(i) + ".null?RES=1x1&TILE=16x16&CHANNELS=1&TYPE=uint8"));
        }
        return pool;
    }

    Pool& m_pool;
    ImageCache::Perthread* m_record = nullptr;
};

std::ptrdiff_t pixel_size(PixelType type, int channels) {
    return std::ptrdiff_t{channels} * size_of(type);
}

/// Zeros for the texels of `box` outside `data`.
void clear_around(const Box& box, const Box& data, std::ptrdiff_t pixel, std::byte* texels,
                  std::ptrdiff_t row_stride) {
    for (int y = box.y0; y < box.y1; ++y) {
        std::byte* row = texels + (y - box.y0) * row_stride;
        const auto clear = [&](int x0, int x1) {
            if (x0 < x1)
                std::memset(row + (x0 - box.x0) * pixel, 0, static_cast<std::size_t>((x1 - x0) * pixel));
        };
        if (data.empty() || y < data.y0 || y >= data.y1) {
            clear(box.x0, box.x1);
        } else {
            clear(box.x0, data.x0);
            clear(data.x1, box.x1);
        }
    }
}

/// A file opened with the cache's own wish for alpha.
std::unique_ptr<OIIO::ImageInput> open_as_cache_does(ImageCache& cache, const std::string& name) {
    int unassociated = 0;
    cache.getattribute("unassociatedalpha", unassociated);
    ImageSpec config;
    config.attribute("oiio:UnassociatedAlpha", unassociated);
    return open_image(name, &config);
}

/// The names of a file's subimages.
std::vector<std::string> names_of_parts(OIIO::ImageInput& file) {
    constexpr int kMost = 1 << 16, kMostNamed = 256;
    std::vector<std::string> names;
    // A film says how many there are, and takes long to say more of each.
    if (const int count = file.spec().get_int_attribute("oiio:subimages"); count > kMostNamed) {
        names.resize(static_cast<std::size_t>(std::min(count, kMost)));
        return names;
    }
    for (int i = 0; i < kMost && file.seek_subimage(i, 0); ++i)
        names.push_back(file.spec().get_string_attribute("oiio:subimagename"));
    static_cast<void>(file.geterror());  // one that is not there is no error
    return names;
}

/// What a cache tells of a MIP level; no format where it cannot. OpenImageIO 3 has the spec of level 0 only,
/// so the windows are asked for: x and y of their first and of their last pixels.
ImageSpec spec_in_cache(ImageCache& cache, OIIO::ustring name, int subimage, int level) {
    static const OIIO::ustring data_window("datawindow"), display_window("displaywindow");
    const TypeDesc corners(TypeDesc::INT, 4);
    ImageSpec spec;
    int data[4], display[4];
    const OpeningLock lock(name.string());
    if (!cache.get_imagespec(name, spec, subimage, 0, true) ||
        !cache.get_image_info(name, subimage, level, data_window, corners, data) ||
        !cache.get_image_info(name, subimage, level, display_window, corners, display))
        return {};
    spec.x = data[0], spec.y = data[1];
    spec.width = data[2] - data[0] + 1, spec.height = data[3] - data[1] + 1;
    spec.full_x = display[0], spec.full_y = display[1];
    spec.full_width = display[2] - display[0] + 1, spec.full_height = display[3] - display[1] + 1;
    return spec;
}

}  // namespace

PixelType pixel_type(TypeDesc type) {
    if (type == OIIO::TypeUInt8) return PixelType::uint8;
    if (type == OIIO::TypeUInt16) return PixelType::uint16;
    return type == OIIO::TypeHalf ? PixelType::half : PixelType::float32;
}

TypeDesc oiio_type(PixelType type) {
    switch (type) {
        case PixelType::uint8:
            return OIIO::TypeUInt8;
        case PixelType::uint16:
            return OIIO::TypeUInt16;
        case PixelType::half:
            return OIIO::TypeHalf;
        case PixelType::float32:
            break;
    }
    return OIIO::TypeFloat;
}

StoredPixels stored_pixels(const ImageSpec& spec) {
    const auto bytes = static_cast<int>(spec.pixel_bytes(true));
    const PixelType type = bytes % size_of(PixelType::float32) == 0  ? PixelType::float32
                           : bytes % size_of(PixelType::uint16) == 0 ? PixelType::uint16
                                                                     : PixelType::uint8;
    return {type, bytes / size_of(type)};
}

bool loses_values(TypeDesc type) {
    return oiio_type(pixel_type(type)) != type;
}

bool loses_values(const ImageSpec& spec) {
    return loses_values(spec.format) || std::any_of(spec.channelformats.begin(), spec.channelformats.end(),
                                                    [](TypeDesc type) { return loses_values(type); });
}

Frame frame_of(const ImageSpec& spec) {
    if (spec.get_string_attribute("textureformat") == "CubeFace Environment" &&
        spec.height == std::int64_t{6} * spec.width)
        return {spec.width, spec.height, {0, 0, spec.width, spec.height}};
    const int left = spec.x - spec.full_x, top = spec.y - spec.full_y;
    return {spec.full_width, spec.full_height, {left, top, left + spec.width, top + spec.height}};
}

SourceLevel Frame::level() const {
    return {
        {width, height},
        {std::min(0, data.x0), std::min(0, data.y0), std::max(width, data.x1), std::max(height, data.y1)}};
}

double pixel_aspect_of(const ImageSpec& spec) {
    const double aspect{spec.get_float_attribute("PixelAspectRatio", 1.0f)};
    // What resolutions that are rounded make of square ones.
    return std::fabs(aspect - 1) <= 1e-4 ? 1 : aspect;
}

int unassociated_alpha_of(const ImageSpec& spec) {
    return spec.get_int_attribute("oiio:UnassociatedAlpha") ? spec.alpha_channel : -1;
}

namespace {

std::string pixels_of(int width, int height) {
    return std::to_string(width) + "x" + std::to_string(height) + " pixels";
}

void check_sides(int width, int height, const std::string& image) {
    constexpr int kMostSide = 1 << 24;
    if (width > kMostSide || height > kMostSide)
        throw Error(image + " has " + pixels_of(width, height) + ": must have 1x1 to " +
                    std::to_string(kMostSide) + "x" + std::to_string(kMostSide));
}

/// Does a name end as those of JPEG files do? Others are not opened once more.
bool is_named_jpeg(const std::string& name) {
    const std::string ending = OIIO::Strutil::lower(OIIO::Filesystem::extension(name, false));
    constexpr std::array kEndings = {"jpg", "jpeg", "jpe", "jif", "jfif", "jfi"};
    return std::find(kEndings.begin(), kEndings.end(), ending) != kEndings.end();
}

}  // namespace

void check_windows(const ImageSpec& spec, const std::string& image) {
    if (spec.width < 1 || spec.height < 1 || spec.full_width < 1 || spec.full_height < 1)
        throw Error(image + " has no pixels");
    check_sides(spec.full_width, spec.full_height, image);
    const auto is_near = [](std::int64_t display, std::int64_t shown, std::int64_t data, int size) {
        return data >= display - kMaxSide && data + size <= display + shown + kMaxSide;
    };
    if (!is_near(spec.full_x, spec.full_width, spec.x, spec.width) ||
        !is_near(spec.full_y, spec.full_height, spec.y, spec.height))
        throw Error(image + " has a data window of " + pixels_of(spec.width, spec.height) + " at " +
                    std::to_string(spec.x) + "," + std::to_string(spec.y) + ": must lie within " +
                    std::to_string(kMaxSide) + " pixels of the display window, " +
                    pixels_of(spec.full_width, spec.full_height) + " at " + std::to_string(spec.full_x) +
                    "," + std::to_string(spec.full_y));
}

void check_source(const ImageSpec& spec, const std::string& name) {
    const std::string image = "source \"" + printable(name) + "\"";
    if (spec.deep) throw Error(image + " is deep: must be a flat image");
    if (spec.depth > 1 || spec.full_depth > 1) throw Error(image + " is a volume: must be a flat image");
    if (spec.nchannels < 1) throw Error(image + " has no pixels");
    check_windows(spec, image);
    const Frame frame = frame_of(spec);
    check_sides(frame.width, frame.height, image);
    constexpr double kMostAspect = 100;
    const double aspect = pixel_aspect_of(spec);
    if (!(aspect >= 1 / kMostAspect && aspect <= kMostAspect))
        throw Error(image + " has PixelAspectRatio=" + shortest(static_cast<float>(aspect)) +
                    ": must be from 0.01 to 100; correct the attribute");
}

std::string reason_of(std::string message, const std::string& name, const std::string& shown) {
    for (std::size_t at = 0; !name.empty() && (at = message.find(name, at)) != std::string::npos;) {
        message.replace(at, name.size(), printable(shown));
        at += printable(shown).size();
    }
    message.resize(std::min(message.size(), message.find('\n')));
    constexpr std::string_view kOurs = "anamorph: ";
    const std::size_t ours = message.rfind(kOurs);
    return ours == std::string::npos ? message : message.substr(ours + kOurs.size());
}

// --- CacheSource -------------------------------------------------------------------------------------------

CacheSource::CacheSource(ImageCacheRef cache, const std::string& name, const std::string& shown, int subimage,
                         int first_level)
    : m_cache(std::move(cache)),
      m_name(name),
      m_shown(shown),
      m_subimage(subimage),
      m_first_level(first_level),
      m_state(content_state(name)) {}

CacheSource::CacheSource(ImageCacheRef cache, const std::string& name, int subimage, int first_level)
    : CacheSource(std::move(cache), name, name, subimage, first_level) {
    read_levels(
        [&](int level) {
            ImageSpec spec = spec_in_cache(*m_cache, m_name, m_subimage, m_first_level + level);
            if (m_subimage == 0 && m_first_level + level == 0 && spec.format != OIIO::TypeUnknown &&
                is_named_jpeg(name))
                add_photo_sphere(spec, name);
            return spec;
        },
        [&] { return m_cache->geterror(); });
}

CacheSource::CacheSource(ImageCacheRef cache, const std::string& name, const std::string& shown, int subimage,
                         const SpecOf& spec_of)
    : CacheSource(std::move(cache), name, shown, subimage, 0) {
    read_levels(spec_of, [] { return std::string(); });
}

CacheSource::CacheSource(ImageCacheRef cache, const std::string& name, const std::string& shown, int subimage)
    : CacheSource(std::move(cache), name, shown, subimage, 0) {
    m_file = open_as_cache_does(*m_cache, name);
    read_levels(
        [&](int level) {
            ImageSpec spec = m_file ? m_file->spec(m_subimage, level) : ImageSpec();
            if (m_subimage == 0 && level == 0 && spec.format != OIIO::TypeUnknown && is_named_jpeg(name))
                add_photo_sphere(spec, name);
            return spec;
        },
        [&] { return m_file ? m_file->geterror() : OIIO::geterror(); });
    if (subimage == 0) m_parts = names_of_parts(*m_file);
}

void CacheSource::read_levels(const SpecOf& spec_of, const std::function<std::string()>& why_not) {
    ImageSpec base = spec_of(0);
    if (base.format == OIIO::TypeUnknown) {
        const std::string why = reason_of(why_not(), m_name.string(), m_shown);
        throw Error("source \"" + printable(m_shown) + "\": " + (why.empty() ? "cannot be read" : why));
    }
    check_source(base, m_shown);
    m_levels.push_back({base, frame_of(base)});
    m_type = pixel_type(base.format);
    m_alpha = unassociated_alpha_of(base);
    m_channels = base.nchannels;

    const auto full = [](const Level& l) {
        return l.frame.data == Box{0, 0, l.frame.width, l.frame.height} && l.spec.width > 0 &&
               l.spec.height > 0;
    };
    // Levels serve while each is half of the one before and has all its pixels.
    for (int level = 1; full(m_levels.back()); ++level) {
        const Frame& before = m_levels.back().frame;
        if (before.width == 1 && before.height == 1) break;
        const ImageSpec spec = spec_of(level);
        const Level next = {spec, frame_of(spec)};
        const bool half = next.frame.width == std::max(1, before.width / 2) &&
                          next.frame.height == std::max(1, before.height / 2);
        if (spec.format == OIIO::TypeUnknown || !half || !full(next) || spec.nchannels != base.nchannels)
            break;
        m_levels.push_back(next);
    }
    why_not();  // a level that is not there is no error
}

std::vector<ImageSpec> CacheSource::specs() const {
    std::vector<ImageSpec> specs;
    for (const Level& level : m_levels) specs.push_back(level.spec);
    return specs;
}

std::string CacheSource::error() const {
    std::lock_guard lock(m_mutex);
    return m_error;
}

bool CacheSource::fail(const std::string& message) const {
    const std::string why = reason_of(message, m_name.string(), m_shown);
    const std::string source = "source \"";
    std::lock_guard lock(m_mutex);
    // A source that is a recipe names the source that failed itself.
    m_error = why.starts_with(source)
                  ? why
                  : source + printable(m_shown) + "\": " + (why.empty() ? "cannot be read" : why);
    return false;
}

bool CacheSource::read(int level, const Box& box, std::byte* texels,
                       std::ptrdiff_t row_stride) const noexcept {
    try {
        const Box data = intersection(box, m_levels[static_cast<std::size_t>(level)].frame.data);
        const std::ptrdiff_t pixel = pixel_size(m_type, channels());
        if (!(data == box)) clear_around(box, data, pixel, texels, row_stride);
        if (data.empty()) return true;
        std::byte* const to = texels + (data.y0 - box.y0) * row_stride + (data.x0 - box.x0) * pixel;
        if (m_read_stored) return read_stored(data, to, row_stride);
        return m_rows ? read_rows(data, to, row_stride) : copy_tiles(level, data, to, row_stride);
    } catch (const std::exception& e) {
        return fail(message_of(e, "its pixels"));
    }
}

void CacheSource::keep_rows() try {
    std::unique_ptr<OIIO::ImageInput> file = std::move(m_file);
    if (levels() > 1 || spec().tile_width > 0) return;
    const std::string& name = m_name.string();
    m_rows = std::make_unique<FileRows>(
        [cache = m_cache, name] { return open_as_cache_does(*cache, name); }, name, m_subimage, spec(),
        FileRows::Pixels{m_type, m_channels, oiio_type(m_type)}, std::move(file));
} catch (const std::bad_alloc&) {
    // Larger than the address space that is left: by the cache, then.
}

void CacheSource::keep_stored(ReadStored read) {
    m_levels.resize(1);
    const StoredPixels stored = stored_pixels(spec());
    m_type = stored.type;
    m_channels = stored.channels;
    m_alpha = -1;
    m_rows.reset();
    m_read_stored = std::move(read);
    if (m_read_stored) return;
    const std::string& name = m_name.string();
    m_rows = std::make_unique<FileRows>([cache = m_cache, name] { return open_as_cache_does(*cache, name); },
                                        name, m_subimage, spec(),
                                        FileRows::Pixels{m_type, m_channels, OIIO::TypeUnknown});
}

const ConstImageView* CacheSource::view(int) const noexcept {
    const Frame& frame = m_levels.front().frame;
    return m_rows && frame.data == Box{0, 0, frame.width, frame.height} ? &m_rows->view() : nullptr;
}

bool CacheSource::prepare(int, const Box& box) const noexcept {
    if (!m_rows) return true;
    try {
        m_rows->need(box.y0, box.y1);
        return true;
    } catch (const std::exception& e) {
        return fail(message_of(e, "its pixels"));
    }
}

/// `box` lies inside the data window.
bool CacheSource::read_rows(const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const {
    const Box& data = m_levels.front().frame.data;
    m_rows->need(box.y0 - data.y0, box.y1 - data.y0);
    const ConstImageView& from = m_rows->view();
    for (int y = box.y0; y < box.y1; ++y, texels += row_stride)
        std::memcpy(texels, from.at(box.x0 - data.x0, y - data.y0),
                    static_cast<std::size_t>(box.width() * from.pixel_stride));
    return true;
}

/// `box` lies inside the data window.
bool CacheSource::read_stored(const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const {
    const Box& data = m_levels.front().frame.data;
    const std::ptrdiff_t row = box.width() * pixel_size(m_type, m_channels);
    std::vector<std::byte> packed(static_cast<std::size_t>(row * box.height()));
    m_read_stored({box.x0 - data.x0, box.y0 - data.y0, box.x1 - data.x0, box.y1 - data.y0}, packed.data());
    for (int j = 0; j < box.height(); ++j)
        std::memcpy(texels + j * row_stride, packed.data() + j * row, static_cast<std::size_t>(row));
    return true;
}

bool CacheSource::is_replaced() const {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    if (m_levels.front().spec.tile_width > 0 || now.count() < m_next_look.load(std::memory_order_relaxed))
        return false;
    const std::string state = content_state(m_name.string());
    if (!state.empty() && state != m_state) return true;
    m_next_look.store((now + std::chrono::milliseconds(10)).count(), std::memory_order_relaxed);
    return false;
}

/// `box` lies inside the data window.
bool CacheSource::copy_tiles(int level, const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const {
    const Level& l = m_levels[static_cast<std::size_t>(level)];
    const int file_level = m_first_level + level;
    // The cache would write what it reads of the new file into memory for the old one's.
    if (is_replaced()) return fail("has changed since it was opened");
    const CacheThread thread(m_cache);
    ImageCache::ImageHandle* image = m_cache->get_image_handle(m_name, thread);
    static const OIIO::ustring resolution("resolution"), channel_count("channels");
    int size[2], count = 0;
    if (!image ||
        !m_cache->get_image_info(image, thread, m_subimage, file_level, resolution,
                                 TypeDesc(TypeDesc::INT, 2), size) ||
        !m_cache->get_image_info(image, thread, m_subimage, file_level, channel_count, OIIO::TypeInt, &count))
        return fail(m_cache->geterror());
    if (size[0] != l.spec.width || size[1] != l.spec.height || count != l.spec.nchannels)
        return fail("has changed since it was opened");

    // From the panorama's corner to the file's coordinates.
    const int to_x = l.spec.x - l.frame.data.x0, to_y = l.spec.y - l.frame.data.y0;
    const std::ptrdiff_t pixel = pixel_size(m_type, channels());
    for (int y = box.y0; y < box.y1;) {
        int next_y = box.y1;
        for (int x = box.x0; x < box.x1;) {
            ImageCache::Tile* tile =
                m_cache->get_tile(image, thread, m_subimage, file_level, x + to_x, y + to_y, l.spec.z);
            const bool tiled = l.spec.tile_width > 0 && l.spec.tile_height > 0;
            const int column = tiled ? (x + to_x - l.spec.x) / l.spec.tile_width : 0,
                      row = tiled ? (y + to_y - l.spec.y) / l.spec.tile_height : 0;
            const BrokenTiles::Tile known{m_name, m_subimage, file_level, column, row};
            if (!tile) {
                BrokenTiles::instance().add(known);
                return fail(m_cache->geterror());
            }
            if (BrokenTiles::instance().has(known)) {
                m_cache->release_tile(tile);
                return fail("a tile is damaged");
            }
            const OIIO::ROI where = m_cache->tile_roi(tile);
            TypeDesc format;
            const auto* pixels = static_cast<const std::byte*>(m_cache->tile_pixels(tile, format));
            const std::ptrdiff_t tile_pixel = std::ptrdiff_t(format.size()) * channels();
            const int x1 = std::min(box.x1, where.xend - to_x), y1 = std::min(box.y1, where.yend - to_y);
            const bool usable = pixels && x1 > x && y1 > y;
            for (int j = y; usable && j < y1; ++j) {
                const std::byte* from = pixels + (std::ptrdiff_t(j + to_y - where.ybegin) * where.width() +
                                                  x + to_x - where.xbegin) *
                                                     tile_pixel;
                std::byte* to = texels + (j - box.y0) * row_stride + (x - box.x0) * pixel;
                if (format == oiio_type(m_type))
                    std::memcpy(to, from, static_cast<std::size_t>((x1 - x) * pixel));
                else
                    // A cache that holds everything as float: back to the very values of the file.
                    OIIO::convert_pixel_values(format, from, oiio_type(m_type), to, (x1 - x) * channels());
            }
            m_cache->release_tile(tile);
            if (!usable) return fail("a tile holds no pixels");
            x = x1;
            next_y = y1;
        }
        y = next_y;
    }
    return true;
}

// --- BufferSource ------------------------------------------------------------------------------------------

BufferSource::BufferSource(const OIIO::ImageBuf& image, bool stored)
    : m_image(image),
      m_frame(frame_of(image.spec())),
      m_type(stored ? stored_pixels(image.spec()).type : pixel_type(image.spec().format)),
      m_channels(stored ? stored_pixels(image.spec()).channels : image.nchannels()),
      m_format(stored ? image.spec().format : oiio_type(m_type)),
      m_alpha(stored ? -1 : unassociated_alpha_of(image.spec())) {
    const bool whole = m_frame.data == Box{0, 0, m_frame.width, m_frame.height};
    if (whole && image.localpixels() && m_format == image.spec().format)
        m_view = ConstImageView{static_cast<const std::byte*>(image.localpixels()),
                                m_type,
                                m_frame.width,
                                m_frame.height,
                                m_channels,
                                image.pixel_stride(),
                                image.scanline_stride()};
}

bool BufferSource::read(int, const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const noexcept {
    const Box data = intersection(box, m_frame.data);
    const std::ptrdiff_t pixel = pixel_size(m_type, channels());
    if (!(data == box)) clear_around(box, data, pixel, texels, row_stride);
    if (data.empty()) return true;
    const TypeDesc format = m_image.spec().format;
    const auto* pixels = static_cast<const std::byte*>(m_image.localpixels());
    if (!pixels) return false;
    for (int y = data.y0; y < data.y1; ++y) {
        const std::byte* from = pixels + (y - m_frame.data.y0) * m_image.scanline_stride() +
                                (data.x0 - m_frame.data.x0) * m_image.pixel_stride();
        std::byte* to = texels + (y - box.y0) * row_stride + (data.x0 - box.x0) * pixel;
        OIIO::convert_image(m_image.nchannels(), data.width(), 1, 1, from, format, m_image.pixel_stride(),
                            OIIO::AutoStride, OIIO::AutoStride, to, m_format, pixel, OIIO::AutoStride,
                            OIIO::AutoStride);
    }
    return true;
}

// --- colour ------------------------------------------------------------------------------------------------

namespace {

const OIIO::ColorConfig& color_config() {
    static const auto& config = *new OIIO::ColorConfig;
    return config;
}

std::string joined(const std::vector<std::string>& words) {
    std::string out;
    for (const std::string& word : words) out += (out.empty() ? "" : ", ") + word;
    return out;
}

/// The spaces of a configuration that can be come to from one, and back.
std::vector<std::string> spaces_from(const std::string& own, const OIIO::ColorConfig& config) {
    std::vector<std::string> spaces;
    for (const std::string& space : config.getColorSpaceNames())
        if (space != own && config.createColorProcessor(own, space) &&
            config.createColorProcessor(space, own))
            spaces.push_back(space);
    return spaces;
}

}  // namespace

std::shared_ptr<const WorkingSpace> WorkingSpace::make(const std::string& name, const ImageSpec& spec) {
    if (spec.nchannels < 3)
        throw Error("colorspace", printable(name), "the source must have at least 3 channels");
    const OIIO::ColorConfig& config = color_config();
    const char* role = config.getColorSpaceNameByRole(name);
    const std::string space = role ? role : name;
    const std::string own = spec.get_string_attribute("oiio:ColorSpace");
    if (own.empty())
        throw Error("colorspace", printable(name),
                    "the source does not say its own color space: must not be given");
    if (own == space) return nullptr;
    auto result = std::make_shared<WorkingSpace>();
    result->m_there = config.createColorProcessor(own, space);
    result->m_back = config.createColorProcessor(space, own);
    if (!result->m_there || !result->m_back)
        throw Error("colorspace", printable(name),
                    "no way to it from \"" + own + "\": must be the role scene_linear or one of " +
                        joined(spaces_from(own, config)));
    result->m_channels = spec.nchannels;
    if (unassociated_alpha_of(spec) < 0) result->m_alpha = alpha_channel_of(spec);
    return result;
}

void WorkingSpace::convert(const OIIO::ColorProcessor& processor, float* pixels, int width, int height,
                           int channels) const {
    const std::ptrdiff_t count = std::ptrdiff_t{width} * height;
    // Colour curves are for colour that is not multiplied by alpha.
    const auto each = [&](auto change) {
        for (std::ptrdiff_t i = 0; m_alpha >= 0 && i < count; ++i)
            change(pixels + i * channels, m_channels, m_alpha);
    };
    each([](float* pixel, int of, int alpha) { unassociate_alpha(pixel, of, alpha); });
    const auto stride = OIIO::stride_t{channels} * OIIO::stride_t{sizeof(float)};
    processor.apply(pixels, width, height, std::min(m_channels, 3), sizeof(float), stride, stride * width);
    each([](float* pixel, int of, int alpha) {
        if (pixel[alpha] != 0) associate_alpha(pixel, of, alpha);
    });
}

bool WorkingSource::read(int level, const Box& box, std::byte* texels,
                         std::ptrdiff_t row_stride) const noexcept {
    try {
        const int values = box.width() * channels();
        const std::ptrdiff_t raw_stride = std::ptrdiff_t{values} * size_of(m_base.type());
        std::vector<std::byte> raw(static_cast<std::size_t>(raw_stride * box.height()));
        if (!m_base.read(level, box, raw.data(), raw_stride)) return false;
        std::vector<float> row(static_cast<std::size_t>(values));
        for (int y = 0; y < box.height(); ++y) {
            load_channels(raw.data() + y * raw_stride, m_base.type(), values, row.data());
            m_space->to_working(row.data(), box.width(), 1);
            std::memcpy(texels + y * row_stride, row.data(), row.size() * sizeof(float));
        }
        return true;
    } catch (const std::exception&) {
        return false;
    }
}

}  // namespace anamorph
