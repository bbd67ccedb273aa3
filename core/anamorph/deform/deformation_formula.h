// SPDX-License-Identifier: Apache-2.0
// What a deformation does at a point: its kernel (Oka 1987, eq. 4.2; Wendland 1995), its side, and what becomes of the
// surface's normal. Templates over the number (number/number.h), read with double, jets and vectors.
//
// No include guard and no namespace: vectors need the templates compiled for each instruction set, so whoever
// reads them includes this file inside a namespace of his own (deform/deformation.h, deform/deform_lanes.cpp).

/// The Gaussian exp(-r^2), as a function of r^2.
template <class T>
inline T gaussian_of(const T& squared) {
    return exp_of_minus(squared);
}

/// Wendland's (1 - r)^4 (4 r + 1) up to r = 1, then 0, as a function of r^2.
template <class T>
inline T wendland_of(const T& squared) {
    const T r = sqrt(squared), rest = T(1.0) - r;
    const T inside = square(square(rest)) * (T(4.0) * r + T(1.0));
    // Expanded: 1 - 10 r^2 + 20 r^3 - 15 r^4 + 4 r^5. At r = 0, r^3 has no derivatives up to the second.
    const T centre = T(1.0) - T(10.0) * squared;
    return select(is_negative(rest), T(0.0), select(is_zero(squared), centre, inside));
}

/// H(2 s): 0 up to s = 0, 1 from s = 1/2 on, and a cubic between.
template <class T>
inline T side_share(const T& facing) {
    const T t = T(2.0) * facing, rest = T(1.0) - t;
    const T between = square(t) * (T(3.0) - T(2.0) * t);
    return select(is_negative(t), T(0.0), select(is_negative(rest), T(1.0), between));
}

/// A vector in space.
template <class T>
struct Triple {
    T x, y, z;
};
template <class T>
inline Triple<T> cross_product(const Triple<T>& a, const Triple<T>& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
inline T dot_product(const Triple<T>& a, const Triple<T>& b) {
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

/// Transforms a normal n, of any length, by the Jacobian J = I + a g^T + b h^T, with a and b the derivatives of the
/// displacement by u and v, and g and h the gradients of u and v:
///     cof(J) n = n + a x (n x g) + b x (n x h) + ((g x h) . n) a x b
/// For tangents s x t = n this is J s x J t. gh: g x h.
template <class T>
inline Triple<T> turned_normal(const Triple<T>& n, const Triple<T>& a, const Triple<T>& b, const Triple<T>& g,
                               const Triple<T>& h, const Triple<T>& gh) {
    const Triple<T> from_u = cross_product(a, cross_product(n, g)),
                    from_v = cross_product(b, cross_product(n, h)), both_ways = cross_product(a, b);
    const T across = dot_product(gh, n);
    return {n.x + from_u.x + from_v.x + across * both_ways.x,
            n.y + from_u.y + from_v.y + across * both_ways.y,
            n.z + from_u.z + from_v.z + across * both_ways.z};
}

/// What a further derivative c of the displacement, by a parameter with the gradient k, adds to turned_normal():
///     c x (n x k) + ((g x k) . n) a x c + ((h x k) . n) b x c
template <class T>
inline Triple<T> turned_further(const Triple<T>& n, const Triple<T>& a, const Triple<T>& b,
                                const Triple<T>& c, const Triple<T>& g, const Triple<T>& h,
                                const Triple<T>& k) {
    const Triple<T> from_w = cross_product(c, cross_product(n, k)), ac = cross_product(a, c),
                    bc = cross_product(b, c);
    const T gk = dot_product(cross_product(g, k), n), hk = dot_product(cross_product(h, k), n);
    return {from_w.x + gk * ac.x + hk * bc.x, from_w.y + gk * ac.y + hk * bc.y,
            from_w.z + gk * ac.z + hk * bc.z};
}

/// The normal and the angle of one corner, between edges of unit length, one of which may be 0: a x b / |a x b|, or 0,
/// and the angle. The sum over the corners at a point of normal times angle is the surface's normal there (Thuermer and
/// Wuethrich 1998).
template <class T>
inline Triple<T> corner_normal(const Triple<T>& a, const Triple<T>& b, T& angle) {
    const Triple<T> across = cross_product(a, b);
    const T sine = sqrt(dot_product(across, across));
    angle = atan2(sine, dot_product(a, b));
    const auto parallel = is_zero(sine);
    const T inverse = select(parallel, T(0.0), T(1.0) / sine);
    return {across.x * inverse, across.y * inverse, across.z * inverse};
}
