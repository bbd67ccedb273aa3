// SPDX-License-Identifier: Apache-2.0
#include "map_formulas.h"

#include "anamorph/parameter/parameter.h"

namespace anamorph::bench {
namespace {

constexpr Orientation kTurned{30, 20, 10};

/// A view of a sphere whose ray is (dx, dy, dz), y down, of any length.
SphereView sphere_view(int side, const Chart& target, const std::string& ray) {
    const Chart sphere(Projection::equirectangular, 4 * side, 2 * side, 360);
    const glm::dmat3 turn = rotation(kTurned);
    FormulaText text;
    text.let = ray;
    const char* const components[] = {"x", "y", "z"};
    for (int row = 0; row < 3; ++row) {
        text.let += std::string(";e") + components[row] + "=0";
        for (int column = 0; column < 3; ++column)
            text.let += "+(" + shortest(turn[column][row]) + ")*d" + components[column];
    }
    text.u = "src_width*(.5+atan2(ex,ez)/(2*pi))";
    text.v = "src_height*(.5+atan2(ey,hypot(ex,ez))/pi)";
    return {Panorama(sphere, target, kTurned), {sphere, text}};
}

Chart flat(int side) {
    return {Projection::rectilinear, side, side};
}

FormulaText swirl() {
    FormulaText text;
    text.let = "b=a-2*exp(-4*r^2)";
    text.u = "width/2*(1+r*cos(b))";
    text.v = "height/2*(1-r*sin(b))";
    return text;
}

}  // namespace

TextMap TextOf::map(int side) const {
    const Size picture{side, side}, pixels{source.width(), source.height()};
    return {parse_formula(text, {picture, pixels}), picture, picture, pixels};
}

SphereView straight_view(int side) {
    return sphere_view(side, Chart(Projection::rectilinear, side, side, 90), "dx=px;dy=-py;dz=1");
}
SphereView fisheye_view(int side) {
    return sphere_view(side, Chart(Projection::fisheye, side, side, 180),
                       "h=pi/2*r;dx=sin(h)*cos(a);dy=-sin(h)*sin(a);dz=cos(h)");
}

LensView lens_view(int side) {
    const Chart observed(Projection::rectilinear, side, side, 90, PixelSpacing::edges, "", 1,
                         LensModel::parse("brown:k1=-0.2,k2=0.05,k3=-0.004"));
    const Size size{side, side};
    FormulaText text;
    // The half picture spans 45 degrees: px and py are tangents.
    text.let = "q=px^2+py^2;k=1+q*(-.2+q*(.05-.004*q))";
    text.u = "width/2*(1+px*k)";
    text.v = "height/2*(1-py*k)";
    return {LensMap(observed, LensMode::undistort, size, size, size), {flat(side), text}};
}

TextOf swirl_view(int side) {
    return {flat(side), swirl()};
}
PushedMap pushed_swirl(int side) {
    const Size size{side, side};
    return {parse_formula(swirl(), {size, size, 0, false, true}), size, size, size};
}

}  // namespace anamorph::bench
