// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/block_machine.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/error.h"

namespace anamorph::machine {
namespace {

// The most pixels of the output image memory.
constexpr int kMostPixels = 1 << 28;

/// Pixels whose centres lie in [low, high], of a row of `count`.
struct PixelRange {
    int first, last;  ///< none where last < first

    PixelRange(double low, double high, int count)
        : first(static_cast<int>(std::ceil(std::clamp(low - 0.5, 0.0, double(count))))),
          last(static_cast<int>(std::floor(std::clamp(high - 0.5, -1.0, count - 1.0)))) {}
};

/// A block on the screen: its parallelogram, and the linear map from pixels to texels (2.11).
class BlockOnScreen {
  public:
    BlockOnScreen(const surface::OkaBlock& block, const Size& picture, const Size& screen)
        : m_x(block.centre.x + 0.5 * screen.width), m_y(block.centre.y + 0.5 * screen.height) {
        // a: pixels of the screen by texels.
        const double a11 = block.by_u.x / picture.width, a12 = block.by_v.x / picture.height,
                     a21 = block.by_u.y / picture.width, a22 = block.by_v.y / picture.height;
        const double r = 1 / (a11 * a22 - a12 * a21);
        m_b[0] = r * a22;
        m_b[1] = -r * a12;
        m_b[2] = -r * a21;
        m_b[3] = r * a11;
        m_u = block.u * picture.width;
        m_v = block.v * picture.height;
        m_low = {block.u0 * picture.width, block.v0 * picture.height};
        m_high = {block.u1 * picture.width, block.v1 * picture.height};
        for (const double u : {m_low.x, m_high.x})
            for (const double v : {m_low.y, m_high.y}) {
                const double x = m_x + a11 * (u - m_u) + a12 * (v - m_v),
                             y = m_y + a21 * (u - m_u) + a22 * (v - m_v);
                m_x0 = std::min(m_x0, x);
                m_x1 = std::max(m_x1, x);
                m_y0 = std::min(m_y0, y);
                m_y1 = std::max(m_y1, y);
            }
    }

    /// Has it an inverse?
    bool is_flat() const {
        return !std::isfinite(m_b[0] + m_b[1] + m_b[2] + m_b[3]) || !std::isfinite(m_x0 + m_x1 + m_y0 + m_y1);
    }
    PixelRange columns(const Size& screen) const { return {m_x0, m_x1, screen.width}; }
    PixelRange rows(const Size& screen) const { return {m_y0, m_y1, screen.height}; }

    /// Does it meet the rectangle from the first to the last pixel centre of a segment? Two convex shapes that are apart
    /// are so along a side of one of them; the sides of the rectangle are looked at by whoever chooses segments.
    bool meets(int x0, int y0, int x1, int y1) const {
        double u[2] = {HUGE_VAL, -HUGE_VAL}, v[2] = {HUGE_VAL, -HUGE_VAL};
        for (const int x : {x0, x1})
            for (const int y : {y0, y1}) {
                const Point<double> at = texel(x, y);
                u[0] = std::min(u[0], at.x);
                u[1] = std::max(u[1], at.x);
                v[0] = std::min(v[0], at.y);
                v[1] = std::max(v[1], at.y);
            }
        return u[1] >= m_low.x && u[0] <= m_high.x && v[1] >= m_low.y && v[0] <= m_high.y;
    }
    /// The exact inverse at a pixel's centre.
    Point<double> texel(int x, int y) const {
        const double dx = x + 0.5 - m_x, dy = y + 0.5 - m_y;
        return {m_u + m_b[0] * dx + m_b[1] * dy, m_v + m_b[2] * dx + m_b[3] * dy};
    }
    bool holds(const Point<double>& at) const {
        return at.x >= m_low.x && at.x <= m_high.x && at.y >= m_low.y && at.y <= m_high.y;
    }
    const double (&inverse() const)[4] { return m_b; }
    /// The pixel nearest to the centre, from which addresses are counted.
    int reference_x(const Size& screen) const { return nearest_pixel(m_x, screen.width); }
    int reference_y(const Size& screen) const { return nearest_pixel(m_y, screen.height); }

  private:
    static int nearest_pixel(double at, int count) {
        return static_cast<int>(std::clamp(std::floor(at), 0.0, count - 1.0));
    }

    double m_x, m_y, m_u, m_v, m_b[4];
    Point<double> m_low{}, m_high{};
    double m_x0 = HUGE_VAL, m_x1 = -HUGE_VAL, m_y0 = HUGE_VAL, m_y1 = -HUGE_VAL;
};

/// The address controller and the pixel processor's addresses.
class Drawer {
  public:
    Drawer(const BlockMachine& machine, const Size& picture, BlockFrame& frame)
        : m_machine(machine),
          m_picture(picture),
          m_frame(frame),
          m_format{NumberFormat::Kind::fixed, machine.address_bits, machine.fraction_bits} {}

    void draw(const surface::OkaBlock& block) {
        const BlockOnScreen on_screen(block, m_picture, m_frame.screen);
        if (on_screen.is_flat()) return;
        const double(&b)[4] = on_screen.inverse();
        m_frame.steps.push_back({b[0], b[2], b[1], b[3]});
        set_addresses(on_screen);
        const PixelRange columns = on_screen.columns(m_frame.screen), rows = on_screen.rows(m_frame.screen);
        if (columns.last < columns.first || rows.last < rows.first) return;
        const int side = m_machine.segment;
        for (int y = rows.first / side * side; y <= rows.last; y += side)
            for (int x = columns.first / side * side; x <= columns.last; x += side) {
                const int x1 = std::min(x + side, m_frame.screen.width) - 1,
                          y1 = std::min(y + side, m_frame.screen.height) - 1;
                if (!on_screen.meets(x, y, x1, y1)) continue;
                ++m_frame.counts.segments;
                draw_segment(on_screen, {x, y, x1 + 1, y1 + 1});
            }
    }

  private:
    /// Eq. 2.12 in fixed point: the address at the reference pixel, and what it gains by a step.
    void set_addresses(const BlockOnScreen& block) {
        m_x = block.reference_x(m_frame.screen);
        m_y = block.reference_y(m_frame.screen);
        const Point<double> at = block.texel(m_x, m_y);
        m_beyond = false;
        m_at = {nearest(m_format, at.x, m_beyond), nearest(m_format, at.y, m_beyond)};
        for (std::size_t i = 0; i < 4; ++i) m_step[i] = nearest(m_format, block.inverse()[i], m_beyond);
    }

    void draw_segment(const BlockOnScreen& block, const Box& box) {
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x) {
                if (!block.holds(block.texel(x, y))) continue;
                bool beyond = m_beyond;
                const double dx = x - m_x, dy = y - m_y;
                const std::size_t k = m_frame.index(x, y);
                m_frame.addresses[k] = {nearest(m_format, m_at.x + dx * m_step[0] + dy * m_step[1], beyond),
                                        nearest(m_format, m_at.y + dx * m_step[2] + dy * m_step[3], beyond)};
                m_frame.block[k] = static_cast<std::int32_t>(m_frame.steps.size()) - 1;
                m_frame.beyond[k] = beyond;
                ++m_frame.counts.pixels;
            }
    }

    const BlockMachine& m_machine;
    Size m_picture;
    BlockFrame& m_frame;
    NumberFormat m_format;
    int m_x = 0, m_y = 0;
    Point<double> m_at{};
    double m_step[4] = {};
    bool m_beyond = false;
};

}  // namespace

BlockFrame run_block_machine(const BlockMachine& machine, const surface::DrapedSurface& surface,
                             const surface::Camera& camera, const Size& picture) {
    const surface::OkaBlocks cut{machine.block, machine.overlap, false};
    const Size count = surface::oka_block_count(picture, cut);
    std::vector<surface::OkaBlock> blocks;
    for (int j = 0; j < count.height; ++j)
        for (int i = 0; i < count.width; ++i)
            if (surface::OkaBlock block; surface::oka_block(surface, camera, picture, cut, i, j, block))
                blocks.push_back(block);
    // The list that hidden surfaces are removed by: from the farthest to the nearest.
    std::stable_sort(
        blocks.begin(), blocks.end(),
        [](const surface::OkaBlock& a, const surface::OkaBlock& b) { return a.centre.z > b.centre.z; });
    BlockFrame frame;
    frame.screen = camera.screen();
    if (double(frame.screen.width) * frame.screen.height > kMostPixels)
        throw Error("machine: a picture of " + std::to_string(frame.screen.width) + "x" +
                    std::to_string(frame.screen.height) + " does not fit its memory: must have at most " +
                    std::to_string(kMostPixels) + " pixels");
    const std::size_t pixels =
        static_cast<std::size_t>(frame.screen.width) * static_cast<std::size_t>(frame.screen.height);
    frame.addresses.resize(pixels);
    frame.beyond.resize(pixels);
    frame.block.resize(pixels, BlockFrame::kNone);
    frame.counts.blocks = static_cast<std::int64_t>(blocks.size());
    Drawer drawer(machine, picture, frame);
    for (const surface::OkaBlock& block : blocks) drawer.draw(block);
    frame.counts.saturated = std::count(frame.beyond.begin(), frame.beyond.end(), true);
    return frame;
}

}  // namespace anamorph::machine
