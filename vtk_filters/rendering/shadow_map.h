// SPDX-License-Identifier: Apache-2.0
// What a projector sees of the triangles that stand around it, as a texture: a cube of six faces, one above the other, whose
// texels are distances along the face's axis.
#pragma once

#include <glm/vec3.hpp>
#include <string>
#include <vector>

#include "anamorph/projector/projector.h"
#include "vtkSmartPointer.h"

class vtkOpenGLRenderWindow;
class vtkPolyData;
class vtkTextureObject;

namespace anamorph_vtk {

/// The corners of all triangles, three each, in a projector's frame of rays.
std::vector<glm::vec3> corners_around(vtkPolyData* mesh, const anamorph::ProjectorPose& pose);

/// Draws it; `size`: texels across a face.
vtkSmartPointer<vtkTextureObject> drawn_shadows(std::vector<glm::vec3> corners, int size,
                                                vtkOpenGLRenderWindow* window);

/// `bool anamorphHidden#(vec3 r, vec3 normal)`: does something stand before a point r of a surface, in the frame of rays? The
/// surface is continued to the middle of the map's texel as a plane, so that it does not hide itself; nor does anything that is
/// nearer to it than 4 / size of its distance.
std::string hidden_function(int size);

}  // namespace anamorph_vtk
