// SPDX-License-Identifier: Apache-2.0
#include "sample.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>

#include "anamorph/error.h"

namespace anamorph::web {
namespace {

/// A colour in sRGB, 0 to 1.
struct Color {
    double r, g, b;
};
constexpr Color color(int rgb) {
    return {((rgb >> 16) & 255) / 255.0, ((rgb >> 8) & 255) / 255.0, (rgb & 255) / 255.0};
}
Color operator*(const Color& c, double k) {
    return {c.r * k, c.g * k, c.b * k};
}
Color mix(const Color& a, const Color& b, double part) {
    return {a.r + (b.r - a.r) * part, a.g + (b.g - a.g) * part, a.b + (b.b - a.b) * part};
}

double clamped(double x) {
    return std::clamp(x, 0.0, 1.0);
}
double smooth(double from, double to, double x) {
    const double t = clamped((x - from) / (to - from));
    return t * t * (3 - 2 * t);
}
/// How much of a pixel `width` wide lies beyond an edge from which its middle is `distance` away.
double covered(double distance, double width) {
    return clamped(distance / width + 0.5);
}

struct Direction {
    double cos, sin;
};

/// The direction of k parts of 2^bits of a turn: a product of directions of halves of halves of a turn.
Direction direction(int k, int bits) {
    Direction product{1, 0}, part{-1, 0};
    for (int bit = bits - 1; bit >= 0; --bit) {
        if ((k >> bit) & 1)
            product = {product.cos * part.cos - product.sin * part.sin,
                       product.cos * part.sin + product.sin * part.cos};
        if (bit == bits - 1) {
            part = {0, 1};
        } else {
            const double half = std::sqrt((1 + part.cos) / 2);
            part = {half, part.sin / (2 * half)};
        }
    }
    return product;
}

/// Random values of whole numbers, 0 to 1.
double lattice(std::int64_t x, std::int64_t y) {
    std::uint32_t n =
        static_cast<std::uint32_t>(x) * 0x9e3779b1u ^ static_cast<std::uint32_t>(y) * 0x85ebca77u;
    n = (n ^ (n >> 15)) * 0x2c1b3c6du;
    n = (n ^ (n >> 12)) * 0x297a2d39u;
    return static_cast<double>((n ^ (n >> 15)) >> 8) * 0x1p-24;
}
double noise(double x, double y) {
    const double fx = std::floor(x), fy = std::floor(y);
    const double s = smooth(0, 1, x - fx), t = smooth(0, 1, y - fy);
    const auto i = static_cast<std::int64_t>(fx), j = static_cast<std::int64_t>(fy);
    const double upper = lattice(i, j) + (lattice(i + 1, j) - lattice(i, j)) * s;
    const double lower = lattice(i, j + 1) + (lattice(i + 1, j + 1) - lattice(i, j + 1)) * s;
    return upper + (lower - upper) * t;
}
/// Noise of several octaves, 0 to 1.
double clouds(double x, double y, int octaves) {
    double sum = 0, weight = 0.5;
    for (int i = 0; i < octaves; ++i, weight /= 2) {
        sum += weight * noise(x, y);
        const double turned = 1.6 * x - 1.2 * y;
        y = 1.2 * x + 1.6 * y + 7.3;
        x = turned + 3.1;
    }
    return sum / (1 - 2 * weight);
}

/// The mean over [x - width / 2, x + width / 2] of what is 1 in even whole numbers' units and -1 in odd ones.
double squares(double x, double width) {
    const auto area = [](double at) {
        const double m = at - 2 * std::floor(at / 2);
        return std::min(m, 2 - m);
    };
    return (area(x + width / 2) - area(x - width / 2)) / width;
}

// The scene, in metres: the eye over a floor, columns in a ring about it, beams on them, hills and the sky behind.
constexpr double kEye = 1.6, kRing = 6, kRadius = 0.36, kHigh = 4.2, kBeam = 0.75, kDeep = 0.42;
constexpr int kColumnBits = 4, kColumns = 1 << kColumnBits;
constexpr Color kZenith = color(0x17255c), kMiddle = color(0x4a5fa8), kLow = color(0xd98f9a),
                kHorizon = color(0xffc78f), kSun = color(0xfff3d0), kCloud = color(0xf3b6b0);
constexpr std::array<Color, 3> kHills = {color(0x9a7fa6), color(0x6d5c90), color(0x443c6b)};
constexpr Color kPale = color(0xe9dcc6), kSlate = color(0x5d6478), kClay = color(0xb5533c),
                kInk = color(0x243056), kIvory = color(0xf6ecd9), kBlue = color(0x2f6f9f),
                kGold = color(0xd8a545);

/// What a column of pixels has in common.
struct Bearing {
    Direction to{};
    std::array<double, 3> hills{};  ///< slopes at which they end
    double aside = 0,
           ahead =
               0;  ///< of the nearest column's axis: across the line of sight and along, for the distance 1
    double dentil = 0;
};

class Scene {
  public:
    explicit Scene(int height)
        : m_bits(std::countr_zero(static_cast<unsigned>(height)) + 1),
          m_step(3.14159265358979311600 / height) {
        const Direction sun = direction(1, 3);
        m_sun = {sun.sin * 0.97, 0.243, sun.cos * 0.97};
        for (int i = 0; i < kColumns; ++i)
            m_columns[static_cast<std::size_t>(i)] = direction(2 * i + 1, kColumnBits + 1);
    }

    /// Of the pixels x; the middle of the picture looks along z, its right half to x.
    Bearing bearing(int x) const {
        Bearing b;
        const Direction d = direction(2 * x + 1, m_bits + 1);
        b.to = {-d.cos, -d.sin};
        for (std::size_t k = 0; k < kHills.size(); ++k) {
            const double scale = 3.0 + 2.5 * static_cast<double>(k);
            const double rough =
                clouds(b.to.cos * scale + 31.7 * static_cast<double>(k), b.to.sin * scale + 5, 6);
            b.hills[k] = 0.30 - 0.075 * static_cast<double>(k) + 0.34 * (rough - 0.55);
        }
        b.ahead = -1;
        for (const Direction& column : m_columns) {
            const double ahead = b.to.cos * column.cos + b.to.sin * column.sin;
            if (ahead <= b.ahead) continue;
            b.ahead = ahead;
            b.aside = b.to.sin * column.cos - b.to.cos * column.sin;
        }
        b.dentil = squares((2 * x + 1) * 96.0 / (1 << (m_bits + 1)) * 2, 96.0 * 2 / (1 << m_bits));
        return b;
    }

    Color at(const Bearing& b, const Direction& elevation) const {
        const double slope = elevation.sin / elevation.cos;
        // What of it a pixel covers.
        const double rise = m_step * (1 + slope * slope);
        Color c = slope > -0.05 ? sky(b, elevation) : kHorizon;
        for (std::size_t k = 0; k < kHills.size(); ++k)
            c = mix(c, mix(kHills[k], kHorizon, 0.35 * smooth(0.25, -0.02, slope)),
                    covered(b.hills[k] - slope, rise));
        c = mix(c, floor(b, std::min(slope, -1e-3)), covered(-slope - 0.02, rise));
        c = beam(c, b, slope, rise);
        return column(c, b, slope, rise);
    }

  private:
    Color sky(const Bearing& b, const Direction& elevation) const {
        const double up = elevation.sin;
        Color c = mix(kHorizon, kLow, smooth(0, 0.22, up));
        c = mix(c, kMiddle, smooth(0.1, 0.5, up));
        c = mix(c, kZenith, smooth(0.35, 1, up));
        const double x = b.to.sin * elevation.cos, z = b.to.cos * elevation.cos;
        const double toward = x * m_sun[0] + up * m_sun[1] + z * m_sun[2];
        double glow = std::max(0.0, toward);
        for (int i = 0; i < 3; ++i) glow *= glow;
        c = mix(c, kHorizon, 0.55 * glow);
        for (int i = 0; i < 3; ++i) glow *= glow;
        c = mix(c, kSun, 0.8 * glow);
        if (up > 0.01) {
            const double far = 1 / (up + 0.12);
            const double thick = smooth(0.5, 0.72, clouds(x * far * 1.7 + 11, z * far * 1.7 - 4, 5));
            c = mix(c, mix(kCloud, kIvory, 0.6 * std::max(0.0, toward)),
                    0.75 * thick * smooth(0.02, 0.2, up));
        }
        // Twice 1 - cos of an angle is nearly its square.
        constexpr double kDisc = 0.035;
        return mix(c, kSun, covered(kDisc - 2 * (1 - toward) / kDisc, 2 * m_step));
    }

    Color floor(const Bearing& b, double slope) const {
        const double away = kEye / -slope;
        const double along = std::max(m_step * (away * away + kEye * kEye) / kEye, 1e-6),
                     across = std::max(m_step * away, 1e-6);
        const double x = b.to.sin * away, z = b.to.cos * away;
        const double wide_x = std::fabs(b.to.sin) * along + std::fabs(b.to.cos) * across,
                     wide_z = std::fabs(b.to.cos) * along + std::fabs(b.to.sin) * across;
        const double checker = squares(x, wide_x) * squares(z, wide_z);
        const double worn = 0.9 + 0.2 * noise(x * 2.3 + 50, z * 2.3 + 50) * smooth(14, 4, away);
        Color c = mix(kSlate, kPale, 0.5 + 0.5 * checker) * worn;
        const auto ring = [&](double from, double to, const Color& paint) {
            c = mix(c, paint, covered(away - from, along) * covered(to - away, along));
        };
        ring(0, 0.9, kInk);
        ring(0.9, 1.0, kGold);
        ring(2.6, 2.95, kClay);
        ring(2.95, 3.02, kIvory);
        ring(kRing - 0.8, kRing + 0.8, kIvory * 0.93);
        // The columns' shade at their feet.
        const double feet_x = kRing * b.ahead - away, feet_z = kRing * b.aside;
        c = c *
            (0.62 + 0.38 * smooth(kRadius * 0.8, kRadius * 3, std::sqrt(feet_x * feet_x + feet_z * feet_z)));
        return mix(c, kHorizon, 0.7 * smooth(8, 60, away));
    }

    /// The beams: their lower side, and their front with dentils.
    Color beam(Color c, const Bearing& b, double slope, double rise) const {
        const double front = kRing - kDeep, back = kRing + kDeep;
        const double high = slope * front + kEye - kHigh, low = slope * back + kEye - kHigh;
        c = mix(c, kInk, covered(low, rise * back) * covered(-high, rise * front));
        Color face =
            mix(kIvory, kClay, covered(high - 0.08, rise * front) * covered(0.14 - high, rise * front));
        const double teeth = covered(high - 0.24, rise * front) * covered(0.40 - high, rise * front);
        face = mix(face, mix(kIvory, kSlate, 0.5 - 0.5 * b.dentil), teeth);
        face = mix(face, kGold, covered(high - 0.62, rise * front));
        const double lit = 0.78 + 0.22 * (b.to.sin * -m_sun[0] + b.to.cos * -m_sun[2]);
        return mix(c, face * lit, covered(high, rise * front) * covered(kBeam - high, rise * front));
    }

    Color column(const Color& behind, const Bearing& b, double slope, double rise) const {
        // Wider at its foot and under the beam.
        const double axis_high = kEye + slope * kRing;
        const bool is_broad = axis_high < 0.22 || axis_high > kHigh - 0.26;
        const double radius = is_broad ? kRadius * 1.3 : kRadius;
        const double q = kRing * b.aside / radius, edge = m_step * kRing / radius;
        if (std::fabs(q) > 1 + edge) return behind;
        const double bulge = std::sqrt(std::max(0.0, 1 - q * q));
        const double away = kRing * b.ahead - radius * bulge, high = kEye + slope * away;
        const double wide = rise * away;
        Color c = mix(kIvory, kClay, covered(high - 0.5, wide) * covered(1.15 - high, wide));
        c = mix(c, kGold, covered(high - 1.15, wide) * covered(1.22 - high, wide));
        c = mix(c, kBlue, covered(high - 3.35, wide) * covered(3.6 - high, wide));
        c = mix(c, kGold, covered(high - 3.6, wide) * covered(3.66 - high, wide));
        if (is_broad) c = kIvory * 0.96;
        // Light from the sun's side, and from the floor.
        const double normal_x = -b.to.sin * bulge + b.to.cos * q, normal_z = -b.to.cos * bulge - b.to.sin * q;
        const double sun = std::max(0.0, normal_x * m_sun[0] + normal_z * m_sun[2]);
        c = mix(c * (0.5 + 0.16 * bulge), mix(c, kSun, 0.18), 0.9 * sun);
        return mix(behind, c,
                   covered((1 - std::fabs(q)) * radius, m_step * kRing) * covered(high, wide) *
                       covered(kHigh - high, wide));
    }

    int m_bits;     ///< the picture is 2^m_bits pixels wide
    double m_step;  ///< angle between pixels
    std::array<double, 3> m_sun{};
    std::array<Direction, kColumns> m_columns{};
};

std::uint8_t byte(double value) {
    return static_cast<std::uint8_t>(clamped(value) * 255 + 0.5);
}

}  // namespace

std::vector<std::uint8_t> sample_panorama(int height) {
    if (height < 16 || height > 8192 || !std::has_single_bit(static_cast<unsigned>(height)))
        throw Error("height", std::to_string(height), "must be a power of 2 from 16 to 8192");
    const Scene scene(height);
    const int width = 2 * height, bits = std::countr_zero(static_cast<unsigned>(width));
    std::vector<Bearing> bearings;
    for (int x = 0; x < width; ++x) bearings.push_back(scene.bearing(x));
    std::vector<std::uint8_t> rgba;
    rgba.reserve(std::size_t{4} * static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
    for (int y = 0; y < height; ++y) {
        // From a quarter of a turn up to a quarter down.
        const Direction down = direction(2 * y + 1, bits + 1);
        const Direction elevation{down.sin, down.cos};
        for (const Bearing& b : bearings) {
            const Color c = scene.at(b, elevation);
            rgba.insert(rgba.end(), {byte(c.r), byte(c.g), byte(c.b), 255});
        }
    }
    return rgba;
}

}  // namespace anamorph::web
