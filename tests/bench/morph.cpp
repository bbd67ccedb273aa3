// SPDX-License-Identifier: Apache-2.0
// Feature morphs: speed against error.
//
// Coordinates: the source points of both maps of a morph at t = 0.5, p = 0.5, on a square picture with seeded
// line pairs of six families (feature_families.h); cases are called FAMILY_aA_bB. automatic: near/far, with
// planning and proof, a fresh plan each time. simd_exact: every line at every pixel, with the same loops as
// near/far uses for near lines. simd_double: the same in vectors of doubles. double: the plain loop over
// FeatureMap. Case 256_lines is larger, and down to tol 0. Cases short_N and outside_N: N lines on 512 x 512.
//
// Case paper: Kim's experiment (2003, 6.3), 32 lines on 600 x 600: mesh_12 and mesh_12_plus_1 evaluate the
// map at the vertices of 12 x 12 cells, cut once more near the lines for the latter.
//
// Case 256_drawn: that morph drawn from two pictures of float RGB: automatic is bilinear, `defaults` has the default filter,
// antialias, from pyramids that are made anew.
//
// Case frame: whole morphed pictures, RGB8; xmorph's `morph` where it is installed, the time of its process
// less that of the same run without warping.
//
// Errors are distances from FeatureMap in double, over all pixels of both maps.
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "../core/each_feature_block.h"
#include "../core/feature_families.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/morph/feature_rows.h"
#include "anamorph/morph/morph.h"
#include "anamorph/morph/near_far.h"
#include "anamorph/morph/near_far_kernels.h"
#include "anamorph/morph/near_far_line.h"
#include "bench.h"
#include "feature_mesh.h"
#include "pixels.h"

namespace anamorph::bench::op_morph {
namespace {

constexpr unsigned kSeed = 5;
constexpr double kTols[] = {0.1, 1.0 / 16, 0.01, 0.005, 0.001};
constexpr int kPaperSize = 600, kPaperLines = 32;

/// Points of both maps, pixel by pixel.
using MapPoints = std::vector<Point<double>>;

struct Scene {
    std::string name;
    std::shared_ptr<const Features> features;
    FeatureMap map;

    Scene(std::string case_name, std::shared_ptr<const Features> lines, int size, const LineWeights& weights)
        : name(std::move(case_name)),
          features(std::move(lines)),
          map(*features, {{size, size}, {size, size}}, {size, size}, {0.5, 0.5}, weights) {}
    int size() const { return map.target().width; }
    std::size_t pixels() const { return static_cast<std::size_t>(size()) * static_cast<std::size_t>(size()); }
};

/// Evaluates both maps at every pixel, those of exact blocks in double.
void evaluate(const FeatureBlocks& blocks, const ParallelFor& parallel_for) {
    parallel_for(blocks.regions(), [&](std::int64_t region) {
        PointsInDouble exact;
        each_feature_block(blocks, region, [&](int, const Block& block, const BlockPoints& points) {
            if (!points.x) exact.read(blocks, block, 0, block.box.height());
        });
    });
}

MapPoints points_of(const FeatureBlocks& blocks, const Scene& scene, const ParallelFor& parallel_for) {
    MapPoints points(2 * scene.pixels());
    parallel_for(blocks.regions(), [&](std::int64_t region) {
        PointsInDouble exact;
        each_feature_block(blocks, region, [&](int k, const Block& block, const BlockPoints& at) {
            if (!at.x) exact.read(blocks, block, 0, block.box.height());
            for (int y = block.box.y0; y < block.box.y1; ++y)
                for (int x = block.box.x0; x < block.box.x1; ++x) {
                    const std::ptrdiff_t i = (y - block.box.y0) * at.row_stride + x - block.box.x0;
                    points[static_cast<std::size_t>(k) * scene.pixels() +
                           static_cast<std::size_t>(y * scene.size() + x)] =
                        at.x ? Point<double>{block.base_x + double(at.x[i]), block.base_y + double(at.y[i])}
                             : exact.at(x - block.box.x0, y - block.box.y0);
                }
        });
    });
    return points;
}

MapPoints true_points(const Scene& scene, const ParallelFor& parallel_for) {
    MapPoints points(2 * scene.pixels());
    parallel_for(scene.size(), [&](std::int64_t y) {
        for (int x = 0; x < scene.size(); ++x) {
            Point<double> both[2];
            scene.map.all(x + 0.5, static_cast<double>(y) + 0.5, both);
            const auto i = static_cast<std::size_t>(y * scene.size() + x);
            points[i] = both[0];
            points[scene.pixels() + i] = both[1];
        }
    });
    return points;
}

Accuracy accuracy(const MapPoints& points, const MapPoints& truth) {
    std::vector<float> errors;
    for (std::size_t i = 0; i < truth.size(); ++i)
        errors.push_back(static_cast<float>(std::hypot(points[i].x - truth[i].x, points[i].y - truth[i].y)));
    return accuracy_of(errors);
}

/// The rival: all lines at every pixel, in vectors of floats, on blocks of 64 x 64 pixels.
class SimdExact {
  public:
    explicit SimdExact(const Scene& scene) : m_scene(scene), m_middle(0.5 * scene.size()) {
        const FeatureMap& map = scene.map;
        const double origin[4] = {};
        for (std::size_t i = 0; i < map.size(); ++i)
            m_lines.push_back(seen_from(map, i, {0, 1}, m_middle, m_middle, origin, 1));
    }

    /// body(box, four rows of planes) for every block.
    template <class Body>
    void run(const ParallelFor& parallel_for, const Body& body) const {
        const int size = m_scene.size(), rows = (size + kSide - 1) / kSide;
        const LineWeights& w = m_scene.map.weights();
        parallel_for(rows, [&](std::int64_t row) {
            std::vector<float> planes(4 * kPlane);
            for (int x = 0; x < size; x += kSide) {
                const int y = static_cast<int>(row) * kSide;
                const Box box{x, y, std::min(x + kSide, size), std::min(y + kSide, size)};
                const simd::FieldCell cell{{0, 0, 1},
                                           0,
                                           nullptr,
                                           m_lines.data(),
                                           static_cast<int>(m_lines.size()),
                                           {static_cast<float>(w.a), static_cast<float>(w.b)}};
                simd::FieldOutput out{};
                out.x = static_cast<float>(x + 0.5 - m_middle);
                out.y = static_cast<float>(y + 0.5 - m_middle);
                out.width = box.width();
                out.height = box.height();
                out.components = 4;
                out.stride = kStride;
                for (int c = 0; c < 4; ++c) {
                    out.slope[c] = 1;
                    out.offset[c] = static_cast<float>(m_middle);
                    out.to[c] = planes.data() + c * kPlane;
                }
                simd::field_points(cell, out);
                body(box, planes.data());
            }
        });
    }

    MapPoints points(const ParallelFor& parallel_for) const {
        MapPoints points(2 * m_scene.pixels());
        run(parallel_for, [&](const Box& box, const float* planes) {
            for (std::size_t k = 0; k < 2; ++k)
                for (int y = box.y0; y < box.y1; ++y)
                    for (int x = box.x0; x < box.x1; ++x) {
                        const float* at = planes + 2 * k * kPlane + (y - box.y0) * kStride + (x - box.x0);
                        points[k * m_scene.pixels() + static_cast<std::size_t>(y * m_scene.size() + x)] = {
                            double(at[0]), double(at[kPlane])};
                    }
        });
        return points;
    }

  private:
    static constexpr int kSide = 64, kStride = kSide + 16;
    static constexpr std::ptrdiff_t kPlane = kSide * kStride;
    const Scene& m_scene;
    double m_middle;
    std::vector<simd::FieldLine> m_lines;
};

/// The rival where floats are too coarse: all lines at every pixel, in vectors of doubles.
template <class Body>
void each_double_row(const Scene& scene, const ParallelFor& parallel_for, const Body& body) {
    parallel_for(scene.size(), [&](std::int64_t row) {
        const auto room = static_cast<std::size_t>(scene.size() + 16);
        std::vector<double> x[2], y[2];
        simd::FeatureRow rows[2];
        for (int shape = 0; shape < 2; ++shape) {
            x[shape].resize(room);
            y[shape].resize(room);
            rows[shape] = {shape, x[shape].data(), y[shape].data()};
        }
        simd::feature_rows(scene.map, rows, 0.5, static_cast<double>(row) + 0.5, scene.size());
        for (int shape = 0; shape < 2; ++shape) body(shape, row, x[shape], y[shape]);
    });
}

MapPoints double_points(const Scene& scene, const ParallelFor& parallel_for) {
    MapPoints points(2 * scene.pixels());
    each_double_row(scene, parallel_for, [&](int shape, std::int64_t row, const auto& x, const auto& y) {
        const auto first =
            static_cast<std::size_t>(shape) * scene.pixels() + static_cast<std::size_t>(row * scene.size());
        for (std::size_t i = 0; i < static_cast<std::size_t>(scene.size()); ++i)
            points[first + i] = {x[i], y[i]};
    });
    return points;
}

struct Contender {
    std::string scheme;
    double tol = kNone;
    std::function<void()> draw;
    std::function<MapPoints()> points;
    double bound = kNone, exact_fraction = kNone;
};

class Bench {
  public:
    Bench(const Settings& settings, Report& report)
        : m_settings(settings),
          m_report(report),
          m_pool(settings.threads),
          m_all(static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))) {}

    const Settings& settings() const { return m_settings; }
    Report& report() { return m_report; }
    ParallelFor threads() { return m_pool.parallel_for(); }

    void measure(const Scene& scene, const std::vector<double>& tols, bool with_double, bool with_mesh) {
        std::vector<Contender> contenders;
        const auto add = [&](Contender c) {
            if (m_settings.wants_scheme(c.scheme) || (c.scheme == "double" && !m_settings.efficiency))
                contenders.push_back(std::move(c));
        };
        const ParallelFor all = m_all.parallel_for(), pool = threads();
        if (with_double) add({"double", kNone, [&scene, pool] { true_points(scene, pool); }, nullptr, 0, 1});
        const auto rival = std::make_shared<SimdExact>(scene);
        add({"simd_exact", kNone, [rival, pool] { rival->run(pool, [](const Box&, const float*) {}); },
             [rival, all] { return rival->points(all); }, kNone, 1});
        add({"simd_double", kNone,
             [&scene, pool] {
                 each_double_row(scene, pool, [](int, std::int64_t, const auto&, const auto&) {});
             },
             [&scene, all] { return double_points(scene, all); }, kNone, 1});
        for (const double tol : tols) {
            Contender c{"automatic", tol,
                        [&scene, pool, tol] {
                            evaluate(NearFar(scene.map, {tol, {0, 1}}), pool);
                        },
                        [&scene, all, tol] {
                            return points_of(NearFar(scene.map, {tol, {0, 1}}), scene, all);
                        }};
            const Reached reached = NearFar(scene.map, {tol, {0, 1}}).reached(serial_for);
            c.bound = reached.max_error;
            c.exact_fraction = reached.exact_fraction;
            add(std::move(c));
        }
        for (int levels = 0; with_mesh && levels < 2; ++levels) {
            const auto make = [&scene, levels] { return FeatureMesh(scene.map, 12, levels, {0, 1}); };
            std::printf("%s: mesh of 12 x 12 cells, %d level(s) deeper near the lines: %lld evaluations\n",
                        scene.name.c_str(), levels, static_cast<long long>(make().evaluations()));
            add({levels ? "mesh_12_plus_1" : "mesh_12", kNone, [make, pool] { evaluate(make(), pool); },
                 [make, &scene, all] { return points_of(make(), scene, all); },
                 std::numeric_limits<double>::infinity(), 0});
        }
        add_rows(scene, contenders, m_settings.efficiency ? MapPoints() : true_points(scene, all));
    }

    /// Near/far's time and bound.
    void measure_alone(const Scene& scene, double tol) {
        const ParallelFor pool = threads();
        const std::vector<Times> times =
            time_interleaved({{[&] {
                                   evaluate(NearFar(scene.map, {tol, {0, 1}}), pool);
                               },
                               m_settings.threads}},
                             m_settings.rounds);
        Row r = row(scene.name, scene.size(), "automatic", times[0], kNone);
        const Reached reached = NearFar(scene.map, {tol, {0, 1}}).reached(serial_for);
        r.tol_px = tol;
        r.bound_px = reached.max_error;
        r.exact_fraction = reached.exact_fraction;
        m_report.add(r);
    }

    Row row(const std::string& name, int size, const std::string& scheme, const Times& times,
            double double_time) const {
        const double pixels = double(size) * size;
        Row r;
        r.op = "morph";
        r.case_name = name;
        r.scheme = scheme;
        r.size = size;
        r.threads = m_settings.threads;
        r.ns_per_px = times.median / pixels;
        r.best_ns_per_px = times.best / pixels;
        r.sharing = times.sharing;
        r.ratio_to_exact = double_time / times.median;
        return r;
    }

  private:
    void add_rows(const Scene& scene, const std::vector<Contender>& contenders, const MapPoints& truth) {
        std::vector<Timed> timed;
        for (const Contender& c : contenders) timed.push_back({c.draw, m_settings.threads});
        const std::vector<Times> times = time_interleaved(timed, m_settings.rounds);
        double double_time = kNone;
        for (std::size_t i = 0; i < contenders.size(); ++i)
            if (contenders[i].scheme == "double") double_time = times[i].median;
        for (std::size_t i = 0; i < contenders.size(); ++i) {
            const Contender& c = contenders[i];
            Row r = row(scene.name, scene.size(), c.scheme, times[i], double_time);
            r.tol_px = c.tol;
            r.bound_px = c.bound;
            r.exact_fraction = c.exact_fraction;
            r.error = c.points && !m_settings.efficiency ? accuracy(c.points(), truth) : Accuracy{0, 0, 0};
            if (c.scheme == "automatic" && !m_settings.efficiency &&
                !(r.error.max <= r.bound_px && (c.tol == 0 || r.bound_px <= c.tol)))
                m_report.failures.push_back(scene.name + ", tol " + std::to_string(c.tol) +
                                            ": the bound or the tolerance is broken");
            m_report.add(r);
        }
    }

    const Settings& m_settings;
    Report& m_report;
    Pool m_pool, m_all;
};

std::string number(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%g", value);
    return text;
}

// --- the families

void run_families(Bench& bench) {
    const int size = std::min(kPaperSize, bench.settings().size);
    for (const std::string& family : families::names()) {
        std::vector<std::string> cases;
        for (const double a : {2.0, 1.0, 0.1, 0.01})
            for (const double b : {0.5, 1.0, 2.0}) {
                const std::string name = family + "_a" + number(a) + "_b" + number(b);
                if (!bench.settings().wants_case(name)) continue;
                const Scene scene(name, families::Maker(size, kSeed).make(family, kPaperLines), size,
                                  {a, b, 0.5});
                bench.measure(scene, {std::begin(kTols), std::end(kTols)}, a == 1, false);
                cases.push_back(name);
            }
        for (const auto& [tol, wanted] : {std::pair{0.1, 6.0}, {0.005, 4.0}}) {
            // The worst of all a and b.
            const Row *slow = nullptr, *fast = nullptr;
            for (const std::string& name : cases) {
                const Row* s = bench.report().find(name, "simd_exact");
                const Row* f = bench.report().find(name, "automatic", tol);
                if (s && f && (!slow || s->ns_per_px / f->ns_per_px < slow->ns_per_px / fast->ns_per_px)) {
                    slow = s;
                    fast = f;
                }
            }
            bench.report().add_speed_target(
                family + ": times the exact SIMD scheme at " + number(tol) + " px, least over a and b",
                wanted, slow, fast);
        }
    }
}

void run_many_lines(Bench& bench) {
    const std::string name = "256_lines";
    if (!bench.settings().wants_case(name)) return;
    const int size = std::min(2048, bench.settings().size);
    const Scene scene(name, families::Maker(size, kSeed).make("random", 256), size, {1, 2, 0.5});
    bench.measure(scene, {0.01, 0.001, 1e-4, 1e-5, 1e-6, 0}, false, false);
    bench.report().add_speed_target("256 lines: times the exact SIMD scheme at 0.01 px", 12,
                                    bench.report().find(name, "simd_exact"),
                                    bench.report().find(name, "automatic", 0.01));
    bench.report().add_speed_target("256 lines: times the exact SIMD scheme at 0.001 px", 1,
                                    bench.report().find(name, "simd_exact"),
                                    bench.report().find(name, "automatic", 0.001));
}

/// Whole pictures of the same morph, with the default filter beside bilinear.
void run_drawn(Bench& bench) {
    const std::string name = "256_drawn";
    if (!bench.settings().wants_case(name)) return;
    const int size = std::min(2048, bench.settings().size);
    const auto features = families::Maker(size, kSeed).make("random", 256);
    const std::vector<Size> sizes(2, {size, size});
    std::vector<float> values[3];
    for (std::vector<float>& v : values)
        for (std::size_t i = 0; i < 3 * static_cast<std::size_t>(size) * static_cast<std::size_t>(size); ++i)
            v.push_back(0.5f + 0.4f * std::sin(0.001f * static_cast<float>(i % 6151)));
    const auto view_of = [&](std::vector<float>& v) {
        return packed_view(reinterpret_cast<std::byte*>(v.data()), PixelType::float32, size, size, 3);
    };
    const auto source_of = [&](std::vector<float>& v) {
        return packed_view(reinterpret_cast<const std::byte*>(v.data()), PixelType::float32, size, size, 3);
    };
    const MemorySource a(source_of(values[0])), b(source_of(values[1]));
    const ImageView to = view_of(values[2]);
    MorphOptions bilinear;
    bilinear.filter = Filter::bilinear;
    const std::vector<Times> times =
        time_interleaved({{[&] {
                               morphed_picture(features, sizes, {size, size}, bilinear)
                                   .draw({&a, &b}, {0, 0, size, size}, to, bench.threads());
                           },
                           bench.settings().threads},
                          {[&] {
                               const Pyramid first(a), second(b);
                               morphed_picture(features, sizes, {size, size}, {})
                                   .draw({&first, &second}, {0, 0, size, size}, to, bench.threads());
                           },
                           bench.settings().threads}},
                         bench.settings().rounds);
    const char* const schemes[] = {"automatic", "defaults"};
    for (std::size_t i = 0; i < 2; ++i) {
        if (!bench.settings().wants_scheme(schemes[i])) continue;
        Row r = bench.row(name, size, schemes[i], times[i], kNone);
        r.tol_px = bilinear.tol;
        r.one_tap = i == 0;
        bench.report().add(r);
    }
    bench.report().add_speed_target("256 lines: bilinear's time over that of the default filter", 1 / 1.8,
                                    bench.report().find(name, "automatic"),
                                    bench.report().find(name, "defaults"));
}

/// How time grows with lines: near/far alone, since a loop over all of them takes too long.
void run_short_lines(Bench& bench) {
    const int size = std::min(512, bench.settings().size);
    for (const std::string family : {"short", "outside"})
        for (const int count : {1000, 10000, 100000}) {
            const std::string name = family + "_" + std::to_string(count);
            if (!bench.settings().wants_case(name)) continue;
            const Scene scene(name, families::Maker(size, kSeed).make(family, count), size, {1, 2, 0.5});
            bench.measure_alone(scene, 0.01);
        }
}

void run_paper(Bench& bench) {
    const std::string name = "paper";
    if (!bench.settings().wants_case(name)) return;
    const int size = std::min(kPaperSize, bench.settings().size);
    const Scene scene(name, families::Maker(size, kSeed).make("face", kPaperLines), size, {1, 2, 0.5});
    bench.measure(scene, {0.1, 0.005}, true, true);
}

// --- whole frames

/// A picture of 8-bit noise in a TGA file (type 2, 24 bits, from the top).
void write_tga(const std::filesystem::path& path, int size, const std::vector<std::uint8_t>& rgb) {
    std::ofstream file(path, std::ios::binary);
    const auto low = [](int v) { return static_cast<char>(v & 255); };
    const char head[18] = {
        0, 0, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, low(size), low(size >> 8), low(size), low(size >> 8), 24, 32};
    file.write(head, sizeof head);
    file.write(reinterpret_cast<const char*>(rgb.data()), static_cast<std::streamsize>(rgb.size()));
}

/// Processor time of programs that were waited for, ns.
double children_ns() {
    rusage usage{};
    getrusage(RUSAGE_CHILDREN, &usage);
    return 1e9 * static_cast<double>(usage.ru_utime.tv_sec) +
           1e3 * static_cast<double>(usage.ru_utime.tv_usec);
}

/// The time that xmorph's `morph` takes to warp and dissolve, or NaN.
Times time_xmorph(int size, const std::vector<std::uint8_t>& a, const std::vector<std::uint8_t>& b,
                  int rounds) {
    if (std::system("command -v morph > /dev/null 2>&1") != 0) return {kNone, kNone};
    const std::filesystem::path dir =
        std::filesystem::temp_directory_path() / ("anamorph_bench_" + std::to_string(getpid()));
    std::filesystem::create_directories(dir);
    write_tga(dir / "a.tga", size, a);
    write_tga(dir / "b.tga", size, b);
    const std::string command =
        "cd '" + dir.string() + "' && morph -start a.tga -finish b.tga -mt .5 -dt .5 -out out.tga";
    std::vector<double> times;
    for (int i = 0; i < std::max(3, rounds / 3); ++i) {
        const auto once = [&](const std::string& options) {
            const double start = children_ns();
            const bool ran = std::system((command + options + " > /dev/null 2>&1").c_str()) == 0;
            return ran ? children_ns() - start : kNone;
        };
        times.push_back(once("") - once(" -skip_warp"));
    }
    std::filesystem::remove_all(dir);
    std::sort(times.begin(), times.end());
    return {times[times.size() / 2], times.front()};
}

void run_frame(Bench& bench) {
    const std::string name = "frame";
    if (!bench.settings().wants_case(name)) return;
    const int size = std::min(kPaperSize, bench.settings().size);
    const Scene scene(name, families::Maker(size, kSeed).make("face", kPaperLines), size, {1, 2, 0.5});
    const auto picture = [&](std::uint32_t seed) {
        std::vector<std::uint8_t> rgb(3 * scene.pixels());
        for (std::uint8_t& v : rgb) v = static_cast<std::uint8_t>((seed = seed * 1664525 + 1013904223) >> 24);
        return rgb;
    };
    const std::vector<std::uint8_t> a = picture(1), b = picture(2);
    std::vector<std::uint8_t> out(a.size());
    const auto view_of = [&](const std::vector<std::uint8_t>& rgb) {
        return packed_view(reinterpret_cast<const std::byte*>(rgb.data()), PixelType::uint8, size, size, 3);
    };
    const MemorySource source_a(view_of(a)), source_b(view_of(b));
    const ImageView to =
        packed_view(reinterpret_cast<std::byte*>(out.data()), PixelType::uint8, size, size, 3);
    const std::vector<Size> sizes(2, {size, size});

    struct Frame {
        const char* scheme;
        MorphOptions options;
    };
    std::vector<Frame> frames;
    for (const double tol : {0.1, 0.01}) {
        Frame f{"automatic", {}};
        f.options.tol = tol;
        frames.push_back(f);
    }
    frames.push_back({"exact", {}});
    frames.back().options.scheme = MorphScheme::exact;
    std::vector<Timed> timed;
    for (Frame& f : frames) {
        f.options.filter = Filter::bilinear;
        timed.push_back({[&, f] {
                             morphed_picture(scene.features, sizes, {size, size}, f.options)
                                 .draw({&source_a, &source_b}, {0, 0, size, size}, to, bench.threads());
                         },
                         bench.settings().threads});
    }
    const std::vector<Times> times = time_interleaved(timed, bench.settings().rounds);
    for (std::size_t i = 0; i < frames.size(); ++i) {
        if (!bench.settings().wants_scheme(frames[i].scheme)) continue;
        Row r = bench.row(name, size, frames[i].scheme, times[i], times.back().median);
        r.tol_px = frames[i].options.scheme == MorphScheme::automatic ? frames[i].options.tol : kNone;
        bench.report().add(r);
    }
    if (!bench.settings().wants_scheme("xmorph")) return;
    const Times xmorph = time_xmorph(size, a, b, bench.settings().rounds);
    if (std::isnan(xmorph.median)) return;
    bench.report().add(bench.row(name, size, "xmorph", xmorph, times.back().median));
    bench.report().add_speed_target("a whole frame: times xmorph's morph", 25,
                                    bench.report().find(name, "xmorph"),
                                    bench.report().find(name, "automatic", 0.01));
}

void run(const Settings& settings, Report& report) {
    std::printf("morph: seed %u\n", kSeed);
    Bench bench(settings, report);
    run_families(bench);
    run_many_lines(bench);
    run_drawn(bench);
    run_short_lines(bench);
    run_paper(bench);
    run_frame(bench);
}

const RegisterOp registered({"morph", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_morph
