// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/drape_map.h"

#include <algorithm>
#include <cmath>

#include "anamorph/image/split_points.h"
#include "anamorph/surface/polish.h"

namespace anamorph::surface {
namespace {

constexpr std::size_t kKeptRegions = 8;

// Blocks of which only a part is seen, or only a part exactly, are cut down to the least side.
constexpr int kMostSide = 32, kLeastSide = 8;

// So are those over so many texels for a pixel, and so many times as many as the steps at their corners say: sheets that lie
// far apart on the picture meet there, and all that lies between them would be read.
constexpr double kMostTexels = 16, kManyTexels = 4;

/// How many pixels of a box show something.
int seen_in(const SeenPixels& pixels, const Box& box) {
    int count = 0;
    for (int y = box.y0; y < box.y1; ++y) {
        const double* const facet = pixels.facet.data() + pixels.index(box.x0, y);
        count += static_cast<int>(
            std::count_if(facet, facet + box.width(), [](double f) { return f != SeenPixels::kNone; }));
    }
    return count;
}

/// body(x, y, at) for the pixels of a box that show something; `at` as SeenPixels::index().
template <class Body>
void for_seen(const SeenPixels& pixels, const Box& box, const Body& body) {
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x)
            if (const std::size_t at = pixels.index(x, y); pixels.facet[at] != SeenPixels::kNone)
                body(x, y, at);
}

/// body(box) for squares of at most `side`.
template <class Body>
void for_squares(const Box& box, int side, const Body& body) {
    for (int y = box.y0; y < box.y1; y += side)
        for (int x = box.x0; x < box.x1; x += side) body(intersection({x, y, x + side, y + side}, box));
}

std::unique_ptr<FacetRoom> room_of(Facets facets) {
    auto room = std::make_unique<FacetRoom>();
    room->facets = std::move(facets);
    return room;
}

}  // namespace

DrapeMap::DrapeMap(Facets facets, const Camera& camera, const Size& picture, double tol,
                   std::shared_ptr<const DrapedSurface> surface)
    : DrapeMap(room_of(std::move(facets)), camera, picture, tol, std::move(surface),
               std::make_shared<SeenPool>(), std::make_shared<FacetPool>()) {}

DrapeMap::DrapeMap(std::unique_ptr<FacetRoom> room, const Camera& camera, const Size& picture, double tol,
                   std::shared_ptr<const DrapedSurface> surface, std::shared_ptr<SeenPool> pool,
                   std::shared_ptr<FacetPool> facet_pool)
    : BlockMap(camera.screen().width, camera.screen().height,
               {{0, 0, camera.screen().width, camera.screen().height}}, {1, kSquare, kKeptRegions}),
      m_room(std::move(room)),
      m_camera(camera),
      m_picture(picture),
      m_for_float(tol * kFloatShare),
      m_surface(std::move(surface)),
      m_pool(std::move(pool)),
      m_facet_pool(std::move(facet_pool)) {
    m_raster.emplace(*m_room, camera.screen(), kSquare);
    for (const FacetLeaf& leaf : m_room->facets.leaves) {
        m_most_bound = std::max(m_most_bound, leaf.bound);
        m_most_by_u = std::max(m_most_by_u, leaf.by_u);
        m_most_by_v = std::max(m_most_by_v, leaf.by_v);
        m_most_depth_bound = std::max(m_most_depth_bound, leaf.depth_bound);
    }
}

DrapeMap::~DrapeMap() {
    m_raster.reset();
    if (m_facet_pool) m_facet_pool->give_back(std::move(m_room));
}

DrapeMap::DrapeMap(std::shared_ptr<const OkaRaster> blocks, const Camera& camera, const Size& picture,
                   double tol, std::shared_ptr<SeenPool> pool)
    : BlockMap(camera.screen().width, camera.screen().height,
               {{0, 0, camera.screen().width, camera.screen().height}}, {1, kSquare, kKeptRegions}),
      m_blocks(std::move(blocks)),
      m_room(std::make_unique<FacetRoom>()),
      m_camera(camera),
      m_picture(picture),
      m_for_float(tol * kFloatShare),
      m_most_bound(HUGE_VAL),
      m_most_by_u(m_blocks->most_by_u()),
      m_most_by_v(m_blocks->most_by_v()),
      m_most_depth_bound(HUGE_VAL),
      m_pool(std::move(pool)) {
    m_room->facets = m_blocks->empty_facets();
    m_made.emplace(m_blocks->count());
}

const Facet& DrapeMap::facet(std::size_t index) const {
    if (m_blocks)
        m_made->ask(index / 2, [&](std::size_t first, std::size_t end) {
            for (std::size_t block = first; block < end; ++block)
                m_blocks->make_facets(block, m_room->facets);
        });
    return m_room->facets.facets[index];
}

/// The bounds of the patches.
const std::vector<double>& DrapeMap::bounds(const ParallelFor& parallel_for) const {
    std::call_once(m_bounded, [&] {
        constexpr std::size_t kAtOnce = 256;
        m_bounds.resize(patches());
        parallel_for(static_cast<std::int64_t>((patches() + kAtOnce - 1) / kAtOnce), [&](std::int64_t part) {
            const std::size_t first = static_cast<std::size_t>(part) * kAtOnce,
                              end = std::min(first + kAtOnce, patches());
            for (std::size_t i = first; i < end; ++i)
                m_bounds[i] = m_blocks ? m_blocks->bound_of(i) : m_room->facets.leaves[i].bound;
        });
    });
    return m_bounds;
}

const Facet& DrapeMap::part_of(const Facet& facet, double u, double v) const {
    if (!m_blocks) return facet;
    // Cut from the first corner to the third.
    const Facet& first = this->facet(2 * std::size_t{facet.leaf});
    const FacetCorner &a = corner(first.corner[0]), &c = corner(first.corner[2]);
    const bool right = (u - a.u) * (c.v - a.v) >= (v - a.v) * (c.u - a.u);
    return right ? first : this->facet(2 * std::size_t{facet.leaf} + 1);
}

double DrapeMap::max_error(const ParallelFor& parallel_for) const {
    if (patches() == 0) return 0;
    return (m_blocks ? m_blocks->most_bound(parallel_for) : m_most_bound) + m_for_float;
}

void DrapeMap::plan(const Box& box, int, Blocks& blocks) const {
    const auto region = std::make_shared<SeenRegion>(m_pool);
    const Box screen{0, 0, width(), height()};
    see(intersection({box.x0 - 1, box.y0 - 1, box.x1 + 1, box.y1 + 1}, screen), region->pixels());
    if (m_surface) polish(region->pixels());
    blocks.data = region;
    for_squares(box, kMostSide, [&](const Box& square) { cut(*region, square, blocks); });
}

void DrapeMap::see(const Box& box, SeenPixels& pixels, int times) const {
    if (m_blocks)
        m_blocks->draw(box, pixels, times);
    else
        m_raster->draw(box, pixels, times);
    if (m_surface) order_sheets(box, pixels, times);
}

/// A facet's own points lie in the depths of its patch, or a little beyond its edge: within as much again either way.
/// Where the depths of another facet at a pixel begin before those of the one that is seen end, both points are found,
/// and the nearer one is seen.
void DrapeMap::order_sheets(const Box& box, SeenPixels& pixels, int times) const {
    const PointPolish to(*m_surface, m_camera);
    const auto leaf_of = [&](double facet) -> const FacetLeaf& {
        return m_room->facets.leaves[m_room->facets.facets[static_cast<std::size_t>(facet)].leaf];
    };
    const auto begins = [](const FacetLeaf& leaf) { return 2 * leaf.nearest - leaf.farthest; };
    const auto ends = [](const FacetLeaf& leaf) { return 2 * leaf.farthest - leaf.nearest; };
    m_raster->each_covered(box, times, [&](std::uint32_t facet, int x, int y, double u, double v) {
        const std::size_t at = pixels.index(x, y);
        if (pixels.facet[at] == facet || begins(leaf_of(facet)) > ends(leaf_of(pixels.facet[at]))) return;
        const double px = (x + 0.5) / times - width() / 2.0, py = (y + 0.5) / times - height() / 2.0;
        const PointPolish::Polished seen = to.polish(px, py, pixels.u[at], pixels.v[at]);
        if (!(seen.bound <= kExactError)) return;
        const PointPolish::Polished other = to.polish(px, py, u, v);
        if (!(other.bound <= kExactError && other.nearness > seen.nearness)) return;
        pixels.facet[at] = facet;
        pixels.nearness[at] = other.nearness;
        pixels.u[at] = u;
        pixels.v[at] = v;
    });
}

/// Moves the points to those that are seen at the middles of their pixels. Slopes over what a square shows, and an eighth of that
/// around it for what points move, serve most of its pixels.
void DrapeMap::polish(SeenPixels& pixels) const {
    constexpr int kSide = 8;
    const PointPolish to(*m_surface, m_camera);
    pixels.bound.assign(pixels.facet.size(), 0);
    for_squares(pixels.box, kSide, [&](const Box& square) {
        Interval u(HUGE_VAL, -HUGE_VAL), v = u;
        for_seen(pixels, square, [&](int, int, std::size_t at) {
            u = {std::min(u.lo, pixels.u[at]), std::max(u.hi, pixels.u[at])};
            v = {std::min(v.lo, pixels.v[at]), std::max(v.hi, pixels.v[at])};
        });
        if (!(u.lo <= u.hi && v.lo <= v.hi)) return;
        const auto with_more = [](const Interval& a) {
            const double more = (a.hi - a.lo) / 8;
            return Interval(std::max(0.0, a.lo - more), std::min(1.0, a.hi + more));
        };
        const PointPolish::Slopes around = to.slopes(with_more(u), with_more(v));
        for_seen(pixels, square, [&](int x, int y, std::size_t at) {
            const auto& facet = m_room->facets.facets[static_cast<std::size_t>(pixels.facet[at])];
            pixels.bound[at] = m_room->facets.leaves[facet.leaf].bound;
            const PointPolish::Polished p = to.polish(x + 0.5 - width() / 2.0, y + 0.5 - height() / 2.0,
                                                      pixels.u[at], pixels.v[at], &around);
            if (!(p.bound < pixels.bound[at])) return;
            pixels.u[at] = p.u;
            pixels.v[at] = p.v;
            pixels.nearness[at] = p.nearness;
            pixels.bound[at] = p.bound;
        });
    });
}

double DrapeMap::bound_at(const SeenPixels& pixels, std::size_t at) const {
    if (!pixels.bound.empty()) return pixels.bound[at];
    return bounds()[leaf_of(pixels.facet[at])];
}

double DrapeMap::nearness_at(const SeenPixels& pixels, std::size_t at) const {
    return pixels.nearness.empty() ? m_blocks->nearness(leaf_of(pixels.facet[at])) : pixels.nearness[at];
}

std::size_t DrapeMap::leaf_of(double facet) const {
    const auto index = static_cast<std::size_t>(facet);
    return m_blocks ? index / 2 : m_room->facets.facets[index].leaf;
}

/// Adds the blocks of a square: whole where all of it is seen, or nothing; else its quarters.
void DrapeMap::cut(const SeenRegion& region, const Box& box, Blocks& blocks) const {
    const int seen = seen_in(region.pixels(), box);
    Block block;
    block.box = box;
    block.data = &region;
    if (seen == 0) {
        block.kind = Block::Kind::outside;
        blocks.push_back(block);
        return;
    }
    const int side = std::max(box.width(), box.height());
    const bool whole = seen == box.width() * box.height();
    block.bound = bound_of(region, box);
    const bool alike = whole && !(m_surface && block.bound > kExactError);
    if (!alike && side > kLeastSide) {
        for_squares(box, (side + 1) / 2, [&](const Box& quarter) { cut(region, quarter, blocks); });
        return;
    }
    block.kind = Block::Kind::computed;
    const Range range = whole ? range_of(region, box) : Range{};
    if (whole && side > kLeastSide && torn(region, box, range)) {
        for_squares(box, (side + 1) / 2, [&](const Box& quarter) { cut(region, quarter, blocks); });
        return;
    }
    block.precise = m_surface || !(whole && fits_float(region, box, range, block));
    blocks.push_back(block);
}

/// The largest bound of what a box shows, or of all there is.
double DrapeMap::bound_of(const SeenRegion& region, const Box& box) const {
    const SeenPixels& pixels = region.pixels();
    if (pixels.bound.empty()) return m_most_bound;
    double bound = 0;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x) bound = std::max(bound, pixels.bound[pixels.index(x, y)]);
    return bound;
}

/// What the points of a box run over.
DrapeMap::Range DrapeMap::range_of(const SeenRegion& region, const Box& box) {
    const SeenPixels& pixels = region.pixels();
    const std::size_t first = pixels.index(box.x0, box.y0);
    const auto of = [&](const std::vector<double>& values) {
        return anamorph::simd::ends_of(anamorph::simd::ValueRows<double>{values.data() + first, pixels.stride,
                                                                         box.width(), box.height()});
    };
    const anamorph::simd::Ends u = of(pixels.u), v = of(pixels.v);
    return {{u.low, u.high}, {v.low, v.high}};
}

/// Do sheets that lie far apart on the picture meet in a box?
bool DrapeMap::torn(const SeenRegion& region, const Box& box, const Range& range) const {
    const double texels =
        (range.u[1] - range.u[0]) * m_picture.width * ((range.v[1] - range.v[0]) * m_picture.height);
    if (!(texels > kMostTexels * box.width() * box.height()) || box.width() < 2 || box.height() < 2)
        return false;
    const SeenPixels& pixels = region.pixels();
    double u = 0, v = 0;
    for (const int y : {box.y0, box.y1 - 1})
        for (const int x : {box.x0, box.x1 - 1}) {
            const std::size_t at = pixels.index(x, y), beside = pixels.index(x == box.x0 ? x + 1 : x - 1, y),
                              below = pixels.index(x, y == box.y0 ? y + 1 : y - 1);
            const auto reach = [&](const std::vector<double>& of) {
                return std::fabs(of[beside] - of[at]) * box.width() +
                       std::fabs(of[below] - of[at]) * box.height();
            };
            u = std::max(u, reach(pixels.u));
            v = std::max(v, reach(pixels.v));
        }
    return texels > kManyTexels * u * m_picture.width * v * m_picture.height;
}

/// Gives a block a base to count its points from, and adds what is lost where they are floats: half of 2^-24 of their
/// distance from the base, as fast as the surface moves on the screen. False where that is too much.
bool DrapeMap::fits_float(const SeenRegion& region, const Box& box, const Range& range, Block& block) const {
    block.base_x = static_cast<std::int32_t>(std::floor(range.u[0] * m_picture.width));
    block.base_y = static_cast<std::int32_t>(std::floor(range.v[0] * m_picture.height));
    const double reach_u = range.u[1] - range.u[0] + 1.0 / m_picture.width,
                 reach_v = range.v[1] - range.v[0] + 1.0 / m_picture.height;
    const auto lost_by = [&](double by_u, double by_v) {
        return 0x1p-24 * (reach_u * by_u + reach_v * by_v);
    };
    double lost = lost_by(m_most_by_u, m_most_by_v);
    if (!(lost <= m_for_float) && !m_blocks) {
        lost = 0;
        for_leaves(region, box,
                   [&](const FacetLeaf& leaf) { lost = std::max(lost, lost_by(leaf.by_u, leaf.by_v)); });
    }
    if (!(lost <= m_for_float)) return false;
    block.bound += lost;
    return true;
}

/// body(leaf) for every leaf that a box shows.
template <class Body>
void DrapeMap::for_leaves(const SeenRegion& region, const Box& box, const Body& body) const {
    double last = SeenPixels::kNone;
    for (int y = box.y0; y < box.y1; ++y) {
        const double* const facet = region.pixels().facet.data() + region.pixels().index(box.x0, y);
        for (int i = 0; i < box.width(); ++i) {
            if (facet[i] == last || facet[i] == SeenPixels::kNone) continue;
            last = facet[i];
            body(m_room->facets.leaves[m_room->facets.facets[static_cast<std::size_t>(last)].leaf]);
        }
    }
}

std::shared_ptr<const SeenRegion> DrapeMap::region_at(int x, int y) const {
    const std::int64_t columns = (width() + kSquare - 1) / kSquare;
    const auto kept = std::make_shared<SharedBlocks>(blocks(y / kSquare * columns + x / kSquare));
    return {kept, static_cast<const SeenRegion*>((*kept)[0].data)};
}

bool DrapeMap::exact(double x, double y, int, Point<double>& source_point, int& source_piece) const noexcept {
    const int i = std::clamp(static_cast<int>(std::floor(x)), 0, width() - 1),
              j = std::clamp(static_cast<int>(std::floor(y)), 0, height() - 1);
    const auto region = region_at(i, j);
    const SeenPixels& pixels = region->pixels();
    const std::size_t at = pixels.index(i, j);
    source_piece = 0;
    if (pixels.facet[at] == SeenPixels::kNone) return false;
    source_point = {pixels.u[at] * m_picture.width, pixels.v[at] * m_picture.height};
    return true;
}

void DrapeMap::exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept {
    const SeenPixels& pixels = static_cast<const SeenRegion*>(block.data)->pixels();
    for (int row = begin; row < end; ++row) {
        const std::size_t at = pixels.index(block.box.x0, block.box.y0 + row);
        const std::ptrdiff_t first = (row - begin) * to.stride;
        for (int i = 0; i < block.box.width(); ++i) {
            const std::size_t k = at + static_cast<std::size_t>(i);
            to.x[first + i] = pixels.u[k] * m_picture.width;
            to.y[first + i] = pixels.v[k] * m_picture.height;
            to.piece[first + i] = pixels.facet[k] == SeenPixels::kNone ? -1 : 0;
        }
    }
}

void DrapeMap::computed_row(const Block& block, int row, int begin, int end, float* x,
                            float* y) const noexcept {
    const SeenPixels& pixels = static_cast<const SeenRegion*>(block.data)->pixels();
    const std::size_t at = pixels.index(block.box.x0 + begin, block.box.y0 + row);
    const double *const u = pixels.u.data() + at, *const v = pixels.v.data() + at;
    const double width = m_picture.width, height = m_picture.height, left = block.base_x, top = block.base_y;
    for (int i = 0; i < end - begin; ++i) {
        x[i] = static_cast<float>(u[i] * width - left);
        y[i] = static_cast<float>(v[i] * height - top);
    }
}

Jacobian DrapeMap::jacobian(double x, double y, int) const noexcept {
    const int i = std::clamp(static_cast<int>(std::floor(x)), 0, width() - 1),
              j = std::clamp(static_cast<int>(std::floor(y)), 0, height() - 1);
    const auto region = region_at(i, j);
    const double seen = region->pixels().facet[region->pixels().index(i, j)];
    if (seen == SeenPixels::kNone) return {};
    return jacobian_of(facet(seen), x, y);
}

/// The derivative of the facet's projective map.
Jacobian DrapeMap::jacobian_of(const Facet& facet, double x, double y) const {
    const double unit = std::ldexp(1.0, grid_bits());
    const double px = (x - width() / 2.0) * unit, py = (y - height() / 2.0) * unit;
    // Weighted sums over the corners of 1, u and v, and their derivatives by x and y.
    double w[3] = {}, u[3] = {}, v[3] = {};
    for (int k = 0; k < 3; ++k) {
        const FacetCorner &a = corner(facet.corner[(k + 1) % 3]), &b = corner(facet.corner[(k + 2) % 3]),
                          &c = corner(facet.corner[k]);
        const double e[3] = {edge_function(a, b, px, py), -(b.y - a.y) * unit, (b.x - a.x) * unit};
        for (int n = 0; n < 3; ++n) {
            w[n] += e[n] * c.weight;
            u[n] += e[n] * c.weight * c.u;
            v[n] += e[n] * c.weight * c.v;
        }
    }
    const auto derivative = [&](const double* s, int n, double scale) {
        return (s[n] - s[0] / w[0] * w[n]) / w[0] * scale;
    };
    return {derivative(u, 1, m_picture.width), derivative(v, 1, m_picture.height),
            derivative(u, 2, m_picture.width), derivative(v, 2, m_picture.height)};
}

}  // namespace anamorph::surface
