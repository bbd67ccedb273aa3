// SPDX-License-Identifier: Apache-2.0
#include "projection_tables.h"

#include <array>
#include <string>

#include "anamorph/error.h"
#include "vtkNew.h"
#include "vtkOpenGLFramebufferObject.h"
#include "vtkOpenGLQuadHelper.h"
#include "vtkOpenGLRenderWindow.h"
#include "vtkOpenGLShaderCache.h"
#include "vtkOpenGLState.h"
#include "vtkOpenGLTexture.h"
#include "vtkShaderProgram.h"
#include "vtkTextureObject.h"

namespace anamorph_vtk {
namespace {

vtkSmartPointer<vtkTextureObject> new_texture(vtkOpenGLRenderWindow* window) {
    const auto texture = vtkSmartPointer<vtkTextureObject>::New();
    texture->SetContext(window);
    texture->SetMinificationFilter(vtkTextureObject::Linear);
    texture->SetMagnificationFilter(vtkTextureObject::Linear);
    texture->SetWrapS(vtkTextureObject::ClampToEdge);
    texture->SetWrapT(vtkTextureObject::ClampToEdge);
    return texture;
}

/// Draws a rectangle over all of a texture, whatever VTK is about to draw, and with its state as it was.
void draw_all_of(vtkTextureObject* texture, const std::string& fragments, vtkOpenGLTexture* picture,
                 vtkOpenGLRenderWindow* window) {
    const int width = static_cast<int>(texture->GetWidth()), height = static_cast<int>(texture->GetHeight());
    vtkOpenGLState* state = window->GetState();
    state->Push();
    vtkOpenGLQuadHelper quad(window, nullptr, fragments.c_str(), nullptr);
    state->PushFramebufferBindings();
    vtkNew<vtkOpenGLFramebufferObject> frame;
    frame->SetContext(window);
    frame->Bind();
    frame->AddColorAttachment(0, texture);
    frame->ActivateDrawBuffer(0);
    // Turns off tests and blending.
    frame->StartNonOrtho(width, height);
    state->vtkglViewport(0, 0, width, height);
    state->vtkglScissor(0, 0, width, height);
    window->GetShaderCache()->ReadyShaderProgram(quad.Program);
    quad.Program->SetUniformi(texture_name(0).c_str(), picture->GetTextureUnit());
    quad.Render();
    state->PopFramebufferBindings();
    state->Pop();
}

}  // namespace

vtkSmartPointer<vtkTextureObject> residual_table(const PreparedPanorama& panorama,
                                                 vtkOpenGLRenderWindow* window) {
    std::vector<std::array<float, 2>> all;
    for (const anamorph::ProjectionGroup& group : panorama.groups)
        if (!panorama.machine) all.insert(all.end(), group.residuals.begin(), group.residuals.end());
    // Texels of all their formats are floats.
    for (const anamorph::machine::BumpTable& table : panorama.bumps)
        for (const auto& texel : table.texels)
            all.push_back({static_cast<float>(texel[0]), static_cast<float>(texel[1])});
    const auto texture = new_texture(window);
    const auto columns = static_cast<unsigned>(panorama.field.columns);
    texture->Create2DFromRaw(columns, static_cast<unsigned>(all.size()) / columns, 2, VTK_FLOAT, all.data());
    return texture;
}

vtkSmartPointer<vtkTextureObject> drawn_planes(const PreparedPanorama& panorama, bool bytes,
                                               vtkOpenGLTexture* picture, vtkOpenGLRenderWindow* window) {
    const auto width = static_cast<unsigned>(panorama.thrown.plane_size),
               height = width * static_cast<unsigned>(panorama.groups.size());
    const int most = vtkTextureObject::GetMaximumTextureSize(window);
    if (most > 0 && height > static_cast<unsigned>(most))
        throw anamorph::Error("PlaneSize", std::to_string(width),
                              "times the number of directions must be no more than " + std::to_string(most));
    const auto texture = new_texture(window);
    texture->Allocate2D(width, height, 4, bytes ? VTK_UNSIGNED_CHAR : VTK_FLOAT);
    draw_all_of(texture, plane_text(panorama), picture, window);
    return texture;
}

vtkSmartPointer<vtkTextureObject> blank_texture(vtkOpenGLRenderWindow* window) {
    const auto texture = new_texture(window);
    std::array<unsigned char, 4> white{255, 255, 255, 255};
    texture->Create2DFromRaw(1, 1, 4, VTK_UNSIGNED_CHAR, white.data());
    return texture;
}

}  // namespace anamorph_vtk
