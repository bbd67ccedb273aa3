// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/outline/stroke_pixels.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <glm/common.hpp>
#include <glm/geometric.hpp>

namespace anamorph::figure {
namespace {

constexpr int kSampleRows = 16, kPixelSamples = kSampleRows * kSampleRows;
// Half the diagonal of a pixel, and a little for rounding.
constexpr double kHalfPixel = 0.7072;

double square_distance(const glm::dvec2& p, const glm::dvec2& a, const glm::dvec2& b) {
    const glm::dvec2 d = b - a, from = p - a;
    const double along = glm::dot(from, d), length = glm::dot(d, d);
    const double t = length > 0 ? std::clamp(along / length, 0.0, 1.0) : 0.0;
    const glm::dvec2 rest = from - t * d;
    return glm::dot(rest, rest);
}

/// A dot's radius is the width of lines.
double half_width(const Stroke& stroke, double line_width) {
    return stroke.kind == StrokeKind::dot ? line_width : 0.5 * line_width;
}

glm::dvec2 point_after(const Stroke& stroke, std::size_t k) {
    return stroke.points[std::min(k + 1, stroke.points.size() - 1)];
}

std::size_t segments_of(const Stroke& stroke) {
    return std::max<std::size_t>(1, stroke.points.size() - 1);
}

/// The pixels that may be within `width` of points.
Box box_about(const glm::dvec2& low, const glm::dvec2& high, double width) {
    const auto pixel = [](double at) { return static_cast<int>(std::clamp(at, -1e9, 1e9)); };
    return {pixel(std::floor(low.x - width)), pixel(std::floor(low.y - width)),
            pixel(std::ceil(high.x + width)), pixel(std::ceil(high.y + width))};
}

/// What a stroke covers of the pixels of a box.
class StrokeCover {
  public:
    explicit StrokeCover(const Box& box)
        : m_box(box),
          m_pixel(static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height()), kNone) {}

    void add(const glm::dvec2& a, const glm::dvec2& b, double half) {
        const Box box = intersection(box_about(glm::min(a, b), glm::max(a, b), half + 1), m_box);
        const double all = std::max(0.0, half - kHalfPixel), none = half + kHalfPixel;
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x) {
                const double square = square_distance({x + 0.5, y + 0.5}, a, b);
                if (square >= none * none) continue;
                int& at = m_pixel[index(x, y)];
                if (at == kNone) {
                    at = static_cast<int>(m_masks.size());
                    m_masks.emplace_back();
                    m_touched.push_back({x, y});
                }
                std::bitset<kPixelSamples>& mask = m_masks[static_cast<std::size_t>(at)];
                if (half > kHalfPixel && square <= all * all)
                    mask.set();
                else
                    sample(x, y, a, b, half * half, mask);
            }
    }

    /// body(x, y, share) of the pixels that are covered; then nothing is.
    template <class Body>
    void take(const Body& body) {
        for (std::size_t k = 0; k < m_touched.size(); ++k) {
            const auto [x, y] = m_touched[k];
            m_pixel[index(x, y)] = kNone;
            if (const std::size_t count = m_masks[k].count())
                body(x, y, static_cast<double>(count) / kPixelSamples);
        }
        m_touched.clear();
        m_masks.clear();
    }

  private:
    static constexpr int kNone = -1;
    struct Place {
        int x, y;
    };

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - m_box.y0) * static_cast<std::size_t>(m_box.width()) +
               static_cast<std::size_t>(x - m_box.x0);
    }

    static void sample(int x, int y, const glm::dvec2& a, const glm::dvec2& b, double square,
                       std::bitset<kPixelSamples>& mask) {
        for (int i = 0; i < kPixelSamples; ++i) {
            const int column = i % kSampleRows, row = i / kSampleRows;
            const glm::dvec2 p(x + (column + 0.5) / kSampleRows, y + (row + 0.5) / kSampleRows);
            if (square_distance(p, a, b) <= square) mask.set(static_cast<std::size_t>(i));
        }
    }

    Box m_box;
    std::vector<int> m_pixel;  ///< of the box: the position in the two below
    std::vector<Place> m_touched;
    std::vector<std::bitset<kPixelSamples>> m_masks;
};

}  // namespace

StrokePixels::StrokePixels(Drawing drawing) : m_drawing(std::move(drawing)) {
    for (const Stroke& stroke : m_drawing.strokes) {
        glm::dvec2 low = stroke.points[0], high = low;
        for (const glm::dvec2& p : stroke.points) low = glm::min(low, p), high = glm::max(high, p);
        m_boxes.push_back(box_about(low, high, half_width(stroke, m_drawing.line_width) + 1));
    }
}

std::vector<LinePixel> StrokePixels::pixels(const Box& box) const {
    std::vector<LinePixel> out(static_cast<std::size_t>(box.width()) *
                               static_cast<std::size_t>(box.height()));
    StrokeCover cover(box);
    for (std::size_t i = 0; i < m_boxes.size(); ++i) {
        if (intersection(m_boxes[i], box).empty()) continue;
        const Stroke& stroke = m_drawing.strokes[i];
        const double half = half_width(stroke, m_drawing.line_width);
        for (std::size_t k = 0; k < segments_of(stroke); ++k)
            cover.add(stroke.points[k], point_after(stroke, k), half);
        const glm::vec3 color(stroke.color / 255.0);
        cover.take([&](int x, int y, double share) {
            LinePixel& p = out[static_cast<std::size_t>((y - box.y0) * box.width() + (x - box.x0))];
            const auto c = static_cast<float>(share);
            p.r += c * (color.r - p.r), p.g += c * (color.g - p.g), p.b += c * (color.b - p.b);
            p.a += c * (1 - p.a);
        });
    }
    return out;
}

}  // namespace anamorph::figure
