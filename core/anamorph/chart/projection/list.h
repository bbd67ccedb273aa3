// SPDX-License-Identifier: Apache-2.0
// All projections: one file and one line each.
//
// A projection's file is read twice, so neither it nor this list has a guard or a namespace. Where
// ANAMORPH_PROJECTION(name, Type) is defined, the file is that entry alone: an enumerator, a case of a switch, a
// row of a table. Where it is not, the file is the formulas, included inside a namespace: the one of chart.h, and
// one for every instruction set whose vectors read them.
//
// The order is that of menus and documentation, and of numbers in saved states: new ones come last.
//
// clang-format off
#include "anamorph/chart/projection/families.h"

#include "anamorph/chart/projection/equirectangular.h"
#include "anamorph/chart/projection/cylindrical.h"
#include "anamorph/chart/projection/rectilinear.h"
#include "anamorph/chart/projection/fisheye.h"
#include "anamorph/chart/projection/equisolid.h"
#include "anamorph/chart/projection/stereographic.h"
#include "anamorph/chart/projection/mercator.h"
#include "anamorph/chart/projection/cubemap.h"
#include "anamorph/chart/projection/cubemap3x2.h"
#include "anamorph/chart/projection/cubecross.h"
#include "anamorph/chart/projection/eac.h"
#include "anamorph/chart/projection/pannini.h"
#include "anamorph/chart/projection/orthographic.h"
#include "anamorph/chart/projection/sinusoidal.h"
#include "anamorph/chart/projection/hammer.h"
#include "anamorph/chart/projection/dual_fisheye.h"
#include "anamorph/chart/projection/octahedral.h"
// clang-format on
