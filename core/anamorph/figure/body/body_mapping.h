// SPDX-License-Identifier: Apache-2.0
// The place of a point of a body on its texture: (u, v) in 0 to 1, v down, from the point (x, y, z) of the
// unit sphere in the body's own axes. An unturned body's side towards the observer is z < 0; there all
// mappings show the middle of the texture, its left on the left and its top on the top.
//
// Chapman 1986, section 3.6, has latitude asin(y) and longitude asin(x / cos(latitude)), which shows the same
// on the front and the back, and the linear one, longitude asin(x).
#pragma once

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>
#include <numbers>

#include "anamorph/number/number.h"

namespace anamorph::figure {

/// How a texture is mapped onto a body.
enum class BodyMapping {
    latlong,     ///< longitude and latitude: once around, the seam at the back
    mirrored,    ///< longitude and latitude over the front alone, mirrored over the back, as MRASEL has it
    linear,      ///< a plane picture pushed through: stripes stay straight, narrower towards the poles
    octahedral,  ///< the sphere unfolded over an octahedron: no pole
};

/// How Filter::antialias averages a body's texture.
enum class TextureAverage {
    footprint,    ///< along the pixel's footprint: taps on one level of the pyramid
    trilinear,    ///< between the two levels next to the footprint's longer side (Williams 1983)
    summed_area,  ///< over the rectangle around the footprint, by a table of sums (Crow 1984)
    mrasel        ///< the nearest texel of the level that MRASEL takes
};

/// Finds the texture coordinates (u, v) of the point (x, y, z) of the unit sphere, for any number (number/number.h).
template <class T>
void texture_point(BodyMapping mapping, const T& x, const T& y, const T& z, T& u, T& v) {
    constexpr double pi = std::numbers::pi;
    const auto size = [](const T& a) { return select(is_negative(a), -a, a); };
    // asin(a) where a is a coordinate: by the other two, which loses nothing next to 1.
    const auto arcsine = [](const T& a, const T& b, const T& c) {
        return atan2(a, sqrt(square(b) + square(c)));
    };
    if (mapping == BodyMapping::octahedral) {
        const T sum = size(x) + size(y) + size(z), px = x / sum, py = y / sum;
        const T fold_x = T(1) - size(py), fold_y = T(1) - size(px);
        const auto behind = is_negative(-z);
        u = 0.5 + 0.5 * select(behind, select(is_negative(x), -fold_x, fold_x), px);
        v = 0.5 - 0.5 * select(behind, select(is_negative(y), -fold_y, fold_y), py);
        return;
    }
    v = 0.5 - arcsine(y, x, z) * (1 / pi);
    if (mapping == BodyMapping::latlong)
        u = 0.5 + atan2(x, -z) * (0.5 / pi);
    else if (mapping == BodyMapping::mirrored)
        // asin(x / cos(latitude)) without the division.
        u = 0.5 + atan2(x, size(z)) * (1 / pi);
    else
        u = 0.5 + arcsine(x, y, z) * (1 / pi);
}

/// The texture coordinates (u, v) of a point of the unit sphere, in double.
inline glm::dvec2 texture_point(BodyMapping mapping, const glm::dvec3& p) {
    glm::dvec2 uv(0.0);
    texture_point(mapping, p.x, p.y, p.z, uv.x, uv.y);
    return uv;
}

}  // namespace anamorph::figure
