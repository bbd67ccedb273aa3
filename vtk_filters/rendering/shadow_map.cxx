// SPDX-License-Identifier: Apache-2.0
#include "shadow_map.h"

#if __has_include("vtk_glad.h")
#include "vtk_glad.h"
#else
#include "vtk_glew.h"
#endif

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

constexpr int kFaces = 6;

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

/// The nearest distance is the least: blending finds it, without limits that a buffer of depths has.
void draw_faces(std::vector<glm::vec3>& corners, int size, vtkOpenGLRenderWindow* window) {
    vtkOpenGLState* state = window->GetState();
    state->vtkglEnable(GL_BLEND);
    state->vtkglBlendEquation(GL_MIN);
    state->vtkglDisable(GL_CULL_FACE);
    vtkShaderProgram* program = window->GetShaderCache()->ReadyShaderProgram(kVertices, kFragments, "");
    std::vector<GLuint> indices(corners.size());
    std::iota(indices.begin(), indices.end(), 0U);
    const auto count = static_cast<unsigned>(corners.size());
    for (int face = 0; face < kFaces && program; ++face) {
        state->vtkglViewport(0, face * size, size, size);
        state->vtkglScissor(0, face * size, size, size);
        program->SetUniformi("face", face);
        vtkNew<vtkOpenGLVertexArrayObject> arrays;
        vtkOpenGLRenderUtilities::RenderTriangles(&corners[0].x, count, indices.data(), count, nullptr,
                                                  program, arrays);
    }
    state->vtkglBlendEquation(GL_FUNC_ADD);
}

}  // namespace

std::vector<glm::vec3> corners_around(vtkPolyData* mesh, const anamorph::ProjectorPose& pose) {
    vtkNew<vtkTriangleFilter> triangles;
    triangles->SetInputData(mesh);
    triangles->PassVertsOff();
    triangles->PassLinesOff();
    triangles->Update();
    vtkPolyData* cut = triangles->GetOutput();
    const glm::dmat3 frame = frame_of(pose);
    std::vector<glm::vec3> corners;
    vtkNew<vtkIdList> ids;
    for (vtkIdType cell = 0; cell < cut->GetNumberOfPolys(); ++cell) {
        cut->GetPolys()->GetCellAtId(cell, ids);
        for (vtkIdType i = 0; i < 3; ++i) {
            double p[3];
            cut->GetPoint(ids->GetId(i), p);
            corners.emplace_back((glm::dvec3(p[0], p[1], p[2]) - pose.position) * frame);
        }
    }
    return corners;
}

vtkSmartPointer<vtkTextureObject> drawn_shadows(std::vector<glm::vec3> corners, int size,
                                                vtkOpenGLRenderWindow* window) {
    const auto texture = vtkSmartPointer<vtkTextureObject>::New();
    texture->SetContext(window);
    texture->SetMinificationFilter(vtkTextureObject::Nearest);
    texture->SetMagnificationFilter(vtkTextureObject::Nearest);
    texture->Allocate2D(static_cast<unsigned>(size), static_cast<unsigned>(size * kFaces), 1, VTK_FLOAT);
    vtkOpenGLState* state = window->GetState();
    state->Push();
    state->PushFramebufferBindings();
    vtkNew<vtkOpenGLFramebufferObject> frame;
    frame->SetContext(window);
    frame->Bind();
    frame->AddColorAttachment(0, texture);
    frame->ActivateDrawBuffer(0);
    frame->StartNonOrtho(size, size * kFaces);
    state->vtkglViewport(0, 0, size, size * kFaces);
    state->vtkglScissor(0, 0, size, size * kFaces);
    const float far = std::numeric_limits<float>::max();
    state->vtkglClearColor(far, far, far, far);
    state->vtkglClear(GL_COLOR_BUFFER_BIT);
    if (!corners.empty()) draw_faces(corners, size, window);
    state->PopFramebufferBindings();
    state->Pop();
    return texture;
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
  float face = float(2 * axis + (q.z < 0.0 ? 1 : 0)), on_plane = dot(n, q) / dot(n, middle);
  float nearest = textureLod(anamorphShadow#, vec2(texel.x, texel.y + face * size) / (size * vec2(1.0, 6.0)), 0.0).r;
  return nearest < clamp(on_plane, 0.5 * ahead, 2.0 * ahead) * (1.0 - 4.0 / size);
}
)";
}

}  // namespace anamorph_vtk
