// SPDX-License-Identifier: Apache-2.0
// Pictures in memory: pixels, sources with levels, borders and filters, and what is drawn from them through maps.
//
// Views (ImageView, ConstImageView) are strided pixels that somebody else owns. A Source hands out texels: MemorySource
// those of a view, Pyramid coarser levels of another source, made where they are read. A Picture draws any box of itself
// from sources; panorama.h, mesh.h and morph.h make Pictures. Example: examples/cpp/image.cpp.
#pragma once

#include "anamorph/geometry/box.h"
#include "anamorph/geometry/point.h"
#include "anamorph/geometry/size.h"
#include "anamorph/image/attribute.h"
#include "anamorph/image/border.h"
#include "anamorph/image/filter.h"
#include "anamorph/image/picture.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/source.h"
#include "anamorph/image/view.h"
#include "anamorph/plan/block.h"
#include "anamorph/plan/scheme.h"
