// SPDX-License-Identifier: Apache-2.0
#include "deformed_mesh.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/mat3x3.hpp>
#include <glm/matrix.hpp>
#include <optional>
#include <string>
#include <type_traits>
#include <variant>

#include "surface_normals.h"
#include "vtkAOSDataArrayTemplate.h"
#include "vtkAlgorithm.h"
#include "vtkCellData.h"
#include "vtkDataArray.h"
#include "vtkDoubleArray.h"
#include "vtkFloatArray.h"
#include "vtkNew.h"
#include "vtkPointData.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkSmartPointer.h"

namespace anamorph_vtk {
namespace {

using anamorph::Deformation;
using anamorph::DeformationChange;
using anamorph::DeformedGrid;
using anamorph::DeformedPoints;
using anamorph::Error;
using anamorph::FormulaDisplacement;
using anamorph::FormulaOffsets;
using anamorph::ParallelFor;

/// The values of the columns and rows if points are a grid: u depends on the column alone, v on the row
/// alone.
struct Axes {
    std::vector<double> u, v;
};
std::optional<Axes> axes_of(const std::vector<glm::dvec2>& points) {
    // Narrower ones are not worth it: sums are kept in blocks of 32 columns.
    constexpr std::size_t kLeastColumns = 16;
    std::size_t columns = 1;
    while (columns < points.size() && points[columns].y == points[0].y) ++columns;
    if (columns < kLeastColumns || points.size() % columns != 0) return std::nullopt;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (points[i].x != points[i % columns].x || points[i].y != points[i - i % columns].y)
            return std::nullopt;
    Axes axes;
    for (std::size_t i = 0; i < columns; ++i) axes.u.push_back(points[i].x);
    for (std::size_t i = 0; i < points.size(); i += columns) axes.v.push_back(points[i].y);
    return axes;
}

template <class T>
class MeshOf final : public DeformedMesh {
    using Array = std::conditional_t<std::is_same_v<T, float>, vtkFloatArray, vtkDoubleArray>;

  public:
    MeshOf(vtkPointSet* mesh, vtkDataArray* coordinates, const DeformSettings& settings)
        : m_settings(settings),
          m_mesh_time(mesh->GetMTime()),
          m_source(mesh->GetPoints()->GetData()),
          m_coordinates(coordinates),
          m_base(base_of(m_source)) {
        read_parameters();
        start();
    }

    /// Times are given once only, so that of the mesh tells it from others too.
    bool fits(vtkPointSet* mesh, vtkDataArray* coordinates, const DeformSettings& settings) const override {
        return settings == m_settings && mesh->GetMTime() == m_mesh_time && coordinates == m_coordinates;
    }

    void set_formula(const std::optional<FormulaDisplacement>& formula,
                     const ParallelFor& parallel_for) override {
        if (formula == m_formula) return;
        m_formula = formula;
        m_offsets = formula ? formula->offsets(m_parameters, parallel_for) : FormulaOffsets();
        give_offsets();
        forget_written();
    }

    const FormulaOffsets& offsets() const override { return m_offsets; }

    vtkIdType deform(const std::vector<Deformation>& list, vtkPointSet* out, Execution& execution,
                     double begin, double end) override {
        follow_depth(list, out);
        std::vector<DeformationChange> changes = difference(m_list, list);
        if (changes.size() > list.size()) {
            // Starting from scratch is less work.
            start();
            changes = difference({}, list);
        }
        m_list = list;
        const vtkIdType written = draw(changes, out, execution, begin, end);
        hand_out(out);
        return written;
    }

    Jacobian write_jacobians(vtkPointSet* out, const ParallelFor& parallel_for) override {
        vtkNew<vtkDoubleArray> array;
        array->SetName("Jacobian");
        array->SetNumberOfTuples(static_cast<vtkIdType>(size()));
        double* const to = array->GetPointer(0);
        const anamorph::ParameterPlane& plane = m_settings.plane;
        const auto take = [&](const anamorph::SurfaceSlopes& slopes) {
            if (m_formula) m_formula->add_slopes(m_parameters, slopes);
            for (int k = 0; k < slopes.count; ++k) {
                glm::dmat3 by(1.0);
                by += glm::outerProduct(slopes.by_u(k), plane.gradient_u()) +
                      glm::outerProduct(slopes.by_v(k), plane.gradient_v());
                if (slopes.parameters > 2)
                    by += glm::outerProduct(glm::dvec3(slopes.by[6][k], slopes.by[7][k], slopes.by[8][k]),
                                            plane.normal());
                to[slopes.point(k)] = glm::determinant(by);
            }
        };
        if (const auto* grid = std::get_if<DeformedGrid>(&m_surface))
            grid->slopes(m_list, nullptr, take, parallel_for);
        else
            std::get<DeformedPoints>(m_surface).slopes(m_list, nullptr, take, parallel_for);
        for (const vtkIdType i : m_unmoved) to[i] = 1;
        out->GetPointData()->AddArray(array);
        Jacobian least;
        for (std::size_t i = 0; i < size(); ++i)
            if (to[i] < least.determinant) least = {Triples(m_source)[static_cast<std::int64_t>(i)], to[i]};
        return least;
    }

    const std::vector<glm::dvec2>& parameters() const override { return m_parameters; }
    const anamorph::PointDepths& depths() const override { return m_depths; }

  private:
    std::size_t size() const { return m_parameters.size(); }

    static vtkSmartPointer<Array> new_array(std::size_t points) {
        auto array = vtkSmartPointer<Array>::New();
        array->SetNumberOfComponents(3);
        array->SetNumberOfTuples(static_cast<vtkIdType>(points));
        return array;
    }

    /// The points as T, without gaps.
    static vtkSmartPointer<vtkAOSDataArrayTemplate<T>> base_of(vtkDataArray* source) {
        if (auto* same = vtkAOSDataArrayTemplate<T>::FastDownCast(source)) return same;
        vtkSmartPointer<Array> copy = new_array(static_cast<std::size_t>(source->GetNumberOfTuples()));
        copy->DeepCopy(source);
        return copy;
    }

    void read_parameters() {
        vtkDataArray* source = m_settings.on_plane ? m_source : m_coordinates;
        const Triples points(m_source);
        const auto parameters_of = [&](vtkIdType i) {
            if (m_settings.on_plane) return m_settings.plane.parameters(points[i]);
            double tuple[9];
            source->GetTuple(i, tuple);
            return glm::dvec2(tuple[0], tuple[1]);
        };
        const vtkIdType count = source->GetNumberOfTuples();
        m_parameters.reserve(static_cast<std::size_t>(count));
        for (vtkIdType i = 0; i < count; ++i) {
            m_parameters.push_back(parameters_of(i));
            if (!is_finite(m_parameters.back())) m_unmoved.push_back(i);
        }
    }

    /// Starts anew where a list begins to need depths or normals, or no longer does. mesh: the undeformed one.
    void follow_depth(const std::vector<Deformation>& list, vtkPointSet* mesh) {
        const bool deep = needs_depth(list), sided = needs_normals(list);
        if (deep == m_deep && sided == m_sided) return;
        m_depths = {};
        if (deep) {
            read_depths();
            m_depths.normal.assign(size(), glm::dvec3(0.0));
            if (sided) read_normals(mesh);
        }
        m_deep = deep;
        m_sided = sided;
        m_surface_normals.reset();
        start();
    }

    void read_depths() {
        if (!m_settings.on_plane && m_coordinates->GetNumberOfComponents() < 3)
            throw Error("deformations with depth or side need texture coordinates of 3 components, not " +
                        std::to_string(m_coordinates->GetNumberOfComponents()) +
                        ": the third is the depth (or use the plane)");
        const Triples points(m_source);
        for (std::size_t i = 0; i < size(); ++i) {
            const auto id = static_cast<vtkIdType>(i);
            m_depths.w.push_back(m_settings.on_plane ? m_settings.plane.depth(points[id])
                                                     : m_coordinates->GetComponent(id, 2));
        }
    }

    /// The unit normals of the undeformed mesh: its own, or those of its cells; 0 where there is none.
    void read_normals(vtkPointSet* mesh) {
        find_given(mesh);
        if (m_given) {
            const Triples given(m_given);
            for (std::size_t i = 0; i < size(); ++i) m_depths.normal[i] = given[static_cast<std::int64_t>(i)];
        } else {
            const SurfaceNormals of_cells(mesh, m_parameters,
                                          m_settings.on_plane ? &m_settings.plane : nullptr, nullptr);
            constexpr std::int64_t kAtOnce = anamorph::SurfaceSlopes::kMost;
            double none[6][kAtOnce] = {};
            std::vector<double> normals(3 * size());
            for (std::int64_t first = 0; first < static_cast<std::int64_t>(size()); first += kAtOnce) {
                const std::int64_t count = std::min(kAtOnce, static_cast<std::int64_t>(size()) - first);
                of_cells.write({static_cast<int>(count), first, nullptr, none}, normals.data());
            }
            for (std::size_t i = 0; i < size(); ++i)
                m_depths.normal[i] = {normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]};
        }
        for (glm::dvec3& n : m_depths.normal) {
            const double length = glm::length(n);
            n = length > 0 && std::isfinite(length) ? n / length : glm::dvec3(0.0);
        }
    }

    /// The surface without deformations, of which nothing is written yet.
    void start() {
        const std::vector<glm::dvec2> parameters = with_finite_parameters(m_parameters);
        if (m_deep)
            m_surface.emplace<DeformedPoints>(parameters, m_depths, m_settings.options);
        else if (std::optional<Axes> axes = axes_of(parameters))
            m_surface.emplace<DeformedGrid>(std::move(axes->u), std::move(axes->v), m_settings.options);
        else
            m_surface.emplace<DeformedPoints>(parameters, m_settings.options);
        give_offsets();
        m_list.clear();
        forget_written();
    }

    void give_offsets() {
        const double* const values = m_formula ? m_offsets.values.data() : nullptr;
        if (auto* grid = std::get_if<DeformedGrid>(&m_surface))
            grid->set_offsets(values);
        else
            std::get<DeformedPoints>(m_surface).set_offsets(values);
    }

    void forget_written() { m_points = m_displacement = m_normals = nullptr; }

    /// Makes an array ours alone, to be written.
    void own(vtkSmartPointer<Array>& array) {
        if (array->GetReferenceCount() > 1) {
            vtkSmartPointer<Array> copy = vtkSmartPointer<Array>::New();
            copy->DeepCopy(array);
            array = copy;
        }
        array->Modified();
    }

    /// Brings points and normals up to date; the number of points that were written. mesh: a shallow copy of
    /// the undeformed one.
    vtkIdType draw(const std::vector<DeformationChange>& changes, vtkPointSet* mesh, Execution& execution,
                   double begin, double end) {
        const bool all = !m_points;
        if (!all && changes.empty()) return 0;
        begin_points();
        if (m_settings.normals) begin_normals(mesh);
        vtkIdType written = static_cast<vtkIdType>(size());
        auto* scattered = std::get_if<DeformedPoints>(&m_surface);
        if (scattered && all && m_settings.normals) {
            scattered->write_with_slopes(m_list, m_base->GetPointer(0), m_points->GetPointer(0),
                                         normals_writer(), execution.stage(begin, end), displacement());
        } else {
            const double middle = m_settings.normals ? begin + (end - begin) * 0.5 : end;
            written = move_points(changes, all, execution.stage(begin, middle));
            if (m_settings.normals) turn_normals(changes, all, execution.stage(middle, end));
        }
        keep_unmoved();
        return written;
    }

    /// Makes room for points, and for displacements if they are wanted.
    void begin_points() {
        if (!m_points) {
            m_points = new_array(size());
            if (m_settings.displacement) m_displacement = new_array(size());
        }
        own(m_points);
        if (m_displacement) own(m_displacement);
    }
    T* displacement() const { return m_displacement ? m_displacement->GetPointer(0) : nullptr; }

    void find_given(vtkPointSet* mesh) {
        m_given = mesh->GetPointData()->GetNormals();
        if (m_given && (m_given->GetNumberOfComponents() != 3 ||
                        m_given->GetNumberOfTuples() != static_cast<vtkIdType>(size())))
            m_given = nullptr;
    }

    /// Makes room for normals.
    void begin_normals(vtkPointSet* mesh) {
        if (!m_normals) {
            find_given(mesh);
            // How the normals that sides go by change along the surface is known from cells alone.
            if (!m_surface_normals)
                m_surface_normals.emplace(mesh, m_parameters,
                                          m_settings.on_plane ? &m_settings.plane : nullptr,
                                          m_sided ? nullptr : m_given.Get(), m_deep ? &m_depths : nullptr);
            m_normals = new_array(size());
            m_normals->SetName(m_given && m_given->GetName() ? m_given->GetName() : "Normals");
        }
        own(m_normals);
    }
    anamorph::TakeSlopes normals_writer() {
        return [this, to = m_normals->GetPointer(0)](const anamorph::SurfaceSlopes& slopes) {
            if (m_formula) m_formula->add_slopes(m_parameters, slopes);
            m_surface_normals->write(slopes, to);
        };
    }

    vtkIdType move_points(const std::vector<DeformationChange>& changes, bool all,
                          const ParallelFor& parallel_for) {
        const T* const base = m_base->GetPointer(0);
        T* const points = m_points->GetPointer(0);
        const auto everything = static_cast<vtkIdType>(size());
        if (auto* grid = std::get_if<DeformedGrid>(&m_surface)) {
            grid->apply(changes);
            if (all) {
                grid->write(base, points, parallel_for, displacement());
                return everything;
            }
            const anamorph::GridPart part = grid->update(base, points, parallel_for, displacement());
            if (part.empty()) return 0;
            return vtkIdType{part.column_end - part.column_begin} * (part.row_end - part.row_begin);
        }
        auto& scattered = std::get<DeformedPoints>(m_surface);
        scattered.apply(changes);
        if (!all) return scattered.update(base, points, parallel_for, displacement());
        scattered.write(base, points, parallel_for, displacement());
        return everything;
    }

    void turn_normals(const std::vector<DeformationChange>& changes, bool all,
                      const ParallelFor& parallel_for) {
        const auto take = normals_writer();
        if (const auto* grid = std::get_if<DeformedGrid>(&m_surface))
            grid->slopes(m_list, all ? nullptr : &changes, take, parallel_for);
        else
            std::get<DeformedPoints>(m_surface).slopes(m_list, all ? nullptr : &changes, take, parallel_for);
    }

    /// Points whose parameters are not finite stay as they were, normals and all.
    void keep_unmoved() {
        for (const vtkIdType i : m_unmoved) {
            std::copy_n(m_base->GetPointer(3 * i), 3, m_points->GetPointer(3 * i));
            if (m_displacement) std::fill_n(m_displacement->GetPointer(3 * i), 3, T(0));
            if (!m_normals) continue;
            double n[3] = {};
            if (m_given) m_given->GetTuple(i, n);
            for (int c = 0; c < 3; ++c) m_normals->GetPointer(3 * i)[c] = static_cast<T>(n[c]);
        }
    }

    void hand_out(vtkPointSet* out) {
        vtkNew<vtkPoints> points;
        points->SetData(m_points);
        out->SetPoints(points);
        // The old ones do not fit the deformed mesh.
        out->GetPointData()->SetNormals(m_normals);
        out->GetCellData()->SetNormals(nullptr);
        if (!m_displacement) return;
        m_displacement->SetName("Displacement");
        out->GetPointData()->AddArray(m_displacement);
    }

    DeformSettings m_settings;
    vtkMTimeType m_mesh_time;  ///< when the mesh was last changed
    vtkSmartPointer<vtkDataArray> m_source, m_coordinates;
    vtkSmartPointer<vtkAOSDataArrayTemplate<T>> m_base;
    std::vector<glm::dvec2> m_parameters;
    std::vector<vtkIdType> m_unmoved;      ///< points whose parameters are not finite
    bool m_deep = false, m_sided = false;  ///< does the list need depths, and normals?
    anamorph::PointDepths m_depths;        ///< if so
    std::variant<std::monostate, DeformedGrid, DeformedPoints> m_surface;
    std::optional<FormulaDisplacement> m_formula;
    FormulaOffsets m_offsets;  ///< of all points, which the surface refers to
    std::optional<SurfaceNormals> m_surface_normals;
    vtkSmartPointer<vtkDataArray> m_given;  ///< the undeformed mesh's normals, or null
    std::vector<Deformation> m_list;        ///< that the surface and the arrays are of
    vtkSmartPointer<Array> m_points, m_displacement, m_normals;
};

}  // namespace

std::unique_ptr<DeformedMesh> DeformedMesh::make(vtkPointSet* mesh, vtkDataArray* coordinates,
                                                 const DeformSettings& settings) {
    const vtkIdType count = mesh->GetNumberOfPoints();
    if (count == 0) return nullptr;
    if (count > kMostPoints)
        throw Error("the mesh has " + std::to_string(count) + " points, but must have fewer than 2^31");
    if (!settings.on_plane) {
        if (!coordinates)
            throw Error("there are no texture coordinates: choose a point array, or use the plane");
        if (coordinates->GetNumberOfTuples() != count || coordinates->GetNumberOfComponents() < 2 ||
            coordinates->GetNumberOfComponents() > 9)
            throw Error(std::string("texture coordinates ") +
                        (coordinates->GetName() ? coordinates->GetName() : "") +
                        ": must have 2 to 9 components at every point, not " +
                        std::to_string(coordinates->GetNumberOfComponents()) + " at " +
                        std::to_string(coordinates->GetNumberOfTuples()) + " of " + std::to_string(count));
    }
    const bool single = settings.precision == vtkAlgorithm::SINGLE_PRECISION ||
                        (settings.precision == vtkAlgorithm::DEFAULT_PRECISION &&
                         mesh->GetPoints()->GetDataType() == VTK_FLOAT);
    if (single) return std::make_unique<MeshOf<float>>(mesh, coordinates, settings);
    return std::make_unique<MeshOf<double>>(mesh, coordinates, settings);
}

}  // namespace anamorph_vtk
