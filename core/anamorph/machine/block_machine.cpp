// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/block_machine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <memory>
#include <numeric>
#include <string>

#include "anamorph/error.h"

namespace anamorph::machine {
namespace {

// The most pixels of the output image memory.
constexpr int kMostPixels = 1 << 28;
constexpr std::size_t kMostSegment = static_cast<std::size_t>(kSegmentRow.most);

/// Pixels whose centres lie in [low, high], of a row of `count`.
struct PixelRange {
    int first, last;  ///< none where last < first

    PixelRange(double low, double high, int count)
        : first(static_cast<int>(std::ceil(std::clamp(low - 0.5, 0.0, double(count))))),
          last(static_cast<int>(std::floor(std::clamp(high - 0.5, -1.0, count - 1.0)))) {}
};

/// Numbers that are taken for exact.
struct NoRounding {
    double operator()(double value) const { return value; }
};

/// A block on the screen: its parallelogram, and the linear map from pixels to texels (2.11).
class BlockOnScreen {
  public:
    /// `coordinate` and `coefficient`: the numbers in which points and the inverse are computed.
    template <class Number>
    BlockOnScreen(const surface::OkaBlock& block, const Size& picture, const Size& screen, double side,
                  const Number& coordinate, const Number& coefficient) {
        const auto seen = [&](const glm::dvec3& at) {
            return glm::dvec3(coordinate(at.x + 0.5 * screen.width), coordinate(at.y + 0.5 * screen.height),
                              coordinate(at.z));
        };
        // What a point on the screen gains by a texel: central differences (2.4 to 2.7).
        const auto gain = [&](const glm::dvec3& before, const glm::dvec3& after, int texels) {
            const double across = coordinate(2 * std::min(side, double(texels)));
            const glm::dvec3 from = seen(before), to = seen(after);
            return glm::dvec3(coordinate(coordinate(to.x - from.x) / across),
                              coordinate(coordinate(to.y - from.y) / across),
                              coordinate(coordinate(to.z - from.z) / across));
        };
        m_centre = seen(block.centre);
        m_by_u = gain(block.left, block.right, picture.width);
        m_by_v = gain(block.above, block.below, picture.height);
        // The inverse of the gains (2.11).
        const double r =
            coefficient(1 / coefficient(coefficient(m_by_u.x * m_by_v.y) - coefficient(m_by_v.x * m_by_u.y)));
        m_b[0] = coefficient(r * m_by_v.y);
        m_b[1] = coefficient(-r * m_by_v.x);
        m_b[2] = coefficient(-r * m_by_u.y);
        m_b[3] = coefficient(r * m_by_u.x);
        m_u = block.u * picture.width;
        m_v = block.v * picture.height;
        m_low = {block.u0 * picture.width, block.v0 * picture.height};
        m_high = {block.u1 * picture.width, block.v1 * picture.height};
        for (const double u : {m_low.x, m_high.x})
            for (const double v : {m_low.y, m_high.y}) {
                const glm::dvec3 at = point(u, v);
                m_first = glm::min(m_first, at);
                m_last = glm::max(m_last, at);
            }
    }

    /// Has it no inverse?
    bool is_flat() const {
        return !std::isfinite(m_b[0] + m_b[1] + m_b[2] + m_b[3]) ||
               !std::isfinite(m_first.x + m_first.y + m_last.x + m_last.y);
    }
    PixelRange columns(const Size& screen) const { return {m_first.x, m_last.x, screen.width}; }
    PixelRange rows(const Size& screen) const { return {m_first.y, m_last.y, screen.height}; }
    double centre_depth() const { return m_centre.z; }
    double least_depth() const { return m_first.z; }
    double largest_depth() const { return m_last.z; }

    /// The inverse at a pixel's centre.
    template <class Number>
    Point<double> texel(int x, int y, const Number& coordinate, const Number& coefficient) const {
        const double dx = coordinate(x + 0.5 - m_centre.x), dy = coordinate(y + 0.5 - m_centre.y);
        return {coefficient(m_u + coefficient(coefficient(m_b[0] * dx) + coefficient(m_b[1] * dy))),
                coefficient(m_v + coefficient(coefficient(m_b[2] * dx) + coefficient(m_b[3] * dy)))};
    }
    bool holds(const Point<double>& at) const {
        return at.x >= m_low.x && at.x <= m_high.x && at.y >= m_low.y && at.y <= m_high.y;
    }
    /// Where a texel is seen, and its depth (2.8).
    glm::dvec3 point(double u, double v) const { return m_centre + (u - m_u) * m_by_u + (v - m_v) * m_by_v; }
    const double (&inverse() const)[4] { return m_b; }
    const Point<double>& low() const { return m_low; }
    const Point<double>& high() const { return m_high; }
    /// The pixel next to the centre, from which addresses are counted.
    int reference_x(const Size& screen) const { return nearest_pixel(m_centre.x, screen.width); }
    int reference_y(const Size& screen) const { return nearest_pixel(m_centre.y, screen.height); }

  private:
    static int nearest_pixel(double at, int count) {
        return static_cast<int>(std::clamp(std::floor(at), 0.0, count - 1.0));
    }

    glm::dvec3 m_centre, m_by_u, m_by_v, m_first{HUGE_VAL}, m_last{-HUGE_VAL};
    double m_u, m_v, m_b[4];
    Point<double> m_low{}, m_high{};
};

/// One coordinate of the addresses of a block's pixels (2.12) in fixed point, segment by segment. A pixel's is the sum of a part that
/// its column has and one that its row has. Sums that are beyond the range saturate.
class AddressSums {
  public:
    /// `x`, `y`: the pixel that addresses are counted from, which has the address `at`; `across` and `down`: what a pixel gains.
    AddressSums(const BlockMachine& machine, const NumberFormat& format, int x, int y, double at,
                double across, double down)
        : m_way(machine.addresses),
          m_format(format),
          m_least(-std::ldexp(1.0, format.bits - 1 - format.fraction)),
          m_largest(largest(format)),
          m_side(machine.segment),
          m_x(x),
          m_y(y),
          m_across(across),
          m_down(down) {
        m_at = fixed(at, m_beyond);
        // Sums of steps are of steps that are rounded, and so are those of segments.
        if (m_way != Addressing::direct) {
            m_step_across = fixed(step() * across, m_beyond);
            m_step_down = fixed(step() * down, m_beyond);
        }
        if (m_way != Addressing::segments) return;
        for (int k = 0; k < m_side; ++k) {
            m_within_across[k] = product(k, across);
            m_within_down[k] = product(k, down);
        }
        // Segments are counted from their first pixels.
        const Sum &left = m_within_across[m_x % m_side], &above = m_within_down[m_y % m_side];
        m_beyond = m_beyond || left.beyond || above.beyond;
        m_at = limited(limited(m_at - left.value, m_beyond) - above.value, m_beyond);
    }

    /// Enters a segment: finds the parts of its columns and rows.
    void enter(const Box& segment) {
        m_segment = segment;
        const Sum first = first_of(segment);
        for (int x = segment.x0; x < segment.x1; ++x) {
            Sum& part = m_columns[x - segment.x0];
            // What a walk along the row adds is a whole number of units however far it goes.
            if (m_way == Addressing::repeated) {
                part = {(x - m_x) * m_step_across, m_beyond};
                continue;
            }
            part =
                m_way == Addressing::segments ? m_within_across[x - segment.x0] : product(x - m_x, m_across);
            part.beyond = part.beyond || first.beyond;
            part.value = limited(first.value + part.value, part.beyond);
        }
        for (int y = segment.y0; y < segment.y1; ++y) {
            Sum& part = m_rows[y - segment.y0];
            part = m_way == Addressing::repeated   ? Sum{m_at + (y - m_y) * m_step_down, false}
                   : m_way == Addressing::segments ? m_within_down[y - segment.y0]
                                                   : product(y - m_y, m_down);
            part.value = limited(part.value, part.beyond);
        }
    }
    /// The address of a pixel of the segment. Sets `beyond` where it, or what it is made of, saturated.
    double at(int x, int y, bool& beyond) const {
        const Sum &column = m_columns[x - m_segment.x0], &row = m_rows[y - m_segment.y0];
        beyond = beyond || column.beyond || row.beyond;
        return limited(column.value + row.value, beyond);
    }

  private:
    struct Sum {
        double value;
        bool beyond;
    };

    double fixed(double value, bool& beyond) const { return nearest(m_format, value, beyond); }
    /// A sum of numbers of the format is in the range, or saturates: it is a multiple of the same unit.
    double limited(double sum, bool& beyond) const {
        const double inside = std::clamp(sum, m_least, m_largest);
        beyond = beyond || inside != sum;
        return inside;
    }
    Sum product(int pixels, double gain) const {
        Sum result{0, false};
        result.value = fixed(pixels * gain, result.beyond);
        return result;
    }
    /// Pixels of a step.
    int step() const { return m_way == Addressing::segments ? m_side : 1; }

    /// The address that products are added to: that of the segment's first pixel, by steps down and then across from segment to
    /// segment, whose sums are products as all of them are multiples of one unit; or of the pixel that addresses are counted from.
    Sum first_of(const Box& segment) const {
        Sum first{m_at, m_beyond};
        if (m_way != Addressing::segments) return first;
        const int rows = segment.y0 / m_side - m_y / m_side, columns = segment.x0 / m_side - m_x / m_side;
        first.value = limited(first.value + rows * m_step_down, first.beyond);
        first.value = limited(first.value + columns * m_step_across, first.beyond);
        return first;
    }

    Addressing m_way;
    NumberFormat m_format;
    double m_least, m_largest;
    int m_side, m_x, m_y;
    double m_across, m_down, m_at = 0, m_step_across = 0, m_step_down = 0;
    bool m_beyond = false;
    Box m_segment{};
    std::array<Sum, kMostSegment> m_within_across, m_within_down, m_columns, m_rows;
};

/// The addresses of a block, and the block's rectangle as they have it.
class BlockAddresses {
  public:
    BlockAddresses(const BlockMachine& machine, const BlockOnScreen& block, const Size& screen)
        : BlockAddresses(machine, block, block.reference_x(screen), block.reference_y(screen)) {}

    /// Enters a segment of the screen. False where none of its pixels can lie in the rectangle: addresses only rise or only fall along
    /// rows and columns.
    bool enter(const Box& segment) {
        m_u.enter(segment);
        m_v.enter(segment);
        Point<double> least{HUGE_VAL, HUGE_VAL}, most{-HUGE_VAL, -HUGE_VAL};
        for (const int x : {segment.x0, segment.x1 - 1})
            for (const int y : {segment.y0, segment.y1 - 1}) {
                bool beyond = false;
                const Point<double> corner = at(x, y, beyond);
                least = {std::min(least.x, corner.x), std::min(least.y, corner.y)};
                most = {std::max(most.x, corner.x), std::max(most.y, corner.y)};
            }
        return most.x >= m_low.x && least.x <= m_high.x && most.y >= m_low.y && least.y <= m_high.y;
    }
    /// The address of a pixel of the segment. Sets `beyond` where it saturated.
    Point<double> at(int x, int y, bool& beyond) const {
        return {m_u.at(x, y, beyond), m_v.at(x, y, beyond)};
    }
    /// Does a pixel of the segment lie in the rectangle? Finds its address then, as at() does.
    bool holds(int x, int y, Point<double>& address, bool& beyond) const {
        address.x = m_u.at(x, y, beyond);
        if (address.x < m_low.x || address.x > m_high.x) return false;
        address.y = m_v.at(x, y, beyond);
        return address.y >= m_low.y && address.y <= m_high.y;
    }

  private:
    BlockAddresses(const BlockMachine& machine, const BlockOnScreen& block, int x, int y)
        : BlockAddresses(machine, {NumberFormat::Kind::fixed, machine.address_bits, machine.fraction_bits},
                         block, x, y,
                         block.texel(x, y, Rounding{machine.coordinates}, Rounding{machine.coefficients})) {}
    BlockAddresses(const BlockMachine& machine, const NumberFormat& format, const BlockOnScreen& block, int x,
                   int y, const Point<double>& reference)
        : m_u(machine, format, x, y, reference.x, block.inverse()[0], block.inverse()[1]),
          m_v(machine, format, x, y, reference.y, block.inverse()[2], block.inverse()[3]) {
        const Rounding fixed{format};
        m_low = {fixed(block.low().x), fixed(block.low().y)};
        m_high = {fixed(block.high().x), fixed(block.high().y)};
    }

    AddressSums m_u, m_v;
    Point<double> m_low{}, m_high{};
};

/// The depths of pixels as the z-buffer holds them: whole numbers from the least to the largest depth of all blocks.
class DepthBuffer {
  public:
    DepthBuffer(const std::vector<BlockOnScreen>& blocks, int bits, std::size_t pixels)
        : m_depths(pixels, std::uint64_t{1} << bits), m_largest(std::ldexp(1.0, bits) - 1) {
        double far = -HUGE_VAL;
        for (const BlockOnScreen& block : blocks) {
            m_near = std::min(m_near, block.least_depth());
            far = std::max(far, block.largest_depth());
        }
        m_scale = far > m_near ? m_largest / (far - m_near) : 0;
    }
    /// Is a depth at most the one that is held? It is held then.
    bool take(std::size_t pixel, double depth) {
        const auto whole = static_cast<std::uint64_t>(
            std::clamp(std::nearbyint((depth - m_near) * m_scale), 0.0, m_largest));
        if (whole > m_depths[pixel]) return false;
        m_depths[pixel] = whole;
        return true;
    }

  private:
    std::vector<std::uint64_t> m_depths;
    double m_near = HUGE_VAL, m_largest, m_scale;
};

/// The list that hidden surfaces are removed by: buckets from the farthest to the nearest, blocks of one bucket in the order in
/// which they came.
std::vector<std::size_t> far_to_near(const std::vector<BlockOnScreen>& blocks, int buckets) {
    double near = HUGE_VAL, far = -HUGE_VAL;
    for (const BlockOnScreen& block : blocks) {
        near = std::min(near, block.centre_depth());
        far = std::max(far, block.centre_depth());
    }
    std::vector<std::vector<std::size_t>> lists(static_cast<std::size_t>(buckets));
    for (std::size_t k = 0; k < blocks.size(); ++k) {
        const double part = far > near ? (far - blocks[k].centre_depth()) / (far - near) : 0;
        lists[static_cast<std::size_t>(std::min(std::floor(part * buckets), buckets - 1.0))].push_back(k);
    }
    std::vector<std::size_t> order;
    for (const std::vector<std::size_t>& list : lists) order.insert(order.end(), list.begin(), list.end());
    return order;
}

/// The address controller, and what the pixel processor shows.
class Drawer {
  public:
    Drawer(const BlockMachine& machine, const std::vector<BlockOnScreen>& blocks, BlockFrame& frame)
        : m_machine(machine), m_blocks(blocks), m_frame(frame) {
        const std::size_t pixels = frame.block.size();
        if (machine.hidden == Hiding::z_buffer)
            m_depths = std::make_unique<DepthBuffer>(blocks, machine.depth_bits, pixels);
        else
            m_nearest.assign(pixels, HUGE_VAL);
    }

    void draw() {
        std::vector<std::size_t> order(m_blocks.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        if (m_machine.hidden == Hiding::sort) order = far_to_near(m_blocks, m_machine.buckets);
        for (const std::size_t number : order) draw(number);
        if (m_depths) return;
        for (std::size_t k = 0; k < m_frame.block.size(); ++k)
            if (m_frame.block[k] != BlockFrame::kNone &&
                m_blocks[static_cast<std::size_t>(m_frame.block[k])].centre_depth() > m_nearest[k])
                ++m_frame.counts.misordered;
    }

  private:
    void draw(std::size_t number) {
        const BlockOnScreen& block = m_blocks[number];
        BlockAddresses addresses(m_machine, block, m_frame.screen);
        const PixelRange columns = block.columns(m_frame.screen), rows = block.rows(m_frame.screen);
        if (columns.last < columns.first || rows.last < rows.first) return;
        const int side = m_machine.segment;
        for (int y = rows.first / side * side; y <= rows.last; y += side)
            for (int x = columns.first / side * side; x <= columns.last; x += side) {
                const Box segment{x, y, std::min(x + side, m_frame.screen.width),
                                  std::min(y + side, m_frame.screen.height)};
                if (addresses.enter(segment)) draw_segment(number, addresses, segment);
            }
    }

    void draw_segment(std::size_t number, const BlockAddresses& addresses, const Box& segment) {
        std::int64_t drawn = 0;
        for (int y = segment.y0; y < segment.y1; ++y)
            for (int x = segment.x0; x < segment.x1; ++x) {
                bool beyond = false;
                Point<double> at;
                if (!addresses.holds(x, y, at, beyond)) continue;
                ++drawn;
                show(number, m_frame.index(x, y), at, beyond);
            }
        BlockCounts& counts = m_frame.counts;
        ++counts.segments;
        counts.addressed += std::int64_t{segment.width()} * segment.height();
        counts.pixels += drawn;
        const int at_once = m_machine.addresses == Addressing::segments ? m_machine.pixel_units : 1;
        counts.pixel_cycles += (drawn + at_once - 1) / at_once;
    }

    void show(std::size_t number, std::size_t pixel, const Point<double>& at, bool beyond) {
        const BlockOnScreen& block = m_blocks[number];
        if (m_depths && !m_depths->take(pixel, block.point(at.x, at.y).z)) return;
        if (!m_depths) m_nearest[pixel] = std::min(m_nearest[pixel], block.centre_depth());
        m_frame.addresses[pixel] = at;
        m_frame.block[pixel] = static_cast<std::int32_t>(number);
        m_frame.beyond[pixel] = beyond;
    }

    const BlockMachine& m_machine;
    const std::vector<BlockOnScreen>& m_blocks;
    BlockFrame& m_frame;
    std::unique_ptr<DepthBuffer> m_depths;
    std::vector<double> m_nearest;  ///< of the centres of the blocks that were drawn at a pixel
};

/// May a block cover a pixel?
bool is_on_screen(const BlockOnScreen& block, const Size& screen) {
    if (block.is_flat()) return false;
    const PixelRange columns = block.columns(screen), rows = block.rows(screen);
    return columns.first <= columns.last && rows.first <= rows.last;
}

/// Marks the pixels that lie in a block.
void mark(const BlockOnScreen& block, const BlockFrame& frame, std::vector<bool>& marks) {
    if (block.is_flat()) return;
    const PixelRange columns = block.columns(frame.screen), rows = block.rows(frame.screen);
    for (int y = rows.first; y <= rows.last; ++y)
        for (int x = columns.first; x <= columns.last; ++x)
            if (block.holds(block.texel(x, y, NoRounding{}, NoRounding{}))) marks[frame.index(x, y)] = true;
}

}  // namespace

BlockFrame run_block_machine(const BlockMachine& machine, const surface::DrapedSurface& surface,
                             const surface::Camera& camera, const Size& picture) {
    const surface::OkaBlocks cut{machine.block, machine.overlap, false};
    const Size count = surface::oka_block_count(picture, cut);
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
    std::vector<bool> covered(pixels);
    std::vector<BlockOnScreen> blocks;
    const Rounding coordinate{machine.coordinates}, coefficient{machine.coefficients};
    for (int j = 0; j < count.height; ++j)
        for (int i = 0; i < count.width; ++i) {
            surface::OkaBlock block;
            const bool made = surface::oka_block(surface, camera, picture, cut, i, j, block);
            if (!made ||
                !is_on_screen({block, picture, frame.screen, machine.block, NoRounding{}, NoRounding{}},
                              frame.screen))
                frame.counts.left_out += surface::oka_block_is_cut(surface, camera, picture, cut, i, j);
            if (!made) continue;
            ++frame.counts.blocks;
            mark({block, picture, frame.screen, machine.block, NoRounding{}, NoRounding{}}, frame, covered);
            const BlockOnScreen on_screen(block, picture, frame.screen, machine.block, coordinate,
                                          coefficient);
            if (on_screen.is_flat()) continue;
            const double(&b)[4] = on_screen.inverse();
            frame.steps.push_back({b[0], b[2], b[1], b[3]});
            frame.centres.push_back({block.u * picture.width, block.v * picture.height});
            blocks.push_back(on_screen);
        }
    Drawer(machine, blocks, frame).draw();
    frame.counts.saturated = std::count(frame.beyond.begin(), frame.beyond.end(), true);
    for (std::size_t k = 0; k < pixels; ++k)
        if (covered[k] && frame.block[k] == BlockFrame::kNone) ++frame.counts.cracks;
    return frame;
}

}  // namespace anamorph::machine
