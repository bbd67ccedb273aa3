// SPDX-License-Identifier: Apache-2.0
// Every operation by its name, with its table of parameters, as hosts call it: pano, lens, map, warp, morph, drape and the
// others.
//
// find_operation() gives an Operation; ParameterValues checks what is asked for; Operation::read makes Pictures of it.
// Example: examples/cpp/operation.cpp.
#pragma once

#include "anamorph/operation/operation.h"
#include "anamorph/operation/side_files.h"
#include "anamorph/parameter/parameter.h"
