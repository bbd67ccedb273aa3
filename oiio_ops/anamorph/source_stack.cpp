// SPDX-License-Identifier: Apache-2.0
#include "anamorph/source_stack.h"

#include <algorithm>
#include <vector>

#include "anamorph/face_source.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/orientation.h"

namespace anamorph {

std::string filtering_space(const ParameterValues& values, PixelKind pixels) {
    return pixels == PixelKind::color && values.knows("colorspace") ? values.text("colorspace") : "";
}

SourceStack::SourceStack(std::unique_ptr<Source> image, const OIIO::ImageSpec& spec, const SourceFaces& faces,
                         const std::string& colorspace, const OverSource& over)
    : m_image(std::move(image)), m_faces(faces), m_full(m_image.get()) {
    if (const StoredOrder order(spec); !order.is_upright()) {
        m_upright = std::make_unique<UprightSource>(*m_image, order);
        m_full = m_upright.get();
    }
    if (!colorspace.empty()) {
        m_space = WorkingSpace::make(colorspace, spec);
        if (m_space) {
            m_working = std::make_unique<WorkingSource>(*m_full, m_space);
            m_full = m_working.get();
        }
    }
    m_over = over(*m_full);
    if (m_over) m_full = m_over.get();
    // Coarser levels of a file blend faces that do not halve.
    if (auto* file = dynamic_cast<CacheSource*>(m_image.get()); file && faces.columns * faces.rows > 1)
        file->keep_first_level();
    m_pyramid = levels_over(*m_full);
    m_top = m_pyramid.get();
}

SourceStack::~SourceStack() = default;

std::unique_ptr<Source> SourceStack::levels_over(const Source& source) const {
    return std::make_unique<Pyramid>(source, m_faces.columns, m_faces.rows);
}

const CacheSource* SourceStack::file() const {
    return dynamic_cast<const CacheSource*>(m_image.get());
}

std::string SourceStack::error() const {
    if (const auto* faces = dynamic_cast<const FaceSource*>(m_image.get())) return faces->error();
    return file() ? file()->error() : "";
}

SourceStacks make_source_stacks(std::vector<std::unique_ptr<Source>> images,
                                const std::vector<OIIO::ImageSpec>& specs, const Pictures& pictures,
                                const std::string& colorspace) {
    SourceStacks stacks;
    for (std::size_t i = 0; i < images.size(); ++i) {
        const auto over = [&](const Source& source) { return pictures.over_source(i, source); };
        stacks.push_back(images[i] ? std::make_unique<const SourceStack>(
                                         std::move(images[i]), specs[i],
                                         i == 0 ? pictures.faces() : SourceFaces{}, colorspace, over)
                                   : nullptr);
    }
    return stacks;
}

namespace {

void draw_in_space(const SolvedPicture& picture, const SourceStacks& stacks, const Box& box,
                   const ImageView& view, const ParallelFor& parallel_for) {
    std::vector<const Source*> tops;
    for (const auto& stack : stacks) tops.push_back(stack ? &stack->top() : nullptr);
    if (picture.draw(tops, box, view, parallel_for)) return;
    for (const auto& stack : stacks)
        if (const std::string error = stack ? stack->error() : ""; !error.empty()) throw Error(error);
    throw Error("a source cannot be read");
}

}  // namespace

void draw_picture(const SolvedPicture& picture, const SourceStacks& stacks, const Box& box,
                  const ImageView& view, const ParallelFor& parallel_for) {
    const WorkingSpace* space = stacks.empty() || !stacks[0] ? nullptr : stacks[0]->space();
    if (!space) return draw_in_space(picture, stacks, box, view, parallel_for);
    // In float and the working space, then back, row by row.
    const std::size_t row = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(view.channels);
    std::vector<float> pixels(row * static_cast<std::size_t>(box.height()));
    draw_in_space(picture, stacks, box,
                  packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, box.width(),
                              box.height(), view.channels),
                  parallel_for);
    parallel_for(box.height(), [&](std::int64_t y) {
        float* values = pixels.data() + row * static_cast<std::size_t>(y);
        space->from_working(values, box.width(), 1, view.channels);
        for (int x = 0; x < box.width(); ++x)
            for (int c = 0; c < view.channels; ++c)
                store_channel(values[static_cast<std::size_t>(x * view.channels + c)],
                              view.at(x, y) + c * size_of(view.type), view.type);
    });
}

}  // namespace anamorph
