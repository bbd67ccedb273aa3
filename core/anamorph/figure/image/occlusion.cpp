// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/image/occlusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <limits>

namespace anamorph::figure {
namespace {

/// Bands of rows are looked at one by one; each has all of its bodies.
constexpr std::size_t kOcclusionBands = 4;
/// Of all bodies, so many of the nearest are put in order first. What they hide needs no order.
constexpr double kNearShare = 1.0 / 8;

/// Added to the box of a body in pixels, on each side, beside 2^-20 of its size: vertices are snapped to 1/256 of a pixel, and axes are
/// rounded by 2^-24 of their length.
constexpr double kBoxMargin = 1.0 / 64;

/// What a body may cover, in pixels, x1 and y1 beyond the last ones.
struct OcclusionBox {
    std::int16_t x0, x1, y0, y1;
    float nearest;  ///< z / w; never more than that of a point of the body
    std::uint32_t body;

    bool empty() const { return x0 >= x1 || y0 >= y1; }
};

/// A coordinate of clip space over the sphere of a body: at + slope . s.
struct Clip {
    double at;
    glm::dvec3 slope;
};

/// The least and the greatest of x / w over a body: where the plane x - X w = 0 touches the sphere. With X = X0 + D, where X0 is the centre's,
/// |gx' - D gw|^2 = (D cw)^2, gx' = gx - X0 gw; of that, (cw^2 - gw^2) D^2 + 2 (gx'.gw) D - gx'^2 = 0. Nothing cancels however small
/// the body is.
struct Extent {
    double middle, least, greatest;  ///< the last two as differences from the middle

    /// `q`: cw^2 - gw^2, and what 1 is divided by it and by cw.
    Extent(const Clip& x, const Clip& w, double q, double per_q, double per_w) : middle(x.at * per_w) {
        const glm::dvec3 across = x.slope - middle * w.slope;
        const double p = glm::dot(across, w.slope), root = std::sqrt(p * p + q * glm::dot(across, across));
        least = (-p - root) * per_q;
        greatest = (root - p) * per_q;
    }
};

/// A body as a picture sees it.
struct ClippedBody {
    Clip x, y, z, w;

    ClippedBody(const OccludedBodies::Body& body, const glm::dmat4& rows) {
        const glm::dvec4 center(body.center[0], body.center[1], body.center[2], 1);
        Clip* const clips[4] = {&x, &y, &z, &w};
        for (int k = 0; k < 4; ++k) {
            const glm::dvec4& row = rows[k];
            clips[k]->at = glm::dot(row, center);
            for (int c = 0; c < 3; ++c)
                clips[k]->slope[c] = row.x * double(body.axes[3 * c]) + row.y * double(body.axes[3 * c + 1]) +
                                     row.z * double(body.axes[3 * c + 2]);
        }
    }

    /// cw^2 - gw^2 of Extent: with cw positive, it is where all of the body is before the eye.
    double before_eye() const { return w.at * w.at - glm::dot(w.slope, w.slope); }
};

/// The pixels whose middles are within an extent: -1 to 1 are `size` pixels.
std::array<std::int16_t, 2> pixels_of(const Extent& extent, int size) {
    const double scale = 0.5 * size, middle = (extent.middle + 1) * scale - 0.5;
    const double margin = kBoxMargin + 0x1p-20 * scale * (extent.greatest - extent.least);
    const double from = std::clamp(std::ceil(middle + scale * extent.least - margin), 0.0, double(size)),
                 to =
                     std::clamp(std::floor(middle + scale * extent.greatest + margin) + 1, 0.0, double(size));
    return {static_cast<std::int16_t>(from), static_cast<std::int16_t>(to)};
}

OcclusionBox box_of(const ClippedBody& seen, double q, const OcclusionView& view, std::uint32_t body) {
    const double per_q = 1 / q, per_w = 1 / seen.w.at;
    const auto [x0, x1] = pixels_of(Extent(seen.x, seen.w, q, per_q, per_w), view.width);
    const auto [y0, y1] = pixels_of(Extent(seen.y, seen.w, q, per_q, per_w), view.height);
    const Extent depth(seen.z, seen.w, q, per_q, per_w);
    return {x0, x1, y0, y1, static_cast<float>(depth.middle + depth.least - view.step), body};
}

/// The part of a picture in a band of rows, with the depths that are certainly hidden beyond.
class Band {
  public:
    Band(const OcclusionView& view, const glm::dmat4& rows, int first, int last)
        : m_view(view), m_rows(rows), m_first(first), m_last(last) {
        m_depths.assign(static_cast<std::size_t>(last - first) * static_cast<std::size_t>(view.width),
                        std::numeric_limits<float>::infinity());
    }

    /// Takes boxes that meet the band, from the nearest on; appends to `found` the bodies that may show.
    void take(std::vector<OcclusionBox>& boxes, const std::vector<OccludedBodies::Body>& bodies,
              std::vector<std::uint32_t>& found) {
        std::sort(boxes.begin(), boxes.end(), [](const OcclusionBox& a, const OcclusionBox& b) {
            return a.nearest != b.nearest ? a.nearest < b.nearest : a.body < b.body;
        });
        for (const OcclusionBox& box : boxes) {
            if (!may_show(box)) continue;
            found.push_back(box.body);
            cover(box, ClippedBody(bodies[box.body], m_rows));
        }
    }

    /// Is there a pixel in which nothing nearer is known?
    bool may_show(const OcclusionBox& box) const {
        for (int y = std::max<int>(box.y0, m_first); y < std::min<int>(box.y1, m_last); ++y) {
            const float* row = depths(y);
            for (int x = box.x0; x < box.x1; ++x)
                if (!(row[x] < box.nearest)) return true;
        }
        return false;
    }

    /// Leaves its depths in the pixels that a body certainly covers. The ray of a pixel is where x - X w and y - Y w are 0, two planes
    /// g . s = -a in the sphere's space; its point next to the centre is (-a1 (g2 x d) - a2 (d x g1)) / |d|^2 with d = g1 x g2. A step across
    /// the picture by D moves that by no more than D w (|g1| + |g2|) / |d|.
    void cover(const OcclusionBox& box, const ClippedBody& body) {
        const double across = 2.0 / m_view.width, up = 2.0 / m_view.height;
        for (int y = std::max<int>(box.y0, m_first); y < std::min<int>(box.y1, m_last); ++y) {
            const double yy = (y + 0.5) * up - 1, a2 = body.y.at - yy * body.w.at;
            const glm::dvec3 g2 = body.y.slope - yy * body.w.slope;
            const double length2 = glm::length(g2);
            float* row = depths(y);
            for (int x = box.x0; x < box.x1; ++x) {
                if (row[x] < box.nearest) continue;
                const double xx = (x + 0.5) * across - 1, a1 = body.x.at - xx * body.w.at;
                const glm::dvec3 g1 = body.x.slope - xx * body.w.slope, d = glm::cross(g1, g2);
                const double square = glm::dot(d, d);
                if (!(square > 0)) continue;
                const glm::dvec3 next = (-a1 * glm::cross(g2, d) - a2 * glm::cross(d, g1)) / square;
                const double length = std::sqrt(square), moved = m_view.reach * body.w.at *
                                                                 (across * length2 + up * glm::length(g1)) /
                                                                 length;
                const double from_middle = glm::length(next) + moved;
                if (!(from_middle < 1 - kRounded)) continue;
                // Both ends of the way through the sphere: the nearer one is seen.
                const glm::dvec3 half = d * (std::sqrt(1 - glm::dot(next, next)) / length);
                const double depth = std::min(depth_of(body, next + half), depth_of(body, next - half));
                row[x] = std::min(row[x], static_cast<float>(depth + m_view.step));
            }
        }
    }

  private:
    /// Axes are rounded by 2^-24 of their length, and so is where a ray passes the centre, to a few times that.
    static constexpr double kRounded = 0x1p-20;

    static double depth_of(const ClippedBody& body, const glm::dvec3& s) {
        return (body.z.at + glm::dot(body.z.slope, s)) / (body.w.at + glm::dot(body.w.slope, s));
    }
    const float* depths(int y) const {
        return m_depths.data() + static_cast<std::ptrdiff_t>(y - m_first) * m_view.width;
    }
    float* depths(int y) { return m_depths.data() + static_cast<std::ptrdiff_t>(y - m_first) * m_view.width; }

    const OcclusionView& m_view;
    const glm::dmat4& m_rows;
    int m_first, m_last;
    std::vector<float> m_depths;
};

}  // namespace

void OccludedBodies::add(const glm::dvec3& center, const glm::dmat3& axes) {
    Body& body = m_bodies.emplace_back();
    for (int k = 0; k < 3; ++k) {
        body.center[k] = center[k];
        for (int c = 0; c < 3; ++c) body.axes[3 * c + k] = static_cast<float>(axes[c][k]);
    }
    body.drawn = true;
}

std::vector<std::uint32_t> OccludedBodies::seen(const OcclusionView& view,
                                                const ParallelFor& parallel_for) const {
    const glm::dmat4 rows = glm::transpose(view.to_clip);
    constexpr std::size_t kBatch = 4096;
    struct Batch {
        std::array<std::vector<OcclusionBox>, kOcclusionBands> boxes;  ///< that meet each band
        bool in_front = true;
    };
    std::array<int, kOcclusionBands + 1> edges;
    for (std::size_t i = 0; i <= kOcclusionBands; ++i)
        edges[i] = static_cast<int>(static_cast<std::size_t>(view.height) * i / kOcclusionBands);
    std::vector<Batch> batches((m_bodies.size() + kBatch - 1) / kBatch);
    parallel_for(static_cast<std::int64_t>(batches.size()), [&](std::int64_t number) {
        Batch& batch = batches[static_cast<std::size_t>(number)];
        for (auto& boxes : batch.boxes) boxes.reserve(kBatch / 2);
        const std::size_t from = static_cast<std::size_t>(number) * kBatch;
        for (std::size_t i = from; i < std::min(from + kBatch, m_bodies.size()); ++i) {
            if (!m_bodies[i].drawn) continue;
            const ClippedBody seen(m_bodies[i], rows);
            const double q = seen.before_eye();
            if (!(q > 0 && seen.w.at > 0 && std::isfinite(q + seen.x.at + seen.y.at + seen.z.at))) {
                batch.in_front = false;
                return;
            }
            const OcclusionBox box = box_of(seen, q, view, static_cast<std::uint32_t>(i));
            if (box.empty()) continue;
            for (std::size_t k = 0; k < kOcclusionBands; ++k)
                if (box.y0 < edges[k + 1] && box.y1 > edges[k]) batch.boxes[k].push_back(box);
        }
    });
    const bool in_front =
        std::all_of(batches.begin(), batches.end(), [](const Batch& batch) { return batch.in_front; });
    std::vector<std::uint8_t> seen(m_bodies.size(), !in_front);
    std::array<std::vector<std::uint32_t>, kOcclusionBands> found;
    if (in_front)
        parallel_for(kOcclusionBands, [&](std::int64_t number) {
            const auto k = static_cast<std::size_t>(number);
            // The depth of the last of the near share.
            std::vector<float> sample;
            for (const Batch& batch : batches)
                for (std::size_t i = 0; i < batch.boxes[k].size(); i += 64)
                    sample.push_back(batch.boxes[k][i].nearest);
            if (sample.empty()) return;
            const auto last =
                sample.begin() + static_cast<std::ptrdiff_t>(kNearShare * double(sample.size()));
            std::nth_element(sample.begin(), last, sample.end());
            const float near = *last;
            Band band(view, rows, edges[k], edges[k + 1]);
            std::vector<OcclusionBox> boxes;
            for (const Batch& batch : batches)
                for (const OcclusionBox& box : batch.boxes[k])
                    if (box.nearest <= near) boxes.push_back(box);
            band.take(boxes, m_bodies, found[k]);
            boxes.clear();
            for (const Batch& batch : batches)
                for (const OcclusionBox& box : batch.boxes[k])
                    if (!(box.nearest <= near) && band.may_show(box)) boxes.push_back(box);
            band.take(boxes, m_bodies, found[k]);
        });
    for (const auto& bodies : found)
        for (const std::uint32_t body : bodies) seen[body] = 1;
    std::vector<std::uint32_t> numbers;
    for (std::size_t i = 0; i < seen.size(); ++i)
        if (seen[i] && m_bodies[i].drawn) numbers.push_back(static_cast<std::uint32_t>(i));
    return numbers;
}

}  // namespace anamorph::figure
