// SPDX-License-Identifier: Apache-2.0
// What chart.h reads from the formulas of projections, for any number of number/number.h. Few files include this one: a formula
// that changes is compiled where it is read.
#pragma once

#include "anamorph/chart/chart.h"
#include "anamorph/number/rounded.h"

namespace anamorph {

namespace projection {
#include "anamorph/chart/projection/list.h"
}  // namespace projection

/// Calls body(P()) with the class P of namespace projection that has the formulas of a projection.
template <class Body>
decltype(auto) with_projection(Projection projection, const Body& body) {
    switch (projection) {
#define ANAMORPH_PROJECTION(name, Type) \
    case Projection::name:              \
        return body(projection::Type());
#include "anamorph/chart/projection/list.h"
#undef ANAMORPH_PROJECTION
    }
    return body(projection::Equirectangular());
}

namespace chart_plane {
#include "anamorph/chart/chart_plane.h"
}  // namespace chart_plane

template <class T>
Point<T> Chart::to_observed_plane(const T& x, const T& y, const Branch& branch) const {
    return chart_plane::plane_of_pixel(x, y, branch, m_per_x.as<T>(), m_per_y.as<T>());
}

template <class T>
Point<T> Chart::to_plane(const T& x, const T& y, const Branch& branch) const {
    Point<T> p = to_observed_plane(x, y, branch);
    if (m_lens) p = m_lens->ideal(p);
    return p;
}

template <class T>
T Chart::inside(const T& x, const T& y, int piece) const {
    const Point<T> p = to_plane(x, y, branch(piece));
    const T there =
        with_projection(m_projection, [&](auto formulas) { return formulas.inside(p, branch(piece)); });
    return m_lens ? min(there, m_lens->inside(to_observed_plane(x, y, branch(piece)))) : there;
}

template <class T>
Ray<T> Chart::local_ray(const T& x, const T& y, const Branch& branch) const {
    const Point<T> p = to_plane(x, y, branch);
    return with_projection(m_projection, [&](auto formulas) { return formulas.ray(p, branch); });
}

template <class T>
T Chart::sees_without_lens(const Ray<T>& local, int piece) const {
    return with_projection(m_projection, [&](auto formulas) { return formulas.sees(local, branch(piece)); });
}

template <class T>
T Chart::sees(const Ray<T>& local, int piece) const {
    const T there = sees_without_lens(local, piece);
    if (!m_lens) return there;
    // What the projection does not see may have no point in its plane.
    const Point<T> p = with_projection(
        m_projection, [&](auto formulas) -> Point<T> { return formulas.point(local, branch(piece)); });
    return select(is_negative(there), there, min(there, m_lens->sees(p)));
}

template <class T>
T Chart::crease(const T& x, const T& y, int piece) const {
    // No projection of one piece that may have a lens has a crease.
    const Point<T> p = to_observed_plane(x, y, branch(piece));
    return with_projection(m_projection, [&](auto formulas) { return formulas.plane_crease(p); });
}
template <class T>
T Chart::crease(const Ray<T>& local) const {
    return with_projection(m_projection, [&](auto formulas) { return formulas.ray_crease(local); });
}

template <class T>
Point<T> Chart::local_point(const Ray<T>& local, const Branch& branch) const {
    Point<T> p = with_projection(m_projection,
                                 [&](auto formulas) -> Point<T> { return formulas.point(local, branch); });
    if (m_lens) p = m_lens->observed(p);
    return chart_plane::pixel_of_plane(p, branch, m_sx.as<T>(), m_sy.as<T>());
}

}  // namespace anamorph
