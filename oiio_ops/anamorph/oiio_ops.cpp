// SPDX-License-Identifier: Apache-2.0
#include "anamorph/oiio_ops.h"

#include <OpenImageIO/imagebufalgo.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <memory>

#include "anamorph/file_names.h"
#include "anamorph/image_source.h"
#include "anamorph/lens_database.h"
#include "anamorph/metadata.h"
#include "anamorph/operation/drape.h"
#include "anamorph/operation/morph.h"
#include "anamorph/operation/pano.h"
#include "anamorph/operation/warp.h"
#include "anamorph/orientation.h"
#include "anamorph/parallel.h"
#include "anamorph/side_files.h"
#include "anamorph/source_stack.h"

namespace anamorph {
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

ParallelFor default_parallel_for(int threads) {
    OIIO::thread_pool& pool = *OIIO::default_thread_pool();
    return parallel_for_on(pool, threads > 0 ? threads : pool.size() + 1);
}

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

/// Keys that only a file has a use for.
const char* const kKeysOfRecipes[] = {"subimage", "concatenate", "tile", "mip", "hash", "frames"};

/// Options of the call, and the size of an initialised dst where no other is
/// asked for.
ParameterValues values_of(const Operation& operation, const OIIO::ParamValueList& options,
                          const ImageBuf& dst) {
    const ParameterTable& table = *operation.parameters;
    ParameterValues values(table);
    if (values.knows("size") && dst.initialized() && dst.spec().full_width > 0 && dst.spec().full_height > 0)
        values.set("size", Size{dst.spec().full_width, dst.spec().full_height});
    const std::vector<Assignment> assignments = assignments_of(options);
    ParameterValues asked(table);
    asked.assign(assignments);
    std::vector<std::string> of_recipes = operation.sources;
    of_recipes.insert(of_recipes.end(), std::begin(kKeysOfRecipes), std::end(kKeysOfRecipes));
    for (const std::string& name : of_recipes)
        if (asked.given(name) && !(name == operation.main_file && operation.gathers(asked.text(name))))
            throw Error(name, printable(asked.text(name)), "must be given in recipes only");
    values.assign(assignments);
    return values;
}

/// The files that the options name, and those that these name.
struct NamedFiles {
    SideFiles files;
    LinkedFiles linked;
};
NamedFiles files_of(const Operation& operation, const ParameterValues& values) {
    NamedFiles named;
    SideFiles& files = named.files;
    for (const LinkedFile& file : operation.named_files(values))
        files[file.key] = {file.name, "", file.image};
    if (operation.linked) named.linked = operation.linked(values, files, KeyedFileReader(files));
    for (const LinkedFile& file : named.linked) files[file.key] = {file.name, ""};
    return named;
}

/// Asks for huge pages behind memory that is written next: a page fault costs as much as drawing 500 pixels.
void advise_huge_pages([[maybe_unused]] void* memory, [[maybe_unused]] std::size_t size) {
#ifdef MADV_HUGEPAGE
    // Whole pages only, so that what lies beside them is not touched.
    constexpr std::uintptr_t kPage = std::uintptr_t{2} << 20;
    const auto address = reinterpret_cast<std::uintptr_t>(memory);
    const std::uintptr_t begin = (address + kPage - 1) / kPage * kPage,
                         end = (address + size) / kPage * kPage;
    if (begin < end) ::madvise(reinterpret_cast<void*>(begin), end - begin, MADV_HUGEPAGE);
#endif
}

/// Brings dst and roi into the state in which pixels can be filled. True where no pixel of dst has a value
/// yet, and filling roi gives one to all.
bool prepare(ImageBuf& dst, const ImageSpec& picture, ROI& roi) {
    bool unwritten = false;
    if (!dst.initialized()) {
        ImageSpec spec = picture;
        if (roi.defined()) {
            spec.x = roi.xbegin;
            spec.y = roi.ybegin;
            spec.width = roi.width();
            spec.height = roi.height();
            if (spec.width < 1 || spec.height < 1) throw Error("roi has no pixels");
        }
        unwritten = !roi.defined() || (roi.chbegin == 0 && roi.chend >= spec.nchannels);
        dst.reset(spec, unwritten ? OIIO::InitializePixels::No : OIIO::InitializePixels::Yes);
        if (dst.has_error() || !dst.localpixels())
            throw Error("no memory for " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                        " pixels");
        if (unwritten) advise_huge_pages(dst.localpixels(), spec.image_bytes());
        roi = ROI(spec.x, spec.x + spec.width, spec.y, spec.y + spec.height, 0, 1,
                  roi.defined() ? roi.chbegin : 0, roi.defined() ? roi.chend : spec.nchannels);
    } else {
        if (dst.deep() || dst.spec().depth > 1) throw Error("dst is deep or a volume: must be a flat image");
        roi = roi.defined() ? roi_intersection(roi, dst.roi()) : dst.roi();
        if (!dst.localpixels() && !dst.make_writable(true)) throw Error("dst cannot be written");
    }
    roi.chend = std::min({roi.chend, dst.nchannels(), picture.nchannels});
    if (roi.chbegin >= roi.chend) throw Error("roi has no channel of the picture");
    return unwritten;
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

void fill(ImageBuf& dst, const SolvedPicture& picture, const SourceStacks& stacks, const ImageSpec& drawn,
          bool stored, const ROI& roi, const ParallelFor& parallel_for) {
    const ImageSpec& spec = dst.spec();
    const Box box = box_of(roi, spec, drawn);
    const bool all_channels = roi.chbegin == 0 && roi.chend == drawn.nchannels && spec.nchannels == roi.chend;
    const Drawn own =
        stored ? Drawn{drawn.format, stored_pixels(drawn)}
               : Drawn{oiio_type(pixel_type(spec.format)), {pixel_type(spec.format), drawn.nchannels}};
    if (all_channels && own.format == spec.format) {
        draw_picture(
            picture, stacks, box,
            {static_cast<std::byte*>(dst.pixeladdr(roi.xbegin, roi.ybegin)), own.pixels.type, box.width(),
             box.height(), own.pixels.channels, dst.pixel_stride(), dst.scanline_stride()},
            parallel_for);
        return;
    }
    // Other channels or types: by way of float, or of what is stored, some rows at a time.
    const Drawn way = stored ? own : Drawn{OIIO::TypeFloat, {PixelType::float32, drawn.nchannels}};
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
            picture, stacks, part,
            packed_view(pixels.data(), way.pixels.type, part.width(), part.height(), way.pixels.channels),
            parallel_for);
        if (!dst.set_pixels(rows, way.format, pixels.data() + roi.chbegin * channel, pixel,
                            pixel * part.width()))
            throw Error(dst.geterror());
    }
}

/// Adds the images among linked files; the keys of those that cannot be opened, which are null.
std::vector<std::string> open_linked(const LinkedFiles& linked, std::vector<std::unique_ptr<Source>>& images,
                                     std::vector<ImageSpec>& specs) {
    std::vector<std::string> missing;
    for (const LinkedFile& file : linked) {
        if (!file.image) continue;
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

/// Fills dst by sources that are not dst. Throws Error.
void run(const Operation& operation, ImageBuf& dst, const std::vector<const ImageBuf*>& sources,
         const OIIO::ParamValueList& options, ROI roi, int nthreads) {
    ParameterValues values = values_of(operation, options, dst);
    const NamedFiles named = files_of(operation, values);
    const std::string gathering = operation.gathering_file(named.files);
    if (!gathering.empty() && !sources.empty())
        throw Error("src", printable(gathering),
                    "must be given without source images, which it names itself");
    if (gathering.empty()) check_count(operation, sources.size());
    OpenSources open = gathering.empty() ? OpenSources() : open_gathered(named.linked);
    for (const ImageBuf* src : sources) {
        if (!src) throw Error("a source image is null");
        check_readable(*src);
        ImageSpec spec = src->spec();
        if (src->file_format_name() == "jpeg") add_photo_sphere(spec, std::string(src->name()));
        open.add(source_of(*src), spec);
    }
    const Attributes lenses = find_lenses(operation, values, open.shown, open.known);
    std::vector<std::unique_ptr<Source>>& images = open.images;
    std::vector<ImageSpec>& specs = open.specs;
    const std::vector<std::string> missing =
        gathering.empty() ? open_linked(named.linked, images, specs) : std::vector<std::string>();
    const std::unique_ptr<const Pictures> pictures =
        operation.read({values, open.known, named.files, KeyedFileReader(named.files), missing});
    const PictureRequest request = *pictures->picture(0, 0);
    const std::string space = filtering_space(values, request.pixels);
    // The pixels that a cache lends are of a type of its own.
    const bool stored = moves_stored(request, specs, space) && *request.moves < sources.size() &&
                        sources[*request.moves]->localpixels() &&
                        specs[*request.moves].channelformats.empty();
    if (stored) images[*request.moves] = std::make_unique<BufferSource>(*sources[*request.moves], true);
    const ImageSpec spec = picture_spec(open.shown.empty() ? nullptr : &open.shown[0], request, stored);
    const ParallelFor parallel_for = default_parallel_for(nthreads);
    const std::unique_ptr<const SolvedPicture> picture = request.solve();
    const Attributes reached = picture->reached(parallel_for);

    const SourceStacks stacks = make_source_stacks(std::move(images), specs, *pictures, space);
    const bool unwritten = prepare(dst, spec, roi);
    try {
        fill(dst, *picture, stacks, spec, stored, roi, parallel_for);
    } catch (...) {
        if (unwritten) OIIO::ImageBufAlgo::zero(dst);
        throw;
    }
    add_attributes(dst.specmod(), own_attributes(request.says));
    add_attributes(dst.specmod(), lenses);
    add_attributes(dst.specmod(), reached);
}

/// What goes wrong is told as an error of `function`. A source that is dst is copied first.
bool run_in_place(const Operation& operation, const char* function, ImageBuf& dst,
                  std::vector<const ImageBuf*> sources, const OIIO::ParamValueList& options, ROI roi,
                  int nthreads) {
    ImageBuf copy;
    for (const ImageBuf*& src : sources) {
        if (src != &dst) continue;
        if (!copy.initialized()) copy = dst;
        src = &copy;
    }
    try {
        run(operation, dst, sources, options, roi, nthreads);
        return true;
    } catch (const std::exception& e) {
        dst.errorfmt("{}: {}", function, message_of(e, "the picture"));
        return false;
    }
}

}  // namespace

bool apply(ImageBuf& dst, OIIO::string_view operation, const std::vector<const ImageBuf*>& sources,
           const OIIO::ParamValueList& options, ROI roi, int nthreads) {
    const std::string name = operation;
    if (const Operation* known = find_operation(name))
        return run_in_place(*known, known->name.c_str(), dst, sources, options, roi, nthreads);
    dst.errorfmt("apply: operation \"{}\": must be one of {}", printable(name), operation_names());
    return false;
}

ImageBuf apply(OIIO::string_view operation, const std::vector<const ImageBuf*>& sources,
               const OIIO::ParamValueList& options, ROI roi, int nthreads) {
    ImageBuf result;
    apply(result, operation, sources, options, roi, nthreads);
    return result;
}

bool reproject(ImageBuf& dst, const ImageBuf& src, const OIIO::ParamValueList& options, ROI roi,
               int nthreads) {
    return run_in_place(pano_operation(), "reproject", dst, {&src}, options, roi, nthreads);
}

bool mesh_warp(ImageBuf& dst, const ImageBuf& src, const OIIO::ParamValueList& options, ROI roi,
               int nthreads) {
    return run_in_place(warp_operation(), "mesh_warp", dst, {&src}, options, roi, nthreads);
}

bool drape(ImageBuf& dst, const ImageBuf& texture, const OIIO::ParamValueList& options, ROI roi,
           int nthreads) {
    return run_in_place(drape_operation(), "drape", dst, {&texture}, options, roi, nthreads);
}

bool morph(ImageBuf& dst, const ImageBuf& a, const ImageBuf& b, const OIIO::ParamValueList& options, ROI roi,
           int nthreads) {
    return morph(dst, {&a, &b}, options, roi, nthreads);
}

bool morph(ImageBuf& dst, const std::vector<const ImageBuf*>& pictures, const OIIO::ParamValueList& options,
           ROI roi, int nthreads) {
    return run_in_place(morph_operation(), "morph", dst, pictures, options, roi, nthreads);
}

ImageBuf reproject(const ImageBuf& src, const OIIO::ParamValueList& options, ROI roi, int nthreads) {
    ImageBuf result;
    reproject(result, src, options, roi, nthreads);
    return result;
}

ImageBuf mesh_warp(const ImageBuf& src, const OIIO::ParamValueList& options, ROI roi, int nthreads) {
    ImageBuf result;
    mesh_warp(result, src, options, roi, nthreads);
    return result;
}

ImageBuf drape(const ImageBuf& texture, const OIIO::ParamValueList& options, ROI roi, int nthreads) {
    ImageBuf result;
    drape(result, texture, options, roi, nthreads);
    return result;
}

ImageBuf morph(const ImageBuf& a, const ImageBuf& b, const OIIO::ParamValueList& options, ROI roi,
               int nthreads) {
    return morph({&a, &b}, options, roi, nthreads);
}

ImageBuf morph(const std::vector<const ImageBuf*>& pictures, const OIIO::ParamValueList& options, ROI roi,
               int nthreads) {
    ImageBuf result;
    morph(result, pictures, options, roi, nthreads);
    return result;
}

}  // namespace anamorph
