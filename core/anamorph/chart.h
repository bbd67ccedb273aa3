// SPDX-License-Identifier: Apache-2.0
// Projections of panoramas and flat pictures, and lenses: rays from pixels and pixels from rays.
//
// A Chart is a picture's projection, size, field of view and lens. Example: examples/cpp/chart.cpp.
#pragma once

#include "anamorph/chart/chart.h"
#include "anamorph/chart/lens.h"
