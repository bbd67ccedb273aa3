// SPDX-License-Identifier: Apache-2.0
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "anamorph/number/jets_lanes.cpp"
#include "anamorph/number/jets.h"

#include "hwy/foreach_target.h"  // must come before highway.h
#include "hwy/highway.h"

HWY_BEFORE_NAMESPACE();
namespace anamorph::simd {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

#include "anamorph/number/lanes.h"
// behind lanes.h
#include "anamorph/number/lane_interval.h"

// The recurrences once more, for this instruction set.
#if defined(__OPTIMIZE__) && !defined(ANAMORPH_SANITIZED)
#define ANAMORPH_UNROLLED HWY_ATTR __attribute__((always_inline))
#else
#define ANAMORPH_UNROLLED HWY_ATTR
#endif
template <class T>
struct ToldDegree {
    int degree = 99;  // none is that high: not told
};
// The number of steps of recurrences, a constant where they are unrolled. Those of intervals would take
// minutes to compile, and are hardly faster unrolled; with sanitizers so would all. The scalar set is for x86
// processors without SSE4, and measured no slower without.
#if defined(ANAMORPH_SANITIZED) || HWY_TARGET == HWY_SCALAR
template <class T, int N>
constexpr int kJetSteps = N;
#else
template <class T, int N>
constexpr std::integral_constant<int, N> kJetSteps{};
template <class Tag, int N>
constexpr int kJetSteps<LaneInterval<Tag>, N> = N;
#endif
#include "anamorph/number/jet_series.h"
#undef ANAMORPH_UNROLLED

using D = hn::CappedTag<double, kJets>;

/// What stands for T in vectors.
template <class T>
using InLanes = std::conditional_t<std::is_same_v<T, double>, Lanes<D>, LaneInterval<D>>;

HWY_INLINE Lanes<D> LoadFour(const Four<double>& a, int lane) {
    return Lanes<D>::load(a.v + lane);
}
HWY_INLINE LaneInterval<D> LoadFour(const Four<Interval>& a, int lane) {
    return {Lanes<D>::load(a.lo + lane), Lanes<D>::load(a.hi + lane)};
}
HWY_INLINE void StoreFour(const Lanes<D>& a, int lane, Four<double>& to) {
    a.store(to.v + lane);
}
HWY_INLINE void StoreFour(const LaneInterval<D>& a, int lane, Four<Interval>& to) {
    a.lo.store(to.lo + lane);
    a.hi.store(to.hi + lane);
}

template <class T, int N>
HWY_INLINE Jet<InLanes<T>, N> LoadJet(const Jets<T, N>& a, int lane) {
    Jet<InLanes<T>, N> jet;
    jet.degree = a.degree;
    const int terms = a.terms();
    for (int k = 0; k < terms; ++k) jet.c[k] = LoadFour(a.c[k], lane);
    const InLanes<T> zero(0);
    for (int k = terms; k < a.kSize; ++k) jet.c[k] = zero;
    return jet;
}
/// `to` has its degree.
template <class T, int N>
HWY_INLINE void StoreJet(const Jet<InLanes<T>, N>& jet, int lane, Jets<T, N>& to) {
    for (int k = 0; k < to.terms(); ++k) StoreFour(jet.c[k], lane, to.c[k]);
}

/// function(lane) for the first of each vector's lanes.
#define ANAMORPH_EACH_LANE for (int lane = 0; lane < kJets; lane += Lanes<D>::kCount)

template <class T, int N>
void MultiplyJets(const Jets<T, N>& a, const Jets<T, N>& b, Jets<T, N>& r) {
    r.degree = std::min(N, a.degree + b.degree);
    ANAMORPH_EACH_LANE StoreJet(LoadJet(a, lane) * LoadJet(b, lane), lane, r);
}
void ScaleBoundJets(const BoundJets& a, double k, BoundJets& r) {
    r.degree = a.degree;
    const int terms = a.terms();
    ANAMORPH_EACH_LANE
    for (int i = 0; i < terms; ++i) StoreFour(LoadFour(a.c[i], lane) * k, lane, r.c[i]);
}
template <class T, int N>
void SquareJets(const Jets<T, N>& a, Jets<T, N>& r) {
    r.degree = std::min(N, 2 * a.degree);
    ANAMORPH_EACH_LANE StoreJet(square(LoadJet(a, lane)), lane, r);
}
template <class T, int N>
void DivideJets(const Jets<T, N>& a, const Jets<T, N>& b, Jets<T, N>& r) {
    r.degree = b.degree > 0 ? N : a.degree;
    ANAMORPH_EACH_LANE StoreJet(LoadJet(a, lane) / LoadJet(b, lane), lane, r);
}
template <class T, int N>
void RootOfJets(const Jets<T, N>& a, Jets<T, N>& r) {
    r.degree = a.degree > 0 ? N : 0;
    ANAMORPH_EACH_LANE StoreJet(sqrt(LoadJet(a, lane)), lane, r);
}
template <class T, int N>
void SineCosineOfJets(const Jets<T, N>& a, Jets<T, N>& s, Jets<T, N>& c) {
    s.degree = c.degree = a.degree > 0 ? N : 0;
    ANAMORPH_EACH_LANE {
        Jet<InLanes<T>, N> sine, cosine;
        sin_cos(LoadJet(a, lane), sine, cosine);
        StoreJet(sine, lane, s);
        StoreJet(cosine, lane, c);
    }
}
template <class T, int N>
void AngleOfJets(const Jets<T, N>& y, const Jets<T, N>& x, Jets<T, N>& r) {
    r.degree = x.degree > 0 || y.degree > 0 ? N : 0;
    ANAMORPH_EACH_LANE StoreJet(atan2(LoadJet(y, lane), LoadJet(x, lane)), lane, r);
}
template <class T, int N>
void PowerOfEJets(const Jets<T, N>& a, Jets<T, N>& r) {
    r.degree = a.degree > 0 ? N : 0;
    ANAMORPH_EACH_LANE StoreJet(exp(LoadJet(a, lane)), lane, r);
}
template <class T, int N>
void LogarithmOfJets(const Jets<T, N>& a, Jets<T, N>& r) {
    r.degree = a.degree > 0 ? N : 0;
    ANAMORPH_EACH_LANE StoreJet(log(LoadJet(a, lane)), lane, r);
}
template <class T, int N>
void AreaSineOfJets(const Jets<T, N>& a, Jets<T, N>& r) {
    r.degree = a.degree > 0 ? N : 0;
    ANAMORPH_EACH_LANE StoreJet(asinh(LoadJet(a, lane)), lane, r);
}
template <class T, int N>
void HyperbolicSineOfJets(const Jets<T, N>& a, Jets<T, N>& sine, Jets<T, N>& one) {
    sine.degree = a.degree > 0 ? N : 0;
    one.degree = 0;
    ANAMORPH_EACH_LANE {
        Jet<InLanes<T>, N> s;
        const InLanes<T> scale = scaled_sinh(LoadJet(a, lane), s);
        StoreJet(s, lane, sine);
        StoreFour(scale, lane, one.c[0]);
    }
}

template <class T, int N>
void ComposeJets(const Four<T>* c, const Jets<T, N>& f, Jets<T, N>& r) {
    r.degree = f.degree > 0 ? N : 0;
    ANAMORPH_EACH_LANE {
        InLanes<T> of[N + 1];
        for (int k = 0; k <= N; ++k) of[k] = LoadFour(c[k], lane);
        StoreJet(compose(of, LoadJet(f, lane)), lane, r);
    }
}

void ComposeTaylorJets(const Four<double>* c, const TaylorJets& f, TaylorJets& r) {
    ComposeJets(c, f, r);
}
void ComposeBoundJets(const Four<Interval>* c, const BoundJets& f, BoundJets& r) {
    ComposeJets(c, f, r);
}
#define ANAMORPH_JETS(J)                                  \
    void Multiply##J(const J& a, const J& b, J& r) {      \
        MultiplyJets(a, b, r);                            \
    }                                                     \
    void Square##J(const J& a, J& r) {                    \
        SquareJets(a, r);                                 \
    }                                                     \
    void Divide##J(const J& a, const J& b, J& r) {        \
        DivideJets(a, b, r);                              \
    }                                                     \
    void RootOf##J(const J& a, J& r) {                    \
        RootOfJets(a, r);                                 \
    }                                                     \
    void SineCosine##J(const J& a, J& s, J& c) {          \
        SineCosineOfJets(a, s, c);                        \
    }                                                     \
    void AngleOf##J(const J& y, const J& x, J& r) {       \
        AngleOfJets(y, x, r);                             \
    }                                                     \
    void PowerOfE##J(const J& a, J& r) {                  \
        PowerOfEJets(a, r);                               \
    }                                                     \
    void LogarithmOf##J(const J& a, J& r) {               \
        LogarithmOfJets(a, r);                            \
    }                                                     \
    void AreaSine##J(const J& a, J& r) {                  \
        AreaSineOfJets(a, r);                             \
    }                                                     \
    void HyperbolicSine##J(const J& a, J& sine, J& one) { \
        HyperbolicSineOfJets(a, sine, one);               \
    }
ANAMORPH_JETS(TaylorJets)
ANAMORPH_JETS(BoundJets)
#undef ANAMORPH_JETS

}  // namespace HWY_NAMESPACE
}  // namespace anamorph::simd
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace anamorph::simd {

#define ANAMORPH_UNARY(J, name, Name)        \
    HWY_EXPORT(Name##J);                     \
    void name(const J& a, J& r) {            \
        HWY_DYNAMIC_DISPATCH(Name##J)(a, r); \
    }
#define ANAMORPH_BINARY(J, name, Name)          \
    HWY_EXPORT(Name##J);                        \
    void name(const J& a, const J& b, J& r) {   \
        HWY_DYNAMIC_DISPATCH(Name##J)(a, b, r); \
    }
#define ANAMORPH_PAIR(J, name, Name)            \
    HWY_EXPORT(Name##J);                        \
    void name(const J& a, J& r, J& s) {         \
        HWY_DYNAMIC_DISPATCH(Name##J)(a, r, s); \
    }
#define ANAMORPH_JETS(J)                         \
    ANAMORPH_BINARY(J, multiply, Multiply)       \
    ANAMORPH_UNARY(J, square_of, Square)         \
    ANAMORPH_BINARY(J, divide, Divide)           \
    ANAMORPH_UNARY(J, root_of, RootOf)           \
    ANAMORPH_PAIR(J, sine_cosine, SineCosine)    \
    ANAMORPH_BINARY(J, angle_of, AngleOf)        \
    ANAMORPH_UNARY(J, power_of_e, PowerOfE)      \
    ANAMORPH_UNARY(J, logarithm_of, LogarithmOf) \
    ANAMORPH_UNARY(J, area_sine, AreaSine)       \
    ANAMORPH_PAIR(J, hyperbolic_sine, HyperbolicSine)

ANAMORPH_JETS(TaylorJets)
ANAMORPH_JETS(BoundJets)

HWY_EXPORT(ScaleBoundJets);
void scale(const BoundJets& a, double k, BoundJets& product) {
    HWY_DYNAMIC_DISPATCH(ScaleBoundJets)(a, k, product);
}

HWY_EXPORT(ComposeTaylorJets);
void compose_with(const Four<double>* c, const TaylorJets& f, TaylorJets& sum) {
    HWY_DYNAMIC_DISPATCH(ComposeTaylorJets)(c, f, sum);
}
HWY_EXPORT(ComposeBoundJets);
void compose_with(const Four<Interval>* c, const BoundJets& f, BoundJets& sum) {
    HWY_DYNAMIC_DISPATCH(ComposeBoundJets)(c, f, sum);
}

}  // namespace anamorph::simd
#endif
