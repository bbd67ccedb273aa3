// SPDX-License-Identifier: Apache-2.0
// Formulas that are written as text: from a point of a picture to one of its source, or to one in space; and how far a point of
// a surface moves.
//
// Text. Numbers as in 12, .5 and 1e-3, which are the doubles next to them, and pi; + - * / with the usual order, % (as mod),
// ^ (a power, from right to left, before a minus sign); < <= > >= == !=, and, or, not make conditions, which
// if(condition, a, b) takes. Names of formulas of a picture:
//
//   x y                     the point: pixels of the picture, the middle of the first one at (.5, .5), y down
//   s t                     the same in parts of width and height, from 0 to 1
//   px py                   the same about the middle of the picture, in halves of its smaller side, y up
//   r a                     the same in polar coordinates: the length of (px, py), and its angle from -pi to pi,
//                           counterclockwise from the right
//   width height            of the picture
//   src_width src_height    of the source
//   frame                   a number that callers give
//
// (where a formula pushes, x, y, s, t, px, py, r and a are of the source, and u and v pixels of the picture)
//
// those of formulas of a surface:
//
//   u v                     the point of the picture that is laid on it: from 0 at the left to 1, from 0 at the bottom to 1
//   aspect                  width over height of that picture
//   frame                   as above
//
// those of displacements:
//
//   u v                     the parameters of a point of a surface, as its host has them
//   frame                   as above
//
// and those that definitions make before. Functions: sin cos tan asin acos atan(y) atan(y, x) atan2(y, x) sinh cosh tanh
// asinh exp log sqrt cbrt pow hypot abs sign min max mod floor ceil round clamp mix step smoothstep, as GLSL has them
// (mod(a, b) has the sign of b, round takes halves up, atan2(0, 0) is 0); angles in radians. Conditions compare exactly. cbrt, and
// a power whose exponent is no known whole number of at most 1024, are made of exp and log.
//
// Domain. A point has no source where a root or a logarithm of what is not positive, an asin or acos of what is not between -1
// and 1 (which are left out), cbrt(0), a power of what is not positive with such an exponent, or a quotient by 0 would be needed; an
// `if` needs what it chooses, `and` and `or` what they have not decided from the left.
#pragma once

#include <string>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/number/formula_program.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {

/// A map as users write it. Each expression is named in errors by the member that it stands in, or by the
/// name that it defines.
struct FormulaText {
    std::string u = "x", v = "y";  ///< source pixels; target pixels of what pushes
    /// Names with their expressions; `let` comes after them, and does not count where it defines the same
    /// name.
    std::vector<Assignment> definitions;
    std::string let;  ///< "name=expression;name=expression"
};

/// The values that names of a FormulaText stand for.
struct FormulaSetting {
    Size picture, source;
    double frame = 0;
    bool in_fractions =
        false;  ///< u and v are in parts of the source's width and height; of the picture's where it pushes
    bool pushes = false;  ///< the formula leads from the source to the picture
};

/// A FormulaText as programs.
struct PlaneFormula {
    FormulaProgram point;   ///< u and v, in source pixels; in target pixels where it pushes
    FormulaProgram domain;  ///< positive, twice, where they have values
    bool is_everywhere;     ///< the domain is the whole plane
};

/// Parses a map. Throws Error with the column, counted from 1, and what was expected there; and of a
/// definition that none of the other expressions uses.
PlaneFormula parse_formula(const FormulaText& text, const FormulaSetting& setting);

/// A surface in space, by default the flat picture as surface/shape/shape.h has it: x to the right, y up, z towards the viewer.
struct SurfaceText {
    std::string px = "(u-0.5)*aspect", py = "v-0.5", pz = "0";
    std::vector<Assignment> definitions;  ///< as in FormulaText
    std::string let;
};

/// The values that names of a SurfaceText stand for.
struct SurfaceSetting {
    double aspect = 1, frame = 0;
};

/// The text of a formula in space as programs: of a surface, of u and 1 - v; of a displacement, of u and v.
struct SpaceFormula {
    FormulaProgram point;   ///< x, y and z
    FormulaProgram domain;  ///< positive where there is a point, and so a surface or a ray
    bool is_everywhere;     ///< there is a point everywhere

    /// Do both compute the same?
    friend bool operator==(const SpaceFormula& a, const SpaceFormula& b);
};

/// Parses a surface. Throws as parse_formula() does.
SpaceFormula parse_surface(const SurfaceText& text, const SurfaceSetting& setting);

/// A view: the ray of a point of a picture, of any length, by default of a flat picture whose smaller side covers 90 degrees.
struct RayText {
    std::string x = "px", y = "py", z = "1";   ///< to the right, up and forward
    std::vector<Assignment> definitions = {};  ///< as in FormulaText
    std::string let = {};
};

/// Parses a view, whose names are those of a FormulaText: as programs of pixels, whose ray has y down, as all
/// rays have. Errors name the expressions ray_x, ray_y and ray_z. Throws as parse_formula() does.
SpaceFormula parse_rays(const RayText& text, const FormulaSetting& setting);

/// A view by its inverse: the place in the picture that a direction goes to, from the middle in halves of the
/// smaller side, by default in an equirectangular picture whose smaller side covers 180 degrees. Names of
/// directions:
///
///   lon lat                 longitude, to the right from straight ahead, and latitude, upwards, in radians
///
/// and, as in formulas of a picture, width, height, src_width, src_height and frame.
struct DirectionText {
    std::string x = "lon/(pi/2)", y = "lat/(pi/2)";  ///< to the right and up
    std::vector<Assignment> definitions = {};        ///< as in FormulaText
    std::string let = {};
};

/// Parses the inverse of a view: as programs of pixels of `globe`, an equirectangular picture, that give
/// pixels of the picture. Errors name the expressions point_x and point_y. Throws as parse_formula() does.
PlaneFormula parse_directions(const DirectionText& text, const FormulaSetting& setting, const Size& globe);

/// The distances that points move along each axis; an empty one is 0.
struct DisplacementText {
    std::string x, y, z;
    std::string let;  ///< as in FormulaText
};

/// Parses displacements: as programs of u and v. Errors name the expressions x, y and z. Throws as
/// parse_formula() does.
SpaceFormula parse_displacement(const DisplacementText& text, double frame);

}  // namespace anamorph
