// SPDX-License-Identifier: Apache-2.0
// All of the libraries without hosts: a header for each topic.
#pragma once

#include "anamorph/chart.h"
#include "anamorph/deform.h"
#include "anamorph/error.h"
#include "anamorph/figure.h"
#include "anamorph/image.h"
#include "anamorph/mesh.h"
#include "anamorph/morph.h"
#include "anamorph/operation.h"
#include "anamorph/panorama.h"
#include "anamorph/parallel_for.h"
#include "anamorph/projector.h"
#include "anamorph/version.h"

/// All that the libraries declare; figures have the namespace anamorph::figure in it.
namespace anamorph {}
