// SPDX-License-Identifier: Apache-2.0
// Views of concentric mosaics: speed and error.
#include <algorithm>
#include <cmath>
#include <deque>
#include <vector>

#include "anamorph/image/part_source.h"
#include "anamorph/panorama/concentric_view.h"
#include "pixels.h"
#include "projection_rows.h"

namespace anamorph::bench {
namespace {

constexpr int kCircles = 5, kMiddle = 3, kMostSide = 1024;
constexpr double kDepth = 3, kYaw = 30, kRight = 0.4, kAhead = -0.3;

Panorama view_of(int side) {
    return Panorama(Chart(Projection::cylindrical, 4 * side, side, 360),
                    Chart(Projection::rectilinear, side, side, 90), {.yaw = kYaw});
}

/// Where a pixel's line of sight is in the panorama of circle kMiddle: by way of the point of the wall at the depth.
Point<Real> source_point(int side, int i, int j) {
    const Real x = (i + Real(0.5)) * 2 / side - 1, y = (j + Real(0.5)) * 2 / side - 1;
    const Real turn = std::atan2(x, Real(1)) + kYaw * kPi / 180, slope = y / std::hypot(x, Real(1));
    const Real ux = std::sin(turn), uz = std::cos(turn), along = kRight * ux + kAhead * uz;
    const Real k = -along + std::sqrt(along * along - (Real(kRight) * kRight + Real(kAhead) * kAhead) +
                                      Real(kDepth) * kDepth);
    const Real azimuth = std::atan2(kRight + k * ux, kAhead + k * uz);
    const Real radius = 2 * Real(kMiddle) / (kCircles - 1) - 1, per_radian = 4 * side / (2 * kPi);
    Real column = azimuth - std::asin(radius / kDepth);
    column -= 2 * kPi * std::round(column / (2 * kPi));
    return {(column + kPi) * per_radian,
            Real(side) / 2 + slope * k / std::sqrt(Real(kDepth) * kDepth - radius * radius) * per_radian};
}

/// Of the panorama of circle kMiddle, to the rounding of float.
Accuracy accuracy(int side, const ConcentricStack& stack, ReprojectOptions options, Pool& pool) {
    options.output = Output::stmap;
    const Picture view = mosaic_picture(view_of(side), stack, options, kMiddle);
    Buffer st(sizeof(float) * 2 * static_cast<std::size_t>(side) * static_cast<std::size_t>(side));
    view.draw(std::vector<const Source*>(kCircles, nullptr), {0, 0, side, side},
              packed_view(st.bytes(), PixelType::float32, side, side, 2), pool.parallel_for());
    std::vector<float> errors;
    const float* at = st.as<float>();
    for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i, at += 2) {
            if (!(at[0] >= 0)) continue;
            const Point<Real> truth = source_point(side, i, j);
            Real across = std::fabs(at[0] * Real(4 * side) - truth.x);
            across = std::min(across, 4 * side - across);
            errors.push_back(static_cast<float>(std::hypot(across, at[1] * Real(side) - truth.y)));
        }
    return accuracy_of(errors);
}

}  // namespace

void run_mosaics(const Settings& settings, Report& report) {
    if (!settings.wants_case("mosaic")) return;
    const int side = std::min(settings.size, kMostSide);
    Pool pool(settings.threads);
    const auto pixels = static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
    Buffer texels(sizeof(float) * 3 * 4 * pixels * kCircles), picture(sizeof(float) * 3 * pixels);
    for (std::size_t i = 0; i < 12 * pixels * kCircles; ++i)
        texels.as<float>()[i] = static_cast<float>(i * 2654435761u % 65536) / 65536;
    const MemorySource stacked(
        packed_view<const std::byte>(texels.bytes(), PixelType::float32, 4 * side, side * kCircles, 3));
    std::deque<PartSource> strips;
    std::vector<const Source*> sources;
    for (int circle = 0; circle < kCircles; ++circle)
        sources.push_back(
            &strips.emplace_back(stacked, Box{0, circle * side, stacked.size(0).width, (circle + 1) * side}));
    const ConcentricStack stack{kCircles, kDepth, {kRight, kAhead}};
    struct Case {
        const char* scheme;
        ReprojectOptions options;
    };
    std::vector<Case> cases;
    for (const double tol : {0.1, 0.01}) {
        cases.push_back({"automatic", {}});
        cases.back().options.tol = tol;
    }
    cases.push_back({"exact", {}});
    cases.back().options.scheme = Scheme::exact;
    cases.back().options.tol = 0;
    std::vector<Timed> timed;
    for (const Case& c : cases)
        timed.push_back({[&] {
                             mosaic_picture(view_of(side), stack, c.options)
                                 .draw(sources, {0, 0, side, side},
                                       packed_view(picture.bytes(), PixelType::float32, side, side, 3),
                                       pool.parallel_for());
                         },
                         settings.threads});
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    for (std::size_t k = 0; k < cases.size(); ++k) {
        if (!settings.wants_scheme(cases[k].scheme)) continue;
        const Reached reached =
            mosaic_picture(view_of(side), stack, cases[k].options).reached(pool.parallel_for());
        Row row;
        row.op = "projection";
        row.case_name = "mosaic";
        row.scheme = cases[k].scheme;
        row.tol_px = cases[k].options.tol;
        row.size = side;
        row.threads = settings.threads;
        row.ns_per_px = times[k].median / static_cast<double>(pixels);
        row.best_ns_per_px = times[k].best / static_cast<double>(pixels);
        row.ratio_to_exact = times.back().median / times[k].median;
        row.error = accuracy(side, stack, cases[k].options, pool);
        row.bound_px = reached.max_error;
        row.exact_fraction = reached.exact_fraction;
        report.add(row);
    }
}

}  // namespace anamorph::bench
