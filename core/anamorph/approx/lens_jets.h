// SPDX-License-Identifier: Apache-2.0
// What formulas of lenses (map/lens_formula.h) find by iterations or in tables, for four jets: roots and coefficients one
// after the other, what is made of them at once.
#pragma once

#include "anamorph/map/lens.h"
#include "anamorph/simd/jets.h"

namespace anamorph::simd {

/// sum_k c_k f^k of four jets f less their constant parts, where series(i) has the c_k of one.
template <class T, int N, class SeriesOf>
Jets<T, N> composed(const Jets<T, N>& f, const SeriesOf& series) {
    Four<T> c[N + 1];
    for (int i = 0; i < kJets; ++i) {
        const auto one = series(i);
        for (int k = 0; k <= N; ++k) c[k].set(i, one.c[k]);
    }
    Jets<T, N> r;
    compose_with(c, f, r);
    return r;
}

template <int N>
Jets<double, N> stretch_of(const LensTerms& lens, const Point<Jets<double, N>>& u) {
    return lens_formula::stretch_at(lens, lens_formula::radial_of(lens, u));
}
template <int N>
Jets<Interval, N> stretch_of(const LensTerms& lens, const Point<Jets<Interval, N>>& u) {
    if (!lens.in_radius) return lens_formula::stretch_at(lens, lens_formula::radial_of(lens, u));
    const Jets<Interval, N> squared = square(u.x) + square(u.y);
    return composed(squared, [&](int i) { return stretch_coefficients(lens, squared.c[0][i]); });
}
template <int N>
Jets<Interval, N> shrink_of(const LensTerms& lens, const Point<Jets<Interval, N>>& v) {
    const Jets<Interval, N> squared = square(v.x) + square(v.y);
    return composed(squared, [&](int i) { return shrink_coefficients(lens, squared.c[0][i]); });
}
template <int N>
Jets<double, N> shrink_of(const LensTerms& lens, const Point<Jets<double, N>>& v) {
    const Jets<double, N> value = lens_formula::radial_of(lens, v);
    return composed(value, [&](int i) {
        return lens_detail::shrink_series<N>(lens, lens_detail::radial_root(lens, value.c[0][i]));
    });
}

namespace lens_jets_detail {

/// Coefficients as constant parts.
template <class T, int N>
Point<Jets<T, N>> about(const Point<Jets<T, N>>& u, const Point<Four<T>>& constant) {
    Point<Jets<T, N>> r = u;
    r.x.c[0] = constant.x;
    r.y.c[0] = constant.y;
    return r;
}
/// settled() of the constant parts.
template <class T, int N>
Point<Four<T>> settled_constants(const LensTerms& lens, const Point<Jets<T, N>>& v) {
    using lens_formula::settled;
    Point<Four<T>> constant;
    for (int i = 0; i < kJets; ++i) {
        const Point<T> u = settled(lens, Point<T>{v.x.c[0][i], v.y.c[0][i]});
        constant.x.set(i, u.x);
        constant.y.set(i, u.y);
    }
    return constant;
}
template <class T, int N>
Point<Jet<T, N>> one_of(const Point<Jets<T, N>>& p, int i) {
    return {p.x.at(i), p.y.at(i)};
}
template <class T, int N>
void set_one(Point<Jets<T, N>>& p, int i, const Point<Jet<T, N>>& one) {
    p.x.set(i, one.x);
    p.y.set(i, one.y);
}

}  // namespace lens_jets_detail

/// As for single jets (map/lens.h): each of the four ends with the first box that is mapped into itself.
template <int N>
Point<Jets<Interval, N>> settled(const LensTerms& lens, const Point<Jets<Interval, N>>& v) {
    using namespace lens_jets_detail;
    using J = Point<Jets<Interval, N>>;
    const Point<Four<Interval>> constant = settled_constants(lens, v);
    const auto nearer = [&](const J& u) { return about(lens_formula::nearer(lens, v, u), constant); };
    J from = about(lens_formula::radially_undistorted(lens, v), constant), to = nearer(from), found;
    bool is_found[kJets] = {};
    for (int step = 0; step < 2; ++step) {
        J box;
        for (int i = 0; i < kJets; ++i) {
            const auto a = one_of(from, i), b = one_of(to, i);
            set_one(box, i, {lens_detail::with_room(a.x, b.x), lens_detail::with_room(a.y, b.y)});
        }
        const J inner = nearer(box);
        for (int i = 0; i < kJets; ++i) {
            const auto outer_one = one_of(box, i), inner_one = one_of(inner, i);
            if (is_found[i] || !lens_detail::holds(outer_one.x, inner_one.x) ||
                !lens_detail::holds(outer_one.y, inner_one.y))
                continue;
            is_found[i] = true;
            set_one(found, i, inner_one);
        }
        if (std::all_of(is_found, is_found + kJets, [](bool one) { return one; })) return found;
        from = to;
        to = inner;
    }
    for (int i = 0; i < kJets; ++i)
        if (!is_found[i])
            set_one(found, i,
                    lens_detail::settled_by_degree(lens, one_of(v, i),
                                                   Point<Interval>{constant.x[i], constant.y[i]}));
    return found;
}
/// Degree by degree, as for single jets.
template <int N>
Point<Jets<double, N>> settled(const LensTerms& lens, const Point<Jets<double, N>>& v) {
    using namespace lens_jets_detail;
    using J = Jets<double, N>;
    const Point<Four<double>> constant = settled_constants(lens, v);
    Point<J> u = about(Point<J>{}, constant);
    for (int k = 1; k <= N; ++k) {
        const Point<J> f = lens_formula::distorted(lens, u);
        u.x.degree = u.y.degree = k;
        for (int i = 0; i < kJets; ++i) {
            const lens_formula::Slope<double> slope(lens, {constant.x[i], constant.y[i]});
            for (int at = Jet<double, N>::part(k); at < Jet<double, N>::part(k + 1); ++at) {
                const auto lacks = [&](const J& of_v, const J& of_f) {
                    return (at < of_v.terms() ? of_v.c[at][i] : 0) - (at < of_f.terms() ? of_f.c[at][i] : 0);
                };
                const Point<double> gain = slope.solved(lacks(v.x, f.x), lacks(v.y, f.y));
                u.x.c[at].set(i, gain.x);
                u.y.c[at].set(i, gain.y);
            }
        }
    }
    return u;
}

}  // namespace anamorph::simd
