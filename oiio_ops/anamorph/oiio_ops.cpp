// SPDX-License-Identifier: Apache-2.0
#include "anamorph/oiio_ops.h"

#include <OpenImageIO/imagebufalgo.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstdint>
#include <memory>

#include "anamorph/buffer_picture.h"
#include "anamorph/metadata.h"
#include "anamorph/operation/drape.h"
#include "anamorph/operation/morph.h"
#include "anamorph/operation/pano.h"
#include "anamorph/operation/warp.h"
#include "anamorph/parallel.h"

namespace anamorph {
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

/// Options of the call, and the size of an initialised dst where no other is
/// asked for.
ParameterValues values_of(const Operation& operation, const OIIO::ParamValueList& options,
                          const ImageBuf& dst) {
    ParameterValues values(*operation.parameters);
    if (values.knows("size") && dst.initialized() && dst.spec().full_width > 0 && dst.spec().full_height > 0)
        values.set("size", Size{dst.spec().full_width, dst.spec().full_height});
    values.assign(assignments_of(options));
    return values;
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

/// Fills dst by sources that are not dst. Throws Error.
void run(const Operation& operation, ImageBuf& dst, const std::vector<const ImageBuf*>& sources,
         const OIIO::ParamValueList& options, ROI roi, int nthreads) {
    const ParallelFor parallel_for = default_parallel_for(nthreads);
    const BufferPicture picture(operation, values_of(operation, options, dst),
                                std::vector<BufferPicture::SourceInput>(sources.begin(), sources.end()),
                                parallel_for);
    const Attributes reached = picture.reached(parallel_for);
    const bool unwritten = prepare(dst, picture.spec(), roi);
    try {
        picture.fill(dst, roi, parallel_for);
    } catch (...) {
        if (unwritten) OIIO::ImageBufAlgo::zero(dst);
        throw;
    }
    add_attributes(dst.specmod(), picture.said());
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
