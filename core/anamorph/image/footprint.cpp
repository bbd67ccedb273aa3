// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/footprint.h"

#include <algorithm>
#include <cmath>

#include "anamorph/number/hypot.h"

namespace anamorph {
namespace {

/// Autocorrelation of the tent: the cubic B-spline.
double tent_correlation(double d) {
    d = std::fabs(d);
    if (d >= 2) return 0;
    const double rest = 2 - d;
    return d <= 1 ? 2.0 / 3 + d * d * (0.5 * d - 1) : rest * rest * rest / 6;
}

/// Fewest taps whose energy can be as low as `energy`; many are as good as very many.
int taps_for(double energy) {
    const double taps = tent_correlation(0) / energy * (1 - 1e-12);
    return taps < 1e6 ? std::max(1, static_cast<int>(std::ceil(taps))) : 1'000'000;
}

/// The derivative of tent_correlation, of d >= 0.
double tent_correlation_slope(double d) {
    if (d >= 2) return 0;
    return d <= 1 ? d * (1.5 * d - 2) : -0.5 * (2 - d) * (2 - d);
}

/// The derivative of tap_energy by the spacing.
double tap_energy_slope(int taps, double spacing) {
    double sum = 0;
    for (int apart = 1; apart < taps && apart * spacing < 2; ++apart)
        sum += 2.0 * (taps - apart) * apart * tent_correlation_slope(apart * spacing);
    return sum / taps / taps;
}

/// One side of the footprint on a level: its length in texels and the energy its taps must have.
struct Side {
    double texels, energy;
    int taps;

    Side(double x, double y, const std::array<double, 2>& scale)
        : texels(hypot(x * scale[0], y * scale[1])),
          energy(texels > 0 ? hypot(x, y) / texels * box_energy(hypot(x, y)) : 1),
          taps(taps_for(energy)) {}
    /// Fewer taps than the energy asks for are spread evenly over the side.
    double spacing(int used) const { return used < taps ? texels / used : spacing_for(taps, energy); }
};

/// The smaller singular value.
double least_stretch(const Jacobian& j) {
    // Half the sum and half the difference of the singular values.
    const double sum = 0.5 * hypot(j.x_i + j.y_j, j.y_i - j.x_j);
    const double difference = 0.5 * hypot(j.x_i - j.y_j, j.y_i + j.x_j);
    return std::fabs(sum - difference);
}

/// The unit vector along (x, y), or none.
Point<double> direction(double x, double y) {
    const double length = hypot(x, y);
    return length > 0 ? Point<double>{x / length, y / length} : Point<double>{0, 0};
}

}  // namespace

TapOffsets::TapOffsets(const Footprint& footprint, const Jacobian& jacobian,
                       const std::array<double, 2>& scale) noexcept
    : m_footprint(footprint),
      m_a(direction(jacobian.x_i * scale[0], jacobian.y_i * scale[1])),
      m_b(direction(jacobian.x_j * scale[0], jacobian.y_j * scale[1])) {}

double box_energy(double width) {
    const double w = std::max(width, 1.0);
    return (1 - 1 / (3 * w)) / w;
}

double tap_energy(int taps, double spacing) {
    double sum = taps * tent_correlation(0);
    for (int apart = 1; apart < taps && apart * spacing < 2; ++apart)
        sum += 2 * (taps - apart) * tent_correlation(apart * spacing);
    return sum / taps / taps;
}

// The energy falls from 2/3 to 2/3 over `taps` as they part: Newton's iteration, kept between the nearest and the farthest that the
// spacing may be.
double spacing_for(int taps, double energy) {
    if (taps == 1) return 0;
    // Of two taps d^2 (1 - d / 2) is 4/3 - 2 energy up to d = 1; many are like a box, whose energy is box_energy.
    const double root = std::sqrt(std::max(0.0, 4.0 / 3 - 2 * energy));
    const double box = (1 + std::sqrt(std::max(0.0, 1 - 4 * energy / 3))) / (2 * energy);
    double spacing = taps == 2 ? root * (1 + 0.25 * root + 0.3 * root * root) : box / taps;
    double near = 0, far = 2;
    // To 1e-6 of energy, which is less than 1e-4 texels wherever taps are farther apart than that.
    for (int i = 0; i < 40; ++i) {
        spacing = spacing > near && spacing < far ? spacing : 0.5 * (near + far);
        const double off = tap_energy(taps, spacing) - energy;
        if (std::fabs(off) <= 1e-6) break;
        (off > 0 ? near : far) = spacing;
        spacing -= off / tap_energy_slope(taps, spacing);
    }
    return spacing;
}

FootprintChooser::FootprintChooser(const Source& source)
    : m_levels(std::clamp(source.levels(), 1, kMaxLevels)) {
    const Size full = source.size(0);
    Size finer = full;
    for (int level = 0; level < m_levels; ++level) {
        const Size size = source.size(level);
        // No coarser copy, or one more than four times coarser either way than the one before, which what is
        // culled relies on: it and those behind it are left alone.
        const bool larger = size.width > full.width || size.height > full.height;
        const bool far_coarser =
            std::int64_t{4} * size.width < finer.width || std::int64_t{4} * size.height < finer.height;
        if (larger || far_coarser) {
            m_levels = level;
            break;
        }
        finer = size;
        m_scale[static_cast<std::size_t>(level)] = {static_cast<double>(size.width) / full.width,
                                                    static_cast<double>(size.height) / full.height};
    }
}

Footprint FootprintChooser::operator()(const Jacobian& j) const noexcept {
    const double largest = std::max({std::fabs(j.x_i), std::fabs(j.y_i), std::fabs(j.x_j), std::fabs(j.y_j)});
    if (!(std::isfinite(j.x_i + j.y_i + j.x_j + j.y_j) && largest < 1e150)) return {};

    // The finest level on which two taps across the footprint's narrow side are enough...
    const double narrow = box_energy(least_stretch(j));
    const auto enough = [&](int level) {
        const auto [sx, sy] = scale(level);
        return narrow >= std::sqrt(sx * sy) / 3;
    };
    int level = 0;
    while (level + 1 < m_levels && !enough(level)) ++level;

    // ... and its long side needs not too many.
    for (;; ++level) {
        const Side a(j.x_i, j.y_i, scale(level)), b(j.x_j, j.y_j, scale(level));
        int taps_a = a.taps, taps_b = b.taps;
        if (std::int64_t{taps_a} * taps_b > kMaxTaps) {
            if (level + 1 < m_levels) continue;
            const double share =
                std::sqrt(static_cast<double>(kMaxTaps) / (static_cast<double>(taps_a) * taps_b));
            taps_a = std::clamp(static_cast<int>(taps_a * share), 1, kMaxTaps);
            taps_b = std::min(taps_b, kMaxTaps / taps_a);
            taps_a = std::min(a.taps, kMaxTaps / taps_b);
        }
        return {level, taps_a, taps_b, static_cast<float>(a.spacing(taps_a)),
                static_cast<float>(b.spacing(taps_b))};
    }
}

}  // namespace anamorph
