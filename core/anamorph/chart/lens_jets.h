// SPDX-License-Identifier: Apache-2.0
// What formulas of lenses (chart/lens_formula.h) find by iterations or in tables, for four jets: roots and coefficients one
// after the other, what is made of them at once.
#pragma once

#include <array>
#include <optional>

#include "anamorph/chart/lens.h"
#include "anamorph/chart/lens_lanes.h"
#include "anamorph/number/jets.h"

namespace anamorph::simd {

/// sum_k c_k f^k of four jets f less their constant parts, where series(i) has the c_k of jet i.
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
    Four<double> c[N + 1];
    shrink_series_of(lens, value.c[0], c);
    Jets<double, N> r;
    compose_with(c, value, r);
    return r;
}

namespace lens_jets_detail {

/// Replaces the constant parts of jets.
template <class T, int N>
Point<Jets<T, N>> about(const Point<Jets<T, N>>& u, const Point<Four<T>>& constant) {
    Point<Jets<T, N>> r = u;
    r.x.c[0] = constant.x;
    r.y.c[0] = constant.y;
    return r;
}
/// settled() of the constant parts of jets.
template <int N>
Point<Four<Interval>> settled_constants(const LensTerms& lens, const Point<Jets<Interval, N>>& v) {
    Point<Four<Interval>> constant;
    for (int i = 0; i < kJets; ++i) {
        const Point<Interval> u = settled(lens, Point<Interval>{v.x.c[0][i], v.y.c[0][i]});
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

/// settled() of four jets, as of single ones (chart/lens.h): each ends with the first box that is mapped into
/// itself.
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
namespace lens_jets_detail {

/// The coefficients of one degree that F(u) lacks of v.
template <int N>
struct Lacking {
    Point<double> of[N + 1][kJets];

    Lacking(const Point<Jets<double, N>>& v, const Point<Jets<double, N>>& f, int degree) {
        const auto less = [](const Jets<double, N>& a, const Jets<double, N>& b, int at, int i) {
            return (at < a.terms() ? a.c[at][i] : 0) - (at < b.terms() ? b.c[at][i] : 0);
        };
        for (int m = 0; m <= degree; ++m)
            for (int i = 0; i < kJets; ++i) {
                const int at = Jet<double, N>::part(degree) + m;
                of[m][i] = {less(v.x, f.x, at, i), less(v.y, f.y, at, i)};
            }
    }
};
using Slopes = std::array<std::optional<lens_formula::Slope<double>>, kJets>;
/// Solves the coefficients of one degree that u lacks, with the slope.
template <int N>
void solve_degree(const Slopes& slopes, const Lacking<N>& lacking, int degree, Point<Jets<double, N>>& u) {
    u.x.degree = u.y.degree = degree;
    for (int m = 0; m <= degree; ++m)
        for (int i = 0; i < kJets; ++i) {
            const int at = Jet<double, N>::part(degree) + m;
            const Point<double> gain = slopes[i]->solved(lacking.of[m][i].x, lacking.of[m][i].y);
            u.x.c[at].set(i, gain.x);
            u.y.c[at].set(i, gain.y);
        }
}
/// Takes off what the slope's first part makes of u's highest degree, which is a part of the next one.
template <int N>
void take_first_part(const LensTerms& lens, const Point<Jets<double, N>>& u, Lacking<N>& lacking) {
    using First = Jet<double, 1>;
    const int degree = u.x.degree;
    const auto first = [](const Jets<double, N>& a, int i) {
        return First::variable(a.c[0][i], a.c[1][i], a.c[2][i]);
    };
    for (int i = 0; i < kJets; ++i) {
        const lens_formula::Slope<First> slope(lens, {first(u.x, i), first(u.y, i)});
        for (int m = 0; m <= degree; ++m)
            for (int to = 0; to < 2; ++to) {
                const int at = Jet<double, N>::part(degree) + m;
                const double x = u.x.c[at][i], y = u.y.c[at][i];
                Point<double>& left = lacking.of[m + to][i];
                left.x -= slope.xx.c[1 + to] * x + slope.xy.c[1 + to] * y;
                left.y -= slope.yx.c[1 + to] * x + slope.yy.c[1 + to] * y;
            }
    }
}

}  // namespace lens_jets_detail

/// settled() of four jets, as of single ones, but two degrees at once: what F(u) lacks of v in degree k is
/// the slope times what u lacks; of degree k + 1, what the slope's first part makes of that is taken off
/// before.
template <int N>
Point<Jets<double, N>> settled(const LensTerms& lens, const Point<Jets<double, N>>& v) {
    using namespace lens_jets_detail;
    Point<Four<double>> constant;
    settled_of(lens, {v.x.c[0], v.y.c[0]}, constant);
    Slopes slopes;
    for (int i = 0; i < kJets; ++i) slopes[i].emplace(lens, Point<double>{constant.x[i], constant.y[i]});
    Point<Jets<double, N>> u = about(Point<Jets<double, N>>{}, constant);
    // F of a constant has none of the first degree.
    solve_degree(slopes, Lacking<N>(v, u, 1), 1, u);
    for (int k = 2; k <= N; k += 2) {
        const Point<Jets<double, N>> f = lens_formula::distorted(lens, u);
        solve_degree(slopes, Lacking<N>(v, f, k), k, u);
        if (k == N) break;
        Lacking<N> lacking(v, f, k + 1);
        take_first_part(lens, u, lacking);
        solve_degree(slopes, lacking, k + 1, u);
    }
    return u;
}

}  // namespace anamorph::simd
