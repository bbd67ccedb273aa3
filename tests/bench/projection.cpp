// SPDX-License-Identifier: Apache-2.0
// Panoramas thrown onto a scene: speed and error.
//
// A room of 12 triangles about a projector that is not in its middle, 4096 x 2048 texels. triangles: cut to a tolerance; the
// time is that of a triangle that is painted. vertices: texture coordinates of a grid's vertices (of about as many
// triangles as the table's size across, squared), without a tolerance; where VTK was found, vtkTextureMapToSphere and
// vtkProjectedTexture (a picture of 90 degrees) do the same beside it; the time is that of a triangle. Errors are measured in long double at three points of each triangle, about poles
// as directions. ratio_to_exact: against a texel for every point, by the formula. groups: the middles of the grid's triangles
// by Kim's linear parts and tables of residuals of 256 x 256 (4.2 to 4.4), eight directions of 90 degrees; those above and below
// are left out. bake: a texture of 256 x 256 of a wall, evaluated at every texel; the time is that of a texel. bake_part: an eighth of
// its rows, as a rank of eight that is asked for these alone holds and makes them.
//
// Case mosaic: a view of 90 degrees of concentric mosaics of 5 circles, four times as wide as the view, from beside their
// middle; the time is that of a pixel, and errors are those of the source points of one circle.
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "anamorph/projector/projected_triangles.h"
#include "anamorph/projector/projection_bake.h"
#include "anamorph/projector/projection_groups.h"
#include "projection_rows.h"

namespace anamorph::bench::op_projection {
namespace {

const ProjectorPose kPose{{0.2, 0.1, -0.3}, {0.3, -0.1, -1}, {0.1, 1, 0.2}};

/// Where errors are measured in a triangle.
const std::vector<std::array<double, 3>> kShares = {
    {0.6, 0.2, 0.2}, {0.2, 0.6, 0.2}, {1. / 3, 1. / 3, 1. / 3}};

/// A cube from -1 to 1, every side of it as a grid of quads.
SceneTriangles room_of(int quads) {
    SceneTriangles room;
    for (int axis = 0; axis < 3; ++axis)
        for (const double side : {-1.0, 1.0})
            for (int j = 0; j < quads; ++j)
                for (int i = 0; i < quads; ++i) {
                    const auto corner = [&](int s, int t) {
                        glm::dvec3 p;
                        p[axis] = side;
                        p[(axis + 1) % 3] = 2.0 * (i + s) / quads - 1;
                        p[(axis + 2) % 3] = 2.0 * (j + t) / quads - 1;
                        return p;
                    };
                    room.push_back({corner(0, 0), corner(1, 0), corner(1, 1)});
                    room.push_back({corner(0, 0), corner(1, 1), corner(0, 1)});
                }
    return room;
}

/// Between a ray and that of a texel, in texels of the panorama's middle.
long double turned(const long double (&ray)[3], long double u, long double v, int width, int height) {
    const long double a = (u / width - 0.5L) * 2 * kPi, e = (v / height - 0.5L) * kPi,
                      n = std::sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
    const long double x = ray[0] / n - std::sin(a) * std::cos(e), y = ray[1] / n - std::sin(e),
                      z = ray[2] / n - std::cos(a) * std::cos(e);
    return std::sqrt(x * x + y * y + z * z) * width / (2 * kPi);
}

/// The formula of an equirectangular panorama in long double, against what is interpolated.
Accuracy accuracy(const Projector& projector, const std::vector<PaintedTriangle>& pieces) {
    const int width = projector.panorama().width(), height = projector.panorama().height();
    std::vector<float> errors;
    for (const PaintedTriangle& piece : pieces)
        for (const auto& share : kShares) {
            long double r[3] = {}, u = 0, v = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const PaintedCorner& c = piece.corners[k];
                for (int i = 0; i < 3; ++i)
                    for (int d = 0; d < 3; ++d)
                        r[i] += share[k] * projector.frame()[i][d] *
                                (static_cast<long double>(c.point[d]) - projector.pose().position[d]);
                u += share[k] * c.texel.x;
                v += share[k] * c.texel.y;
            }
            const long double x = (std::atan2(r[0], r[2]) / (2 * kPi) + 0.5L) * width;
            const long double y = (std::atan2(r[1], std::hypot(r[0], r[2])) / kPi + 0.5L) * height;
            long double across = std::fabs(x - u);
            if (across > width / 2.0L) across = width - across;
            errors.push_back(
                static_cast<float>(std::min(std::hypot(across, y - v), turned(r, u, v, width, height))));
        }
    return accuracy_of(errors);
}

/// Texels at the corners, and nothing else.
std::vector<PaintedTriangle> by_vertices(const Projector& projector, const SceneTriangles& scene) {
    std::vector<PaintedTriangle> pieces;
    for (const auto& triangle : scene) {
        PaintedTriangle piece;
        for (std::size_t k = 0; k < 3; ++k) {
            piece.corners[k].point = triangle[k];
            projector.receive(triangle[k], piece.corners[k].texel);
        }
        pieces.push_back(piece);
    }
    return pieces;
}

/// The middles of triangles by the tables of their groups.
struct GroupedPoints {
    std::vector<glm::dvec3> points;
    std::vector<int> groups;
    std::vector<Point<double>> texels;

    GroupedPoints(const ProjectionGroups& all, const SceneTriangles& scene) {
        for (const auto& triangle : scene) {
            const int group = all.group_of(triangle);
            if (group < 0) continue;
            points.push_back((triangle[0] + triangle[1] + triangle[2]) / 3.0);
            groups.push_back(group);
        }
        texels.resize(points.size());
    }

    void read(const ProjectionGroups& all) {
        for (std::size_t i = 0; i < points.size(); ++i) all.texel(groups[i], points[i], texels[i]);
    }

    /// As pieces that are points, for accuracy().
    std::vector<PaintedTriangle> pieces() const {
        std::vector<PaintedTriangle> all(points.size());
        for (std::size_t i = 0; i < points.size(); ++i)
            for (PaintedCorner& corner : all[i].corners) corner = {{}, points[i], texels[i]};
        return all;
    }
};

std::vector<BakedTriangle> baked_wall() {
    const glm::dvec3 p(-1, -1, -1), q(1, -1, -1), r(1, 1, -1), s(-1, 1, -1);
    return {{{p, q, r}, {{{0, 0}, {1, 0}, {1, 1}}}}, {{p, r, s}, {{{0, 0}, {1, 1}, {0, 1}}}}};
}

/// Two channels, the places of a panorama's pixels, from which bilinear reading makes those of all points.
std::vector<float> coordinates(int width, int height) {
    std::vector<float> pixels;
    for (int j = 0; j < height; ++j)
        for (int i = 0; i < width; ++i)
            pixels.insert(pixels.end(), {static_cast<float>(i) + 0.5F, static_cast<float>(j) + 0.5F});
    return pixels;
}

/// Texels of the wall that show coordinates, as pieces that are points.
std::vector<PaintedTriangle> texels_of(const BakedTexture& baked, int size) {
    std::vector<PaintedTriangle> all(static_cast<std::size_t>(size) * static_cast<std::size_t>(size));
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto column = static_cast<double>(i % static_cast<std::size_t>(size)),
                   row = static_cast<double>(i / static_cast<std::size_t>(size));
        for (PaintedCorner& corner : all[i].corners) {
            corner.point = {(column + 0.5) / size * 2 - 1, 1 - (row + 0.5) / size * 2, -1};
            corner.texel = {baked.pixels[3 * i], baked.pixels[3 * i + 1]};
        }
    }
    return all;
}

/// Of so many triangles or texels, without its errors.
Row row_of(const std::string& scheme, double tol, const Times& time, std::size_t count) {
    Row row;
    row.op = "projection";
    row.case_name = "room";
    row.scheme = scheme;
    row.tol_px = tol;
    row.size = static_cast<int>(count);
    row.ns_per_px = time.median / static_cast<double>(count);
    row.best_ns_per_px = time.best / static_cast<double>(count);
    return row;
}

void run_room(const Settings& settings, Report& report) {
    if (!settings.wants_case("room")) return;
    const Projector projector(Chart(Projection::equirectangular, 4096, 2048), kPose);
    const SceneTriangles room = room_of(1), grid = room_of(std::max(2, settings.size / 16));
    std::vector<PaintedTriangle> vertices;
    struct Tolerance {
        double tol;
        std::vector<PaintedTriangle> pieces = {};
        PaintedCounts counts = {};
    };
    std::vector<Tolerance> tolerances{{8}, {2}, {0.5}};
    std::vector<Timed> timed{{[&] { vertices = by_vertices(projector, grid); }}};
    for (Tolerance& t : tolerances)
        timed.push_back({[&] {
            const ScenePainter painter(projector, {.tol = t.tol});
            t.pieces.clear();
            t.counts = {};
            for (const auto& triangle : room) t.counts += painter.paint(triangle, t.pieces);
        }});
    const ProjectionGroups groups(projector, ProjectionGroups::level_directions(8));
    GroupedPoints grouped(groups, grid);
    timed.push_back({[&] { grouped.read(groups); }});
    const std::vector<float> picture = coordinates(4096, 2048);
    BakeOptions bake_options;
    bake_options.size = {256, 256};
    bake_options.channels = 2;
    BakedTexture baked;
    timed.push_back({[&] { baked = bake(baked_wall(), {{projector, picture.data()}}, bake_options); }});
    BakeOptions part_options = bake_options;
    part_options.begin_row = 96;
    part_options.end_row = 128;
    BakedTexture part;
    timed.push_back({[&] { part = bake(baked_wall(), {{projector, picture.data()}}, part_options); }});
    const std::vector<VertexRival> rivals = vertex_rivals(grid, kPose, 4096);
    for (const VertexRival& rival : rivals) timed.push_back({rival.run});
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    const auto add_row = [&](const std::string& scheme, double tol, const Times& time, std::size_t count,
                             const std::function<Accuracy()>& error, double bound) {
        if (!settings.wants_scheme(scheme)) return;
        Row row = row_of(scheme, tol, time, count);
        row.ratio_to_exact = times[0].median / static_cast<double>(vertices.size()) / row.ns_per_px;
        row.error = error();
        row.bound_px = bound;
        report.add(row);
    };
    const auto add = [&](const std::string& scheme, double tol, const Times& time,
                         const std::vector<PaintedTriangle>& pieces, double bound) {
        add_row(
            scheme, tol, time, pieces.size(), [&] { return accuracy(projector, pieces); }, bound);
    };
    add("vertices", kNone, times[0], vertices, kNone);
    for (std::size_t i = 0; i < tolerances.size(); ++i)
        add("triangles", tolerances[i].tol, times[i + 1], tolerances[i].pieces,
            tolerances[i].counts.max_error);
    double bound = 0;
    for (const ProjectionGroup& group : groups.groups()) bound = std::max(bound, group.bound);
    add("groups", kNone, times[tolerances.size() + 1], grouped.pieces(), bound);
    add("bake", 0, times[tolerances.size() + 2], texels_of(baked, 256), kNone);
    const auto row_length = static_cast<std::size_t>(3 * 256);
    if (!std::equal(part.pixels.begin(), part.pixels.end(),
                    baked.pixels.begin() + 96 * static_cast<std::ptrdiff_t>(row_length),
                    baked.pixels.begin() + 128 * static_cast<std::ptrdiff_t>(row_length)))
        report.failures.push_back("room, bake_part: its rows are not those of the whole");
    add_row(
        "bake_part", 0, times[tolerances.size() + 3], part.pixels.size() / 3, [] { return Accuracy{}; },
        kNone);
    for (std::size_t i = 0; i < rivals.size(); ++i)
        add_row(
            rivals[i].scheme, kNone, times[tolerances.size() + 4 + i], grid.size(),
            [&] { return rivals[i].accuracy(kShares); }, kNone);
}

void run(const Settings& settings, Report& report) {
    run_room(settings, report);
    run_mosaics(settings, report);
}

const RegisterOp registered({"projection", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_projection
