// SPDX-License-Identifier: Apache-2.0
// All projections: one file and one line each.
//
// A projection's file is read twice, so neither it nor this list has a guard or a namespace. Where
// ANAMORPH_PROJECTION(name, Type) is defined, the file is that entry alone: an enumerator, a case of a switch, a
// row of a table. Where it is not, the file is the formulas, included inside a namespace: the one of chart.h, and
// one for every instruction set whose vectors read them.
//
// The order is that of menus and documentation.
//
// clang-format off
#include "anamorph/map/projection/families.h"

#include "anamorph/map/projection/equirectangular.h"
#include "anamorph/map/projection/cylindrical.h"
#include "anamorph/map/projection/rectilinear.h"
#include "anamorph/map/projection/fisheye.h"
#include "anamorph/map/projection/equisolid.h"
#include "anamorph/map/projection/stereographic.h"
#include "anamorph/map/projection/mercator.h"
#include "anamorph/map/projection/cubemap.h"
#include "anamorph/map/projection/cubemap3x2.h"
#include "anamorph/map/projection/cubecross.h"
#include "anamorph/map/projection/eac.h"
#include "anamorph/map/projection/pannini.h"
#include "anamorph/map/projection/orthographic.h"
#include "anamorph/map/projection/sinusoidal.h"
#include "anamorph/map/projection/hammer.h"
#include "anamorph/map/projection/dual_fisheye.h"
#include "anamorph/map/projection/octahedral.h"
// clang-format on
