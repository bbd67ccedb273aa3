// SPDX-License-Identifier: Apache-2.0
// Rectilinear: a camera without distortion, X = x / z and Y = y / z.

struct Rectilinear : FlatFamily {
    static constexpr FieldOfView fov{90, 180, true};
    static constexpr Lensed lensed = Lensed::flat;

    static DoubleDouble width(DoubleDouble degrees, const Setting&) { return 2 * tan_of(degrees / 2); }
    static double largest_tangent(double half_width, double half_height) {
        return std::max(half_width, half_height);
    }

    template <class T>
    static T sees(const Ray<T>& r, const Setting& s) {
        const T far = r.z * s.reach;
        return min(min(T(far - r.x), T(far + r.x)), min(T(far - r.y), T(far + r.y)));
    }
};
