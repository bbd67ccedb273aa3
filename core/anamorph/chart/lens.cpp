// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chart/lens.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "anamorph/chart/lens_table.h"
#include "anamorph/error.h"
#include "anamorph/number/hypot.h"
#include "anamorph/number/portable.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

using lens_formula::Series;

// How far a lens reaches, in distances of the picture's farthest corner: in the observed and in the ideal picture.
constexpr double kObservedReach = 4, kIdealReach = 16;
// What OCamCalib's affine part and PanoTools' shear may be: sensors are next to square to their lenses.
constexpr double kLeastStretch = 0.1, kMostStretch = 10, kMostShear = 1, kLeastArea = 0.01;

struct KindOfLens {
    LensModel::Kind kind;
    std::string name;
    std::vector<std::string> values;
};
const std::vector<KindOfLens>& kinds() {
    using enum LensModel::Kind;
    static const std::vector<KindOfLens> all = {
        {none, "none", {}},
        {ptlens, "ptlens", {"a", "b", "c", "g", "t", "d", "e"}},
        {brown, "brown", {"k1", "k2", "k3", "k4", "k5", "k6", "p1", "p2", "s1", "s2", "s3", "s4", "d", "e"}},
        {three_de4, "3de4", {"k1", "k2", "d", "e"}},
        {kb4, "kb4", {"k1", "k2", "k3", "k4", "d", "e"}},
        {division, "division", {"k1", "k2", "d", "e"}},
        {poly, "poly", {"k0", "k1", "k2", "k3", "k4", "d", "e"}},
        {ocam, "ocam", {"a0", "a2", "a3", "a4", "affine_c", "affine_d", "affine_e", "d", "e"}}};
    return all;
}
const KindOfLens& kind_of(LensModel::Kind kind) {
    return kinds()[static_cast<std::size_t>(kind)];
}

/// What a value is that is not given.
double unsaid(const std::string& name) {
    return name == "affine_c" ? 1 : 0;
}

template <class List, class Name>
std::string listed(const List& list, const Name& name) {
    std::string text;
    for (const auto& item : list) text += (text.empty() ? "" : ", ") + std::string(name(item));
    return text;
}

/// sum |c_i| t^i
double magnitude_of(const Constant* c, int count, double t) {
    double sum = 0;
    for (int i = count - 1; i >= 0; --i) sum = sum * t + std::fabs(c[i].value());
    return sum;
}

/// What errors below the line are held against: the polynomial, or of a direction its length.
Interval below_the_line(const LensTerms& lens, const Interval& t) {
    const Interval sum = lens_formula::sum_of_powers(lens.under, lens.under_count, t);
    return lens.of_direction ? sqrt(square(sum) + (lens.in_radius ? square(t) : t)) : sum;
}

/// How much the radial part stretches the least, along the radius or across it, over all of these t; less than nothing
/// where a pole is near.
double least_stretch(const LensTerms& lens, const Interval& t) {
    using S = Series<Interval, 1>;
    const S at = S::variable(t);
    if (lens.under_count > 1 || lens.of_direction) {
        const Interval under = below_the_line(lens, t);
        if (!(under.lo > 0x1p-40 * magnitude_of(lens.under, lens.under_count, t.hi))) return -1;
    }
    const S stretch = lens_formula::stretch_at(lens, at);
    const Interval slope = stretch.c[0] + stretch.c[1] * t * (lens.in_radius ? 1.0 : 2.0);
    return stretch.c[0].lo > 0 && slope.lo > 0 ? std::min(stretch.c[0].lo, slope.lo) : -1;
}

/// How much the part that is not radial stretches the most, up to t: its slope is 2 (m.u) + 2 (u m^T + m u^T), and
/// 2 (a + 2 b r^2) u^T of a prism.
double most_tangential(const LensTerms& lens, double t) {
    const double r = std::sqrt(t), a = hypot(lens.ax, lens.ay), b = hypot(lens.bx, lens.by);
    return (6 * hypot(lens.mx, lens.my) * r + (2 * a + 4 * b * t) * r) * (1 + 8 * interval_detail::kUlp);
}

}  // namespace

const std::vector<std::string>& LensModel::names(Kind kind) {
    return kind_of(kind).values;
}

LensModel LensModel::parse(std::string_view text, const std::string& parameter) {
    const std::string whole(text);
    const std::string_view name = text.substr(0, text.find(':'));
    const auto kind =
        std::find_if(kinds().begin(), kinds().end(), [&](const auto& k) { return k.name == name; });
    if (kind == kinds().end())
        throw Error(parameter, whole,
                    "must begin with one of " + listed(kinds(), [](const auto& k) { return k.name; }));
    LensModel model{kind->kind, {}};
    for (const std::string& value : kind->values) model.values.push_back(unsaid(value));
    std::set<std::string_view> seen;
    for (std::size_t at = name.size(); at < text.size();) {
        // What stands before is a colon or a comma.
        const std::string_view part = text.substr(at + 1, text.find(',', at + 1) - (at + 1));
        at += 1 + part.size();
        const std::size_t equals = std::min(part.find('='), part.size());
        const std::string_view key = part.substr(0, equals);
        const auto found = std::find(kind->values.begin(), kind->values.end(), key);
        if (found == kind->values.end())
            throw Error(parameter, whole,
                        kind->values.empty() ? "none has no values"
                                             : kind->name + " must be followed by values of " +
                                                   listed(kind->values, [](const auto& v) { return v; }) +
                                                   ", as in " + kind->name + ":" + kind->values[0] + "=0.1");
        if (!seen.insert(key).second) throw Error(parameter, whole, std::string(key) + " must be given once");
        double& value = model.values[static_cast<std::size_t>(found - kind->values.begin())];
        const std::string_view number = part.substr(std::min(equals + 1, part.size()));
        const auto [end, error] = from_chars(number.data(), number.data() + number.size(), value);
        if (error != std::errc() || end != number.data() + number.size() ||
            !(std::fabs(value) <= LensModel::kMostValue))
            throw Error(parameter, whole,
                        std::string(key) + " must be a number from " + brief(-LensModel::kMostValue) +
                            " to " + brief(LensModel::kMostValue));
    }
    return model;
}

std::string LensModel::text() const {
    std::string text = kind_of(kind).name;
    char separator = ':';
    for (std::size_t i = 0; i < values.size(); ++i) {
        if (values[i] == unsaid(names(kind)[i])) continue;
        text += separator + names(kind)[i] + "=" + shortest(values[i]);
        separator = ',';
    }
    return text;
}

double LensModel::magnification() const {
    return kind == Kind::ptlens ? 1 - values[0] - values[1] - values[2]
           : kind == Kind::poly ? 1 + values[0]
                                : 1;
}
double Lens::magnification() const {
    if (!m_terms.of_direction) return m_model.magnification();
    const Constant(&shear)[4] = m_terms.shear;
    const double area =
        m_terms.sheared ? shear[0].value() * shear[3].value() - shear[1].value() * shear[2].value() : 1;
    return 2 * m_terms.under[0].value() / m_terms.over[0].value() * std::sqrt(area);
}

Lens::Lens(const LensModel& model, Lensed lensed, const std::string& projection, const Plane& plane,
           const std::string& parameter)
    : m_model(model) {
    using enum LensModel::Kind;
    if (lensed == Lensed::no)
        throw Error(parameter, model.text(), "must be none for " + projection + ", which has no lens");
    const auto belongs_to = [&](LensModel::Kind kind, Lensed picture, const char* name) {
        if (model.kind == kind && lensed != picture)
            throw Error(parameter, model.text(),
                        kind_of(kind).name + " must be of a " + name + " picture, not " + projection);
    };
    belongs_to(brown, Lensed::flat, "rectilinear");
    belongs_to(kb4, Lensed::equidistant, "fisheye");
    belongs_to(ocam, Lensed::stereographic, "stereographic");
    set_terms();
    set_shear(plane, parameter);
    const DoubleDouble smaller = min(plane.half_width, plane.half_height);
    const bool by_diagonal = model.kind == three_de4 || model.kind == division;
    const bool by_side = model.kind == ptlens || model.kind == poly;
    const DoubleDouble unit = by_side              ? smaller
                              : by_diagonal        ? hypot(plane.half_width, plane.half_height)
                              : model.kind == ocam ? plane.per_x
                                                   : 1;
    // Twice the tangent of half of the angle, in pixels.
    if (model.kind == ocam) m_terms.over[0] = Constant(2 / plane.per_x);
    set_centre(plane);
    const DoubleDouble d = m_terms.shift_x.precise(), e = m_terms.shift_y.precise();
    m_terms.unit = unit == 1 ? Constant(1, 0) : Constant(unit);
    m_terms.per_unit = unit == 1 ? Constant(1, 0) : Constant(1 / unit);
    m_terms.has_unit = unit != 1;
    const auto in_units = [&](DoubleDouble length) { return static_cast<double>(length / unit); };
    const double corner = in_units(farthest_corner(plane, d, e));
    const bool folds = set_ends(corner);
    // The circle in the picture's middle, about the lens's centre.
    const double asked = m_most_unshear * in_units(smaller + hypot(d, e));
    if (!(m_terms.observed_end >= asked * (1 - 1e-4))) {
        const auto pixels = [&](double length) {
            return brief(std::round(10 * length * static_cast<double>(unit / plane.per_x)) / 10);
        };
        throw Error(parameter, model.text(),
                    std::string(folds && !m_terms.tangential ? "folds" : "ends") + " at a radius of " +
                        pixels(m_terms.observed_end) + " pixels: must not within " + pixels(asked) +
                        ", the circle that the picture holds");
    }
    m_terms.table = std::make_shared<const LensTable>(m_terms, corner);
}

/// How far a picture's corners are from the centre of the lens, which is (d, e) from its middle, before they are sheared.
DoubleDouble Lens::farthest_corner(const Plane& plane, DoubleDouble d, DoubleDouble e) const {
    const DoubleDouble x = plane.half_width + fabs(d), y = plane.half_height + fabs(e);
    if (!m_terms.sheared) return hypot(x, y);
    DoubleDouble farthest = 0;
    for (const DoubleDouble across : {-plane.half_width - d, plane.half_width - d})
        for (const DoubleDouble down : {-plane.half_height - e, plane.half_height - e}) {
            const Point<DoubleDouble> corner =
                lens_formula::sheared(m_terms, Point<DoubleDouble>{across, down}, m_terms.unshear);
            farthest = max(farthest, hypot(corner.x, corner.y));
        }
    return farthest;
}

/// PanoTools shears about the picture's middle what it has shifted before.
void Lens::set_centre(const Plane& plane) {
    const std::vector<double>& v = m_model.values;
    const DoubleDouble d = v[v.size() - 2] * plane.per_x, e = v[v.size() - 1] * plane.per_y;
    const bool moves = m_terms.sheared && m_model.kind == LensModel::Kind::ptlens;
    const DoubleDouble across = moves ? e * m_terms.shear[1].precise() : 0,
                       down = moves ? d * m_terms.shear[2].precise() : 0;
    // Of either part what a Constant may be off, and what the entry is.
    const auto sum = [](DoubleDouble own, DoubleDouble other) {
        const auto size = static_cast<double>(fabs(own) + 4 * fabs(other));
        const double error = 32 * Rounded<DoubleDouble>::kUnit * size;
        // What cancels is known no better than that it is small.
        return Constant(own + other == 0 ? error * 0x1p-20 : own + other, 2 * error);
    };
    m_terms.shift_x = sum(d, across);
    m_terms.shift_y = sum(e, down);
    m_terms.shifted = m_terms.shift_x.value() != 0 || m_terms.shift_y.value() != 0;
}

/// The affine part of a model as the matrix (1 e; d c).
Lens::Affine Lens::affine_of(const Plane& plane) const {
    const std::vector<double>& v = m_model.values;
    if (m_model.kind == LensModel::Kind::ocam) return {v[4], v[5], v[6], true};
    // g pixels across at a distance of the picture's height, and t down at its width.
    if (m_model.kind == LensModel::Kind::ptlens)
        return {1, v[4] * plane.per_y / (2 * plane.half_width), v[3] * plane.per_x / (2 * plane.half_height),
                false};
    return {};
}

/// The matrix, its inverse, and their largest singular values.
void Lens::set_shear(const Plane& plane, const std::string& parameter) {
    const auto [c, d, e, is_exact] = affine_of(plane);
    const DoubleDouble area = c - d * e;
    if (!(c >= kLeastStretch && c <= kMostStretch && fabs(d) <= kMostShear && fabs(e) <= kMostShear &&
          area >= kLeastArea))
        throw Error(parameter, m_model.text(),
                    m_model.kind == LensModel::Kind::ocam
                        ? "affine_c must be from " + brief(kLeastStretch) + " to " + brief(kMostStretch) +
                              ", affine_d and affine_e from " + brief(-kMostShear) + " to " +
                              brief(kMostShear) + ", and affine_c - affine_d affine_e at least " +
                              brief(kLeastArea)
                        : "g must be at most the picture's height and t its width, and g t at most " +
                              brief(1 - kLeastArea) + " of their product");
    m_terms.sheared = c != 1 || d != 0 || e != 0;
    if (!m_terms.sheared) return;
    const DoubleDouble shear[4] = {1, e, d, c};
    const DoubleDouble unshear[4] = {c / area, -e / area, -d / area, 1 / area};
    // Two lengths of the plane, each off by what a Constant may be, and a few roundings.
    const double off = is_exact ? 0 : 80;
    // The area is off by two roundings of c + |d e|, and by what d and e are off; an entry over it by one more.
    const double area_off = static_cast<double>((c + fabs(d * e)) / area) * (2 + 2 * off);
    constexpr double kUnit = Rounded<DoubleDouble>::kUnit;
    double square = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        m_terms.shear[i] = Constant(shear[i], off * kUnit * static_cast<double>(fabs(shear[i])));
        const double size = static_cast<double>(fabs(unshear[i]));
        m_terms.unshear[i] = Constant(unshear[i], (area_off + off + 2) * (1 + 0x1p-20) * kUnit * size);
        square += m_terms.shear[i].value() * m_terms.shear[i].value();
    }
    // Of singular values a >= b, a^2 + b^2 is the sum of the squares and a b the determinant. Where they are next to equal a
    // difference of 2^-26 of them is lost, as it is squared.
    const double determinant = static_cast<double>(area);
    const double most =
        std::sqrt((square + std::sqrt(std::max(0.0, square * square - 4 * determinant * determinant))) / 2);
    m_most_shear = most * (1 + 0x1p-25);
    m_most_unshear = most / determinant * (1 + 0x1p-25);
}

void Lens::set_terms() {
    using enum LensModel::Kind;
    LensTerms& terms = m_terms;
    const std::vector<double>& v = m_model.values;
    const auto exact = [](double value) { return Constant(value, 0); };
    terms.over[0] = exact(1);
    terms.under[0] = exact(1);
    const auto powers = [&](Constant* c, std::size_t first, int count) {
        int used = 1;
        for (int i = 0; i < count; ++i) {
            const double k = v[first + static_cast<std::size_t>(i)];
            c[i + 1] = exact(k);
            if (k != 0) used = i + 2;
        }
        return used;
    };
    if (m_model.kind == ptlens) {
        const DoubleDouble a = v[0], b = v[1], c = v[2];
        terms.in_radius = true;
        // Three differences, each rounded, of no more than all of them together.
        const double largest = static_cast<double>(1 + fabs(a) + fabs(b) + fabs(c));
        terms.over[0] = Constant(1 - a - b - c, 3 * Rounded<DoubleDouble>::kUnit * largest);
        terms.over[1] = exact(v[2]);
        terms.over[2] = exact(v[1]);
        terms.over[3] = exact(v[0]);
        terms.over_count = v[0] != 0 ? 4 : v[1] != 0 ? 3 : v[2] != 0 ? 2 : 1;
        // Then only r^2 is needed, which is smooth at the centre.
        if (v[0] == 0 && v[2] == 0) {
            terms.in_radius = false;
            terms.over[1] = exact(v[1]);
            terms.over_count = v[1] != 0 ? 2 : 1;
        }
    } else if (m_model.kind == brown) {
        terms.over_count = powers(terms.over, 0, 3);
        terms.under_count = powers(terms.under, 3, 3);
        terms.mx = v[7];
        terms.my = v[6];
        terms.ax = v[8];
        terms.bx = v[9];
        terms.ay = v[10];
        terms.by = v[11];
        terms.prism = std::any_of(v.begin() + 8, v.begin() + 12, [](double s) { return s != 0; });
        terms.tangential = terms.mx != 0 || terms.my != 0 || terms.prism;
    } else if (m_model.kind == poly) {
        // A sum, rounded, of no more than both.
        const DoubleDouble k0 = v[0];
        terms.over[0] = Constant(1 + k0, Rounded<DoubleDouble>::kUnit * static_cast<double>(1 + fabs(k0)));
        // Then only r^2 is needed, which is smooth at the centre.
        terms.in_radius = v[1] != 0 || v[3] != 0;
        if (terms.in_radius) {
            terms.over_count = powers(terms.over, 1, 4);
        } else {
            terms.over[1] = exact(v[2]);
            terms.over[2] = exact(v[4]);
            terms.over_count = v[4] != 0 ? 3 : v[2] != 0 ? 2 : 1;
        }
    } else if (m_model.kind == ocam) {
        // The axis is in front: what is ahead in the middle is positive.
        const double sign = v[0] < 0 ? -1 : 1;
        terms.to_observed = false;
        terms.of_direction = true;
        terms.in_radius = v[2] != 0;
        const double powers_of_r[5] = {v[0], 0, v[1], v[2], v[3]};
        const int step = terms.in_radius ? 1 : 2;
        for (int i = 0; i < 5; i += step) {
            terms.under[i / step] = exact(sign * powers_of_r[i]);
            if (powers_of_r[i] != 0) terms.under_count = i / step + 1;
        }
    } else if (m_model.kind == division) {
        terms.to_observed = false;
        terms.under_count = powers(terms.under, 0, 2);
    } else {
        terms.to_observed = m_model.kind == kb4;
        terms.over_count = powers(terms.over, 0, m_model.kind == kb4 ? 4 : 2);
    }
}

bool Lens::set_ends(double corner) {
    LensTerms& terms = m_terms;
    const double farthest = corner * (terms.to_observed ? kIdealReach : kObservedReach);
    const double most = corner * (terms.to_observed ? kObservedReach : kIdealReach);
    const double last = terms.in_radius ? farthest : farthest * farthest;
    const double value_limit = terms.in_radius ? most : most * most;
    // From the centre in steps over which the radius certainly rises, larger ones after such and smaller ones before
    // others, down to where it folds. A tangential part may take up half of what all of the disc so far is stretched:
    // then each step of settled(), which undoes the radial part of a distance that the other changed, halves it.
    double at = 0, step = last / 64, least = HUGE_VAL;
    bool folds = false;
    while (at < last && step > last * 0x1p-48) {
        const Interval part(at, std::min(at + step, last));
        const double here = std::min(least, least_stretch(terms, part));
        folds = !(here > 2 * most_tangential(terms, part.hi));
        const bool goes_on = !folds && lens_formula::radial_at(terms, Interval(part.hi)).hi <= value_limit;
        step *= goes_on ? 2 : 0.5;
        if (!goes_on) continue;
        at = part.hi;
        least = here;
        terms.condition = std::max(terms.condition, condition_over(part));
    }
    terms.end = at;
    terms.value_end = std::max(0.0, lens_formula::radial_at(terms, Interval(at)).lo);
    // A hair less, so that rounding does not lead beyond the end.
    constexpr double kLess = 1 - 0x1p-40;
    const double argument = kLess * (terms.in_radius ? at : std::sqrt(at));
    double value = kLess * (terms.in_radius ? terms.value_end : std::sqrt(terms.value_end));
    // Wherever |u| is the end's, |F| is at least that less (3 |m| + |a| + |b| |u|^2) |u|^2.
    value -= (1 + 0x1p-40) * 3 * hypot(terms.mx, terms.my) * argument * argument;
    const double a = hypot(terms.ax, terms.ay), b = hypot(terms.bx, terms.by);
    value -= (1 + 0x1p-40) * (a + b * argument * argument) * argument * argument;
    terms.ideal_end = terms.to_observed ? argument : value;
    terms.observed_end = terms.to_observed ? value : argument;
    const double centre = terms.of_direction ? lens_formula::stretch_at(terms, 0.0) : terms.over[0].value();
    terms.slope = terms.in_radius ? 1 / centre : 1 / (centre * centre);
    return folds;
}

// Rounding of radial_at() in Real, with u its unit, N = sum |c_i| t^i, D the same below the line and d what is below the
// line. The constants over the line are off by 3 u and 1 u of N (1 - a - b - c of ptlens counts with 1 + |a| + |b| + |c|
// in N, and 1 + k0 of poly with 1 + |k0|; all others are exact in double), Horner's rule by 2 u for each of 4 degrees: 13 u N in all; below the line by
// 7 u D. Then S is off by (13 u N + S 7 u D) / d + u S, at most 14 u A with A = (N + S D) / d; t S by 15 u t A, and
// t S^2 by (2 * 14 + 2) u t A^2. With condition >= A / S or (A / S)^2 that is kOff; terms of second order are below 2 u
// as long as D / d is below 2^40.
//
// Of a direction, g below the line is off by 9 u D, D the sum of its magnitudes: its coefficients are exact. Its length n then is
// by 9 u D and 3 u n, and both together, |g| + n, by 18 u D + 4 u (|g| + n), of which n is a part; t^2 over them by 2 u more, and S by
// (18 D / n + 8) u S. With 2 D / n + 1 in place of A / S the rest holds as it stands.
//
// Where the iteration's bracket has come down to neighbours, 2 u t apart, their exact values differ by 2 u t times the
// slope, and the computed ones by 2 kOff more: within kResidual where the condition is at least t slope / 8 over the
// value.
double Lens::condition_over(const Interval& t) const {
    const LensTerms& terms = m_terms;
    const Series<Interval, 1> stretch = lens_formula::stretch_at(terms, Series<Interval, 1>::variable(t));
    double over = magnitude_of(terms.over, terms.over_count, t.hi);
    if (m_model.kind == LensModel::Kind::ptlens)
        over +=
            1 + std::fabs(m_model.values[0]) + std::fabs(m_model.values[1]) + std::fabs(m_model.values[2]);
    if (m_model.kind == LensModel::Kind::poly) over += 1 + std::fabs(m_model.values[0]);
    const Interval below = below_the_line(terms, t);
    const double under = magnitude_of(terms.under, terms.under_count, t.hi);
    const double ratio = terms.of_direction ? 2 * under / below.lo + 1
                                            : (over + stretch.c[0].hi * under) / below.lo / stretch.c[0].lo;
    const double steep = 1 + 2 * magnitude(stretch.c[1] * t / stretch.c[0]);
    return std::max(terms.in_radius ? ratio : ratio * ratio, steep / 8) * (1 + 0x1p-40);
}

namespace lens_detail {

Interval radial_root(const LensTerms& lens, const Interval& value) {
    if (!(value.lo <= value.hi)) return {0, lens.end};
    // Outwards from the root in double until the values there are certainly beyond.
    const auto beyond = [&](double of, double sign) {
        const double root = lens_formula::radial_root(lens, of);
        for (double off = 0x1p-47 * root + 0x1p-100 * lens.end;; off *= 4) {
            const double t = root + sign * off;
            if (!(t > 0)) return 0.0;
            if (!(t < lens.end)) return lens.end;
            const Interval at = lens_formula::radial_at(lens, Interval(t));
            if (sign < 0 ? at.hi <= of : at.lo >= of) return t;
        }
    };
    return {value.lo > 0 ? beyond(std::min(value.lo, lens.value_end), -1) : 0,
            value.hi < lens.value_end ? beyond(value.hi, 1) : lens.end};
}

double least_slope(const LensTerms& lens, const Interval& t) {
    return lens_formula::radial_at(lens, Series<Interval, 1>::variable(t)).c[1].lo;
}

namespace {

/// The coefficients about computed values that are off by `error` from those of an interval: their derivatives are the next
/// ones.
Series<Rounded<double>, ComputedSeries::kDegree> about_rounded(const ComputedSeries& series, double error) {
    Series<Rounded<double>, ComputedSeries::kDegree> rounded;
    for (int k = 0; k <= ComputedSeries::kDegree; ++k) {
        const double moved = (k + 1) * magnitude(series.exact.c[k + 1]) * error;
        rounded.c[k] = {series.exact.c[k], 0, (series.error[k] + moved) * rounded_detail::kUp};
    }
    return rounded;
}

}  // namespace

std::optional<Rounded<double>> shrink_by_table(const LensTerms& lens, const Rounded<double>& value) {
    using R = Rounded<double>;
    if (!lens.table) return {};
    // All that are computed are within.
    const Interval around = value.range + Interval(-value.error, value.error);
    const ComputedSeries series = computed_shrink(lens, {std::max(around.lo, 0.0), around.hi});
    if (!(series.error[0] < HUGE_VAL && magnitude(series.exact.c[1]) < HUGE_VAL)) return {};
    const Series<R, ComputedSeries::kDegree> rounded = about_rounded(series, value.error);
    if (!value.is_jet()) return R(shrink(lens, value.range), 0, rounded.c[0].error);
    if (!(rounded.c[ComputedSeries::kDegree].error < HUGE_VAL)) return {};
    return compose(rounded, R(Interval(0), value.radius, value.error));
}

}  // namespace lens_detail

LensCoefficients stretch_coefficients(const LensTerms& lens, const Interval& squared) {
    return lens.table->stretch(squared);
}
LensCoefficients shrink_coefficients(const LensTerms& lens, const Interval& squared) {
    return lens.table->shrink(squared);
}
ComputedSeries computed_shrink(const LensTerms& lens, const Interval& value) {
    return lens.table ? lens.table->computed_shrink(value) : ComputedSeries::unbounded();
}
double near_root(const LensTerms& lens, double value) {
    return lens.table ? lens.table->near_root(value) : value * lens.slope;
}

/// By the mean value theorem from what double computes in the middle, where the table knows by how much that is off.
Interval shrink(const LensTerms& lens, const Interval& value) {
    const Interval within{std::max(value.lo, 0.0), value.hi};
    const ComputedSeries series = computed_shrink(lens, within);
    if (series.error[0] < HUGE_VAL && magnitude(series.exact.c[1]) < HUGE_VAL) {
        const double middle = 0.5 * (within.lo + within.hi), there = lens_formula::shrink(lens, middle);
        const Interval moved = Interval(there) + Interval(-series.error[0], series.error[0]) +
                               series.exact.c[1] * (within - middle);
        return {std::max(moved.lo, series.exact.c[0].lo), std::min(moved.hi, series.exact.c[0].hi)};
    }
    return Interval(1) / lens_formula::stretch_at(lens, lens_detail::radial_root(lens, value));
}

/// Wherever the members' points are, a step from a point in the middle ends no farther from it than half of that; more
/// steps, with all of them, come nearer.
Point<Interval> settled(const LensTerms& lens, const Point<Interval>& v) {
    const auto middle = [](const Interval& a) { return 0.5 * a.lo + 0.5 * a.hi; };
    const Point<double> u = lens_formula::settled(lens, Point<double>{middle(v.x), middle(v.y)});
    const Point<Interval> next = lens_formula::nearer(lens, v, Point<Interval>{u.x, u.y});
    const double far = magnitude(next.x - u.x) + magnitude(next.y - u.y);
    if (!(far < HUGE_VAL)) return {Interval::all(), Interval::all()};
    Point<Interval> box{{u.x - 2.01 * far, u.x + 2.01 * far}, {u.y - 2.01 * far, u.y + 2.01 * far}};
    const auto common = [](const Interval& a, const Interval& b) {
        return Interval(std::max(a.lo, b.lo), std::min(a.hi, b.hi));
    };
    const auto size = [](const Point<Interval>& p) { return p.x.hi - p.x.lo + (p.y.hi - p.y.lo); };
    for (int i = 0; i < 6; ++i) {
        const Point<Interval> nearer = lens_formula::nearer(lens, v, box);
        const Point<Interval> smaller{common(box.x, nearer.x), common(box.y, nearer.y)};
        if (!(smaller.x.lo <= smaller.x.hi && smaller.y.lo <= smaller.y.hi)) break;
        const double before = size(box);
        box = smaller;
        // A step more would gain less still.
        if (!(size(box) < 0.75 * before)) break;
    }
    return box;
}

}  // namespace anamorph
