// SPDX-License-Identifier: Apache-2.0
// The triangles that stand around a projector and their tree of boxes (anamorph::Occluders) as a texture, through which shaders
// follow the ray to a fragment: shadows that are exact but for the rounding of float.
#pragma once

#include <glm/vec3.hpp>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "vtkSmartPointer.h"
#include "vtkType.h"
#include "vtkWeakPointer.h"

class vtkOpenGLRenderWindow;
class vtkPolyData;
class vtkTextureObject;

namespace anamorph_vtk {

class ShadowRays {
  public:
    /// The most triangles, whose texture has up to 400 MB.
    static constexpr vtkIdType kMostTriangles = 1 << 22;

    explicit ShadowRays(vtkOpenGLRenderWindow* window);
    ~ShadowRays();

    /// The texture of what surrounds a position; made if something has changed since the last time.
    vtkTextureObject* refreshed(vtkPolyData* occluders, const glm::dvec3& position);
    /// The number of times that the texture has been made.
    int draws() const { return m_draws; }
    bool is_of(vtkOpenGLRenderWindow* window) const;

  private:
    vtkWeakPointer<vtkOpenGLRenderWindow> m_window;
    vtkSmartPointer<vtkTextureObject> m_texture;
    vtkWeakPointer<vtkPolyData> m_occluders;
    vtkMTimeType m_time = 0;
    glm::dvec3 m_position{0.0};
    int m_draws = 0;
};

/// The number of triangles that a mesh is cut into.
vtkIdType count_triangles(vtkPolyData* mesh);

/// The text of `bool anamorphHidden#(vec3 r, vec3 normal)`, as hidden_function() of shadow maps gives it:
/// does a triangle stand before r? What is nearer to r than anamorph::Occluders::kTouching of its distance
/// does not hide it, nor what float cannot tell from it.
std::string traced_function();

/// The shadows of a projector that actors in a window share, as long as one of them has it.
template <class Shadows>
std::shared_ptr<Shadows> shared_shadows(void* projector, vtkOpenGLRenderWindow* window) {
    static std::map<std::pair<void*, void*>, std::weak_ptr<Shadows>> all;
    std::erase_if(all, [](const auto& entry) { return entry.second.expired(); });
    std::weak_ptr<Shadows>& known = all[{projector, window}];
    std::shared_ptr<Shadows> shadows = known.lock();
    // Another window may stand where one was.
    if (!shadows || !shadows->is_of(window)) known = shadows = std::make_shared<Shadows>(window);
    return shadows;
}

}  // namespace anamorph_vtk
