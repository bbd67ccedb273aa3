// SPDX-License-Identifier: Apache-2.0
// Antialiasing where the map minifies: which level of a pyramid to read, and how many bilinear taps where, so
// that white noise in the source comes out as strong as from an exact average over the pixel's footprint.
//
// Theory, per axis of the footprint. Interpolating linearly at a random phase leaves the energy A(0) = 2/3 of
// white noise, and two taps d texels apart correlate as A(d), the tent's autocorrelation, which is the cubic
// B-spline. The exact average of piecewise constant texels over w >= 1 texels at a random phase has energy
//     e(w) = (1 - 1 / (3 w)) / w,
// at w = 1 the bilinear filter's 2/3: the two join. A level whose texels average r base texels has r times
// less noise already, so taps on it must have energy r e(w).
#pragma once

#include <array>
#include <cmath>

#include "anamorph/image/source.h"

namespace anamorph {

/// taps_a x taps_b bilinear taps on `level`, weighted alike: tap k of n stands (k - (n - 1) / 2) * spacing
/// level texels from the centre along the level's direction of (x_i, y_i), and so along (x_j, y_j) for b.
struct Footprint {
    int level = 0;
    int taps_a = 1, taps_b = 1;
    float spacing_a = 0, spacing_b = 0;

    friend bool operator==(const Footprint&, const Footprint&) = default;
};

/// The least rectangle whose sides are along the source's own and that covers a pixel's parallelogram, as the steps of a
/// pixel to the right and down (Oka 1987, fig. 2.6): (|b11| + |b12|) x (|b21| + |b22|).
inline Jacobian covering_rectangle(const Jacobian& j) {
    return {std::fabs(j.x_i) + std::fabs(j.x_j), 0, 0, std::fabs(j.y_i) + std::fabs(j.y_j)};
}

/// The positions of the taps of a footprint.
class TapOffsets {
  public:
    /// `jacobian`: the one that the footprint was made for; `scale`: texels of its level per texel of level 0.
    TapOffsets(const Footprint& footprint, const Jacobian& jacobian,
               const std::array<double, 2>& scale) noexcept;

    /// The offset of tap (i, j), in texels of the footprint's level.
    Point<double> operator()(int i, int j) const noexcept {
        const double da = (i - 0.5 * (m_footprint.taps_a - 1)) * static_cast<double>(m_footprint.spacing_a);
        const double db = (j - 0.5 * (m_footprint.taps_b - 1)) * static_cast<double>(m_footprint.spacing_b);
        return {da * m_a.x + db * m_b.x, da * m_a.y + db * m_b.y};
    }

  private:
    Footprint m_footprint;
    Point<double> m_a, m_b;  ///< the sides' directions
};

/// Energy of white noise after an exact average over `width` >= 1 texels; below 1 as at 1.
double box_energy(double width);
/// Energy after the mean of `taps` linear interpolations `spacing` texels apart, at a random phase.
double tap_energy(int taps, double spacing);
/// The spacing, in [0, 2] texels, at which so many taps have an energy, to 1e-6 of it.
double spacing_for(int taps, double energy);

/// Chooses footprints for one source.
class FootprintChooser {
  public:
    static constexpr int kMaxTaps = 64;

    explicit FootprintChooser(const Source& source);

    /// Chooses a footprint: one bilinear tap on level 0 where the map magnifies, or is no map (not finite).
    /// At most kMaxTaps taps: a coarser level is taken instead, and on the coarsest the average is thinner
    /// than the footprint.
    Footprint operator()(const Jacobian& jacobian) const noexcept;

    /// The number of levels in use: those of the source as far as none is larger than level 0, nor more than four times
    /// coarser, either way, than the one before.
    int levels() const noexcept { return m_levels; }
    /// Texels of a level per texel of level 0, across and down.
    const std::array<double, 2>& scale(int level) const noexcept {
        return m_scale[static_cast<std::size_t>(level)];
    }

  private:
    static constexpr int kMaxLevels = 32;

    int m_levels = 1;
    std::array<std::array<double, 2>, kMaxLevels> m_scale{};
};

}  // namespace anamorph
