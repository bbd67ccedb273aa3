// SPDX-License-Identifier: Apache-2.0
// The constants of proofs against what they bound, looked for where it is largest: none is passed, and each is come near to.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include "anamorph/chart/chart_formulas.h"
#include "anamorph/panorama/concentric.h"
#include "panorama_oracle.h"

namespace anamorph::test_proof_constants {
namespace {

using oracle::kPi;
using Real = long double;

// --- widths of planes, against numbers of 113 bits ---

using Quad = __float128;
const Quad kQuadPi = Quad(kPi) - 5.0165576126683320235e-20L;

/// Sine (first = 1) or cosine (first = 0) of up to a right angle, by its power series.
Quad power_series(Quad angle, int first) {
    Quad term = first ? angle : Quad(1), sum = 0;
    for (int k = first + 1; k < 80; k += 2) {
        sum += term;
        term *= -angle * angle / (k * (k + 1));
    }
    return sum;
}
Quad sine(Quad angle) {
    return power_series(angle, 1);
}
Quad cosine(Quad angle) {
    return power_series(angle, 0);
}

/// By Newton's method from long double's.
Quad square_root(Quad value) {
    const Quad near = std::sqrt(static_cast<long double>(value));
    return (near + value / near) / 2;
}

/// What a field of view covers, of its projection's definition.
Quad width_of(Projection projection, double degrees, const Distance& numbers) {
    const Quad angle = Quad(degrees) * kQuadPi / 180, d = numbers.d, e = numbers.e;
    // Sine and cosine of half of it, which is up to a half turn, by those of a quarter.
    const Quad quarter = cosine(angle / 4), s = 2 * sine(angle / 4) * quarter, c = 2 * quarter * quarter - 1;
    switch (projection) {
        case Projection::rectilinear:
            return 2 * sine(angle / 2) / cosine(angle / 2);
        case Projection::equisolid:
        case Projection::mirror_ball:
            return 4 * sine(angle / 4);
        case Projection::stereographic:
            return 4 * sine(angle / 4) / cosine(angle / 4);
        case Projection::orthographic:
            return 2 * sine(angle / 2);
        case Projection::hammer:
            // k = sqrt(2 / (1 + cos(a / 2))) = 1 / cos(a / 4), at a of half the field of view.
            return 4 * sine(angle / 4) / cosine(angle / 8);
        case Projection::pannini:
        case Projection::unified:
            return 2 * (d + 1) * s / (d + c);
        case Projection::eucm:
            return 2 * s / (e * square_root(d * s * s + c * c) + (1 - e) * c);
        case Projection::double_sphere: {
            const Quad w = c + d;
            return 2 * (1 + d) * s / (e * square_root(s * s + w * w) + (1 - e) * w);
        }
        case Projection::cubemap:
        case Projection::cubemap3x2:
        case Projection::cubecross:
        case Projection::eac:
            return 2;
        case Projection::octahedral:
            return 1;
        default:
            return angle;
    }
}

Quad quad(const DoubleDouble& a) {
    return Quad(a.upper()) + Quad(a.lower());
}

/// How far pixels per unit of a plane, or their inverse, are off, in units of 2^-64.
double units_off(const Chart& chart, double pixels) {
    const Quad width = width_of(chart.projection(), chart.fov(), chart.distance());
    const Quad off[] = {quad(chart.pixels_per_unit().precise()) * width / pixels - 1,
                        quad(chart.units_per_pixel().precise()) * pixels / width - 1};
    double most = 0;
    for (const Quad& each : off) most = std::max(most, std::fabs(static_cast<double>(each)) * 0x1p64);
    return most;
}

double most_units(Projection projection, double fov, const Distance& d) {
    Setting setting;
    setting.distance = d;
    return with_projection(projection, [&](auto formulas) { return formulas.width_units(fov, setting); });
}

/// Numbers that a projection may have, of two between 0 and 1.
Distance numbers_for(Projection projection, double a, double b) {
    if (projection == Projection::eucm) return {std::exp(4 * b - 2), a};
    if (projection == Projection::double_sphere) return {1.9 * b - 0.95, a};
    return numbers_of(projection) > 0 ? std::exp(6 * a - 3) : 1;
}

TEST(ProofConstants, WidthsOfPlanesAreAsWellKnownAsTheySay) {
    constexpr unsigned kSeed = 410;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    double most_of_all = 0;
    for (const Projection projection : kProjections) {
        const FieldOfView limits = fov_of(projection);
        const FaceGrid faces = faces_of(projection);
        double nearest = 0;
        for (int i = 0; i < 2000; ++i) {
            const double a = uniform(random), b = uniform(random);
            const Distance d = numbers_for(projection, a, b);
            Setting setting;
            setting.distance = d;
            const double most = with_projection(
                projection, [&](auto formulas) { return formulas.most_fov(limits, setting); });
            // Near the end one time in four.
            const double part = i % 4 ? uniform(random) : 1 - std::exp(-25 * uniform(random));
            const double fov = limits.fixed ? limits.standard : most * std::min(part, 1 - 1e-12);
            if (!(fov > 0)) continue;
            const bool centers = i % 2 != 0;
            const int n = 2 + static_cast<int>(uniform(random) * 1000);
            const Chart chart(projection, n * std::max(faces.columns, 1), n * std::max(faces.rows, 1), fov,
                              centers ? PixelSpacing::centers : PixelSpacing::edges, "", d);
            // Between the centres of the outer pixels of a face, or of two that are joined.
            const double pixels = !centers ? n : faces.joined ? n - 0.5 : n - 1;
            const double units = units_off(chart, pixels), allowed = most_units(projection, fov, d);
            EXPECT_LE(units, allowed) << name_of(projection) << " " << fov << " " << d.d << " " << d.e;
            nearest = std::max(nearest, units / allowed);
        }
        RecordProperty(std::string(name_of(projection)), std::to_string(nearest));
        most_of_all = std::max(most_of_all, nearest);
    }
    // Sums of two doubles take next to nothing of what is allowed.
    EXPECT_GT(most_of_all, 1e-7);
    EXPECT_LT(most_of_all, 1e-4);
}

// --- Pannini's largest field of view ---

TEST(ProofConstants, PanninisLargestFieldOfViewIsNotTooLarge) {
    constexpr unsigned kSeed = 411;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    const FieldOfView limits = fov_of(Projection::pannini);
    for (int i = 0; i < 300000; ++i) {
        Setting setting;
        double d = 1.0000001071968494;
        if (i > 0) d = 1 + std::exp(-36 * uniform(random) + 3) * (i % 3 ? 1 : -0.04);
        setting.distance = d;
        const double most = projection::Pannini::most_fov(limits, setting);
        // acos(-c) = pi - 2 asin(sqrt((1 - c) / 2)), in which nothing cancels; c = d or 1 / d.
        const Real less = d > 1 ? (Real(d) - 1) / d : 1 - Real(d);
        const Real truth = 2 * (180 - 2 * std::asin(std::sqrt(less / 2)) * 180 / kPi);
        EXPECT_LE(most, truth * (1 + 0x1p-62L)) << d;
        // Of a cosine one unit off.
        EXPECT_GT(most, truth - 1e-12L - Real(0x1p-50) * 180 / std::sqrt(less + 1e-300L)) << d;
    }
}

// --- the widest distance between points ---

/// Where a ray's point lies from the middle, in double, straight behind where squares underflow.
TEST(ProofConstants, NoPointsAreFartherApartThanTheWidest) {
    constexpr unsigned kSeed = 412;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (const Projection projection : {Projection::fisheye, Projection::equisolid})
        for (const int n : {1, 7, 512}) {
            const Chart chart(projection, n, n, 360);
            double farthest = 0;
            for (int i = 0; i < 20000; ++i) {
                // Across the axis from 2^-541 to 1, most of all where squares are a few multiples of 2^-1074.
                const double size =
                    i % 2 ? std::exp2(-541 + 8 * uniform(random)) : std::exp2(-600 * uniform(random));
                const double angle = 2 * std::numbers::pi * uniform(random);
                const double x = size * std::cos(angle), y = size * std::sin(angle);
                const Point<double> p = chart.point(Ray<double>{x, y, -1}, 0);
                // A quotient that overflows gives none.
                if (!std::isfinite(p.x) || !std::isfinite(p.y)) continue;
                // The other side's, where nothing underflows.
                const Real turned = std::atan2(Real(-y), Real(-x));
                const Real radius =
                    (projection == Projection::fisheye ? kPi : Real(2)) * Real(chart.scale_x());
                const Real apart = std::hypot(Real(p.x) - n / Real(2) - radius * std::cos(turned),
                                              Real(p.y) - n / Real(2) - radius * std::sin(turned));
                EXPECT_LE(apart, Real(chart.widest())) << name_of(projection) << " " << x << " " << y;
                farthest = std::max(farthest, static_cast<double>(apart / chart.widest()));
            }
            // An equisolid quotient overflows before squares are far off.
            EXPECT_GT(farthest, projection == Projection::fisheye ? 0.9 : 0.79);
        }
}

// --- rotations to and from local frames ---

struct Matrix {
    Real at[3][3];  ///< by columns
};

Matrix product(const Matrix& a, const Matrix& b) {
    Matrix m{};
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            for (int k = 0; k < 3; ++k) m.at[column][row] += a.at[k][row] * b.at[column][k];
    return m;
}
Matrix transposed(const Matrix& a) {
    Matrix m{};
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) m.at[column][row] = a.at[row][column];
    return m;
}

/// A local frame, of the angle from which its branch counts.
Matrix frame_of(const Chart& chart, const Branch& branch) {
    const Real s = std::sin(Real(branch.around.angle)), c = std::cos(Real(branch.around.angle));
    Matrix piece{}, turn{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
    const glm::dmat3& axes = chart.pieces()[static_cast<std::size_t>(branch.piece)].axes;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row) piece.at[column][row] = axes[column][row];
    if (chart.counted() == Counted::azimuth)
        turn = {{{c, 0, -s}, {0, 1, 0}, {s, 0, c}}};
    else if (chart.counted() == Counted::axis)
        turn = {{{c, s, 0}, {-s, c, 0}, {0, 0, 1}}};
    return product(piece, turn);
}

TEST(ProofConstants, LocalRotationsAreAsWellKnownAsTheySay) {
    constexpr unsigned kSeed = 413;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    double most = 0;
    for (const Projection source :
         {Projection::equirectangular, Projection::fisheye, Projection::dual_fisheye})
        for (const Projection target :
             {Projection::equirectangular, Projection::fisheye, Projection::rectilinear})
            for (int i = 0; i < 2000; ++i) {
                const Orientation look{180 * uniform(random), 90 * uniform(random), 180 * uniform(random)};
                const Panorama map(
                    source == Projection::dual_fisheye ? Chart(source, 128, 64) : Chart(source, 100, 64),
                    Chart(target, 100, 64), look);
                const auto local = map.local_around(50 + 25 * uniform(random), 32 + 25 * uniform(random), 0);
                Matrix turn{};
                for (int column = 0; column < 3; ++column) {
                    const oracle::Vector v =
                        oracle::rotated({Real(column == 0), Real(column == 1), Real(column == 2)}, look);
                    turn.at[column][0] = v.x, turn.at[column][1] = v.y, turn.at[column][2] = v.z;
                }
                const Matrix exact = product(transposed(frame_of(map.source(), local.source)),
                                             product(turn, frame_of(map.target(), local.target)));
                for (int column = 0; column < 3; ++column)
                    for (int row = 0; row < 3; ++row)
                        most = std::max(most, static_cast<double>(std::fabs(exact.at[column][row] -
                                                                            local.rotation[column][row])));
            }
    EXPECT_LE(most, Panorama::kLocalError);
    // What libm is taken to be off is most of it.
    EXPECT_GT(most, Panorama::kLocalError / 150);
}

// --- lines of sight beyond a circle's ---

TEST(ProofConstants, WhereACircleShowsNothingItWeighsNothing) {
    constexpr unsigned kSeed = 414;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    int outside = 0;
    for (int i = 0; i < 200; ++i) {
        // Nearly straight up or down directions are off by as much more as they are nearer to that.
        const double fov = std::exp(-25 * uniform(random)) * 90;
        const double pitch = (i % 2 ? 90 : -90) * (i % 3 ? 1 : uniform(random));
        const Panorama view(Chart(Projection::equirectangular, 512, 256, 360),
                            Chart(Projection::rectilinear, 32, 32, fov),
                            {360 * uniform(random), pitch, 360 * uniform(random)});
        const double turn = 2 * std::numbers::pi * uniform(random);
        const ConcentricStack stack{
            2 + static_cast<int>(uniform(random) * 1000), 3, {0.99 * std::sin(turn), 0.99 * std::cos(turn)}};
        for (int k = 0; k < 100; ++k) {
            const double x = 32 * uniform(random), y = 32 * uniform(random);
            const double offset = stack.offset(view.source_ray(x, y, 0));
            // A circle whose neighbour's line of sight this nearly is.
            const double place = (offset + 1) / 2 * (stack.circles - 1);
            for (const double circle : {std::floor(place) - 1, std::ceil(place) + 1, std::round(place)}) {
                if (!(circle >= 0 && circle < stack.circles)) continue;
                const ConcentricMap map(view, stack, static_cast<int>(circle), false);
                const auto local = map.local_around(x, y, 0);
                if (map.cover(Interval(x), Interval(y), 0, local, true) != Cover::outside) continue;
                ++outside;
                EXPECT_EQ(stack.weight(static_cast<int>(circle), offset), 0) << fov << " " << x << " " << y;
            }
        }
    }
    EXPECT_GT(outside, 1000);
}

// What formulas make of numbers that are off themselves, next to the axis of a fisheye: sin t / t and cos t of t^2, and the angle of
// (across, ahead) over across. Truths in long double, by series where t is small.
TEST(ProofConstants, FisheyesHaveBoundsNextToTheirAxis) {
    constexpr unsigned kOwnSeed = 20262;
    SCOPED_TRACE(testing::Message() << "seed " << kOwnSeed);
    std::mt19937 random(kOwnSeed);
    std::uniform_real_distribution<double> exponent(-40, 0), part(-1, 1);
    using R = Rounded<double>;
    int bounded = 0;
    for (int i = 0; i < 20000; ++i) {
        const bool is_on_axis = i % 5 == 0;
        const double s = is_on_axis ? 0 : 0.5 * std::pow(10, exponent(random)),
                     off = 0.4 * std::pow(10, exponent(random)),
                     computed = std::max(s + off * part(random), 0.0);
        double sinc, cosine;
        projection::sinc_cos(computed, sinc, cosine);
        R bound_sinc, bound_cosine;
        projection::sinc_cos(R(Interval(s), 0, off), bound_sinc, bound_cosine);
        const long double t = std::sqrt(static_cast<long double>(s));
        const long double true_sinc = s < 1e-12 ? 1 - s / 6.0L : std::sin(t) / t, true_cosine = std::cos(t);
        EXPECT_LE(std::fabs(static_cast<double>(sinc - true_sinc)), bound_sinc.error);
        EXPECT_LE(std::fabs(static_cast<double>(cosine - true_cosine)), bound_cosine.error);
        EXPECT_LE(bound_sinc.range.lo, static_cast<double>(true_sinc));
        EXPECT_GE(bound_sinc.range.hi, static_cast<double>(true_sinc));

        const double across = is_on_axis ? 0 : 0.5 * std::pow(10, exponent(random)),
                     ahead = 1 + part(random) / 2, there = std::max(across + off * part(random), 0.0),
                     before = ahead + 1e-3 * off * part(random);
        const Heading along;
        const double found = projection::tilt_over_across(there == 0, there, before, along);
        const R of_across(Interval(across), 0, off), of_ahead(Interval(ahead), 0, 1e-3 * off);
        const R bound = projection::tilt_over_across(is_zero(of_across), of_across, of_ahead, along);
        const long double q = static_cast<long double>(across) / ahead;
        const long double truth = (q < 1e-6L ? 1 - q * q / 3 : std::atan(q) / q) / ahead;
        EXPECT_LE(std::fabs(static_cast<double>(found - truth)), bound.error)
            << across << " " << ahead << " " << off;
        if (!(bound.error < 10)) continue;
        ++bounded;
        EXPECT_LE(bound.range.lo, static_cast<double>(truth));
        EXPECT_GE(bound.range.hi, static_cast<double>(truth));
    }
    EXPECT_GT(bounded, 15000);
}

}  // namespace
}  // namespace anamorph::test_proof_constants
