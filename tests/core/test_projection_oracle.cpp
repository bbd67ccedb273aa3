// SPDX-License-Identifier: Apache-2.0
// Projections against their closed formulas in long double, both ways, written in polar angles, azimuths and
// elevations where the product computes with components of rays.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "anamorph/chart/chart.h"
#include "anamorph/panorama/panorama_plan.h"
#include "panorama_oracle.h"

namespace anamorph::test_projection_oracle {
namespace {

using Real = long double;
constexpr Real kPi = std::numbers::pi_v<Real>;
constexpr Real kDegree = kPi / 180;
constexpr double kTolerance = 2e-12;

struct Vector {
    Real x, y, z;
};
struct Plane {
    Real x, y;
};

constexpr Plane kNoPoint{NAN, NAN};
constexpr Vector kNoRay{NAN, NAN, NAN};

Vector unit(const Vector& v) {
    const Real n = std::sqrt(v.x * v.x + v.y * v.y + v.z * v.z);
    return {v.x / n, v.y / n, v.z / n};
}
Vector of_angles(Real azimuth, Real elevation) {
    return {std::sin(azimuth) * std::cos(elevation), std::sin(elevation),
            std::cos(azimuth) * std::cos(elevation)};
}
Real azimuth_of(const Vector& v) {
    return std::atan2(v.x, v.z);
}
Real elevation_of(const Vector& v) {
    return std::atan2(v.y, std::hypot(v.x, v.z));
}
/// From the axis of sight.
Vector of_polar(Real t, Real around) {
    return {std::sin(t) * std::cos(around), std::sin(t) * std::sin(around), std::cos(t)};
}
Real polar_of(const Vector& v) {
    return std::atan2(std::hypot(v.x, v.y), v.z);
}
Plane turned(Real radius, const Vector& v) {
    const Real around = std::atan2(v.y, v.x);
    return {radius * std::cos(around), radius * std::sin(around)};
}

/// A projection of one picture or of faces n x n pixels large, by its formulas in a plane that a face, or a
/// whole picture without faces, fills from -half to half across.
class Oracle {
  public:
    explicit Oracle(const Chart& chart)
        : m_projection(chart.projection()),
          m_width(chart.width()),
          m_height(chart.height()),
          m_d(chart.distance().d),
          m_e(chart.distance().e),
          m_spans(m_width - (chart.spacing() == PixelSpacing::centers ? 1 : 0)) {
        const Real h = static_cast<Real>(chart.fov()) / 2 * kDegree;
        switch (m_projection) {
            case Projection::pannini:
            case Projection::unified:
                m_half = (m_d + 1) * std::sin(h) / (m_d + std::cos(h));
                break;
            case Projection::eucm:
            case Projection::double_sphere:
                m_half = of_sphere(h);
                m_end = sphere_end();
                break;
            case Projection::orthographic:
                m_half = std::sin(h);
                break;
            case Projection::equisolid:
            case Projection::mirror_ball:
                m_half = 2 * std::sin(h / 2);
                break;
            case Projection::hammer:
                m_half = 4 * std::sin(h / 4);
                break;
            case Projection::eac:
            case Projection::octahedral:
                m_half = 1;
                break;
            default:
                m_half = h;
        }
    }

    /// Not a number outside of the picture's rim.
    Vector ray(Real x, Real y) const {
        switch (m_projection) {
            case Projection::eac: {
                const Real side = m_width / Real(3), down = m_height / Real(2);
                const int column = static_cast<int>(x / side), row = static_cast<int>(y / down);
                const Real u = (x / side - column - 0.5L) * kPi / 2, v = (y / down - row - 0.5L) * kPi / 2;
                // On a face tan u, tan v, 1: an elevation of tan v cos u, at the face's azimuth and u.
                const Vector upper =
                    of_angles((column - 1) * kPi / 2 + u, std::atan(std::tan(v) * std::cos(u)));
                return row == 0 ? upper : lower_row(upper);
            }
            case Projection::dual_fisheye: {
                const Real side = m_width / Real(2);
                const bool front = x >= side;
                const Real px = (x / side - front - 0.5L) * 2 * m_half, py = (y / side - 0.5L) * 2 * m_half;
                const Real r = std::hypot(px, py);
                if (r > std::min(m_half, kPi)) return kNoRay;
                const Vector v = of_polar(r, std::atan2(py, px));
                return front ? v : Vector{-v.x, v.y, -v.z};
            }
            case Projection::dual_fisheye_tb: {
                const bool front = y < m_width;
                const Real px = (x / m_width - 0.5L) * 2 * m_half,
                           py = (y / m_width - !front - 0.5L) * 2 * m_half;
                const Real r = std::hypot(px, py);
                if (r > std::min(m_half, kPi)) return kNoRay;
                const Vector v = of_polar(r, std::atan2(py, px));
                return front ? v : Vector{-v.x, v.y, -v.z};
            }
            default:
                break;
        }
        const Real scale = m_spans / (2 * m_half);
        return of_plane((x - m_width / Real(2)) / scale, (y - m_height / Real(2)) / scale);
    }

    /// Not a number where a ray is not seen.
    Plane point(const Vector& v) const {
        switch (m_projection) {
            case Projection::eac: {
                const Real side = m_width / Real(3), down = m_height / Real(2), eighth = kPi / 4;
                const bool level = std::fabs(v.y) <= std::max(std::fabs(v.x), std::fabs(v.z)) &&
                                   !(v.z < 0 && -v.z >= std::fabs(v.x));
                const Vector w = level ? v : lower_row(v);
                const int column = azimuth_of(w) < -eighth ? 0 : azimuth_of(w) > eighth ? 2 : 1;
                const Real u = azimuth_of(w) - (column - 1) * kPi / 2;
                const Real e = std::atan(std::tan(elevation_of(w)) / std::cos(u));
                return {(column + 0.5L + u / (2 * eighth)) * side,
                        ((level ? 0 : 1) + 0.5L + e / (2 * eighth)) * down};
            }
            case Projection::dual_fisheye: {
                const Real side = m_width / Real(2);
                const bool front = v.z > 0;
                const Vector w = front ? v : Vector{-v.x, v.y, -v.z};
                if (polar_of(w) > m_half) return kNoPoint;
                const Plane p = turned(polar_of(w), w);
                return {(front + 0.5L + p.x / (2 * m_half)) * side, (0.5L + p.y / (2 * m_half)) * side};
            }
            case Projection::dual_fisheye_tb: {
                const bool front = v.z > 0;
                const Vector w = front ? v : Vector{-v.x, v.y, -v.z};
                if (polar_of(w) > m_half) return kNoPoint;
                const Plane p = turned(polar_of(w), w);
                return {(0.5L + p.x / (2 * m_half)) * m_width,
                        (!front + 0.5L + p.y / (2 * m_half)) * m_width};
            }
            default:
                break;
        }
        const Plane p = in_plane(v);
        const Real scale = m_spans / (2 * m_half);
        return {p.x * scale + m_width / Real(2), p.y * scale + m_height / Real(2)};
    }

  private:
    /// eac: what goes on from below over behind to above stands as the upper row does from left to right; its
    /// own inverse.
    static Vector lower_row(const Vector& v) { return {-v.y, -v.x, -v.z}; }

    Vector of_plane(Real x, Real y) const {
        const Real r = std::hypot(x, y), around = std::atan2(y, x);
        switch (m_projection) {
            case Projection::orthographic:
                return r > 1 ? kNoRay : of_polar(std::asin(r), around);
            case Projection::equisolid:
                return r > 2 ? kNoRay : of_polar(2 * std::asin(r / 2), around);
            case Projection::mirror_ball:
                return r > 2 ? kNoRay : reflected(r / 2, around);
            case Projection::unified: {
                const Real t = pannini_azimuth(r);
                return r > edge_of_sphere() ? kNoRay : of_polar(t, around);
            }
            case Projection::eucm:
            case Projection::double_sphere: {
                Real edge;
                const Real t = sphere_angle(r, edge);
                return r > edge ? kNoRay : of_polar(t, around);
            }
            case Projection::sinusoidal:
                if (std::fabs(y) > kPi / 2 || std::fabs(x) > m_half * std::cos(y)) return kNoRay;
                return of_angles(x / std::cos(y), y);
            case Projection::hammer: {
                // Snyder (1987), p. 182, from the plane as it is published: sqrt(2) high each way.
                const Real square = 1 - x * x / 16 - y * y / 4;
                if (square < 0.5L) return kNoRay;
                const Real z = std::sqrt(square);
                return of_angles(2 * std::atan2(z * x, 2 * (2 * square - 1)), std::asin(z * y));
            }
            case Projection::pannini: {
                const Real azimuth = pannini_azimuth(x);
                return of_angles(azimuth, std::atan(y * (m_d + std::cos(azimuth)) / (m_d + 1)));
            }
            case Projection::octahedral: {
                // The side of the picture that a corner is folded over.
                const Real u = 2 * x / (2 * m_half), v = 2 * y / (2 * m_half),
                           z = 1 - std::fabs(u) - std::fabs(v);
                return unit(z >= 0 ? Vector{u, v, z}
                                   : Vector{std::copysign(1 - std::fabs(v), u),
                                            std::copysign(1 - std::fabs(u), v), z});
            }
            default:
                return kNoRay;
        }
    }

    Plane in_plane(const Vector& v) const {
        const Real a = azimuth_of(v), e = elevation_of(v), t = polar_of(v);
        switch (m_projection) {
            case Projection::orthographic:
                return t > kPi / 2 ? kNoPoint : turned(std::sin(t), v);
            case Projection::equisolid:
                return turned(2 * std::sin(t / 2), v);
            case Projection::mirror_ball: {
                // The normal of the ball is halfway between the ray and the way back to the camera.
                const Vector n = unit({v.x, v.y, v.z - 1});
                return {2 * n.x, 2 * n.y};
            }
            case Projection::unified:
                return t >= pannini_end() ? kNoPoint
                                          : turned((m_d + 1) * std::sin(t) / (m_d + std::cos(t)), v);
            case Projection::eucm:
            case Projection::double_sphere:
                return t >= m_end ? kNoPoint : turned(of_sphere(t), v);
            case Projection::sinusoidal:
                return {a * std::cos(e), e};
            case Projection::hammer: {
                const Real k = std::sqrt(1 + std::cos(e) * std::cos(a / 2)), root = std::sqrt(2.0L);
                return {2 * root * std::cos(e) * std::sin(a / 2) / k, root * std::sin(e) / k};
            }
            case Projection::pannini: {
                if (std::fabs(a) >= pannini_end()) return kNoPoint;
                const Real s = (m_d + 1) / (m_d + std::cos(a));
                return {s * std::sin(a), s * std::tan(e)};
            }
            case Projection::octahedral: {
                const Real n = std::fabs(v.x) + std::fabs(v.y) + std::fabs(v.z), x = v.x / n, y = v.y / n;
                if (v.z >= 0) return {x * m_half, y * m_half};
                return {std::copysign(1 - std::fabs(y), x) * m_half,
                        std::copysign(1 - std::fabs(x), y) * m_half};
            }
            default:
                return kNoPoint;
        }
    }

    /// What a camera that looks along z sees in a ball of radius 1, at this distance from its middle.
    static Vector reflected(Real r, Real around) {
        const Real x = r * std::cos(around), y = r * std::sin(around), z = -std::sqrt(1 - r * r);
        // d - 2 (d . n) n, with d = (0, 0, 1).
        return {-2 * z * x, -2 * z * y, 1 - 2 * z * z};
    }
    /// The radius of an angle from the axis, by the definitions of Khomutenko 2016 and Usenko 2018 with alpha = e.
    Real of_sphere(Real t) const {
        const Real s = std::sin(t), c = std::cos(t);
        if (m_projection == Projection::eucm)
            return s / (m_e * std::sqrt(m_d * s * s + c * c) + (1 - m_e) * c);
        const Real w = m_d + c;
        return (1 + m_d) * s / (m_e * std::hypot(s, w) + (1 - m_e) * w);
    }
    /// Where the radius turns round, or has no end: by steps, then halving.
    Real sphere_end() const {
        const auto rises = [&](Real t) {
            const Real h = 1e-9L, before = of_sphere(t - h), after = of_sphere(t + h);
            return before < after && before >= 0;
        };
        Real low = 1e-3L, step = kPi / 4096;
        while (low + step < kPi && rises(low + step)) low += step;
        Real high = std::min(low + step, kPi);
        for (int i = 0; i < 60; ++i) {
            const Real middle = (low + high) / 2;
            (rises(middle) ? low : high) = middle;
        }
        return low;
    }
    /// By halving; `edge`: the largest radius.
    Real sphere_angle(Real r, Real& edge) const {
        Real low = 0, high = m_end;
        edge = of_sphere(high);
        if (m_e <= 0.5L) edge = HUGE_VALL;
        for (int i = 0; i < 80; ++i) {
            const Real middle = (low + high) / 2;
            (of_sphere(middle) < r ? low : high) = middle;
        }
        return (low + high) / 2;
    }
    /// The largest radius of the unified model: where the sphere's far side begins.
    Real edge_of_sphere() const { return m_d > 1 ? (m_d + 1) / std::sqrt(m_d * m_d - 1) : HUGE_VALL; }

    /// Where X turns round, or has no end.
    Real pannini_end() const { return std::acos(-(m_d > 1 ? 1 / m_d : m_d)); }
    /// By halving: X rises with the azimuth.
    Real pannini_azimuth(Real x) const {
        Real low = -pannini_end(), high = -low;
        for (int i = 0; i < 120; ++i) {
            const Real middle = (low + high) / 2;
            ((m_d + 1) * std::sin(middle) / (m_d + std::cos(middle)) < x ? low : high) = middle;
        }
        return (low + high) / 2;
    }

    Projection m_projection;
    int m_width, m_height;
    Real m_d, m_e, m_half = 1, m_end = 0;
    int m_spans;  ///< pixels that 2 m_half cover, of pictures without faces and of the octahedron's
};

struct Case {
    Projection projection;
    int width, height;
    double fov = 0, d = 1;
    PixelSpacing spacing = PixelSpacing::edges;
    double e = 0.5;
};

const Case kCases[] = {
    {Projection::pannini, 30, 20, 150},
    {Projection::pannini, 30, 20, 90, 0},
    {Projection::pannini, 25, 31, 100, 0.5},
    {Projection::pannini, 30, 20, 220, 1},
    {Projection::pannini, 30, 20, 160, 7},
    {Projection::eac, 36, 24},
    {Projection::orthographic, 33, 33},
    {Projection::orthographic, 32, 20, 70},
    {Projection::sinusoidal, 40, 20},
    {Projection::sinusoidal, 30, 30, 100},
    {Projection::hammer, 40, 20},
    {Projection::hammer, 31, 30, 140},
    {Projection::dual_fisheye, 40, 20},
    {Projection::dual_fisheye, 40, 20, 210},
    {Projection::dual_fisheye, 40, 20, 120},
    {Projection::octahedral, 32, 32},
    {Projection::octahedral, 32, 32, 0, 1, PixelSpacing::centers},
    {Projection::eac, 48, 18},
    {Projection::mirror_ball, 31, 31},
    {Projection::mirror_ball, 40, 30, 200},
    {Projection::unified, 30, 20, 150},
    {Projection::unified, 30, 20, 90, 0},
    {Projection::unified, 25, 31, 100, 0.5},
    {Projection::unified, 30, 20, 220, 1},
    {Projection::unified, 30, 20, 160, 7},
    {Projection::eucm, 30, 20, 150, 1.1, PixelSpacing::edges, 0.6},
    {Projection::eucm, 30, 20, 110, 2, PixelSpacing::edges, 0},
    {Projection::eucm, 25, 31, 100, 0.7, PixelSpacing::edges, 0.35},
    {Projection::eucm, 30, 20, 190, 1.6, PixelSpacing::edges, 0.62},
    {Projection::eucm, 30, 20, 120, 0.25, PixelSpacing::edges, 1},
    {Projection::double_sphere, 30, 20, 150, -0.2, PixelSpacing::edges, 0.6},
    {Projection::double_sphere, 25, 31, 100, 0.4, PixelSpacing::edges, 0.3},
    {Projection::double_sphere, 30, 20, 200, 0.1, PixelSpacing::edges, 0.55},
    {Projection::double_sphere, 30, 20, 200, 0.8, PixelSpacing::edges, 1},
    {Projection::double_sphere, 30, 20, 300, 1, PixelSpacing::edges, 0.7},
    {Projection::double_sphere, 30, 20, 120, -0.9, PixelSpacing::edges, 0.5},
    {Projection::dual_fisheye_tb, 20, 40, 210},
    {Projection::dual_fisheye_tb, 20, 40, 120},
    {Projection::equisolid, 31, 31, 360},
    {Projection::equisolid, 30, 20, 100},
};

class Checked {
  public:
    Checked(const Chart& chart, const Oracle& oracle) : m_chart(chart), m_oracle(oracle) {}

    void at(double x, double y) {
        SCOPED_TRACE(testing::Message() << "pixel " << x << " " << y);
        int piece = 0;
        for (std::size_t i = 0; i < m_chart.pieces().size(); ++i) {
            const Box& b = m_chart.pieces()[i].box;
            if (x >= b.x0 && x < b.x1 && y >= b.y0 && y < b.y1) piece = static_cast<int>(i);
        }
        const Vector truth = m_oracle.ray(x, y);
        const bool inside = m_chart.inside(x, y, piece) >= 0;
        EXPECT_EQ(inside, !std::isnan(truth.x));
        if (!inside) return;
        const Ray<double> r = m_chart.ray(x, y, piece);
        const Vector ray = unit({r.x, r.y, r.z});
        // At its rim a picture's rays turn without end, of which z tells too little.
        const double slack = std::min(m_chart.inside(x, y, piece), 1.0);
        const double off = static_cast<double>(std::hypot(ray.x - truth.x, ray.y - truth.y, ray.z - truth.z));
        EXPECT_LE(off, kTolerance / std::sqrt(std::max(slack, 1e-9)));
        // Where the oracle sees the product's ray, unless another face shows its direction, too.
        ++seen;
        if (m_chart.piece_of(r) != piece) return;
        const Plane back = m_oracle.point(ray);
        EXPECT_LE(std::hypot(back.x - x, back.y - y), kTolerance * m_chart.width());
    }

    void toward(const Vector& v) {
        SCOPED_TRACE(testing::Message() << "ray " << v.x << " " << v.y << " " << v.z);
        const Ray<double> r{double(v.x), double(v.y), double(v.z)};
        const int piece = m_chart.piece_of(r);
        const Ray<double> local = transform(glm::transpose(m_chart.branch(piece).axes), r);
        const Plane truth = m_oracle.point({r.x, r.y, r.z});
        // Far out, where a point is all rounding, charts end somewhere.
        if (std::hypot(truth.x, truth.y) > 100 * m_chart.width()) return;
        EXPECT_EQ(m_chart.sees(local, piece) > 0, !std::isnan(truth.x));
        if (std::isnan(truth.x)) return;
        const Point<double> p = m_chart.point(r, piece);
        EXPECT_LE(std::hypot(p.x - truth.x, p.y - truth.y),
                  kTolerance * std::max<double>(std::hypot(truth.x, truth.y), m_chart.width()));
        ++seen;
    }

    int seen = 0;

  private:
    const Chart& m_chart;
    const Oracle& m_oracle;
};

TEST(ProjectionOracle, BothWays) {
    constexpr unsigned kSeed = 11;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> unit_range(0, 1);
    std::normal_distribution<double> normal;
    for (const Case& c : kCases) {
        SCOPED_TRACE(testing::Message()
                     << name_of(c.projection) << " fov " << c.fov << " d " << c.d << " e " << c.e);
        const Chart chart(c.projection, c.width, c.height, c.fov, c.spacing, "", {c.d, c.e});
        const Oracle oracle(chart);
        Checked checked(chart, oracle);
        // Between pixel centres the outer ones stand on the octahedron's folded edges, where a ray has two points.
        const int rim = c.spacing == PixelSpacing::centers ? 1 : 0;
        for (int j = rim; j < c.height - rim; ++j)
            for (int i = rim; i < c.width - rim; ++i) checked.at(i + 0.5, j + 0.5);
        EXPECT_GT(checked.seen, c.width * c.height / 2);
        for (int i = 0; i < 1000; ++i)
            checked.at(rim + (c.width - 2 * rim) * unit_range(random),
                       rim + (c.height - 2 * rim) * unit_range(random));
        checked.seen = 0;
        for (int i = 0; i < 2000; ++i) checked.toward(unit({normal(random), normal(random), normal(random)}));
        EXPECT_GT(checked.seen, 400);
    }
}

// A pole of the source within 1e-11 of a pixel's centre magnifies what rays are off by, constants of the formulas included.
TEST(ProjectionOracle, ExactPixelsBesideAPoleHoldTheirBounds) {
    struct View {
        Case target;
        Orientation look;
        int x, y;
    };
    const View views[] = {
        {{Projection::eac, 63, 42}, {0, 3.24e-10, 132.85714285714286}, 10, 20},
        {{Projection::pannini, 21, 21, 150, 0.3}, {0, 49.435636393783604, -179.999999999105}, 10, 14},
        {{Projection::pannini, 21, 21, 150, 0.001}, {0, 35.198333844456087, -179.999999999105}, 10, 14},
        {{Projection::hammer, 40, 20}, {30, 12, 49.5}, 10, 14},
    };
    for (const View& v : views) {
        const Case& c = v.target;
        SCOPED_TRACE(testing::Message() << name_of(c.projection) << " d " << c.d);
        const Chart target(c.projection, c.width, c.height, c.fov, PixelSpacing::edges, "", c.d);
        const Panorama map({Projection::equirectangular, 16384, 8192}, target, v.look);
        PlanOptions options;
        options.scheme = Scheme::exact;
        const PanoramaPlan plan(map, options);
        const Vector local = Oracle(target).ray(v.x + 0.5L, v.y + 0.5L);
        const oracle::Vector ray = oracle::rotated({local.x, local.y, local.z}, v.look);
        const Plane truth{azimuth_of({ray.x, ray.y, ray.z}) / (2 * kPi) * 16384 + 8192,
                          elevation_of({ray.x, ray.y, ray.z}) / kPi * 8192 + 4096};
        int seen = 0;
        for (const Block& block : plan.blocks(0)) {
            const Box& b = block.box;
            if (v.x < b.x0 || v.x >= b.x1 || v.y < b.y0 || v.y >= b.y1) continue;
            Point<double> used{};
            int piece = 0;
            ASSERT_TRUE(static_cast<const BlockMap&>(plan).exact(block, v.x + 0.5, v.y + 0.5, used, piece));
            const Real turn = used.x - truth.x, off = turn - std::round(turn / 16384) * 16384;
            EXPECT_LE(std::hypot(off, used.y - truth.y), block.bound);
            ++seen;
        }
        EXPECT_EQ(seen, 1);
    }
}

// Near the largest field of view d + cos a is next to nothing.
TEST(ProjectionOracle, PanninisScaleIsAsPreciseAsItSays) {
    const auto cotangent_near_right = [](Real degrees) { return std::tan((90 - degrees) * kDegree); };
    const auto expect_scale = [](double fov, double d, Real truth) {
        SCOPED_TRACE(testing::Message() << "fov " << fov << " d " << d);
        const Chart chart(Projection::pannini, 128, 128, fov, PixelSpacing::edges, "", d);
        const Constant& scale = chart.pixels_per_unit();
        const auto bounded = scale.as<Rounded<DoubleDouble>>();
        EXPECT_GE(bounded.range.hi, truth);
        EXPECT_LE(bounded.range.lo, truth);
        EXPECT_LE(std::fabs(static_cast<Real>(scale.precise()) - truth), bounded.error);
        EXPECT_LE(bounded.error, 1e-7 * truth);
    };
    for (const double fov : {359.99999964, 359.99964, 300.0, 90.0})
        expect_scale(fov, 1, 32 * cotangent_near_right(static_cast<Real>(fov) / 4));
    for (const double fov : {179.99999982, 179.5, 90.0})
        expect_scale(fov, 0, 64 * cotangent_near_right(static_cast<Real>(fov) / 2));
}

TEST(ProjectionOracle, PanninisFieldOfViewStaysBelowItsLimit) {
    EXPECT_THROW(Chart(Projection::pannini, 64, 64, 240, PixelSpacing::edges, "", 0.5), Error);
    for (const double d : {2.02e-8, 0.1, 0.23, 0.3, 0.5, 0.7, 0.999}) {
        const Real limit = 2 * std::acos(-static_cast<Real>(d)) / kDegree;
        double fov = static_cast<double>(limit);
        for (int i = 0; i < 20; ++i) fov = std::nextafter(fov, 360);
        int accepted = 0;
        for (int i = 0; i < 40; ++i, fov = std::nextafter(fov, 0)) {
            SCOPED_TRACE(testing::Message() << testing::PrintToString(fov) << " d " << d);
            try {
                const Chart chart(Projection::pannini, 64, 64, fov, PixelSpacing::edges, "", d);
                ++accepted;
                EXPECT_LT(static_cast<Real>(fov), limit);
                EXPECT_GT(chart.pixels_per_unit().precise(), 0);
            } catch (const Error&) {
            }
        }
        EXPECT_GT(accepted, 0);
    }
}

}  // namespace
}  // namespace anamorph::test_projection_oracle
