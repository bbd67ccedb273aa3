// SPDX-License-Identifier: Apache-2.0
// A map as a link of a chain of maps (chain/chain_map.h), whatever it is made of.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "anamorph/number/hypot.h"
#include "anamorph/number/jets.h"
#include "anamorph/number/rounded.h"
#include "anamorph/plan/formula_map.h"
#include "anamorph/plan/formula_plan.h"

namespace anamorph {

/// The place where a link is read: Local of its map.
using LinkPlace = std::shared_ptr<const void>;

namespace link_detail {

template <class... T>
struct Numbers {};
/// The numbers that plans read formulas with.
using PlanNumbers = Numbers<double, Jet1<double>, Interval, Jet<Interval, 1>, Jet<Interval, 2>,
                            Rounded<double>, simd::TaylorJets, simd::BoundJets>;

/// Something that finds source points with each of some numbers.
template <class List>
class Reads;
template <>
class Reads<Numbers<>> {
  public:
    virtual ~Reads() = default;
    void read() const = delete;
};
template <class T, class... Rest>
class Reads<Numbers<T, Rest...>> : public Reads<Numbers<Rest...>> {
  public:
    using Reads<Numbers<Rest...>>::read;
    /// Finds the source point of a target point near `place`.
    virtual Point<T> read(const Point<T>& p, const LinkPlace& place) const = 0;
};

/// `Base` with its reads by Link::formula().
template <class Link, class Base, class List>
class ReadsFormula;
template <class Link, class Base>
class ReadsFormula<Link, Base, Numbers<>> : public Base {};
template <class Link, class Base, class T, class... Rest>
class ReadsFormula<Link, Base, Numbers<T, Rest...>> : public ReadsFormula<Link, Base, Numbers<Rest...>> {
  public:
    using ReadsFormula<Link, Base, Numbers<Rest...>>::read;
    Point<T> read(const Point<T>& p, const LinkPlace& place) const final {
        return static_cast<const Link&>(*this).formula(p, place);
    }
};

}  // namespace link_detail

/// A FormulaMap (plan/formula_map.h) of any type, and how it is planned when it is alone.
class MapLink : public link_detail::Reads<link_detail::PlanNumbers> {
  public:
    virtual Size target_size() const = 0;
    virtual Size source_size() const = 0;
    virtual std::vector<Box> target_pieces() const = 0;
    virtual SourceEdges source_edges() const = 0;
    /// The periods of x in source pixels and in target pixels, or 0.
    virtual int source_period() const = 0;
    virtual int target_period() const = 0;
    /// May points be read that another map computed? Else only the target's coordinates themselves may.
    virtual bool reads_computed_points() const = 0;
    virtual PlanOptions options() const = 0;

    virtual LinkPlace place_around(double x, double y, int piece) const = 0;
    virtual int source_piece(const LinkPlace& place) const = 0;
    virtual Cover cover(const Interval& x, const Interval& y, int piece, const LinkPlace& place,
                        bool across_seam) const = 0;
    virtual bool exact(double x, double y, int piece, Point<double>& p, int& source_piece) const = 0;
    virtual bool exact(DoubleDouble x, DoubleDouble y, int piece, Point<DoubleDouble>& p,
                       int& source_piece) const = 0;
    /// Bounds the error of source points that exact() finds in double or DoubleDouble from points of a box, which are
    /// themselves off by up to `off` and lie in the box with where they belong. As FormulaMap's exact_error else.
    virtual double exact_error(const Interval& x, const Interval& y, int piece, double off,
                               bool in_long_double) const = 0;

    /// The derivative at a target point; no number where there is no source point.
    virtual Jacobian jacobian(double x, double y, int piece) const = 0;

    /// A box that holds all source points of a box of the target, the true ones and those that exact() finds, though they lie on
    /// no one branch; none where that is not known, or where some have none.
    virtual std::optional<Point<Interval>> points_of(const Interval& x, const Interval& y) const = 0;

    /// Appends how far a target point lies within each edge of the pictures that the map leads through on its way, if there are
    /// such, in pixels of those: negative beyond. False where that is not known of all points of a box.
    virtual bool add_edges(const Point<Jet1<double>>& p, int piece,
                           std::vector<Jet1<double>>& edges) const = 0;
    virtual bool add_edges(const Point<Jet1<Interval>>& p, int piece,
                           std::vector<Jet1<Interval>>& edges) const = 0;

    /// Does the map end inside of its target, or do pictures that it leads through have edges?
    virtual bool may_end() const = 0;
    /// May it end in a box?
    virtual bool may_end_in(const Interval& x, const Interval& y, int piece) const = 0;
    /// Does it certainly end nowhere in a box, and lies that within all those edges?
    virtual bool is_clear(const Interval& x, const Interval& y, int piece) const = 0;
    /// Appends numbers that are positive on one side of where the map ends, near a target point, and negative on the other, where there
    /// is no source point; in no unit. False where the point itself has none.
    virtual bool add_ends(const Point<Jet1<double>>& p, int piece,
                          std::vector<Jet1<double>>& edges) const = 0;
};

/// A function of target points as add_ends() gives them: its value, and its derivatives by differences over half a pixel.
template <class Function>
Jet1<double> end_of(const Function& function, const Point<Jet1<double>>& p) {
    constexpr double kStep = 0.25;
    const double x = p.x.c[0], y = p.y.c[0];
    const double by_x = (function(x + kStep, y) - function(x - kStep, y)) / (2 * kStep),
                 by_y = (function(x, y + kStep) - function(x, y - kStep)) / (2 * kStep);
    Jet1<double> end;
    end.c[0] = function(x, y);
    for (int k = 1; k < 3; ++k) end.c[k] = by_x * p.x.c[k] + by_y * p.y.c[k];
    return end;
}

/// The link of a map.
template <FormulaMap Map>
class LinkOf final : public link_detail::ReadsFormula<LinkOf<Map>, MapLink, link_detail::PlanNumbers> {
    using Local = typename Map::Local;

  public:
    LinkOf(Map map, PlanOptions options) : m_map(std::move(map)), m_options(std::move(options)) {}

    Size target_size() const override { return m_map.target_size(); }
    Size source_size() const override { return m_map.source_size(); }
    std::vector<Box> target_pieces() const override { return m_map.target_pieces(); }
    SourceEdges source_edges() const override { return m_map.source_edges(); }
    int source_period() const override { return m_map.period(); }
    int target_period() const override {
        if constexpr (requires { m_map.target_period(); })
            return m_map.target_period();
        else
            return 0;
    }
    bool reads_computed_points() const override {
        if constexpr (requires { m_map.reads_computed_points(); })
            return m_map.reads_computed_points();
        else
            return true;
    }
    PlanOptions options() const override { return m_options; }

    LinkPlace place_around(double x, double y, int piece) const override {
        return std::make_shared<const Local>(m_map.local_around(x, y, piece));
    }
    int source_piece(const LinkPlace& place) const override { return m_map.source_piece(local(place)); }
    Cover cover(const Interval& x, const Interval& y, int piece, const LinkPlace& place,
                bool across_seam) const override {
        return m_map.cover(x, y, piece, local(place), across_seam);
    }
    bool exact(double x, double y, int piece, Point<double>& p, int& source_piece) const override {
        return m_map.exact(x, y, piece, p, source_piece);
    }
    bool exact(DoubleDouble x, DoubleDouble y, int piece, Point<DoubleDouble>& p,
               int& source_piece) const override {
        return m_map.exact(x, y, piece, p, source_piece);
    }
    double exact_error(const Interval& x, const Interval& y, int piece, double off,
                       bool in_long_double) const override {
        return in_long_double ? error_in<DoubleDouble>(x, y, piece, off) : error_in<double>(x, y, piece, off);
    }
    Jacobian jacobian(double x, double y, int piece) const override {
        if constexpr (requires { m_map.jacobian(x, y, piece); }) {
            return m_map.jacobian(x, y, piece);
        } else {
            using J = Jet1<double>;
            const Point<J> p =
                m_map(J::variable(x, 1, 0), J::variable(y, 0, 1), m_map.local_around(x, y, piece));
            return {p.x.c[1], p.y.c[1], p.x.c[2], p.y.c[2]};
        }
    }
    template <class T>
    Point<T> formula(const Point<T>& p, const LinkPlace& place) const {
        return m_map(p.x, p.y, local(place));
    }
    std::optional<Point<Interval>> points_of(const Interval& x, const Interval& y) const override {
        if constexpr (requires { m_map.points_of(x, y); })
            return m_map.points_of(x, y);
        else
            return {};
    }
    bool add_edges(const Point<Jet1<double>>& p, int piece, std::vector<Jet1<double>>& edges) const override {
        return add_edges_of_map(p, piece, edges);
    }
    bool add_edges(const Point<Jet1<Interval>>& p, int piece,
                   std::vector<Jet1<Interval>>& edges) const override {
        return add_edges_of_map(p, piece, edges);
    }

    bool may_end() const override {
        if constexpr (requires { m_map.may_end(); })
            return m_map.may_end();
        else
            return requires {
                m_map.end(0.0, 0.0, 0);
            };
    }
    bool may_end_in(const Interval& x, const Interval& y, int piece) const override {
        if constexpr (requires { m_map.may_end_in(x, y, piece); })
            return m_map.may_end_in(x, y, piece);
        else if constexpr (requires { m_map.end(x, y, piece); })
            return !(m_map.end(x, y, piece).lo > 0);
        else
            return false;
    }
    bool is_clear(const Interval& x, const Interval& y, int piece) const override {
        if constexpr (requires { m_map.is_clear(x, y, piece); })
            return m_map.is_clear(x, y, piece);
        else
            return !may_end_in(x, y, piece);
    }
    bool add_ends(const Point<Jet1<double>>& p, int piece, std::vector<Jet1<double>>& edges) const override {
        if constexpr (requires { m_map.add_ends(p, piece, edges); }) {
            return m_map.add_ends(p, piece, edges);
        } else if constexpr (requires { m_map.end(0.0, 0.0, piece); }) {
            const Jet1<double> end = end_of([&](double x, double y) { return m_map.end(x, y, piece); }, p);
            // Where it is not known which way the end lies it is left to the pixel's middle.
            if (std::isfinite(end.c[0] + end.c[1] + end.c[2])) edges.push_back(end);
            return end.c[0] > 0;
        } else {
            return true;
        }
    }

  private:
    template <class J>
    bool add_edges_of_map(const Point<J>& p, int piece, std::vector<J>& edges) const {
        if constexpr (requires { m_map.add_edges(p, piece, edges); })
            return m_map.add_edges(p, piece, edges);
        else
            return true;
    }
    /// Bounds how much farther apart source points are than points of a box; infinite where the map is not smooth.
    double stretch(const Interval& x, const Interval& y, int piece) const {
        const Local local = m_map.local_around(0.5 * (x.lo + x.hi), 0.5 * (y.lo + y.hi), piece);
        const Cover cover = m_map.cover(x, y, piece, local, /*across_seam=*/true);
        if (cover != Cover::inside) return cover == Cover::outside ? 0 : HUGE_VAL;
        // |f(a) - f(b)| <= |f'| |a - b| on a box, which is convex; the norm is at most Frobenius's.
        using J = Jet<Interval, 1>;
        const Point<J> p = m_map(J::variable(x, 1, 0), J::variable(y, 0, 1), local);
        return hypot(hypot(magnitude(p.x.c[1]), magnitude(p.x.c[2])),
                     hypot(magnitude(p.y.c[1]), magnitude(p.y.c[2])));
    }
    template <class Real>
    double error_in(const Interval& x, const Interval& y, int piece, double off) const {
        if constexpr (requires { m_map.template exact_error<Real>(x, y, piece, off); }) {
            return m_map.template exact_error<Real>(x, y, piece, off);
        } else {
            const double error = m_map.template exact_error<Real>(x, y, piece);
            if (off == 0 || !(error < HUGE_VAL)) return error;
            return (stretch(x, y, piece) * off + error) * rounded_detail::kUp;
        }
    }
    static const Local& local(const LinkPlace& place) { return *static_cast<const Local*>(place.get()); }

    Map m_map;
    PlanOptions m_options;
};

}  // namespace anamorph
