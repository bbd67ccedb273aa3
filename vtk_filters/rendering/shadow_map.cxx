// SPDX-License-Identifier: Apache-2.0
#include "shadow_map.h"

#if __has_include("vtk_glad.h")
#include "vtk_glad.h"
#else
#include "vtk_glew.h"
#endif

#include <array>
#include <limits>
#include <numeric>

#include "vtkIdList.h"
#include "vtkNew.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLRenderUtilities.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkOpenGLVertexArrayObject.h"
#include "vtkPolyData.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"
#include "vtkTriangleFilter.h"

namespace anamorph_vtk {
namespace {

constexpr int kFaces = 6, kAcross = 3, kDown = 2;

// Face f looks along axis f / 2, the other two across: upwards or downwards along it.
constexpr const char* kVertices = R"(//VTK::System::Dec
in vec3 vertexMC;
out float ahead;
uniform int face;
void main() {
  vec3 q = face < 2 ? vertexMC.yzx : face < 4 ? vertexMC.zxy : vertexMC.xyz;
  ahead = face % 2 == 0 ? q.z : -q.z;
  gl_Position = vec4(q.xy, 0.0, ahead);
}
)";
constexpr const char* kFragments = R"(//VTK::System::Dec
//VTK::Output::Dec
in float ahead;
void main() { gl_FragData[0] = vec4(ahead); }
)";

/// Corners from a position.
std::vector<glm::vec3> seen_from(const glm::dvec3& position, const std::vector<glm::dvec3>& corners) {
    std::vector<glm::vec3> seen;
    for (const glm::dvec3& corner : corners) seen.emplace_back(corner - position);
    return seen;
}

/// The triangles that may be seen in a face: not all beyond one of its sides.
std::vector<glm::vec3> corners_in(const std::vector<glm::vec3>& corners, int face) {
    const int ahead = face / 2, across = (ahead + 1) % 3, down = (ahead + 2) % 3;
    const float side = face % 2 == 0 ? 1.0F : -1.0F;
    std::vector<glm::vec3> inside;
    for (std::size_t i = 0; i + 2 < corners.size(); i += 3) {
        std::array<int, 4> beyond{};
        for (std::size_t k = i; k < i + 3; ++k) {
            const glm::vec3& c = corners[k];
            const float z = side * c[ahead];
            beyond[0] += c[across] > z;
            beyond[1] += -c[across] > z;
            beyond[2] += c[down] > z;
            beyond[3] += -c[down] > z;
        }
        if (std::max({beyond[0], beyond[1], beyond[2], beyond[3]}) < 3)
            inside.insert(inside.end(), {corners[i], corners[i + 1], corners[i + 2]});
    }
    return inside;
}

/// The nearest distance is the least: blending finds it, without limits that a buffer of depths has.
void draw_faces(const std::vector<glm::vec3>& corners, int size, vtkOpenGLRenderWindow* window) {
    vtkOpenGLState* state = window->GetState();
    state->vtkglEnable(GL_BLEND);
    state->vtkglBlendEquation(GL_MIN);
    state->vtkglDisable(GL_CULL_FACE);
    vtkShaderProgram* program = window->GetShaderCache()->ReadyShaderProgram(kVertices, kFragments, "");
    for (int face = 0; face < kFaces && program; ++face) {
        std::vector<glm::vec3> inside = corners_in(corners, face);
        if (inside.empty()) continue;
        std::vector<GLuint> indices(inside.size());
        std::iota(indices.begin(), indices.end(), 0U);
        const auto count = static_cast<unsigned>(inside.size());
        state->vtkglViewport(face % kAcross * size, face / kAcross * size, size, size);
        state->vtkglScissor(face % kAcross * size, face / kAcross * size, size, size);
        program->SetUniformi("face", face);
        vtkNew<vtkOpenGLVertexArrayObject> arrays;
        vtkOpenGLRenderUtilities::RenderTriangles(&inside[0].x, count, indices.data(), count, nullptr,
                                                  program, arrays);
    }
    state->vtkglBlendEquation(GL_FUNC_ADD);
}

}  // namespace

std::vector<glm::dvec3> corners_of(vtkPolyData* mesh) {
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(mesh);
    triangles->PassVertsOff();
    triangles->PassLinesOff();
    triangles->Update();
    vtkPolyData* cut = triangles->GetOutput();
    std::vector<glm::dvec3> corners;
    vtkNew<vtkIdList> ids;
    for (vtkIdType cell = 0; cell < cut->GetNumberOfPolys(); ++cell) {
        cut->GetPolys()->GetCellAtId(cell, ids);
        for (vtkIdType i = 0; i < 3; ++i) {
            double p[3];
            cut->GetPoint(ids->GetId(i), p);
            corners.emplace_back(p[0], p[1], p[2]);
        }
    }
    return corners;
}

int most_shadow_size(vtkOpenGLRenderWindow* window) {
    const int most = vtkTextureObject::GetMaximumTextureSize(window);
    return most > 0 ? most / kAcross : std::numeric_limits<int>::max();
}

ShadowMap::ShadowMap(vtkOpenGLRenderWindow* window) : m_window(window) {}

ShadowMap::~ShadowMap() = default;

bool ShadowMap::is_of(vtkOpenGLRenderWindow* window) const {
    return m_window == window;
}

vtkTextureObject* ShadowMap::refreshed(vtkPolyData* occluders, const glm::dvec3& position, int size) {
    const bool same = m_texture && m_texture->GetHandle() && m_occluders == occluders &&
                      m_time == occluders->GetMTime() && m_position == position && m_size == size;
    if (same) return m_texture;
    draw(seen_from(position, corners_of(occluders)), size);
    m_occluders = occluders;
    m_time = occluders->GetMTime();
    m_position = position;
    return m_texture;
}

void ShadowMap::draw(const std::vector<glm::vec3>& corners, int size) {
    if (!m_texture || !m_texture->GetHandle() || m_size != size) {
        m_texture = vtkSmartPointer<vtkTextureObject>::New();
        m_texture->SetContext(m_window);
        m_texture->SetMinificationFilter(vtkTextureObject::Nearest);
        m_texture->SetMagnificationFilter(vtkTextureObject::Nearest);
        m_texture->Allocate2D(static_cast<unsigned>(size * kAcross), static_cast<unsigned>(size * kDown), 1,
                              VTK_FLOAT);
        m_frame = vtkSmartPointer<vtkOpenGLFramebufferObject>::New();
        m_frame->SetContext(m_window);
        m_size = size;
    }
    vtkOpenGLState* state = m_window->GetState();
    state->Push();
    state->PushFramebufferBindings();
    m_frame->Bind();
    m_frame->AddColorAttachment(0, m_texture);
    m_frame->ActivateDrawBuffer(0);
    m_frame->StartNonOrtho(size * kAcross, size * kDown);
    state->vtkglViewport(0, 0, size * kAcross, size * kDown);
    state->vtkglScissor(0, 0, size * kAcross, size * kDown);
    const float far = std::numeric_limits<float>::max();
    state->vtkglClearColor(far, far, far, far);
    state->vtkglClear(GL_COLOR_BUFFER_BIT);
    if (!corners.empty()) draw_faces(corners, size, m_window);
    state->PopFramebufferBindings();
    state->Pop();
    ++m_draws;
}

std::string hidden_function(int size) {
    return R"(
bool anamorphHidden#(vec3 r, vec3 normal) {
  vec3 most = abs(r);
  int axis = most.x > max(most.y, most.z) ? 0 : most.y > most.z ? 1 : 2;
  vec3 q = axis == 0 ? r.yzx : axis == 1 ? r.zxy : r, n = axis == 0 ? normal.yzx : axis == 1 ? normal.zxy : normal;
  float size = )" +
           std::to_string(size) + R"(.0, ahead = abs(q.z);
  vec2 texel = clamp(floor((q.xy / ahead * 0.5 + 0.5) * size), 0.0, size - 1.0) + 0.5;
  vec3 middle = vec3(texel / size * 2.0 - 1.0, sign(q.z));
  int face = 2 * axis + (q.z < 0.0 ? 1 : 0);
  float on_plane = dot(n, q) / dot(n, middle);
  float nearest = texelFetch(anamorphShadow#, ivec2(texel) + ivec2(face % 3, face / 3) * int(size), 0).r;
  return nearest < clamp(on_plane, 0.5 * ahead, 2.0 * ahead) * (1.0 - 4.0 / size);
}
)";
}

}  // namespace anamorph_vtk
