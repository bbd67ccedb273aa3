// SPDX-License-Identifier: Apache-2.0
// Surfaces deformed by editable bumps, and inbetweens of several of them (Oka et al. 1987, section 4).
//
// A DeformationList holds bumps and their edits; DeformedGrid and DeformedPoints compute surfaces, again only where an edit
// reaches. Example: examples/cpp/deform.cpp.
#pragma once

#include "anamorph/deform/deformation.h"
#include "anamorph/deform/deformation_entry.h"
#include "anamorph/deform/deformation_file.h"
#include "anamorph/deform/deformed_surface.h"
#include "anamorph/deform/inbetween.h"
#include "anamorph/deform/key_frames.h"
#include "anamorph/deform/plane_warp.h"
