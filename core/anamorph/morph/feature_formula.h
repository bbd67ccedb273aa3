// SPDX-License-Identifier: Apache-2.0
// What one feature line says about a pixel (Kim 2003, eq. 5.9 to 5.11; Beier and Neely 1992): templates over
// the number, read with double, jets, vectors of floats, and what writes shaders.
//
// No include guard and no namespace: vectors need the templates compiled for each instruction set, so whoever
// reads them includes this file inside a namespace of his own (morph/feature_lines.h, morph/feature_glsl.cpp, morph/near_far_lanes.cpp), where
// max(T, T) and root(T) are known for his numbers.
//
// A pixel X in the frame of a line from p to q: along = (X - p) . e / |e| = u |e| and beside = v, with
// e = q - p.

/// The distance of the point X along a line of unit direction (ux, uy), with X - p = (dx, dy).
template <class T, class U>
inline T along_line(const T& dx, const T& dy, const U& ux, const U& uy) {
    return dx * ux + dy * uy;
}
/// The distance of X beside such a line.
template <class T, class U>
inline T beside_line(const T& dx, const T& dy, const U& ux, const U& uy) {
    return dy * ux - dx * uy;
}

/// The square of dist of eq. 5.11, from the distances of X before p (-along), behind q (along - |e|) and
/// beside the line.
template <class T>
inline T square_to_line(const T& before, const T& behind, const T& beside) {
    const T beyond = max(max(before, behind), T(0));
    return beyond * beyond + beside * beside;
}
/// The distance dist of eq. 5.11, from the same arguments as square_to_line().
template <class T>
inline T distance_to_line(const T& before, const T& behind, const T& beside) {
    return root(square_to_line(before, behind, beside));
}

/// The displacement of a pixel by one line, along one axis: eq. 5.10 less X. `origin`: the displacement at p; the rates:
/// its increase per unit of along and beside.
template <class T>
inline T displacement_by_line(const T& origin, const T& along_rate, const T& along, const T& beside_rate,
                              const T& beside) {
    return origin + along_rate * along + beside_rate * beside;
}

/// The weight of eq. 5.11 of a line at `far`, its a + dist, where `nearest` is the least of any. `power`: (length^p / far)^b without the
/// factor. On a line with a = 0, nothing counts but what is there.
template <class T, class U, class Power>
inline T weight_of_line(const T& far, const T& nearest, const U& factor, const Power& power) {
    return select(is_zero(nearest), select(is_zero(far), T(factor), T(0)), T(power(far) * factor));
}

/// Eq. 5.9 along one axis: a pixel's source point, in a picture `scale` times as large. `displacements`: their sum, by their weights.
template <class T, class U>
inline T source_coordinate(const T& x, const T& displacements, const T& weights, const U& scale) {
    return (x + displacements / weights) * scale;
}
