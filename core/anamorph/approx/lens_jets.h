// SPDX-License-Identifier: Apache-2.0
// What formulas of lenses (map/lens_formula.h) find by iterations or in tables, for four jets: one after the other.
#pragma once

#include "anamorph/map/lens.h"
#include "anamorph/simd/jets.h"

namespace anamorph::simd {

template <class T, int N>
Jets<T, N> stretch_of(const LensTerms& lens, const Point<Jets<T, N>>& u) {
    if (!lens.in_radius) return lens_formula::stretch_at(lens, lens_formula::radial_of(lens, u));
    using lens_formula::stretch_of;
    Jets<T, N> r;
    for (int i = 0; i < kJets; ++i) r.set(i, stretch_of(lens, Point<Jet<T, N>>{u.x.at(i), u.y.at(i)}));
    return r;
}
template <class T, int N>
Jets<T, N> shrink_of(const LensTerms& lens, const Point<Jets<T, N>>& v) {
    using lens_formula::shrink_of;
    Jets<T, N> r;
    for (int i = 0; i < kJets; ++i) r.set(i, shrink_of(lens, Point<Jet<T, N>>{v.x.at(i), v.y.at(i)}));
    return r;
}
template <class T, int N>
Point<Jets<T, N>> settled(const LensTerms& lens, const Point<Jets<T, N>>& v) {
    using lens_formula::settled;
    Point<Jets<T, N>> r;
    for (int i = 0; i < kJets; ++i) {
        const Point<Jet<T, N>> u = settled(lens, Point<Jet<T, N>>{v.x.at(i), v.y.at(i)});
        r.x.set(i, u.x);
        r.y.set(i, u.y);
    }
    return r;
}

}  // namespace anamorph::simd
