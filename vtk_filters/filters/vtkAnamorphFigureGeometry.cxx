// SPDX-License-Identifier: Apache-2.0
#include "vtkAnamorphFigureGeometry.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <numbers>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/body/surface_steps.h"
#include "anamorph/parameter/parameter.h"
#include "execution.h"
#include "figure_data.h"
#include "vtkAOSDataArrayTemplate.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkIdTypeArray.h"
#include "vtkNew.h"
#include "vtkObjectFactory.h"
#include "vtkPointData.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"

vtkObjectFactoryNewMacro(vtkAnamorphFigureGeometry);

namespace {

using anamorph::Error;
using anamorph::figure::Ellipsoid;
using anamorph::figure::View;

constexpr double kPi = std::numbers::pi;
/// About 0.8 GB with the arrays of the bodies; a renderer needs as much again.
constexpr vtkIdType kMostTriangles = vtkIdType{1} << 22;

/// A grid over an ellipsoid. Its poles are a point for each column, between the grid's lines.
struct Grid {
    vtkIdType body = 0;
    Ellipsoid shape;
    int rows = 0, columns = 0;  ///< cells from the bottom up, and around
    double bound = 0;
    vtkIdType first_point = 0, first_triangle = 0;

    vtkIdType points() const { return vtkIdType{rows - 1} * (columns + 1) + 2 * columns; }
    vtkIdType triangles() const { return vtkIdType{rows - 1} * columns * 2; }
    vtkIdType end_point() const { return first_point + points(); }
    vtkIdType end_triangle() const { return first_triangle + triangles(); }
};

/// A point of the input and how far its surface may be off, in units.
struct Body {
    vtkIdType id;
    Ellipsoid shape;
    double tolerance;
};

Grid grid_of(vtkIdType body, const Ellipsoid& shape, double tolerance) {
    const auto steps = anamorph::figure::surface_steps(shape.axes, tolerance);
    if (!steps)
        throw Error("Tolerance", anamorph::shortest(tolerance),
                    "is too small for ellipsoid " + std::to_string(body) + ", which may have at most " +
                        std::to_string(anamorph::figure::kMostSurfaceSteps) + " steps around it");
    return {body, shape, steps->rows, steps->columns, steps->bound};
}

/// The grids of all bodies, one after the other.
std::vector<Grid> grids_of(const std::vector<Body>& bodies) {
    std::vector<Grid> grids;
    for (const Body& body : bodies) {
        Grid grid = grid_of(body.id, body.shape, body.tolerance);
        if (!grids.empty()) {
            grid.first_point = grids.back().end_point();
            grid.first_triangle = grids.back().end_triangle();
        }
        grids.push_back(grid);
    }
    return grids;
}

/// Refuses what would take too much memory, and says with which tolerance it would not.
void check_size(const std::vector<Body>& bodies, double tolerance) {
    const auto triangles = [&](double factor) {
        vtkIdType sum = 0;
        for (const Body& body : bodies)
            sum += grid_of(body.id, body.shape, factor * body.tolerance).triangles();
        return sum;
    };
    const vtkIdType needed = triangles(1);
    if (needed <= kMostTriangles) return;
    const std::string rule = "needs " + std::to_string(needed) + " triangles, but there must be at most " +
                             std::to_string(kMostTriangles);
    constexpr double kMostFactor = 1 << 20;
    for (double factor = 2; factor <= kMostFactor; factor *= 2)
        if (triangles(factor) <= kMostTriangles)
            throw Error("Tolerance", anamorph::shortest(tolerance),
                        rule + "; " + anamorph::shortest(factor * tolerance) + " needs no more");
    throw Error("Tolerance", anamorph::shortest(tolerance), rule);
}

/// At most how far a point, from the middle of a body in its own axes, is from the body's surface. Outside, a plane between
/// the two is as far from it as it says, whatever its normal n: n p - |a n|. The normal at the nearest point is
/// best, which is at a^2 p / (a^2 + t) where sum (a p / (a^2 + t))^2 = 1 (Eberly 2013): the sum falls as t grows, and
/// is at most 1 at t = |a p|. Inside, the body holds the sphere of radius 1 - |p / a| times its least half axis.
double distance_bound(const glm::dvec3& a, const glm::dvec3& p) {
    const double from_middle = glm::length(p / a), least = std::min({a.x, a.y, a.z});
    if (from_middle <= 1) return (1 - from_middle) * least;
    double low = 0, high = glm::length(a * p);
    for (int i = 0; i < 64; ++i) {
        const double t = 0.5 * (low + high);
        (glm::length(a * p / (a * a + t)) > 1 ? low : high) = t;
    }
    glm::dvec3 n;
    for (int k = 0; k < 3; ++k) n[k] = a[k] > 0 ? p[k] * (high / (a[k] * a[k] + high)) : p[k];
    n /= glm::length(n);
    return std::max(0.0, glm::dot(n, p) - glm::length(a * n));
}

/// Most that a point of a body may move for the picture to move by `pixels`. In perspective the image of q +
/// d is zoom (d.xy - q.xy / q.z d.z) / (q.z + d.z) from that of q, and on the screen |q.xy| / q.z <= slope. So a point
/// that is seen has a depth of at least its distance from the eye over |(1, slope)|.
double tolerance_in_units(double pixels, const Ellipsoid& shape, const View& view, double half_diagonal) {
    if (!view.perspective()) return pixels / view.scale;
    const double zoom = view.scale * view.eye_distance, slope = half_diagonal / zoom;
    const glm::dvec3 away(view.rotation[0][2], view.rotation[1][2], view.rotation[2][2]);
    const double reach = glm::length(shape.axes * (away * shape.rotation));
    const glm::dvec3 eye = view.center - view.eye_distance * away;
    const double distance = distance_bound(shape.axes, (eye - shape.center) * shape.rotation);
    const double nearest =
        std::max({view.to_view(shape.center).z - reach, distance / std::hypot(1, slope), view.near});
    return pixels * nearest / (zoom * std::hypot(1, slope) + pixels);
}

/// Writes a grid's points and triangles where they belong. Real: of the points.
template <class Real>
struct Surface {
    Real* points;
    float *normals, *texture;
    vtkIdType* triangles;

    void write(const Grid& grid) const {
        vtkIdType i = grid.first_point;
        const auto vertex = [&](int row, double column) {
            const double v = 1.0 * row / grid.rows, u = column / grid.columns;
            const double t = kPi * (v - 0.5), p = kPi * (1 - 2 * u);
            const double c = row == 0 || row == grid.rows ? 0 : std::cos(t);
            // The point of the unit sphere; -cos p, because z is negated.
            const glm::dvec3 s(c * std::sin(p), std::sin(t), -c * std::cos(p));
            put(points, i, grid.shape.center + grid.shape.rotation * (grid.shape.axes * s));
            put(normals, i, grid.shape.rotation * normal(grid.shape.axes, s));
            texture[2 * i] = static_cast<float>(u);
            texture[2 * i + 1] = static_cast<float>(v);
            ++i;
        };
        for (int column = 0; column < grid.columns; ++column) vertex(0, column + 0.5);
        for (int row = 1; row < grid.rows; ++row)
            for (int column = 0; column <= grid.columns; ++column) vertex(row, column);
        for (int column = 0; column < grid.columns; ++column) vertex(grid.rows, column + 0.5);
        write_triangles(grid);
    }

    void write_triangles(const Grid& grid) const {
        vtkIdType* to = triangles + 3 * grid.first_triangle;
        const auto triangle = [&](vtkIdType a, vtkIdType b, vtkIdType c) {
            for (const vtkIdType corner : {a, b, c}) *to++ = grid.first_point + corner;
        };
        const vtkIdType wide = grid.columns + 1, top = grid.columns + (grid.rows - 1) * wide;
        for (int column = 0; column < grid.columns; ++column) {
            vtkIdType below = grid.columns + column;
            triangle(column, below + 1, below);
            for (int row = 1; row < grid.rows - 1; ++row, below += wide) {
                triangle(below, below + 1, below + wide + 1);
                triangle(below, below + wide + 1, below + wide);
            }
            triangle(below, below + 1, top + column);
        }
    }

    /// Along s / a, times the product of the axes: so bodies without volume have normals where they can.
    static glm::dvec3 normal(const glm::dvec3& a, const glm::dvec3& s) {
        const glm::dvec3 unit = a / std::max({a.x, a.y, a.z, 1e-300});
        const glm::dvec3 n(s.x * unit.y * unit.z, s.y * unit.z * unit.x, s.z * unit.x * unit.y);
        const double length = glm::length(n);
        return length > 0 ? n / length : s;
    }

    template <class T>
    static void put(T* to, vtkIdType i, const glm::dvec3& v) {
        for (int k = 0; k < 3; ++k) to[3 * i + k] = static_cast<T>(v[k]);
    }
};

template <class Array>
vtkSmartPointer<Array> new_array(const char* name, int components, vtkIdType tuples) {
    auto array = vtkSmartPointer<Array>::New();
    array->SetName(name);
    array->SetNumberOfComponents(components);
    array->SetNumberOfTuples(tuples);
    return array;
}

template <class Real>
void tessellate(const std::vector<Grid>& grids, vtkIdType points, vtkIdType triangles, vtkPolyData* output,
                const anamorph::ParallelFor& parallel_for) {
    const auto positions = new_array<vtkAOSDataArrayTemplate<Real>>("Points", 3, points);
    const auto normals = new_array<vtkFloatArray>("Normals", 3, points);
    const auto texture = new_array<vtkFloatArray>("TextureCoordinates", 2, points);
    const auto corners = new_array<vtkIdTypeArray>("", 1, 3 * triangles);
    const auto offsets = new_array<vtkIdTypeArray>("", 1, triangles + 1);
    for (vtkIdType k = 0; k <= triangles; ++k) offsets->SetValue(k, 3 * k);
    const Surface<Real> surface{positions->GetPointer(0), normals->GetPointer(0), texture->GetPointer(0),
                                corners->GetPointer(0)};
    parallel_for(static_cast<std::int64_t>(grids.size()),
                 [&](std::int64_t i) { surface.write(grids[static_cast<std::size_t>(i)]); });
    vtkNew<vtkPoints> holder;
    holder->SetData(positions);
    output->SetPoints(holder);
    vtkNew<vtkCellArray> cells;
    cells->SetData(offsets, corners);
    output->SetPolys(cells);
    output->GetPointData()->SetNormals(normals);
    output->GetPointData()->SetTCoords(texture);
}

/// The arrays of the bodies, for each triangle.
void write_cell_data(const std::vector<Grid>& grids, vtkIdType triangles, vtkPolyData* input,
                     vtkPolyData* output) {
    vtkCellData* data = output->GetCellData();
    anamorph_vtk::allocate_cell_data(input, triangles, data);
    const auto bodies = new_array<vtkIdTypeArray>("BodyId", 1, triangles);
    const auto bounds = new_array<vtkDoubleArray>("ChordalBound", 1, triangles);
    for (const Grid& grid : grids)
        for (vtkIdType k = 0; k < grid.triangles(); ++k) {
            const vtkIdType cell = grid.first_triangle + k;
            data->CopyData(input->GetPointData(), grid.body, cell);
            bodies->SetValue(cell, grid.body);
            bounds->SetValue(cell, grid.bound);
        }
    data->AddArray(bodies);
    data->AddArray(bounds);
}

}  // namespace

vtkAnamorphFigureGeometry::vtkAnamorphFigureGeometry() = default;
vtkAnamorphFigureGeometry::~vtkAnamorphFigureGeometry() = default;

void vtkAnamorphFigureGeometry::Draw(vtkPolyData* input, vtkDataObject* data,
                                     anamorph_vtk::Execution& execution) {
    anamorph::figure::kSurfaceTolRow.check(this->Tolerance, "Tolerance");
    const anamorph_vtk::FigureData figures(input);
    const View view = this->ToleranceMode == PIXELS ? this->ViewOf(input) : View();
    const double half_diagonal = 0.5 * std::hypot(this->ViewSize[0], this->ViewSize[1]);
    std::vector<Body> bodies;
    for (vtkIdType i = 0; i < figures.size(); ++i)
        if (const auto shape = figures.ellipsoid(i))
            bodies.push_back({i, *shape,
                              this->ToleranceMode == PIXELS
                                  ? tolerance_in_units(this->Tolerance, *shape, view, half_diagonal)
                                  : this->Tolerance});
    check_size(bodies, this->Tolerance);
    const std::vector<Grid> grids = grids_of(bodies);
    const vtkIdType points = grids.empty() ? 0 : grids.back().end_point(),
                    triangles = grids.empty() ? 0 : grids.back().end_triangle();
    execution.progress(0.1);
    const auto parallel_for = execution.stage(0.1, 0.9);
    auto* output = vtkPolyData::SafeDownCast(data);
    if (this->OutputPointsPrecision == DOUBLE_PRECISION)
        tessellate<double>(grids, points, triangles, output, parallel_for);
    else
        tessellate<float>(grids, points, triangles, output, parallel_for);
    write_cell_data(grids, triangles, input, output);
}

void vtkAnamorphFigureGeometry::PrintSelf(ostream& os, vtkIndent indent) {
    this->Superclass::PrintSelf(os, indent);
    os << indent << "ToleranceMode: " << (this->ToleranceMode == UNITS ? "units" : "pixels") << "\n"
       << indent << "Tolerance: " << this->Tolerance << "\n"
       << indent << "OutputPointsPrecision: " << this->OutputPointsPrecision << "\n";
}
