// SPDX-License-Identifier: Apache-2.0
// Pictures that turn into each other along corresponding lines (Kim 2003, 5.6), to a proven tolerance.
//
// Features are the lines, made in memory or read from text. Example: examples/cpp/morph.cpp.
#pragma once

#include "anamorph/morph/feature_lines.h"
#include "anamorph/morph/features_file.h"
#include "anamorph/morph/morph.h"
