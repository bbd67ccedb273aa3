// SPDX-License-Identifier: Apache-2.0
// The formulas of all surfaces in list.h.
#pragma once

#include "anamorph/surface/shape/cylinder.h"
#include "anamorph/surface/shape/page_turn.h"
#include "anamorph/surface/shape/plane.h"
#include "anamorph/surface/shape/ripples.h"
#include "anamorph/surface/shape/sphere.h"
#include "anamorph/surface/shape/torus.h"
#include "anamorph/surface/shape/waves.h"
