// SPDX-License-Identifier: Apache-2.0
#include "anamorph/buffer_picture.h"

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <variant>

#include "anamorph/file_names.h"
#include "anamorph/image_source.h"
#include "anamorph/joining.h"
#include "anamorph/lens_database.h"
#include "anamorph/metadata.h"
#include "anamorph/operation/rows.h"
#include "anamorph/operation/solved.h"
#include "anamorph/orientation.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

std::unique_ptr<Source> source_of(const ImageBuf& src) {
    if (src.localpixels()) return std::make_unique<BufferSource>(src);
    return std::make_unique<CacheSource>(src.imagecache(), src.name(), src.subimage(), src.miplevel());
}

void check_readable(const ImageBuf& src) {
    // Asking for the pixels reads a file that was only named so far.
    const bool local = src.localpixels() != nullptr;
    if (!src.initialized() && src.name().empty()) throw Error("the source image is not initialised");
    if (src.initialized()) check_source(src.spec(), src.name());
    if (!src.initialized() || (!local && src.storage() != ImageBuf::IMAGECACHE))
        throw Error("the source image cannot be read: " + src.geterror());
}

/// The files that the options name, and those that these name.
struct NamedFiles {
    SideFiles files;
    LinkedFiles linked;
};
NamedFiles files_of(const Operation& operation, const ParameterValues& values, const SideFileReader& reader) {
    NamedFiles named;
    SideFiles& files = named.files;
    for (const LinkedFile& file : operation.named_files(values))
        files[file.key] = {file.name, "", file.image};
    if (operation.linked) named.linked = operation.linked(values, files, KeyedFileReader(files, reader));
    for (const LinkedFile& file : named.linked) files[file.key] = {file.name, ""};
    return named;
}

/// The part of the picture that `roi` of dst shows, whose display window is the picture's, as `picture` has it.
Box box_of(const ROI& roi, const ImageSpec& dst, const ImageSpec& picture) {
    const int x = dst.full_x + picture.x - picture.full_x, y = dst.full_y + picture.y - picture.full_y;
    return {roi.xbegin - x, roi.ybegin - y, roi.xend - x, roi.yend - y};
}

/// The pixels that are drawn: their format, and as what the core sees them.
struct Drawn {
    OIIO::TypeDesc format;
    StoredPixels pixels;
};

/// Adds the images among linked files; the keys of those that cannot be opened, which are null.
std::vector<std::string> open_linked(const LinkedFiles& linked, const MemoryFiles& in_memory,
                                     std::vector<std::unique_ptr<Source>>& images,
                                     std::vector<ImageSpec>& specs) {
    std::vector<std::string> missing;
    for (const LinkedFile& file : linked) {
        if (!file.image) continue;
        if (const auto found = in_memory.images.find(file.name); found != in_memory.images.end()) {
            images.push_back(source_of(*found->second));
            specs.push_back(found->second->spec());
            continue;
        }
        images.emplace_back();
        specs.emplace_back();
        try {
            check_file_name(file.key, file.name);
            auto image = std::make_unique<CacheSource>(OIIO::ImageCache::create(true), file.name, 0, 0);
            specs.back() = image->spec();
            images.back() = std::move(image);
        } catch (const Error&) {
            missing.push_back(file.key);
        }
    }
    return missing;
}

/// What is known of sources, in their order.
struct OpenSources {
    std::vector<std::unique_ptr<Source>> images;
    std::vector<ImageSpec> specs, shown;  ///< as they are stored, and upright
    std::vector<SourceImage> known;

    void add(const BufferPicture::SourceInput& source) {
        if (source.picture) return add(nullptr, source.picture->spec());
        if (!source.image) throw Error("a source image is null");
        check_readable(*source.image);
        ImageSpec spec = source.image->spec();
        if (source.image->file_format_name() == "jpeg")
            add_photo_sphere(spec, std::string(source.image->name()));
        add(source_of(*source.image), spec);
    }
    void add(std::unique_ptr<Source> image, const ImageSpec& spec) {
        images.push_back(std::move(image));
        specs.push_back(spec);
        shown.push_back(upright(spec));
        known.push_back(source_image(shown.back()));
    }
};

/// The images that a file gathers, as they are stored.
OpenSources open_gathered(const LinkedFiles& linked) {
    OpenSources open;
    for (const LinkedFile& file : linked) {
        check_file_name(file.key, file.name);
        auto image = std::make_unique<CacheSource>(OIIO::ImageCache::create(true), file.name, 0, 0);
        ImageSpec spec = image->spec();
        spec.attribute("Orientation", 1);
        open.add(std::move(image), spec);
    }
    return open;
}

void check_count(const Operation& operation, std::size_t sources) {
    const std::size_t least = operation.least_sources, most = operation.sources.size();
    if (sources >= least && sources <= most) return;
    throw Error(std::to_string(sources) + " source images: must be " + std::to_string(least) +
                (least < most ? " to " + std::to_string(most) : ""));
}

/// Refuses keys that only a recipe has a use for, the sources' names among them.
void check_keys(const Operation& operation, const ParameterValues& values, bool reads_pictures) {
    std::vector<std::string> of_recipes = operation.sources;
    of_recipes.insert(of_recipes.end(), std::begin(rows::kKeysOfRecipes), std::end(rows::kKeysOfRecipes));
    if (!reads_pictures) of_recipes.emplace_back("concatenate");
    for (const std::string& name : of_recipes)
        if (values.given(name) && !(name == operation.main_file && operation.gathers(values.text(name))))
            throw Error(name, printable(values.text(name)), "must be given in recipes only");
}

/// Are the pixels of a source in memory, and of one type?
bool is_stored_alike(const BufferPicture::SourceInput& source) {
    if (source.picture) return source.picture->spec().channelformats.empty();
    return source.image->localpixels() && source.image->spec().channelformats.empty();
}

/// The tolerance that a picture says; null where it says none.
template <class SomeAttributes>
auto* tolerance_in(SomeAttributes& said) {
    const auto found = std::find_if(said.begin(), said.end(), [](const Attribute& attribute) {
        return attribute.name == "anamorph:tol";
    });
    return found == said.end() ? nullptr : std::get_if<double>(&found->value);
}

PictureRequest picture_of(const Pictures& pictures, int subimage) {
    if (subimage < 0 || subimage >= pictures.frames())
        throw Error("subimage", std::to_string(subimage),
                    "must be an integer from 0 to " + std::to_string(pictures.frames() - 1));
    return *pictures.picture(subimage, 0);
}

}  // namespace

BufferPicture::BufferPicture(const Operation& operation, const ParameterValues& values,
                             const std::vector<SourceInput>& sources, const ParallelFor& parallel_for,
                             const MemoryFiles& in_memory, int subimage)
    : m_values(values), m_sources(sources), m_chain(operation.name) {
    check_keys(operation, values, std::any_of(sources.begin(), sources.end(), [](const SourceInput& source) {
                   return source.picture != nullptr;
               }));
    const MemoryFileReader reader(in_memory);
    const NamedFiles named = files_of(operation, values, reader);
    const std::string gathering = operation.gathering_file(named.files);
    if (!gathering.empty() && !sources.empty())
        throw Error("src", printable(gathering),
                    "must be given without source images, which it names itself");
    if (gathering.empty()) check_count(operation, sources.size());
    OpenSources open = gathering.empty() ? OpenSources() : open_gathered(named.linked);
    for (const SourceInput& source : sources) open.add(source);
    m_said = find_lenses(operation, m_values, open.shown, open.known);
    const std::vector<std::string> missing =
        gathering.empty() ? open_linked(named.linked, in_memory, open.images, open.specs)
                          : std::vector<std::string>();
    m_pictures =
        operation.read({m_values, open.known, named.files, KeyedFileReader(named.files, reader), missing});
    m_request = picture_of(*m_pictures, subimage);
    m_space = filtering_space(m_values, m_request.pixels);
    m_stored = moves_stored(m_request, open.specs, m_space) && *m_request.moves < sources.size() &&
               is_stored_alike(sources[*m_request.moves]);
    m_spec = picture_spec(open.shown.empty() ? nullptr : &open.shown[0], m_request, m_stored);
    const Attributes own = own_attributes(m_request.says);
    m_said.insert(m_said.begin(), own.begin(), own.end());
    m_picture = m_request.solve();

    if (!sources.empty() && sources[0].picture) {
        const std::string reason = join(*sources[0].picture);
        m_said.push_back({"anamorph:chain", reason.empty()
                                                ? m_chain
                                                : m_chain + " of a picture that is drawn first: " + reason});
        if (reason.empty()) return;
    }
    for (std::size_t i = 0; i < sources.size(); ++i) {
        if (sources[i].picture) m_sources[i].image = &drawn(*sources[i].picture, parallel_for);
        // The pixels that a cache lends are of a type of its own.
        const bool stored = m_stored && i == *m_request.moves;
        if (stored || sources[i].picture)
            open.images[i] = std::make_unique<BufferSource>(*m_sources[i].image, stored);
    }
    m_stacks = std::make_shared<const SourceStacks>(
        make_source_stacks(std::move(open.images), open.specs, *m_pictures, m_space));
}

const ImageBuf& BufferPicture::drawn(const BufferPicture& inner, const ParallelFor& parallel_for) {
    m_drawn.push_back(std::make_unique<ImageBuf>(inner.spec(), OIIO::InitializePixels::No));
    ImageBuf& image = *m_drawn.back();
    if (!image.localpixels()) throw Error("no memory for a source that is drawn first");
    inner.fill(image, image.roi(), parallel_for);
    return image;
}

std::string BufferPicture::join(const BufferPicture& inner) {
    if (std::string reason = why_drawn_apart(m_chain, m_values, m_pictures->frames()); !reason.empty())
        return reason;
    const Joined joined =
        joined_sides({*m_picture, m_request.shown(), m_space, m_stored}, m_request.pixels,
                     {*inner.m_picture, inner.m_request.shown(), inner.m_space, inner.m_stored});
    if (!joined.picture) return joined.reason;
    m_picture = solved(*joined.picture);
    m_stacks = inner.m_stacks;
    m_chain += " of " + inner.m_chain;
    // What is joined holds both tolerances.
    if (double* const own = tolerance_in(m_said))
        if (const double* const other = tolerance_in(inner.m_said)) {
            *own = std::min(*own, *other);
            m_spec.attribute("anamorph:tol", static_cast<float>(*own));
        }
    return "";
}

void BufferPicture::fill(ImageBuf& dst, const ROI& roi, const ParallelFor& parallel_for) const {
    const ImageSpec& drawn = m_spec;
    const ImageSpec& spec = dst.spec();
    const Box box = box_of(roi, spec, drawn);
    const bool all_channels = roi.chbegin == 0 && roi.chend == drawn.nchannels && spec.nchannels == roi.chend;
    const Drawn own =
        m_stored ? Drawn{drawn.format, stored_pixels(drawn)}
                 : Drawn{oiio_type(pixel_type(spec.format)), {pixel_type(spec.format), drawn.nchannels}};
    if (all_channels && own.format == spec.format) {
        draw_picture(
            *m_picture, *m_stacks, box,
            {static_cast<std::byte*>(dst.pixeladdr(roi.xbegin, roi.ybegin)), own.pixels.type, box.width(),
             box.height(), own.pixels.channels, dst.pixel_stride(), dst.scanline_stride()},
            parallel_for);
        return;
    }
    // Other channels or types: by way of float, or of what is stored, some rows at a time.
    const Drawn way = m_stored ? own : Drawn{OIIO::TypeFloat, {PixelType::float32, drawn.nchannels}};
    constexpr int kRows = 512;
    const auto channel = static_cast<std::ptrdiff_t>(way.format.size());
    const std::ptrdiff_t pixel = channel * drawn.nchannels;
    std::vector<std::byte> pixels;
    for (int y = roi.ybegin; y < roi.yend; y += kRows) {
        ROI rows = roi;
        rows.ybegin = y;
        rows.yend = std::min(y + kRows, roi.yend);
        const Box part = box_of(rows, spec, drawn);
        pixels.resize(static_cast<std::size_t>(std::int64_t{part.width()} * part.height() * pixel));
        draw_picture(
            *m_picture, *m_stacks, part,
            packed_view(pixels.data(), way.pixels.type, part.width(), part.height(), way.pixels.channels),
            parallel_for);
        if (!dst.set_pixels(rows, way.format, pixels.data() + roi.chbegin * channel, pixel,
                            pixel * part.width()))
            throw Error(dst.geterror());
    }
}

}  // namespace anamorph
