// SPDX-License-Identifier: Apache-2.0
// Textures that modes residual and multipass read beside the panorama.
#pragma once

#include "projection_text.h"
#include "vtkSmartPointer.h"

class vtkOpenGLRenderWindow;
class vtkOpenGLTexture;
class vtkTextureObject;

namespace anamorph_vtk {

/// The texture of the residuals of all groups, one above the other.
vtkSmartPointer<vtkTextureObject> residual_table(const PreparedPanorama& panorama,
                                                 vtkOpenGLRenderWindow* window);

/// Draws the panorama on its projection planes. `bytes`: are 8 bits a channel enough? Throws Error where they are larger
/// than textures may be.
vtkSmartPointer<vtkTextureObject> drawn_planes(const PreparedPanorama& panorama, bool bytes,
                                               vtkOpenGLTexture* picture, vtkOpenGLRenderWindow* window);

/// A texture of one white texel, where there is no other.
vtkSmartPointer<vtkTextureObject> blank_texture(vtkOpenGLRenderWindow* window);

}  // namespace anamorph_vtk
