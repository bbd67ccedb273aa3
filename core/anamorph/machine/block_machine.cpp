// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/block_machine.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/common.hpp>
#include <memory>
#include <optional>
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
    /// The pixels of the least rectangle about it; empty() where there are none.
    Box pixels(const Size& screen) const {
        const PixelRange columns(m_first.x, m_last.x, screen.width), rows(m_first.y, m_last.y, screen.height);
        return {columns.first, rows.first, columns.last + 1, rows.last + 1};
    }
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

/// The depths that a z-buffer holds: whole numbers from the least to the largest depth of all blocks.
class DepthScale {
  public:
    DepthScale(const std::vector<BlockOnScreen>& blocks, int bits)
        : m_beyond(std::uint64_t{1} << bits), m_largest(std::ldexp(1.0, bits) - 1) {
        double far = -HUGE_VAL;
        for (const BlockOnScreen& block : blocks) {
            m_near = std::min(m_near, block.least_depth());
            far = std::max(far, block.largest_depth());
        }
        m_scale = far > m_near ? m_largest / (far - m_near) : 0;
    }
    std::uint64_t whole(double depth) const {
        return static_cast<std::uint64_t>(
            std::clamp(std::nearbyint((depth - m_near) * m_scale), 0.0, m_largest));
    }
    /// Farther than all.
    std::uint64_t beyond() const { return m_beyond; }

  private:
    std::uint64_t m_beyond;
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

/// Squares of the screen, each of whole segments, and which blocks may be seen in each, in the order in which they are drawn.
class SquareLists {
  public:
    SquareLists(const Size& screen, int segment)
        : m_screen(screen),
          m_side((kLeastSide + segment - 1) / segment * segment),
          m_columns((screen.width + m_side - 1) / m_side) {
        m_lists.resize(static_cast<std::size_t>(m_columns) *
                       static_cast<std::size_t>((screen.height + m_side - 1) / m_side));
    }
    void add(std::size_t number, const BlockOnScreen& block) {
        for_squares(block.pixels(m_screen), [&](std::size_t square) {
            m_lists[square].push_back(static_cast<std::uint32_t>(number));
        });
    }
    /// body(square) for all squares that have pixels of a box.
    template <class Body>
    void for_squares(const Box& box, const Body& body) const {
        if (box.empty()) return;
        for (int row = box.y0 / m_side; row <= (box.y1 - 1) / m_side; ++row)
            for (int column = box.x0 / m_side; column <= (box.x1 - 1) / m_side; ++column)
                body(static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
                     static_cast<std::size_t>(column));
    }
    std::size_t count() const { return m_lists.size(); }
    const std::vector<std::uint32_t>& list(std::size_t square) const { return m_lists[square]; }
    /// The pixels of a square.
    Box box(std::size_t square) const {
        const int x = static_cast<int>(square % static_cast<std::size_t>(m_columns)) * m_side,
                  y = static_cast<int>(square / static_cast<std::size_t>(m_columns)) * m_side;
        return {x, y, std::min(x + m_side, m_screen.width), std::min(y + m_side, m_screen.height)};
    }

  private:
    static constexpr int kLeastSide = 64;

    Size m_screen;
    int m_side, m_columns;
    std::vector<std::vector<std::uint32_t>> m_lists;
};

/// The address controller, and what the pixel processor shows, of a part of the screen.
class Drawer {
  public:
    /// `frame`: has all pixels of `part`, which lies in `square`, one of whole segments.
    Drawer(const BlockMachine& machine, const Size& screen, const std::vector<BlockOnScreen>& blocks,
           const DepthScale* depths, BlockFrame& frame, const Box& square, const Box& part)
        : m_machine(machine),
          m_screen(screen),
          m_blocks(blocks),
          m_scale(depths),
          m_frame(frame),
          m_square(square),
          m_part(part) {
        const std::size_t pixels =
            static_cast<std::size_t>(part.width()) * static_cast<std::size_t>(part.height());
        if (m_scale)
            m_depths.assign(pixels, m_scale->beyond());
        else
            m_nearest.assign(pixels, HUGE_VAL);
    }

    void draw(std::size_t number) {
        const BlockOnScreen& block = m_blocks[number];
        // All segments that it may reach into: by rounding it may have pixels beside its parallelogram.
        const Box seen = intersection(block.pixels(m_screen), m_square);
        if (seen.empty()) return;
        const int side = m_machine.segment;
        const Box segments{seen.x0 / side * side, seen.y0 / side * side, (seen.x1 + side - 1) / side * side,
                           (seen.y1 + side - 1) / side * side};
        if (intersection(segments, m_part).empty()) return;
        BlockAddresses addresses(m_machine, block, m_screen);
        for (int y = segments.y0; y < segments.y1; y += side)
            for (int x = segments.x0; x < segments.x1; x += side) {
                const Box segment{x, y, std::min(x + side, m_screen.width),
                                  std::min(y + side, m_screen.height)};
                if (!intersection(segment, m_part).empty() && addresses.enter(segment))
                    draw_segment(number, addresses, segment);
            }
    }
    /// What was counted, where the part is one of whole segments.
    const BlockCounts& count() {
        for (int y = m_part.y0; y < m_part.y1; ++y)
            for (int x = m_part.x0; x < m_part.x1; ++x) {
                const std::size_t at = m_frame.index(x, y);
                m_counts.saturated += m_frame.beyond[at];
                if (!m_scale && m_frame.block[at] != BlockFrame::kNone)
                    m_counts.misordered +=
                        m_blocks[static_cast<std::size_t>(m_frame.block[at])].centre_depth() >
                        m_nearest[own_index(x, y)];
            }
        return m_counts;
    }

  private:
    void draw_segment(std::size_t number, const BlockAddresses& addresses, const Box& segment) {
        std::int64_t drawn = 0;
        const Box seen = intersection(segment, m_part);
        for (int y = seen.y0; y < seen.y1; ++y)
            for (int x = seen.x0; x < seen.x1; ++x) {
                bool beyond = false;
                Point<double> at;
                if (!addresses.holds(x, y, at, beyond)) continue;
                ++drawn;
                show(number, x, y, at, beyond);
            }
        ++m_counts.segments;
        m_counts.addressed += std::int64_t{segment.width()} * segment.height();
        m_counts.pixels += drawn;
        const int at_once = m_machine.addresses == Addressing::segments ? m_machine.pixel_units : 1;
        m_counts.pixel_cycles += (drawn + at_once - 1) / at_once;
    }

    void show(std::size_t number, int x, int y, const Point<double>& at, bool beyond) {
        const BlockOnScreen& block = m_blocks[number];
        const std::size_t own = own_index(x, y);
        if (m_scale) {
            const std::uint64_t depth = m_scale->whole(block.point(at.x, at.y).z);
            if (depth > m_depths[own]) return;
            m_depths[own] = depth;
        } else {
            m_nearest[own] = std::min(m_nearest[own], block.centre_depth());
        }
        const std::size_t pixel = m_frame.index(x, y);
        m_frame.addresses[pixel] = at;
        m_frame.block[pixel] = static_cast<std::int32_t>(number);
        m_frame.beyond[pixel] = beyond ? 1 : 0;
    }
    std::size_t own_index(int x, int y) const {
        return static_cast<std::size_t>(y - m_part.y0) * static_cast<std::size_t>(m_part.width()) +
               static_cast<std::size_t>(x - m_part.x0);
    }

    const BlockMachine& m_machine;
    Size m_screen;
    const std::vector<BlockOnScreen>& m_blocks;
    const DepthScale* m_scale;
    BlockFrame& m_frame;
    Box m_square, m_part;
    BlockCounts m_counts;
    std::vector<std::uint64_t> m_depths;
    std::vector<double> m_nearest;  ///< of the centres of the blocks that were drawn at a pixel
};

/// How many pixels of `part` lie in one of some blocks but show nothing.
std::int64_t cracks_in(const Box& part, const std::vector<BlockOnScreen>& blocks,
                       const std::vector<std::uint32_t>& list, const Size& screen, const BlockFrame& frame) {
    std::vector<bool> cracked(static_cast<std::size_t>(part.width()) *
                              static_cast<std::size_t>(part.height()));
    for (const std::uint32_t number : list) {
        const BlockOnScreen& block = blocks[number];
        const Box seen = intersection(block.pixels(screen), part);
        for (int y = seen.y0; y < seen.y1; ++y)
            for (int x = seen.x0; x < seen.x1; ++x)
                if (frame.block[frame.index(x, y)] == BlockFrame::kNone &&
                    block.holds(block.texel(x, y, NoRounding{}, NoRounding{})))
                    cracked[static_cast<std::size_t>(y - part.y0) * static_cast<std::size_t>(part.width()) +
                            static_cast<std::size_t>(x - part.x0)] = true;
    }
    return std::count(cracked.begin(), cracked.end(), true);
}

BlockFrame empty_frame(const Box& box) {
    BlockFrame frame;
    frame.box = box;
    const std::size_t pixels = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height());
    frame.addresses.resize(pixels);
    frame.beyond.resize(pixels);
    frame.block.resize(pixels, BlockFrame::kNone);
    return frame;
}

BlockCounts& operator+=(BlockCounts& sum, const BlockCounts& more) {
    for (const auto count : {&BlockCounts::blocks, &BlockCounts::segments, &BlockCounts::pixels,
                             &BlockCounts::saturated, &BlockCounts::addressed, &BlockCounts::pixel_cycles,
                             &BlockCounts::cracks, &BlockCounts::misordered, &BlockCounts::left_out})
        sum.*count += more.*count;
    return sum;
}

}  // namespace

struct MachineBlocks::Parts {
    BlockMachine machine;
    std::shared_ptr<const surface::DrapedSurface> surface;
    surface::Camera camera;
    Size picture;
    surface::OkaBlocks cut;
    Size count;
    std::int64_t made = 0;
    std::vector<BlockOnScreen> blocks;
    std::vector<Jacobian> steps;
    std::vector<Point<double>> centres;
    std::optional<DepthScale> depths;
    SquareLists squares;

    Parts(const BlockMachine& of, std::shared_ptr<const surface::DrapedSurface> on,
          const surface::Camera& seen_by, const Size& size)
        : machine(of),
          surface(std::move(on)),
          camera(seen_by),
          picture(size),
          cut{machine.block, machine.overlap, false},
          count(surface::oka_block_count(picture, cut)),
          squares(screen(), machine.segment) {
        const Rounding coordinate{machine.coordinates}, coefficient{machine.coefficients};
        for_blocks([&](int, int, const surface::OkaBlock* block) {
            if (!block) return;
            ++made;
            const BlockOnScreen placed(*block, picture, screen(), machine.block, coordinate, coefficient);
            if (placed.is_flat()) return;
            const double(&b)[4] = placed.inverse();
            steps.push_back({b[0], b[2], b[1], b[3]});
            centres.push_back({block->u * picture.width, block->v * picture.height});
            blocks.push_back(placed);
        });
        if (machine.hidden == Hiding::z_buffer) {
            depths.emplace(blocks, machine.depth_bits);
            for (std::size_t k = 0; k < blocks.size(); ++k) squares.add(k, blocks[k]);
        } else {
            for (const std::size_t k : far_to_near(blocks, machine.buckets)) squares.add(k, blocks[k]);
        }
    }

    const Size& screen() const { return camera.screen(); }
    /// body(i, j, block) for all blocks, null where there is no map of one.
    template <class Body>
    void for_blocks(const Body& body) const {
        for (int j = 0; j < count.height; ++j)
            for (int i = 0; i < count.width; ++i) {
                surface::OkaBlock block;
                const bool has_map = surface::oka_block(*surface, camera, picture, cut, i, j, block);
                body(i, j, has_map ? &block : nullptr);
            }
    }
    /// Draws the pixels of a square that lie in `box`.
    Drawer draw(std::size_t square, const Box& box, BlockFrame& frame) const {
        const Box all = squares.box(square);
        Drawer drawer(machine, screen(), blocks, depths ? &*depths : nullptr, frame, all,
                      intersection(all, box));
        for (const std::uint32_t number : squares.list(square)) drawer.draw(number);
        return drawer;
    }
};

MachineBlocks::MachineBlocks(const BlockMachine& machine,
                             std::shared_ptr<const surface::DrapedSurface> surface,
                             const surface::Camera& camera, const Size& picture) {
    const Size& screen = camera.screen();
    if (double(screen.width) * screen.height > kMostPixels)
        throw Error("machine: a picture of " + std::to_string(screen.width) + "x" +
                    std::to_string(screen.height) + " does not fit its memory: must have at most " +
                    std::to_string(kMostPixels) + " pixels");
    m_parts = std::make_unique<Parts>(machine, std::move(surface), camera, picture);
}

MachineBlocks::~MachineBlocks() = default;

std::int64_t MachineBlocks::made() const {
    return m_parts->made;
}

const std::vector<Jacobian>& MachineBlocks::steps() const {
    return m_parts->steps;
}

const std::vector<Point<double>>& MachineBlocks::centres() const {
    return m_parts->centres;
}

BlockFrame MachineBlocks::draw(const Box& box) const {
    BlockFrame frame = empty_frame(box);
    m_parts->squares.for_squares(box, [&](std::size_t square) { m_parts->draw(square, box, frame); });
    return frame;
}

BlockFrame MachineBlocks::draw_all(const ParallelFor& parallel_for) const {
    const Parts& parts = *m_parts;
    const Size& screen = parts.screen();
    const Box whole{0, 0, screen.width, screen.height};
    BlockFrame frame = empty_frame(whole);
    frame.counts.blocks = parts.made;
    // Where they would be seen but for rounding.
    std::vector<BlockOnScreen> unrounded;
    SquareLists squares(screen, parts.machine.segment);
    parts.for_blocks([&](int i, int j, const surface::OkaBlock* block) {
        if (block) {
            const BlockOnScreen placed(*block, parts.picture, screen, parts.machine.block, NoRounding{},
                                       NoRounding{});
            if (!placed.is_flat() && !placed.pixels(screen).empty()) {
                squares.add(unrounded.size(), placed);
                unrounded.push_back(placed);
                return;
            }
        }
        frame.counts.left_out +=
            surface::oka_block_is_cut(*parts.surface, parts.camera, parts.picture, parts.cut, i, j);
    });
    std::vector<BlockCounts> counts(parts.squares.count());
    parallel_for(static_cast<std::int64_t>(counts.size()), [&](std::int64_t i) {
        const auto k = static_cast<std::size_t>(i);
        counts[k] = parts.draw(k, whole, frame).count();
        counts[k].cracks = cracks_in(squares.box(k), unrounded, squares.list(k), screen, frame);
    });
    for (const BlockCounts& of_square : counts) frame.counts += of_square;
    return frame;
}

}  // namespace anamorph::machine
