// SPDX-License-Identifier: Apache-2.0
// The triangles that stand around a projector as it sees them, as a texture: a cube of six faces along the
// scene's axes, three beside each other and two above each other, whose texels are distances along the face's
// axis. A projector that turns keeps it, and actors in one window share it.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "vtkSmartPointer.h"
#include "vtkType.h"
#include "vtkWeakPointer.h"

class vtkOpenGLFramebufferObject;
class vtkOpenGLRenderWindow;
class vtkPolyData;
class vtkTextureObject;

namespace anamorph_vtk {

/// The corners of a mesh's triangles, three each.
std::vector<glm::dvec3> corners_of(vtkPolyData* mesh);

/// The most texels across a face that a window's textures have room for.
int most_shadow_size(vtkOpenGLRenderWindow* window);

class ShadowMap {
  public:
    explicit ShadowMap(vtkOpenGLRenderWindow* window);
    ~ShadowMap();

    /// The map of what surrounds a position, `size` texels across a face; drawn if something has changed since the last time.
    vtkTextureObject* refreshed(vtkPolyData* occluders, const glm::dvec3& position, int size);
    /// The number of times that the map has been drawn.
    int draws() const { return m_draws; }
    bool is_of(vtkOpenGLRenderWindow* window) const;

  private:
    void draw(const std::vector<glm::vec3>& corners, int size);

    vtkWeakPointer<vtkOpenGLRenderWindow> m_window;
    vtkSmartPointer<vtkTextureObject> m_texture;
    vtkSmartPointer<vtkOpenGLFramebufferObject> m_frame;
    vtkWeakPointer<vtkPolyData> m_occluders;
    vtkMTimeType m_time = 0;
    glm::dvec3 m_position{0.0};
    int m_size = 0, m_draws = 0;
};

/// The text of `bool anamorphHidden#(vec3 r, vec3 normal)`: does something stand before a point r of a
/// surface, from the projector along the scene's axes? The surface is continued to the middle of the map's
/// texel as a plane, so that it does not hide itself; nor does anything that is nearer to it than 4 / size of
/// its distance.
std::string hidden_function(int size);

}  // namespace anamorph_vtk
