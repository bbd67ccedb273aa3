// SPDX-License-Identifier: Apache-2.0
#include "anamorph/map/surface.h"

#include <algorithm>

#include "anamorph/map/surface/cylinder.h"
#include "anamorph/map/surface/page_turn.h"
#include "anamorph/map/surface/plane.h"
#include "anamorph/map/surface/ripples.h"
#include "anamorph/map/surface/sphere.h"
#include "anamorph/map/surface/torus.h"
#include "anamorph/map/surface/waves.h"

namespace anamorph {
namespace {

/// What influence() encloses over a box of (u, v), for Wendland's kernel, which is smooth at r = 0 though r is not. With
/// x and y in extents and r^2 = x^2 + y^2, up to r = 1:
///     F_x = -20 (1 - r)^3 x,  F_xx = -20 (1 - r)^3 + 60 (1 - r)^2 x^2 / r,  F_xy = 60 (1 - r)^2 x y / r,
/// where x^2 / r is at most r, and |x y| / r at most r / 2.
Jet<Interval, 2> wendland_range(const Deformation& d, const Interval& u, const Interval& v) {
    const Interval a = Interval(1) / Interval(d.extent.x), b = Interval(1) / Interval(d.extent.y);
    const Interval x = (u - d.center.x) * a, y = (v - d.center.y) * b;
    const Interval r = min(sqrt(square(x) + square(y)), Interval(1)), rest = max(1.0 - r, Interval(0));
    const Interval squared = square(rest), cubed = squared * rest;
    const auto over_r = [&](const Interval& product, const Interval& bound) {
        const Interval quotient = r.lo > 0 ? product / r : bound;
        return Interval(std::max(quotient.lo, bound.lo), std::min(quotient.hi, bound.hi));
    };
    const Interval xx = over_r(square(x), {0, r.hi}), yy = over_r(square(y), {0, r.hi}),
                   xy = over_r(x * y, {-r.hi / 2, r.hi / 2});
    Jet<Interval, 2> f(square(squared) * (r * 4.0 + 1.0));
    f.c[1] = cubed * x * -20.0 * a;
    f.c[2] = cubed * y * -20.0 * b;
    f.c[3] = (cubed * -10.0 + squared * xx * 30.0) * square(a);
    f.c[4] = squared * xy * 60.0 * a * b;
    f.c[5] = (cubed * -10.0 + squared * yy * 30.0) * square(b);
    return f;
}

/// influence(), and what encloses it.
template <class T>
T influence_of(const Deformation& d, const T& u, const T& v) {
    return influence(d, u, v);
}
/// Of the variables u and v themselves.
Jet<Interval, 2> influence_of(const Deformation& d, const Jet<Interval, 2>& u, const Jet<Interval, 2>& v) {
    return d.kernel == DeformationKernel::wendland_c2 ? wendland_range(d, u.value(), v.value())
                                                      : influence(d, u, v);
}

/// A formula, moved by deformations, read with the numbers that a DrapedSurface is read with.
template <class Formula>
class FormulaSurface final : public DrapedSurface {
  public:
    FormulaSurface(const SurfaceShape& shape, const std::vector<Deformation>& deformations)
        : m_formula(shape) {
        for (Deformation d : deformations) {
            check_deformation(d);
            // Its v is counted up. Differences from a centre are exact near by, and one from 1 would not be.
            d.center.y = 1 - d.center.y;
            if (d.enabled) m_deformations.push_back(d);
        }
    }

    glm::dvec3 position(double u, double v) const noexcept override {
        const SurfacePoint<double> p = point(u, v);
        return {p.x, p.y, p.z};
    }
    double rounding(double u, double v) const noexcept override {
        // Whatever an operation rounds, intervals enclose it. Eight times that: a surface's own numbers, such as turns in
        // radians, have been rounded too.
        const SurfacePoint<Interval> p = point(Interval(u), Interval(v));
        return 8 * std::max({p.x.hi - p.x.lo, p.y.hi - p.y.lo, p.z.hi - p.z.lo});
    }
    SurfaceFrame frame(double u, double v) const noexcept override {
        using J = Jet<double, 1>;
        const SurfacePoint<J> p = point(J::variable(u, 1, 0), J::variable(v, 0, 1));
        const auto part = [&](int i) { return glm::dvec3(p.x.c[i], p.y.c[i], p.z.c[i]); };
        return {part(0), part(1), part(2)};
    }
    std::array<long double, 3> truth(long double u, long double v) const noexcept override {
        const SurfacePoint<long double> p = point(u, v);
        return {p.x, p.y, p.z};
    }
    SurfaceRange range(const Interval& u, const Interval& v) const noexcept override {
        using J = Jet<Interval, 2>;
        const SurfacePoint<J> p = point(J::variable(u, 1.0, 0.0), J::variable(v, 0.0, 1.0));
        return {p.x, p.y, p.z};
    }

  private:
    template <class T>
    SurfacePoint<T> point(const T& u, const T& v) const {
        SurfacePoint<T> p = m_formula.point(u, v);
        for (const Deformation& d : m_deformations) {
            const T share = influence_of(d, u, v);
            p = {p.x + share * d.vector.x, p.y + share * d.vector.y, p.z + share * d.vector.z};
        }
        return p;
    }

    Formula m_formula;
    std::vector<Deformation> m_deformations;  ///< with v down
};

using Make = std::shared_ptr<const DrapedSurface> (*)(const SurfaceShape&, const std::vector<Deformation>&);

template <class Formula>
std::shared_ptr<const DrapedSurface> make(const SurfaceShape& shape,
                                          const std::vector<Deformation>& deformations) {
    return std::make_shared<FormulaSurface<Formula>>(shape, deformations);
}

}  // namespace

const std::vector<std::string>& surface_names() {
    static const std::vector<std::string> names = {
#define ANAMORPH_SURFACE(name, Type) #name,
#include "anamorph/map/surface/list.h"
#undef ANAMORPH_SURFACE
    };
    return names;
}

std::shared_ptr<const DrapedSurface> make_surface(std::size_t which, const SurfaceShape& shape,
                                                  const std::vector<Deformation>& deformations) {
    static const std::vector<Make> makers = {
#define ANAMORPH_SURFACE(name, Type) make<surfaces::Type>,
#include "anamorph/map/surface/list.h"
#undef ANAMORPH_SURFACE
    };
    return makers[which](shape, deformations);
}

}  // namespace anamorph
