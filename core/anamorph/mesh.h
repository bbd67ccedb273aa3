// SPDX-License-Identifier: Apache-2.0
// Pictures warped by control meshes, pairs of points and ST-maps (Kim 2003, chapter 5), to a proven tolerance.
//
// A WarpMap holds a ControlMesh or ControlPoints, made in memory or read from text. Example: examples/cpp/mesh.cpp.
#pragma once

#include "anamorph/mesh/mesh_data.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_warp.h"
