// SPDX-License-Identifier: Apache-2.0
// The parts of the benchmark of projections.
#pragma once

#include <array>
#include <numbers>
#include <vector>

#include "anamorph/projector/projected_triangles.h"
#include "bench.h"

namespace anamorph::bench {

/// What references are computed in.
using Real = long double;
inline constexpr Real kPi = std::numbers::pi_v<Real>;

using SceneTriangles = std::vector<std::array<glm::dvec3, 3>>;

/// The texture coordinates that VTK gives the vertices of a scene.
struct VertexRival {
    std::string scheme;
    std::function<void()> run;
    /// The error of what it gives, interpolated across triangles, in texels of its picture: at the places
    /// within triangles that `shares` are weights of.
    std::function<Accuracy(const std::vector<std::array<double, 3>>& shares)> accuracy;
};

/// The rivals vtkTextureMapToSphere, of a picture of width x width / 2, and vtkProjectedTexture, of one of 90
/// degrees whose middle has as many texels to a degree; none where VTK was not found. They last as long as
/// the scene.
std::vector<VertexRival> vertex_rivals(const SceneTriangles& scene, const ProjectorPose& pose, int width);

/// Measures views of concentric mosaics.
void run_mosaics(const Settings& settings, Report& report);

}  // namespace anamorph::bench
