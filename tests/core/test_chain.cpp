// SPDX-License-Identifier: Apache-2.0
// Pictures of pictures drawn by one resampling: every pixel against the maps written out in long double, one after the
// other, and what is lost of a picture that is drawn several times and once.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <memory>
#include <numbers>
#include <random>
#include <vector>

#include "anamorph/chain/joined.h"
#include "anamorph/chain/middle_edges.h"
#include "anamorph/formula/text_plan.h"
#include "anamorph/image/pixel.h"
#include "anamorph/lens/lens_plan.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_warp.h"
#include "anamorph/mesh/scattered.h"
#include "anamorph/panorama/reproject.h"
#include "block_points.h"
#include "mesh_cases.h"
#include "panorama_oracle.h"
#include "warp_oracles.h"

namespace anamorph::test_chain {
namespace {

using oracle::View;
using Real = long double;
using Truth = std::function<Point<Real>(const Point<Real>&)>;

constexpr Real kNone = std::numeric_limits<Real>::quiet_NaN();

/// One picture of a chain, and its map as the oracles have it; no number where there is no source point.
struct Link {
    Picture picture;
    Truth truth;
    bool closes = false;  ///< does its source close on itself?

    Size size() const { return {picture.width(), picture.height()}; }
};

/// What is shared by the links of a chain.
struct Settings {
    double tol = 0.01;
    Scheme scheme = Scheme::automatic;
    Filter filter = Filter::antialias;
};

PlanOptions plan_of(const Settings& settings) {
    PlanOptions options;
    options.tol = settings.tol;
    options.scheme = settings.scheme;
    return options;
}

Border flat_border(const Size& source) {
    return Border(Chart(Projection::rectilinear, source.width, source.height), Wrap::automatic);
}

Link lens_link(const std::string& lens, LensMode mode, const Size& size, const Size& target,
               const Settings& settings) {
    const View view = oracle::view_through(lens, size, 80);
    const Chart chart = oracle::chart_of(view);
    const std::vector<double> values = chart.lens()->model().values;
    const Point<Real> centre{values[values.size() - 2], values.back()};
    const auto plan =
        std::make_shared<const LensPlan>(LensMap(chart, mode, target, target, size), plan_of(settings));
    const auto truth = [view, mode, size, target, centre](const Point<Real>& p) -> Point<Real> {
        const Real dx = Real(size.width - target.width) / 2, dy = Real(size.height - target.height) / 2;
        const oracle::LensOracle& of = oracle::lens_of(view);
        if (mode == LensMode::undistort) return of.observed(view, {p.x + dx - centre.x, p.y + dy - centre.y});
        const Point<Real> q = of.ideal(view, {p.x + dx, p.y + dy});
        return {q.x + centre.x, q.y + centre.y};
    };
    return {picture_through(plan, flat_border(size), settings.filter, Output::color), truth};
}

Link pano_link(const View& source, const View& target, const Orientation& look, const Settings& settings) {
    ReprojectOptions options;
    options.tol = settings.tol;
    options.scheme = settings.scheme;
    options.filter = settings.filter;
    const Chart chart = oracle::chart_of(source);
    const auto truth = [source, target, look](const Point<Real>& p) -> Point<Real> {
        oracle::Vector ray{};
        if (!oracle::ray_of(target, oracle::chart_of(target).pieces()[0], p.x, p.y, ray))
            return {kNone, kNone};
        return oracle::point_of(source, oracle::chart_of(source).pieces()[0], oracle::rotated(ray, look));
    };
    return {reprojected_picture(Panorama(chart, oracle::chart_of(target), look), options), truth,
            chart.closed()};
}

/// A picture of the faces of a cube, which its reader takes for a flat one.
Link faces_link(const View& source, const View& faces, const Orientation& look, const Settings& settings) {
    Link link = pano_link(source, faces, look, settings);
    link.truth = [source, faces, look](const Point<Real>& p) -> Point<Real> {
        const Chart chart = oracle::chart_of(faces);
        for (const Piece& face : chart.pieces()) {
            const Box& box = face.box;
            oracle::Vector ray{};
            if (p.x >= box.x0 && p.x <= box.x1 && p.y >= box.y0 && p.y <= box.y1 &&
                oracle::ray_of(faces, face, p.x, p.y, ray))
                return oracle::point_of(source, oracle::chart_of(source).pieces()[0],
                                        oracle::rotated(ray, look));
        }
        return {kNone, kNone};
    };
    return link;
}

Link mesh_link(unsigned seed, int cells, int levels, const Size& source, const Size& target,
               const Settings& settings) {
    test::Random random(seed);
    const ControlMesh mesh = test::random_mesh(random, target, source, cells, cells, 0.3, levels == 0, 0);
    MeshWarpOptions options;
    options.tol = settings.tol;
    options.scheme = settings.scheme == Scheme::exact ? WarpScheme::exact : WarpScheme::automatic;
    options.filter = settings.filter;
    const auto truth = [oracle = std::make_shared<test::MeshOracle>(mesh, target, source, 1)](
                           const Point<Real>& p) { return (*oracle)(p.x, p.y); };
    return {warped_picture(WarpMap{"mesh", mesh}, source, target, options), truth};
}

/// A twirl about the middle, as text.
Link twirl_link(const Size& size, const Settings& settings) {
    FormulaText text;
    text.let = "w=0.8*exp(-2*r^2)";
    text.u = "width/2+height/2*r*cos(a+w)";
    text.v = "height/2-height/2*r*sin(a+w)";
    const PlaneFormula formula = parse_formula(text, {size, size});
    const auto plan = std::make_shared<const TextPlan>(TextMap(formula, size, size, size), plan_of(settings));
    const auto truth = [size](const Point<Real>& p) -> Point<Real> {
        const Real half = Real(size.height) / 2, x = (p.x - Real(size.width) / 2) / half,
                   y = (p.y - half) / half, w = Real(0.8L) * std::exp(-2 * (x * x + y * y)), c = std::cos(w),
                   s = std::sin(w);
        // Turned by w against the clock, y down.
        return {Real(size.width) / 2 + half * (x * c + y * s), half + half * (y * c - x * s)};
    };
    return {picture_through(plan, flat_border(size), settings.filter, Output::color), truth};
}

/// Waves of 50 pixels, as text.
Link waves_link(const Size& size, const Settings& settings) {
    FormulaText text;
    text.u = "x+3*sin(y/8)";
    text.v = "y+3*sin(x/8)";
    const PlaneFormula formula = parse_formula(text, {size, size});
    const auto plan = std::make_shared<const TextPlan>(TextMap(formula, size, size, size), plan_of(settings));
    const auto truth = [](const Point<Real>& p) -> Point<Real> {
        return {p.x + 3 * std::sin(p.y / 8), p.y + 3 * std::sin(p.x / 8)};
    };
    return {picture_through(plan, flat_border(size), settings.filter, Output::color), truth};
}

/// How an ST-map is made.
struct StMapCase {
    double noise = 0;  ///< pixels
    bool v_up = false;
    bool has_holes = false;
    double amount = 1;
    double spikes = 0;  ///< pixels; of one sample in 128 each way
};

/// A smooth ST-map as large as its picture, read pixel for pixel.
Link stmap_link(const Size& size, const Size& source, const StMapCase& how, const Settings& settings) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> noise(-how.noise, how.noise);
    std::vector<float> uv;
    ControlMesh exact;
    exact.columns = size.width - 1, exact.rows = size.height - 1;
    exact.units = Units::fractions;
    for (int i = 0; i < size.width; ++i) exact.x_lines.push_back((i + 0.5) / size.width);
    for (int j = 0; j < size.height; ++j) exact.y_lines.push_back((j + 0.5) / size.height);
    for (int j = 0; j < size.height; ++j)
        for (int i = 0; i < size.width; ++i) {
            const double x = (i + 0.5) / size.width, y = (j + 0.5) / size.height;
            auto u =
                static_cast<float>(0.05 + 0.9 * x + 0.04 * std::sin(4 * y) + noise(random) / source.width);
            auto v = static_cast<float>(0.04 + 0.9 * y - 0.05 * x * y + noise(random) / source.height);
            if (i % 128 == 22 && j % 128 == 22) u += static_cast<float>(how.spikes / source.width);
            if (how.has_holes && std::hypot(i - 120, j - 90) < 20) u = v = NAN;
            uv.insert(uv.end(), {u, v});
            exact.vertices.push_back({u, how.v_up ? 1 - double{v} : v});
        }
    MeshWarpOptions options;
    options.tol = settings.tol;
    options.scheme = settings.scheme == Scheme::exact ? WarpScheme::exact : WarpScheme::automatic;
    options.filter = settings.filter;
    options.amount = how.amount;
    const auto truth = [exact, size, source, how,
                        oracle = std::make_shared<test::MeshOracle>(exact, size, source, how.amount)](
                           const Point<Real>& p) -> Point<Real> {
        // A pixel is its own sample, whatever stands around it.
        const Real i = p.x - 0.5L, j = p.y - 0.5L;
        const bool is_pixel =
            i == std::floor(i) && j == std::floor(j) && i >= 0 && i < size.width && j >= 0 && j < size.height;
        if (!is_pixel) return (*oracle)(p.x, p.y);
        const Point<double>& at = exact.vertices[static_cast<std::size_t>(j * size.width + i)];
        const auto blended = [&](Real here, Real there) { return here + how.amount * (there - here); };
        return {blended(p.x * source.width / size.width, Real(at.x) * source.width),
                blended(p.y * source.height / size.height, Real(at.y) * source.height)};
    };
    return {warped_picture(mesh_from_stmap(std::move(uv), size.width, size.height, "st", how.v_up), source,
                           size, options),
            truth};
}

/// A mesh of many cells that follow one smooth map.
ControlMesh smooth_mesh(const Size& to, int columns, int rows, double bend, Direction direction) {
    ControlMesh mesh;
    mesh.columns = columns, mesh.rows = rows;
    mesh.direction = direction;
    for (int j = 0; j <= rows; ++j)
        for (int i = 0; i <= columns; ++i) {
            const double x = double(i) / columns, y = double(j) / rows;
            mesh.vertices.push_back(
                {to.width * (0.02 + 0.95 * x + bend * (0.02 * std::sin(4 * y) + 0.01 * std::cos(4 * x))),
                 to.height * (0.03 + 0.94 * y + bend * (0.02 * std::sin(4 * x) - 0.03 * x * y))});
        }
    return mesh;
}

MeshWarpOptions warp_options(const Settings& settings) {
    MeshWarpOptions options;
    options.tol = settings.tol;
    options.scheme = settings.scheme == Scheme::exact ? WarpScheme::exact : WarpScheme::automatic;
    options.filter = settings.filter;
    return options;
}

/// A mesh of cells of 7 x 6 pixels or so.
Link dense_link(const Size& source, const Size& target, const Settings& settings) {
    const ControlMesh mesh = smooth_mesh(source, target.width / 7, target.height / 6, 1, Direction::pull);
    const auto truth = [oracle = std::make_shared<test::MeshOracle>(mesh, target, source, 1)](
                           const Point<Real>& p) { return (*oracle)(p.x, p.y); };
    return {warped_picture(WarpMap{"mesh", mesh}, source, target, warp_options(settings)), truth};
}

/// A mesh that pushes, and its inverse by Newton's iteration.
Link push_link(const Size& source, const Size& target, int columns, int rows, const Settings& settings) {
    const ControlMesh mesh = smooth_mesh(target, columns, rows, 0.3, Direction::push);
    const auto truth = [source, target, oracle = std::make_shared<test::MeshOracle>(mesh, source, target, 1)](
                           const Point<Real>& p) -> Point<Real> {
        Point<Real> z{p.x * source.width / target.width, p.y * source.height / target.height};
        for (int n = 0; n < 30; ++n) {
            const Real step = 1e-6L;
            const auto f = [&](Real dx, Real dy) { return (*oracle)(z.x + dx, z.y + dy); };
            const Point<Real> at = f(0, 0), e = f(step, 0), w = f(-step, 0), s = f(0, step), m = f(0, -step);
            const Real xx = (e.x - w.x) / (2 * step), yx = (e.y - w.y) / (2 * step),
                       xy = (s.x - m.x) / (2 * step), yy = (s.y - m.y) / (2 * step);
            const Real det = xx * yy - xy * yx, dx = p.x - at.x, dy = p.y - at.y;
            const Point<Real> by{(yy * dx - xy * dy) / det, (xx * dy - yx * dx) / det};
            z = {z.x + by.x, z.y + by.y};
            if (std::fabs(by.x) + std::fabs(by.y) < 1e-16L) break;
        }
        const bool is_on = z.x >= 0 && z.x <= source.width && z.y >= 0 && z.y <= source.height;
        return is_on ? z : Point<Real>{kNone, kNone};
    };
    return {warped_picture(WarpMap{"mesh", mesh}, source, target, warp_options(settings)), truth};
}

/// Pairs of points at random places, moved smoothly.
Link points_link(unsigned seed, int count, const Size& source, const Size& target, const Settings& settings) {
    test::Random random(seed);
    ControlPoints points;
    for (int i = 0; i < count; ++i) {
        const double x = random.between(0, target.width), y = random.between(0, target.height);
        points.pairs.push_back({x, y, x * source.width / target.width + 4 * std::sin(y / 50),
                                y * source.height / target.height + 3 * std::cos(x / 60)});
    }
    const Scattered map(points, target, source, 1);
    const auto truth = [oracle = std::make_shared<test::PointsOracle>(points, map, target, source)](
                           const Point<Real>& p) { return (*oracle)(p.x, p.y); };
    return {warped_picture(WarpMap{"points", points}, source, target, warp_options(settings)), truth};
}

/// The chain of links, from the outermost to the innermost.
Joined joined_of(const std::vector<Link>& links, const Point<int>& origin = {0, 0}) {
    Joined all{links.back().picture, ""};
    for (std::size_t i = links.size() - 1; i-- > 0;) {
        const Size size{all.picture->width(), all.picture->height()};
        all = joined_picture(links[i].picture, *all.picture,
                             {origin.x, origin.y, size.width - origin.x, size.height - origin.y});
        if (!all.picture) return all;
    }
    return all;
}

/// How near the edges of a picture in the middle points may be in or out.
constexpr Real kEdge = 1e-6L;

struct TruePoint {
    Point<Real> at{kNone, kNone};
    bool is_open = false;  ///< does rounding decide whether there is one?
};

TruePoint true_point(const std::vector<Link>& links, Point<Real> p, const Point<int>& origin) {
    TruePoint found;
    for (std::size_t i = 0; i < links.size(); ++i) {
        p = links[i].truth(p);
        if (!std::isfinite(p.x) || !std::isfinite(p.y)) return {{kNone, kNone}, found.is_open};
        if (i + 1 == links.size()) break;
        const Size size = links[i + 1].size();
        p = {p.x + origin.x, p.y + origin.y};
        if (links[i].closes) p.x -= std::floor(p.x / size.width) * size.width;
        const Real out = std::max({-p.x, p.x - size.width, -p.y, p.y - size.height});
        found.is_open |= std::fabs(out) < kEdge;
        if (out > 0) return {{kNone, kNone}, found.is_open};
    }
    found.at = p;
    return found;
}

struct Findings {
    std::int64_t over = 0, lost = 0, invented = 0, pixels = 0, exact = 0, drawn = 0;
    double bound = 0;
};

Findings examine(const BlockMap& map, const std::vector<Link>& links, const Point<int>& origin = {0, 0}) {
    Findings found;
    const Border& border = links.back().picture.maps[0].layers[0].border;
    const double turn = border.chart().closed() ? border.chart().period() : 0;
    const double width = border.chart().width(), height = border.chart().height();
    for (std::int64_t region = 0; region < map.regions(); ++region)
        for (const Block& block : map.blocks(region)) {
            found.bound = std::max(found.bound, block.bound);
            for (int j = block.box.y0; j < block.box.y1; ++j) {
                const test::BlockRow row(map, block, j);
                for (int i = block.box.x0; i < block.box.x1; ++i) {
                    ++found.pixels;
                    found.exact += block.kind == Block::Kind::exact;
                    const TruePoint truth = true_point(links, {i + 0.5L, j + 0.5L}, origin);
                    Point<double> p{};
                    int piece = 0;
                    bool seen = test::has_points(block);
                    if (seen)
                        p = row.at(i);
                    else if (block.kind == Block::Kind::exact)
                        seen = map.exact(block, i + 0.5, j + 0.5, p, piece);
                    const Point<Real>& at = truth.at;
                    const bool exists = std::isfinite(at.x) && std::isfinite(at.y);
                    constexpr double kFilter = 4;
                    const bool in_source = exists &&
                                           (turn > 0 || (at.x > -kFilter && at.x < width + kFilter)) &&
                                           at.y > -kFilter && at.y < height + kFilter;
                    found.drawn += seen;
                    if (!seen) found.lost += in_source && !truth.is_open;
                    if (!seen || !exists) {
                        found.invented += seen && !truth.is_open;
                        continue;
                    }
                    Real dx = p.x - at.x;
                    if (turn > 0) dx -= std::round(dx / turn) * turn;
                    found.over += std::hypot(dx, p.y - at.y) > block.bound;
                }
            }
        }
    return found;
}

struct ChainCase {
    std::string name;
    std::function<std::vector<Link>(const Settings&)> links;
    double most_exact = 0.5;
    /// The largest bound where nothing is exact enough (poles).
    double exact_bound = 1e-6;
    /// The least tolerance that its links are made for.
    double least_tol = 1e-9;
};

View view(Projection projection, const Size& size, double fov) {
    return {projection, size.width, size.height, fov};
}
View flat(const Size& size, double fov) {
    return view(Projection::rectilinear, size, fov);
}

/// Chains with ST-maps. Their cubics need some tolerance: what is finer has no block.
std::vector<ChainCase> stmap_cases() {
    const Size plate{310, 206}, middle{280, 240};
    const auto coarse = [](Settings s) {
        if (s.tol > 0 && s.tol < 1e-2) s.tol = 1e-2;
        return s;
    };
    const auto lens = [=](const Settings& s) {
        return lens_link("brown:k1=-0.2,k2=0.05,k3=-0.004", LensMode::undistort, plate, plate, s);
    };
    return {
        {"pano of ST-map",
         [=](const Settings& s) {
             return std::vector{pano_link(flat(middle, 80), flat({260, 200}, 70), {12, 7, 20}, s),
                                stmap_link(middle, plate, {}, coarse(s))};
         },
         0.7},
        {"ST-map of lens",
         [=](const Settings& s) {
             return std::vector{stmap_link(middle, plate, {0, true}, coarse(s)), lens(s)};
         },
         0.7},
        {"ST-map of ST-map",
         [=](const Settings& s) {
             return std::vector{stmap_link(middle, plate, {0, false, false, 1.2}, coarse(s)),
                                stmap_link(plate, {400, 300}, {}, coarse(s))};
         },
         0.7},
        {"ST-map with a hole, of lens",
         [=](const Settings& s) {
             return std::vector{stmap_link({300, 280}, plate, {0, false, true}, coarse(s)), lens(s)};
         },
         0.8},
        {"pano of ST-map with a hole",
         [=](const Settings& s) {
             return std::vector{pano_link(flat({300, 280}, 80), flat({260, 200}, 70), {-4, 3, 5}, s),
                                stmap_link({300, 280}, plate, {0, false, true}, coarse(s))};
         },
         0.8},
        {"rough ST-map of lens, exactly",
         [=](Settings s) {
             s.tol = 0, s.scheme = Scheme::exact;
             return std::vector{stmap_link(middle, plate, {0.4}, s), lens(s)};
         },
         1.1},
        {"lens of rough ST-map, exactly",
         [=](Settings s) {
             s.tol = 0, s.scheme = Scheme::exact;
             return std::vector{lens(s), stmap_link(plate, {300, 200}, {0.4}, s)};
         },
         1.1},
    };
}

/// Chains with warps that are read as cubics, too.
std::vector<ChainCase> warp_cases() {
    const Size plate{310, 206}, middle{260, 220};
    const auto coarse = [](Settings s) {
        if (s.tol > 0 && s.tol < 1e-2) s.tol = 1e-2;
        return s;
    };
    const auto exactly = [](Settings s) {
        s.tol = 0, s.scheme = Scheme::exact;
        return s;
    };
    const auto lens = [=](const Settings& s) {
        return lens_link("brown:k1=-0.2,k2=0.05,k3=-0.004", LensMode::undistort, plate, plate, s);
    };
    const auto turned = [=](const Settings& s, const Size& of) {
        return pano_link(flat(of, 80), flat({230, 180}, 74), {5, 4, 12}, s);
    };
    // So large that triangles are.
    const Size large{600, 480};
    return {
        {"pano of a mesh of small cells",
         [=](const Settings& s) {
             return std::vector{turned(s, middle), dense_link(plate, middle, coarse(s))};
         }},
        {"mesh of small cells, of lens",
         [=](const Settings& s) {
             return std::vector{dense_link(plate, middle, coarse(s)), lens(s)};
         }},
        {"pano of points",
         [=](const Settings& s) {
             return std::vector{turned(s, large), points_link(3, 4, plate, large, coarse(s))};
         },
         0.7},
        {"points of lens",
         [=](const Settings& s) {
             return std::vector{points_link(4, 4, plate, {480, 400}, coarse(s)), lens(s)};
         },
         0.7},
        {"pano of a mesh that pushes",
         [=](const Settings& s) {
             return std::vector{turned(s, middle), push_link(plate, middle, 1, 1, coarse(s))};
         },
         0.6},
        {"mesh that pushes, of points",
         [=](const Settings& s) {
             return std::vector{push_link(large, middle, 1, 1, coarse(s)),
                                points_link(5, 4, {200, 170}, large, coarse(s))};
         },
         0.9},
        {"mesh of small cells of points of a mesh that pushes, exactly",
         [=](const Settings& s) {
             return std::vector{dense_link(middle, {150, 120}, exactly(s)),
                                points_link(6, 20, {200, 170}, middle, exactly(s)),
                                push_link(plate, {200, 170}, 3, 3, exactly(s))};
         },
         1.1},
    };
}

std::vector<ChainCase> chain_cases() {
    const Size plate{310, 206};
    const View sphere = view(Projection::equirectangular, {640, 320}, 360);
    return {
        {"pano of lens",
         [=](const Settings& s) {
             return std::vector{
                 pano_link(flat(plate, 80), flat({280, 240}, 70), {12, 7, 20}, s),
                 lens_link("brown:k1=-0.2,k2=0.05,k3=-0.004", LensMode::undistort, plate, plate, s)};
         }},
        {"warp of pano of lens",
         [=](const Settings& s) {
             return std::vector{mesh_link(7, 4, 0, {280, 240}, {300, 250}, s),
                                pano_link(flat(plate, 80), flat({280, 240}, 70), {12, 7, 20}, s),
                                lens_link("3de4:k1=0.1,k2=0.03", LensMode::distort, plate, plate, s)};
         }},
        {"lens of warp",
         [=](const Settings& s) {
             return std::vector{
                 lens_link("ptlens:a=0.01,b=-0.03,c=0.02", LensMode::undistort, {300, 250}, {320, 260}, s),
                 mesh_link(8, 3, 1, plate, {300, 250}, s)};
         }},
        {"pano of warp, along the lines of its cells",
         [=](const Settings& s) {
             return std::vector{pano_link(flat({65, 65}, 60), flat({65, 65}, 50), {0, 0, 0}, s),
                                mesh_link(9, 2, 1, {65, 65}, {65, 65}, s)};
         },
         1.01},
        {"pano of pano, across the seam",
         [=](const Settings& s) {
             return std::vector{
                 pano_link(sphere, flat({260, 200}, 100), {175, 20, 5}, s),
                 pano_link(view(Projection::equirectangular, {800, 400}, 360), sphere, {30, 40, 10}, s)};
         }},
        {"pano of pano, at a pole",
         [=](const Settings& s) {
             return std::vector{
                 pano_link(sphere, flat({200, 200}, 90), {3, 88, 0}, s),
                 pano_link(view(Projection::fisheye, {400, 400}, 190), sphere, {0, 70, 10}, s)};
         },
         0.6},
        {"pano of a cylinder, beyond its edges",
         [=](const Settings& s) {
             const View cylinder = view(Projection::cylindrical, {500, 160}, 360);
             return std::vector{pano_link(cylinder, flat({200, 200}, 90), {170, 30, 10}, s),
                                pano_link(sphere, cylinder, {10, 20, 5}, s)};
         }},
        {"twirl of lens that ends",
         [=](const Settings& s) {
             return std::vector{twirl_link(plate, s),
                                lens_link("ptlens:b=-0.45", LensMode::undistort, plate, plate, s)};
         },
         0.8},
        {"twirl of a cube's faces",
         [=](const Settings& s) {
             return std::vector{
                 twirl_link({240, 160}, s),
                 faces_link(sphere, view(Projection::cubemap3x2, {240, 160}, 90), {20, 10, 5}, s)};
         },
         1.01},  // no box of one face is worth its bound
        {"sphere of twirled plane",
         [=](const Settings& s) {
             return std::vector{pano_link(flat({300, 300}, 100),
                                          view(Projection::stereographic, {220, 220}, 150), {0, 20, 0}, s),
                                twirl_link({300, 300}, s)};
         }},
    };
}

TEST(Chain, HoldsEveryTolerance) {
    constexpr unsigned kSeed = 1987;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    const double tols[] = {1, 1.0 / 16, 0.01, 1e-3, 1e-5, 1e-7, 0};
    std::vector<ChainCase> cases = chain_cases();
    for (const auto& coarse : {stmap_cases(), warp_cases()})
        for (const ChainCase& c : coarse) {
            cases.push_back(c);
            cases.back().least_tol = 1e-2;
        }
    for (const ChainCase& c : cases)
        for (int n = 0; n < 3; ++n) {
            Settings settings;
            settings.tol = tols[random() % std::size(tols)];
            SCOPED_TRACE(::testing::Message() << c.name << ", tol " << settings.tol);
            const std::vector<Link> links = c.links(settings);
            const Joined joined = joined_of(links);
            ASSERT_TRUE(joined.picture) << joined.reason;
            const Findings found = examine(*joined.picture->maps[0].blocks, links);
            EXPECT_EQ(found.over, 0);
            EXPECT_EQ(found.lost, 0);
            EXPECT_EQ(found.invented, 0);
            EXPECT_EQ(found.pixels, std::int64_t{links[0].size().width} * links[0].size().height);
            EXPECT_GT(found.drawn, found.pixels / 4);
            EXPECT_LE(found.bound, settings.tol > 0 ? std::max(settings.tol, c.least_tol) : c.exact_bound);
            if (settings.tol >= 0.01) {
                EXPECT_LT(static_cast<double>(found.exact), c.most_exact * static_cast<double>(found.pixels));
            }
        }
}

// Where the window of a box's middle serves, and that of the middle of a part of the box does not, which needs a bound of its own.
TEST(Chain, HoldsTheToleranceNextToRoughSamples) {
    const Size size{512, 512}, plate{400, 400};
    Settings settings;
    settings.tol = 0.05;
    const std::vector<Link> links{stmap_link(size, plate, {.spikes = 8}, settings),
                                  waves_link(plate, settings)};
    const Joined joined = joined_of(links);
    ASSERT_TRUE(joined.picture) << joined.reason;
    const Findings found = examine(*joined.picture->maps[0].blocks, links);
    EXPECT_EQ(found.over, 0);
    EXPECT_LE(found.bound, settings.tol);
    EXPECT_LT(static_cast<double>(found.exact), 0.5 * static_cast<double>(found.pixels));
}

// What the outer map rounds is moved by the inner one, here by far more than that rounds itself.
TEST(Chain, KnowsWhatTheOuterMapRounds) {
    const Size plate{310, 206};
    Settings settings;
    settings.tol = 0;
    FormulaText text;
    text.u = "(x/3+1e9)-1e9+90";
    text.v = "y/3+60";
    const PlaneFormula formula = parse_formula(text, {plate, plate});
    const auto plan =
        std::make_shared<const TextPlan>(TextMap(formula, plate, plate, plate), plan_of(settings));
    const Link outer{picture_through(plan, flat_border(plate), settings.filter, Output::color),
                     [](const Point<Real>& p) {
                         return Point<Real>{p.x / 3 + 90, p.y / 3 + 60};
                     }};
    const std::vector<Link> links{
        outer, lens_link("brown:k1=-0.2,k2=0.05,k3=-0.004", LensMode::undistort, plate, plate, settings)};
    const Joined joined = joined_of(links);
    ASSERT_TRUE(joined.picture) << joined.reason;
    const Findings found = examine(*joined.picture->maps[0].blocks, links);
    EXPECT_EQ(found.over, 0);
    EXPECT_EQ(found.pixels, found.drawn);
    EXPECT_GT(found.bound, 1e-8);
    EXPECT_LT(found.bound, 1e-6);
}

// The smaller tolerance is that of the chain, and a link that is exact makes all of it so.
TEST(Chain, TakesTheSmallerTolerance) {
    const Size plate{310, 206};
    Settings coarse, fine;
    coarse.tol = 0.5;
    fine.tol = 1e-4;
    const auto chain = [&](const Settings& outer, const Settings& inner) {
        return std::vector{pano_link(flat(plate, 80), flat(plate, 60), {9, 5, 3}, outer),
                           lens_link("brown:k1=-0.2,k2=0.05", LensMode::undistort, plate, plate, inner)};
    };
    for (const auto& links : {chain(coarse, fine), chain(fine, coarse)})
        EXPECT_LE(joined_of(links).picture->reached().max_error, 1e-4);
    EXPECT_GT(joined_of(chain(coarse, coarse)).picture->reached().max_error, 1e-4);
    Settings exact = coarse;
    exact.scheme = Scheme::exact;
    for (const auto& links : {chain(coarse, exact), chain(exact, coarse)}) {
        const Reached reached = joined_of(links).picture->reached();
        EXPECT_EQ(reached.exact_fraction, 1);
        EXPECT_LT(reached.max_error, 1e-9);
    }
}

// The coordinates of a picture with overscan begin at its display window.
TEST(Chain, CountsFromTheDisplayWindow) {
    const Size shown{310, 206}, all{350, 246};
    const Point<int> origin{20, 20};
    Settings settings;
    const std::vector<Link> links{
        pano_link(flat(shown, 80), flat({300, 220}, 90), {4, 3, 2}, settings),
        lens_link("3de4:k1=0.1,k2=0.03", LensMode::undistort, shown, all, settings)};
    const Joined joined = joined_of(links, origin);
    ASSERT_TRUE(joined.picture) << joined.reason;
    const Findings found = examine(*joined.picture->maps[0].blocks, links, origin);
    EXPECT_EQ(found.over, 0);
    EXPECT_EQ(found.lost, 0);
    EXPECT_EQ(found.invented, 0);
}

// Two inverse maps are none: nothing moves, and nothing is lost.
TEST(Chain, OfInverseMapsMovesNothing) {
    const Size plate{310, 206};
    Settings settings;
    const char* const lens = "brown:k1=-0.1,k2=0.02,p1=0.002,p2=-0.003,d=3.5,e=-2";
    const std::vector<Link> links{lens_link(lens, LensMode::distort, plate, plate, settings),
                                  lens_link(lens, LensMode::undistort, plate, plate, settings)};
    const Joined joined = joined_of(links);
    ASSERT_TRUE(joined.picture) << joined.reason;
    const BlockMap& map = *joined.picture->maps[0].blocks;
    double largest = 0;
    int piece = 0;
    for (int y = 20; y < 186; y += 7)
        for (int x = 20; x < 290; x += 7) {
            Point<double> p{};
            ASSERT_TRUE(map.exact(x + 0.5, y + 0.5, 0, p, piece));
            largest = std::max(largest, std::hypot(p.x - x - 0.5, p.y - y - 0.5));
            const Jacobian j = map.jacobian(x + 0.5, y + 0.5, 0);
            EXPECT_NEAR(j.x_i, 1, 1e-9);
            EXPECT_NEAR(j.y_j, 1, 1e-9);
            EXPECT_NEAR(j.x_j, 0, 1e-9);
            EXPECT_NEAR(j.y_i, 0, 1e-9);
        }
    EXPECT_LT(largest, 1e-9);
}

/// How much of a pixel has a source point, by points of a Fibonacci lattice; no number where anything but edges of pictures in the
/// middle, and ends of the maps that draw them, decides that.
Real share_of(const std::vector<Link>& links, int x, int y) {
    constexpr int kPoints = 610, kStep = 377;
    const Chart& source = links.back().picture.maps[0].layers[0].border.chart();
    int in = 0;
    for (int n = 0; n < kPoints; ++n) {
        Point<Real> p{x + (n + 0.5L) / kPoints, y + (n * kStep % kPoints + 0.5L) / kPoints};
        bool is_in = true;
        for (std::size_t i = 0; i < links.size() && is_in; ++i) {
            p = links[i].truth(p);
            if (!std::isfinite(p.x) || !std::isfinite(p.y)) {
                if (i == 0) return kNone;
                is_in = false;
            }
            if (!is_in || i + 1 == links.size()) break;
            const Size size = links[i + 1].size();
            if (links[i].closes) p.x -= std::floor(p.x / size.width) * size.width;
            is_in = p.x >= 0 && p.x <= size.width && p.y >= 0 && p.y <= size.height;
        }
        in += is_in;
        // What fades at the source's own edges is another matter.
        const Real reach = 6;
        if (is_in && (p.y < reach || p.y > source.height() - reach ||
                      (!source.closed() && (p.x < reach || p.x > source.width() - reach))))
            return kNone;
    }
    return static_cast<Real>(in) / kPoints;
}

/// Compares coverage with such shares: of one in so many of the pixels next to those that differ, and of some others.
void compare_covers(int one_in) {
    const Size plate{310, 206};
    std::vector<ChainCase> cases = chain_cases();
    cases.push_back({"map of a turned plane, magnified", [=](const Settings& s) {
                         return std::vector{
                             pano_link(flat({90, 60}, 60), flat({300, 200}, 70), {4, 3, 10}, s),
                             pano_link(flat(plate, 100), flat({90, 60}, 60), {3, 2, 5}, s)};
                     }});
    // A map that ends within its picture, at the rim of a circle, beyond which the oracle goes on.
    cases.push_back(
        {"twirl of an orthographic view of a sphere", [=](const Settings& s) {
             Link inner = pano_link(view(Projection::equirectangular, {640, 320}, 360),
                                    view(Projection::orthographic, {200, 200}, 180), {20, 30, 5}, s);
             inner.truth = [goes_on = inner.truth](const Point<Real>& p) {
                 return std::hypot(p.x - 100, p.y - 100) < 100 ? goes_on(p) : Point<Real>{kNone, kNone};
             };
             return std::vector{twirl_link({200, 200}, s), inner};
         }});
    for (const ChainCase& c : cases)
        for (const Filter filter : {Filter::antialias, Filter::bilinear}) {
            if (filter == Filter::bilinear && c.name != "pano of lens") continue;
            SCOPED_TRACE(c.name);
            Settings settings;
            settings.filter = filter;
            const std::vector<Link> links = c.links(settings);
            Joined joined = joined_of(links);
            ASSERT_TRUE(joined.picture) << joined.reason;
            joined.picture->output = Output::coverage;
            const Size size = links[0].size();
            std::vector<float> cover(static_cast<std::size_t>(size.width) *
                                     static_cast<std::size_t>(size.height));
            const Chart& chart = links.back().picture.maps[0].layers[0].border.chart();
            const std::vector<float> white(
                static_cast<std::size_t>(chart.width()) * static_cast<std::size_t>(chart.height()), 1.0f);
            const MemorySource source(packed_view(reinterpret_cast<const std::byte*>(white.data()),
                                                  PixelType::float32, chart.width(), chart.height(), 1));
            const ImageView view = packed_view(reinterpret_cast<std::byte*>(cover.data()), PixelType::float32,
                                               size.width, size.height, 1);
            ASSERT_TRUE(joined.picture->draw(&source, {0, 0, size.width, size.height}, view));
            // Of a part of it the same.
            std::vector<float> part(50 * 40);
            const Box of{size.width - 61, size.height - 47, size.width - 11, size.height - 7};
            ASSERT_TRUE(joined.picture->draw(
                &source, of,
                packed_view(reinterpret_cast<std::byte*>(part.data()), PixelType::float32, 50, 40, 1)));
            const auto at = [&](int x, int y) { return cover[static_cast<std::size_t>(y * size.width + x)]; };
            for (int i = 0; i < 50 * 40; ++i)
                ASSERT_EQ(part[static_cast<std::size_t>(i)], at(of.x0 + i % 50, of.y0 + i / 50));
            int crossed = 0;
            Real largest = 0, sum = 0;
            for (int y = 1; y + 1 < size.height; ++y)
                for (int x = 1; x + 1 < size.width; ++x) {
                    const float here = at(x, y);
                    const bool differs = here != at(x - 1, y) || here != at(x + 1, y) ||
                                         here != at(x, y - 1) || here != at(x, y + 1);
                    if ((x + 7 * y) % (differs ? one_in : 397) != 0) continue;
                    const Real truth = share_of(links, x, y);
                    if (!std::isfinite(truth)) continue;
                    const Real off = std::fabs(here - truth);
                    largest = std::max(largest, off);
                    if (truth > 0 && truth < 1) ++crossed, sum += off;
                }
            EXPECT_LT(largest, 0.02);
            EXPECT_LT(sum, 0.004L * std::max(crossed, 1));
        }
}

TEST(Chain, CoversOfAPixelWhatLiesInTheMiddle) {
    compare_covers(3);
}
TEST(Chain, CoversOfEveryPixelWhatLiesInTheMiddle) {
    compare_covers(1);
}

// Pixels that an edge of the picture in the middle crosses are exact, and few beside them: blocks are cut down to four pixels.
TEST(Chain, IsExactInNarrowBandsAlongEdges) {
    const Size size{1000, 800};
    const Settings settings;
    const Joined joined =
        joined_of({pano_link(flat(size, 84), flat(size, 76), {6, 3, 10}, settings),
                   lens_link("brown:k1=-0.1,k2=0.02", LensMode::undistort, size, size, settings)});
    ASSERT_TRUE(joined.picture) << joined.reason;
    std::int64_t exact = 0, crossed = 0;
    const BlockMap& map = *joined.picture->maps[0].blocks;
    const auto seen = [&](int x, int y) { return map.seen(x + 0.5, y + 0.5, 0); };
    for (std::int64_t region = 0; region < map.regions(); ++region)
        for (const Block& block : map.blocks(region))
            if (block.kind == Block::Kind::exact)
                exact += std::int64_t{block.box.width()} * block.box.height();
    for (int y = 0; y + 1 < size.height; ++y)
        for (int x = 0; x + 1 < size.width; ++x)
            crossed += seen(x, y) != seen(x + 1, y) || seen(x, y) != seen(x, y + 1);
    ASSERT_GT(crossed, 500);
    EXPECT_GE(exact, crossed);
    EXPECT_LT(exact, 5 * crossed);
}

TEST(EdgesOverBox, TellsWhatLiesWithin) {
    test::Random random(2611);
    int counts[5] = {};
    for (int trial = 0; trial < 3000; ++trial) {
        const Box box{-7, 5, 25, 21};
        const double cx = 9, cy = 13;
        // Two edges, each linear but for the square of its own distance from the middle.
        double a[2][4];
        std::vector<Jet1<double>> middle(2);
        std::vector<Jet1<Interval>> over(2);
        for (int i = 0; i < 2; ++i) {
            a[i][0] = random.between(-15, 25), a[i][1] = random.between(-1, 1),
            a[i][2] = random.between(-1, 1), a[i][3] = random.between(-0.01, 0.01);
            for (int k = 0; k < 3; ++k) middle[i].c[k] = a[i][k];
            const double wide = std::fabs(a[i][3]) * 32, high = std::fabs(a[i][3]) * 16;
            over[i].c[1] = Interval(a[i][1] - wide, a[i][1] + wide);
            over[i].c[2] = Interval(a[i][2] - high, a[i][2] + high);
        }
        const auto least = [&](double x, double y) {
            double value = HUGE_VAL;
            for (const auto& f : a)
                value = std::min(value, f[0] + f[1] * (x - cx) + f[2] * (y - cy) +
                                            f[3] * ((x - cx) * (x - cx) + (y - cy) * (y - cy)));
            return value;
        };
        const EdgesOverBox edges(box, middle, over);
        Box part{static_cast<int>(random.between(-7, 25)), static_cast<int>(random.between(5, 21)), 0, 0};
        part.x1 = part.x0 + 1 + static_cast<int>(random.between(0, 24 - part.x0));
        part.y1 = part.y0 + 1 + static_cast<int>(random.between(0, 20 - part.y0));
        const Cover cover = edges.cover(part);
        ++counts[static_cast<int>(cover)];
        double lowest = HUGE_VAL, highest = -HUGE_VAL, corner = HUGE_VAL;
        for (int j = 0; j <= 8; ++j)
            for (int i = 0; i <= 8; ++i) {
                const double value =
                    least(part.x0 + part.width() * i / 8.0, part.y0 + part.height() * j / 8.0);
                lowest = std::min(lowest, value), highest = std::max(highest, value);
                if (i % 8 == 0 && j % 8 == 0) corner = std::min(corner, value);
            }
        EXPECT_TRUE(cover != Cover::inside || lowest >= 0) << trial;
        EXPECT_TRUE(cover != Cover::outside || highest < 0) << trial;
        EXPECT_TRUE(cover != Cover::cut || corner < -0x1p-9) << trial;
    }
    // What is clear is told, and most of it is.
    for (const Cover cover : {Cover::inside, Cover::outside, Cover::cut})
        EXPECT_GT(counts[static_cast<int>(cover)], 300);
    EXPECT_LT(counts[static_cast<int>(Cover::mixed)], 300);
}

TEST(Chain, SaysWhyItDoesNotJoin) {
    const Size plate{310, 206};
    const Settings settings;
    const Link lens = lens_link("3de4:k1=0.1", LensMode::undistort, plate, plate, settings);
    const Link pano = pano_link(flat(plate, 80), flat(plate, 60), {}, settings);
    const Box shown{0, 0, plate.width, plate.height};
    const auto reason = [&](const Picture& outer, const Picture& inner) {
        const Joined joined = joined_picture(outer, inner, shown);
        EXPECT_FALSE(joined.picture);
        return joined.reason;
    };
    Picture other = pano.picture;
    other.filter = Filter::bicubic;
    EXPECT_EQ(reason(other, lens.picture), "the filters differ");
    other = lens.picture;
    other.output = Output::stmap;
    EXPECT_EQ(reason(pano.picture, other), "its source is no picture in colour");
    Settings blocks = settings;
    blocks.scheme = Scheme::blocks;
    const Link by_blocks = lens_link("3de4:k1=0.1", LensMode::undistort, plate, plate, blocks);
    EXPECT_EQ(reason(by_blocks.picture, lens.picture), "it has a scheme that does not join");
    EXPECT_EQ(reason(pano.picture, by_blocks.picture), "its source has a scheme that does not join");
    other = pano.picture;
    other.maps[0].layers[0].border = Border(Chart(Projection::rectilinear, 310, 206), Wrap::clamp);
    EXPECT_EQ(reason(other, lens.picture), "wrap goes on beyond its source's edges");
    const Link rough = stmap_link(plate, plate, {0.4}, settings);
    EXPECT_EQ(reason(rough.picture, lens.picture), "it has an ST-map that is rough or small");
    EXPECT_EQ(reason(lens.picture, stmap_link({90, 60}, plate, {0.4}, settings).picture),
              "its source has an ST-map that is rough or small");
    // Of few pixels any is joined.
    EXPECT_TRUE(
        joined_picture(lens.picture, stmap_link({60, 50}, plate, {0.4}, settings).picture, shown).picture);
    // A mesh of small cells is quicker drawn by itself where they differ.
    const Link dense = mesh_link(3, 40, 0, plate, plate, settings);
    EXPECT_EQ(reason(dense.picture, lens.picture), "it has a mesh of small cells that differ");
    EXPECT_EQ(reason(points_link(7, 2000, plate, plate, settings).picture, lens.picture),
              "it has pairs of points that stand close");
    const Link cube = pano_link(view(Projection::cubemap, {40, 240}, 90), flat(plate, 60), {}, settings);
    EXPECT_EQ(reason(cube.picture, lens.picture), "its source has faces");
    // What closes on itself is read across its seam, beyond which a flat source has nothing.
    const Size whole{320, 160};
    const Link twirl = twirl_link(whole, settings);
    const Link sphere =
        pano_link(view(Projection::equirectangular, whole, 360), flat({100, 80}, 60), {}, settings);
    const Joined across = joined_picture(sphere.picture, twirl.picture, {0, 0, 320, 160});
    EXPECT_FALSE(across.picture);
    EXPECT_EQ(across.reason, "its source closes on itself, but not what that is drawn from");
}

}  // namespace
}  // namespace anamorph::test_chain
