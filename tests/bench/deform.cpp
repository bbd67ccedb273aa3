// SPDX-License-Identifier: Apache-2.0
// Deformed surfaces and inbetweening: speed against error.
//
// A plane of up to 1000 x 1000 points with 50 Gaussians, local ones and wide ones. double and float: plain
// loops over eq. (4.1), no cutoff. fixed and fixed_double: deform_grid to float and double points. kept: a
// DeformedGrid filled and drawn. edit: one bump of a DeformedGrid changed and drawn, averaged over all bumps.
// points and points_edit: the same of DeformedPoints. memory: as many bytes copied as fixed reads and writes.
//
// What limits an edit: deform/deformed_surface.h has the arithmetic. 15 times as fast as all anew is out of reach for the
// wide bumps whatever is stored, and for the local ones with sums of 64 bits.
//
// With normals: the same planes, normals (0, 0, 1) that turn along. double: the plain loop, that of a bump
// giving both derivatives from its value. grid: a DeformedGrid filled and drawn, and its slopes, which turn
// the normals. points: the same of DeformedPoints, at once. grid_edit, points_edit: the same after one bump that reaches 250 to
// 300 points has changed. Errors are those of a component of a normal.
//
// Case depth: the same plane as a sheet that rises and falls, and 50 bumps with depth; frames: these with frames of their own. double: the
// plain loop over (u, v, w). points, points_edit: as before.
//
// A blend of 10 shapes of as many points, weights from -0.3 to 0.4. double: the plain loop. blend: inbetween.
// regions: inbetween_from_base with a mask for every other shape. memory: as many bytes copied as blend reads
// and writes.
//
// Errors are those of a component of a point, in units of the surface (u and v go from 0 to 1), from eq.
// (4.1) in long double, over every 31st point. Times are a point's ("px").
#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <glm/geometric.hpp>
#include <random>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "anamorph/deform/deformed_surface.h"
#include "anamorph/deform/inbetween.h"
#include "bench.h"
#include "pixels.h"

namespace anamorph::bench::op_deform {
namespace {

constexpr int kMostSide = 1000;
constexpr std::size_t kTruthStep = 31;

struct Contender {
    std::string scheme;
    std::function<void()> draw;
    double repeats = 1;                          ///< what `draw` does how many times
    std::function<double(std::size_t)> value{};  ///< what it has drawn: component k of the surface
    double bound = kNone;
};

/// Times contenders together and adds their rows. `truth` has component k for multiples of kTruthStep points.
void measure(const std::string& case_name, int side, std::size_t points, const Settings& settings,
             const std::vector<Contender>& contenders, const std::function<long double(std::size_t)>& truth,
             Report& report) {
    std::vector<Timed> timed;
    for (const Contender& c : contenders) timed.push_back({c.draw, 1});
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    for (std::size_t k = 0; k < contenders.size(); ++k) {
        const Contender& c = contenders[k];
        const double share = 1 / (c.repeats * static_cast<double>(points));
        Row row;
        row.op = "deform";
        row.case_name = case_name;
        row.scheme = c.scheme;
        row.size = side;
        row.ns_per_px = times[k].median * share;
        row.best_ns_per_px = times[k].best * share;
        row.sharing = times[k].sharing;
        row.ratio_to_exact = times[0].median / times[k].median * c.repeats;
        row.bound_px = c.bound;
        if (c.value) {
            c.draw();
            std::vector<float> errors;
            for (std::size_t p = 0; p < points; p += kTruthStep)
                for (std::size_t i = 3 * p; i < 3 * p + 3; ++i)
                    errors.push_back(static_cast<float>(std::fabs(c.value(i) - truth(i))));
            row.error = accuracy_of(errors);
            // Points in float are rounded to 2^-24 of themselves, which are below 2.
            if (!std::isnan(c.bound) && !(row.error.max <= c.bound + 0x1p-23))
                report.failures.push_back(case_name + ", " + c.scheme + ": largest error " +
                                          std::to_string(row.error.max) + ", bound " +
                                          std::to_string(c.bound));
        }
        if (settings.wants_scheme(c.scheme)) report.add(row);
    }
}

std::vector<Deformation> gaussians(unsigned seed, double least_extent, double most_extent) {
    std::mt19937 random(seed);
    const auto number = [&](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    std::vector<Deformation> list(50);
    for (Deformation& d : list) {
        d.vector = {number(-.05, .05), number(-.05, .05), number(-.2, .2)};
        d.center = {number(0, 1), number(0, 1)};
        d.extent = {number(least_extent, most_extent), number(least_extent, most_extent)};
    }
    return list;
}

/// The loop that one would write first. Real: of the arithmetic.
template <class Real, class T>
void plain_loop(const std::vector<Deformation>& list, const std::vector<double>& u, const T* base, T* out) {
    std::vector<Real> p(list.size() * 7);
    for (std::size_t k = 0; k < list.size(); ++k) {
        const Deformation& d = list[k];
        const double from[7] = {d.center.x, d.center.y, d.extent.x, d.extent.y,
                                d.vector.x, d.vector.y, d.vector.z};
        std::transform(from, from + 7, &p[7 * k], [](double x) { return static_cast<Real>(x); });
    }
    for (const double v : u)
        for (const double column : u) {
            Real x = base[0], y = base[1], z = base[2];
            for (std::size_t k = 0; k < p.size(); k += 7) {
                const Real s = (static_cast<Real>(column) - p[k]) / p[k + 2],
                           t = (static_cast<Real>(v) - p[k + 1]) / p[k + 3], f = std::exp(-s * s - t * t);
                x += p[k + 4] * f;
                y += p[k + 5] * f;
                z += p[k + 6] * f;
            }
            *out++ = static_cast<T>(x);
            *out++ = static_cast<T>(y);
            *out++ = static_cast<T>(z);
            base += 3;
        }
}

/// A list whose bumps are changed one after the other, there and back.
template <class Surface, class T>
class Edits {
  public:
    Edits(Surface surface, const std::vector<Deformation>& list, const T* base, T* out)
        : m_surface(std::move(surface)), m_list(list), m_base(base), m_out(out) {
        m_surface.apply(difference({}, list));
        m_surface.write(base, out);
    }
    void run() {
        m_there = !m_there;
        for (std::size_t k = 0; k < m_list.entries().size(); ++k) {
            Deformation d = m_list.entries()[k];
            d.vector.z *= m_there ? 1.5 : 1 / 1.5;
            d.center.x += m_there ? .01 : -.01;
            m_surface.apply(m_list.change(k, d));
            m_surface.update(m_base, m_out);
        }
    }

  private:
    Surface m_surface;
    DeformationList m_list;
    const T* m_base;
    T* m_out;
    bool m_there = false;
};

void run_list(const Settings& settings, Report& report, const std::string& name, double least_extent,
              double most_extent) {
    if (!settings.wants_case(name)) return;
    const int side = std::min(settings.size, kMostSide);
    const std::vector<Deformation> list = gaussians(1, least_extent, most_extent);
    std::vector<double> u;
    for (int i = 0; i < side; ++i) u.push_back((i + 0.5) / side);
    const std::size_t across = u.size(), points = across * across, bytes = 3 * points * sizeof(double);
    // The points in float are those of the plane in double to the bit: u and v are rounded first.
    for (double& x : u) x = static_cast<float>(x);
    const Buffer base(bytes), base_double(bytes), out(bytes), out_double(bytes), edited(bytes), copied(bytes);
    std::vector<glm::dvec2> parameters;
    for (std::size_t p = 0; p < points; ++p) {
        const double at[3] = {u[p % across], u[p / across], 0};
        parameters.push_back({at[0], at[1]});
        for (std::size_t c = 0; c < 3; ++c) {
            base_double.as<double>()[3 * p + c] = at[c];
            base.as<float>()[3 * p + c] = static_cast<float>(at[c]);
        }
    }
    std::vector<long double> exact(3 * points);
    for (std::size_t p = 0; p < points; p += kTruthStep)
        for (std::size_t c = 0; c < 3; ++c) {
            long double& sum = exact[3 * p + c] = base_double.as<double>()[3 * p + c];
            for (const Deformation& d : list)
                sum += d.vector[static_cast<int>(c)] *
                       kernel_value(d.kernel,
                                    (parameters[p].x - static_cast<long double>(d.center.x)) / d.extent.x,
                                    (parameters[p].y - static_cast<long double>(d.center.y)) / d.extent.y);
        }
    const auto floats = [to = out.as<float>()](std::size_t k) { return static_cast<double>(to[k]); };
    const auto doubles = [to = out_double.as<double>()](std::size_t k) { return to[k]; };
    const DeformOptions options;
    const double bound = deform_grid<float>(list, u, u, options, nullptr, out.as<float>());

    Edits<DeformedGrid, float> grid_edits(DeformedGrid(u, u, options), list, base.as<float>(),
                                          edited.as<float>());
    Edits<DeformedPoints, float> point_edits(DeformedPoints(parameters, options), list, base.as<float>(),
                                             edited.as<float>());
    DeformedPoints scattered(parameters, options);
    const std::vector<DeformationChange> changes = difference({}, list);
    std::vector<DeformationChange> renewed;  // taken away and added: the surface stays
    for (const DeformationChange& change : changes) renewed.push_back({change.after, change.after});
    scattered.apply(changes);
    scattered.write(base.as<float>(), out.as<float>());
    const double edits = static_cast<double>(list.size());
    const std::vector<Contender> contenders = {
        {"double", [&] { plain_loop<double>(list, u, base_double.as<double>(), out_double.as<double>()); }, 1,
         doubles},
        {"float", [&] { plain_loop<float>(list, u, base.as<float>(), out.as<float>()); }, 1, floats},
        {"fixed", [&] { deform_grid(list, u, u, options, base.as<float>(), out.as<float>()); }, 1, floats,
         bound},
        {"fixed_double",
         [&] { deform_grid(list, u, u, options, base_double.as<double>(), out_double.as<double>()); }, 1,
         doubles, bound},
        {"kept",
         [&] {
             DeformedGrid grid(u, u, options);
             grid.apply(changes);
             grid.write(base.as<float>(), out.as<float>());
         },
         1, floats, bound},
        {"edit", [&] { grid_edits.run(); }, edits},
        {"points",
         [&] {
             scattered.apply(renewed);
             scattered.write(base.as<float>(), out.as<float>());
         },
         2, floats, bound},
        {"points_edit", [&] { point_edits.run(); }, edits},
        {"memory", [&] { std::memcpy(copied.bytes(), base.bytes(), 3 * points * sizeof(float)); }}};
    measure(
        name, side, points, settings, contenders, [&](std::size_t k) { return exact[k]; }, report);
}

/// A bump's own coordinates, in extents: R^T (p - c) / a, R of a quaternion (w, x, y, z) as in every textbook.
template <class Real>
class OwnCoordinates {
  public:
    explicit OwnCoordinates(const Deformation& d) : m_center{d.center.x, d.center.y, d.center_w} {
        const Real q[4] = {static_cast<Real>(d.orientation.x), static_cast<Real>(d.orientation.y),
                           static_cast<Real>(d.orientation.z), static_cast<Real>(d.orientation.w)};
        const Real length = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
        const Real w = q[0] / length, x = q[1] / length, y = q[2] / length, z = q[3] / length;
        const Real turn[3][3] = {{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
                                 {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
                                 {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
        const Real extents[3] = {static_cast<Real>(d.extent.x), static_cast<Real>(d.extent.y),
                                 static_cast<Real>(d.extent_w)};
        for (int k = 0; k < 3; ++k)
            for (int j = 0; j < 3; ++j) m_rows[k][j] = turn[j][k] / extents[k];
    }

    /// The square of their distance from 0.
    Real squared(const Real (&p)[3]) const {
        Real sum = 0;
        for (const auto& row : m_rows) {
            const Real own =
                row[0] * (p[0] - m_center[0]) + row[1] * (p[1] - m_center[1]) + row[2] * (p[2] - m_center[2]);
            sum += own * own;
        }
        return sum;
    }

  private:
    Real m_center[3], m_rows[3][3];
};

void run_depth(const Settings& settings, Report& report, const std::string& name, bool frames) {
    if (!settings.wants_case(name)) return;
    const int side = std::min(settings.size, kMostSide);
    std::vector<Deformation> list = gaussians(1, .05, .2);
    std::mt19937 random(2);
    const auto number = [&](double least, double most) {
        return std::uniform_real_distribution<double>(least, most)(random);
    };
    for (Deformation& d : list) {
        d.center_w = number(-.2, .2);
        d.extent_w = number(.05, .2);
        if (frames) d.orientation = {number(.1, 1), number(-1, 1), number(-1, 1), number(-1, 1)};
    }
    const auto across = static_cast<std::size_t>(side);
    const std::size_t points = across * across, bytes = 3 * points * sizeof(float);
    const Buffer base(bytes), out(bytes), edited(bytes);
    std::vector<glm::dvec2> parameters;
    PointDepths depths;
    for (std::size_t p = 0; p < points; ++p) {
        const double u = (static_cast<double>(p % across) + 0.5) / side,
                     v = (static_cast<double>(p / across) + 0.5) / side;
        const float at[3] = {static_cast<float>(u), static_cast<float>(v),
                             static_cast<float>(0.2 * std::sin(7 * u) * std::cos(5 * v))};
        std::copy_n(at, 3, &base.as<float>()[3 * p]);
        parameters.push_back({at[0], at[1]});
        depths.w.push_back(at[2]);
        depths.normal.push_back({0, 0, 1});
    }
    const float* from = base.as<float>();
    float* to = out.as<float>();
    const std::vector<OwnCoordinates<double>> own(list.begin(), list.end());
    const std::vector<OwnCoordinates<long double>> exactly(list.begin(), list.end());
    const auto plain = [&] {
        for (std::size_t p = 0; p < points; ++p) {
            glm::dvec3 sum(from[3 * p], from[3 * p + 1], from[3 * p + 2]);
            const double at[3] = {sum.x, sum.y, sum.z};
            for (std::size_t k = 0; k < list.size(); ++k)
                sum += list[k].vector * std::exp(-own[k].squared(at));
            for (int c = 0; c < 3; ++c) to[3 * p + static_cast<std::size_t>(c)] = static_cast<float>(sum[c]);
        }
    };
    std::vector<long double> exact(3 * points);
    for (std::size_t p = 0; p < points; p += kTruthStep) {
        const long double at[3] = {from[3 * p], from[3 * p + 1], from[3 * p + 2]};
        for (std::size_t c = 0; c < 3; ++c) {
            long double& sum = exact[3 * p + c] = at[c];
            for (std::size_t k = 0; k < list.size(); ++k)
                sum += list[k].vector[static_cast<int>(c)] * std::exp(-exactly[k].squared(at));
        }
    }
    const DeformOptions options;
    Edits<DeformedPoints, float> edits(DeformedPoints(parameters, depths, options), list, from,
                                       edited.as<float>());
    DeformedPoints scattered(parameters, depths, options);
    const std::vector<DeformationChange> changes = difference({}, list);
    std::vector<DeformationChange> renewed;  // taken away and added: the surface stays
    for (const DeformationChange& change : changes) renewed.push_back({change.after, change.after});
    scattered.apply(changes);
    scattered.write(from, to);
    const auto drawn = [to](std::size_t k) { return static_cast<double>(to[k]); };
    const std::vector<Contender> contenders = {
        {"double", plain, 1, drawn},
        {"points",
         [&] {
             scattered.apply(renewed);
             scattered.write(from, to);
         },
         2, drawn, scattered.error_bound()},
        {"points_edit", [&] { edits.run(); }, static_cast<double>(list.size())}};
    measure(
        name, side, points, settings, contenders, [&](std::size_t k) { return exact[k]; }, report);
}

/// The loop that one would write first, with normals: those of the plane are (0, 0, 1).
void plain_normals_loop(const std::vector<Deformation>& list, const std::vector<double>& u, const float* base,
                        float* out, float* normals) {
    for (const double v : u)
        for (const double column : u) {
            glm::dvec3 p(base[0], base[1], base[2]), by_u(1, 0, 0), by_v(0, 1, 0);
            for (const Deformation& d : list) {
                const double s = (column - d.center.x) / d.extent.x, t = (v - d.center.y) / d.extent.y,
                             f = std::exp(-s * s - t * t);
                p += d.vector * f;
                by_u += d.vector * (-2 * s / d.extent.x * f);
                by_v += d.vector * (-2 * t / d.extent.y * f);
            }
            const glm::dvec3 normal = glm::normalize(glm::cross(by_u, by_v));
            for (int c = 0; c < 3; ++c) {
                *out++ = static_cast<float>(p[c]);
                *normals++ = static_cast<float>(normal[c]);
            }
            base += 3;
        }
}

/// A surface whose points and normals are drawn.
template <class Surface>
class WithNormals {
  public:
    WithNormals(Surface surface, std::vector<Deformation> list, const float* base, float* out, float* normals)
        : m_undeformed(std::move(surface)),
          m_surface(m_undeformed),
          m_list(std::move(list)),
          m_base(base),
          m_out(out),
          m_normals(normals) {}
    /// All points and normals anew.
    void draw() {
        if constexpr (std::is_same_v<Surface, DeformedPoints>) {
            m_surface.write_with_slopes(m_list, m_base, m_out, turn_normals_to());
        } else {
            m_surface = m_undeformed;
            m_surface.apply(difference({}, m_list));
            m_surface.write(m_base, m_out);
            m_surface.slopes(m_list, nullptr, turn_normals_to());
        }
    }
    /// Changes the last bump, there and back.
    void edit() {
        const Deformation before = m_list.back();
        m_list.back().vector.z *= -1;
        const std::vector<DeformationChange> changes{{before, m_list.back()}};
        m_surface.apply(changes);
        m_surface.update(m_base, m_out);
        m_surface.slopes(m_list, &changes, turn_normals_to());
    }

  private:
    TakeSlopes turn_normals_to() {
        return [this](const SurfaceSlopes& slopes) {
            double normals[3][SurfaceSlopes::kMost] = {};
            std::fill_n(normals[2], slopes.count, 1.0);
            turn_normals(slopes, {1, 0, 0}, {0, 1, 0}, normals);
            for (int k = 0; k < slopes.count; ++k)
                for (int c = 0; c < 3; ++c)
                    m_normals[3 * slopes.point(k) + c] = static_cast<float>(normals[c][k]);
        };
    }

    const Surface m_undeformed;
    Surface m_surface;
    std::vector<Deformation> m_list;
    const float* m_base;
    float *m_out, *m_normals;
};

/// Normals in long double, of every kTruthStep-th point.
std::vector<long double> true_normals(const std::vector<Deformation>& list,
                                      const std::vector<glm::dvec2>& points) {
    using Vector = glm::vec<3, long double>;
    std::vector<long double> exact(3 * points.size());
    for (std::size_t p = 0; p < points.size(); p += kTruthStep) {
        Vector by_u(1, 0, 0), by_v(0, 1, 0);
        for (const Deformation& d : list) {
            const long double s = (points[p].x - static_cast<long double>(d.center.x)) / d.extent.x,
                              t = (points[p].y - static_cast<long double>(d.center.y)) / d.extent.y,
                              f = std::exp(-s * s - t * t);
            by_u += Vector(d.vector) * (-2 * s / d.extent.x * f);
            by_v += Vector(d.vector) * (-2 * t / d.extent.y * f);
        }
        const Vector normal = glm::normalize(glm::cross(by_u, by_v));
        for (int c = 0; c < 3; ++c) exact[3 * p + static_cast<std::size_t>(c)] = normal[c];
    }
    return exact;
}

void run_normals(const Settings& settings, Report& report, const std::string& name, double least_extent,
                 double most_extent) {
    if (!settings.wants_case(name)) return;
    const int side = std::min(settings.size, kMostSide);
    std::vector<Deformation> list = gaussians(1, least_extent, most_extent);
    // Of 4 extents each way: some 16 to 18 columns and rows.
    const double small = 2.2 / side;
    list.push_back({{0, 0, .1 * small}, {.5, .5}, {small, small}});
    std::vector<double> u;
    for (int i = 0; i < side; ++i) u.push_back(static_cast<float>((i + 0.5) / side));
    const std::size_t points = u.size() * u.size(), bytes = 3 * points * sizeof(float);
    const Buffer base(bytes), out(bytes), normals(bytes), edited(bytes), edited_normals(bytes);
    std::vector<glm::dvec2> parameters;
    for (std::size_t p = 0; p < points; ++p) {
        parameters.push_back({u[p % u.size()], u[p / u.size()]});
        base.as<float>()[3 * p] = static_cast<float>(parameters[p].x);
        base.as<float>()[3 * p + 1] = static_cast<float>(parameters[p].y);
        base.as<float>()[3 * p + 2] = 0;
    }
    const std::vector<long double> exact = true_normals(list, parameters);
    WithNormals<DeformedGrid> grid({u, u}, list, base.as<float>(), out.as<float>(), normals.as<float>());
    WithNormals<DeformedPoints> scattered(DeformedPoints(parameters), list, base.as<float>(), out.as<float>(),
                                          normals.as<float>());
    WithNormals<DeformedGrid> grid_edits({u, u}, list, base.as<float>(), edited.as<float>(),
                                         edited_normals.as<float>());
    WithNormals<DeformedPoints> point_edits(DeformedPoints(parameters), list, base.as<float>(),
                                            edited.as<float>(), edited_normals.as<float>());
    grid_edits.draw();
    point_edits.draw();
    const auto drawn = [to = normals.as<float>()](std::size_t k) { return static_cast<double>(to[k]); };
    const std::vector<Contender> contenders = {
        {"double",
         [&] { plain_normals_loop(list, u, base.as<float>(), out.as<float>(), normals.as<float>()); }, 1,
         drawn},
        {"grid", [&] { grid.draw(); }, 1, drawn},
        {"points", [&] { scattered.draw(); }, 1, drawn},
        {"grid_edit", [&] { grid_edits.edit(); }},
        {"points_edit", [&] { point_edits.edit(); }}};
    measure(
        name, side, points, settings, contenders, [&](std::size_t k) { return exact[k]; }, report);
}

void run_blend(const Settings& settings, Report& report) {
    if (!settings.wants_case("blend10")) return;
    const int side = std::min(settings.size, kMostSide);
    const auto points = static_cast<std::size_t>(side) * static_cast<std::size_t>(side), values = 3 * points;
    const std::vector<double> weights = {.3, .2, -.1, .4, .1, .05, .05, .2, -.3, .1};
    const std::size_t count = weights.size(), bytes = values * sizeof(float);
    const Buffer memory(count * bytes), out(bytes), copied((count + 1) * bytes / 2);
    std::mt19937 random(1);
    for (std::size_t i = 0; i < count * values; ++i)
        memory.as<float>()[i] = std::uniform_real_distribution<float>(0, 1)(random);
    std::vector<const float*> shapes;
    for (std::size_t k = 0; k < count; ++k) shapes.push_back(memory.as<float>() + k * values);
    const std::vector<float> mask(points, .5f);
    std::vector<const float*> masks(count, nullptr);
    for (std::size_t k = 0; k < count; k += 2) masks[k] = mask.data();

    float* to = out.as<float>();
    const auto drawn = [to](std::size_t i) { return static_cast<double>(to[i]); };
    const std::vector<Contender> contenders = {
        {"double",
         [&] {
             for (std::size_t i = 0; i < values; ++i) {
                 double sum = 0;
                 for (std::size_t k = 0; k < count; ++k)
                     sum += weights[k] * static_cast<double>(shapes[k][i]);
                 to[i] = static_cast<float>(sum);
             }
         },
         1, drawn},
        {"blend",
         [&] {
             inbetween<float>(shapes, weights, WeightSum::checked, static_cast<std::int64_t>(points), 3, to);
         },
         1, drawn, 0x1p-24},
        {"regions",
         [&] {
             inbetween_from_base<float>(shapes[0], shapes, weights, masks, static_cast<std::int64_t>(points),
                                        3, to);
         }},
        {"memory", [&] { std::memcpy(copied.bytes(), memory.bytes(), (count + 1) * bytes / 2); }}};
    const auto truth = [&](std::size_t i) {
        long double sum = 0;
        for (std::size_t k = 0; k < count; ++k) sum += static_cast<long double>(weights[k]) * shapes[k][i];
        return sum;
    };
    measure("blend10", side, points, settings, contenders, truth, report);
}

void run(const Settings& settings, Report& report) {
    run_list(settings, report, "gaussians_local", .02, .08);
    run_list(settings, report, "gaussians_wide", .1, .3);
    run_normals(settings, report, "normals_local", .02, .08);
    run_normals(settings, report, "normals_wide", .1, .3);
    run_depth(settings, report, "depth", false);
    run_depth(settings, report, "frames", true);
    run_blend(settings, report);
    const auto row = [&](const char* case_name, const char* scheme) {
        return report.find(case_name, scheme);
    };
    report.add_speed_target("deform: 50 local Gaussians, times the plain double loop", 100,
                            row("gaussians_local", "double"), row("gaussians_local", "fixed"));
    report.add_speed_target("deform: 50 wide Gaussians, times the plain double loop", 30,
                            row("gaussians_wide", "double"), row("gaussians_wide", "fixed"));
    report.add_speed_target("deform: one edit of local Gaussians, times recomputing", 15,
                            row("gaussians_local", "fixed"), row("gaussians_local", "edit"));
    report.add_speed_target("deform: one edit of wide Gaussians, times recomputing", 15,
                            row("gaussians_wide", "fixed"), row("gaussians_wide", "edit"));
    report.add_speed_target("deform: points and normals, 50 local Gaussians, times the plain double loop", 5,
                            row("normals_local", "double"), row("normals_local", "grid"));
    report.add_speed_target("deform: points and normals, 50 wide Gaussians, times the plain double loop", 3.3,
                            row("normals_wide", "double"), row("normals_wide", "grid"));
    report.add_speed_target("deform: a blend of 10 shapes, times the plain loop", 1.8,
                            row("blend10", "double"), row("blend10", "blend"));
    report.add_speed_target("deform: a blend of 10 shapes, share of the memory limit", .45,
                            row("blend10", "memory"), row("blend10", "blend"));
}

const RegisterOp registered({"deform", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_deform
