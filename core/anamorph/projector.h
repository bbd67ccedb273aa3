// SPDX-License-Identifier: Apache-2.0
// Panoramas thrown onto scenes (Kim 2003, chapter 4): what a point receives, triangles cut until linear
// texture coordinates hold a tolerance, shadows, baked textures, and the formulas as GLSL.
//
// A Projector is a panorama with a pose. ScenePainter cuts a scene's triangles for it, bake() makes the mesh's own texture,
// Occluders tell what is in shadow. Example: examples/cpp/projector.cpp.
#pragma once

#include "anamorph/projector/occluders.h"
#include "anamorph/projector/panorama_glsl.h"
#include "anamorph/projector/projected_triangles.h"
#include "anamorph/projector/projection_bake.h"
#include "anamorph/projector/projection_groups.h"
#include "anamorph/projector/projector.h"
