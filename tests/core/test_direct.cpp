// SPDX-License-Identifier: Apache-2.0
// Blocks read pixel by pixel near their middles, in float or in double: the bases that are written down are the ones read, for
// every projection and lens; the same bits on every instruction set and for every part of a block.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "anamorph/chart/chart_formulas.h"
#include "anamorph/image/block_reader.h"
#include "anamorph/image/block_sampler.h"
#include "anamorph/panorama/direct_rows.h"
#include "anamorph/panorama/panorama_plan.h"
#include "panorama_oracle.h"
#include "projection_cases.h"

namespace anamorph {
namespace {

/// A base read from where it was written, one at a time: as the loops over a block's pixels have it (panorama/direct_rows_lanes.cpp).
struct Replayed {
    using Number = ReadingOrder::Number;
    static inline const double* next_value = nullptr;
    static inline ReadingOrder order;

    double value = 0;
    Number number = 0;

    Replayed() = default;
    Replayed(double k) : value(k) {}  // NOLINT: a number is a constant
    static Replayed next(BaseOperation operation, Number a, Number b = 0) {
        Replayed base(*next_value++);
        base.number = order.next(operation, a, b);
        return base;
    }
    friend Replayed operator-(const Replayed& a, const Replayed& b) {
        return next(BaseOperation::difference, a.number, b.number);
    }
    friend Replayed operator+(const Replayed& a, const Replayed& b) {
        return next(BaseOperation::sum, a.number, b.number);
    }
    friend Replayed operator*(const Replayed& a, const Replayed& b) {
        return next(BaseOperation::product, a.number, b.number);
    }
    friend Replayed operator/(const Replayed& a, const Replayed& b) {
        return next(BaseOperation::quotient, a.number, b.number);
    }
    friend Replayed sqrt(const Replayed& a) { return next(BaseOperation::root, a.number); }
};

}  // namespace

template <>
struct NearRest<Replayed, double> {
    static double of(const Replayed& base) { return base.value; }
    static double off(double rest, const Replayed&, double) { return rest; }
};

namespace {

/// The points of all direct blocks of a plan, in their order.
std::vector<double> direct_points(const PanoramaPlan& plan) {
    std::vector<double> points;
    BlockPlanes planes(1);
    PointsInDouble precise;
    const auto take = [&](const Block& block, const auto& at) {
        for (int j = 0; j < block.box.height(); ++j)
            for (const auto* row : {at.x, at.y})
                points.insert(points.end(), row + j * at.row_stride,
                              row + j * at.row_stride + block.box.width());
    };
    for (std::int64_t r = 0; r < plan.regions(); ++r)
        for (const Block& block : plan.blocks(r)) {
            if (block.kind != Block::Kind::computed) continue;
            if (block.precise) {
                precise.read(plan, block, 0, block.box.height());
                take(block, precise.points());
            } else {
                plan.computed({&block, 1}, planes.rows());
                take(block, planes.points(0));
            }
        }
    return points;
}

PanoramaPlan plan_of(const Panorama& map, double tol) {
    PlanOptions options;
    options.scheme = Scheme::direct;
    options.tol = tol;
    return {map, options};
}

void expect_same_bits(const Panorama& map, double tol) {
    std::vector<double> first;
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        SCOPED_TRACE(*set);
        ASSERT_TRUE(simd::use_instruction_set(*set));
        const std::vector<double> points = direct_points(plan_of(map, tol));
        if (first.empty()) first = points;
        ASSERT_EQ(points.size(), first.size());
        // Of two without a direct block there are no bits.
        if (points.empty()) continue;
        EXPECT_EQ(std::memcmp(points.data(), first.data(), points.size() * sizeof(double)), 0);
    }
    simd::use_instruction_set("");
}

template <class Real>
class Near : public testing::Test {};
using Reals = testing::Types<float, double>;
TYPED_TEST_SUITE(Near, Reals);

/// A number of this value, so much off its base.
template <class Real>
NearBound<Real> number_near(double at, double off) {
    return {WrittenBase(at), RestBound<Real>(off, 0, 0)};
}
/// Base and rest together.
template <class Real>
Interval whole_of(const NearBound<Real>& number) {
    return Interval(number.base.value) + Interval(number.rest.middle) +
           Interval(-number.rest.radius, number.rest.radius);
}

/// Room for bases that nobody reads.
class WrittenBases {
  public:
    WrittenBases() { WrittenBase::to = &m_writer; }
    ~WrittenBases() { WrittenBase::to = nullptr; }

    const Bases& bases() const { return m_bases; }
    ReadingOrder& order() { return m_writer.order; }

  private:
    Bases m_bases;
    BaseWriter m_writer{m_bases, {}};
};

/// Is base and rest together the value, and its rounding bounded?
template <class Real>
void expect_encloses(const NearBound<Real>& found, double value, const std::string& words) {
    const Interval whole = whole_of(found);
    EXPECT_LE(whole.lo, value + 1e-12) << words;
    EXPECT_GE(whole.hi, value - 1e-12) << words;
    EXPECT_LT(whole.hi - whole.lo, 1e-9) << words;
    const double most = std::is_same_v<Real, float> ? 1e-6 : 1e-12;
    EXPECT_LT(found.rest.error, most) << words;
}

TYPED_TEST(Near, AnAngleMayTurnByUpToHalfATurn) {
    using Number = NearBound<TypeParam>;
    const WrittenBases bases;
    const double error = std::is_same_v<TypeParam, float> ? 1e-5 : 1e-14;
    constexpr unsigned kSeed = 406;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> turn(-std::numbers::pi, std::numbers::pi), length(0.1, 10);
    for (int i = 0; i < 1000; ++i) {
        const double from = turn(random), by = 0.98 * turn(random), near = length(random),
                     far = length(random);
        const double x = near * std::cos(from), y = near * std::sin(from);
        const double to_x = far * std::cos(from + by), to_y = far * std::sin(from + by);
        const Number angle = atan2(Number{WrittenBase(y), RestBound<TypeParam>(to_y - y, 0, error)},
                                   Number{WrittenBase(x), RestBound<TypeParam>(to_x - x, 0, error)});
        const Interval whole = whole_of(angle);
        EXPECT_LE(whole.lo, from + by + 1e-12);
        EXPECT_GE(whole.hi, from + by - 1e-12);
        EXPECT_LT(whole.hi - whole.lo, 1e-9);
        // A point that is off by so much is seen from the centre within the quotient, and rounding adds its own.
        EXPECT_GE(angle.rest.error, error / far);
        EXPECT_LT(angle.rest.error, 100 * error);
    }
}

TYPED_TEST(Near, AnAngleAcrossHalfATurnIsUnbounded) {
    using Number = NearBound<TypeParam>;
    using Rest = RestBound<TypeParam>;
    const WrittenBases bases;
    const Number ahead{WrittenBase(1), Rest(-2, 0.5, 0)};
    EXPECT_FALSE(atan2(Number{WrittenBase(0), Rest(0, 0.1, 0)}, ahead).rest.error < 1);
    // The exact ones lie on one side, and what is computed may not.
    EXPECT_FALSE(atan2(Number{WrittenBase(0), Rest(0.2, 0.1, 0.11)}, ahead).rest.error < 1);
    EXPECT_TRUE(atan2(Number{WrittenBase(0), Rest(0.2, 0.1, 0)}, ahead).rest.error < 1);
    // The centre itself.
    EXPECT_FALSE(
        atan2(Number{WrittenBase(0), Rest(0, 1, 0)}, Number{WrittenBase(1), Rest(0, 1, 0)}).rest.error < 1);
}

TYPED_TEST(Near, ATiltIsTheAngleWhateverItIsCountedFrom) {
    const WrittenBases bases;
    constexpr unsigned kSeed = 409;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 1000; ++i) {
        const double from = std::numbers::pi * uniform(random), length = 0.5 + uniform(random);
        const double across = length * std::sin(from), ahead = length * std::cos(from);
        const double to_across = across + 0.1 * uniform(random),
                     to_ahead = ahead + 0.1 * uniform(random) - 0.05;
        const double counted_from = from + 0.2 * uniform(random) - 0.1;
        const Heading along(std::sin(counted_from), std::cos(counted_from));
        const auto found = tilt(number_near<TypeParam>(across, to_across - across),
                                number_near<TypeParam>(ahead, to_ahead - ahead), along);
        expect_encloses(found, std::atan2(to_across, to_ahead), "");
    }
}

TYPED_TEST(Near, SinesOverAnglesAreBoundedFromTheAxisToHalfATurn) {
    using Number = NearBound<TypeParam>;
    const WrittenBases bases;
    constexpr unsigned kSeed = 407;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 3000; ++i) {
        const double at = i % 10 == 0 ? 0 : 9.8 * uniform(random);
        const double off = std::max(-at, uniform(random) - 0.5), near_by = std::fabs(off) / (i % 3 + 1);
        for (const double d : {off, near_by}) {
            Number sinc, cosine;
            sinc_cos(number_near<TypeParam>(at, d), sinc, cosine);
            const long double t = std::sqrt(static_cast<long double>(at) + d);
            const auto expect = [&](const Number& found, long double value) {
                const Interval whole = whole_of(found);
                // What is left out of the series is part of the bound, and of the width.
                const double left_out =
                    std::is_same_v<TypeParam, float> ? 1e-6 * std::pow(std::fabs(d), 5) : 0;
                EXPECT_LE(whole.lo, static_cast<double>(value)) << at << " " << d;
                EXPECT_GE(whole.hi, static_cast<double>(value)) << at << " " << d;
                EXPECT_LT(whole.hi - whole.lo, 2 * left_out + 1e-13) << at << " " << d;
                EXPECT_LT(found.rest.error, left_out + (std::is_same_v<TypeParam, float> ? 1e-6 : 1e-14));
            };
            expect(sinc, t == 0 ? 1 : std::sin(t) / t);
            expect(cosine, std::cos(t));
        }
    }
    // Beyond half a turn there is none.
    Number sinc, cosine;
    sinc_cos(number_near<TypeParam>(11, 0), sinc, cosine);
    EXPECT_FALSE(sinc.rest.error < 1);
    EXPECT_FALSE(cosine.rest.error < 1);
}

TYPED_TEST(Near, LengthsAreBoundedWhereverTheyAreNotZero) {
    using Number = NearBound<TypeParam>;
    const WrittenBases bases;
    constexpr unsigned kSeed = 408;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (int i = 0; i < 1000; ++i) {
        // A box so wide that it may come near the centre, or hold it.
        const double x = uniform(random), y = uniform(random), distance = std::hypot(x, y);
        const double spread = 0.7 * distance * (1 + 0.4 * uniform(random));
        const RestBound<TypeParam> rest(0, spread, 0);
        const Number found = length(Number{WrittenBase(x), rest}, Number{WrittenBase(y), rest});
        const Interval whole = whole_of(found);
        for (int k = 0; k < 10; ++k) {
            const double length = std::hypot(x + spread * uniform(random), y + spread * uniform(random));
            EXPECT_LE(whole.lo, length);
            EXPECT_GE(whole.hi, length);
        }
        // It is no wider than the box.
        EXPECT_LE(whole.hi - whole.lo, 2 * std::numbers::sqrt2 * spread * (1 + 1e-12));
        EXPECT_LT(found.rest.error, (std::is_same_v<TypeParam, float> ? 3e-5 : 1e-13) * distance);
    }
}

TYPED_TEST(Near, LengthsOfWhatUnderflowsAreBounded) {
    const RestBound<TypeParam> little(1e-170, 0, 1e-170), none(0.0), found = length(little, none);
    EXPECT_LE(found.middle - found.radius, 1e-170);
    EXPECT_GE(found.middle + found.radius, 1e-170);
    EXPECT_GE(found.error, 1e-170);
}

TYPED_TEST(Near, ScalesAreKnownToTheLeastOne) {
    const WrittenBases bases;
    NearBound<TypeParam> sine;
    const NearBound<TypeParam> scale = scaled_sinh(number_near<TypeParam>(700, 0), sine);
    // 1 / cosh(700) is next to nothing, and kLeastScale is taken for it.
    EXPECT_EQ(scale.base.value, kLeastScale);
    EXPECT_GE(scale.rest.radius, kLeastScale);
}

TYPED_TEST(Near, NumbersEncloseEveryProjection) {
    using Number = NearBound<TypeParam>;
    const WrittenBases bases;
    constexpr unsigned kSeed = 404;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (const Projection projection : kProjections)
        for (int i = 0; i < 200; ++i) {
            Setting setting;
            setting.half_width = 1;
            setting.reach = 1000;
            setting.centre_x = setting.centre_y = 0.5;
            const double lift = projection == Projection::octahedral ? 0.45 : 0;
            const double x = lift + 0.4 * uniform(random), y = lift + 0.4 * uniform(random);
            const double dx = 0.03 * uniform(random), dy = 0.03 * uniform(random);
            if (std::hypot(x, y) < 0.06) continue;                  // an axis
            if (lift > 0 && std::fabs(1 - x - y) < 0.08) continue;  // its crease
            const std::string words(name_of(projection));
            with_projection(projection, [&](auto formulas) {
                const Ray<double> from = formulas.ray(Point<double>{x, y}, setting),
                                  to = formulas.ray(Point<double>{x + dx, y + dy}, setting);
                const auto near = number_near<TypeParam>;
                const Ray<Number> ray = formulas.ray(Point<Number>{near(x, dx), near(y, dy)}, setting);
                expect_encloses(ray.x, to.x, words + " ray x");
                expect_encloses(ray.y, to.y, words + " ray y");
                expect_encloses(ray.z, to.z, words + " ray z");
                const Point<Number> p =
                    formulas.point(Ray<Number>{near(from.x, to.x - from.x), near(from.y, to.y - from.y),
                                               near(from.z, to.z - from.z)},
                                   setting);
                expect_encloses(p.x, x + dx, words + " x");
                expect_encloses(p.y, y + dy, words + " y");
            });
        }
}

const char* const kLenses[] = {"ptlens:a=0.01,b=-0.03,c=0.02", "ptlens:b=-0.05",
                               "brown:k1=-0.2,k2=0.05,k3=-0.004", "3de4:k1=0.1,k2=0.03",
                               "kb4:k1=0.05,k2=-0.01,k3=0.002,k4=-0.0003"};

// Both ways, against the radius found by halving and the formula, in long double.
TYPED_TEST(Near, NumbersEncloseEveryLens) {
    using Number = NearBound<TypeParam>;
    const WrittenBases bases;
    constexpr unsigned kSeed = 405;
    SCOPED_TRACE(testing::Message() << "seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    for (const char* text : kLenses) {
        const oracle::View view = oracle::view_through(text, {1000, 1000}, 90);
        const oracle::LensOracle truth(view);
        const Chart chart = oracle::chart_of(view);
        const LensTerms& terms = chart.lens()->terms();
        for (int i = 0; i < 200; ++i) {
            const double x = 0.6 * uniform(random), y = 0.6 * uniform(random), dx = 0.01 * uniform(random),
                         dy = 0.01 * uniform(random);
            if (std::hypot(x, y) < 0.1) continue;
            const auto near = number_near<TypeParam>;
            // In the model's own unit.
            const double unit = terms.unit.value();
            const Point<Number> p{near(x * unit, dx * unit), near(y * unit, dy * unit)};
            const long double px = static_cast<long double>(x) + dx, py = static_cast<long double>(y) + dy,
                              r = std::hypot(px, py);
            const long double by_formula = truth.formula(r) / r, by_root = truth.root(r) / r;
            const auto expect = [&](const Point<Number>& found, long double by, const char* way) {
                const std::string words = std::string(text) + way;
                for (const auto& [number, value] : {std::pair(found.x, px), std::pair(found.y, py)}) {
                    const Interval whole = whole_of(number);
                    const double exact = static_cast<double>(value * by * unit);
                    EXPECT_LE(whole.lo, exact + 1e-15) << words;
                    EXPECT_GE(whole.hi, exact - 1e-15) << words;
                    // Coefficients are those of a ring.
                    EXPECT_LT(whole.hi - whole.lo, 0.01 * unit) << words;
                    EXPECT_LT(number.rest.error, 1e-7 * unit) << words;
                }
            };
            expect(lens_formula::ideal_point(terms, p), terms.to_observed ? by_root : by_formula, ", ideal");
            expect(lens_formula::observed_point(terms, p), terms.to_observed ? by_formula : by_root,
                   ", observed");
        }
    }
}

// Formulas whose two operands are both made in one expression, as a compiler does that begins with the left one, or with the
// right one. Of the first the operations differ, of the second their operands alone, of the third what they lead to alone.
template <int Formula, bool LeftFirst, class T>
Point<T> in_order(const T& x, const T& y) {
    const auto in_turn = [](const auto& left, const auto& right, const auto& together) -> Point<T> {
        if (LeftFirst) {
            const T a = left();
            return together(a, T(right()));
        }
        const T b = right();
        return together(T(left()), b);
    };
    const auto apart = [](const T& a, const T& b) { return Point<T>{a, b}; };
    const auto less = [](const T& a, const T& b) { return Point<T>{a - b, a / b}; };
    if (Formula == 0) return in_turn([&] { return sqrt(T(x + 2.0)); }, [&] { return y * y; }, less);
    if (Formula == 1) return in_turn([&] { return x * 2.0; }, [&] { return y * 3.0; }, less);
    return in_turn([&] { return x * 2.0; }, [&] { return x * 3.0; }, apart);
}

/// What comes of a formula that was written in one order and is read in one.
struct Replay {
    std::uint64_t written, read;
    double error, bound;  ///< the distance from the exact point, and what was said of it
};

template <int Formula, bool LeftWritten, bool LeftRead>
Replay replay(double x, double y, double dx, double dy) {
    using Written = NearBound<double>;
    using Read = anamorph::Near<Replayed, double>;
    WrittenBases written;
    const Written at_x{WrittenBase::input(x), RestBound<double>(0, std::fabs(dx), 0)};
    const Written at_y{WrittenBase::input(y), RestBound<double>(0, std::fabs(dy), 0)};
    const Point<Written> base = in_order<Formula, LeftWritten>(at_x, at_y);
    const auto end_of = [](ReadingOrder& order, const auto& p) {
        order.next(BaseOperation::output, p.x.base.number);
        order.next(BaseOperation::output, p.y.base.number);
        return order.sum();
    };
    Replayed::next_value = written.bases().data();
    Replayed::order = {};
    const Read read_x{Replayed::next(BaseOperation::input, 0), dx};
    const Read read_y{Replayed::next(BaseOperation::input, 0), dy};
    const Point<Read> found = in_order<Formula, LeftRead>(read_x, read_y);
    const Point<long double> exact =
        in_order<Formula, true>(static_cast<long double>(x) + dx, static_cast<long double>(y) + dy);
    const auto off = [](const Read& number, const Written& at, long double value) {
        return std::fabs(static_cast<long double>(at.base.value) + number.rest - value);
    };
    return {end_of(written.order(), base), end_of(Replayed::order, found),
            static_cast<double>(std::hypot(off(found.x, base.x, exact.x), off(found.y, base.y, exact.y))),
            std::hypot(base.x.rest.error, base.y.rest.error)};
}

template <int Formula>
void expect_order_is_noticed() {
    constexpr unsigned kSeed = 415;
    SCOPED_TRACE(testing::Message() << "formula " << Formula << ", seed " << kSeed);
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (int i = 0; i < 100; ++i) {
        const double x = 1 + uniform(random), y = 3 + uniform(random), dx = 0.1 * uniform(random),
                     dy = 0.1 * uniform(random);
        for (const Replay& same :
             {replay<Formula, true, true>(x, y, dx, dy), replay<Formula, false, false>(x, y, dx, dy)}) {
            EXPECT_EQ(same.written, same.read);
            EXPECT_LE(same.error, same.bound);
        }
        for (const Replay& other :
             {replay<Formula, true, false>(x, y, dx, dy), replay<Formula, false, true>(x, y, dx, dy)}) {
            EXPECT_NE(other.written, other.read);
            // Nor would the bound hold, where something is made of the bases.
            EXPECT_TRUE(Formula == 2 || other.error > other.bound);
        }
    }
}

TEST(Direct, AnotherOrderOfOperandsIsNoticed) {
    expect_order_is_noticed<0>();
    expect_order_is_noticed<1>();
    expect_order_is_noticed<2>();
}

/// Its blocks would be read in an order in which no bases are written.
class MisreadPlan final : public FormulaPlan<Panorama> {
  public:
    MisreadPlan(const Panorama& map, const PlanOptions& options) : FormulaPlan(map, options, {1, 2}) {}
};

TEST(Direct, BasesThatWouldBeReadInAnotherOrderAreNot) {
    const Panorama map({Projection::equirectangular, 4096, 2048}, {Projection::fisheye, 300, 300, 180},
                       {150, 40, 0});
    for (const Scheme scheme : {Scheme::automatic, Scheme::direct, Scheme::exact})
        for (const double tol : {0.01, 1e-7, 0.0}) {
            PlanOptions options;
            options.scheme = scheme;
            options.tol = tol;
            const auto count = [](const BlockMap& plan) {
                int direct = 0;
                for (std::int64_t r = 0; r < plan.regions(); ++r)
                    for (const Block& block : plan.blocks(r)) {
                        direct += block.kind == Block::Kind::computed;
                        EXPECT_TRUE(block.kind == Block::Kind::outside || block.bound <= 0.01);
                    }
                return direct;
            };
            EXPECT_EQ(count(MisreadPlan(map, options)), 0);
            EXPECT_TRUE(scheme != Scheme::direct || count(PanoramaPlan(map, options)) > 0);
        }
}

template <class Real>
void expect_read_as_written(const Panorama& map) {
    const double x = 0.3 * map.target_size().width, y = 0.4 * map.target_size().height;
    const std::uint64_t read =
        simd::direct_order<Real>(map.target(), map.source(), map.local_around(x, y, 0));
    for (std::size_t piece = 0; piece < map.target_pieces().size(); ++piece) {
        const Panorama::Local local = map.local_around(x, y, static_cast<int>(piece));
        Bases bases;
        const NearReading found = map.direct<Real>(x, y, 8, 8, local, bases);
        EXPECT_EQ(found.order, read);
    }
}
/// On the set that is in use.
void expect_read_as_written_in_float_and_double(const Panorama& map) {
    expect_read_as_written<float>(map);
    expect_read_as_written<double>(map);
}

TEST(Direct, BasesAreReadInTheOrderInWhichTheyAreWritten) {
    for (const char* const* set = simd::instruction_sets(); *set; ++set) {
        ASSERT_TRUE(simd::use_instruction_set(*set));
        for (const Projection source : kProjections)
            for (const Projection target : kProjections) {
                SCOPED_TRACE(testing::Message()
                             << *set << ", " << name_of(source) << " -> " << name_of(target));
                expect_read_as_written_in_float_and_double(Panorama(
                    test::chart_of_width(source, 2048), test::chart_of_width(target, 96), {30, 20, 10}));
            }
        for (const char* text : kLenses) {
            SCOPED_TRACE(testing::Message() << *set << ", " << text);
            const Chart observed = oracle::chart_of(oracle::view_through(text, {96, 96}, 90)),
                        sphere(Projection::equirectangular, 2048, 1024);
            expect_read_as_written_in_float_and_double(Panorama(sphere, observed, {30, 20, 10}));
            expect_read_as_written_in_float_and_double(
                Panorama(observed, Chart(Projection::rectilinear, 96, 96, 40), {30, 20, 10}));
        }
    }
    simd::use_instruction_set("");
}

/// One operation in Real on values that are exact, and its bound: the largest part of the bound that rounding takes.
template <class Real, class Compute, class Exact>
double part_of_bound(const Compute& compute, const Exact& exact) {
    constexpr unsigned kSeed = 416;
    std::mt19937 random(kSeed);
    std::uniform_real_distribution<double> uniform(1, 2);
    double most = 0;
    for (int i = 0; i < 20000; ++i) {
        const Real a = static_cast<Real>(uniform(random)), b = static_cast<Real>(uniform(random));
        const double bound = compute(RestBound<Real>(double{a}), RestBound<Real>(double{b})).error;
        const long double computed = compute(a, b),
                          truth = exact(static_cast<long double>(a), static_cast<long double>(b));
        EXPECT_LE(std::fabs(computed - truth), bound);
        most = std::max(most, static_cast<double>(std::fabs(computed - truth) / bound));
    }
    return most;
}

template <class Real>
void expect_operations_come_near_their_bounds() {
    const auto expect = [](const char* what, double least, const auto& operation) {
        EXPECT_GT(part_of_bound<Real>(operation, operation), least) << what;
    };
    using std::sqrt;
    expect("+", 0.9, [](const auto& a, const auto& b) { return a + b; });
    expect("-", 0.45, [](const auto& a, const auto& b) { return a * b - b; });
    expect("*", 0.9, [](const auto& a, const auto& b) { return a * b; });
    expect("sqrt", 0.6, [](const auto& a, const auto&) { return sqrt(a); });
}

// Half of what a RestBound says does not hold.
TEST(Direct, OperationsComeNearTheirBounds) {
    expect_operations_come_near_their_bounds<float>();
    expect_operations_come_near_their_bounds<double>();
}

class DirectTo : public testing::TestWithParam<double> {};
INSTANTIATE_TEST_SUITE_P(FloatAndDouble, DirectTo, testing::Values(0.01, 1e-7));

TEST_P(DirectTo, GivesTheSameBitsOnEveryInstructionSet) {
    for (const Projection source : kProjections)
        for (const Projection target : kProjections) {
            SCOPED_TRACE(testing::Message() << name_of(source) << " -> " << name_of(target));
            const Panorama map(test::chart_of_width(source, 2048), test::chart_of_width(target, 96),
                               {30, 20, 10});
            expect_same_bits(map, GetParam());
        }
}
TEST_P(DirectTo, GivesTheSameBitsThroughLenses) {
    for (const char* text : kLenses) {
        SCOPED_TRACE(text);
        const Chart observed = oracle::chart_of(oracle::view_through(text, {96, 96}, 90)),
                    sphere(Projection::equirectangular, 2048, 1024);
        expect_same_bits(Panorama(sphere, observed, {30, 20, 10}), GetParam());
        expect_same_bits(Panorama(observed, Chart(Projection::rectilinear, 96, 96, 40), {30, 20, 10}),
                         GetParam());
    }
}

TEST(Direct, ServesMostOfAViewThroughALens) {
    const Chart sphere(Projection::equirectangular, 4096, 2048);
    for (const char* text : kLenses) {
        const Chart observed = oracle::chart_of(oracle::view_through(text, {1024, 1024}, 90));
        EXPECT_LT(plan_of(Panorama(sphere, observed, {30, 20, 10}), 0.01).reached(serial_for).exact_fraction,
                  0.3)
            << text;
    }
}

TEST(Direct, ServesMostOfAView) {
    // What is exact lies about poles, rims and edges of faces.
    for (const Projection source : kProjections) {
        const Panorama map(test::chart_of_width(source, 4096), {Projection::rectilinear, 1024, 1024, 90},
                           {30, 20, 10});
        EXPECT_LT(plan_of(map, 0.01).reached(serial_for).exact_fraction, 0.3) << name_of(source);
    }
}

TEST(Direct, ServesMostExactPixelsWithinABillionthOfOne) {
    for (const Projection source : kProjections) {
        const Panorama map(test::chart_of_width(source, 4096), {Projection::rectilinear, 1024, 1024, 90},
                           {30, 20, 10});
        const PanoramaPlan plan = plan_of(map, 0);
        std::int64_t direct = 0;
        for (std::int64_t r = 0; r < plan.regions(); ++r)
            for (const Block& block : plan.blocks(r)) {
                if (block.kind == Block::Kind::outside) continue;
                EXPECT_TRUE(is_exact(block));
                if (block.kind != Block::Kind::computed) continue;
                EXPECT_LE(block.bound, 1e-9);
                direct += std::int64_t{block.box.width()} * block.box.height();
            }
        EXPECT_GT(direct, 1024 * 1024 / 3) << name_of(source);
    }
}

TEST(Direct, RowsInDoubleAreThoseOfTheBlock) {
    const Panorama map({Projection::equirectangular, 4096, 2048}, {Projection::fisheye, 900, 700, 180},
                       {150, 40, 0});
    const PanoramaPlan plan = plan_of(map, 1e-8);
    PointsInDouble whole, row;
    int blocks = 0;
    for (std::int64_t r = 0; r < plan.regions(); ++r)
        for (const Block& block : plan.blocks(r)) {
            if (block.kind != Block::Kind::computed || !block.precise) continue;
            ++blocks;
            whole.read(plan, block, 0, block.box.height());
            for (int j = 0; j < block.box.height(); ++j) {
                row.read(plan, block, j, j + 1);
                for (int i = 0; i < block.box.width(); ++i) {
                    EXPECT_EQ(row.at(i, 0).x, whole.at(i, j).x);
                    EXPECT_EQ(row.at(i, 0).y, whole.at(i, j).y);
                    EXPECT_EQ(row.piece(0)[i], block.source_piece);
                }
            }
        }
    EXPECT_GT(blocks, 4);
}

TEST(Direct, RowsAndPartsAreThoseOfTheBlock) {
    const Panorama map({Projection::equirectangular, 4096, 2048}, {Projection::fisheye, 900, 700, 180},
                       {150, 40, 0});
    const PanoramaPlan plan = plan_of(map, 0.001);
    BlockPlanes planes(1);
    int blocks = 0;
    for (std::int64_t r = 0; r < plan.regions(); ++r)
        for (const Block& block : plan.blocks(r)) {
            if (block.kind != Block::Kind::computed || block.precise) continue;
            ++blocks;
            plan.computed({&block, 1}, planes.rows());
            const BlockPoints whole = planes.points(0);
            float x[simd::kRowRoom], y[simd::kRowRoom];
            for (int j = 0; j < block.box.height(); ++j)
                for (int begin = 0; begin < block.box.width(); begin += 7) {
                    const int end = std::min(begin + 11, block.box.width());
                    plan.computed_row(block, j, begin, end, x, y);
                    for (int i = begin; i < end; ++i) {
                        EXPECT_EQ(x[i - begin], whole.x[j * whole.row_stride + i]);
                        EXPECT_EQ(y[i - begin], whole.y[j * whole.row_stride + i]);
                    }
                }
        }
    EXPECT_GT(blocks, 4);
}

}  // namespace
}  // namespace anamorph
