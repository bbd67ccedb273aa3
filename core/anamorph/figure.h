// SPDX-License-Identifier: Apache-2.0
// Figures of ellipsoids, animated by the language of NUDES, outlined with hidden lines removed, and shaded (Chapman 1986).
//
// A Script becomes a Program, a Performance plays it, a FigureFrame is one moment: outlines(), draw() and FigurePicture show
// it. Example: examples/cpp/figure.cpp.
#pragma once

#include "anamorph/figure/body/body_mapping.h"
#include "anamorph/figure/body/ellipse.h"
#include "anamorph/figure/body/ellipsoid.h"
#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/body/motion.h"
#include "anamorph/figure/body/skeleton.h"
#include "anamorph/figure/files/frame_file.h"
#include "anamorph/figure/files/motion_file.h"
#include "anamorph/figure/files/scene_file.h"
#include "anamorph/figure/image/figure_picture.h"
#include "anamorph/figure/image/shading.h"
#include "anamorph/figure/image/solid_look.h"
#include "anamorph/figure/language/performance.h"
#include "anamorph/figure/language/program.h"
#include "anamorph/figure/language/script.h"
#include "anamorph/figure/outline/connected.h"
#include "anamorph/figure/outline/drawing.h"
#include "anamorph/figure/outline/fit.h"
#include "anamorph/figure/outline/level_of_detail.h"
#include "anamorph/figure/outline/outline.h"
#include "anamorph/figure/outline/outline_style.h"
#include "anamorph/figure/outline/outline_view.h"
#include "anamorph/figure/outline/spheres.h"
#include "anamorph/figure/outline/viewport.h"
