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
                // A zeta whose square overflows turns by nothing; t is at most 1.
                const double t = std::copysign(1.0, zeta) / (std::abs(zeta) + std::sqrt(1 + zeta * zeta));
                const double cosine = 1 / std::sqrt(1 + t * t), sine = cosine * t;
                for (glm::dmat3* const w : {&m, &v}) {
                    const glm::dvec3 left = (*w)[i], right = (*w)[j];
                    (*w)[i] = cosine * left - sine * right;
                    (*w)[j] = sine * left + cosine * right;
                }
            }
        if (done) return;
    }
}

/// The value at s of the sum of q_k^2 (1 - s^2 b_k) / (1 + s b_k)^2, which falls as s rises.
struct FallingSum {
    double value = 0;
    double decline = 0;  ///< -s times the derivative, which is -2 (1 + s) sum q_k^2 b_k / (1 + s b_k)^3
    double noise = 0;    ///< how far rounding may have put `value` off

    FallingSum(const glm::dvec3& q, const glm::dvec3& b, double s) {
        double size = 0;
        for (int k = 0; k < 3; ++k) {
            const double divisor = 1 + s * b[k], w = q[k] / divisor, square = w * w, loss = s * s * b[k];
            value += square * (1 - loss);
            size += square * (1 + loss);
            decline += square * b[k] / divisor;
        }
        decline *= 2 * s * (1 + s);
        // Terms have 12 roundings at most: two of the divisor, each twice as w is squared, so the division, one of the square,
        // three of 1 - loss, one of the product; sums two. 16 of 2^-53 hold the products of these, and the size's own rounding.
        noise = 0x1p-49 * size;
    }
};

/// Where the falling sum is zero: at the least s no term is negative, at the greatest none positive. Newton's method in log s, which
/// halves its steps, or else the bracket is halved. In log s the derivative's own, term by term, is within 2 of it either
/// way: 1 + s / (1 + s) - 3 s b / (1 + s b). So what a step e leaves is at most e^2 exp(2 e).
double zero_of_falling_sum(const glm::dvec3& q, const glm::dvec3& b) {
    constexpr int kMostSteps = 200;
    constexpr double kLastStep = 0x1p-27;
    double low = 1 / std::sqrt(longest(b)), high = 1 / std::sqrt(std::min({b.x, b.y, b.z}));
    double s = std::sqrt(low) * std::sqrt(high), last = 2;
    for (int i = 0; i < kMostSteps && high > low * (1 + 1e-15); ++i) {
        const FallingSum sum(q, b, s);
        const double step = sum.value / sum.decline;
        // exp(step), but for the cube of the step.
        const double next = s * ((2 + step) / (2 - step));
        const bool inside = next >= low && next <= high;
        if (!(std::abs(sum.value) > sum.noise) || (inside && std::abs(step) <= kLastStep))
            return inside ? next : s;
        (sum.value > 0 ? low : high) = s;
        const bool converges = inside && std::abs(step) <= 0.5 * last;
        last = converges ? std::abs(step) : 2;
        s = converges ? next : std::sqrt(low) * std::sqrt(high);
    }
    return s;
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
    // sign of sum q_k^2 (1 - s^2 b_k) / (1 + s b_k)^2, which falls.
    const double s = zero_of_falling_sum(q, b);
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
