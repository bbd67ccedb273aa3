// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/oka.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string>
#include <utility>

#include "anamorph/error.h"
#include "anamorph/number/hypot.h"
#include "anamorph/number/portable.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/surface/seen_range.h"

namespace anamorph::surface {
namespace {

constexpr int kMostBlocks = 1 << 22;

using Taylor = std::array<Jet<Interval, 2>, 2>;

Taylor hull_of(const Taylor& a, const Taylor& b) {
    Taylor all = a;
    for (std::size_t axis = 0; axis < 2; ++axis)
        for (std::size_t n = 0; n < 6; ++n) all[axis].c[n] = hull(a[axis].c[n], b[axis].c[n]);
    return all;
}

/// What is known of the second derivatives over a quarter of a block: over its halves either way, and over both.
class QuarterRanges {
  public:
    /// over(s0, s1, t0, t1): over a part of the quarter, 0 to 1 from the block's centre outwards.
    template <class Over>
    explicit QuarterRanges(const Over& over) {
        for (int j = 0; j < 2; ++j)
            for (int i = 0; i < 2; ++i) at(i, i, j, j) = over(i / 2.0, (i + 1) / 2.0, j / 2.0, (j + 1) / 2.0);
        for (int j = 0; j < 2; ++j) at(0, 1, j, j) = hull_of(at(0, 0, j, j), at(1, 1, j, j));
        for (int i = 0; i < 2; ++i) at(i, i, 0, 1) = hull_of(at(i, i, 0, 0), at(i, i, 1, 1));
        at(0, 1, 0, 1) = hull_of(at(0, 1, 0, 0), at(0, 1, 1, 1));
    }
    /// Over the halves from the first to the last either way.
    const Taylor& at(int i0, int i1, int j0, int j1) const {
        return m_ranges[static_cast<std::size_t>((i0 + i1) * 3 + j0 + j1)];
    }

  private:
    Taylor& at(int i0, int i1, int j0, int j1) {
        return m_ranges[static_cast<std::size_t>((i0 + i1) * 3 + j0 + j1)];
    }

    std::array<Taylor, 9> m_ranges;
};

// Parts of a quarter of a block, either way; and of the way from the centre to a part.
constexpr int kParts = 4;

/// The mean of the second derivatives, twice the integral of 1 - r times those at r of the way, over all ways from the
/// centre to part (i, j): each part of the way lies in a rectangle.
void put_means(const QuarterRanges& ranges, int i, int j, Taylor& to) {
    for (std::size_t axis = 0; axis < 2; ++axis)
        for (std::size_t n = 3; n < 6; ++n) to[axis].c[n] = Interval(0);
    const auto first = [](int from, int k) { return 2 * from * k >= kParts * kParts ? 1 : 0; };
    const auto last = [](int end, int k) { return 2 * end * (k + 1) > kParts * kParts ? 1 : 0; };
    const Taylor* range = nullptr;
    double weight = 0;
    const auto add = [&] {
        for (std::size_t axis = 0; range && axis < 2; ++axis)
            for (std::size_t n = 3; n < 6; ++n) to[axis].c[n] += (*range)[axis].c[n] * weight;
    };
    for (int k = 0; k < kParts; ++k) {
        const Taylor& next = ranges.at(first(k, i), last(k + 1, i), first(k, j), last(k + 1, j));
        if (&next != range) {
            add();
            range = &next;
            weight = 0;
        }
        weight += (square(double(kParts - k)) - square(kParts - k - 1.0)) / (kParts * kParts);
    }
    add();
}

/// The length of the vector of polynomials of the second degree, over a quarter of a block from its centre to (right, down),
/// at most: part by part of it, so that its terms need not all be largest at once. `p` has what is constant of them and the
/// first degree.
double length_of(Taylor p, const QuarterRanges& ranges, double right, double down) {
    const auto part = [](double to, int i) {
        const double a = to * i / kParts, b = to * (i + 1) / kParts;
        return Interval(std::min(a, b), std::max(a, b));
    };
    double length = 0;
    for (int j = 0; j < kParts; ++j)
        for (int i = 0; i < kParts; ++i) {
            put_means(ranges, i, j, p);
            const Interval s = part(right, i), t = part(down, j);
            const auto size = [&](const Jet<Interval, 2>& g) {
                return magnitude(g.c[0] + g.c[1] * s + g.c[2] * t + g.c[3] * square(s) + g.c[4] * (s * t) +
                                 g.c[5] * square(t));
            };
            const double here = hypot(size(p[0]), size(p[1]));
            if (std::isnan(here)) return HUGE_VAL;
            length = std::max(length, here);
        }
    return length;
}

/// Is the surface there on all of a block? Taylor's formula says nothing of what lies beyond a part that is missing.
bool is_whole(const OkaBlock& map, const DrapedSurface& surface, double h, double k) {
    return surface.missing(Interval(-h, h) + Interval(map.u), Interval(-k, k) + Interval(map.v)) ==
           Certainty::no;
}

/// What g and its slopes at a block's centre are off those of its map.
Taylor off_centre(const OkaBlock& map, const DrapedSurface& surface, const Camera& camera) {
    Taylor off = seen_range(camera, surface.range(Interval(map.u), Interval(map.v)));
    for (int i = 0; i < 2; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        off[axis].c[0] -= map.centre[i];
        off[axis].c[1] -= map.by_u[i];
        off[axis].c[2] -= map.by_v[i];
    }
    return off;
}

/// How far a block's map is off on the screen, at most: pixels. By second derivatives over all of the block, which takes a
/// twentieth of the time.
double quick_bound_of(const OkaBlock& map, const DrapedSurface& surface, const Camera& camera, double h,
                      double k) {
    if (!is_whole(map, surface, h, k)) return HUGE_VAL;
    Taylor off = off_centre(map, surface, camera);
    const Taylor bends = seen_range(
        camera, surface.range(Interval(-h, h) + Interval(map.u), Interval(-k, k) + Interval(map.v)));
    double size = 0;
    for (const double right : {-h, h})
        for (const double down : {-k, k}) {
            const Interval s(std::min(0.0, right), std::max(0.0, right)),
                t(std::min(0.0, down), std::max(0.0, down));
            double length[2];
            for (std::size_t axis = 0; axis < 2; ++axis)
                length[axis] = magnitude(off[axis].c[0] + off[axis].c[1] * s + off[axis].c[2] * t +
                                         bends[axis].c[3] * square(s) + bends[axis].c[4] * (s * t) +
                                         bends[axis].c[5] * square(t));
            const double here = hypot(length[0], length[1]);
            if (std::isnan(here)) return HUGE_VAL;
            size = std::max(size, here);
        }
    return size;
}

/// The largest error of a block's map on the screen, in pixels, part by part.
double bound_of(const OkaBlock& map, const DrapedSurface& surface, const Camera& camera, double h, double k) {
    if (!is_whole(map, surface, h, k)) return HUGE_VAL;
    const Taylor off = off_centre(map, surface, camera);
    double size = 0;
    for (const double right : {-h, h})
        for (const double down : {-k, k}) {
            const auto between = [](double a, double b) { return Interval(std::min(a, b), std::max(a, b)); };
            const QuarterRanges ranges([&](double s0, double s1, double t0, double t1) {
                return seen_range(camera, surface.range(between(s0 * right, s1 * right) + map.u,
                                                        between(t0 * down, t1 * down) + map.v));
            });
            size = std::max(size, length_of(off, ranges, right, down));
        }
    return size;
}

// Parallelograms that are so much longer than wide are lines.
constexpr double kMostCondition = 0x1p30;

/// A key that is the less the farther a depth is: its bits as a float.
std::uint32_t far_first(double depth) {
    const auto bits = bit_cast<std::uint32_t>(static_cast<float>(depth));
    return bits >> 31 ? bits : ~(bits | 0x80000000u);
}

/// Sorts numbers by their keys; those with equal ones stay in order.
void bucket_sort(const std::vector<std::uint32_t>& keys, std::vector<std::uint32_t>& order,
                 std::vector<std::uint32_t>& room) {
    constexpr int kBits = 11;
    constexpr std::size_t kBuckets = std::size_t{1} << kBits;
    order.resize(keys.size());
    room.resize(keys.size());
    std::iota(order.begin(), order.end(), 0u);
    for (int shift = 0; shift < 32; shift += kBits) {
        std::array<std::uint32_t, kBuckets> next{};
        const auto bucket = [&](std::uint32_t i) { return keys[i] >> shift & (kBuckets - 1); };
        for (const std::uint32_t i : order) ++next[bucket(i)];
        if (!order.empty() && next[bucket(order[0])] == order.size()) continue;
        std::uint32_t sum = 0;
        for (std::uint32_t& n : next) sum += std::exchange(n, sum);
        for (const std::uint32_t i : order) room[next[bucket(i)]++] = i;
        order.swap(room);
    }
}

/// Where the points of a grid of the picture are seen, pixels from the middle of the screen, and their depths; NaN where one
/// is not in front of the camera.
void see_grid(const DrapedSurface& surface, const Camera& camera, std::span<const double> u,
              std::span<const double> v, glm::dvec3* to) {
    surface.positions(u, v, to);
    for (std::size_t i = 0; i < u.size() * v.size(); ++i) {
        const glm::dvec3 p = camera.in_frame(to[i]);
        const Point<double> on_screen = camera.seen(p);
        to[i] = p.z >= camera.near() ? glm::dvec3(on_screen.x, on_screen.y, p.z)
                                     : glm::dvec3(std::numeric_limits<double>::quiet_NaN());
    }
}

/// The sides of a block in u and in v; at most all of the picture.
glm::dvec2 sides_of(const Size& picture, const OkaBlocks& blocks) {
    return {std::min(1.0, blocks.side / picture.width), std::min(1.0, blocks.side / picture.height)};
}

bool is_finite(const glm::dvec3& v) {
    return std::isfinite(v.x + v.y + v.z);
}

}  // namespace

Size oka_block_count(const Size& picture, const OkaBlocks& blocks) {
    const auto count = [&](int pixels) { return std::ceil(pixels / blocks.side); };
    if (count(picture.width) * count(picture.height) > kMostBlocks)
        throw Error("block", shortest(blocks.side),
                    "makes more than " + std::to_string(kMostBlocks) + " blocks; must be larger");
    return {static_cast<int>(count(picture.width)), static_cast<int>(count(picture.height))};
}

namespace {

/// The sides of a block that is halved `level` times, and how far one reaches from its centre, in u and in v.
simd::ParallelogramGrid grid_of(const Size& picture, const OkaBlocks& blocks) {
    const glm::dvec2 sides = sides_of(picture, blocks);
    return {sides.x, sides.y, (sides.x + blocks.overlap / picture.width) / 2,
            (sides.y + blocks.overlap / picture.height) / 2};
}

/// The part of 0 to 1 within `half` of a centre.
Interval reach_of(double centre, double half) {
    return {std::max(0.0, centre - half), std::min(1.0, centre + half)};
}

/// Is a part of a surface certainly not in view: behind the near plane, or beyond one of the planes through the eye and an edge of
/// the screen? Each is where a linear form of the place in space has one sign, so that it does not matter where the part is cut.
bool is_out_of_view(const DrapedSurface& surface, const Camera& camera, const Interval& u,
                    const Interval& v) {
    if (u.lo > u.hi || v.lo > v.hi) return true;
    const SurfaceRange range = surface.range(u, v);
    // across x + down y + ahead z + constant in the camera's frame.
    const auto form = [&](double across, double down, double ahead, double constant) {
        const glm::dvec3 weights(across, down, ahead);
        Interval sum(constant);
        for (int i = 0; i < 3; ++i) sum += Interval(weights[i]) * Interval(camera.offset()[i]);
        for (int axis = 0; axis < 3; ++axis) {
            Interval weight(0);
            for (int i = 0; i < 3; ++i) weight += Interval(weights[i]) * Interval(camera.matrix()[axis][i]);
            sum += weight * range[static_cast<std::size_t>(axis)].c[0];
        }
        return sum;
    };
    if (form(0, 0, 1, -camera.near()).hi < 0) return true;
    const double right = 0.5 * camera.screen().width, down = 0.5 * camera.screen().height;
    for (const double side : {-1.0, 1.0})
        if (form(side * camera.focal(), 0, -right, 0).lo > 0 ||
            form(0, side * camera.focal(), -down, 0).lo > 0)
            return true;
    return false;
}

// A block's linear map is taken for what is seen of it where no point of its five is so much farther ahead than another.
constexpr double kMostSteepness = 2;

/// Is one of a block's five points behind the camera, or much nearer to it than another one? Points that are missing are neither.
bool is_steep(const DrapedSurface& surface, const Camera& camera, const simd::ParallelogramGrid& grid, int i,
              int j) {
    const auto centre = [](int k, double side) { return (k + 0.5) * side; };
    double near = HUGE_VAL, far = -HUGE_VAL;
    const int beside[5][2] = {{0, 0}, {-1, 0}, {1, 0}, {0, -1}, {0, 1}};
    for (const auto& [across, down] : beside) {
        const double depth =
            camera.in_frame(surface.position(centre(i + across, grid.side_u), centre(j + down, grid.side_v)))
                .z;
        near = std::fmin(near, depth);
        far = std::fmax(far, depth);
    }
    return near < camera.near() || far > kMostSteepness * near;
}

}  // namespace

bool oka_block(const DrapedSurface& surface, const Camera& camera, const Size& picture,
               const OkaBlocks& blocks, int i, int j, OkaBlock& block, int level) {
    const simd::ParallelogramGrid grid = grid_of(picture, blocks).at(level);
    const double side_u = grid.side_u, side_v = grid.side_v;
    // Where the centres of the block and of those beside, above and below it are seen, and their depths.
    const auto centre = [](int k, double side) { return (k + 0.5) * side; };
    const double u[] = {centre(i - 1, side_u), centre(i, side_u), centre(i + 1, side_u)},
                 v[] = {centre(j - 1, side_v), centre(j, side_v), centre(j + 1, side_v)};
    glm::dvec3 row[3], column[3];
    see_grid(surface, camera, u, std::span(v).subspan(1, 1), row);
    see_grid(surface, camera, std::span(u).subspan(1, 1), v, column);
    block.left = row[0];
    block.centre = row[1];
    block.right = row[2];
    block.above = column[0];
    block.below = column[2];
    block.by_u = (block.right - block.left) / (2 * side_u);
    block.by_v = (block.below - block.above) / (2 * side_v);
    if (!is_finite(block.centre) || !is_finite(block.by_u) || !is_finite(block.by_v)) return false;
    block.u = (i + 0.5) * side_u;
    block.v = (j + 0.5) * side_v;
    block.u0 = std::max(0.0, block.u - grid.half_u);
    block.u1 = std::min(1.0, block.u + grid.half_u);
    block.v0 = std::max(0.0, block.v - grid.half_v);
    block.v1 = std::min(1.0, block.v + grid.half_v);
    return true;
}

bool oka_block_is_cut(const DrapedSurface& surface, const Camera& camera, const Size& picture,
                      const OkaBlocks& blocks, int i, int j, int level) {
    if (!camera.perspective()) return false;
    const simd::ParallelogramGrid grid = grid_of(picture, blocks).at(level);
    return is_steep(surface, camera, grid, i, j) &&
           !is_out_of_view(surface, camera, reach_of((i + 0.5) * grid.side_u, grid.half_u),
                           reach_of((j + 0.5) * grid.side_v, grid.half_v));
}

OkaRaster::OkaRaster(std::shared_ptr<const DrapedSurface> surface, const Camera& camera, const Size& picture,
                     const OkaBlocks& blocks, int square, std::shared_ptr<RoomPool<OkaRoom>> pool)
    : m_surface(std::move(surface)),
      m_camera(camera),
      m_picture(picture),
      m_count(oka_block_count(picture, blocks)),
      m_blocks(blocks),
      m_square(square),
      m_columns((camera.screen().width + square - 1) / square),
      m_pool(std::move(pool)),
      m_room(m_pool->take()) {
    m_grid = grid_of(picture, blocks);
    find_blocks();
    m_most_by_u = std::sqrt(m_most_by_u);
    m_most_by_v = std::sqrt(m_most_by_v);
    if (!m_blocks.linear_depth) sort_by_depth();
    list_squares();
}

OkaRaster::~OkaRaster() {
    m_pool->give_back(std::move(m_room));
}

void OkaRaster::find_blocks() {
    m_room->blocks.clear();
    m_room->squares.clear();
    // Centres, and of one more at each end.
    const auto centres = [](int first, int end, double side, std::vector<double>& to) {
        to.clear();
        for (int i = first; i < end; ++i) to.push_back((i + 0.5) * side);
    };
    centres(-1, m_count.width + 1, m_grid.side_u, m_room->columns);
    // Rows a few at a time, and those above and below.
    constexpr int kRows = 16;
    const auto width = m_room->columns.size();
    m_room->seen.resize((kRows + 2) * width);
    glm::dvec3* const seen = m_room->seen.data();
    for (int top = 0; top < m_count.height; top += kRows) {
        const int end = std::min(top + kRows, m_count.height);
        // The last two rows before are the first two now.
        const std::size_t kept = top > 0 ? 2 : 0;
        std::copy_n(seen + kRows * width, kept * width, seen);
        centres(top - 1 + static_cast<int>(kept), end + 1, m_grid.side_v, m_room->rows);
        see_grid(*m_surface, m_camera, m_room->columns, m_room->rows, seen + kept * width);
        for (int j = top; j < end; ++j) {
            const glm::dvec3* const here = seen + static_cast<std::size_t>(j - top + 1) * width;
            find_row(j, here - width, here, here + width);
        }
    }
}

/// Adds the blocks of a row that are on the screen.
void OkaRaster::find_row(int row, const glm::dvec3* above, const glm::dvec3* here, const glm::dvec3* below) {
    const double twice_u = 2 * m_grid.side_u, twice_v = 2 * m_grid.side_v;
    std::vector<std::int32_t>& behind = m_room->behind;
    behind.clear();
    for (int i = 0; i < m_count.width; ++i) {
        const glm::dvec3& centre = here[i + 1];
        const glm::dvec3 by_u = (here[i + 2] - here[i]) / twice_u,
                         by_v = (below[i + 1] - above[i + 1]) / twice_v;
        if (add(centre, by_u, by_v, i, row, 0) || !m_camera.perspective()) continue;
        // Written so that a depth that is no number may be one behind the camera.
        const double depths[] = {centre.z, here[i].z, here[i + 2].z, above[i + 1].z, below[i + 1].z};
        const auto [near, far] = std::minmax_element(std::begin(depths), std::end(depths));
        if (!std::isfinite(centre.z + by_u.z + by_v.z) || !(*far <= kMostSteepness * *near))
            behind.push_back(i);
    }
    for (std::size_t k = 0, end = 0; k < behind.size(); k = end) {
        for (end = k + 1; end < behind.size() && behind[end] == behind[end - 1] + 1;) ++end;
        add_parts_of_row(row, behind[k], behind[end - 1] + 1);
    }
}

/// Adds a block, or a part of one, whose parallelogram is on the screen and no line. Is it on the screen?
bool OkaRaster::add(const glm::dvec3& centre, const glm::dvec3& by_u, const glm::dvec3& by_v, int column,
                    int row, int level) {
    const Size& screen = m_camera.screen();
    const double half_width = 0.5 * screen.width, half_height = 0.5 * screen.height;
    const simd::ParallelogramGrid grid = level == 0 ? m_grid : m_grid.at(level);
    const double reach_x = std::fabs(by_u.x) * grid.half_u + std::fabs(by_v.x) * grid.half_v,
                 reach_y = std::fabs(by_u.y) * grid.half_u + std::fabs(by_v.y) * grid.half_v;
    // Written so that what is no number is not on the screen.
    if (!(std::fabs(centre.x) < half_width + reach_x && std::fabs(centre.y) < half_height + reach_y))
        return false;
    const double area = by_u.x * by_v.y - by_v.x * by_u.y, square_u = square(by_u.x) + square(by_u.y),
                 square_v = square(by_v.x) + square(by_v.y);
    if (!(square_u + square_v <= kMostCondition * std::fabs(area)) || !std::isfinite(by_u.z + by_v.z))
        return true;
    m_most_by_u = std::max(m_most_by_u, square_u);
    m_most_by_v = std::max(m_most_by_v, square_v);
    const double inverse = 1 / area;
    // A pixel more, for what this and the places of pixels lose.
    const auto first = [](double at) { return static_cast<int>(std::max(at, 0.0)); };
    const auto end = [](double at, int size) { return static_cast<int>(std::min(at + 1.5, double(size))); };
    const double x = centre.x + half_width - 0.5, y = centre.y + half_height - 0.5;
    m_room->blocks.push_back({centre.x, centre.y, centre.z, by_v.y * inverse, -by_v.x * inverse,
                              -by_u.y * inverse, by_u.x * inverse, by_u.z, by_v.z, column, row, level,
                              Box{first(x - reach_x), first(y - reach_y), end(x + reach_x, screen.width),
                                  end(y + reach_y, screen.height)}});
    m_room->squares.push_back(squares_of(m_room->blocks.back().pixels));
    return true;
}

/// Adds parts of blocks of a row: those of a run that is out of view are found out of view together.
void OkaRaster::add_parts_of_row(int row, int first, int end) {
    const Interval u(std::max(0.0, (first + 0.5) * m_grid.side_u - m_grid.half_u),
                     std::min(1.0, (end - 0.5) * m_grid.side_u + m_grid.half_u));
    if (is_out_of_view(*m_surface, m_camera, u, reach_of((row + 0.5) * m_grid.side_v, m_grid.half_v))) return;
    if (end - first == 1) {
        add_parts(first, row, 0);
        return;
    }
    const int middle = (first + end) / 2;
    add_parts_of_row(row, first, middle);
    add_parts_of_row(row, middle, end);
}

/// Adds a part of a block where it has a linear map that serves, or else its quarters.
void OkaRaster::add_parts(int column, int row, int level) {
    const double part = std::ldexp(1.0, -level);
    if (column * m_grid.side_u * part >= 1 || row * m_grid.side_v * part >= 1) return;
    ++m_parts;
    OkaBlock block;
    const bool made = oka_block(*m_surface, m_camera, m_picture, m_blocks, column, row, block, level);
    const simd::ParallelogramGrid grid = m_grid.at(level);
    if (!is_steep(*m_surface, m_camera, grid, column, row)) {
        if (made && level > 0) add(block.centre, block.by_u, block.by_v, column, row, level);
        return;
    }
    if (is_out_of_view(*m_surface, m_camera, reach_of((column + 0.5) * grid.side_u, grid.half_u),
                       reach_of((row + 0.5) * grid.side_v, grid.half_v)))
        return;
    if (level == kMostHalvings || m_parts >= kMostParts) {
        if (!made || !add(block.centre, block.by_u, block.by_v, column, row, level)) ++m_left_out;
        return;
    }
    for (const int down : {0, 1})
        for (const int across : {0, 1}) add_parts(2 * column + across, 2 * row + down, level + 1);
}

/// From the farthest to the nearest.
void OkaRaster::sort_by_depth() {
    const auto& blocks = m_room->blocks;
    const auto& keys = m_room->keys;
    auto& order = m_room->order;
    m_room->keys.clear();
    for (const simd::Parallelogram& p : blocks) m_room->keys.push_back(far_first(p.z));
    bucket_sort(keys, order, m_room->sorted);
    // Depths that are one as floats are few, but of a camera far away.
    for (auto begin = order.begin(); begin != order.end();) {
        const auto end =
            std::find_if(begin, order.end(), [&](std::uint32_t i) { return keys[i] != keys[*begin]; });
        std::stable_sort(begin, end,
                         [&](std::uint32_t a, std::uint32_t b) { return blocks[a].z > blocks[b].z; });
        begin = end;
    }
}

OkaRoom::Squares OkaRaster::squares_of(const Box& pixels) const {
    const Size& screen = m_camera.screen();
    const auto square = [&](int at, int size) {
        return static_cast<std::uint16_t>(static_cast<unsigned>(std::clamp(at, 0, size - 1)) /
                                          static_cast<unsigned>(m_square));
    };
    return {square(pixels.x0 - 2, screen.width), square(pixels.y0 - 2, screen.height),
            square(pixels.x1 + 1, screen.width), square(pixels.y1 + 1, screen.height)};
}

/// The blocks of each square of the screen and the pixels around it, in the order in which they are drawn.
void OkaRaster::list_squares() {
    const int rows = (m_camera.screen().height + m_square - 1) / m_square;
    std::vector<std::size_t>& first = m_room->first;
    const auto each_square = [&](const OkaRoom::Squares& s, const auto& body) {
        for (int row = s.y0; row <= s.y1; ++row)
            for (int column = s.x0; column <= s.x1; ++column)
                body(static_cast<std::size_t>(row * m_columns + column));
    };
    // Counted, added up, and put in their order.
    first.assign(static_cast<std::size_t>(m_columns * rows) + 2, 0);
    for (const OkaRoom::Squares& s : m_room->squares)
        each_square(s, [&](std::size_t at) { ++first[at + 2]; });
    for (std::size_t i = 2; i < first.size(); ++i) first[i] += first[i - 1];
    m_room->lists.resize(first.back());
    const auto put = [&](std::uint32_t block) {
        each_square(m_room->squares[block], [&](std::size_t at) { m_room->lists[first[at + 1]++] = block; });
    };
    if (m_blocks.linear_depth)
        for (std::uint32_t k = 0; k < count(); ++k) put(k);
    else
        for (const std::uint32_t block : m_room->order) put(block);
}

void OkaRaster::draw(const Box& box, SeenPixels& seen, int times) const {
    seen.clear(box, m_blocks.linear_depth);
    if (box.empty()) return;
    // Of the square in the middle: the box may reach over its edges by a pixel.
    const int row = (box.y0 + box.y1) / 2 / times / m_square,
              column = (box.x0 + box.x1) / 2 / times / m_square;
    const auto square = static_cast<std::size_t>(row * m_columns + column);
    const std::size_t first = m_room->first[square];
    const Size& screen = m_camera.screen();
    simd::draw_parallelograms(
        m_room->blocks.data(), m_room->lists.data() + first, m_room->first[square + 1] - first, m_grid,
        {box, screen.width, screen.height, times}, m_blocks.linear_depth,
        {seen.nearness.data(), seen.u.data(), seen.v.data(), seen.facet.data(), seen.stride});
}

OkaBlock OkaRaster::block_of(const simd::Parallelogram& p) const {
    OkaBlock block{};
    oka_block(*m_surface, m_camera, m_picture, m_blocks, p.column, p.row, block, p.level);
    return block;
}

Facets OkaRaster::empty_facets() const {
    Facets facets;
    facets.grid_bits = grid_bits_of(m_camera.screen());
    facets.inverse_depth = false;
    facets.corners.resize(4 * count());
    facets.facets.resize(2 * count());
    facets.leaves.resize(count());
    return facets;
}

void OkaRaster::make_facets(std::size_t block, Facets& to) const {
    const double unit = std::ldexp(1.0, to.grid_bits);
    const OkaBlock b = block_of(m_room->blocks[block]);
    const auto first = static_cast<std::uint32_t>(4 * block), leaf = static_cast<std::uint32_t>(block);
    FacetCorner* corner = to.corners.data() + first;
    const double corners[4][2] = {{b.u0, b.v0}, {b.u1, b.v0}, {b.u1, b.v1}, {b.u0, b.v1}};
    for (const auto& [u, v] : corners) {
        const glm::dvec3 at = b.centre + (u - b.u) * b.by_u + (v - b.v) * b.by_v;
        *corner++ = {at.x * unit, at.y * unit, 1, -(m_blocks.linear_depth ? at.z : b.centre.z), u, v};
    }
    to.leaves[block] = {SurfacePatch::kNone, HUGE_VAL, glm::length(glm::dvec2(b.by_u)),
                        glm::length(glm::dvec2(b.by_v))};
    to.facets[2 * block] = {{first, first + 1, first + 2}, leaf};
    to.facets[2 * block + 1] = {{first, first + 2, first + 3}, leaf};
}

double OkaRaster::lost_by(const OkaBlock& block, const simd::ParallelogramGrid& grid) const {
    const double by_u = glm::length(glm::dvec2(block.by_u)), by_v = glm::length(glm::dvec2(block.by_v));
    // What the inverse loses, relative to a point's distance from the centre, is the map's condition times a few units of
    // 2^-53; and a unit of u and of v.
    const double condition =
        (square(by_u) + square(by_v)) / std::fabs(block.by_u.x * block.by_v.y - block.by_v.x * block.by_u.y);
    return (condition * (by_u * grid.half_u + by_v * grid.half_v) + by_u + by_v) * 0x1p-48;
}

double OkaRaster::quick_bound_of(std::size_t index) const {
    const OkaBlock block = block_of(m_room->blocks[index]);
    const simd::ParallelogramGrid grid = m_grid.at(m_room->blocks[index].level);
    return surface::quick_bound_of(block, *m_surface, m_camera, grid.half_u, grid.half_v) +
           lost_by(block, grid);
}

double OkaRaster::bound_of(std::size_t index) const {
    const OkaBlock block = block_of(m_room->blocks[index]);
    const simd::ParallelogramGrid grid = m_grid.at(m_room->blocks[index].level);
    return std::min(surface::quick_bound_of(block, *m_surface, m_camera, grid.half_u, grid.half_v),
                    surface::bound_of(block, *m_surface, m_camera, grid.half_u, grid.half_v)) +
           lost_by(block, grid);
}

double OkaRaster::most_bound(const ParallelFor& parallel_for) const {
    constexpr std::size_t kAtOnce = 256;
    const auto in_parts = [&](std::size_t size, const auto& body) {
        parallel_for(static_cast<std::int64_t>((size + kAtOnce - 1) / kAtOnce), [&](std::int64_t part) {
            const std::size_t first = static_cast<std::size_t>(part) * kAtOnce;
            for (std::size_t i = first; i < std::min(first + kAtOnce, size); ++i) body(i);
        });
    };
    std::vector<double> quick(count());
    in_parts(count(), [&](std::size_t i) { quick[i] = quick_bound_of(i); });
    std::vector<std::size_t> order(count());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return quick[a] > quick[b]; });
    // No bound is larger than a quick one.
    double most = 0;
    std::vector<double> bounds;
    for (std::size_t done = 0; done < order.size() && quick[order[done]] > most; done += bounds.size()) {
        bounds.resize(std::min(4 * kAtOnce, order.size() - done));
        in_parts(bounds.size(), [&](std::size_t i) { bounds[i] = bound_of(order[done + i]); });
        most = std::max(most, *std::max_element(bounds.begin(), bounds.end()));
    }
    return most;
}

}  // namespace anamorph::surface
