// SPDX-License-Identifier: Apache-2.0
#include "projection_rows.h"

#ifdef ANAMORPH_HAVE_VTK
#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkDataSet.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkProjectedTexture.h>
#include <vtkSmartPointer.h>
#include <vtkTextureMapToSphere.h>

#include <cmath>
#include <glm/geometric.hpp>
#endif

namespace anamorph::bench {

#ifdef ANAMORPH_HAVE_VTK
namespace {

using Vector = std::array<Real, 3>;

/// No corner is shared: VTK does as much for each triangle as the others.
vtkSmartPointer<vtkPolyData> mesh_of(const SceneTriangles& scene) {
    const auto points = vtkSmartPointer<vtkPoints>::New();
    const auto cells = vtkSmartPointer<vtkCellArray>::New();
    points->SetDataTypeToDouble();
    for (const auto& triangle : scene) {
        vtkIdType ids[3];
        for (std::size_t k = 0; k < 3; ++k)
            ids[k] = points->InsertNextPoint(triangle[k].x, triangle[k].y, triangle[k].z);
        cells->InsertNextCell(3, ids);
    }
    const auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points);
    mesh->SetPolys(cells);
    return mesh;
}

/// Texture coordinates (s, t) times the picture's size against a formula of rays, which is false where the picture shows
/// nothing.
Accuracy accuracy(const SceneTriangles& scene, const glm::dvec3& position, vtkDataArray* coordinates,
                  const std::vector<std::array<double, 3>>& shares,
                  const std::function<bool(const Vector& ray, Real s, Real t, Real& off)>& distance) {
    std::vector<float> errors;
    for (std::size_t i = 0; i < scene.size(); ++i)
        for (const auto& share : shares) {
            Vector ray{};
            Real s = 0, t = 0, off = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto point = static_cast<vtkIdType>(3 * i + k);
                for (int d = 0; d < 3; ++d)
                    ray[static_cast<std::size_t>(d)] += share[k] * (Real(scene[i][k][d]) - position[d]);
                s += share[k] * coordinates->GetComponent(point, 0);
                t += share[k] * coordinates->GetComponent(point, 1);
            }
            if (distance(ray, s, t, off)) errors.push_back(static_cast<float>(off));
        }
    return accuracy_of(errors);
}

vtkDataArray* coordinates_of(vtkAlgorithm* filter) {
    return vtkDataSet::SafeDownCast(filter->GetOutputDataObject(0))->GetPointData()->GetTCoords();
}

/// s goes about z from x by way of y, and t from +z to -z.
VertexRival sphere(const SceneTriangles& scene, const glm::dvec3& position, int width) {
    const auto filter = vtkSmartPointer<vtkTextureMapToSphere>::New();
    filter->SetInputData(mesh_of(scene));
    filter->AutomaticSphereGenerationOff();
    filter->PreventSeamOff();
    filter->SetCenter(position.x, position.y, position.z);
    const auto distance = [width](const Vector& r, Real s, Real t, Real& off) {
        const Real around = std::hypot(r[0], r[1]), n = std::hypot(around, r[2]);
        const Real turn = std::atan2(r[1], r[0]) / (2 * kPi);
        Real across = s - (turn < 0 ? turn + 1 : turn);
        across -= std::round(across);
        const Real down = t - std::atan2(around, r[2]) / kPi;
        // About poles, as directions.
        const Real a = 2 * kPi * s, b = kPi * t;
        const Vector given{std::cos(a) * std::sin(b), std::sin(a) * std::sin(b), std::cos(b)};
        Real turned = 0;
        for (std::size_t k = 0; k < 3; ++k) turned += (r[k] / n - given[k]) * (r[k] / n - given[k]);
        off = std::min(std::hypot(across * width, down * width / 2), std::sqrt(turned) * width / (2 * kPi));
        return true;
    };
    return {"vtkTextureMapToSphere",
            [filter] {
                filter->Modified();
                filter->Update();
            },
            [=, &scene](const auto& shares) {
                return accuracy(scene, position, coordinates_of(filter), shares, distance);
            }};
}

/// A picture of 90 degrees each way.
VertexRival slide(const SceneTriangles& scene, const ProjectorPose& pose, int width) {
    const auto filter = vtkSmartPointer<vtkProjectedTexture>::New();
    const glm::dvec3 &position = pose.position, ahead = glm::normalize(pose.direction), at = position + ahead;
    filter->SetInputData(mesh_of(scene));
    filter->SetPosition(position.x, position.y, position.z);
    filter->SetFocalPoint(at.x, at.y, at.z);
    filter->SetUp(pose.up.x, pose.up.y, pose.up.z);
    filter->SetAspectRatio(2, 2, 1);
    const glm::dvec3 right = glm::normalize(glm::cross(ahead, pose.up)), up = glm::cross(right, ahead);
    const Real side = width / kPi;
    const auto distance = [=](const Vector& r, Real s, Real t, Real& off) {
        const auto along = [&](const glm::dvec3& a) { return r[0] * a.x + r[1] * a.y + r[2] * a.z; };
        const Real forward = along(ahead), u = 0.5L + along(right) / forward / 2,
                   v = 0.5L + along(up) / forward / 2;
        off = side * std::hypot(s - u, t - v);
        return forward > 0 && std::fabs(u - 0.5L) < 0.5L && std::fabs(v - 0.5L) < 0.5L;
    };
    return {"vtkProjectedTexture",
            [filter] {
                // It warns of every point beside the projector.
                vtkObject::GlobalWarningDisplayOff();
                filter->Modified();
                filter->Update();
                vtkObject::GlobalWarningDisplayOn();
            },
            [=, &scene](const auto& shares) {
                return accuracy(scene, position, coordinates_of(filter), shares, distance);
            }};
}

}  // namespace

std::vector<VertexRival> vertex_rivals(const SceneTriangles& scene, const ProjectorPose& pose, int width) {
    return {sphere(scene, pose.position, width), slide(scene, pose, width)};
}
#else
std::vector<VertexRival> vertex_rivals(const SceneTriangles&, const ProjectorPose&, int) {
    return {};
}
#endif

}  // namespace anamorph::bench
