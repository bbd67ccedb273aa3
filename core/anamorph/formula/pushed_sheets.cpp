// SPDX-License-Identifier: Apache-2.0
#include "anamorph/formula/pushed_sheets.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/error.h"
#include "anamorph/number/hypot.h"

namespace anamorph {

namespace {

using pushed_detail::about, pushed_detail::common, pushed_detail::half_of, pushed_detail::middle_of;
using BoundJet = PushedFormula::BoundJet;

// Parts of a formula that jumps, or turns over nearly everywhere, need never end.
constexpr double kFoldSize = 1;
constexpr int kMostCuts = 80;
// A source that looks as if it took so many times the parts it may have is given up early. It may be hard in its first corner only.
constexpr double kForeseen = 4;
// For a pixel near a fold.
constexpr std::size_t kMostVisits = std::size_t{1} << 14;
// Sheets are looked at without their outermost this many source pixels, or this part of them, which count as their hair: so a jump
// along an edge of theirs is none. What jumps and is no wider than a sliver is left out.
constexpr double kGap = 0x1p-28, kGapShare = 0x1p-7, kSliver = 0x1p-27;
// The least size of a determinant over the square of its largest entry: below, its inverse is not computed.
constexpr double kRegular = 1e-13;
// Parts are cut where they bend, if Y f' - I is less than this, and they are at most so many times longer one way in the target.
constexpr double kLittle = 4, kThin = 16;
constexpr int kNarrowings = 12;
// Source points that lie less apart are in one row.
constexpr double kSameRow = 1e-6;
// Formulas whose values are farther apart than this (target pixels) at points that are this near to each other jump there.
constexpr double kJump = 1e-5, kNear = 0x1p-36;
// Where it jumps along a row or a column, parts become thin and stay long, but for some 60 about a place where two such lines cross.
// Along other lines they become small (source pixels) both ways, and so many are enough to tell.
constexpr double kSmall = 0x1p-8, kAsWide = 1.5;
constexpr int kMostTorn = 1 << 15;
// Chords by which a point in double becomes one in DoubleDouble: each leaves a quarter of its error of some 2^-40.
constexpr int kPreciseSteps = 16;
constexpr double kLongestChord = 1e-3;

const Bounds kNothing{HUGE_VAL, HUGE_VAL, -HUGE_VAL, -HUGE_VAL};

/// The largest slope of g(z) - z, where z runs from -1 to 1 over a box of half sizes hx and hy: of g' - I.
double slope_beyond(const Point<BoundJet>& g, double hx, double hy) {
    const auto entry = [](const Interval& c, double h, double one) {
        return magnitude(c * h - Interval(one));
    };
    return std::max(entry(g.x.c[1], hx, 1) + entry(g.x.c[2], hy, 0),
                    entry(g.y.c[1], hx, 0) + entry(g.y.c[2], hy, 1));
}

}  // namespace

/// The whole source.
class PushedSheets::Cell {
  public:
    /// Are small parts looked at for jumps?
    Cell(const PushedSheets& sheets, bool looks_for_jumps)
        : m_sheets(sheets), m_looks_for_jumps(looks_for_jumps) {}

    double width() const { return m_sheets.m_source.width; }
    double height() const { return m_sheets.m_source.height; }
    Point<double> source(double s, double t) const { return {s * width(), t * height()}; }
    SeenPart see(const Part& s, const Part& t, const Bounds& target) const {
        const double hx = s.half * width(), hy = t.half * height();
        const Interval x = within(s, width(), 0), y = within(t, height(), 0);
        SeenPart seen{kNothing, 0, std::nullopt, hx >= hy};
        const Point<DefinedInterval> range =
            m_sheets.m_formula.target_point(DefinedInterval(x), DefinedInterval(y));
        const auto meets = [&](const Point<Interval>& at) {
            return Bounds{at.x.lo, at.y.lo, at.x.hi, at.y.hi}.meets(target);
        };
        if (!meets({range.x, range.y})) return seen;
        const Interval inner_x = inner(s, width()), inner_y = inner(t, height());
        const Certainty defined = m_sheets.m_formula.is_defined(inner_x, inner_y);
        if (defined == Certainty::no) return seen;
        Point<Interval> at{range.x, range.y};
        const bool is_smooth = defined == Certainty::yes && look(s, t, inner_x, inner_y, at, seen);
        double size = 0.5 * std::max(at.x.hi - at.x.lo, at.y.hi - at.y.lo);
        const bool may_jump = m_looks_for_jumps && defined == Certainty::yes && !is_smooth;
        if (may_jump && size <= 0.5 * kFoldSize && jumps(s, t)) size = kFoldSize;
        const double longer = std::max(hx, hy), thinner = std::min(hx, hy);
        seen.is_torn = may_jump && size > 0.5 * kFoldSize && longer <= kSmall && longer <= kAsWide * thinner;
        if (!is_smooth && std::min(hx, hy) <= kSliver && !(size <= 0.5 * kFoldSize)) return seen;
        seen.bounds = {at.x.lo, at.y.lo, at.x.hi, at.y.hi};
        seen.size = size;
        if (!is_smooth) seen.cut_s = cuts_to_smooth_halves(s, t, seen.cut_s);
        return seen;
    }
    Sheet fold(const Part& s, const Part& t) const { return Sheet::of_fold(0, s, t, {}); }

  private:
    /// What rounding makes of a source point by its parameters, at most.
    double position_error() const { return 8 * 0x1p-53 * (width() + height()); }
    static Interval within(const Part& part, double length, double gap) {
        return {(part.middle - part.half) * length + gap, (part.middle + part.half) * length - gap};
    }
    static double gap_of(const Part& part, double length) {
        return std::min(kGap, kGapShare * part.half * length);
    }
    static Interval inner(const Part& part, double length) {
        return within(part, length, gap_of(part, length));
    }

    /// Does the formula jump between the corners of a part? Where it bends most is looked for by halving.
    bool jumps(const Part& s, const Part& t) const {
        const auto corner = [&](int i) {
            return source(s.middle + (i & 1 ? s.half : -s.half), t.middle + (i & 2 ? t.half : -t.half));
        };
        for (int i = 0; i < 4; ++i)
            for (int j = i + 1; j < 4; ++j)
                if (jumps_between(corner(i), corner(j))) return true;
        return false;
    }
    bool jumps_between(Point<double> from, Point<double> to) const {
        const auto f = [&](const Point<double>& p) { return m_sheets.m_formula.target_point(p.x, p.y); };
        Point<double> at_from = f(from), at_to = f(to);
        while (largest(to - from) > kNear) {
            const Point<double> middle = (from + to) * 0.5, at_middle = f(middle);
            const auto bend = [&](const Point<double>& a, const Point<double>& at_a) {
                return largest(f((a + middle) * 0.5) - (at_a + at_middle) * 0.5);
            };
            const bool is_first = bend(from, at_from) >= bend(to, at_to);
            (is_first ? to : from) = middle;
            (is_first ? at_to : at_from) = at_middle;
        }
        return largest(at_to - at_from) > kJump;
    }

    /// Which way would more halves of a part be smooth that jumps or has a crease? Not the way in which it is
    /// thin already.
    bool cuts_to_smooth_halves(const Part& s, const Part& t, bool otherwise) const {
        int smooth[2] = {};
        for (const bool cut_s : {false, true})
            each_half(s, t, cut_s, [&](const Part& a, const Part& b) {
                using J = Jet<Interval, 1>;
                const Interval x = inner(a, width()), y = inner(b, height());
                const Point<J> f =
                    m_sheets.m_formula.target_point(J::variable(x, 1, 0), J::variable(y, 0, 1));
                const double size =
                    magnitude(f.x.c[1]) + magnitude(f.x.c[2]) + magnitude(f.y.c[1]) + magnitude(f.y.c[2]);
                smooth[cut_s] +=
                    m_sheets.m_formula.is_defined(x, y) != Certainty::open && std::isfinite(size);
            });
        const bool cut_s = smooth[0] == smooth[1] ? otherwise : smooth[1] > smooth[0];
        return (cut_s ? s.half * width() : t.half * height()) > kGap ? cut_s : otherwise;
    }

    /// Where the formula has derivatives: bounds by them, and whether it is one to one. Else false.
    bool look(const Part& s, const Part& t, const Interval& x, const Interval& y, Point<Interval>& at,
              SeenPart& seen) const {
        const double hx = s.half * width(), hy = t.half * height();
        const Point<double> middle = source(s.middle, t.middle);
        const Matrix2 at_middle = m_sheets.m_formula.derivative(middle);
        const Matrix2 a{at_middle.a11 * hx, at_middle.a12 * hy, at_middle.a21 * hx, at_middle.a22 * hy},
            inverse = a.inverse();
        // The formula as it is, and Y f.
        const Point<Interval> box{x, y}, boxes[] = {box, box};
        const PlaneFrame frames[] = {{}, {{0, 0}, {1, 0, 0, 1}, inverse}};
        PushedFormula::Series series[2];
        m_sheets.m_formula.expand(boxes, frames, series);
        const Point<BoundJet>& f = series[0].over;
        const double reach_x = magnitude(f.x.c[1]) * hx + magnitude(f.x.c[2]) * hy,
                     reach_y = magnitude(f.y.c[1]) * hx + magnitude(f.y.c[2]) * hy;
        if (!std::isfinite(reach_x + reach_y)) return false;
        const auto along = [&](int k) { return std::max(magnitude(f.x.c[k]), magnitude(f.y.c[k])); };
        seen.cut_s = along(1) * hx >= along(2) * hy;
        double hair = std::max(Sheet::kHair, 2 * std::max(gap_of(s, width()) / hx, gap_of(t, height()) / hy));

        const Point<Rounded<double>> rounded =
            m_sheets.m_formula.target_point(Rounded<double>(x, 0, 0), Rounded<double>(y, 0, 0));
        // What rounding of the formula, or of the source point, makes of a target point.
        const auto rounding = [&](const BoundJet& j, double error) {
            return error + (magnitude(j.c[1]) + magnitude(j.c[2])) * position_error();
        };
        seen.is_point =
            reach_x <= rounding(f.x, rounded.x.error) && reach_y <= rounding(f.y, rounded.y.error);
        const double size = std::max(largest({a.a11, a.a12}), largest({a.a21, a.a22}));
        if (std::fabs(a.determinant()) > kRegular * size * size) {
            const auto slope_of = [&](const PushedFormula::Series& g) {
                return slope_beyond(g.over, hx, hy);
            };
            m_sheets.m_formula.narrow(
                box, frames[1], [&](const auto& g) { return slope_of(g) <= Sheet::kContraction; }, series[1]);
            const double slope = slope_of(series[1]);
            // Near a fold Y says little, and what it says may lead to parts that are ever thinner.
            const double in_s = along(1) * hx, in_t = along(2) * hy;
            if (slope < kLittle && std::max(in_s, in_t) <= kThin * std::min(in_s, in_t))
                seen.cut_s = bends_along_s(series[1].about, hx, hy);
            if (slope <= Sheet::kContraction) {
                const Sheet sheet =
                    sheet_of(s, t, std::max(rounded.x.error, rounded.y.error), hair, inverse, slope);
                if (sheet.hair <= Sheet::kMostHair) {
                    seen.sheet = sheet;
                    hair = sheet.hair;
                }
            }
        }
        // The hair around counts. Jets hold constants as doubles, which rounding counts.
        const auto narrow = [](Interval& to, const Interval& from, double more) {
            const Interval near = from + Interval(-more, more);
            if (std::isfinite(magnitude(near))) to = common(to, near);
        };
        narrow(at.x, f.x.c[0], rounded.x.error + 2 * hair * reach_x);
        narrow(at.y, f.y.c[0], rounded.y.error + 2 * hair * reach_y);
        return true;
    }

    /// Is N's slope smaller in halves of s than in those of t? By its second derivatives: in a half, terms are smaller by a half for each
    /// of its parameter's powers, and that parameter counts twice.
    static bool bends_along_s(const Point<BoundJet>& g, double hx, double hy) {
        double in_s = 0, in_t = 0;
        for (const bool second : {false, true}) {
            const BoundJet& row = second ? g.y : g.x;
            const double ss = magnitude(row.c[3]) * hx * hx, st = magnitude(row.c[4]) * hx * hy,
                         tt = magnitude(row.c[5]) * hy * hy;
            in_s = std::max(in_s, (second ? 1 : 2) * (ss / 4 + st / 2 + tt));
            in_t = std::max(in_t, (second ? 2 : 1) * (ss + st / 2 + tt / 4));
        }
        return in_s <= in_t;
    }

    Sheet sheet_of(const Part& s, const Part& t, double rounding, double hair, const Matrix2& inverse,
                   double slope) const {
        // Of z: the parameters s and t round, and the map in double errs; the iteration is a contraction.
        const double noise = (inverse.norm() * rounding + 0x1p-51 * (1 + 1 / std::min(s.half, t.half))) /
                             (1 - Sheet::kContraction);
        const double diameter = 2 * hypot(s.half * width(), t.half * height());
        Sheet sheet = fold(s, t);
        sheet.fold = false;
        const Point<double> middle = source(s.middle, t.middle);
        sheet.at = m_sheets.m_formula.target_point(middle.x, middle.y);
        sheet.to_parameters = inverse;
        sheet.hair = std::max(hair, 4 * noise);
        // N's slope from its value in the middle.
        sheet.reach = slope + 2 * sheet.hair;
        sheet.noise = noise;
        // The stop at a step of `noise`, and the rounding of the position.
        sheet.error = diameter * 1.5 * noise + position_error();
        sheet.edge = diameter * 2 * sheet.hair;
        return sheet;
    }

    const PushedSheets& m_sheets;
    bool m_looks_for_jumps;
};

std::string PushedSheets::pixel_name(const Point<double>& source) {
    return "source pixel " + std::to_string(std::lround(source.x)) + "," +
           std::to_string(std::lround(source.y));
}

PushedSheets::PushedSheets(PushedFormula formula, const Box& target, const Size& source,
                           std::size_t most_parts, NamePlace name_place)
    : m_formula(std::move(formula)),
      m_source(source),
      m_most_visits(static_cast<int>(std::min(most_parts, kMostVisits))) {
    const Cell whole(*this, true);
    SheetCutter cutter(
        {double(target.x0), double(target.y0), double(target.x1), double(target.y1)},
        {kFoldSize, kMostCuts, most_parts, kMostTorn, kForeseen * static_cast<double>(most_parts)});
    if (!cutter.cut(whole)) {
        const std::string place =
            " near " + name_place(whole.source(cutter.stopped_at.x, cutter.stopped_at.y));
        throw Error(cutter.torn > kMostTorn
                        ? "the formula jumps, other than along a row or a column," + place +
                              ": must be continuous to be inverted"
                        : "the formula folds or ends at too many places to be inverted, as" + place);
    }
    // What is smaller than a pixel is a fold as well, but has an area: the determinant of its derivative.
    const auto area_of_fold = [&](const Sheet& sheet) {
        const Matrix2 d = m_formula.derivative(whole.source(sheet.s, sheet.t));
        const double size = std::max(largest({d.a11, d.a12}), largest({d.a21, d.a22}));
        return std::fabs(d.determinant()) > kRegular * size * size ? d.determinant() * sheet.hs * sheet.ht
                                                                   : 0;
    };
    const auto is_squeezed = [&](const Sheet& sheet) { return sheet.fold && area_of_fold(sheet) == 0; };
    if (!cutter.sheets.empty() && std::all_of(cutter.sheets.begin(), cutter.sheets.end(), is_squeezed))
        throw Error("the formula squeezes the source to a line or a point: must lead to an area");
    const bool has_sheets = std::any_of(cutter.sheets.begin(), cutter.sheets.end(),
                                        [](const Sheet& sheet) { return !sheet.fold; });
    double turned = 0, straight = 0;
    for (const Sheet& sheet : cutter.sheets) {
        if (sheet.fold && has_sheets) continue;
        const double area = sheet.fold ? area_of_fold(sheet) : 1 / sheet.to_parameters.determinant();
        (area < 0 ? turned : straight) += std::fabs(area);
    }
    m_mirrors = turned > straight;
    m_sheets = std::move(cutter.sheets);
    m_tree = BoundsTree(std::move(cutter.bounds));
}

PushedSheets::Cell PushedSheets::cell(int) const {
    return Cell(*this, false);
}

Point<double> PushedSheets::on_sheet(const Sheet& sheet, const Point<double>& z) const {
    return m_formula.target_point((sheet.s + sheet.hs * z.x) * m_source.width,
                                  (sheet.t + sheet.ht * z.y) * m_source.height);
}
/// On its outermost hair and beyond, where the formula may jump, by its slope in the middle: Y f still is a contraction away from z.
Point<double> PushedSheets::about_sheet(const Sheet& sheet, const Point<double>& z) const {
    const double end = 1 - 0.5 * sheet.hair;
    const Point<double> inner{std::clamp(z.x, -end, end), std::clamp(z.y, -end, end)};
    const Point<double> p = on_sheet(sheet, inner);
    if (inner.x == z.x && inner.y == z.y) return p;
    return p + sheet.to_parameters.inverse()(z - inner);
}

bool PushedSheets::find(const Sheet& sheet, double x, double y, Preimage& found) const {
    Point<double> z{};
    if (!sheet.find(
            x, y, [&](const Point<double>& at) { return about_sheet(sheet, at); }, z))
        return false;
    // There it is the formula that counts, unless it jumps.
    constexpr int kMostSteps = 40;
    double moved = largest(z) <= 1 - 0.5 * sheet.hair ? 0 : HUGE_VAL;
    for (int n = 0; n < kMostSteps && !(moved <= sheet.noise); ++n) {
        const Point<double> p = on_sheet(sheet, z), step = sheet.to_parameters(p.x - x, p.y - y);
        moved = largest(step);
        if (!(moved <= sheet.hair)) return false;
        z = z - step;
    }
    if (!(moved <= sheet.noise && largest(z) <= 1 + sheet.hair)) return false;
    found = {{(sheet.s + sheet.hs * z.x) * m_source.width, (sheet.t + sheet.ht * z.y) * m_source.height},
             0,
             (sheet.to_parameters.determinant() < 0) != m_mirrors,
             sheet.error,
             largest(z) >= 1 - 2 * sheet.hair ? sheet.edge : 0,
             sheet.to_source(m_source.width, m_source.height)};
    return true;
}

bool PushedSheets::before(const Preimage& a, const Preimage& b) const {
    if (a.turned != b.turned) return b.turned;
    // Rounding does not decide between rows.
    return std::fabs(a.at.y - b.at.y) > kSameRow ? a.at.y > b.at.y : a.at.x > b.at.x;
}

Preimages PushedSheets::preimages(double x, double y) const {
    PreimageSearch search(*this, x, y);
    m_tree.each({x, y, x, y}, [&](std::int32_t i) { search.look(m_sheets[static_cast<std::size_t>(i)]); });
    return search.result();
}

std::optional<double> PushedSheets::error(const Interval& x, const Interval& y) const {
    double error = 0;
    bool has_fold = false;
    m_tree.each({x.lo, y.lo, x.hi, y.hi}, [&](std::int32_t i) {
        const Sheet& sheet = m_sheets[static_cast<std::size_t>(i)];
        has_fold = has_fold || sheet.fold;
        error = std::max(error, sheet.error);
    });
    return has_fold ? std::nullopt : std::optional(error);
}

template <RealNumber Real>
bool PushedSheets::exact(const Real& x, const Real& y, Point<Real>& p) const {
    const Preimages all = preimages(static_cast<double>(x), static_cast<double>(y));
    if (all.count == 0) return false;
    p = {all.best.at.x, all.best.at.y};
    if constexpr (!std::is_same_v<Real, double>) {
        const Matrix2& inverse = all.best.inverse;
        for (int n = 0; n < kPreciseSteps; ++n) {
            const Point<Real> f = m_formula.target_point(p.x, p.y);
            const Real off_x = f.x - x, off_y = f.y - y;
            const Point<Real> step{inverse.a11 * off_x + inverse.a12 * off_y,
                                   inverse.a21 * off_x + inverse.a22 * off_y};
            // Beyond a jump.
            if (!(max(fabs(step.x), fabs(step.y)) <= kLongestChord)) break;
            p.x -= step.x;
            p.y -= step.y;
        }
    }
    return true;
}
template bool PushedSheets::exact(const double&, const double&, Point<double>&) const;
template bool PushedSheets::exact(const DoubleDouble&, const DoubleDouble&, Point<DoubleDouble>&) const;

/// On sheets, by their errors; on folds, pixel by pixel.
template <class Real>
double PushedSheets::exact_error(const Interval& x, const Interval& y) const {
    const std::optional<double> known = this->error(x, y);
    if (!known) {
        double error = 0;
        for (double row = y.lo; row <= y.hi; ++row)
            for (double column = x.lo; column <= x.hi; ++column)
                error = std::max(error, preimages(column, row).error);
        return error;
    }
    if constexpr (std::is_same_v<Real, double>)
        return *known;
    else
        return precise_error(x, y);
}
template double PushedSheets::exact_error<double>(const Interval&, const Interval&) const;
template double PushedSheets::exact_error<DoubleDouble>(const Interval&, const Interval&) const;

/// Bounds the error of chords in DoubleDouble from the point in double: each leaves kContraction of its error
/// in a sheet's parameters, and adds |Y| times what rounding makes of the formula there, and that of
/// positions.
double PushedSheets::precise_error(const Interval& x, const Interval& y) const {
    using R = Rounded<DoubleDouble>;
    const double size = double(m_source.width) + m_source.height;
    double most = 0;
    m_tree.each({x.lo, y.lo, x.hi, y.hi}, [&](std::int32_t i) {
        const Sheet& sheet = m_sheets[static_cast<std::size_t>(i)];
        const double w = sheet.hs * m_source.width, h = sheet.ht * m_source.height, thin = std::min(w, h);
        // Without the hair, where the formula may jump.
        const double end = 1 - 0.5 * sheet.hair;
        const Point<R> f = m_formula.target_point(R(about(sheet.s * m_source.width, w * end), 0, 0),
                                                  R(about(sheet.t * m_source.height, h * end), 0, 0));
        const double chord =
            sheet.to_parameters.norm() * std::max(f.x.error, f.y.error) + 8 * R::kUnit * size / thin;
        const double first = 1.5 * sheet.noise + 8 * 0x1p-53 * size / thin;
        const double off = chord / (1 - Sheet::kContraction) + std::ldexp(first, -2 * kPreciseSteps);
        most = std::max(most, 2.1 * hypot(w, h) * off);
    });
    // The point is kept in double.
    return most + 0x1p-53 * size;
}

std::optional<PushedSheets::Reached> PushedSheets::reached(const Interval& x, const Interval& y,
                                                           const PlaneFrame& frame) const {
    Reached all;
    bool has_fold = false;
    const Point<double> middle{middle_of(x), middle_of(y)};
    const Matrix2 to_frame = frame.to_source.inverse();
    m_tree.each({x.lo, y.lo, x.hi, y.hi}, [&](std::int32_t i) {
        const Sheet& sheet = m_sheets[static_cast<std::size_t>(i)];
        has_fold = has_fold || sheet.fold;
        if (has_fold) return;
        const auto f = [&](const Point<double>& z) { return about_sheet(sheet, z); };
        const auto near = sheet.narrowed(middle.x, middle.y, half_of(x), half_of(y), f, kNarrowings);
        if (!near) return;
        const auto& [s, t] = *near;
        const double w = sheet.hs * m_source.width, h = sheet.ht * m_source.height;
        const Point<double> at{sheet.s * m_source.width + w * s.middle,
                               sheet.t * m_source.height + h * t.middle};
        const Point<double> z = to_frame(at - frame.origin), span = to_frame.span(w * s.half, h * t.half);
        const auto put = [](Interval& to, double at_z, double half) {
            // The hairs of sheets are more than what rounding takes here.
            to.lo = std::min(to.lo, at_z - half);
            to.hi = std::max(to.hi, at_z + half);
        };
        put(all.z.x, z.x, span.x);
        put(all.z.y, z.y, span.y);
        all.halves = all.halves + span;
        all.largest_sheet = {std::max(all.largest_sheet.x, w), std::max(all.largest_sheet.y, h)};
    });
    if (has_fold) return std::nullopt;
    return all;
}

}  // namespace anamorph
