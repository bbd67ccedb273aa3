// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/body/ellipsoid_distance.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>

namespace anamorph::figure {
namespace {

constexpr double kThinnest = 1e-18;  // of the longest axis

/// Turns pairs of columns of `m` until all are square to each other (one-sided Jacobi: small ones keep their
/// relative accuracy), and the columns of `v` with them.
void make_columns_square(glm::dmat3& m, glm::dmat3& v) {
    for (int sweep = 0; sweep < 40; ++sweep) {
        bool done = true;
        for (int i = 0; i < 2; ++i)
            for (int j = i + 1; j < 3; ++j) {
                const double a = glm::dot(m[i], m[i]), b = glm::dot(m[j], m[j]), c = glm::dot(m[i], m[j]);
                if (!(std::abs(c) > 1e-16 * std::sqrt(a) * std::sqrt(b))) continue;
                done = false;
                const double zeta = (b - a) / (2 * c);
                const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::hypot(1.0, zeta));
                const double cosine = 1 / std::hypot(1.0, t), sine = cosine * t;
                for (glm::dmat3* const w : {&m, &v}) {
                    const glm::dvec3 left = (*w)[i], right = (*w)[j];
                    (*w)[i] = cosine * left - sine * right;
                    (*w)[j] = sine * left + cosine * right;
                }
            }
        if (done) return;
    }
}

}  // namespace

double reach_of(const Ellipsoid& e, const glm::dvec3& direction) noexcept {
    return glm::length(e.axes * (glm::transpose(e.rotation) * direction));
}

EllipsoidContact contact_of(const Ellipsoid& first, const Ellipsoid& second) noexcept {
    EllipsoidContact contact;
    const glm::dvec3 r = second.center - first.center;
    const double largest = std::max(longest(first.axes), longest(second.axes));
    const double distance = glm::length(r);
    if (!(distance > 0) || !(largest > 0)) {
        contact.ratio = distance > 0 ? INFINITY : 0;
        if (distance > 0) contact.normal = r / distance;
        contact.gap = distance - reach_of(first, contact.normal) - reach_of(second, contact.normal);
        return contact;
    }
    // Seen where the first is a unit sphere, the second has half axes sqrt(b_k) along the columns of v.
    const glm::dvec3 a = glm::max(first.axes, glm::dvec3(kThinnest * largest));
    const glm::dvec3 b_axes = glm::max(second.axes, glm::dvec3(kThinnest * largest));
    const glm::dmat3 turned = glm::transpose(second.rotation) * first.rotation;
    glm::dmat3 m, v(1.0);
    for (int k = 0; k < 3; ++k) m[k] = b_axes * turned[k] / a[k];
    make_columns_square(m, v);
    const glm::dvec3 b(glm::dot(m[0], m[0]), glm::dot(m[1], m[1]), glm::dot(m[2], m[2]));
    const glm::dvec3 q = glm::transpose(v) * ((glm::transpose(first.rotation) * r) / a);

    // With s = l / (1 - l) the function is F = sum q_k^2 s / ((1 + s)(1 + s b_k)); its derivative has the
    // sign of sum q_k^2 (1 - s^2 b_k) / (1 + s b_k)^2, which falls. Bisection in log s.
    const double low_b = std::min({b.x, b.y, b.z}), high_b = longest(b);
    double low = -0.5 * std::log(high_b), high = -0.5 * std::log(low_b);
    for (int i = 0; i < 100 && high - low > 1e-15 * (1 + std::abs(low)); ++i) {
        const double middle = 0.5 * (low + high), s = std::exp(middle);
        double slope = 0;
        for (int k = 0; k < 3; ++k) {
            const double w = q[k] / (1 + s * b[k]);
            slope += w * w * (1 - s * s * b[k]);
        }
        if (middle <= low || middle >= high) break;
        (slope > 0 ? low : high) = middle;
    }
    const double s = std::exp(0.5 * (low + high));
    const glm::dvec3 w = q / (1.0 + s * b);
    contact.ratio = std::sqrt(s / (1 + s) * glm::dot(q, w));
    const glm::dvec3 normal = first.rotation * ((v * w) / a);
    const double length = glm::length(normal);
    contact.normal = length > 0 && std::isfinite(length) ? normal / length : r / distance;
    contact.gap =
        glm::dot(r, contact.normal) - reach_of(first, contact.normal) - reach_of(second, contact.normal);
    return contact;
}

}  // namespace anamorph::figure
