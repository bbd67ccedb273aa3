// SPDX-License-Identifier: Apache-2.0
#include "inverse_points.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace anamorph::command {
namespace {

constexpr int kStarts = 65, kCells = 32, kSteps = 40;
// Starts that are kept of each cell, and how many of these are tried for a point.
constexpr std::size_t kKept = 16, kTries = 4;
constexpr double kMet = 1e-9, kLeastStride = 1e-3;

double squared_distance(const Point<double>& a, const Point<double>& b) {
    return (a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y);
}

}  // namespace

InversePoints::InversePoints(const BlockMap& map, const Box& data, const Size& source)
    : m_map(map), m_data(data), m_met(kMet * std::max(source.width, source.height)) {
    for (int j = 0; j < kStarts; ++j)
        for (int i = 0; i < kStarts; ++i) {
            const Point<double> at{data.x0 + (i + 0.5) / kStarts * data.width(),
                                   data.y0 + (j + 0.5) / kStarts * data.height()};
            if (const std::optional<Point<double>> seen = source_of(at)) m_starts.push_back({at, *seen});
        }
    if (m_starts.empty()) return;
    Point<double> high = m_low = m_starts[0].source;
    for (const Start& start : m_starts) {
        m_low = {std::min(m_low.x, start.source.x), std::min(m_low.y, start.source.y)};
        high = {std::max(high.x, start.source.x), std::max(high.y, start.source.y)};
    }
    m_size = {std::max(high.x - m_low.x, m_met), std::max(high.y - m_low.y, m_met)};
    std::vector<std::pair<double, std::uint32_t>> order(m_starts.size());
    const auto kept = static_cast<std::ptrdiff_t>(std::min(kKept, order.size()));
    for (int j = 0; j < kCells; ++j)
        for (int i = 0; i < kCells; ++i) {
            const Point<double> middle{m_low.x + (i + 0.5) / kCells * m_size.x,
                                       m_low.y + (j + 0.5) / kCells * m_size.y};
            for (std::uint32_t k = 0; k < order.size(); ++k)
                order[k] = {squared_distance(m_starts[k].source, middle), k};
            // Of those that are as far the first.
            std::nth_element(order.begin(), order.begin() + kept - 1, order.end());
            std::vector<std::uint32_t>& near = m_near.emplace_back();
            for (auto at = order.begin(); at != order.begin() + kept; ++at) near.push_back(at->second);
        }
}

std::optional<Point<double>> InversePoints::source_of(const Point<double>& at) const {
    if (!(at.x >= m_data.x0 && at.x <= m_data.x1 && at.y >= m_data.y0 && at.y <= m_data.y1)) return {};
    const int piece = m_map.piece_at(at.x, at.y);
    Point<double> p{};
    int source_piece = 0;
    if (piece < 0 || !m_map.exact(at.x, at.y, piece, p, source_piece) || !std::isfinite(p.x + p.y)) return {};
    return p;
}

std::size_t InversePoints::cell_of(const Point<double>& p) const {
    const auto part = [](double share) {
        return static_cast<std::size_t>(std::clamp(share * kCells, 0.0, kCells - 1.0));
    };
    return part((p.y - m_low.y) / m_size.y) * kCells + part((p.x - m_low.x) / m_size.x);
}

std::optional<Point<double>> InversePoints::newton(const Start& start, const Point<double>& wanted) const {
    Point<double> at = start.at, rest = wanted - start.source;
    double off = std::hypot(rest.x, rest.y), stride = 1;
    for (int step = 0; step < kSteps && off > m_met && stride > kLeastStride; ++step) {
        const Jacobian j = m_map.jacobian(at.x, at.y, m_map.piece_at(at.x, at.y));
        const double determinant = j.x_i * j.y_j - j.x_j * j.y_i;
        const Point<double> way{(j.y_j * rest.x - j.x_j * rest.y) / determinant,
                                (j.x_i * rest.y - j.y_i * rest.x) / determinant};
        // Not beyond the picture, on whose edge a point may lie.
        const Point<double> tried{std::clamp(at.x + stride * way.x, double(m_data.x0), double(m_data.x1)),
                                  std::clamp(at.y + stride * way.y, double(m_data.y0), double(m_data.y1))};
        const std::optional<Point<double>> seen = source_of(tried);
        const double now = seen ? std::hypot(wanted.x - seen->x, wanted.y - seen->y) : HUGE_VAL;
        if (now < off) {
            at = tried;
            rest = wanted - *seen;
            off = now;
            stride = std::min(1.0, 2 * stride);
        } else {
            stride /= 2;
        }
    }
    if (!(off <= m_met)) return {};
    return at;
}

std::optional<Point<double>> InversePoints::of(const Point<double>& wanted) const {
    if (m_starts.empty()) return {};
    std::array<std::pair<double, std::uint32_t>, kKept> order{};
    std::size_t count = 0;
    for (const std::uint32_t k : m_near[cell_of(wanted)])
        order[count++] = {squared_distance(m_starts[k].source, wanted), k};
    const std::size_t tries = std::min(kTries, count);
    std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(tries),
                      order.begin() + static_cast<std::ptrdiff_t>(count));
    for (std::size_t k = 0; k < tries; ++k)
        if (const std::optional<Point<double>> found = newton(m_starts[order[k].second], wanted))
            return found;
    return {};
}

}  // namespace anamorph::command
