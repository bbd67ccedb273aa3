// SPDX-License-Identifier: Apache-2.0
// The formulas of charts and lenses read with the numbers that most source files need: compiled once, in chart_numbers.cpp
// and chart_bounds.cpp.
#pragma once

#include "anamorph/chart/chart.h"
#include "anamorph/number/rounded.h"

namespace anamorph {

/// The functions from points to rays and back, read with T; `external` is extern, or nothing where they are compiled.
#define ANAMORPH_CHART_POINTS(external, T)                                              \
    external template Ray<T> Chart::local_ray(const T&, const T&, const Branch&) const; \
    external template Point<T> Chart::local_point(const Ray<T>&, const Branch&) const;  \
    external template Point<T> Lens::ideal(const Point<T>&) const;                      \
    external template Point<T> Lens::observed(const Point<T>&) const;
/// Declares the functions that say whether an image point has a ray, and whether a ray is seen, for the number T.
#define ANAMORPH_CHART_SIGHT(external, T)                             \
    external template T Chart::inside(const T&, const T&, int) const; \
    external template T Chart::sees(const Ray<T>&, int) const;
/// The functions that say where an image point or a ray is at a crease.
#define ANAMORPH_CHART_CREASE(external, T)                            \
    external template T Chart::crease(const T&, const T&, int) const; \
    external template T Chart::crease(const Ray<T>&) const;
/// Declares all functions of charts with the numbers of a pixel: its point and how that moves.
#define ANAMORPH_CHART_NUMBERS(external)          \
    ANAMORPH_CHART_POINTS(external, double)       \
    ANAMORPH_CHART_POINTS(external, Jet1<double>) \
    ANAMORPH_CHART_SIGHT(external, double)        \
    ANAMORPH_CHART_CREASE(external, double)
/// The same with the numbers of which bounds are made, and with DoubleDouble.
#define ANAMORPH_CHART_BOUNDS(external)                                                        \
    ANAMORPH_CHART_POINTS(external, DoubleDouble)                                              \
    ANAMORPH_CHART_POINTS(external, Interval)                                                  \
    ANAMORPH_CHART_POINTS(external, Rounded<double>)                                           \
    ANAMORPH_CHART_POINTS(external, Rounded<DoubleDouble>)                                     \
    ANAMORPH_CHART_POINTS(external, Jet1<Interval>)                                            \
    ANAMORPH_CHART_POINTS(external, Jet2<Interval>)                                            \
    ANAMORPH_CHART_SIGHT(external, DoubleDouble)                                               \
    ANAMORPH_CHART_SIGHT(external, Interval)                                                   \
    ANAMORPH_CHART_SIGHT(external, Rounded<double>)                                            \
    ANAMORPH_CHART_SIGHT(external, Rounded<DoubleDouble>)                                      \
    ANAMORPH_CHART_CREASE(external, Interval)                                                  \
    external template Interval Chart::sees_without_lens(const Ray<Interval>&, int) const;      \
    external template Point<Jet<Interval, 3>> Chart::local_point(const Ray<Jet<Interval, 3>>&, \
                                                                 const Branch&) const;         \
    external template Point<Jet<Interval, 3>> Lens::observed(const Point<Jet<Interval, 3>>&) const;

ANAMORPH_CHART_NUMBERS(extern)
ANAMORPH_CHART_BOUNDS(extern)

}  // namespace anamorph
