// SPDX-License-Identifier: Apache-2.0
// All projections: one file each, and here one line in either part.
//
// Where ANAMORPH_PROJECTION(name, Type) is defined, this is what that makes of each: enumerators, cases of a switch, rows of a table.
// Where it is not, this is their formulas, which are included inside a namespace: that of chart_formulas.h, and one for every
// instruction set whose vectors read them. So neither this list nor the files have a guard or a namespace.
//
// The order is that of menus and documentation, and of numbers in saved states: new ones come last.
//
// clang-format off
#ifdef ANAMORPH_PROJECTION
ANAMORPH_PROJECTION(equirectangular, Equirectangular)
ANAMORPH_PROJECTION(cylindrical, Cylindrical)
ANAMORPH_PROJECTION(rectilinear, Rectilinear)
ANAMORPH_PROJECTION(fisheye, Fisheye)
ANAMORPH_PROJECTION(equisolid, Equisolid)
ANAMORPH_PROJECTION(stereographic, Stereographic)
ANAMORPH_PROJECTION(mercator, Mercator)
ANAMORPH_PROJECTION(cubemap, Cubemap)
ANAMORPH_PROJECTION(cubemap3x2, Cubemap3x2)
ANAMORPH_PROJECTION(cubecross, Cubecross)
ANAMORPH_PROJECTION(eac, Eac)
ANAMORPH_PROJECTION(pannini, Pannini)
ANAMORPH_PROJECTION(orthographic, Orthographic)
ANAMORPH_PROJECTION(sinusoidal, Sinusoidal)
ANAMORPH_PROJECTION(hammer, Hammer)
ANAMORPH_PROJECTION(dual_fisheye, DualFisheye)
ANAMORPH_PROJECTION(octahedral, Octahedral)
ANAMORPH_PROJECTION(mirror_ball, MirrorBall)
ANAMORPH_PROJECTION(unified, Unified)
ANAMORPH_PROJECTION(dual_fisheye_tb, DualFisheyeTb)
ANAMORPH_PROJECTION(eucm, Eucm)
ANAMORPH_PROJECTION(double_sphere, DoubleSphere)
#else
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
#include "anamorph/chart/projection/mirror_ball.h"
#include "anamorph/chart/projection/unified.h"
#include "anamorph/chart/projection/dual_fisheye_tb.h"
#include "anamorph/chart/projection/eucm.h"
#include "anamorph/chart/projection/double_sphere.h"
#endif
// clang-format on
