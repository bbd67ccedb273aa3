// SPDX-License-Identifier: Apache-2.0
#include "anamorph/mesh/mesh_glsl.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "anamorph/error.h"
#include "anamorph/mesh/cells.h"
#include "anamorph/number/glsl_number.h"
#include "anamorph/number/hypot.h"
#include "anamorph/number/rounded.h"

namespace anamorph {
namespace {

/// The point of a fragment. `st`: the parameters of its centre, `x` and `y` the centre itself.
template <class T>
Point<T> fragment_point(const Point<T> (&g)[4][4], const Point<T>& st, const T& x, const T& y,
                        const Point<T>& scale) {
    return displaced(x, y, scale, hermite_sum(g, st.x, st.y));
}

/// A cell's parameters are looked at in so many parts, each way.
constexpr int kParts = 8;

/// A part of them, and a hair more, as they are rounded.
Interval part_of_cell(int part) {
    constexpr double kMore = 1e-6;
    return {double(part) / kParts - kMore, double(part + 1) / kParts + kMore};
}

/// A number that a float stands for, of magnitude `most` at most.
Rounded<float> as_float(double most) {
    using R = Rounded<float>;
    return R(Interval(-most, most), 0, most * R::kUnit + R::kLeast);
}

}  // namespace

std::vector<CellFragments> cell_fragments(const Mesh& mesh) {
    std::vector<CellFragments> cells;
    std::int64_t count = 0;
    const Box whole{0, 0, mesh.from().width, mesh.from().height};
    each_cell_of(mesh, whole, [&](const MeshCell& cell, const Box& pixels) {
        if (++count > kMostFragmentCells) return;
        const Patch patch = mesh.patch(cell);
        CellFragments fragments{pixels, {}, {}};
        for (std::size_t i = 0; i < 16; ++i) {
            const Point<double>& g = patch.g[i / 4][i % 4];
            fragments.patch[2 * i] = static_cast<float>(g.x);
            fragments.patch[2 * i + 1] = static_cast<float>(g.y);
        }
        const double across = cell.x1 - cell.x0, down = cell.y1 - cell.y0;
        fragments.parameters = {static_cast<float>((pixels.x0 + 0.5 - cell.x0) / across),
                                static_cast<float>((pixels.y0 + 0.5 - cell.y0) / down),
                                static_cast<float>(1 / across), static_cast<float>(1 / down)};
        cells.push_back(fragments);
    });
    if (count > kMostFragmentCells)
        throw Error("a mesh of " + std::to_string(count) + " cells: must have at most " +
                    std::to_string(kMostFragmentCells) + " to be drawn by fragments");
    return cells;
}

std::string mesh_glsl(const std::string& name) {
    GlslText text;
    const auto input = [&](const std::string& of) { return text.input(of); };
    Point<GlslNumber> g[4][4];
    for (int i = 0; i < 16; ++i) {
        const std::string element = "g[" + std::to_string(i / 2) + "].";
        g[i / 4][i % 4] = {input(element + (i % 2 ? "z" : "x")), input(element + (i % 2 ? "w" : "y"))};
    }
    const auto along = [&](const std::string& axis, const std::string& first, const std::string& step) {
        const GlslNumber offset = input("pixel." + axis) - input("first." + axis);
        return offset * input("parameters." + step) + input("parameters." + first);
    };
    const Point<GlslNumber> p =
        fragment_point(g, {along("x", "x", "z"), along("y", "y", "w")}, input("pixel.x") + 0.5,
                       input("pixel.y") + 0.5, {input("scale.x"), input("scale.y")});
    return "vec2 " + name + "(vec4 g[8], vec4 parameters, vec2 first, vec2 scale, vec2 pixel) {\n" +
           text.lines() + "  return vec2(" + p.x.written() + ", " + p.y.written() + ");\n}\n";
}

// The sum of what three things do. Parameters: each is the sum of `first`, at most 1, and of offset times step, at most 1. Each of these
// two is rounded once as it is made a float, the product once and the sum once; offsets are whole numbers. That makes 4 units, and one
// more is room for products of two of them. The displacement moves by as much, times its derivatives. Floats: the formula's roundings
// where parameters are as they should be. And the rounding of the elements, in double, to begin with.
double mesh_glsl_bound(const Mesh& mesh) {
    using R = Rounded<float>;
    double most_x[16] = {}, most_y[16] = {};
    mesh.each_cell(0, 0, mesh.from().width, mesh.from().height, [&](const MeshCell& cell) {
        const Patch patch = mesh.patch(cell);
        for (int i = 0; i < 16; ++i) {
            most_x[i] = std::max(most_x[i], std::fabs(patch.g[i / 4][i % 4].x));
            most_y[i] = std::max(most_y[i], std::fabs(patch.g[i / 4][i % 4].y));
        }
    });
    Point<R> rounded[4][4];
    Point<Interval> elements[4][4];
    for (int i = 0; i < 16; ++i) {
        rounded[i / 4][i % 4] = {as_float(most_x[i]), as_float(most_y[i])};
        elements[i / 4][i % 4] = {Interval(-most_x[i], most_x[i]), Interval(-most_y[i], most_y[i])};
    }
    const auto at = [](int size) { return R(Interval(0.5, size - 0.5), 0, 0); };
    const auto scale = [](double of) {
        return R::near(of, static_cast<double>(static_cast<float>(of)) == of ? 0 : of * R::kUnit);
    };
    const Point<R> scales{scale(mesh.scale().x), scale(mesh.scale().y)};
    Point<double> most{0, 0};
    for (int k = 0; k < kParts * kParts; ++k) {
        const Interval s = part_of_cell(k % kParts), t = part_of_cell(k / kParts);
        const Point<R> p = fragment_point(rounded, {R(s, 0, 0), R(t, 0, 0)}, at(mesh.from().width),
                                          at(mesh.from().height), scales);
        using J = Jet1<Interval>;
        const Point<J> d = hermite_sum(elements, J::variable(s, Interval(1), Interval(0)),
                                       J::variable(t, Interval(0), Interval(1)));
        const auto moved = [](const J& of) {
            return 5 * R::kUnit * (magnitude(of.c[1]) + magnitude(of.c[2]));
        };
        most.x = std::max(most.x, p.x.error + moved(d.x));
        most.y = std::max(most.y, p.y.error + moved(d.y));
    }
    const double whole =
        exact_rounding_by_cells(mesh, {0, 0, double(mesh.from().width), double(mesh.from().height)});
    return hypot(most.x, most.y) * (1 + 0x1p-50) + whole;
}

}  // namespace anamorph
