// SPDX-License-Identifier: Apache-2.0
// Mesh warps: speed against error.
//
// Source and picture are square and of one size, three channels, bilinear; `defaults` with the default filter, antialias, from a
// pyramid that is made anew. Cases: a 12 x 12 mesh that pulls
// (in float and in 8 bits), the same with a level more in some cells, the first one pushing, pairs of
// points, and the first one as an ST-map, pixel by pixel. Every scheme draws a fresh picture each time, planning included. `double` is the loop that one
// writes in an afternoon: the patch at every pixel in double, then four texels. Rivals: warp_rivals.h.
//
// Errors are distances of the source points used from the map in pairs of doubles (of the inverse and of points:
// in double), over all pixels that have a point; they come from the blocks and from the rivals' own formulas.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <mutex>
#include <random>

#include "anamorph/image/block_reader.h"
#include "anamorph/image/block_sampler.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_warp.h"
#include "anamorph/mesh/scattered.h"
#include "bench.h"
#include "pixels.h"
#include "warp_rivals.h"

namespace anamorph::bench::op_warp {
namespace {

constexpr double kTols[] = {1, 1.0 / 16, 0.01, 0.001};
constexpr unsigned kSeed = 12;
constexpr int kCells = 12;

using Points = std::vector<Point<double>>;

std::size_t index_of(int x, int y, int width) {
    return static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
}

class Uniform {
  public:
    double operator()(double low, double high) {
        return low + (high - low) * (static_cast<double>(m_random()) / 4294967296.0);
    }

  private:
    std::mt19937 m_random{kSeed};
};

/// Vertices moved by up to 12 % of a cell each way; border vertices stay on the border.
ControlMesh moved_mesh(int size) {
    Uniform uniform;
    ControlMesh mesh;
    mesh.columns = mesh.rows = kCells;
    const double cell = double(size) / kCells;
    const auto moved = [&](int i) {
        return i * cell + (i == 0 || i == kCells ? 0 : uniform(-0.12, 0.12) * cell);
    };
    for (int r = 0; r <= kCells; ++r)
        for (int c = 0; c <= kCells; ++c) {
            const double x = moved(c), y = moved(r);
            mesh.vertices.push_back({x, y});
        }
    return mesh;
}

ControlMesh with_finer_cells(ControlMesh mesh, int size) {
    ControlMesh::Level level;
    for (int r = 4; r < 8; ++r)
        for (int c = 4; c < 8; ++c) level.cells.push_back({c, r});
    Uniform uniform;
    const double cell = 0.5 * size / kCells;
    for (int r = 9; r < 16; ++r)
        for (int c = 9; c < 16; ++c)
            level.vertices.push_back(
                {c, r, {(c + uniform(-0.2, 0.2)) * cell, (r + uniform(-0.2, 0.2)) * cell}});
    mesh.levels.push_back(level);
    return mesh;
}

ControlPoints moved_points(int size) {
    Uniform uniform;
    ControlPoints points;
    for (int i = 0; i < kCells * kCells; ++i) {
        const double x = uniform(0, size), y = uniform(0, size), most = 0.1 * size / kCells;
        points.pairs.push_back({x, y, x + uniform(-most, most), y + uniform(-most, most)});
    }
    return points;
}

/// The map of a mesh as an ST-map of a picture of `size` pixels each way.
WarpMap as_stmap(const ControlMesh& control, int size) {
    const Mesh mesh(control, {size, size}, {size, size}, 1);
    std::vector<float> uv;
    for (int y = 0; y < size; ++y)
        for (int x = 0; x < size; ++x) {
            const Point<double> p = mesh.at(x + 0.5, y + 0.5);
            uv.push_back(static_cast<float>(p.x / size));
            uv.push_back(static_cast<float>(p.y / size));
        }
    return mesh_from_stmap(std::move(uv), size, size, "stmap");
}

/// One case: a map, its truth, and pixels.
struct Scene {
    std::string name;
    WarpMap map;
    PixelType type;
    int size;
    Buffer texels, picture;
    Points truth;

    Scene(std::string case_name, WarpMap warp, PixelType pixel_type, int pixels,
          const ParallelFor& parallel_for)
        : name(std::move(case_name)),
          map(std::move(warp)),
          type(pixel_type),
          size(pixels),
          texels(bytes()),
          picture(bytes()) {
        fill();
        find_truth(parallel_for);
    }

    std::size_t bytes() const {
        return index_of(0, size, size) * 3 * static_cast<std::size_t>(size_of(type));
    }
    ConstImageView source() const {
        return packed_view<const std::byte>(texels.bytes(), type, size, size, 3);
    }
    ImageView target() const { return packed_view(picture.bytes(), type, size, size, 3); }
    Box box() const { return {0, 0, size, size}; }
    Picture warp(const MeshWarpOptions& options) const {
        return warped_picture(map, {size, size}, {size, size}, options);
    }
    const ControlMesh* mesh() const { return std::get_if<ControlMesh>(&map.shape); }
    bool is_stmap() const { return mesh() && mesh()->samples; }
    bool pulls() const { return mesh() && mesh()->direction == Direction::pull && !is_stmap(); }
    Mesh pull_mesh() const { return Mesh(*mesh(), {size, size}, {size, size}, 1); }

  private:
    /// A smooth picture with stripes.
    void fill() const {
        for (int y = 0; y < size; ++y)
            for (int x = 0; x < size; ++x)
                for (std::size_t c = 0; c < 3; ++c) {
                    const float v = 0.5f + 0.3f * std::sin(0.02f * static_cast<float>(x)) +
                                    0.2f * std::sin(0.3f * static_cast<float>(y) + static_cast<float>(c));
                    const std::size_t i = 3 * index_of(x, y, size) + c;
                    if (type == PixelType::float32)
                        texels.as<float>()[i] = v;
                    else
                        texels.as<std::uint8_t>()[i] = static_cast<std::uint8_t>(v * 255);
                }
    }

    void find_truth(const ParallelFor& parallel_for) {
        truth.resize(index_of(0, size, size));
        MeshWarpOptions options;
        options.tol = 0;
        const Picture exact = warp(options);
        parallel_for(size, [&](std::int64_t row) {
            const int y = static_cast<int>(row);
            const std::unique_ptr<Mesh> own = pulls() ? std::make_unique<Mesh>(pull_mesh()) : nullptr;
            for (int x = 0; x < size; ++x) {
                Point<double>& p = truth[index_of(x, y, size)];
                int piece = 0;
                if (own) {
                    const Point<DoubleDouble> q = own->at(own->patch(own->cell_at(x + 0.5, y + 0.5)),
                                                          DoubleDouble(x + 0.5), DoubleDouble(y + 0.5));
                    p = {static_cast<double>(q.x), static_cast<double>(q.y)};
                } else if (!exact.maps[0].blocks->exact(x + 0.5, y + 0.5, 0, p, piece)) {
                    p = {std::nan(""), std::nan("")};
                }
            }
        });
    }
};

/// The points that a warp's blocks lead to.
Points points_of(const Picture& warp, const ParallelFor& parallel_for) {
    const BlockMap& map = *warp.maps[0].blocks;
    Points points(index_of(0, map.height(), map.width()), {std::nan(""), std::nan("")});
    parallel_for(map.regions(), [&](std::int64_t region) {
        for (const Block& b : map.blocks(region))
            for (int y = b.box.y0; y < b.box.y1; ++y) {
                alignas(64) float px[simd::kRowRoom], py[simd::kRowRoom];
                block_row(map, b, b.box, y, px, py);
                for (int i = 0; i < b.box.width() && b.kind != Block::Kind::outside; ++i) {
                    Point<double>& p = points[index_of(b.box.x0 + i, y, map.width())];
                    int piece = 0;
                    if (b.kind == Block::Kind::exact)
                        map.exact(b.box.x0 + i + 0.5, y + 0.5, 0, p, piece);
                    else
                        p = {b.base_x + double{px[i]}, b.base_y + double{py[i]}};
                }
            }
    });
    return points;
}

Accuracy accuracy(const Points& used, const Points& truth) {
    std::vector<float> errors;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (std::isnan(truth[i].x)) continue;
        const double e = std::hypot(used[i].x - truth[i].x, used[i].y - truth[i].y);
        errors.push_back(std::isnan(e) ? std::numeric_limits<float>::infinity() : static_cast<float>(e));
    }
    return accuracy_of(errors);
}

/// The plain loop: each pixel's point in double, then four texels and black beyond the edges.
template <class Texel>
void draw_double(const Scene& scene, const Picture& warp, const ParallelFor& parallel_for) {
    const auto* source = scene.texels.as<Texel>();
    auto* picture = scene.picture.as<Texel>();
    const int n = scene.size;
    parallel_for(n, [&](std::int64_t row) {
        const int y = static_cast<int>(row);
        for (int x = 0; x < n; ++x) {
            Point<double> p{};
            int piece = 0;
            Texel* to = picture + 3 * index_of(x, y, n);
            double sum[3] = {};
            if (warp.maps[0].blocks->exact(x + 0.5, y + 0.5, 0, p, piece)) {
                const double fx = std::floor(p.x - 0.5), fy = std::floor(p.y - 0.5);
                for (int k = 0; k < 4; ++k) {
                    const double tx = fx + (k & 1), ty = fy + (k >> 1);
                    if (!(tx >= 0 && ty >= 0 && tx < n && ty < n)) continue;
                    const double weight = (1 - std::fabs(p.x - 0.5 - tx)) * (1 - std::fabs(p.y - 0.5 - ty));
                    const Texel* from = source + 3 * index_of(static_cast<int>(tx), static_cast<int>(ty), n);
                    for (int c = 0; c < 3; ++c) sum[c] += weight * static_cast<double>(from[c]);
                }
            }
            for (int c = 0; c < 3; ++c) to[c] = static_cast<Texel>(sum[c] + (sizeof(Texel) == 1 ? 0.5 : 0));
        }
    });
}

/// One way to draw a scene.
struct Contender {
    std::string scheme;
    double tol = kNone;
    std::function<void()> draw;
    std::function<Points()> points;
    double bound = kNone, exact_fraction = kNone;
    bool one_tap = true;
};

class Bench {
  public:
    Bench(const Settings& settings, Report& report)
        : m_settings(settings),
          m_report(report),
          m_pool(settings.threads),
          m_all(static_cast<int>(std::max(1u, std::thread::hardware_concurrency()))) {}

    void measure(const std::string& name, const WarpMap& map, PixelType type, bool with_rivals) {
        if (!m_settings.wants_case(name)) return;
        const Scene scene(name, map, type, m_settings.size, m_all.parallel_for());
        std::vector<Contender> contenders;
        const auto add = [&](Contender c) {
            if (m_settings.wants_scheme(c.scheme) || (c.scheme == "double" && !m_settings.efficiency))
                contenders.push_back(std::move(c));
        };
        for (const double tol : kTols) add(ours(scene, WarpScheme::automatic, "automatic", tol));
        add(with_defaults(scene));
        if (scene.pulls())
            for (const double tol : {1.0 / 16, 0.01}) {
                add(ours(scene, WarpScheme::hermite, "hermite", tol));
                add(ours(scene, WarpScheme::residual, "residual", tol));
            }
        add(ours(scene, WarpScheme::exact, "exact", 0));

        MeshWarpOptions exact;
        exact.tol = 0;
        const auto warp = std::make_shared<Picture>(scene.warp(exact));
        add({"double", kNone,
             [this, &scene, warp] {
                 if (scene.type == PixelType::float32)
                     draw_double<float>(scene, *warp, m_pool.parallel_for());
                 else
                     draw_double<std::uint8_t>(scene, *warp, m_pool.parallel_for());
             },
             nullptr, 0, 1});
        const Mesh mesh = scene.pulls() ? scene.pull_mesh() : Mesh(moved_mesh(16), {16, 16}, {16, 16}, 1);
        // A mesh with a vertex for each pixel is more than VTK's grid is asked to hold.
        const auto is_rival = [&](const Rival& r) { return !scene.is_stmap() || r.scheme != "vtk_reslice"; };
        if (with_rivals)
            for (Rival& rival :
                 warp_rivals({&mesh, &scene.truth, scene.source(), scene.target(), m_settings.threads}))
                if (is_rival(rival))
                    add({rival.scheme, kNone, rival.draw,
                         [this, &scene, point = rival.point] { return points_by(scene, point); }});
        add_rows(scene, contenders);
    }

  private:
    Contender ours(const Scene& scene, WarpScheme scheme, const char* name, double tol) {
        MeshWarpOptions options;
        options.scheme = scheme;
        options.tol = tol;
        options.filter = Filter::bilinear;
        Contender c{name, tol,
                    [this, &scene, options] {
                        const MemorySource source(scene.source());
                        scene.warp(options).draw(&source, scene.box(), scene.target(), m_pool.parallel_for());
                    },
                    [this, &scene, options] { return points_of(scene.warp(options), m_all.parallel_for()); }};
        const Reached reached = scene.warp(options).reached(m_all.parallel_for());
        c.bound = reached.max_error;
        c.exact_fraction = reached.exact_fraction;
        return c;
    }

    Contender with_defaults(const Scene& scene) {
        const MeshWarpOptions options;
        Contender c;
        c.scheme = "defaults";
        c.tol = options.tol;
        c.draw = [this, &scene, options] {
            const MemorySource base(scene.source());
            const Pyramid source(base);
            scene.warp(options).draw(&source, scene.box(), scene.target(), m_pool.parallel_for());
        };
        c.points = [this, &scene, options] { return points_of(scene.warp(options), m_all.parallel_for()); };
        const Reached reached = scene.warp(options).reached(m_all.parallel_for());
        c.bound = reached.max_error;
        c.exact_fraction = reached.exact_fraction;
        c.one_tap = false;
        return c;
    }

    Points points_by(const Scene& scene, const std::function<Point<double>(int, int)>& point) const {
        Points points(scene.truth.size());
        for (int y = 0; y < scene.size; ++y)
            for (int x = 0; x < scene.size; ++x) points[index_of(x, y, scene.size)] = point(x, y);
        return points;
    }

    void add_rows(const Scene& scene, const std::vector<Contender>& contenders) {
        std::vector<Timed> timed;
        for (const Contender& c : contenders) timed.push_back({c.draw, m_settings.threads});
        const std::vector<Times> times = time_interleaved(timed, m_settings.rounds);
        double double_time = kNone;
        for (std::size_t i = 0; i < contenders.size(); ++i)
            if (contenders[i].scheme == "double") double_time = times[i].median;
        for (std::size_t i = 0; i < contenders.size(); ++i) {
            const Contender& c = contenders[i];
            const double pixels = double(scene.size) * scene.size;
            Row r;
            r.op = "warp";
            r.case_name = scene.name;
            r.scheme = c.scheme;
            r.tol_px = c.tol;
            r.size = scene.size;
            r.threads = m_settings.threads;
            r.ns_per_px = times[i].median / pixels;
            r.best_ns_per_px = times[i].best / pixels;
            r.sharing = times[i].sharing;
            r.ratio_to_exact = double_time / times[i].median;
            r.bound_px = c.bound;
            r.exact_fraction = c.exact_fraction;
            r.one_tap = c.one_tap;
            r.error =
                c.points && !m_settings.efficiency ? accuracy(c.points(), scene.truth) : Accuracy{0, 0, 0};
            const bool approximates = c.tol > 0 && !m_settings.efficiency;
            if (approximates && !(r.error.max <= r.bound_px && r.bound_px <= c.tol) && r.exact_fraction < 1)
                m_report.failures.push_back(scene.name + ", " + c.scheme + ", tol " + std::to_string(c.tol) +
                                            ": the bound or the tolerance is broken");
            m_report.add(r);
        }
    }

    const Settings& m_settings;
    Report& m_report;
    Pool m_pool, m_all;
};

void run(const Settings& settings, Report& report) {
    Bench bench(settings, report);
    const ControlMesh mesh = moved_mesh(settings.size);
    ControlMesh push = mesh;
    push.direction = Direction::push;
    bench.measure("mesh_12", {"mesh_12", mesh}, PixelType::float32, true);
    bench.measure("mesh_12_u8", {"mesh_12", mesh}, PixelType::uint8, true);
    bench.measure("mesh_12_plus_1", {"mesh", with_finer_cells(mesh, settings.size)}, PixelType::float32,
                  false);
    bench.measure("mesh_12_push", {"mesh", push}, PixelType::float32, false);
    bench.measure("points_144", {"points", moved_points(settings.size)}, PixelType::float32, false);
    bench.measure("stmap_step_1", as_stmap(mesh, settings.size), PixelType::float32, true);
    const Row* stmap = report.find("stmap_step_1", "automatic", 0.01);
    report.add_speed_target("warp stmap_step_1: x OpenCV remap, map given", 1 / 1.2,
                            report.find("stmap_step_1", "opencv_remap"), stmap);
    report.add_speed_target("warp stmap_step_1: x st_warp, triangle, map given", 1,
                            report.find("stmap_step_1", "oiio_st_warp"), stmap);
    for (const std::string name : {"mesh_12", "mesh_12_u8"}) {
        const Row* own = report.find(name, "automatic", 1.0 / 16);
        const auto target = [&](double wanted, const char* scheme, const char* whom) {
            report.add_speed_target("warp " + name + ", tol 1/16: x " + whom, wanted,
                                    report.find(name, scheme), own);
        };
        target(60, "vtk_reslice", "vtkImageReslice, cubic vtkGridTransform");
        target(50, "oiio_st_warp", "st_warp, triangle, map given");
        target(1.3, "opencv_remap", "OpenCV remap, map given");
        report.add_speed_target("warp " + name + ": bilinear's time over that of the default filter", 1 / 1.5,
                                report.find(name, "automatic", 0.01), report.find(name, "defaults"));
    }
}

const RegisterOp registered({"warp", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_warp
