// SPDX-License-Identifier: Apache-2.0
#include "anamorph/drape/drape.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>

#include "anamorph/drape/oka.h"
#include "anamorph/parameter.h"
#include "anamorph/render/pixel.h"
#include "anamorph/render/strips.h"

namespace anamorph {
namespace {

Facets facets_of(SharedTree& surface, const Camera& camera, const Size& picture,
                 const DrapeOptions& options) {
    if (options.scheme == DrapeScheme::oka || options.scheme == DrapeScheme::oka_z)
        return oka_facets(surface.tree.surface(), camera, picture,
                          {options.block, options.overlap, options.scheme == DrapeScheme::oka_z});
    const double least = 2 * grid_error(grid_bits_of(camera.screen()));
    if (!(options.tol >= least))
        throw Error("tol", shortest(options.tol),
                    "must be at least " + shortest(least) + " for a picture of this size");
    const std::lock_guard lock(surface.mutex);
    return cut_into_facets(surface.tree, camera, options.tol);
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

}  // namespace

/// A pixel's facet, and the weights of its corners in space.
struct Drape::Spot {
    const Facet* facet = nullptr;  ///< null where nothing is seen
    double u = 0, v = 0, nearness = 0;
    double weight[3] = {};
};

Drape::Drape(std::shared_ptr<SharedTree> surface, const Camera& camera, const Size& picture,
             const DrapeOptions& options)
    : m_surface(std::move(surface)),
      m_options(options),
      m_map(std::make_shared<DrapeMap>(facets_of(*m_surface, camera, picture, options), camera, picture,
                                       options.tol)) {
    if (options.lighting.shading != DrapeShading::none || options.own == DrapeOutput::normal)
        for (const FacetCorner& corner : m_map->facets().corners) m_lit.push_back(lit(corner));
    const Chart flat(Projection::rectilinear, picture.width, picture.height);
    m_picture.maps = {{m_map, {{Border(flat, options.wrap)}}}};
    m_picture.filter = options.filter;
    m_picture.output = options.output;
}

Drape::Lit Drape::lit(const FacetCorner& corner) const {
    const Camera& camera = m_map->camera();
    const SurfaceFrame frame = m_surface->tree.surface().frame(corner.u, corner.v);
    const glm::dvec3 across = glm::cross(camera.turned(frame.by_u), camera.turned(frame.by_v));
    const glm::dvec3 ray = camera.ray_to(camera.in_frame(frame.position));
    const double length = glm::length(across);
    const double inverse = length > 0 ? (glm::dot(across, ray) > 0 ? -1 : 1) / length : 0;
    return {camera.in_space(across * inverse), camera.in_space(ray)};
}

Drape::Spot Drape::spot(const SeenPixels& pixels, int x, int y) const {
    const std::size_t at = pixels.index(x, y);
    Spot spot;
    if (pixels.facet[at] == SeenPixels::kNone) return spot;
    const Facets& facets = m_map->facets();
    spot.facet = &facets.facets[static_cast<std::size_t>(pixels.facet[at])];
    spot.u = pixels.u[at];
    spot.v = pixels.v[at];
    spot.nearness = pixels.nearness[at];
    weigh(spot, x + 0.5, y + 0.5);
    return spot;
}

/// The weights of a point of the screen.
void Drape::weigh(Spot& spot, double x, double y) const {
    const Facets& facets = m_map->facets();
    const double unit = std::ldexp(1.0, facets.grid_bits);
    const double px = (x - m_map->width() / 2.0) * unit, py = (y - m_map->height() / 2.0) * unit;
    double sum = 0;
    for (int k = 0; k < 3; ++k) {
        const FacetCorner &a = facets.corners[spot.facet->corner[(k + 1) % 3]],
                          &b = facets.corners[spot.facet->corner[(k + 2) % 3]],
                          &c = facets.corners[spot.facet->corner[k]];
        spot.weight[k] = std::fabs(edge_function(a, b, px, py)) * c.weight;
        sum += spot.weight[k];
    }
    for (double& weight : spot.weight) weight = sum > 0 ? weight / sum : 1.0 / 3;
}

glm::dvec3 Drape::normal(const Spot& spot) const {
    glm::dvec3 sum(0.0);
    const glm::dvec3& first = m_lit[spot.facet->corner[0]].normal;
    for (int k = 0; k < 3; ++k) {
        const glm::dvec3& n = m_lit[spot.facet->corner[k]].normal;
        // On a silhouette the corners may show different sides.
        sum += spot.weight[k] * (glm::dot(n, first) < 0 ? -n : n);
    }
    const double length = glm::length(sum);
    return length > 0 ? sum / length : glm::dvec3(0.0);
}

/// How far the point that is drawn at a pixel is seen from its centre.
double Drape::landing_error(const Spot& spot, int x, int y) const {
    const std::array<long double, 3> p = m_surface->tree.surface().truth(spot.u, spot.v);
    const Camera& camera = m_map->camera();
    long double seen[3];
    for (int i = 0; i < 3; ++i)
        seen[i] = camera.matrix()[0][i] * p[0] + camera.matrix()[1][i] * p[1] + camera.matrix()[2][i] * p[2] +
                  camera.offset()[i];
    const long double scale = camera.focal() / (camera.perspective() ? seen[2] : 1);
    const long double dx = seen[0] * scale + m_map->width() / 2.0L - (x + 0.5L),
                      dy = seen[1] * scale + m_map->height() / 2.0L - (y + 0.5L);
    return static_cast<double>(std::hypot(dx, dy));
}

void Drape::put_values(const Spot& spot, int x, int y, float* to) const {
    const bool seen = spot.facet != nullptr;
    switch (m_options.own) {
        case DrapeOutput::depth: {
            const double depth = m_map->facets().inverse_depth ? 1 / spot.nearness : -spot.nearness;
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
            *to = seen ? 1 : 0;
            return;
        case DrapeOutput::shared:
            break;
    }
    switch (m_options.output) {
        case Output::stmap:
            to[0] = seen ? static_cast<float>(spot.u) : -1;
            to[1] = seen ? static_cast<float>(spot.v) : -1;
            return;
        case Output::error:
            *to = seen ? static_cast<float>(landing_error(spot, x, y)) : 0;
            return;
        default:
            *to = seen ? static_cast<float>(m_map->facets().leaves[spot.facet->leaf].bound) : 0;
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
        simd::finish_stores();
    });
    return true;
}

float Drape::light(const glm::dvec3& n, const glm::dvec3& ray, float& highlight) const {
    const DrapeLighting& l = m_options.lighting;
    double diffuse = 0, specular = 0;
    for (const glm::dvec3& to_light : l.lights) {
        const double facing = glm::dot(n, to_light);
        if (!(facing > 0)) continue;
        diffuse += facing;
        const glm::dvec3 middle = to_light - ray;
        const double length = glm::length(middle);
        if (l.specular > 0 && length > 0)
            specular += std::pow(std::max(0.0, glm::dot(n, middle) / length), l.shininess);
    }
    highlight = static_cast<float>(l.specular * specular);
    return static_cast<float>(l.ambient + l.diffuse * diffuse);
}

void Drape::light_pixel(const Spot& spot, float* pixel, int channels, int alpha) const {
    float share = 0, highlight = 0;
    glm::dvec3 ray(0.0);
    for (int k = 0; k < 3; ++k) {
        const Lit& corner = m_lit[spot.facet->corner[k]];
        ray += spot.weight[k] * corner.ray;
        if (m_options.lighting.shading == DrapeShading::phong) continue;
        float more = 0;
        const auto weight = static_cast<float>(spot.weight[k]);
        share += weight * light(corner.normal, corner.ray, more);
        highlight += weight * more;
    }
    if (m_options.lighting.shading == DrapeShading::phong)
        share = light(normal(spot), glm::normalize(ray), highlight);
    for (int c = 0; c < channels; ++c)
        if (c != alpha) pixel[c] = pixel[c] * share + highlight;
}

/// Light, and the background where nothing is seen.
void Drape::finish(const PixelRows& rows, int alpha) const {
    const bool lit = m_options.lighting.shading != DrapeShading::none;
    for_regions(*m_map, rows.box, [&](const SeenPixels& pixels, const Box& part) {
        for (int y = part.y0; y < part.y1; ++y)
            for (int x = part.x0; x < part.x1; ++x) {
                float* const pixel = rows.at(x, y);
                const bool seen = pixels.facet[pixels.index(x, y)] != SeenPixels::kNone;
                if (seen && lit) light_pixel(spot(pixels, x, y), pixel, rows.channels, alpha);
                if (!seen)
                    for (std::size_t c = 0;
                         c < m_options.background.size() && c < static_cast<std::size_t>(rows.channels); ++c)
                        pixel[c] = m_options.background[c];
            }
    });
}

/// Draws edge pixels again: each part by itself, and nothing where nothing is seen.
bool Drape::draw_edges(const Source& source, const Box& box, const Canvas& canvas,
                       const ParallelFor& parallel_for) const {
    std::atomic<bool> ok{true};
    const std::vector<std::int64_t> regions = m_map->regions_in(box);
    parallel_for(static_cast<std::int64_t>(regions.size()), [&](std::int64_t i) {
        const Box part = intersection(m_map->region_box(regions[static_cast<std::size_t>(i)]), box);
        const FootprintChooser chooser(source);
        PointSampler sampler(source, m_picture.maps.front().layers.front().border);
        std::vector<float> pixel(static_cast<std::size_t>(canvas.channels()) + 16);
        for (const EdgePixel& edge : edges_in(*m_map, *m_map->region_at(part.x0, part.y0), part)) {
            if (!draw_edge(edge, source, chooser, sampler, pixel)) ok = false;
            canvas.store(edge.x, edge.y, 1, pixel.data());
        }
        simd::finish_stores();
    });
    return ok;
}

bool Drape::draw_edge(const EdgePixel& edge, const Source& source, const FootprintChooser& chooser,
                      PointSampler& sampler, std::vector<float>& pixel) const {
    const int channels = source.channels(), alpha = source.unassociated_alpha();
    std::fill(pixel.begin(), pixel.end(), 0.0f);
    std::vector<float> one(pixel.size());
    // What is not multiplied with its alpha yet is, before it is mixed.
    const auto mix = [&](float share) {
        if (alpha >= 0) associate_alpha(one.data(), channels, alpha);
        for (std::size_t c = 0; c < static_cast<std::size_t>(channels); ++c) pixel[c] += share * one[c];
    };
    float rest = 1;
    bool ok = true;
    for (const EdgePart& part : edge.parts) {
        Spot spot{&m_map->facets().facets[part.facet], part.u, part.v};
        weigh(spot, part.x, part.y);
        const Jacobian jacobian = m_map->jacobian_of(*spot.facet, part.x, part.y);
        const Size& size = m_map->picture();
        ok = sampler.sample(chooser(jacobian), jacobian, 0, part.u * size.width, part.v * size.height,
                            one.data()) &&
             ok;
        if (alpha >= 0) unassociate_alpha(one.data(), channels, alpha);
        if (m_options.lighting.shading != DrapeShading::none) light_pixel(spot, one.data(), channels, alpha);
        mix(static_cast<float>(part.share));
        rest -= static_cast<float>(part.share);
    }
    std::fill(one.begin(), one.end(), 0.0f);
    const std::size_t count = std::min(m_options.background.size(), static_cast<std::size_t>(channels));
    std::copy_n(m_options.background.begin(), count, one.begin());
    mix(std::max(0.0f, rest));
    if (alpha >= 0) unassociate_alpha(pixel.data(), channels, alpha);
    return ok;
}

bool Drape::draw(const Source* source, const Box& box, const ImageView& view,
                 const ParallelFor& parallel_for) const {
    if (m_options.own != DrapeOutput::shared || m_options.output != Output::color)
        return draw_values(box, view, parallel_for);
    Picture picture = m_picture;
    const int alpha = source ? source->unassociated_alpha() : -1;
    if (m_options.lighting.shading != DrapeShading::none || !m_options.background.empty())
        picture.overlay = [this, alpha](const PixelRows& rows) { finish(rows, alpha); };
    if (!picture.draw({source}, box, view, parallel_for)) return false;
    const Box inside = intersection(box, {0, 0, m_map->width(), m_map->height()});
    return m_options.filter != Filter::antialias ||
           draw_edges(*source, inside, Canvas(view, box), parallel_for);
}

}  // namespace anamorph
