// SPDX-License-Identifier: Apache-2.0
#include "projection_hook.h"

#include <glm/mat4x4.hpp>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "projection_tables.h"
#include "vtkActor.h"
#include "vtkAnamorphPanoramaProjector.h"
#include "vtkAnamorphProjectionShader.h"
#include "vtkImageData.h"
#include "vtkMatrix4x4.h"
#include "vtkObjectFactory.h"
#include "vtkOpenGLCamera.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkPolyData.h"
#include "vtkProperty.h"
#include "vtkRenderer.h"
#include "vtkShaderProperty.h"
#include "vtkTextureObject.h"
#include "vtkUniforms.h"

namespace anamorph_vtk {

vtkStandardNewMacro(LoadedTexture);
vtkStandardNewMacro(ProjectionHook);

namespace {

constexpr const char* kPositionDec = "//VTK::PositionVC::Dec";
constexpr const char* kPositionImpl = "//VTK::PositionVC::Impl";
constexpr const char* kTextureDec = "//VTK::TCoord::Dec";
constexpr const char* kTextureImpl = "//VTK::TCoord::Impl";

void set_replacements(vtkShaderProperty& shaders, const ProjectionText& text) {
    const auto after = [](const char* tag, const std::string& added) {
        return std::string(tag) + "\n" + added;
    };
    shaders.AddVertexShaderReplacement(kPositionDec, true, after(kPositionDec, text.vertex_declarations),
                                       false);
    shaders.AddVertexShaderReplacement(kPositionImpl, true, after(kPositionImpl, text.vertex_code), false);
    shaders.AddGeometryShaderReplacement(kPositionDec, true, after(kPositionDec, text.geometry_declarations),
                                         false);
    shaders.AddGeometryShaderReplacement(kPositionImpl, true, after(kPositionImpl, text.geometry_code),
                                         false);
    shaders.AddFragmentShaderReplacement(kPositionDec, true, after(kPositionDec, text.fragment_declarations),
                                         false);
    shaders.AddFragmentShaderReplacement(kTextureDec, true, after(kTextureDec, text.fragment_functions),
                                         false);
    shaders.AddFragmentShaderReplacement(kTextureImpl, true, text.fragment_code, false);
}

void clear_replacements(vtkShaderProperty& shaders) {
    shaders.ClearVertexShaderReplacement(kPositionDec, true);
    shaders.ClearVertexShaderReplacement(kPositionImpl, true);
    shaders.ClearGeometryShaderReplacement(kPositionDec, true);
    shaders.ClearGeometryShaderReplacement(kPositionImpl, true);
    shaders.ClearFragmentShaderReplacement(kPositionDec, true);
    shaders.ClearFragmentShaderReplacement(kTextureDec, true);
    shaders.ClearFragmentShaderReplacement(kTextureImpl, true);
}

/// VTK may make others of an image than it has.
int loaded_components(vtkTexture* texture, vtkRenderer* renderer) {
    texture->Render(renderer);
    auto* loaded = vtkOpenGLTexture::SafeDownCast(texture);
    return loaded && loaded->GetTextureObject() ? loaded->GetTextureObject()->GetComponents() : 4;
}

/// Are shadows those of rays now? A window that wants several frames a second is being interacted with.
bool follows_rays(vtkAnamorphPanoramaProjector& projector, vtkRenderWindow* window) {
    constexpr double kStill = 1;
    const int shadows = projector.GetShadows();
    return (shadows == vtkAnamorphPanoramaProjector::SHADOW_RAYS ||
            (shadows == vtkAnamorphPanoramaProjector::SHADOW_RAYS_IN_STILLS &&
             window->GetDesiredUpdateRate() < kStill)) &&
           count_triangles(projector.GetOccluders()) <= ShadowRays::kMostTriangles;
}

/// From world coordinates to those of gl_Position.
glm::dmat4 clip_matrix(vtkRenderer* renderer) {
    vtkMatrix4x4 *view = nullptr, *projection = nullptr, *both = nullptr;
    vtkMatrix3x3* normals = nullptr;
    vtkOpenGLCamera::SafeDownCast(renderer->GetActiveCamera())
        ->GetKeyMatrices(renderer, view, normals, projection, both);
    glm::dmat4 matrix;
    for (int column = 0; column < 4; ++column)
        for (int row = 0; row < 4; ++row) matrix[column][row] = both->GetElement(column, row);
    return matrix;
}

/// ray = matrix * gl_Position + origin. In perspective x, y and w tell a point better than z does; else z counts.
struct RayFromClip {
    glm::dmat4 matrix{0.0};
    /// Where gl_Position is 0: in perspective the eye's own ray.
    glm::dvec3 origin{0.0};
    /// The eye from the projector, and 1; in a parallel view the direction that it is in, and 0.
    glm::dvec4 eye{0.0};

    RayFromClip(const glm::dmat4& clip, const anamorph::ProjectorPose& pose) {
        const bool perspective = clip[0][3] != 0 || clip[1][3] != 0 || clip[2][3] != 0;
        const int third = perspective ? 3 : 2;
        const auto part = [&](int column) {
            return glm::dvec3(clip[column][0], clip[column][1], clip[column][third]);
        };
        const glm::dmat3 to_world = glm::inverse(glm::dmat3(part(0), part(1), part(2)));
        const glm::dmat3 to_frame = glm::transpose(frame_of(pose));
        const glm::dmat3 to_ray = to_frame * to_world;
        matrix[0] = glm::dvec4(to_ray[0], 0);
        matrix[1] = glm::dvec4(to_ray[1], 0);
        matrix[third] = glm::dvec4(to_ray[2], 0);
        origin = -(to_frame * (to_world * part(3) + pose.position));
        // Depths grow away from the eye.
        eye = perspective ? glm::dvec4(origin, 1) : glm::dvec4(-glm::normalize(to_ray[2]), 0);
    }
};

}  // namespace

void LoadedTexture::Render(vtkRenderer*) {
    if (this->GetTextureObject()) this->GetTextureObject()->Activate();
}

void LoadedTexture::PostRender(vtkRenderer*) {
    if (this->GetTextureObject()) this->GetTextureObject()->Deactivate();
}

void ProjectionHook::put_on(vtkActor* actor, vtkAnamorphProjectionShader* owner) {
    const auto state = std::make_shared<State>();
    for (int i = 0; i < owner->GetNumberOfProjectors(); ++i) {
        const auto hook = vtkSmartPointer<ProjectionHook>::New();
        hook->m_owner = owner;
        hook->m_projector = owner->GetProjector(i);
        hook->m_shaders = actor->GetShaderProperty();
        hook->m_index = static_cast<std::size_t>(i);
        hook->m_state = state;
        // Until there is a right pose nothing has a direction.
        hook->write_uniforms(glm::dmat4(0.0), glm::dvec3(0.0), glm::dmat3(0.0), 0);
        hook->write_viewer(glm::dvec4(0.0), {});
        // By name, tables and shadows come behind panoramas, and are loaded when these have been.
        actor->GetProperty()->SetTexture(texture_name(hook->m_index).c_str(), hook);
        hook->m_shadows = vtkSmartPointer<LoadedTexture>::New();
        actor->GetProperty()->SetTexture(shadow_name(hook->m_index).c_str(), hook->m_shadows);
        if (owner->GetMode() == vtkAnamorphProjectionShader::DIRECT) continue;
        hook->m_table = vtkSmartPointer<LoadedTexture>::New();
        actor->GetProperty()->SetTexture(table_name(hook->m_index).c_str(), hook->m_table);
    }
}

void ProjectionHook::take_off(vtkActor* actor) {
    vtkProperty* property = actor->GetProperty();
    vtkShaderProperty* shaders = actor->GetShaderProperty();
    if (owner_of(actor)) clear_replacements(*shaders);
    for (std::size_t i = 0; i < vtkAnamorphProjectionShader::MostProjectors; ++i) {
        for (const std::string& name : {texture_name(i), table_name(i), shadow_name(i)})
            if (property->GetTexture(name.c_str())) property->RemoveTexture(name.c_str());
        shaders->GetVertexCustomUniforms()->RemoveUniform(matrix_name(i).c_str());
        shaders->GetVertexCustomUniforms()->RemoveUniform(origin_name(i).c_str());
        for (const std::string& name : {frame_name(i), origin_name(i), away_name(i), viewer_name(i)})
            shaders->GetFragmentCustomUniforms()->RemoveUniform(name.c_str());
    }
}

vtkAnamorphProjectionShader* ProjectionHook::owner_of(vtkActor* actor) {
    auto* first = ProjectionHook::SafeDownCast(actor->GetProperty()->GetTexture(texture_name(0).c_str()));
    return first ? first->m_owner : nullptr;
}

const PreparedPanorama* ProjectionHook::prepared_for(vtkActor* actor, int projector) {
    auto* first = ProjectionHook::SafeDownCast(actor->GetProperty()->GetTexture(texture_name(0).c_str()));
    const auto i = static_cast<std::size_t>(projector);
    return first && i < first->m_state->prepared.size() ? first->m_state->prepared[i].get() : nullptr;
}

int ProjectionHook::shadow_draws_for(vtkActor* actor, int projector) {
    const std::string name = texture_name(static_cast<std::size_t>(projector));
    auto* hook = ProjectionHook::SafeDownCast(actor->GetProperty()->GetTexture(name.c_str()));
    if (!hook) return 0;
    return (hook->m_shadow_map ? hook->m_shadow_map->draws() : 0) +
           (hook->m_shadow_rays ? hook->m_shadow_rays->draws() : 0);
}

vtkOpenGLTexture* ProjectionHook::panorama() const {
    return vtkOpenGLTexture::SafeDownCast(m_projector->GetPanorama());
}

void ProjectionHook::complain(const std::string& complaint, std::string& last) {
    if (!complaint.empty() && complaint != last) vtkErrorWithObjectMacro(m_owner, << complaint);
    last = complaint;
}

void ProjectionHook::Render(vtkRenderer* renderer) {
    if (m_index == 0) refresh_text(renderer);
    set_uniforms(renderer);
    vtkSmartPointer<vtkTextureObject> loaded;
    if (panorama() && m_index < m_state->prepared.size()) {
        panorama()->Render(renderer);
        loaded = panorama()->GetTextureObject();
    }
    if (!loaded) loaded = blank_texture(vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()));
    this->SetTextureObject(loaded);
    this->Superclass::Render(renderer);
    if (m_table) refresh_table(renderer);
    refresh_shadows(renderer);
}

void ProjectionHook::PostRender(vtkRenderer* renderer) {
    if (panorama()) panorama()->PostRender(renderer);
    this->Superclass::PostRender(renderer);
}

void ProjectionHook::ReleaseGraphicsResources(vtkWindow* window) {
    if (panorama()) panorama()->ReleaseGraphicsResources(window);
    this->SetTextureObject(nullptr);
    if (m_table) m_table->SetTextureObject(nullptr);
    m_table_of = nullptr;
    m_shadows->SetTextureObject(nullptr);
    m_shadow_map = nullptr;
    m_shadow_rays = nullptr;
}

void ProjectionHook::refresh_text(vtkRenderer* renderer) {
    if (!m_shaders) return;
    PreparedPanoramas& prepared = m_state->prepared;
    PreparedPanoramas now;
    std::vector<bool> rays;
    std::string complaint;
    try {
        for (int i = 0; i < m_owner->GetNumberOfProjectors(); ++i) {
            vtkAnamorphPanoramaProjector& projector = *m_owner->GetProjector(i);
            ThrownPanorama thrown = thrown_by(projector, *m_owner);
            thrown.components = loaded_components(projector.GetPanorama(), renderer);
            thrown.shadow_size =
                std::min(thrown.shadow_size,
                         most_shadow_size(vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow())));
            thrown.most_rows = vtkTextureObject::GetMaximumTextureSize(
                vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()));
            const auto at = static_cast<std::size_t>(i);
            const bool known = at < prepared.size() && prepared[at]->thrown == thrown;
            now.push_back(known ? prepared[at] : std::make_shared<const PreparedPanorama>(thrown));
            rays.push_back(thrown.shadow_size > 0 && follows_rays(projector, renderer->GetRenderWindow()));
        }
    } catch (const anamorph::Error& error) {
        complaint = error.what();
        now.clear();
    }
    complain(complaint, m_state->complaint);
    const bool leaves_machine =
        m_owner->GetMode() != vtkAnamorphProjectionShader::RESIDUAL && *m_owner->GetMachine() != '\0';
    if (leaves_machine && !m_state->leaves_machine)
        vtkWarningWithObjectMacro(m_owner, << "Machine=" << anamorph::printable(m_owner->GetMachine())
                                           << ": is of mode residual alone");
    m_state->leaves_machine = leaves_machine;
    const bool hides = m_owner->GetHideUnpainted();
    if (m_state->has_text && now == prepared && rays == m_state->rays && hides == m_state->hides) return;
    prepared = now;
    m_state->rays = rays;
    m_state->hides = hides;
    m_state->has_text = true;
    set_replacements(*m_shaders, projection_text(prepared, rays, hides));
}

void ProjectionHook::refresh_table(vtkRenderer* renderer) {
    auto* window = vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow());
    const auto prepared = m_index < m_state->prepared.size() ? m_state->prepared[m_index] : nullptr;
    if (!prepared || prepared->groups.empty()) {
        m_table->SetTextureObject(this->GetTextureObject());
        m_table_of = nullptr;
        return;
    }
    const bool residual = prepared->thrown.mode == vtkAnamorphProjectionShader::RESIDUAL;
    const std::pair<vtkTextureObject*, vtkMTimeType> drawn(
        this->GetTextureObject(),
        residual ? 0 : std::max(panorama()->GetMTime(), panorama()->GetInput()->GetMTime()));
    if (m_table_of == prepared && drawn == m_drawn) return;
    try {
        // What is blended by parts has colours times these, which 8 bits would not hold.
        const bool bytes = panorama()->GetTextureObject()->GetVTKDataType() == VTK_UNSIGNED_CHAR &&
                           !(prepared->thrown.fade > 0);
        m_table->SetTextureObject(residual ? residual_table(*prepared, window)
                                           : drawn_planes(*prepared, bytes, panorama(), window));
        complain("", m_wrong_table);
    } catch (const anamorph::Error& error) {
        m_table->SetTextureObject(blank_texture(window));
        complain(error.what(), m_wrong_table);
    }
    m_table_of = prepared;
    m_drawn = drawn;
}

void ProjectionHook::refresh_shadows(vtkRenderer* renderer) {
    const auto prepared = m_index < m_state->prepared.size() ? m_state->prepared[m_index] : nullptr;
    if (!prepared || prepared->thrown.shadow_size == 0) {
        m_shadows->SetTextureObject(this->GetTextureObject());
        m_shadow_map = nullptr;
        m_shadow_rays = nullptr;
        return;
    }
    const bool too_many = m_projector->GetShadows() != vtkAnamorphPanoramaProjector::SHADOW_MAP &&
                          count_triangles(m_projector->GetOccluders()) > ShadowRays::kMostTriangles;
    complain(too_many
                 ? "Occluders: rays are followed through at most " +
                       std::to_string(ShadowRays::kMostTriangles) + " triangles: shadows are those of the map"
                 : "",
             m_wrong_shadows);
    // With a wrong pose, of which set_uniforms() tells, the last shadows stay.
    if (m_wrong_pose.empty())
        m_shadows->SetTextureObject(shadows_now(
            vtkOpenGLRenderWindow::SafeDownCast(renderer->GetRenderWindow()), prepared->thrown.shadow_size));
    else if (!m_shadows->GetTextureObject())
        m_shadows->SetTextureObject(this->GetTextureObject());
}

vtkTextureObject* ProjectionHook::shadows_now(vtkOpenGLRenderWindow* window, int size) {
    const bool rays = m_state->rays[m_index];
    // Where stills have one and interaction the other, both are kept.
    const bool both = m_projector->GetShadows() == vtkAnamorphPanoramaProjector::SHADOW_RAYS_IN_STILLS;
    if (!rays && !both) m_shadow_rays = nullptr;
    if (rays && !both) m_shadow_map = nullptr;
    vtkPolyData* occluders = m_projector->GetOccluders();
    const double* at = m_projector->GetPosition();
    const glm::dvec3 position(at[0], at[1], at[2]);
    if (rays) {
        m_shadow_rays = shared_shadows<ShadowRays>(m_projector, window);
        return m_shadow_rays->refreshed(occluders, position);
    }
    m_shadow_map = shared_shadows<ShadowMap>(m_projector, window);
    return m_shadow_map->refreshed(occluders, position, size);
}

void ProjectionHook::set_uniforms(vtkRenderer* renderer) {
    if (!m_shaders) return;
    try {
        const anamorph::ProjectorPose pose = pose_of(*m_projector);
        const RayFromClip from(clip_matrix(renderer), pose);
        write_uniforms(from.matrix, from.origin, frame_of(pose), glm::length(pose.position));
        write_viewer(from.eye, pose);
        complain("", m_wrong_pose);
    } catch (const anamorph::Error& error) {
        // The last right pose stays.
        complain(error.what(), m_wrong_pose);
    }
}

void ProjectionHook::write_viewer(const glm::dvec4& eye, const anamorph::ProjectorPose& pose) {
    glm::dvec4 viewer = eye;
    if (!m_projector->GetFollowCamera()) {
        const double* at = m_projector->GetViewpoint();
        viewer =
            glm::dvec4(glm::transpose(frame_of(pose)) * (glm::dvec3(at[0], at[1], at[2]) - pose.position), 1);
    }
    // Heights of the viewpoint do not count: slits see in the plane of their circles.
    const double radius = viewer.w > 0 ? m_projector->GetCircleRadius() : 1;
    const float numbers[] = {static_cast<float>(viewer.x / radius), static_cast<float>(viewer.y / radius),
                             static_cast<float>(viewer.z / radius), static_cast<float>(viewer.w)};
    m_shaders->GetFragmentCustomUniforms()->SetUniform4f(viewer_name(m_index).c_str(), numbers);
}

void ProjectionHook::write_uniforms(const glm::dmat4& matrix, const glm::dvec3& origin,
                                    const glm::dmat3& frame, double away) {
    float numbers[16], vector[3], axes[9];
    for (int i = 0; i < 16; ++i) numbers[i] = static_cast<float>(matrix[i / 4][i % 4]);
    for (int i = 0; i < 3; ++i) vector[i] = static_cast<float>(origin[i]);
    for (int i = 0; i < 9; ++i) axes[i] = static_cast<float>(frame[i / 3][i % 3]);
    vtkUniforms* uniforms = m_shaders->GetVertexCustomUniforms();
    uniforms->SetUniformMatrix4x4(matrix_name(m_index).c_str(), numbers);
    uniforms->SetUniform3f(origin_name(m_index).c_str(), vector);
    vtkUniforms* of_fragments = m_shaders->GetFragmentCustomUniforms();
    of_fragments->SetUniformMatrix3x3(frame_name(m_index).c_str(), axes);
    of_fragments->SetUniform3f(origin_name(m_index).c_str(), vector);
    of_fragments->SetUniformf(away_name(m_index).c_str(), static_cast<float>(away));
}

}  // namespace anamorph_vtk
