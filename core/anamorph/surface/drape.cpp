// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/drape.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <deque>
#include <glm/geometric.hpp>
#include <optional>

#include "anamorph/image/mirrored_source.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/strips.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/surface/oka.h"

namespace anamorph::surface {
namespace {

/// `blocks`: the paper's blocks, where they have been made.
std::shared_ptr<const DrapeMap> map_of(SharedTree& surface, const Camera& camera, const Size& picture,
                                       const DrapeOptions& options,
                                       const std::shared_ptr<const OkaRaster>& blocks = nullptr) {
    if (blocks) return std::make_shared<DrapeMap>(blocks, camera, picture, options.tol, surface.pool);
    if (options.scheme == DrapeScheme::oka || options.scheme == DrapeScheme::oka_z)
        return std::make_shared<DrapeMap>(
            std::make_shared<OkaRaster>(
                surface.tree.shared_surface(), camera, picture,
                OkaBlocks{options.block, options.overlap, options.scheme == DrapeScheme::oka_z},
                DrapeMap::kSquare, surface.oka_pool),
            camera, picture, options.tol, surface.pool);
    const double least = 2 * grid_error(grid_bits_of(camera.screen()));
    if (!(options.tol >= least))
        throw Error("tol", shortest(options.tol),
                    "must be at least " + shortest(least) + " for a picture of this size");
    std::unique_ptr<FacetRoom> room = surface.facet_pool->take();
    {
        const std::lock_guard lock(surface.mutex);
        cut_into_facets(surface.tree, camera, options.tol, *room);
    }
    return std::make_shared<DrapeMap>(
        std::move(room), camera, picture, options.tol,
        options.scheme == DrapeScheme::exact ? surface.tree.shared_surface() : nullptr, surface.pool,
        surface.facet_pool);
}

/// `value` with two digits, rounded up.
double with_two_digits(double value) {
    const double place = std::pow(10, std::floor(std::log10(value)) - 1);
    return std::ceil(value / place) * place;
}

constexpr double kMostTimes = 64;

/// A tolerance above `tol`, which takes too many patches, that does not, within an eighth above the least one; nothing
/// where there is none up to kMostTimes as large, as it takes a while to find.
std::optional<double> least_tol(SharedTree& surface, const Camera& camera, double tol) {
    FacetRoom room;
    const std::lock_guard lock(surface.mutex);
    const auto works = [&](double more) {
        try {
            cut_into_facets(surface.tree, camera, more, room);
            return true;
        } catch (const TooManyPatches&) {
            return false;
        }
    };
    double too_small = tol, enough = kMostTimes * tol;
    if (!works(enough)) return {};
    for (int halving = 0; halving < 5; ++halving) {
        const double middle = std::sqrt(too_small * enough);
        (works(middle) ? enough : too_small) = middle;
    }
    const double rounded = with_two_digits(enough);
    return works(rounded) ? rounded : enough;
}

/// map_of; where patches are too many, the error says with which tolerance they are not.
std::shared_ptr<const DrapeMap> map_or_least_tol(SharedTree& surface, const Camera& camera,
                                                 const Size& picture, const DrapeOptions& options) {
    try {
        return map_of(surface, camera, picture, options);
    } catch (const TooManyPatches& error) {
        const std::optional<double> least = least_tol(surface, camera, options.tol);
        if (!least)
            throw TooManyPatches(options.tol, error.most,
                                 ", and so does " + shortest(kMostTimes * options.tol));
        throw TooManyPatches(options.tol, error.most,
                             ": must be at least " + shortest(static_cast<float>(*least)));
    }
}

/// body(pixels, part) for the regions that meet a box.
template <class Body>
void for_regions(const DrapeMap& map, const Box& box, const Body& body) {
    for (const std::int64_t region : map.regions_in(box)) {
        const Box part = intersection(map.region_box(region), box);
        const auto seen = map.region_at(part.x0, part.y0);
        body(seen->pixels(), part);
    }
}

/// The facets that show where the surface is; null where they are too many.
std::shared_ptr<const DrapeMap> cover_of(SharedTree& surface, const DrapeMap& map) {
    DrapeOptions options;
    options.tol = std::max(Drape::kCoverTol, 2 * grid_error(grid_bits_of(map.camera().screen())));
    try {
        return map_of(surface, map.camera(), map.picture(), options);
    } catch (const Error&) {
        return nullptr;
    }
}

bool shows(const SeenPixels& pixels, int x, int y) {
    return pixels.facet[pixels.index(x, y)] != SeenPixels::kNone;
}

/// The pixels of a box that show nothing where a cover does, also around them.
int holes_in(const SeenPixels& drawn, const SeenPixels& cover, const Box& box) {
    const auto within = [&](int x, int y) {
        for (int j = y - 1; j <= y + 1; ++j)
            for (int i = x - 1; i <= x + 1; ++i)
                if (!shows(cover, i, j)) return false;
        return true;
    };
    int count = 0;
    for (int y = box.y0; y < box.y1; ++y)
        for (int x = box.x0; x < box.x1; ++x)
            if (!shows(drawn, x, y) && within(x, y)) ++count;
    return count;
}

}  // namespace

/// A pixel's facet, and the weights of its corners in space.
struct Drape::Spot {
    const Facet* facet = nullptr;  ///< null where nothing is seen
    double u = 0, v = 0, nearness = 0, bound = 0;
    double weight[3] = {};
};

/// Corners of facets, lit when they are first asked for.
class Drape::LitCorners {
  public:
    LitCorners(std::shared_ptr<const SharedTree> surface, std::shared_ptr<const DrapeMap> map)
        : m_surface(std::move(surface)),
          m_map(std::move(map)),
          m_lit(m_map->corners()),
          m_once(m_map->corners()) {}

    /// That of a corner of a facet that has been asked for: then so have been the facets of the corners beside it in the list, as a
    /// run of OnceEach is of more corners where it is one of the paper's blocks, which have four each.
    const LitPoint& at(std::uint32_t corner) {
        m_once.ask(corner, [&](std::size_t first, std::size_t end) {
            for (std::size_t i = first; i < end; ++i) {
                const FacetCorner& c = m_map->corner(static_cast<std::uint32_t>(i));
                m_lit[i] = lit_point(m_surface->tree.surface(), m_map->camera(), c.u, c.v);
            }
        });
        return m_lit[corner];
    }

  private:
    std::shared_ptr<const SharedTree> m_surface;
    std::shared_ptr<const DrapeMap> m_map;
    std::vector<LitPoint> m_lit;
    OnceEach m_once;
};

Drape::Drape(std::shared_ptr<SharedTree> surface, const Camera& camera, const Size& picture,
             const DrapeOptions& options)
    : m_surface(std::move(surface)),
      m_options(options),
      m_map(map_or_least_tol(*m_surface, camera, picture, options)) {
    if (options.lighting.shading != DrapeShading::none || options.own == DrapeOutput::normal)
        m_lit = std::make_shared<LitCorners>(m_surface, m_map);
    const Chart flat(Projection::rectilinear, picture.width, picture.height);
    m_picture.maps = {{m_map, {{Border(flat, options.wrap)}}}};
    m_picture.filter = options.filter;
    m_picture.output = options.output;
    const bool is_other = !(options.back == Size{}) && !(options.back == picture);
    m_back_map = is_other ? map_of(*m_surface, camera, options.back, options, m_map->oka_blocks()) : m_map;
    const Chart flat_back(Projection::rectilinear, m_back_map->picture().width, m_back_map->picture().height);
    m_back_maps = {{m_back_map, {{Border(flat_back, options.wrap)}}}};
}

Reached Drape::reached(const ParallelFor& parallel_for) const {
    // So that they are not found in the midst of drawing, on one thread.
    if (m_options.output == Output::bound) m_map->find_bounds(parallel_for);
    return m_map->exact_points() ? m_map->reached(parallel_for) : Reached{m_map->max_error(parallel_for), 0};
}

std::optional<double> Drape::max_depth_error() const {
    if (m_options.scheme != DrapeScheme::automatic) return {};
    return m_map->max_depth_error();
}

std::optional<int> Drape::holes(const ParallelFor& parallel_for) const {
    if (m_options.scheme == DrapeScheme::automatic || m_options.scheme == DrapeScheme::exact) return 0;
    if (double(m_map->width()) * m_map->height() > kMostCounted) return {};
    const auto cover = cover_of(*m_surface, *m_map);
    if (!cover) return {};
    const Box screen{0, 0, m_map->width(), m_map->height()};
    const std::vector<std::int64_t> regions = m_map->regions_in(screen);
    std::atomic<int> count{0};
    parallel_for(static_cast<std::int64_t>(regions.size()), [&](std::int64_t i) {
        const Box box = m_map->region_box(regions[static_cast<std::size_t>(i)]);
        const auto drawn = m_map->region_at(box.x0, box.y0), covered = cover->region_at(box.x0, box.y0);
        count += holes_in(drawn->pixels(), covered->pixels(),
                          intersection(box, {1, 1, screen.x1 - 1, screen.y1 - 1}));
    });
    return count.load();
}

Drape::Spot Drape::spot(const SeenPixels& pixels, int x, int y) const {
    const std::size_t at = pixels.index(x, y);
    Spot spot;
    if (pixels.facet[at] == SeenPixels::kNone) return spot;
    spot.facet = &m_map->facet(pixels.facet[at]);
    spot.u = pixels.u[at];
    spot.v = pixels.v[at];
    spot.nearness = m_map->nearness_at(pixels, at);
    if (m_options.own == DrapeOutput::shared && m_options.output == Output::bound)
        spot.bound = m_map->bound_at(pixels, at);
    weigh(spot, x + 0.5, y + 0.5);
    return spot;
}

/// The weights of a point of the screen.
void Drape::weigh(Spot& spot, double x, double y) const {
    spot.facet = &m_map->part_of(*spot.facet, spot.u, spot.v);
    const double unit = std::ldexp(1.0, m_map->grid_bits());
    const double px = (x - m_map->width() / 2.0) * unit, py = (y - m_map->height() / 2.0) * unit;
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const FacetCorner &a = m_map->corner(spot.facet->corner[(k + 1) % 3]),
                          &b = m_map->corner(spot.facet->corner[(k + 2) % 3]),
                          &c = m_map->corner(spot.facet->corner[k]);
        spot.weight[k] = std::fabs(edge_function(a, b, px, py)) * c.weight;
        sum += spot.weight[k];
    }
    for (double& weight : spot.weight) weight = sum > 0 ? weight / sum : 1.0 / 3;
}

glm::dvec3 Drape::normal(const Spot& spot) const {
    glm::dvec3 sum(0.0);
    const glm::dvec3& first = m_lit->at(spot.facet->corner[0]).normal;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3& n = m_lit->at(spot.facet->corner[k]).normal;
        // On a silhouette the corners may show different sides.
        sum += spot.weight[k] * (glm::dot(n, first) < 0 ? -n : n);
    }
    const double length = glm::length(sum);
    return length > 0 ? sum / length : glm::dvec3(0.0);
}

/// How far the point that is drawn at a pixel is seen from its centre.
double Drape::landing_error(const Spot& spot, int x, int y) const {
    const std::array<DoubleDouble, 3> p = m_surface->tree.surface().truth(spot.u, spot.v);
    const Camera& camera = m_map->camera();
    DoubleDouble seen[3];
    for (int i = 0; i < 3; ++i)
        seen[i] = camera.matrix()[0][i] * p[0] + camera.matrix()[1][i] * p[1] + camera.matrix()[2][i] * p[2] +
                  camera.offset()[i];
    const DoubleDouble scale = camera.focal() / (camera.perspective() ? seen[2] : 1);
    const DoubleDouble dx = seen[0] * scale + m_map->width() / 2.0 - (x + 0.5),
                       dy = seen[1] * scale + m_map->height() / 2.0 - (y + 0.5);
    return static_cast<double>(hypot(dx, dy));
}

void Drape::put_values(const Spot& spot, int x, int y, float* to) const {
    const bool seen = spot.facet != nullptr;
    switch (m_options.own) {
        case DrapeOutput::depth: {
            const double depth = m_map->inverse_depth() ? 1 / spot.nearness : -spot.nearness;
            *to = static_cast<float>(seen ? depth : HUGE_VAL);
            return;
        }
        case DrapeOutput::normal: {
            const glm::dvec3 n = seen ? normal(spot) : glm::dvec3(0.0);
            for (int i = 0; i < 3; ++i) to[i] = static_cast<float>(n[i]);
            return;
        }
        case DrapeOutput::patch:
            *to = seen ? static_cast<float>(spot.facet->leaf) : -1;
            return;
        case DrapeOutput::coverage:
        case DrapeOutput::seen:
            *to = seen ? 1 : 0;
            return;
        case DrapeOutput::shared:
            break;
    }
    switch (m_options.output) {
        case Output::stmap:
        case Output::stmap_up:
            to[0] = seen ? static_cast<float>(spot.u) : -1;
            to[1] = seen ? static_cast<float>(v_of(m_options.output, spot.v)) : -1;
            return;
        case Output::error:
            *to = seen ? static_cast<float>(landing_error(spot, x, y)) : 0;
            return;
        default:
            *to = seen ? static_cast<float>(spot.bound) : 0;
    }
}

bool Drape::draw_values(const Box& box, const ImageView& view, const ParallelFor& parallel_for) const {
    const Canvas canvas(view, box);
    const Box inside = intersection(box, {0, 0, m_map->width(), m_map->height()});
    for_each_square(inside, parallel_for, [&](const Box& square) {
        for_regions(*m_map, square, [&](const SeenPixels& pixels, const Box& part) {
            float value[3];
            for (int y = part.y0; y < part.y1; ++y)
                for (int x = part.x0; x < part.x1; ++x) {
                    put_values(spot(pixels, x, y), x, y, value);
                    canvas.store(x, y, 1, value);
                }
        });
        anamorph::simd::finish_stores();
    });
    if (m_options.own == DrapeOutput::coverage && averages(m_options.filter))
        for_edges(inside, parallel_for, [&](const std::vector<EdgePixel>& edges) {
            for (const EdgePixel& edge : edges) {
                const float covered = edge.covered();
                canvas.store(edge.x, edge.y, 1, &covered);
            }
        });
    return true;
}

void Drape::light_pixel(const Spot& spot, float* pixel, int channels, const AlphaChannel& alpha) const {
    Light light;
    glm::dvec3 ray(0.0);
    for (int k = 0; k < 3; ++k) {
        const LitPoint& corner = m_lit->at(spot.facet->corner[k]);
        ray += spot.weight[k] * corner.ray;
        if (m_options.lighting.shading == DrapeShading::phong) continue;
        const auto weight = static_cast<float>(spot.weight[k]);
        const Light of_corner = light_at(m_options.lighting, corner);
        light.share += weight * of_corner.share;
        light.highlight += weight * of_corner.highlight;
    }
    if (m_options.lighting.shading == DrapeShading::phong)
        light = light_at(m_options.lighting, {normal(spot), glm::normalize(ray)});
    add_light(light, pixel, channels, alpha.channel, alpha.multiplied);
}

struct Drape::Layers {
    const Source& source;
    const Source* back;  ///< mirrored; null where both sides have the same
    const Source* backdrop;
    AlphaChannel alpha;  ///< of the source, and so of the picture

    bool has_backdrop(const DrapeOptions& options) const { return backdrop || !options.background.empty(); }
    /// Behind a picture of these options.
    std::unique_ptr<Backdrop> make_backdrop(const DrapeOptions& options, const Size& screen) const {
        const Box covered{options.overscan.width, options.overscan.height,
                          screen.width - options.overscan.width, screen.height - options.overscan.height};
        return std::make_unique<Backdrop>(options.background, backdrop, options.backdrop_alpha, covered,
                                          options.filter, source.channels(), alpha);
    }
};

/// Light, and what is behind.
bool Drape::finish(const PixelRows& rows, const Layers& layers) const {
    const bool lit = m_options.lighting.shading != DrapeShading::none,
               behind = layers.has_backdrop(m_options);
    const AlphaChannel& alpha = layers.alpha;
    const int channels = rows.channels;
    const auto backdrop = layers.make_backdrop(m_options, {m_map->width(), m_map->height()});
    std::vector<float> under(static_cast<std::size_t>(channels));
    bool ok = true;
    for_regions(*m_map, rows.box, [&](const SeenPixels& pixels, const Box& part) {
        for (int y = part.y0; y < part.y1; ++y)
            for (int x = part.x0; x < part.x1; ++x) {
                float* const pixel = rows.at(x, y);
                const bool seen = pixels.facet[pixels.index(x, y)] != SeenPixels::kNone;
                if (seen && lit) light_pixel(spot(pixels, x, y), pixel, channels, alpha);
                if (!behind || (seen && !alpha.exists())) continue;
                if (alpha.straight()) associate_alpha(pixel, channels, alpha.channel);
                if (!seen) std::fill_n(pixel, channels, 0.0f);
                ok = backdrop->at(x, y, under.data()) && ok;
                lay_over(pixel, under.data(), channels, alpha.channel, 0, pixel);
                if (alpha.straight()) unassociate_alpha(pixel, channels, alpha.channel);
            }
    });
    return ok;
}

class Drape::EdgePainter {
  public:
    EdgePainter(const Drape& drape, const Layers& layers)
        : m_drape(drape),
          m_layers(layers),
          m_chooser(layers.source),
          m_sampler(layers.source, border()),
          m_part(static_cast<std::size_t>(layers.source.channels()) + 16),
          m_under(m_part) {
        if (layers.back) {
            m_back_chooser.emplace(*layers.back);
            m_back_sampler.emplace(*layers.back, back_border());
        }
        if (layers.has_backdrop(drape.m_options))
            m_backdrop = layers.make_backdrop(drape.m_options, {drape.m_map->width(), drape.m_map->height()});
    }

    /// Each part by itself, and behind them what is behind the surface. False when a source could not be read.
    bool draw(const EdgePixel& edge, float* pixel) {
        const int channels = m_layers.source.channels();
        const AlphaChannel& alpha = m_layers.alpha;
        std::fill_n(pixel, channels, 0.0f);
        bool ok = true;
        for (const EdgePart& part : edge.parts) {
            ok = read(part) && ok;
            const auto share = static_cast<float>(part.share);
            for (int c = 0; c < channels; ++c) pixel[c] += share * m_part[static_cast<std::size_t>(c)];
        }
        if (m_backdrop) {
            ok = m_backdrop->at(edge.x, edge.y, m_under.data()) && ok;
            lay_over(pixel, m_under.data(), channels, alpha.channel, edge.covered(), pixel);
        }
        if (alpha.straight()) unassociate_alpha(pixel, channels, alpha.channel);
        return ok;
    }

  private:
    const Border& border() const { return m_drape.m_picture.maps.front().layers.front().border; }
    const Border& back_border() const { return m_drape.m_back_maps.front().layers.front().border; }
    /// What a part shows, multiplied with its alpha.
    bool read(const EdgePart& part) {
        const int channels = m_layers.source.channels();
        const AlphaChannel& alpha = m_layers.alpha;
        const DrapeMap& map = *m_drape.m_map;
        Spot spot{&map.facet(std::size_t{part.facet}), part.u, part.v};
        m_drape.weigh(spot, part.x, part.y);
        const bool of_back = m_back_sampler && m_drape.shows_back(*spot.facet, part.x, part.y);
        const DrapeMap& of_side = of_back ? *m_drape.m_back_map : map;
        const Jacobian jacobian = of_side.jacobian_of(*spot.facet, part.x, part.y);
        const Size& size = of_side.picture();
        PointSampler& sampler = of_back ? *m_back_sampler : m_sampler;
        const bool ok = sampler.sample(m_drape.m_options.filter, of_back ? *m_back_chooser : m_chooser,
                                       jacobian, 0, part.u * size.width, part.v * size.height, m_part.data());
        if (m_drape.m_options.lighting.shading == DrapeShading::none) return ok;
        if (alpha.straight()) unassociate_alpha(m_part.data(), channels, alpha.channel);
        m_drape.light_pixel(spot, m_part.data(), channels, alpha);
        if (alpha.straight()) associate_alpha(m_part.data(), channels, alpha.channel);
        return ok;
    }

    const Drape& m_drape;
    const Layers& m_layers;
    FootprintChooser m_chooser;
    PointSampler m_sampler;
    std::optional<FootprintChooser> m_back_chooser;
    std::optional<PointSampler> m_back_sampler;
    std::unique_ptr<Backdrop> m_backdrop;
    std::vector<float> m_part, m_under;
};

/// body(edges) for the edge pixels of a box, region by region.
template <class Body>
void Drape::for_edges(const Box& box, const ParallelFor& parallel_for, const Body& body) const {
    const std::vector<std::int64_t> regions = m_map->regions_in(box);
    parallel_for(static_cast<std::int64_t>(regions.size()), [&](std::int64_t i) {
        const Box part = intersection(m_map->region_box(regions[static_cast<std::size_t>(i)]), box);
        body(edges_in(*m_map, *m_map->region_at(part.x0, part.y0), part));
        anamorph::simd::finish_stores();
    });
}

/// Draws edge pixels again, by what is seen at their samples.
bool Drape::draw_edges(const Layers& layers, const Box& box, const Canvas& canvas,
                       const ParallelFor& parallel_for) const {
    std::atomic<bool> ok{true};
    for_edges(box, parallel_for, [&](const std::vector<EdgePixel>& edges) {
        EdgePainter painter(*this, layers);
        std::vector<float> pixel(static_cast<std::size_t>(canvas.channels()) + 16);
        for (const EdgePixel& edge : edges) {
            if (!painter.draw(edge, pixel.data())) ok = false;
            canvas.store(edge.x, edge.y, 1, pixel.data());
        }
    });
    return ok;
}

bool Drape::shows_back(const Facet& facet, double x, double y) const {
    // Seen from the front, the picture is not turned over.
    const Jacobian j = m_map->jacobian_of(facet, x, y);
    return j.x_i * j.y_j - j.x_j * j.y_i < 0;
}

bool Drape::draw_back(const Picture& picture, const Source& back, const Box& box, const ImageView& view,
                      const ParallelFor& parallel_for) const {
    struct Pixel {
        int x, y;
    };
    std::vector<Pixel> seen;
    const Box inside = intersection(box, {0, 0, m_map->width(), m_map->height()});
    for_regions(*m_map, inside, [&](const SeenPixels& pixels, const Box& part) {
        for (int y = part.y0; y < part.y1; ++y)
            for (int x = part.x0; x < part.x1; ++x) {
                const Spot at = spot(pixels, x, y);
                if (at.facet && shows_back(*at.facet, x + 0.5, y + 0.5)) seen.push_back({x, y});
            }
    });
    if (seen.empty()) return true;
    const std::ptrdiff_t pixel = std::ptrdiff_t{view.channels} * size_of(view.type);
    std::vector<std::byte> drawn(static_cast<std::size_t>(pixel * box.width() * box.height()));
    const ImageView to = packed_view(drawn.data(), view.type, box.width(), box.height(), view.channels);
    if (!picture.draw(&back, box, to, parallel_for)) return false;
    for (const Pixel& p : seen)
        std::copy_n(to.at(p.x - box.x0, p.y - box.y0), pixel, view.at(p.x - box.x0, p.y - box.y0));
    return true;
}

bool Drape::draw(const Source* source, const Box& box, const ImageView& view, const ParallelFor& parallel_for,
                 const Source* backdrop, const Source* back) const {
    if (m_options.own != DrapeOutput::shared || m_options.output != Output::color)
        return draw_values(box, view, parallel_for);
    if (!source) return m_picture.draw(source, box, view, parallel_for);
    if (back && (back->channels() != source->channels() || !(back->size(0) == m_back_map->picture()) ||
                 back->unassociated_alpha() != source->unassociated_alpha()))
        throw Error("the picture on the far side has another size than was said, or other channels than src");
    std::optional<MirroredSource> mirrored;
    if (back) back = &mirrored.emplace(*back);
    // Sources that keep no sums are lent a place for them.
    std::deque<Pyramid> lent;
    if (m_options.filter == Filter::summed_area)
        for (const Source** s : {&source, &backdrop, &back})
            if (*s && !(*s)->summed_areas(0)) *s = &lent.emplace_back(**s);
    const int straight = source->unassociated_alpha();
    const Layers layers{*source, back, backdrop, {straight >= 0 ? straight : m_options.alpha, straight < 0}};
    Picture picture = m_picture;
    std::atomic<bool> ok{true};
    if (m_options.lighting.shading != DrapeShading::none || layers.has_backdrop(m_options))
        picture.overlay = [&](const PixelRows& rows) {
            if (!finish(rows, layers)) ok = false;
        };
    if (!picture.draw(source, box, view, parallel_for)) return false;
    picture.maps = m_back_maps;
    if (layers.back && !draw_back(picture, *layers.back, box, view, parallel_for)) return false;
    const Box inside = intersection(box, {0, 0, m_map->width(), m_map->height()});
    return ok && (!averages(m_options.filter) || draw_edges(layers, inside, Canvas(view, box), parallel_for));
}

}  // namespace anamorph::surface
