// SPDX-License-Identifier: Apache-2.0
#include "default_bump.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>

#include "automatic_plane.h"
#include "deform_overlay.h"
#include "ranks.h"
#include "subdivided.h"
#include "surface_normals.h"
#include "vtkCommunicator.h"
#include "vtkGeometryFilter.h"
#include "vtkMultiProcessController.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTriangle.h"

namespace anamorph_vtk {
namespace {

using anamorph::Deformation;

/// From the middle to the eye: what looks this way shows at the upper right of ParaView's first view, and stands out there.
const glm::dvec3 kToEye = glm::normalize(glm::dvec3(1.0));
/// Of the data's diagonal: points that are nearer to each other are one.
constexpr double kSame = 1e-6;

glm::dvec3 point_of(vtkPointSet* mesh, vtkIdType id) {
    glm::dvec3 p;
    mesh->GetPoint(id, &p.x);
    return p;
}

/// What is seen of a mesh, and the parameters of its points.
struct Surface {
    vtkSmartPointer<vtkPointSet> mesh;
    std::function<glm::dvec2(vtkIdType)> parameters;
    bool has_subdivisions = false;
};

/// The faces of bodies are seen of a mesh; its lines and single points are left as they are.
vtkSmartPointer<vtkPointSet> faces_of(vtkPointSet* mesh) {
    if (vtkPolyData::SafeDownCast(mesh)) return mesh;
    vtkNew<vtkGeometryFilter> faces;
    faces->SetInputData(mesh);
    faces->Update();
    return faces->GetOutput();
}

template <class Points>
std::array<glm::dvec3, 2> box_of(const Points& points) {
    glm::dvec3 least(Bounds::kInfinity), most(-Bounds::kInfinity);
    for (const glm::dvec3& p : points) {
        least = glm::min(least, p);
        most = glm::max(most, p);
    }
    return {least, most};
}
/// How far along an axis a point is from a box at least; negative inside.
double apart(const glm::dvec3& least, const glm::dvec3& most, const glm::dvec3& point) {
    const glm::dvec3 off = glm::max(least - point, point - most);
    return std::max({off.x, off.y, off.z});
}

/// A place on a surface, and which side of its cells is the outer one.
struct Place {
    glm::dvec3 point{0.0};
    glm::dvec2 parameters{0.0};
    double turn = 1;  ///< of the cells' normals: -1 where they look inwards
    bool found = false;
};

class Search {
  public:
    Search(std::vector<Surface> surfaces, const anamorph::ParameterPlane* plane,
           vtkMultiProcessController* controller)
        : m_surfaces(std::move(surfaces)), m_plane(plane), m_controller(controller) {}

    std::optional<DefaultBump> find() {
        measure();
        if (m_bounds.empty()) return std::nullopt;
        Place place = middle();
        bool deep = false;
        if (!place.found) {
            place = seen_from_the_eye();
            deep = m_plane != nullptr;
        }
        if (!place.found) place = corner_nearest_the_eye();
        DefaultBump found{bump_at(place, deep, 1, false)};
        found.points = points_in(found.bump);
        if (found.points >= DefaultBump::kEnough) return found;
        found.subdivisions = subdivisions_at(place);
        if (found.subdivisions > 0) return found;
        // Onto a point, and as far as the next.
        place = nearest_point(place);
        const double grown = std::clamp(next_point(place.point) / width(), 1.0, 2.0);
        found.bump = bump_at(place, deep, m_plane ? grown : 1, true);
        found.points = points_in(found.bump);
        return found;
    }

  private:
    template <class Body>
    void each_point(const Body& body) const {
        for (const Surface& surface : m_surfaces)
            for (vtkIdType i = 0; i < surface.mesh->GetNumberOfPoints(); ++i) {
                const glm::dvec3 p = point_of(surface.mesh, i);
                const glm::dvec2 s = surface.parameters(i);
                if (std::isfinite(p.x + p.y + p.z) && is_finite(s)) body(p, s);
            }
    }

    void reduce(double* numbers, int count, int operation) const {
        if (!distributed(m_controller)) return;
        const std::vector<double> own(numbers, numbers + count);
        m_controller->AllReduce(own.data(), numbers, count, operation);
    }

    /// Finds the bounds in space, in the parameters and in depth.
    void measure() {
        double least[6], most[6];
        std::fill_n(least, 6, Bounds::kInfinity);
        std::fill_n(most, 6, -Bounds::kInfinity);
        each_point([&](const glm::dvec3& p, glm::dvec2 s) {
            const double all[6] = {p.x, p.y, p.z, s.x, s.y, m_plane ? m_plane->depth(p) : 0};
            for (int c = 0; c < 6; ++c) {
                least[c] = std::min(least[c], all[c]);
                most[c] = std::max(most[c], all[c]);
            }
        });
        reduce(least, 6, vtkCommunicator::MIN_OP);
        reduce(most, 6, vtkCommunicator::MAX_OP);
        std::copy_n(least, 3, m_bounds.least);
        std::copy_n(most, 3, m_bounds.most);
        if (m_bounds.empty()) return;
        m_center = {least[0] / 2 + most[0] / 2, least[1] / 2 + most[1] / 2, least[2] / 2 + most[2] / 2};
        m_diagonal = std::hypot(m_bounds.length(0), m_bounds.length(1), m_bounds.length(2));
        for (int i = 0; i < 2; ++i) {
            m_middle[i] = least[3 + i] / 2 + most[3 + i] / 2;
            m_extent[i] = most[3 + i] > least[3 + i] ? (most[3 + i] - least[3 + i]) / 6 : 1;
        }
        m_depths = {least[5], most[5]};
    }

    /// The middle of the plane, if no more than one part of the surface is over it.
    Place middle() const {
        Place place;
        if (!m_plane) return place;
        place.parameters = m_middle;
        place.point = m_plane->point(m_middle);
        // From above all to below all. What several triangles share is met several times.
        const double beyond = std::max(m_diagonal, 1.0);
        const glm::dvec3 from = place.point + (m_depths[1] + beyond) * m_plane->normal(),
                         to = place.point + (m_depths[0] - beyond) * m_plane->normal();
        double least = Bounds::kInfinity, most = -Bounds::kInfinity;
        for (const Surface& surface : m_surfaces)
            for_each_meeting(from, to, surface.mesh, surface.mesh, [&](const MetPoint& met, const auto&) {
                const double depth = m_plane->depth(met.point);
                least = std::min(least, depth);
                most = std::max(most, depth);
            });
        reduce(&least, 1, vtkCommunicator::MIN_OP);
        reduce(&most, 1, vtkCommunicator::MAX_OP);
        const bool flat = m_depths[1] - m_depths[0] <= kSame * m_diagonal;
        place.found = flat || (least <= most && most - least <= kSame * m_diagonal);
        if (place.found) place.point += (least <= most ? least : m_depths[0]) * m_plane->normal();
        return place;
    }

    Place seen_from_the_eye() const {
        const double beyond = std::max(m_diagonal, 1.0);
        const glm::dvec3 from = m_center + beyond * kToEye, to = m_center - beyond * kToEye;
        Place best;
        double first = kNowhere;
        for (const Surface& surface : m_surfaces)
            for_each_meeting(from, to, surface.mesh, surface.mesh,
                             [&](const MetPoint& met, const std::array<vtkIdType, 3>& corners) {
                                 if (!(met.along < first)) return;
                                 first = met.along;
                                 best = place_in(surface, corners, met.point);
                             });
        return of_best_rank(best, first);
    }

    /// A point of a triangle that the line from the eye meets.
    static Place place_in(const Surface& surface, const std::array<vtkIdType, 3>& corners,
                          const glm::dvec3& point) {
        const glm::dvec3 a = point_of(surface.mesh, corners[0]), b = point_of(surface.mesh, corners[1]) - a,
                         c = point_of(surface.mesh, corners[2]) - a, normal = glm::cross(b, c), p = point - a;
        const double y = glm::dot(glm::cross(p, c), normal) / glm::dot(normal, normal),
                     z = glm::dot(glm::cross(b, p), normal) / glm::dot(normal, normal);
        const glm::dvec2 s = (1 - y - z) * surface.parameters(corners[0]) +
                             y * surface.parameters(corners[1]) + z * surface.parameters(corners[2]);
        return {point, s, glm::dot(normal, kToEye) < 0 ? -1.0 : 1.0, is_finite(s)};
    }

    Place corner_nearest_the_eye() const {
        return best_point([](const glm::dvec3& p) { return -glm::dot(p, kToEye); }, 1);
    }
    /// Of several that are as near, the one nearest the eye.
    Place nearest_point(const Place& place) const {
        return best_point(
            [&](const glm::dvec3& p) {
                return glm::distance(p, place.point) - kSame * glm::dot(p - m_center, kToEye);
            },
            place.turn);
    }
    template <class Measure>
    Place best_point(const Measure& measure, double turn) const {
        Place best;
        double least = kNowhere;
        each_point([&](const glm::dvec3& p, glm::dvec2 s) {
            if (const double here = measure(p); here < least) {
                least = here;
                best = {p, s, turn, true};
            }
        });
        return of_best_rank(best, least);
    }
    Place of_best_rank(const Place& own, double measure) const {
        double all[7] = {own.point.x,      own.point.y, own.point.z,          own.parameters.x,
                         own.parameters.y, own.turn,    own.found ? 1.0 : 0.0};
        take_best(all, 7, own.found ? measure : kNowhere, m_controller);
        return {{all[0], all[1], all[2]}, {all[3], all[4]}, all[5], all[6] != 0};
    }

    /// How far the next point is.
    double next_point(const glm::dvec3& from) const {
        double least = kNowhere;
        each_point([&](const glm::dvec3& p, glm::dvec2) {
            if (const double apart = glm::distance(p, from); apart > kSame * m_diagonal)
                least = std::min(least, apart);
        });
        reduce(&least, 1, vtkCommunicator::MIN_OP);
        return least;
    }

    /// How many points, at places of their own, a bump has within its extents; as many as are enough at most.
    int points_in(const Deformation& bump) const {
        const double edge = std::exp(-1.0) * (1 - 1e-9);  // the Gaussian's value there
        std::vector<glm::dvec3> found;
        each_point([&](const glm::dvec3& p, glm::dvec2 s) {
            if (found.size() == DefaultBump::kEnough ||
                influence(bump, s.x, s.y, m_plane ? m_plane->depth(p) : 0.0, 1.0) < edge)
                return;
            if (std::none_of(found.begin(), found.end(), [&](const glm::dvec3& other) {
                    return glm::distance(p, other) <= kSame * m_diagonal;
                }))
                found.push_back(p);
        });
        auto count = static_cast<double>(found.size());
        reduce(&count, 1, vtkCommunicator::SUM_OP);
        return static_cast<int>(std::min(count, static_cast<double>(DefaultBump::kEnough)));
    }

    /// How often edges about a place are to be halved to be short for the bump; 0 where that cannot be.
    int subdivisions_at(const Place& place) const {
        constexpr double kShort = 0.6;              // of the extent
        constexpr double kMostTriangles = 1 << 20;  // that nobody has asked for
        const double wide = width();
        double longest = 0, triangles = 0, other = 0;
        for (const Surface& surface : m_surfaces) {
            if (!surface.has_subdivisions) other = 1;
            for_each_surface_cell(surface.mesh, [&](vtkIdType count, const vtkIdType* p) {
                triangles += static_cast<double>(count - 2);
                std::vector<glm::dvec3> corners;
                for (vtkIdType i = 0; i < count; ++i) corners.push_back(point_of(surface.mesh, p[i]));
                const auto [least, most] = box_of(corners);
                if (apart(least, most, place.point) <= wide)
                    longest = std::max(longest, glm::distance(least, most));
            });
        }
        double found[2] = {longest, other};
        reduce(found, 2, vtkCommunicator::MAX_OP);
        reduce(&triangles, 1, vtkCommunicator::SUM_OP);
        if (found[1] != 0 || !(triangles > 0) || !(wide > 0)) return 0;
        const double wanted = std::ceil(std::log2(found[0] / (kShort * wide))),
                     most = std::floor(std::log2(kMostTriangles / triangles) / 2);
        return static_cast<int>(std::clamp(std::min(wanted, most), 0.0, 6.0));
    }

    /// The mean of the normals, by area, of the triangles no farther than `reach` from a place that look to the eye.
    glm::dvec3 normal_at(const Place& place, double reach) const {
        glm::dvec3 sum(0.0);
        vtkNew<vtkTriangle> triangle;
        const auto add = [&](const std::array<glm::dvec3, 3>& corners) {
            const auto [least, most] = box_of(corners);
            if (!(apart(least, most, place.point) <= reach)) return;
            for (int k = 0; k < 3; ++k)
                triangle->GetPoints()->SetPoint(k, &corners[static_cast<std::size_t>(k)].x);
            double closest[3], coordinates[3], square = 0, shares[3];
            int part;
            // What has no area has no normal.
            if (triangle->EvaluatePosition(&place.point.x, closest, part, coordinates, square, shares) < 0 ||
                square > reach * reach)
                return;
            const glm::dvec3 area = place.turn * glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
            if (glm::dot(area, kToEye) > 0) sum += area;
        };
        for (const Surface& surface : m_surfaces)
            for_each_surface_cell(surface.mesh, [&](vtkIdType count, const vtkIdType* p) {
                const auto corner = [&](vtkIdType i) { return point_of(surface.mesh, p[i]); };
                for (vtkIdType i = 1; i + 1 < count; ++i) add({corner(0), corner(i), corner(i + 1)});
            });
        reduce(&sum.x, 3, vtkCommunicator::SUM_OP);
        const double length = glm::length(sum);
        return length > 0 && std::isfinite(length) ? sum / length : kToEye;
    }

    /// How wide the bump is in space, the narrower way.
    double width() const { return m_plane ? std::min(space_extent(0), space_extent(1)) : m_diagonal / 6; }

    /// How far a bump reaches in space along u (0) or v (1).
    double space_extent(int i) const {
        return m_plane ? m_extent[i] * glm::length(i == 0 ? m_plane->axis_u() : m_plane->axis_v()) : 0;
    }

    /// on_point: the place is a point of the mesh, whose own cells alone tell the normal.
    Deformation bump_at(const Place& place, bool deep, double grown, bool on_point) const {
        const double height = m_diagonal > 0 ? m_diagonal / 10 : 1;
        Deformation bump;
        bump.center = place.parameters;
        bump.extent = grown * m_extent;
        if (m_plane && !deep) {
            const glm::dvec3 up = m_plane->normal();
            bump.vector = (glm::dot(up, kToEye) < 0 ? -height : height) * up;
            return bump;
        }
        const glm::dvec3 normal = normal_at(place, on_point ? kSame * m_diagonal : width());
        bump.vector = height * normal;
        if (!m_plane) return bump;
        bump.center_w = m_plane->depth(place.point);
        bump.extent_w = std::min(bump.extent.x, bump.extent.y);
        bump.orientation = turn_to(normal, *m_plane);
        return bump;
    }

    std::vector<Surface> m_surfaces;
    const anamorph::ParameterPlane* m_plane;
    vtkMultiProcessController* m_controller;
    Bounds m_bounds;
    double m_diagonal = 0;
    glm::dvec3 m_center{0.0};
    glm::dvec2 m_middle{0.0}, m_extent{1.0};  ///< of the parameters
    std::array<double, 2> m_depths{};         ///< the least and the greatest
};

}  // namespace

std::optional<DefaultBump> find_default_bump(const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                                             const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                                             const anamorph::ParameterPlane* plane,
                                             vtkMultiProcessController* controller) {
    std::vector<Surface> surfaces;
    for (std::size_t m = 0; m < std::min(meshes.size(), undeformed.size()); ++m) {
        if (!meshes[m]) continue;
        if (plane) {
            const vtkSmartPointer<vtkPointSet> faces = faces_of(undeformed[m]);
            surfaces.push_back({faces,
                                [faces, plane](vtkIdType i) { return plane->parameters(point_of(faces, i)); },
                                has_polygons_alone(undeformed[m])});
        } else {
            surfaces.push_back({undeformed[m],
                                [of_all = &meshes[m]->parameters()](vtkIdType i) {
                                    return (*of_all)[static_cast<std::size_t>(i)];
                                },
                                has_polygons_alone(undeformed[m])});
        }
    }
    return Search(std::move(surfaces), plane, controller).find();
}

}  // namespace anamorph_vtk
