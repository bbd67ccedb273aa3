// SPDX-License-Identifier: Apache-2.0
#include "shadow_rays.h"

#include <algorithm>
#include <array>
#include <glm/common.hpp>
#include <glm/vec4.hpp>
#include <vector>

#include "anamorph/projector/occluders.h"
#include "shadow_map.h"
#include "vtkCellArray.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkPolyData.h"
#include "vtkTextureObject.h"

namespace anamorph_vtk {
namespace {

using anamorph::Occluders;

/// Texels across: all drivers have room for as many, and 4096 rows hold what kMostTriangles need.
constexpr std::size_t kAcross = 8192;

/// Where a ray that misses a box goes on: after all that is in it.
std::vector<std::int32_t> boxes_after(const std::vector<Occluders::Node>& nodes) {
    std::vector<std::int32_t> after(nodes.size(), static_cast<std::int32_t>(nodes.size()));
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        if (nodes[i].right == 0) continue;
        after[i + 1] = nodes[i].right;
        after[static_cast<std::size_t>(nodes[i].right)] = after[i];
    }
    return after;
}

/// A texel with the number of boxes; two for each box: its low corner and where a miss goes on, its high corner and, of leaves,
/// the first triangle, else -1; four for each triangle: its normals, with a 1 at the first where a leaf ends, and the depth.
std::vector<glm::vec4> texels_of(const Occluders& occluders) {
    const auto& nodes = occluders.nodes();
    std::vector<glm::vec4> texels{{static_cast<float>(nodes.size()), 0, 0, 0}};
    const std::vector<std::int32_t> after = boxes_after(nodes);
    std::vector<bool> ends(occluders.occluders().size());
    for (std::size_t i = 0; i < nodes.size(); ++i) {
        const Occluders::Node& node = nodes[i];
        // Rounding to float, and of a ray in it, must not lead past a box.
        const glm::dvec3 wider = 0x1p-20 * glm::max(glm::abs(node.low), glm::abs(node.high));
        const bool leaf = node.right == 0;
        texels.emplace_back(glm::vec3(node.low - wider), static_cast<float>(after[i]));
        texels.emplace_back(glm::vec3(node.high + wider), leaf ? static_cast<float>(node.begin) : -1.0F);
        if (leaf) ends[static_cast<std::size_t>(node.end) - 1] = true;
    }
    for (std::size_t i = 0; i < ends.size(); ++i) {
        const Occluders::Occluder& o = occluders.occluders()[i];
        const std::array<float, 4> beside{ends[i] ? 1.0F : 0.0F, 0, 0, static_cast<float>(o.depth)};
        for (std::size_t k = 0; k < 4; ++k) texels.emplace_back(glm::vec3(o.normals[k]), beside[k]);
    }
    return texels;
}

}  // namespace

ShadowRays::ShadowRays(vtkOpenGLRenderWindow* window) : m_window(window) {}

ShadowRays::~ShadowRays() = default;

bool ShadowRays::is_of(vtkOpenGLRenderWindow* window) const {
    return m_window == window;
}

vtkTextureObject* ShadowRays::refreshed(vtkPolyData* occluders, const glm::dvec3& position) {
    const bool same = m_texture && m_texture->GetHandle() && m_occluders == occluders &&
                      m_time == occluders->GetMTime() && m_position == position;
    if (same) return m_texture;
    std::vector<glm::vec4> texels = texels_of(Occluders(corners_of(occluders), position));
    const std::size_t across = std::min(kAcross, texels.size()), down = (texels.size() - 1) / across + 1;
    texels.resize(across * down);
    m_texture = vtkSmartPointer<vtkTextureObject>::New();
    m_texture->SetContext(m_window);
    m_texture->SetMinificationFilter(vtkTextureObject::Nearest);
    m_texture->SetMagnificationFilter(vtkTextureObject::Nearest);
    m_texture->Create2DFromRaw(static_cast<unsigned>(across), static_cast<unsigned>(down), 4, VTK_FLOAT,
                               texels.data());
    m_occluders = occluders;
    m_time = occluders->GetMTime();
    m_position = position;
    ++m_draws;
    return m_texture;
}

vtkIdType count_triangles(vtkPolyData* mesh) {
    const auto count = [](vtkCellArray* cells) {
        return cells ? cells->GetNumberOfConnectivityIds() - 2 * cells->GetNumberOfCells() : 0;
    };
    return count(mesh->GetPolys()) + count(mesh->GetStrips());
}

// The slack: gl_Position and the ray are sums of four products each, interpolated across a triangle, turned, and multiplied with
// a plane: at most some 30 roundings of 2^-24 of what is added up, which is no longer than the ray, the way from the projector
// to the camera, and that from the origin to the projector, as points are floats counted from there. Without it a surface would
// hide itself where it is seen edge-on.
std::string traced_function() {
    return R"(
vec4 anamorphTree#(int i) {
  int across = textureSize(anamorphShadow#, 0).x;
  return texelFetch(anamorphShadow#, ivec2(i % across, i / across), 0);
}
bool anamorphHidden#(vec3 r, vec3 normal) {
  float slack = 2e-6 * (length(r) + length(anamorphOrigin#) + anamorphAway#);
  vec3 per = 1.0 / mix(r, vec3(1e-20), equal(r, vec3(0.0)));
  int boxes = int(anamorphTree#(0).x), triangles = 1 + 2 * boxes;
  for (int at = 0; at < boxes;) {
    vec4 low = anamorphTree#(1 + 2 * at), high = anamorphTree#(2 + 2 * at);
    vec3 p = low.xyz * per, q = high.xyz * per, enter = min(p, q), leave = max(p, q);
    bool meets = max(max(enter.x, enter.y), max(enter.z, 0.0)) <=
                 min(min(leave.x, leave.y), min(leave.z, 1.0)) + 1e-5;
    at = meets ? at + 1 : int(low.w);
    bool more = meets && high.w >= 0.0;
    for (int i = triangles + 4 * int(high.w); more; i += 4) {
      vec4 a = anamorphTree#(i), b = anamorphTree#(i + 1), c = anamorphTree#(i + 2), plane = anamorphTree#(i + 3);
      if (dot(a.xyz, r) >= 0.0 && dot(b.xyz, r) >= 0.0 && dot(c.xyz, r) >= 0.0 && dot(plane.xyz, r) - plane.w > slack)
        return true;
      more = a.w == 0.0;
    }
  }
  return false;
}
)";
}

}  // namespace anamorph_vtk
