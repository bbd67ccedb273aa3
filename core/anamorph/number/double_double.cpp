// SPDX-License-Identifier: Apache-2.0
#include "anamorph/number/double_double.h"

#include <algorithm>

#include "anamorph/number/quarter_turns.h"

namespace anamorph {
namespace {

constexpr DoubleDouble kHalfTurn = DoubleDouble::pi();
/// What is left of half a turn, off by less than 2^-216.
constexpr double kRestOfHalfTurn[] = {-0x1.f1976b7ed8fbcp-109, 0x1.4cf98e804177dp-163};
constexpr DoubleDouble kLogOf2{0x1.62e42fefa39efp-1, 0x1.abc9e3b39803fp-56};

/// Does a result have a second part?
bool is_ordinary(double upper) {
    return std::isfinite(upper) && upper != 0;
}
/// a + b where |a| >= |b| (Dekker 1971).
DoubleDouble ordered_sum(double a, double b) {
    const double sum = a + b;
    return is_ordinary(sum) ? DoubleDouble(sum, b - (sum - a)) : DoubleDouble(sum);
}
/// a + b, whichever is larger (Knuth 1969).
DoubleDouble exact_sum(double a, double b) {
    const double sum = a + b, of_b = sum - a;
    return {sum, (a - (sum - of_b)) + (b - of_b)};
}
/// a b: what rounding left of a product is a double, but where it underflows.
DoubleDouble exact_product(double a, double b) {
    const double product = a * b;
    return {product, std::fma(a, b, -product)};
}
/// a times a power of two.
DoubleDouble scaled(const DoubleDouble& a, int exponent) {
    const double upper = std::ldexp(a.upper(), exponent);
    return is_ordinary(upper) ? DoubleDouble(upper, std::ldexp(a.lower(), exponent)) : DoubleDouble(upper);
}

/// 1 / n! of n from 2 to 28, off by less than 2^-106 of themselves.
constexpr int kLargestFactorial = 28;
constexpr DoubleDouble kInverseFactorials[] = {{0x1p-1, 0},
                                               {0x1.5555555555555p-3, 0x1.5555555555555p-57},
                                               {0x1.5555555555555p-5, 0x1.5555555555555p-59},
                                               {0x1.1111111111111p-7, 0x1.1111111111111p-63},
                                               {0x1.6c16c16c16c17p-10, -0x1.f49f49f49f49fp-65},
                                               {0x1.a01a01a01a01ap-13, 0x1.a01a01a01a01ap-73},
                                               {0x1.a01a01a01a01ap-16, 0x1.a01a01a01a01ap-76},
                                               {0x1.71de3a556c734p-19, -0x1.c154f8ddc6c00p-73},
                                               {0x1.27e4fb7789f5cp-22, 0x1.cbbc05b4fa99ap-76},
                                               {0x1.ae64567f544e4p-26, -0x1.c062e06d1f209p-80},
                                               {0x1.1eed8eff8d898p-29, -0x1.2aec959e14c06p-83},
                                               {0x1.6124613a86d09p-33, 0x1.f28e0cc748ebep-87},
                                               {0x1.93974a8c07c9dp-37, 0x1.05d6f8a2efd1fp-92},
                                               {0x1.ae7f3e733b81fp-41, 0x1.1d8656b0ee8cbp-97},
                                               {0x1.ae7f3e733b81fp-45, 0x1.1d8656b0ee8cbp-101},
                                               {0x1.952c77030ad4ap-49, 0x1.ac981465ddc6cp-103},
                                               {0x1.6827863b97d97p-53, 0x1.eec01221a8b0bp-107},
                                               {0x1.2f49b46814157p-57, 0x1.2650f61dbdcb4p-112},
                                               {0x1.e542ba4020225p-62, 0x1.ea72b4afe3c2fp-120},
                                               {0x1.71b8ef6dcf572p-66, -0x1.d043ae40c4647p-120},
                                               {0x1.0ce396db7f853p-70, -0x1.aebcdbd20331cp-124},
                                               {0x1.761b41316381ap-75, -0x1.3423c7d91404fp-130},
                                               {0x1.f2cf01972f578p-80, -0x1.9ada5fcc1ab14p-135},
                                               {0x1.3f3ccdd165fa9p-84, -0x1.58ddadf344487p-139},
                                               {0x1.88e85fc6a4e5ap-89, -0x1.71c37ebd16540p-143},
                                               {0x1.d1ab1c2dccea3p-94, 0x1.054d0c78aea14p-149},
                                               {0x1.0a18a2635085dp-98, 0x1.b9e2e28e1aa54p-153}};

/// x / first! + x^2 / (first + step)! + x^3 / (first + 2 step)! + ... up to 28!, of |x| <= .62 and first 2 or 3 with step 2, or
/// |x| <= .35 with step 1: what is left out is below 2^-108 of the sum. Of the terms behind (first + 14)!, which are below 2^-53 of it,
/// a double is enough.
DoubleDouble factorial_series(const DoubleDouble& x, int first, int step) {
    const auto inverse = [](int n) -> const DoubleDouble& { return kInverseFactorials[n - 2]; };
    int n = first + (kLargestFactorial - first) / step * step;
    double tail = 0;
    for (; n > first + 14; n -= step) tail = (tail + inverse(n).upper()) * x.upper();
    DoubleDouble sum = tail;
    for (; n >= first; n -= step) sum = (sum + inverse(n)) * x;
    return sum;
}

/// Sine and cosine of up to an eighth of a turn.
void small_sin_cos(const DoubleDouble& a, DoubleDouble& s, DoubleDouble& c) {
    const DoubleDouble less_square = -(a * a);
    s = a + a * factorial_series(less_square, 3, 2);
    c = 1 + factorial_series(less_square, 2, 2);
}

/// The hyperbolic sine of up to 1/2.
DoubleDouble small_sinh(const DoubleDouble& a) {
    return a + a * factorial_series(a * a, 3, 2);
}

/// log(1 + z) for |z| <= 1/2: 2 (s + s^3 / 3 + s^5 / 5 + ...) with s = z / (2 + z).
DoubleDouble small_log1p(const DoubleDouble& z) {
    const DoubleDouble s = z / (z + 2), square = s * s;
    // |s| <= 1/5: what is left out is below 25^-23 / 47 < 2^-112 of the sum, and the terms from s^25 on below 2^-60.
    double tail = 0;
    for (int n = 45; n > 23; n -= 2) tail = (tail + 1.0 / n) * square.upper();
    DoubleDouble sum = tail;
    for (int n = 23; n > 1; n -= 2) sum = (sum + DoubleDouble(1) / n) * square;
    return (s + s * sum) * 2;
}
/// log(1 + z) for z >= 0.
DoubleDouble log1p_of(const DoubleDouble& z) {
    return z < 0.5 ? small_log1p(z) : log(z + 1);
}

}  // namespace

DoubleDouble operator+(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble upper = exact_sum(a.m_upper, b.m_upper), lower = exact_sum(a.m_lower, b.m_lower);
    if (!is_ordinary(upper.m_upper)) {
        const double sum = upper.m_upper == 0 ? lower.m_upper : 0;
        return sum == 0 ? DoubleDouble(upper.m_upper) : DoubleDouble(sum, lower.m_lower);
    }
    const DoubleDouble sum = ordered_sum(upper.m_upper, upper.m_lower + lower.m_upper);
    return ordered_sum(sum.m_upper, sum.m_lower + lower.m_lower);
}

DoubleDouble operator*(const DoubleDouble& a, const DoubleDouble& b) {
    const DoubleDouble upper = exact_product(a.m_upper, b.m_upper);
    if (!is_ordinary(upper.m_upper)) return upper.m_upper;
    return ordered_sum(upper.m_upper, upper.m_lower + (a.m_upper * b.m_lower + a.m_lower * b.m_upper));
}

DoubleDouble operator/(const DoubleDouble& a, const DoubleDouble& b) {
    const double first = a.m_upper / b.m_upper;
    if (!is_ordinary(first) || std::isinf(b.m_upper)) return first;
    // What is left of a after a digit of 53 bits, thrice.
    DoubleDouble rest = a - b * first;
    if (!isfinite(rest)) return first;
    const double second = rest.m_upper / b.m_upper;
    rest -= b * second;
    return ordered_sum(first, second) + rest.m_upper / b.m_upper;
}

DoubleDouble floor(const DoubleDouble& a) {
    const double whole = std::floor(a.upper());
    return whole == a.upper() ? ordered_sum(whole, std::floor(a.lower())) : whole;
}

DoubleDouble sqrt(const DoubleDouble& a) {
    const double root = std::sqrt(a.upper());
    if (!is_ordinary(root)) return root;
    // Half of what is left of a, over the root (Newton).
    const DoubleDouble rest = a - exact_product(root, root);
    return ordered_sum(root, rest.upper() / (2 * root));
}

DoubleDouble hypot(const DoubleDouble& a, const DoubleDouble& b) {
    if (std::isinf(a.upper()) || std::isinf(b.upper())) return HUGE_VAL;
    const DoubleDouble more = max(fabs(a), fabs(b));
    if (!is_ordinary(more.upper())) return fabs(a) + fabs(b);
    const int exponent = std::ilogb(more.upper());
    const DoubleDouble x = scaled(a, -exponent), y = scaled(b, -exponent);
    return scaled(sqrt(x * x + y * y), exponent);
}

void sin_cos(const DoubleDouble& a, DoubleDouble& s, DoubleDouble& c) {
    const double upper = a.upper();
    if (!(std::fabs(upper) <= DoubleDouble::kLargestAngle)) {
        s = std::sin(upper), c = std::cos(upper);
        return;
    }
    if (upper == 0) {
        s = a, c = 1;
        return;
    }
    // Whole quarters of a turn are taken off, by four doubles of half a turn: each difference is as exact as sums are.
    const double quarters = std::round(upper / (kHalfTurn.upper() / 2)), halves = quarters / 2;
    DoubleDouble rest = a;
    for (const double part : {kHalfTurn.upper(), kHalfTurn.lower(), kRestOfHalfTurn[0], kRestOfHalfTurn[1]})
        rest -= exact_product(halves, part);
    small_sin_cos(rest, s, c);
    turn_by_quarters(static_cast<long long>(quarters), s, c);
}

DoubleDouble tan(const DoubleDouble& a) {
    DoubleDouble s, c;
    sin_cos(a, s, c);
    return s / c;
}

DoubleDouble asin(const DoubleDouble& a) {
    return atan2(a, sqrt((1 - a) * (1 + a)));
}

DoubleDouble acos(const DoubleDouble& a) {
    return atan2(sqrt((1 - a) * (1 + a)), a);
}

DoubleDouble atan2(const DoubleDouble& y, const DoubleDouble& x) {
    if (isnan(x) || isnan(y)) return NAN;
    const bool is_axis = is_zero(x) || is_zero(y) || !isfinite(x) || !isfinite(y);
    if (is_axis) {
        // Whole eighths of a turn, the odd ones between infinities.
        const auto unit = [](double a) {
            return static_cast<float>(a == 0 || std::isinf(a) ? a : std::copysign(1.0, a));
        };
        const double eighths =
            std::round(std::atan2(unit(y.upper()), unit(x.upper())) / (kHalfTurn.upper() / 4));
        return kHalfTurn * (eighths / 4);
    }
    const int exponent = -std::ilogb(std::max(std::fabs(y.upper()), std::fabs(x.upper())));
    const DoubleDouble across = scaled(x, exponent), down = scaled(y, exponent);
    // An angle of float, and the one that is left when that is turned back, of which the tangent t is below 2^-20: t - t^3 / 3 + t^5 / 5,
    // off by 2^-140. Of the corrections a double is enough.
    const double nearly = std::atan2(static_cast<float>(down.upper()), static_cast<float>(across.upper()));
    DoubleDouble s, c;
    sin_cos(nearly, s, c);
    const DoubleDouble tangent = (down * c - across * s) / (across * c + down * s);
    const double t = tangent.upper(), squared = t * t;
    const DoubleDouble angle = nearly + (tangent - t * squared * (1.0 / 3 - squared / 5));
    return is_zero(angle) ? DoubleDouble(std::copysign(0.0, y.upper())) : angle;
}

DoubleDouble exp(const DoubleDouble& a) {
    if (!(std::fabs(a.upper()) < 800)) return std::exp(a.upper());
    const double twos = std::round(a.upper() / kLogOf2.upper());
    const DoubleDouble rest = a - kLogOf2 * twos;
    const DoubleDouble sum = 1 + (rest + rest * factorial_series(rest, 2, 1));
    // Halves of the power, of which none overflows where their product does not.
    const int half = static_cast<int>(twos) / 2;
    return scaled(scaled(sum, half), static_cast<int>(twos) - half);
}

DoubleDouble pow(const DoubleDouble& a, double exponent) {
    return exp(log(a) * exponent);
}

DoubleDouble log(const DoubleDouble& a) {
    if (!(a.upper() > 0) || std::isinf(a.upper())) return std::log(a.upper());
    // The power of two that leaves 3/4 to 3/2; no a is too large for it.
    const int twos = std::ilogb(a.upper() * (2.0 / 3)) + 1;
    return kLogOf2 * twos + small_log1p(scaled(a, -twos) - 1);
}

DoubleDouble asinh(const DoubleDouble& a) {
    const DoubleDouble size = fabs(a);
    if (!is_ordinary(size.upper())) return a;
    // The square is lost beside 1, or 1 beside it.
    const DoubleDouble of_size =
        size > 0x1p60 ? log(size) + kLogOf2 : log1p_of(size + size * size / (1 + sqrt(size * size + 1)));
    return std::signbit(a.upper()) ? -of_size : of_size;
}

DoubleDouble scaled_sinh(const DoubleDouble& a, DoubleDouble& s) {
    const DoubleDouble size = fabs(a);
    DoubleDouble sech;
    if (size < 0.5) {
        const DoubleDouble sinh = small_sinh(a);
        sech = 1 / sqrt(sinh * sinh + 1);
        s = sinh * sech;
    } else {
        const DoubleDouble falling = exp(-size), square = falling * falling;
        sech = falling * 2 / (square + 1);
        s = (1 - square) / (square + 1);
        if (std::signbit(a.upper())) s = -s;
    }
    return max(sech, kLeastScale);
}

}  // namespace anamorph
