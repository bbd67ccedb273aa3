// SPDX-License-Identifier: Apache-2.0
#include "arrays.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "anamorph/image/picture.h"
#include "anamorph/image_source.h"
#include "anamorph/metadata.h"

namespace anamorph {
namespace {

using OIIO::ImageBuf;
using OIIO::ImageSpec;
using OIIO::ROI;

ImageSpec spec_of(const ArrayPixels& pixels) {
    constexpr std::int64_t kMost = std::numeric_limits<int>::max();
    if (pixels.width < 1 || pixels.height < 1 || pixels.channels < 1 || pixels.width > kMost ||
        pixels.height > kMost || pixels.channels > kMost)
        throw Error("an array of " + std::to_string(pixels.height) + " rows, " +
                    std::to_string(pixels.width) + " columns and " + std::to_string(pixels.channels) +
                    " channels: must have 1 to 2147483647 of each");
    return {static_cast<int>(pixels.width), static_cast<int>(pixels.height),
            static_cast<int>(pixels.channels), pixels.type};
}

ImageSpec spec_of(const ArrayPixels& pixels, const ArrayFacts& facts) {
    ImageSpec spec = spec_of(pixels);
    if (!facts.channels.empty()) {
        if (std::ssize(facts.channels) != spec.nchannels)
            throw Error("channels", std::to_string(facts.channels.size()) + " names",
                        "must be " + std::to_string(spec.nchannels) + ", one for each channel");
        spec.channelnames = facts.channels;
        for (int c = 0; c < spec.nchannels; ++c)
            if (facts.channels[static_cast<std::size_t>(c)] == "A") spec.alpha_channel = c;
    }
    spec.x = facts.x;
    spec.y = facts.y;
    const Box shown = facts.display.empty()
                          ? Box{facts.x, facts.y, facts.x + spec.width, facts.y + spec.height}
                          : facts.display;
    spec.full_x = shown.x0;
    spec.full_y = shown.y0;
    spec.full_width = shown.width();
    spec.full_height = shown.height();
    if (facts.unassociated) spec.attribute("oiio:UnassociatedAlpha", 1);
    add_attributes(spec, facts.metadata);
    check_source(spec, "array");
    return spec;
}

}  // namespace

ArraySource::ArraySource(const ArrayPixels& pixels, const ArrayFacts& facts)
    : m_image(spec_of(pixels, facts), pixels.data, pixels.pixel_stride, pixels.row_stride) {}

ArraySource::ArraySource(const std::string& file) : m_image(file) {}

ArrayPicture::ArrayPicture(const Operation& operation, const std::vector<Assignment>& assignments,
                           const std::vector<Input>& sources, const ArrayFiles& files, int subimage,
                           const ParallelFor& parallel_for)
    : m_operation(&operation), m_sources(sources), m_files(files) {
    ParameterValues values(*operation.parameters);
    values.assign(assignments);
    std::vector<BufferPicture::SourceInput> inputs;
    for (const Input& source : sources)
        inputs.push_back({source.array ? &source.array->image() : nullptr,
                          source.picture ? source.picture->m_picture : nullptr});
    MemoryFiles in_memory{files.texts, {}};
    for (const auto& [name, image] : files.images) in_memory.images[name] = &image->image();
    m_picture =
        std::make_shared<const BufferPicture>(operation, values, inputs, parallel_for, in_memory, subimage);
}

void ArrayPicture::draw(const ArrayPixels& to, int x, int y, const ParallelFor& parallel_for,
                        const std::function<void(int rows)>& progress) const {
    ImageSpec spec = this->spec();
    const ImageSpec drawn = spec_of(to);
    // Corners are added to and subtracted from.
    constexpr std::int64_t kFarthest = std::int64_t{1} << 30;
    if (x < -kFarthest || y < -kFarthest || x + to.width > kFarthest || y + to.height > kFarthest)
        throw Error("roi", std::to_string(x) + "," + std::to_string(y) + ",...",
                    "must lie within " + std::to_string(kFarthest) + " pixels of (0, 0)");
    if (drawn.nchannels != spec.nchannels)
        throw Error("out", std::to_string(drawn.nchannels) + " channels",
                    "must have " + std::to_string(spec.nchannels));
    spec.x = x;
    spec.y = y;
    spec.width = drawn.width;
    spec.height = drawn.height;
    spec.set_format(to.type);
    ImageBuf image(spec, to.data, to.pixel_stride, to.row_stride);
    if (!progress) return m_picture->fill(image, image.roi(), parallel_for);
    // Bands begin where the rows of the maps' regions do.
    constexpr int kRows = BlockMap::kRegion;
    for (int done = 0; done < spec.height;) {
        const int first = y + done,
                  rows = std::min(spec.height - done, kRows - ((first % kRows) + kRows) % kRows);
        m_picture->fill(image, ROI(x, x + spec.width, first, first + rows, 0, 1, 0, spec.nchannels),
                        parallel_for);
        done += rows;
        progress(rows);
    }
}

const BlockMap& ArrayPicture::map() const {
    const Picture* picture = m_picture->of_maps();
    if (!picture || picture->maps.size() != 1 || picture->maps[0].layers.size() != 1)
        throw Error("the picture of " + m_operation->name +
                    " has no single source point: it is not one map of one source");
    return *picture->maps[0].blocks;
}

template <class Found>
void ArrayPicture::each(const PointArrays& points, const ParallelFor& parallel_for,
                        const Found& found) const {
    constexpr std::int64_t kAtOnce = 1024;
    const BlockMap& map = this->map();
    // Points are counted from the display window's corner, as maps are that know of overscan; others begin at the data window's.
    const ImageSpec& windows = spec();
    const Size& known = m_picture->of_maps()->overscan;
    const Point<double> corner{static_cast<double>(windows.full_x - windows.x - known.width),
                               static_cast<double>(windows.full_y - windows.y - known.height)};
    parallel_for((points.count + kAtOnce - 1) / kAtOnce, [&](std::int64_t part) {
        const std::int64_t end = std::min(points.count, (part + 1) * kAtOnce);
        for (std::int64_t i = part * kAtOnce; i < end; ++i) {
            const Point<double> at = Point<double>{points.x[i], points.y[i]} + corner;
            found(i, map, at, map.piece_at(at.x, at.y));
        }
    });
}

void ArrayPicture::source_points(const PointArrays& points, double* x, double* y,
                                 const ParallelFor& parallel_for) const {
    each(points, parallel_for, [&](std::int64_t i, const BlockMap& map, const Point<double>& at, int piece) {
        Point<double> point;
        int source_piece = 0;
        if (piece < 0 || !map.exact(at.x, at.y, piece, point, source_piece))
            point = {std::nan(""), std::nan("")};
        x[i] = point.x;
        y[i] = point.y;
    });
}

void ArrayPicture::jacobians(const PointArrays& points, double* derivatives,
                             const ParallelFor& parallel_for) const {
    each(points, parallel_for, [&](std::int64_t i, const BlockMap& map, const Point<double>& at, int piece) {
        const double none = std::nan("");
        Jacobian j{none, none, none, none};
        if (piece >= 0 && map.seen(at.x, at.y, piece)) j = map.jacobian(at.x, at.y, piece);
        const double values[4] = {j.x_i, j.x_j, j.y_i, j.y_j};
        std::copy_n(values, 4, derivatives + 4 * i);
    });
}

}  // namespace anamorph
