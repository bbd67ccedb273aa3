// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/body/displacement.h"

#include <cmath>
#include <numbers>

#include "anamorph/figure/body/figure_rows.h"

namespace anamorph::figure {
namespace {

/// sqrt(2 / pi), of the density sqrt(2 / pi) r^2 exp(-r^2 / 2) of distances from the centre.
const double kDensity = std::sqrt(2 / std::numbers::pi);

/// The probability of a distance below s, the density's integral; below 1 by its series, where the closed form cancels.
double probability_within(double s) {
    if (s >= 1) return std::erf(s / std::numbers::sqrt2) - kDensity * s * std::exp(-s * s / 2);
    double sum = 0, power = s * s * s;
    for (int n = 0; n < 20; ++n) {
        sum += power / (2 * n + 3);
        power *= -s * s / (2 * (n + 1));
    }
    return kDensity * sum;
}

/// That of a greater one, of which no digits are lost where it is small.
double probability_beyond(double s) {
    return std::erfc(s / std::numbers::sqrt2) + kDensity * s * std::exp(-s * s / 2);
}

}  // namespace

double displacement_scale(double probability) {
    kProbabilityRow.check(probability, "probability");
    if (probability == 0.5) return kHalfProbability;
    // Both are monotone: halve until nothing is between. Beyond 40 no double's probability is left.
    double below = 0, above = 40;
    for (;;) {
        const double middle = below + (above - below) / 2;
        if (!(middle > below && middle < above)) return middle;
        const bool small = probability < 0.5 ? probability_within(middle) < probability
                                             : probability_beyond(middle) > 1 - probability;
        (small ? below : above) = middle;
    }
}

}  // namespace anamorph::figure
