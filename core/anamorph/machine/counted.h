// SPDX-License-Identifier: Apache-2.0
// A number that counts what is done with it (number/number.h).
#pragma once

#include "anamorph/number/number.h"

namespace anamorph::machine {

/// What a processor does for a formula.
struct OperationCounts {
    int products = 0;   ///< squares too
    int divisions = 0;  ///< what is divided by a number of the formula is one
    int functions = 0;  ///< roots, sines, cosines, exponentials and the like

    OperationCounts& operator+=(const OperationCounts& other) {
        products += other.products;
        divisions += other.divisions;
        functions += other.functions;
        return *this;
    }
    friend bool operator==(const OperationCounts&, const OperationCounts&) = default;
};

/// A number without a value: reading a formula with it adds to a count, that of the number the formula begins with. Both
/// sides of a choice are computed, as by a processor without branches.
class Counted {
  public:
    explicit Counted(OperationCounts& counts) : m_counts(&counts) {}
    /// A number of the formula: it counts for nothing by itself.
    Counted(double) {}
    Counted() = default;

    friend Counted operator+(const Counted& a, const Counted& b) { return either(a, b); }
    friend Counted operator-(const Counted& a, const Counted& b) { return either(a, b); }
    friend Counted operator*(const Counted& a, const Counted& b) { return product(either(a, b)); }
    friend Counted operator/(const Counted& a, const Counted& b) {
        const Counted result = either(a, b);
        if (result.m_counts) ++result.m_counts->divisions;
        return result;
    }
    friend Counted operator-(const Counted& a) { return a; }
    friend Counted square(const Counted& a) { return product(a); }
    friend Counted sqrt(const Counted& a) { return function(a); }
    friend Counted exp(const Counted& a) { return function(a); }
    friend Counted log(const Counted& a) { return function(a); }
    friend Counted asinh(const Counted& a) { return function(a); }
    friend Counted atan2(const Counted& a, const Counted& b) { return function(either(a, b)); }
    friend void sin_cos(const Counted& a, Counted& s, Counted& c) {
        s = function(a);
        c = function(a);
    }
    friend Counted min(const Counted& a, const Counted& b) { return either(a, b); }
    friend Counted max(const Counted& a, const Counted& b) { return either(a, b); }
    friend bool is_zero(const Counted&) { return false; }
    friend bool is_negative(const Counted&) { return false; }
    friend Counted select(bool, const Counted& a, const Counted& b) { return either(a, b); }
    friend Counted without_hair(const Counted& a) { return a; }
    friend Counted scaled_sinh(const Counted& a, Counted& s) {
        s = function(a);
        return function(a);
    }
    friend double enlarger(const Counted&, const Counted&) { return 1; }

  private:
    static Counted either(const Counted& a, const Counted& b) { return a.m_counts ? a : b; }
    static Counted product(const Counted& a) {
        if (a.m_counts) ++a.m_counts->products;
        return a;
    }
    static Counted function(const Counted& a) {
        if (a.m_counts) ++a.m_counts->functions;
        return a;
    }

    OperationCounts* m_counts = nullptr;
};
static_assert(FormulaNumber<Counted>);

}  // namespace anamorph::machine
