// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/projector.h"

#include <cmath>
#include <glm/geometric.hpp>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

std::string in_words(const glm::dvec3& v) {
    return shortest(v.x) + "," + shortest(v.y) + "," + shortest(v.z);
}

/// Throws Error unless the vector has a direction. Its length is near 1 then.
glm::dvec3 direction_of(const glm::dvec3& vector, const char* parameter) {
    const glm::dvec3 scaled = scaled_ray(vector);
    if (scaled == glm::dvec3(0.0)) throw Error(parameter, in_words(vector), "must be finite and not all 0");
    return glm::normalize(scaled);
}

/// By intervals over squares of the panorama.
double least_forward_of(const Chart& chart) {
    constexpr int kSquares = 32;
    if (chart.pieces().size() > 1) return -1;
    double least = 1;
    for (int j = 0; j < kSquares; ++j)
        for (int i = 0; i < kSquares; ++i) {
            const auto part = [](int at, int size) {
                return Interval(1.0 * size * at / kSquares, 1.0 * size * (at + 1) / kSquares);
            };
            const Ray<Interval> r =
                chart.local_ray(part(i, chart.width()), part(j, chart.height()), chart.branch());
            const Interval forward = r.z / sqrt(square(r.x) + square(r.y) + square(r.z));
            if (!(forward.lo >= least)) least = forward.lo > -1 ? forward.lo : -1;
        }
    return least;
}

/// A scene is cut where azimuths have a seam, which only those without a lens can be turned away from.
const Chart& checked(const Chart& panorama) {
    if (panorama.lens() && panorama.counted() == Counted::azimuth)
        throw Error("panorama lens", panorama.lens()->model().text(),
                    "must be none for " + std::string(name_of(panorama.projection())) + " in a scene");
    return panorama;
}

}  // namespace

glm::dvec3 scaled_ray(const glm::dvec3& ray) {
    const double most = std::max({std::fabs(ray.x), std::fabs(ray.y), std::fabs(ray.z)});
    if (!(std::isfinite(ray.x) && std::isfinite(ray.y) && std::isfinite(ray.z) && most > 0))
        return glm::dvec3(0.0);
    const int exponent = -std::ilogb(most);
    // A product with a power of two is quicker, where there is one.
    if (std::abs(exponent) < 1022) return ray * std::ldexp(1.0, exponent);
    return {std::ldexp(ray.x, exponent), std::ldexp(ray.y, exponent), std::ldexp(ray.z, exponent)};
}

glm::dmat3 frame_of(const ProjectorPose& pose) {
    const glm::dvec3& p = pose.position;
    if (!(std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)))
        throw Error("position", in_words(p), "must be finite");
    const glm::dvec3 forward = direction_of(pose.direction, "direction"), up = direction_of(pose.up, "up");
    const glm::dvec3 right = glm::cross(forward, up);
    if (!(glm::length(right) > 1e-9)) throw Error("up", in_words(pose.up), "must not be along the direction");
    const glm::dvec3 across = glm::normalize(right);
    return {across, glm::cross(forward, across), forward};
}

Projector::Projector(const Chart& panorama, const ProjectorPose& pose)
    : m_panorama(checked(panorama)),
      m_pose(pose),
      m_frame(frame_of(pose)),
      m_least_forward(least_forward_of(panorama)) {}

Received Projector::receive(const glm::dvec3& point, Point<double>& texel) const {
    const glm::dvec3 r = scaled_ray(ray(point));
    if (r == glm::dvec3(0.0)) return Received::no_direction;
    const Ray<double> direction{r.x, r.y, r.z};
    const bool on_axis = m_panorama.counted() == Counted::azimuth && r.x == 0 && r.z == 0;
    const auto unseen = on_axis ? Received::no_direction : Received::nothing;
    const int piece = m_panorama.piece_of(direction);
    const Ray<double> local = transform(glm::transpose(m_panorama.branch(piece).axes), direction);
    if (!m_panorama.pieces_see_all() && !(m_panorama.sees(local, piece) > 0)) return unseen;
    const Point<double> found = m_panorama.point(direction, piece);
    const bool inside =
        found.x >= 0 && found.x <= m_panorama.width() && found.y >= 0 && found.y <= m_panorama.height();
    if (!inside) return unseen;
    texel = found;
    return Received::texel;
}

}  // namespace anamorph
