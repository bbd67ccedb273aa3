// SPDX-License-Identifier: Apache-2.0
// exp(-a) of vectors of doubles, for Gaussians: without the quotient that exp (number/lanes.h) has.
//
// Compiled for each instruction set: included after number/lanes.h, as that is.

/// exp(-a) for a >= 0, with an error of 2 in units of 2^-53 of the result; the same bits on all instruction
/// sets. 0 beyond 700, where the exponent would run out, and for NaN.
///
/// With -a = m log 2 + r, |r| <= log(2) / 2, it is 2^m (1 + r + r^2 q(r)), and m is added to the exponent. q, a
/// minimax polynomial of degree 9, errs by 0.16 units of 1 + r + ...; r by 0.25, of which at most 0.35 remain
/// of the result; the sum r + r^2 q by 0.25, the products in it by 0.2. The last sum errs by 1 where the
/// result is 1 or more, and there that makes 1.96; it errs by 0.5 below, where the others are to be divided by
/// 0.7 at least: (0.5 + 0.25 + 0.25 + 0.2 + 0.16) / 0.7 = 1.95.
template <class D>
HWY_INLINE Lanes<D> exp_of_minus(const Lanes<D>& a) {
    static_assert(sizeof(hn::TFromD<D>) == 8);
    using L = Lanes<D>;
    const hn::RebindToSigned<D> di;
    // q, split into even and odd powers: half as long a chain.
    constexpr double kEven[] = {0x1.0000000000001p-1, 0x1.5555555553d63p-5, 0x1.6c16c1788bd90p-10,
                                0x1.a019b90d2ae7ap-16, 0x1.289185613a3d6p-22};
    constexpr double kOdd[] = {0x1.5555555555556p-3, 0x1.11111111109b3p-7, 0x1.a01a01a7c41d5p-13,
                               0x1.71de0dae63bb3p-19, 0x1.af38a9b0ec855p-26};
    const L shifted = L(kIntegerShift<D>) - a * L(1.44269504088896338700);  // m in its last bits
    const L n = L(kIntegerShift<D>) - shifted;                              // -m
    const L r = (n * 6.93147180369123816490e-01 - a) + n * 1.90821492927058770002e-10, z = r * r;
    const L value = L(1) + (r + z * (polynomial(z, kEven) + r * polynomial(z, kOdd)));
    const auto bits = hn::Add(hn::BitCast(di, value.v), hn::ShiftLeft<52>(hn::BitCast(di, shifted.v)));
    return L(hn::IfThenElseZero(hn::Le(a.v, L(700).v), hn::BitCast(D(), bits)));
}
