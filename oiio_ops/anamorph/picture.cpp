// SPDX-License-Identifier: Apache-2.0
#include "anamorph/picture.h"

#include <algorithm>
#include <vector>

#include "anamorph/image/pixel.h"
#include "anamorph/image/pyramid.h"

namespace anamorph {

std::string filtering_space(const ParameterValues& values, const ReprojectRequest& request) {
    return request.options.output == Output::color ? values.text("colorspace") : "";
}

SourceStack::SourceStack(std::unique_ptr<Source> image, const OIIO::ImageSpec& spec,
                         const ReprojectRequest& request, const std::string& colorspace)
    : m_image(std::move(image)), m_top(m_image.get()) {
    if (!colorspace.empty()) {
        m_space = WorkingSpace::make(colorspace, spec);
        if (m_space) {
            m_working = std::make_unique<WorkingSource>(*m_top, m_space);
            m_top = m_working.get();
        }
    }
    const std::vector<Piece>& pieces = request.source.pieces();
    const int columns = request.source.width() / pieces[0].box.width();
    const int rows = request.source.height() / pieces[0].box.height();
    // Coarser levels of a file blend faces that do not halve.
    if (auto* file = dynamic_cast<CacheSource*>(m_image.get()); file && columns * rows > 1)
        file->keep_first_level();
    m_pyramid = std::make_unique<Pyramid>(*m_top, columns, rows);
    m_top = m_pyramid.get();
}

SourceStack::~SourceStack() = default;

std::string SourceStack::error() const {
    const auto* file = dynamic_cast<const CacheSource*>(m_image.get());
    const std::string error = file ? file->error() : "";
    return error.empty() ? "the source cannot be read" : error;
}

void Picture::draw_raw(const Box& box, const ImageView& view, const ParallelFor& parallel_for) const {
    if (!m_reprojection.draw(&m_source.top(), box, view, parallel_for)) throw Error(m_source.error());
}

void Picture::draw(const Box& box, const ImageView& view, const ParallelFor& parallel_for) const {
    if (!m_source.space()) return draw_raw(box, view, parallel_for);
    // In float and the working space, then back, row by row.
    const std::size_t row = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(view.channels);
    std::vector<float> pixels(row * static_cast<std::size_t>(box.height()));
    draw_raw(box,
             packed_view(reinterpret_cast<std::byte*>(pixels.data()), PixelType::float32, box.width(),
                         box.height(), view.channels),
             parallel_for);
    parallel_for(box.height(), [&](std::int64_t y) {
        float* values = pixels.data() + row * static_cast<std::size_t>(y);
        m_source.space()->from_working(values, box.width(), 1);
        for (int x = 0; x < box.width(); ++x)
            for (int c = 0; c < view.channels; ++c)
                store_channel(values[static_cast<std::size_t>(x * view.channels + c)],
                              view.at(x, y) + c * size_of(view.type), view.type);
    });
}

}  // namespace anamorph
