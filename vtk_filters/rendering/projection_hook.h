// SPDX-License-Identifier: Apache-2.0
// How a vtkAnamorphProjectionShader takes part in drawing an actor: as textures of the actor's property, one or two for each
// projector. VTK lets them load just before it draws, with the renderer: they load the panorama's texture instead, and bring
// the actor's shaders up to date.
#pragma once

#include <glm/mat4x4.hpp>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "projection_text.h"
#include "shadow_map.h"
#include "shadow_rays.h"
#include "vtkOpenGLTexture.h"
#include "vtkSmartPointer.h"
#include "vtkWeakPointer.h"

class vtkActor;
class vtkShaderProperty;

namespace anamorph_vtk {

/// A texture that is only loaded.
class LoadedTexture : public vtkOpenGLTexture {
  public:
    static LoadedTexture* New();
    vtkTypeMacro(LoadedTexture, vtkOpenGLTexture);

    void Render(vtkRenderer*) override;
    void PostRender(vtkRenderer*) override;
    int IsTranslucent() override { return 0; }
};

class ProjectionHook : public LoadedTexture {
  public:
    static ProjectionHook* New();
    vtkTypeMacro(ProjectionHook, LoadedTexture);

    static void put_on(vtkActor* actor, vtkAnamorphProjectionShader* owner);
    static void take_off(vtkActor* actor);
    /// The shader whose hooks an actor has; null: none.
    static vtkAnamorphProjectionShader* owner_of(vtkActor* actor);
    /// The panorama that a projector throws as of the last frame; null: nothing.
    static const PreparedPanorama* prepared_for(vtkActor* actor, int projector);

    /// The number of times that the map of what hides from a projector, and the texture that its rays are
    /// followed through, have been made.
    static int shadow_draws_for(vtkActor* actor, int projector);

    // The members of a texture.
    void Render(vtkRenderer* renderer) override;
    void PostRender(vtkRenderer* renderer) override;
    void ReleaseGraphicsResources(vtkWindow* window) override;

  private:
    /// The state that the hooks of an actor share.
    struct State {
        PreparedPanoramas prepared;
        std::vector<bool> rays;  ///< of each projector: are its shadows those of rays?
        bool hides = false, has_text = false;
        std::string complaint;
        bool leaves_machine = false;  ///< was it told that the mode reads no machine?
    };

    vtkOpenGLTexture* panorama() const;
    /// Tells a complaint, unless it is empty or the last one.
    void complain(const std::string& complaint, std::string& last);
    /// Loads all panoramas, and writes the shaders anew where the text has changed.
    void refresh_text(vtkRenderer* renderer);
    /// Draws or loads what the mode reads beside the panorama.
    void refresh_table(vtkRenderer* renderer);
    /// Draws the map of distances around the projector, or what rays are followed through.
    void refresh_shadows(vtkRenderer* renderer);
    vtkTextureObject* shadows_now(vtkOpenGLRenderWindow* window, int size);
    void set_uniforms(vtkRenderer* renderer);
    /// Writes the uniforms. `away`: the distance of the projector from the origin of the scene.
    void write_uniforms(const glm::dmat4& matrix, const glm::dvec3& origin, const glm::dmat3& frame,
                        double away);
    /// Writes from where concentric mosaics are seen. `eye`: the camera's, from the projector, as RayFromClip has it.
    void write_viewer(const glm::dvec4& eye, const anamorph::ProjectorPose& pose);

    vtkSmartPointer<vtkAnamorphProjectionShader> m_owner;
    vtkSmartPointer<vtkAnamorphPanoramaProjector> m_projector;
    vtkWeakPointer<vtkShaderProperty> m_shaders;
    std::size_t m_index = 0;
    std::shared_ptr<State> m_state;
    std::string m_wrong_pose, m_wrong_table, m_wrong_shadows;
    /// The table; none in mode direct.
    vtkSmartPointer<LoadedTexture> m_table;
    /// The panorama that the table was made of.
    std::shared_ptr<const PreparedPanorama> m_table_of;
    std::pair<vtkTextureObject*, vtkMTimeType> m_drawn{};
    vtkSmartPointer<LoadedTexture> m_shadows;
    /// The map of what hides; none where nothing is hidden.
    std::shared_ptr<ShadowMap> m_shadow_map;
    std::shared_ptr<ShadowRays> m_shadow_rays;
};

}  // namespace anamorph_vtk
