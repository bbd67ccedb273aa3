// SPDX-License-Identifier: Apache-2.0
// Fisheye, equidistant: the radius is t, the angle from the axis.

struct Fisheye : AxisFamily {
    static constexpr Counted counted = Counted::axis;
    static constexpr Lensed lensed = Lensed::equidistant;
    static double diameter(const Setting&) { return 2 * std::numbers::pi; }

    template <class T>
    static T inside(const Point<T>& p, const Setting&) {
        return std::numbers::pi * std::numbers::pi * kSlack - (square(p.x) + square(p.y));
    }
    /// The local ray: sin t along the radius, cos t along the axis.
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        const auto cos = measured<T>(s.around.cos, s.around.error),
                   sin = measured<T>(s.around.sin, s.around.error);
        const T u = p.x * cos + p.y * sin, v = p.y * cos - p.x * sin;
        T k, ct;
        sinc_cos(T(square(u) + square(v)), k, ct);
        return {u * k, v * k, ct};
    }
    /// The point of a local ray. Straight ahead t / rho is 1 / z; the direction straight behind is all of the rim, of which one
    /// point is taken.
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const T rho = length(r.x, r.y);
        const auto on_axis = is_zero(rho);
        const T k = tilt_over_across(on_axis, rho, r.z, s.along);
        const auto cos = measured<T>(s.around.cos, s.around.error),
                   sin = measured<T>(s.around.sin, s.around.error);
        const auto behind = both(on_axis, is_negative(r.z));
        return {select(behind, T(kHalfTurn.as<T>()), T((r.x * cos - r.y * sin) * k)),
                select(behind, T(0), T((r.y * cos + r.x * sin) * k))};
    }

  private:
    static inline const Constant kHalfTurn{DoubleDouble::pi()};
};
