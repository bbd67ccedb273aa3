// SPDX-License-Identifier: Apache-2.0
// OpenImageIO's images as sources: an ImageBuf, a file behind an ImageCache, either in a working colour
// space.
//
// The image of a source is the display window: pixels outside the data window are 0 (black, transparent), those of a data
// window that goes beyond it stand around it.
// Pixel types other than uint8, uint16, half and float are read as float, which loses digits of some; a picture whose
// pixels are moved only, and never computed with, can have them as they are stored.
#pragma once

#include <OpenImageIO/color.h>
#include <OpenImageIO/imagebuf.h>
#include <OpenImageIO/imagecache.h>

#include <atomic>
#include <chrono>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/file_rows.h"
#include "anamorph/image/source.h"

namespace anamorph {

/// A pointer to an ImageCache: a plain one before OpenImageIO 3.0, a shared one since.
using ImageCacheRef = decltype(OIIO::ImageCache::create(true));

/// The core's type for an OpenImageIO type: itself, or float.
PixelType pixel_type(OIIO::TypeDesc type);
OIIO::TypeDesc oiio_type(PixelType type);

/// Pixels as an image stores them, of any type, as numbers of the core's that are as long together.
struct StoredPixels {
    PixelType type;
    int channels;
};
StoredPixels stored_pixels(const OIIO::ImageSpec& spec);
/// Has the core no numbers for a type, so that it is read as float, which holds fewer digits, or other ones?
bool loses_values(OIIO::TypeDesc type);
/// Are some of an image's channels of a type that the core reads as float, or in a file of several types of channels as
/// float, though it holds more digits, or other ones?
bool loses_values(const OIIO::ImageSpec& spec);

/// The data window inside the display window. An environment of six faces that is as high as these is whole: OpenEXR's display
/// window is one.
struct Frame {
    int width = 0, height = 0;  ///< size of the display window
    Box data;                   ///< relative to its corner

    /// Both windows.
    SourceLevel level() const;
};
Frame frame_of(const OIIO::ImageSpec& spec);

/// The width of an image's pixels over their height.
double pixel_aspect_of(const OIIO::ImageSpec& spec);

/// The channel by which a picture's colour is not yet multiplied, or -1.
int unassociated_alpha_of(const OIIO::ImageSpec& spec);

/// Throws Error unless both windows of an image have pixels, and the data window lies within kMaxSide of the other.
/// `image`: what messages call it.
void check_windows(const OIIO::ImageSpec& spec, const std::string& image);

/// Throws Error when the image is deep, has depth, has no pixels or channels, or pixels of no shape.
void check_source(const OIIO::ImageSpec& spec, const std::string& name);

/// The reason that OpenImageIO gives for a failure, fit for a message about the file that was opened as
/// `name` and is shown as `shown`: one line, without the reader's own prefix.
std::string reason_of(std::string message, const std::string& name, const std::string& shown);

/// A file, read tile by tile through an ImageCache, or row by row where it keeps its rows. Each read borrows one of a pool of the cache's thread
/// records, so it may happen inside another read of the same cache. Throws Error when the image cannot be
/// opened.
class CacheSource final : public Source {
  public:
    /// Opens a file with sizes and metadata as the cache knows them.
    CacheSource(ImageCacheRef cache, const std::string& name, int subimage, int first_level);

    /// A function that gives the spec of a MIP level; one without a format where there is none.
    using SpecOf = std::function<OIIO::ImageSpec(int level)>;
    /// Opens a subimage of a file that the cache is asked for as `name` and that messages call `shown`; sizes and
    /// metadata from `spec_of`, or from the file itself. Neither touches a lock of the cache: a cache that is opening
    /// one of its files would otherwise wait for another, which may wait for the first to be closed.
    CacheSource(ImageCacheRef cache, const std::string& name, const std::string& shown, int subimage,
                const SpecOf& spec_of);
    CacheSource(ImageCacheRef cache, const std::string& name, const std::string& shown, int subimage);

    const OIIO::ImageSpec& spec() const { return m_levels.front().spec; }
    /// The file's name as messages have it.
    const std::string& name() const { return m_shown; }
    /// The specs of all levels that serve, as the file has them.
    std::vector<OIIO::ImageSpec> specs() const;
    /// The names of all subimages of the file, where it was asked itself for the first; empty names of those that have
    /// none.
    const std::vector<std::string>& parts() const { return m_parts; }
    /// The reason that the last failed read failed.
    std::string error() const;

    PixelType type() const noexcept override { return m_type; }
    int channels() const noexcept override { return m_channels; }
    int unassociated_alpha() const noexcept override { return m_alpha; }
    int levels() const noexcept override { return static_cast<int>(m_levels.size()); }
    Size size(int level) const noexcept override { return frame(level).level().size; }
    Box extent(int level) const noexcept override { return frame(level).level().extent; }
    Box data_window() const noexcept override { return frame(0).data; }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;
    const ConstImageView* view(int level) const noexcept override;
    bool prepare(int level, const Box& box) const noexcept override;

    /// Leaves level 0 only, where the coarser levels cannot serve (cube faces that do not halve).
    void keep_first_level() { m_levels.resize(1); }
    /// Has a file without tiles decode its rows once, past the cache; of other files nothing changes.
    void keep_rows();
    /// A function that reads packed pixels of a box of level 0, in the format of the file. Throws Error.
    using ReadStored = std::function<void(const Box& box, std::byte* pixels)>;
    /// Hands out stored_pixels() of level 0 from now on: by `read`, or past the cache, which has float only.
    void keep_stored(ReadStored read = {});

  private:
    struct Level {
        OIIO::ImageSpec spec;  ///< spec of the file
        Frame frame;
    };
    CacheSource(ImageCacheRef cache, const std::string& name, const std::string& shown, int subimage,
                int first_level);
    const Frame& frame(int level) const noexcept { return m_levels[static_cast<std::size_t>(level)].frame; }
    /// `why_not`: the reason where there is no level 0.
    void read_levels(const SpecOf& spec_of, const std::function<std::string()>& why_not);
    bool read_rows(const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const;
    bool read_stored(const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const;
    bool copy_tiles(int level, const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const;
    /// Is a file without tiles another one by now? Looks again after some milliseconds.
    bool is_replaced() const;
    bool fail(const std::string& message) const;

    ImageCacheRef m_cache;
    OIIO::ustring m_name;
    std::string m_shown;
    int m_subimage, m_first_level;
    std::string m_state;  ///< of the file's content when it was opened
    mutable std::atomic<std::chrono::steady_clock::duration::rep> m_next_look{0};
    PixelType m_type = PixelType::float32;
    int m_alpha = -1, m_channels = 0;
    std::vector<Level> m_levels;
    std::vector<std::string> m_parts;
    std::unique_ptr<OIIO::ImageInput> m_file;  ///< open since its header was read, until rows are kept
    std::unique_ptr<FileRows> m_rows;
    ReadStored m_read_stored;
    mutable std::mutex m_mutex;
    mutable std::string m_error;
};

/// Pixels that an ImageBuf holds in memory; read in place where type and window allow it. Keeps a reference.
class BufferSource final : public Source {
  public:
    /// Takes an image. `stored`: are its pixels handed out as stored_pixels()?
    explicit BufferSource(const OIIO::ImageBuf& image, bool stored = false);

    PixelType type() const noexcept override { return m_type; }
    int channels() const noexcept override { return m_channels; }
    int unassociated_alpha() const noexcept override { return m_alpha; }
    int levels() const noexcept override { return 1; }
    Size size(int) const noexcept override { return m_frame.level().size; }
    Box extent(int) const noexcept override { return m_frame.level().extent; }
    Box data_window() const noexcept override { return m_frame.data; }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;
    const ConstImageView* view(int) const noexcept override { return m_view ? &*m_view : nullptr; }

  private:
    const OIIO::ImageBuf& m_image;
    Frame m_frame;
    PixelType m_type;
    int m_channels;
    OIIO::TypeDesc m_format;  ///< format that pixels are handed out in
    int m_alpha;
    std::optional<ConstImageView> m_view;
};

/// The way to a colour space to filter in, and back.
class WorkingSpace {
  public:
    /// Makes the way to a colour space. `name`: a colour space or a role of OpenColorIO's configuration
    /// ($OCIO, or OpenImageIO's own). Throws Error when it is unknown or when the image does not say its own.
    /// Null when there is nothing to convert.
    static std::shared_ptr<const WorkingSpace> make(const std::string& name, const OIIO::ImageSpec& spec);

    void to_working(float* pixels, int width, int height) const {
        convert(*m_there, pixels, width, height, m_channels);
    }
    /// `channels`: those of the image, and perhaps more, which do not change.
    void from_working(float* pixels, int width, int height, int channels) const {
        convert(*m_back, pixels, width, height, channels);
    }

  private:
    void convert(const OIIO::ColorProcessor& processor, float* pixels, int width, int height,
                 int channels) const;

    OIIO::ColorProcessorHandle m_there, m_back;
    int m_channels = 0;
    int m_alpha = -1;  ///< channel of alpha that colour is multiplied by
};

/// A source as float in a working space. Keeps a reference to the base.
class WorkingSource final : public Source {
  public:
    WorkingSource(const Source& base, std::shared_ptr<const WorkingSpace> space)
        : m_base(base), m_space(std::move(space)) {}

    PixelType type() const noexcept override { return PixelType::float32; }
    int channels() const noexcept override { return m_base.channels(); }
    int unassociated_alpha() const noexcept override { return m_base.unassociated_alpha(); }
    int levels() const noexcept override {
        return 1;
    }  // an average before the conversion is not one after it
    Size size(int level) const noexcept override { return m_base.size(level); }
    Box extent(int level) const noexcept override { return m_base.extent(level); }
    Box data_window() const noexcept override { return m_base.data_window(); }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override;

  private:
    const Source& m_base;
    std::shared_ptr<const WorkingSpace> m_space;
};

}  // namespace anamorph
