// SPDX-License-Identifier: Apache-2.0
// A panorama, or any picture with a projection, seen through another (Kim 2003, chapter 4), to a proven tolerance.
//
// A Panorama is the map between two charts. Example: examples/cpp/panorama.cpp.
#pragma once

#include "anamorph/panorama/panorama.h"
#include "anamorph/panorama/reproject.h"
