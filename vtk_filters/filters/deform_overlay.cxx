// SPDX-License-Identifier: Apache-2.0
#include "deform_overlay.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <glm/geometric.hpp>
#include <limits>

#include "surface_normals.h"
#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkIntArray.h"
#include "vtkNew.h"
#include "vtkPointSet.h"
#include "vtkPoints.h"
#include "vtkPolyData.h"
#include "vtkTriangle.h"

namespace anamorph_vtk {
namespace {

using anamorph::Deformation;

/// A point of a surface, undeformed, with its depth and its normal.
struct SurfacePlace {
    glm::dvec3 point{0.0};
    double depth = 0;
    glm::dvec3 normal{0.0};
};

/// How much of its vector a bump moves a point.
double share_of(const Deformation& bump, glm::dvec2 s, const SurfacePlace& place) {
    const anamorph::Triple<double> to = anamorph::side_direction<double>(bump);
    return influence(bump, s.x, s.y, place.depth, glm::dot(place.normal, {to.x, to.y, to.z}));
}

/// Where a surface is, by its parameters: triangles of the parameter plane in bins.
class SurfaceOfParameters {
  public:
    explicit SurfaceOfParameters(const std::vector<OverlayMesh>& meshes) {
        for (const OverlayMesh& m : meshes)
            for_each_surface_cell(m.mesh, [&](vtkIdType count, const vtkIdType* p) {
                for (vtkIdType i = 1; i + 1 < count; ++i) add(m, {p[0], p[i], p[i + 1]});
            });
        if (m_triangles.empty()) return;
        // About a triangle a bin; coarser bins where triangles reach over many.
        constexpr double kMostBins = 16;  // of a triangle, in the mean
        const auto count = static_cast<double>(m_triangles.size());
        m_side = std::clamp(static_cast<int>(std::sqrt(count)), 1, 1024);
        while (m_side > 1 && bins_of_all() > kMostBins * count) m_side /= 2;
        m_bins.resize(static_cast<std::size_t>(m_side) * static_cast<std::size_t>(m_side));
        for (std::size_t k = 0; k < m_triangles.size(); ++k) {
            const Box box = box_of(m_triangles[k]);
            for (int j = box.least[1]; j <= box.most[1]; ++j)
                for (int i = box.least[0]; i <= box.most[0]; ++i)
                    m_bins[static_cast<std::size_t>(j * m_side + i)].push_back(k);
        }
    }

    /// The part of the surface at s, or of several the one that a bump with depth or side moves most.
    std::optional<SurfacePlace> at(glm::dvec2 s, const Deformation& bump) const {
        if (m_triangles.empty() ||
            !(s.x >= m_least.x && s.x <= m_most.x && s.y >= m_least.y && s.y <= m_most.y))
            return std::nullopt;
        std::optional<SurfacePlace> best;
        double most = -1;
        for (const std::size_t k : m_bins[static_cast<std::size_t>(bin(s.y, 1) * m_side + bin(s.x, 0))]) {
            const Triangle& t = m_triangles[k];
            // Barycentric coordinates.
            const glm::dvec2 a = t.parameters[1] - t.parameters[0], b = t.parameters[2] - t.parameters[0],
                             c = s - t.parameters[0];
            const double area = a.x * b.y - a.y * b.x;
            const double x = (c.x * b.y - c.y * b.x) / area, y = (a.x * c.y - a.y * c.x) / area;
            constexpr double kRounding = 1e-9;
            if (!(x >= -kRounding && y >= -kRounding && x + y <= 1 + kRounding)) continue;
            const auto between = [&](const auto& of) {
                return of(0) + x * (of(1) - of(0)) + y * (of(2) - of(0));
            };
            SurfacePlace place{between([&](std::size_t i) { return t.places[i].point; }),
                               between([&](std::size_t i) { return t.places[i].depth; }),
                               between([&](std::size_t i) { return t.places[i].normal; })};
            if (bump.is_plain()) return place;
            const double share = share_of(bump, s, place);
            if (share > most) {
                best = place;
                most = share;
            }
        }
        return best;
    }

  private:
    struct Triangle {
        std::array<glm::dvec2, 3> parameters;
        std::array<SurfacePlace, 3> places;
    };

    /// The bins around a triangle.
    struct Box {
        int least[2], most[2];
    };
    Box box_of(const Triangle& triangle) const {
        const auto& s = triangle.parameters;
        Box box;
        for (int axis = 0; axis < 2; ++axis) {
            const auto [least, most] = std::minmax({s[0][axis], s[1][axis], s[2][axis]});
            box.least[axis] = bin(least, axis);
            box.most[axis] = bin(most, axis);
        }
        return box;
    }
    double bins_of_all() const {
        double bins = 0;
        for (const Triangle& triangle : m_triangles) {
            const Box box = box_of(triangle);
            bins += (box.most[0] - box.least[0] + 1.0) * (box.most[1] - box.least[1] + 1.0);
        }
        return bins;
    }

    void add(const OverlayMesh& m, const std::array<vtkIdType, 3>& ids) {
        Triangle t;
        for (std::size_t c = 0; c < 3; ++c) {
            t.parameters[c] = (*m.parameters)[static_cast<std::size_t>(ids[c])];
            if (!is_finite(t.parameters[c])) return;
            double p[3];
            m.mesh->GetPoint(ids[c], p);
            t.places[c].point = {p[0], p[1], p[2]};
            if (m.depths && !m.depths->w.empty()) {
                const auto id = static_cast<std::size_t>(ids[c]);
                t.places[c].depth = m.depths->w[id];
                t.places[c].normal = m.depths->normal[id];
            }
        }
        m_triangles.push_back(t);
        for (const glm::dvec2& s : t.parameters) {
            m_least = glm::dvec2(std::min(m_least.x, s.x), std::min(m_least.y, s.y));
            m_most = glm::dvec2(std::max(m_most.x, s.x), std::max(m_most.y, s.y));
        }
    }

    int bin(double value, int axis) const {
        const double width = m_most[axis] - m_least[axis];
        return width > 0 && std::isfinite(width)
                   ? std::clamp(static_cast<int>((value - m_least[axis]) / width * m_side), 0, m_side - 1)
                   : 0;
    }

    std::vector<Triangle> m_triangles;
    glm::dvec2 m_least{std::numeric_limits<double>::infinity()},
        m_most{-std::numeric_limits<double>::infinity()};
    int m_side = 0;
    std::vector<std::vector<std::size_t>> m_bins;
};

/// The + and the oval, as paths in parameters.
std::vector<std::vector<glm::dvec2>> paths_of(const Deformation& d) {
    constexpr int kOval = 64, kArm = 4;
    constexpr double kArmLength = 0.25;  // of the extent
    std::vector<std::vector<glm::dvec2>> paths(3);
    for (int i = -kArm; i <= kArm; ++i) {
        const double t = kArmLength * i / kArm;
        paths[0].push_back(d.center + glm::dvec2(t * d.extent.x, 0));
        paths[1].push_back(d.center + glm::dvec2(0, t * d.extent.y));
    }
    for (int i = 0; i <= kOval; ++i) {
        const double angle = 2 * 3.14159265358979323846 * (i % kOval) / kOval;
        paths[2].push_back(d.center + glm::dvec2(std::cos(angle) * d.extent.x, std::sin(angle) * d.extent.y));
    }
    return paths;
}

}  // namespace

void draw_overlay(const std::vector<Deformation>& list, const std::vector<std::size_t>& entries,
                  const anamorph::DeformOptions& options,
                  const std::optional<anamorph::FormulaDisplacement>& formula,
                  const std::vector<OverlayMesh>& meshes, const anamorph::ParameterPlane* plane,
                  vtkPolyData* overlay) {
    const SurfaceOfParameters surface(meshes);
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    vtkNew<vtkCellArray> lines;
    vtkNew<vtkIntArray> positions, enabled;
    positions->SetName("Deformation");
    enabled->SetName("Enabled");
    std::vector<glm::dvec2> parameters;  // of `points`
    std::vector<SurfacePlace> places;    // of `points`
    for (std::size_t k = 0; k < list.size(); ++k)
        for (const std::vector<glm::dvec2>& path : paths_of(list[k])) {
            std::vector<vtkIdType> line;
            const auto finish = [&] {
                if (line.size() >= 2) {
                    lines->InsertNextCell(static_cast<vtkIdType>(line.size()), line.data());
                    positions->InsertNextValue(static_cast<int>(entries[k]));
                    enabled->InsertNextValue(list[k].enabled ? 1 : 0);
                }
                line.clear();
            };
            for (const glm::dvec2& s : path) {
                std::optional<SurfacePlace> p;
                if (is_finite(s)) {
                    p = surface.at(s, list[k]);
                    if (!p && plane) p = SurfacePlace{plane->point(s)};
                }
                if (!p) {
                    finish();
                    continue;
                }
                line.push_back(points->InsertNextPoint(p->point.x, p->point.y, p->point.z));
                parameters.push_back(s);
                places.push_back(*p);
            }
            finish();
        }
    std::vector<glm::dvec3> moved(parameters.size());
    if (needs_depth(list)) {
        for (std::size_t i = 0; i < moved.size(); ++i)
            moved[i] = displacement_at(list, parameters[i], places[i].depth, places[i].normal);
    } else {
        std::vector<anamorph::DisplacementJet> jets(parameters.size());
        anamorph::displacement_jets(list, parameters, options, jets.data());
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = jets[i].value;
    }
    for (std::size_t i = 0; i < moved.size(); ++i) {
        double p[3];
        const auto id = static_cast<vtkIdType>(i);
        points->GetPoint(id, p);
        if (formula) moved[i] += formula->jet(parameters[i]).value;
        points->SetPoint(id, p[0] + moved[i].x, p[1] + moved[i].y, p[2] + moved[i].z);
    }
    overlay->SetPoints(points);
    overlay->SetLines(lines);
    overlay->GetCellData()->AddArray(positions);
    overlay->GetCellData()->AddArray(enabled);
}

namespace {

/// The point of meshes that is best in some way, at which the best so far is no better.
struct BestPoint {
    double measure;
    std::size_t mesh = 0, point = 0;
    bool found = false;

    void offer(double value, std::size_t m, std::size_t i) {
        if (!(value > measure)) return;
        *this = {value, m, i, true};
    }
};

}  // namespace

double find_heights(const Deformation& bump, const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                    const std::vector<vtkSmartPointer<vtkPointSet>>& deformed,
                    const anamorph::ParameterPlane& plane, double (&heights)[2]) {
    const auto each_point = [&](const auto& body) {
        for (std::size_t m = 0; m < std::min(meshes.size(), deformed.size()); ++m) {
            if (!meshes[m]) continue;
            const std::vector<glm::dvec2>& parameters = meshes[m]->parameters();
            for (std::size_t i = 0; i < parameters.size(); ++i) body(m, i, parameters[i]);
        }
    };
    const auto height_of = [&](std::size_t m, std::size_t i) {
        double p[3];
        deformed[m]->GetPoint(static_cast<vtkIdType>(i), p);
        return plane.depth({p[0], p[1], p[2]});
    };
    BestPoint center{0}, corner{-1e300};
    each_point([&](std::size_t m, std::size_t i, glm::dvec2 s) {
        const anamorph::PointDepths& depths = meshes[m]->depths();
        SurfacePlace place;
        if (!depths.w.empty()) {
            place.depth = depths.w[i];
            place.normal = depths.normal[i];
        }
        center.offer(share_of(bump, s, place), m, i);
    });
    if (!center.found) return kNowhere;
    const double height = height_of(center.mesh, center.point);
    heights[0] = heights[1] = height;
    // The corner's nearest point, in extents; in depth it is near that of the centre.
    const double length =
        std::max(bump.extent.x * glm::length(plane.axis_u()), bump.extent.y * glm::length(plane.axis_v()));
    const auto off = [&](glm::dvec2 s) { return (s - bump.center - bump.extent) / bump.extent; };
    each_point([&](std::size_t m, std::size_t i, glm::dvec2 s) {
        const double apart = (height_of(m, i) - height) / (16 * length);
        corner.offer(-(glm::dot(off(s), off(s)) + apart * apart), m, i);
    });
    // Where the mesh ends before the corner, that is as high as the centre.
    constexpr double kNear = 0.25;
    const glm::dvec2 found =
        corner.found ? off(meshes[corner.mesh]->parameters()[corner.point]) : glm::dvec2(1);
    if (glm::dot(found, found) < kNear) heights[1] = height_of(corner.mesh, corner.point);
    return -center.measure;
}

namespace {

/// A place on a triangle of a mesh, by the shares of its corners.
struct TrianglePlace {
    std::size_t mesh = 0;
    std::array<vtkIdType, 3> corners{};
    glm::dvec3 shares{0.0};
    double depth = 0, apart = std::numeric_limits<double>::infinity();
};

glm::dvec3 point_of(vtkPointSet* mesh, vtkIdType id) {
    glm::dvec3 p;
    mesh->GetPoint(id, &p.x);
    return p;
}

TrianglePlace place_over(const Deformation& bump, const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                         const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                         const anamorph::ParameterPlane& plane) {
    TrianglePlace best;
    for (std::size_t m = 0; m < std::min(meshes.size(), undeformed.size()); ++m) {
        if (!meshes[m]) continue;
        const std::vector<glm::dvec2>& parameters = meshes[m]->parameters();
        const auto offer = [&](const std::array<vtkIdType, 3>& ids) {
            const auto at = [&](std::size_t i) { return parameters[static_cast<std::size_t>(ids[i])]; };
            const glm::dvec2 a = at(1) - at(0), b = at(2) - at(0), c = bump.center - at(0);
            const double area = a.x * b.y - a.y * b.x;
            const double x = (c.x * b.y - c.y * b.x) / area, y = (a.x * c.y - a.y * c.x) / area;
            constexpr double kRounding = 1e-9;
            if (!(x >= -kRounding && y >= -kRounding && x + y <= 1 + kRounding)) return;
            const glm::dvec3 shares(1 - x - y, x, y);
            double depth = 0;
            for (int i = 0; i < 3; ++i)
                depth += shares[i] * plane.depth(point_of(undeformed[m], ids[static_cast<std::size_t>(i)]));
            if (const double apart = std::fabs(depth - bump.center_w); apart < best.apart)
                best = {m, ids, shares, depth, apart};
        };
        for_each_surface_cell(undeformed[m], [&](vtkIdType count, const vtkIdType* p) {
            for (vtkIdType i = 1; i + 1 < count; ++i) offer({p[0], p[i], p[i + 1]});
        });
    }
    return best;
}

/// The sum of the normals of the cells at each corner, each as long as the cell's area, in the shares of the corners.
glm::dvec3 normal_at(const TrianglePlace& place, vtkPointSet* mesh) {
    std::array<glm::dvec3, 3> normals{};
    for_each_surface_cell(mesh, [&](vtkIdType count, const vtkIdType* p) {
        glm::dvec3 area(0.0);
        for (vtkIdType i = 1; i + 1 < count; ++i)
            area += glm::cross(point_of(mesh, p[i]) - point_of(mesh, p[0]),
                               point_of(mesh, p[i + 1]) - point_of(mesh, p[0]));
        for (std::size_t k = 0; k < 3; ++k)
            if (std::find(p, p + count, place.corners[k]) != p + count) normals[k] += area;
    });
    glm::dvec3 sum(0.0);
    for (std::size_t k = 0; k < 3; ++k)
        if (const double length = glm::length(normals[k]); length > 0)
            sum += place.shares[static_cast<int>(k)] / length * normals[k];
    return sum;
}

}  // namespace

glm::dvec4 turn_to(const glm::dvec3& normal, const anamorph::ParameterPlane& plane) {
    // A plane of space with this normal is one of (u, v, w) with that of its products with where u, v and w go.
    return anamorph::frame_at({glm::dot(normal, plane.axis_u()), glm::dot(normal, plane.axis_v()),
                               glm::dot(normal, plane.normal())});
}

double find_anchor(const Deformation& bump, const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                   const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                   const anamorph::ParameterPlane& plane, double (&anchor)[9]) {
    const TrianglePlace place = place_over(bump, meshes, undeformed, plane);
    if (!std::isfinite(place.apart)) return kNowhere;
    glm::dvec3 normal = normal_at(place, undeformed[place.mesh]);
    if (!(glm::length(normal) > 0)) return kNowhere;
    normal = glm::normalize(normal);
    const glm::dvec4 turn = turn_to(normal, plane);
    const double length = glm::length(bump.vector);
    const glm::dvec3 vector = (glm::dot(bump.vector, normal) < 0 ? -length : length) * normal;
    anchor[0] = place.depth;
    anchor[1] = bump.has_depth() ? bump.extent_w : std::min(bump.extent.x, bump.extent.y);
    for (int c = 0; c < 4; ++c) anchor[2 + c] = turn[c];
    for (int c = 0; c < 3; ++c) anchor[6 + c] = vector[c];
    return place.apart;
}

double find_frame(glm::dvec2 at, const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                  const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                  const std::vector<vtkSmartPointer<vtkPointSet>>& deformed, double (&frame)[9]) {
    struct Near {
        double apart;
        std::size_t mesh, point;
        bool operator<(const Near& other) const {
            return std::tie(apart, mesh, point) < std::tie(other.apart, other.mesh, other.point);
        }
    };
    std::vector<Near> near;
    for (std::size_t m = 0; m < std::min(meshes.size(), deformed.size()); ++m) {
        if (!meshes[m]) continue;
        const std::vector<glm::dvec2>& parameters = meshes[m]->parameters();
        for (std::size_t i = 0; i < parameters.size(); ++i) {
            const glm::dvec2 off = parameters[i] - at;
            if (const double apart = glm::dot(off, off); std::isfinite(apart)) near.push_back({apart, m, i});
        }
    }
    if (near.empty()) return kNowhere;
    constexpr std::size_t kPoints = 12;
    const std::size_t count = std::min(kPoints, near.size());
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    near.resize(count);
    const auto place_of = [&](const Near& one) {
        glm::dvec3 p;
        undeformed[one.mesh]->GetPoint(static_cast<vtkIdType>(one.point), &p.x);
        return p;
    };
    const auto parameters_of = [&](const Near& one) { return meshes[one.mesh]->parameters()[one.point]; };
    // Least squares of P - P_0 = d (u - u_0) + e (v - v_0), nearer points weighing more.
    const glm::dvec3 origin = place_of(near[0]);
    const glm::dvec2 first = parameters_of(near[0]);
    const double far = near.back().apart;
    double uu = 0, uv = 0, vv = 0;
    glm::dvec3 up(0.0), vp(0.0);
    for (const Near& one : near) {
        const double weight = far > 0 ? std::exp(-4 * one.apart / far) : 1;
        const glm::dvec2 off = parameters_of(one) - first;
        const glm::dvec3 place = place_of(one) - origin;
        uu += weight * off.x * off.x;
        uv += weight * off.x * off.y;
        vv += weight * off.y * off.y;
        up += weight * off.x * place;
        vp += weight * off.y * place;
    }
    const double determinant = uu * vv - uv * uv;
    if (!(determinant > 1e-12 * uu * vv)) return kNowhere;
    const glm::dvec3 d = (vv * up - uv * vp) / determinant, e = (uu * vp - uv * up) / determinant;
    glm::dvec3 moved;
    deformed[near[0].mesh]->GetPoint(static_cast<vtkIdType>(near[0].point), &moved.x);
    const glm::dvec3 zero = moved - first.x * d - first.y * e;
    for (int c = 0; c < 3; ++c) {
        frame[c] = zero[c];
        frame[3 + c] = d[c];
        frame[6 + c] = e[c];
    }
    return near[0].apart;
}

PickedPlace find_place(const glm::dvec3& at, const std::vector<std::unique_ptr<DeformedMesh>>& meshes,
                       const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                       const std::vector<vtkSmartPointer<vtkPointSet>>& deformed) {
    PickedPlace place;
    if (!std::isfinite(at.x + at.y + at.z)) return place;
    double nearest = std::numeric_limits<double>::infinity();
    vtkNew<vtkTriangle> triangle;
    for (std::size_t m = 0; m < std::min({meshes.size(), undeformed.size(), deformed.size()}); ++m) {
        if (!meshes[m]) continue;
        const std::vector<glm::dvec2>& parameters = meshes[m]->parameters();
        const auto offer = [&](const std::array<vtkIdType, 3>& ids) {
            for (int i = 0; i < 3; ++i) {
                const glm::dvec3 corner = point_of(deformed[m], ids[static_cast<std::size_t>(i)]);
                triangle->GetPoints()->SetPoint(i, &corner.x);
            }
            double closest[3], coordinates[3], square, shares[3];
            int part;
            if (triangle->EvaluatePosition(&at.x, closest, part, coordinates, square, shares) < 0) return;
            if (!(square < nearest)) return;
            PickedPlace here;
            double sum = 0;
            for (double& share : shares) sum += share = std::max(share, 0.0);
            for (std::size_t i = 0; i < 3; ++i) {
                here.parameters += shares[i] / sum * parameters[static_cast<std::size_t>(ids[i])];
                here.point += shares[i] / sum * point_of(undeformed[m], ids[i]);
            }
            here.found = std::isfinite(here.parameters.x + here.parameters.y);
            if (!here.found) return;
            nearest = here.square = square;
            place = here;
        };
        for_each_surface_cell(undeformed[m], [&](vtkIdType count, const vtkIdType* p) {
            for (vtkIdType i = 1; i + 1 < count; ++i) offer({p[0], p[i], p[i + 1]});
        });
    }
    return place;
}

void for_each_meeting(
    const glm::dvec3& from, const glm::dvec3& to, vtkPointSet* mesh, vtkPointSet* points,
    const std::function<void(const MetPoint&, const std::array<vtkIdType, 3>& corners)>& take) {
    const double beside = 1e-10 * glm::length(to - from);  // of an edge, whose two triangles round apart
    vtkNew<vtkTriangle> triangle;
    for_each_surface_cell(mesh, [&](vtkIdType count, const vtkIdType* p) {
        for (vtkIdType i = 1; i + 1 < count; ++i) {
            const std::array<vtkIdType, 3> corners = {p[0], p[i], p[i + 1]};
            for (int k = 0; k < 3; ++k) {
                const glm::dvec3 corner = point_of(points, corners[static_cast<std::size_t>(k)]);
                triangle->GetPoints()->SetPoint(k, &corner.x);
            }
            MetPoint met{};
            double coordinates[3];
            int part;
            if (triangle->IntersectWithLine(&from.x, &to.x, beside, met.along, &met.point.x, coordinates,
                                            part))
                take(met, corners);
        }
    });
}

std::optional<MetPoint> find_on_line(const glm::dvec3& from, const glm::dvec3& to,
                                     const std::vector<vtkSmartPointer<vtkPointSet>>& undeformed,
                                     const std::vector<vtkSmartPointer<vtkPointSet>>& deformed) {
    std::optional<MetPoint> found;
    for (std::size_t m = 0; m < std::min(undeformed.size(), deformed.size()); ++m)
        if (deformed[m]->GetPoints())
            for_each_meeting(from, to, undeformed[m], deformed[m],
                             [&](const MetPoint& met, const std::array<vtkIdType, 3>&) {
                                 if (!found || met.along < found->along) found = met;
                             });
    return found;
}

}  // namespace anamorph_vtk
