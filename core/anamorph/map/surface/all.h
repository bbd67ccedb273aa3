// SPDX-License-Identifier: Apache-2.0
// The formulas of all surfaces in list.h.
#pragma once

#include "anamorph/map/surface/cylinder.h"
#include "anamorph/map/surface/page_turn.h"
#include "anamorph/map/surface/plane.h"
#include "anamorph/map/surface/ripples.h"
#include "anamorph/map/surface/sphere.h"
#include "anamorph/map/surface/torus.h"
#include "anamorph/map/surface/waves.h"
