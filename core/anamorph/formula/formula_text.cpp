// SPDX-License-Identifier: Apache-2.0
#include "anamorph/formula/formula_text.h"

#include <algorithm>
#include <cctype>
#include <functional>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>

#include "anamorph/error.h"
#include "anamorph/formula/solid_program.h"
#include "anamorph/number/portable.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

// --- the graph of operations ---

/// A result: of node `node`, its first or, of a sine and cosine, its second.
struct Result {
    int node = -1;
    bool second = false;

    friend auto operator<=>(const Result&, const Result&) = default;
};

struct Node {
    StepKind kind;
    Result a, b, c;
    int index = -1;  ///< of a number or a constant

    friend auto operator<=>(const Node&, const Node&) = default;
};

/// Are two numbers equal, and zeros of the same sign?
bool is_same(const DoubleDouble& a, const DoubleDouble& b) {
    return a == b && std::signbit(a.upper()) == std::signbit(b.upper());
}

/// Operations without repetitions, operands before what is made of them. Nodes 0 and 1 are x and y.
class Graph {
  public:
    static constexpr std::size_t kMostNodes = 1 << 14;

    Graph() { m_nodes.assign(2, {StepKind::number, {}, {}, {}, -1}); }
    Result x() const { return {0}; }
    Result y() const { return {1}; }
    Result number(double value) { return add({StepKind::number, {}, {}, {}, index_of(m_numbers, value)}); }
    Result constant(DoubleDouble value) {
        return add({StepKind::constant, {}, {}, {}, index_of(m_constants, value)});
    }
    Result make(StepKind kind, Result a, Result b = {}, Result c = {}) { return add({kind, a, b, c, -1}); }
    Result with_number(StepKind kind, Result a, double value) {
        return add({kind, a, {}, {}, index_of(m_numbers, value)});
    }
    Result times_constant(Result a, DoubleDouble value) {
        return add({StepKind::times_constant, a, {}, {}, index_of(m_constants, value)});
    }
    /// The value of a result that is a number, or that is a constant.
    std::optional<double> known_number(Result r) const { return known(r, StepKind::number, m_numbers); }
    std::optional<DoubleDouble> known_constant(Result r) const {
        return known(r, StepKind::constant, m_constants);
    }

    FormulaProgram program(const std::vector<Result>& outputs) const;

  private:
    template <class T>
    static int index_of(std::vector<T>& values, T value) {
        const auto found =
            std::find_if(values.begin(), values.end(), [&](T other) { return is_same(other, value); });
        if (found != values.end()) return static_cast<int>(found - values.begin());
        values.push_back(value);
        return static_cast<int>(values.size()) - 1;
    }
    template <class T>
    std::optional<T> known(Result r, StepKind kind, const std::vector<T>& values) const {
        const Node& node = m_nodes[static_cast<std::size_t>(r.node)];
        if (node.kind != kind || node.index < 0) return {};
        return values[static_cast<std::size_t>(node.index)];
    }
    Result add(const Node& node) {
        const auto [known, is_new] = m_known.try_emplace(node, static_cast<int>(m_nodes.size()));
        if (is_new) m_nodes.push_back(node);
        if (m_nodes.size() > kMostNodes) throw Error("needs more than 16384 operations: must be simpler");
        return {known->second};
    }

    std::vector<Node> m_nodes;
    std::vector<double> m_numbers;
    std::vector<DoubleDouble> m_constants;
    std::map<Node, int> m_known;
};

/// Registers, which are taken and given back.
class Registers {
  public:
    explicit Registers(int count) : m_free(static_cast<std::size_t>(count), true) {}

    /// The first of so many free ones in a row.
    std::uint8_t take(std::size_t count) {
        for (std::size_t i = 0; i + count <= m_free.size(); ++i)
            if (std::all_of(&m_free[i], &m_free[i] + count, [](char free) { return free != 0; })) {
                std::fill_n(&m_free[i], count, false);
                return static_cast<std::uint8_t>(i);
            }
        throw Error("needs more than " + std::to_string(m_free.size()) + " numbers at once: must be simpler");
    }
    void give_back(std::uint8_t i) { m_free[i] = true; }

  private:
    std::vector<char> m_free;
};

/// In a program's own list, from which it may be missing yet.
inline double key_of(double number) {
    return number;
}
inline DoubleDouble key_of(const Constant& constant) {
    return constant.precise();
}
template <class T>
std::uint8_t place_of(std::vector<T>& values, const T& value) {
    const auto known = std::find_if(values.begin(), values.end(),
                                    [&](const T& other) { return is_same(key_of(other), key_of(value)); });
    if (known != values.end()) return static_cast<std::uint8_t>(known - values.begin());
    if (values.size() == 256) throw Error("needs more than 256 different numbers: must be simpler");
    values.push_back(value);
    return static_cast<std::uint8_t>(values.size() - 1);
}

FormulaProgram Graph::program(const std::vector<Result>& outputs) const {
    FormulaProgram program;
    constexpr int kNever = -1, kAlways = 1 << 30;
    const std::size_t count = m_nodes.size();
    // Which node is the last one to read each result.
    std::vector<std::array<int, 2>> last(count, {kNever, kNever});
    const auto last_of = [&](Result r) -> int& {
        return last[static_cast<std::size_t>(r.node)][r.second ? 1 : 0];
    };
    for (const Result& output : outputs) last_of(output) = kAlways;
    const auto operands = [](const Node& node) { return std::array{node.a, node.b, node.c}; };
    const auto is_read = [&](std::size_t i) { return last[i][0] != kNever || last[i][1] != kNever; };
    for (std::size_t i = count; i-- > 2;)
        for (const Result& operand : operands(m_nodes[i]))
            if (operand.node >= 0 && is_read(i) && last_of(operand) == kNever)
                last_of(operand) = static_cast<int>(i);

    Registers registers(FormulaProgram::kRegisters);
    std::vector<std::uint8_t> at(count);
    at[0] = registers.take(1);
    at[1] = registers.take(1);
    const auto place = [&](Result r) {
        return static_cast<std::uint8_t>(at[static_cast<std::size_t>(r.node)] + (r.second ? 1 : 0));
    };
    for (std::size_t i = 2; i < count; ++i) {
        if (!is_read(i)) continue;
        const Node& node = m_nodes[i];
        const bool pair = node.kind == StepKind::sine_and_cosine;
        // Before its operands are given back: no step writes over them.
        at[i] = registers.take(pair ? 2 : 1);
        ProgramStep step{node.kind, at[i]};
        std::uint8_t* const to[] = {&step.a, &step.b, &step.c};
        const auto read = operands(node);
        for (std::size_t k = 0; k < read.size(); ++k)
            if (read[k].node >= 0) *to[k] = place(read[k]);
        if (node.index >= 0) {
            const bool alone = node.kind == StepKind::number || node.kind == StepKind::constant;
            (alone ? step.a : step.b) =
                node.kind == StepKind::constant || node.kind == StepKind::times_constant
                    ? place_of(program.constants, Constant(m_constants[static_cast<std::size_t>(node.index)]))
                    : place_of(program.numbers, m_numbers[static_cast<std::size_t>(node.index)]);
        }
        program.steps.push_back(step);
        std::vector<Result> done{{static_cast<int>(i), false}};
        if (pair) done.push_back({static_cast<int>(i), true});
        std::erase_if(done, [&](Result r) { return last_of(r) != kNever; });
        for (const Result& operand : read)
            if (operand.node >= 0 && last_of(operand) == static_cast<int>(i)) done.push_back(operand);
        std::sort(done.begin(), done.end());
        done.erase(std::unique(done.begin(), done.end()), done.end());
        for (const Result& r : done) registers.give_back(place(r));
    }
    for (const Result& output : outputs) program.outputs.push_back(place(output));
    return program;
}

// --- formulas of operations ---

/// A number of the text, or a condition, which holds where its number is negative; and where it is to be had: where `domain` is
/// positive, or everywhere.
struct Value {
    Result at;
    std::optional<Result> domain;
    bool is_condition = false;
};

/// Makes values of values.
class Maker {
  public:
    explicit Maker(Graph& graph) : m_graph(graph) {}

    Value number(double value) { return everywhere(m_graph.number(value)); }
    Value constant(DoubleDouble value) { return everywhere(m_graph.constant(value)); }
    Value x() const { return everywhere(m_graph.x()); }
    Value y() const { return everywhere(m_graph.y()); }

    Value negated(const Value& a) {
        const auto k = m_graph.known_number(a.at);
        return {k ? m_graph.number(-*k) : m_graph.make(StepKind::negation, a.at), a.domain};
    }
    Value sum(const Value& a, const Value& b) { return {sum(a.at, b.at), needs(a, b)}; }
    Value difference(const Value& a, const Value& b) {
        if (a.at == b.at) return {m_graph.number(0), needs(a, b)};
        if (m_graph.known_number(a.at) || m_graph.known_number(b.at)) return sum(a, negated(b));
        return {m_graph.make(StepKind::difference, a.at, b.at), needs(a, b)};
    }
    Value product(const Value& a, const Value& b) { return {product(a.at, b.at), needs(a, b)}; }
    Value quotient(const Value& a, const Value& b) {
        if (const auto by = divided(a.at, b.at)) return {*by, needs(a, b)};
        return {m_graph.make(StepKind::quotient, a.at, b.at), needs(needs(a, b), magnitude(b).at)};
    }
    Value of_one(StepKind kind, const Value& a) { return {m_graph.make(kind, a.at), a.domain}; }
    /// Where `positive` is.
    Value where(const Value& a, const Value& positive) {
        return {a.at, needs(a.domain, positive.at), a.is_condition};
    }
    Value square(const Value& a) { return of_one(StepKind::square, a); }
    Value root(const Value& a) {
        const auto k = m_graph.known_number(a.at);
        const double root = k && *k > 0 ? std::sqrt(*k) : 0;
        if (k && program_detail::is_exact_product(root, root, *k)) return {m_graph.number(root), a.domain};
        return of_one(StepKind::sqrt, a);
    }
    Value floor(const Value& a) {
        if (const auto k = m_graph.known_number(a.at)) return {m_graph.number(std::floor(*k)), a.domain};
        return of_one(StepKind::floor, a);
    }
    Value sine(const Value& a) { return of_one(StepKind::sine_and_cosine, a); }
    Value cosine(const Value& a) {
        Value r = sine(a);
        r.at.second = true;
        return r;
    }
    Value angle(const Value& y, const Value& x) {
        return {m_graph.make(StepKind::angle, y.at, x.at), needs(y, x)};
    }
    Value less(const Value& a, const Value& b) {
        Value r = difference(a, b);
        r.is_condition = true;
        return r;
    }
    /// a where the condition holds, else b.
    Value choice(const Value& condition, const Value& a, const Value& b) {
        if (const auto k = m_graph.known_number(condition.at); k && !condition.domain) return *k < 0 ? a : b;
        // Only the domain tells a value from one that is nowhere.
        const Result at = is_never(a.domain)   ? b.at
                          : is_never(b.domain) ? a.at
                                               : m_graph.make(StepKind::choice, condition.at, a.at, b.at);
        Value r{at, condition.domain, a.is_condition};
        if (!a.domain && !b.domain) return r;
        const Result one = m_graph.number(1);
        r.domain = needs(r.domain, m_graph.make(StepKind::choice, condition.at, a.domain.value_or(one),
                                                b.domain.value_or(one)));
        return r;
    }
    Value truth(bool holds) {
        Value r = number(holds ? -1 : 1);
        r.is_condition = true;
        return r;
    }
    Value contrary(const Value& a) { return choice(a, truth(false), truth(true)); }
    Value both(const Value& a, const Value& b) { return choice(a, b, truth(false)); }
    Value either(const Value& a, const Value& b) { return choice(a, truth(true), b); }
    Value least(const Value& a, const Value& b) { return choice(less(b, a), b, a); }
    Value most(const Value& a, const Value& b) { return choice(less(a, b), b, a); }
    Value magnitude(const Value& a) { return choice(less(a, number(0)), negated(a), a); }
    /// The power, of a number that is positive.
    Value power(const Value& a, const Value& b) {
        return of_one(StepKind::exp, product(b, of_one(StepKind::log, a)));
    }
    Value whole_power(const Value& a, int n) {
        if (n == 0) return {m_graph.number(1), a.domain};
        if (n < 0) return quotient(number(1), whole_power(a, -n));
        if (n == 1) return a;
        const Value half = whole_power(a, n / 2), even = product(half, half);
        return n % 2 == 0 ? even : product(even, a);
    }
    static constexpr double kMostPower = 1024;
    /// The whole number that is known, if it is one of few.
    std::optional<int> few(const Value& a) const {
        const auto k = m_graph.known_number(a.at);
        if (!k || std::fabs(*k) > kMostPower || *k != std::floor(*k)) return {};
        return static_cast<int>(*k);
    }

    /// The lesser of two domains. Where the first is not positive the second may not be a number.
    std::optional<Result> needs(const std::optional<Result>& a, const std::optional<Result>& b) {
        if (!a || !b || a == b) return a ? a : b;
        if (is_never(a) || is_never(b)) return is_never(a) ? a : b;
        const Result apart = m_graph.make(StepKind::difference, *b, *a);
        return m_graph.make(StepKind::choice, *a, *a, m_graph.make(StepKind::choice, apart, *b, *a));
    }
    std::optional<Result> needs(const Value& a, const Value& b) { return needs(a.domain, b.domain); }

  private:
    static Value everywhere(Result at) { return {at, {}, false}; }
    /// Is a domain known to be empty?
    bool is_never(const std::optional<Result>& domain) const {
        const auto k = domain ? m_graph.known_number(*domain) : std::nullopt;
        return k && !(*k > 0);
    }
    Result sum(Result a, Result b) {
        const auto x = m_graph.known_number(a), y = m_graph.known_number(b);
        if (x && y && program_detail::is_exact_sum(*x, *y, *x + *y)) return m_graph.number(*x + *y);
        return y ? added(a, *y) : x ? added(b, *x) : m_graph.make(StepKind::sum, a, b);
    }
    Result product(Result a, Result b) {
        const auto x = m_graph.known_number(a), y = m_graph.known_number(b);
        if (x && y && program_detail::is_exact_product(*x, *y, *x * *y)) return m_graph.number(*x * *y);
        if ((x && *x == 0) || (y && *y == 0)) return m_graph.number(0);
        if (y) return scaled(a, *y);
        if (x) return scaled(b, *x);
        if (const auto k = m_graph.known_constant(b)) return m_graph.times_constant(a, *k);
        if (const auto k = m_graph.known_constant(a)) return m_graph.times_constant(b, *k);
        return a == b ? m_graph.make(StepKind::square, a) : m_graph.make(StepKind::product, a, b);
    }
    /// By what is known and has an inverse.
    std::optional<Result> divided(Result a, Result b) {
        if (const auto k = m_graph.known_constant(b)) return m_graph.times_constant(a, 1 / *k);
        const auto x = m_graph.known_number(a), y = m_graph.known_number(b);
        if (x && y && *y != 0 && program_detail::is_exact_product(*x / *y, *y, *x))
            return m_graph.number(*x / *y);
        if (!y || !std::isnormal(*y) || !std::isnormal(1 / *y)) return {};
        // A power of two has an exact inverse.
        int exponent = 0;
        if (std::frexp(std::fabs(*y), &exponent) == 0.5) return scaled(a, 1 / *y);
        return m_graph.times_constant(a, 1 / static_cast<DoubleDouble>(*y));
    }
    Result added(Result a, double k) { return k == 0 ? a : m_graph.with_number(StepKind::add_number, a, k); }
    Result scaled(Result a, double k) {
        return k == 1 ? a : m_graph.with_number(StepKind::times_number, a, k);
    }

    Graph& m_graph;
};

// --- the text ---

using text_file::continues_name, text_file::starts_name;

struct NamedValue {
    Value value;
    bool used = false;
};
using NamedValues = std::map<std::string, NamedValue, std::less<>>;

struct Function {
    std::size_t least, most;  ///< arguments
    std::function<Value(Maker&, const std::vector<Value>&)> make;
};

Value smooth_step(Maker& m, const Value& low, const Value& high, const Value& x) {
    const Value part = m.quotient(m.difference(x, low), m.difference(high, low));
    const Value t = m.least(m.most(part, m.number(0)), m.number(1));
    return m.product(m.square(t), m.difference(m.number(3), m.product(m.number(2), t)));
}
/// The cube root of numbers of both signs.
Value cube_root(Maker& m, const Value& a) {
    const Value size = m.magnitude(a), third = m.constant(DoubleDouble(1) / 3);
    const Value root = m.power(size, third);
    return m.where(m.choice(m.less(a, m.number(0)), m.negated(root), root), size);
}
Value power(Maker& m, const Value& a, const Value& b) {
    if (const auto n = m.few(b)) return m.whole_power(a, *n);
    return m.where(m.power(a, b), a);
}
Value modulo(Maker& m, const Value& a, const Value& b) {
    return m.difference(a, m.product(b, m.floor(m.quotient(a, b))));
}
Value sign(Maker& m, const Value& a) {
    const Value zero = m.number(0);
    return m.choice(m.less(a, zero), m.number(-1), m.choice(m.less(zero, a), m.number(1), zero));
}
/// The root of 1 - a^2, where that is positive.
Value leg(Maker& m, const Value& a) {
    const Value squared = m.product(m.difference(m.number(1), a), m.sum(a, m.number(1)));
    return m.where(m.root(squared), squared);
}
Value tangent(Maker& m, const Value& a) {
    return m.quotient(m.sine(a), m.cosine(a));
}
/// (e^a + sign e^-a) / 2
Value half_sum(Maker& m, const Value& a, double sign) {
    const Value up = m.of_one(StepKind::exp, a), down = m.of_one(StepKind::exp, m.negated(a));
    return m.product(m.sum(up, m.product(down, m.number(sign))), m.number(0.5));
}
Value hyperbolic_tangent(Maker& m, const Value& a) {
    // From there on it is 1 to 300 digits.
    const Value twice = m.least(m.product(a, m.number(2)), m.number(700));
    const Value grown = m.of_one(StepKind::exp, twice);
    return m.difference(m.number(1), m.quotient(m.number(2), m.sum(grown, m.number(1))));
}

const std::map<std::string, Function, std::less<>>& functions() {
    using Values = const std::vector<Value>&;
    static const std::map<std::string, Function, std::less<>> all{
        {"sin", {1, 1, [](Maker& m, Values v) { return m.sine(v[0]); }}},
        {"cos", {1, 1, [](Maker& m, Values v) { return m.cosine(v[0]); }}},
        {"tan", {1, 1, [](Maker& m, Values v) { return tangent(m, v[0]); }}},
        {"asin", {1, 1, [](Maker& m, Values v) { return m.angle(v[0], leg(m, v[0])); }}},
        {"acos", {1, 1, [](Maker& m, Values v) { return m.angle(leg(m, v[0]), v[0]); }}},
        {"atan", {1, 2, [](Maker& m, Values v) { return m.angle(v[0], v.size() > 1 ? v[1] : m.number(1)); }}},
        {"atan2", {2, 2, [](Maker& m, Values v) { return m.angle(v[0], v[1]); }}},
        {"sinh", {1, 1, [](Maker& m, Values v) { return half_sum(m, v[0], -1); }}},
        {"cosh", {1, 1, [](Maker& m, Values v) { return half_sum(m, v[0], 1); }}},
        {"tanh", {1, 1, [](Maker& m, Values v) { return hyperbolic_tangent(m, v[0]); }}},
        {"asinh", {1, 1, [](Maker& m, Values v) { return m.of_one(StepKind::asinh, v[0]); }}},
        {"exp", {1, 1, [](Maker& m, Values v) { return m.of_one(StepKind::exp, v[0]); }}},
        {"log", {1, 1, [](Maker& m, Values v) { return m.where(m.of_one(StepKind::log, v[0]), v[0]); }}},
        {"sqrt", {1, 1, [](Maker& m, Values v) { return m.where(m.root(v[0]), v[0]); }}},
        {"cbrt", {1, 1, [](Maker& m, Values v) { return cube_root(m, v[0]); }}},
        {"pow", {2, 2, [](Maker& m, Values v) { return power(m, v[0], v[1]); }}},
        {"hypot", {2, 2, [](Maker& m, Values v) { return m.root(m.sum(m.square(v[0]), m.square(v[1]))); }}},
        {"abs", {1, 1, [](Maker& m, Values v) { return m.magnitude(v[0]); }}},
        {"sign", {1, 1, [](Maker& m, Values v) { return sign(m, v[0]); }}},
        {"min", {2, 2, [](Maker& m, Values v) { return m.least(v[0], v[1]); }}},
        {"max", {2, 2, [](Maker& m, Values v) { return m.most(v[0], v[1]); }}},
        {"mod", {2, 2, [](Maker& m, Values v) { return modulo(m, v[0], v[1]); }}},
        {"floor", {1, 1, [](Maker& m, Values v) { return m.floor(v[0]); }}},
        {"ceil", {1, 1, [](Maker& m, Values v) { return m.negated(m.floor(m.negated(v[0]))); }}},
        {"round", {1, 1, [](Maker& m, Values v) { return m.floor(m.sum(v[0], m.number(0.5))); }}},
        {"clamp", {3, 3, [](Maker& m, Values v) { return m.least(m.most(v[0], v[1]), v[2]); }}},
        {"mix",
         {3, 3, [](Maker& m, Values v) { return m.sum(v[0], m.product(m.difference(v[1], v[0]), v[2])); }}},
        {"step",
         {2, 2, [](Maker& m, Values v) { return m.choice(m.less(v[1], v[0]), m.number(0), m.number(1)); }}},
        {"smoothstep", {3, 3, [](Maker& m, Values v) { return smooth_step(m, v[0], v[1], v[2]); }}},
    };
    return all;
}

/// One expression, or definitions, by recursive descent; from the weakest operator to the strongest.
class Parser {
  public:
    Parser(Maker& maker, NamedValues& names, const std::string& parameter, std::string_view text)
        : m_maker(maker), m_names(names), m_parameter(parameter), m_text(text) {}

    /// All of the text.
    Value expression() {
        const Value value = number();
        if (!at_end()) fail("an operator or the end");
        return value;
    }
    /// name=expression; ... What is in `given` already stays, and what is in `fixed` must not be there.
    static void define(Maker& maker, NamedValues& names, const std::string& parameter, std::string_view text,
                       const std::set<std::string>& given, const std::set<std::string>& fixed) {
        Parser parser(maker, names, parameter, text);
        while (!parser.at_end()) {
            parser.skip_blanks();
            const std::size_t first = parser.m_at;
            const std::string name(parser.name());
            if (fixed.count(name)) parser.fail(first, "another name: every formula has this one");
            parser.expect("=");
            // Only what stands before is known.
            const Value value = parser.number();
            if (!given.count(name)) names.insert_or_assign(name, NamedValue{value});
            if (!parser.at_end()) parser.expect(";");
        }
    }

    /// Checks the name of a definition by itself.
    static void check_name(std::string_view name, std::string_view expression) {
        if (!text_file::is_name(name) || is_taken(name))
            throw Error(printable(name), printable(expression), "must be a name that is no function's");
    }

  private:
    static constexpr int kDeepest = 200;

    [[noreturn]] void fail(const std::string& expected) const { fail(m_at, expected); }
    [[noreturn]] void fail(std::size_t at, const std::string& expected) const {
        throw Error(m_parameter, printable(m_text),
                    "column " + std::to_string(at + 1) + ": expected " + expected);
    }
    void skip_blanks() {
        while (m_at < m_text.size() && (m_text[m_at] == ' ' || m_text[m_at] == '\t')) ++m_at;
    }
    bool at_end() {
        skip_blanks();
        return m_at == m_text.size();
    }
    /// Is it here? Then goes on behind it.
    bool accept(std::string_view what) {
        skip_blanks();
        if (m_text.substr(m_at, what.size()) != what) return false;
        const bool is_word = starts_name(what[0]), goes_on = m_at + what.size() < m_text.size();
        if (is_word && goes_on && continues_name(m_text[m_at + what.size()])) return false;
        m_at += what.size();
        return true;
    }
    void expect(const char* what) {
        if (!accept(what)) fail(what);
    }
    std::string_view name() {
        skip_blanks();
        const std::size_t first = m_at;
        if (m_at == m_text.size() || !starts_name(m_text[m_at])) fail("a name");
        while (m_at < m_text.size() && continues_name(m_text[m_at])) ++m_at;
        const std::string_view word = m_text.substr(first, m_at - first);
        if (is_taken(word)) fail(first, "a name that is no function's");
        return word;
    }
    /// By a function or an operator?
    static bool is_taken(std::string_view word) {
        return functions().count(word) || word == "if" || word == "and" || word == "or" || word == "not";
    }

    Value number() {
        return checked(false, [&] { return disjunction(); });
    }
    Value condition() {
        return checked(true, [&] { return disjunction(); });
    }
    template <class Parse>
    Value checked(bool is_condition, const Parse& parse) {
        skip_blanks();
        const std::size_t first = m_at;
        const Value value = parse();
        if (value.is_condition != is_condition) fail(first, is_condition ? "a condition" : "a number");
        return value;
    }

    /// Parses two or more parts with an operator in between, all conditions; or a single part.
    template <class Part, class Join>
    Value chain(const char* word, const Part& part, const Join& join) {
        skip_blanks();
        std::size_t first = m_at;
        Value value = part();
        while (accept(word)) {
            if (!value.is_condition) fail(first, "a condition");
            skip_blanks();
            first = m_at;
            const Value next = part();
            if (!next.is_condition) fail(first, "a condition");
            value = join(value, next);
        }
        return value;
    }
    Value disjunction() {
        const Deeper deeper(*this);
        return chain(
            "or", [&] { return conjunction(); },
            [&](const Value& a, const Value& b) { return m_maker.either(a, b); });
    }
    Value conjunction() {
        return chain(
            "and", [&] { return contrary(); },
            [&](const Value& a, const Value& b) { return m_maker.both(a, b); });
    }
    Value contrary() {
        if (!accept("not")) return comparison();
        const Deeper deeper(*this);
        return m_maker.contrary(checked(true, [&] { return contrary(); }));
    }
    Value comparison() {
        skip_blanks();
        const std::size_t first = m_at;
        const Value a = sum();
        const char* const signs[] = {"<=", ">=", "==", "!=", "<", ">"};
        if (!at_end() && m_text[m_at] == '=' && m_text.substr(m_at, 2) != "==") fail("==");
        for (const std::string_view sign : signs) {
            if (!accept(sign)) continue;
            if (a.is_condition) fail(first, "a number");
            const Value b = checked(false, [&] { return sum(); });
            Maker& m = m_maker;
            if (sign == "<") return m.less(a, b);
            if (sign == ">") return m.less(b, a);
            if (sign == "<=") return m.contrary(m.less(b, a));
            if (sign == ">=") return m.contrary(m.less(a, b));
            const Value differ = m.either(m.less(a, b), m.less(b, a));
            return sign == "!=" ? differ : m.contrary(differ);
        }
        return a;
    }
    /// a + b and the like, from left to right; `join(sign, a, b)`.
    template <class Part, class Join>
    Value row(std::string_view signs, const Part& part, const Join& join) {
        skip_blanks();
        const std::size_t first = m_at;
        Value value = part();
        for (skip_blanks(); m_at < m_text.size() && signs.find(m_text[m_at]) != signs.npos; skip_blanks()) {
            const char sign = m_text[m_at++];
            if (value.is_condition) fail(first, "a number");
            value = join(sign, value, checked(false, part));
        }
        return value;
    }
    Value sum() {
        return row(
            "+-", [&] { return product(); },
            [&](char sign, const Value& a, const Value& b) {
                return sign == '+' ? m_maker.sum(a, b) : m_maker.difference(a, b);
            });
    }
    Value product() {
        return row(
            "*/%", [&] { return signed_power(); },
            [&](char sign, const Value& a, const Value& b) {
                return sign == '*'   ? m_maker.product(a, b)
                       : sign == '/' ? m_maker.quotient(a, b)
                                     : modulo(m_maker, a, b);
            });
    }
    Value signed_power() {
        if (accept("+")) return checked(false, [&] { return deeper_signed_power(); });
        if (accept("-")) return m_maker.negated(checked(false, [&] { return deeper_signed_power(); }));
        skip_blanks();
        const std::size_t first = m_at;
        const Value base = primary();
        if (!accept("^")) return base;
        if (base.is_condition) fail(first, "a number");
        return power(m_maker, base, checked(false, [&] { return deeper_signed_power(); }));
    }
    Value deeper_signed_power() {
        const Deeper deeper(*this);
        return signed_power();
    }
    Value primary() {
        if (accept("(")) {
            const Value value = disjunction();
            expect(")");
            return value;
        }
        skip_blanks();
        if (m_at == m_text.size()) fail("a number, a name or (");
        if (std::isdigit(static_cast<unsigned char>(m_text[m_at])) || m_text[m_at] == '.') return literal();
        if (!starts_name(m_text[m_at])) fail("a number, a name or (");
        return named();
    }
    Value literal() {
        double value = 0;
        const char* const first = m_text.data() + m_at;
        const auto [end, error] = from_chars(first, m_text.data() + m_text.size(), value);
        if (error != std::errc() || !std::isfinite(value)) fail("a number that double can hold");
        m_at += static_cast<std::size_t>(end - first);
        return m_maker.number(value);
    }
    Value named() {
        const std::size_t first = m_at;
        std::size_t end = m_at;
        while (end < m_text.size() && continues_name(m_text[end])) ++end;
        const std::string_view word = m_text.substr(first, end - first);
        m_at = end;
        if (word == "if") return choice();
        if (const auto function = functions().find(word); function != functions().end())
            return call(first, function->first, function->second);
        const auto name = m_names.find(word);
        if (name == m_names.end()) fail(first, "a name that is known, not " + printable(word));
        name->second.used = true;
        return name->second.value;
    }
    Value choice() {
        expect("(");
        const Value where = condition();
        expect(",");
        const Value a = number();
        expect(",");
        const Value b = number();
        expect(")");
        return m_maker.choice(where, a, b);
    }
    Value call(std::size_t first, const std::string& name, const Function& function) {
        expect("(");
        std::vector<Value> arguments{number()};
        while (accept(",")) arguments.push_back(number());
        expect(")");
        if (arguments.size() < function.least || arguments.size() > function.most) {
            const std::string two =
                function.most > function.least ? " or " + std::to_string(function.most) : "";
            fail(first, name + " with " + std::to_string(function.least) + two +
                            (function.most == 1 ? " argument" : " arguments"));
        }
        return function.make(m_maker, arguments);
    }

    /// Counts how deep expressions are nested.
    struct Deeper {
        explicit Deeper(Parser& of) : parser(of) {
            if (++parser.m_depth > kDeepest)
                parser.fail("no more than " + std::to_string(kDeepest) + " expressions in each other");
        }
        ~Deeper() { --parser.m_depth; }
        Deeper(const Deeper&) = delete;
        Deeper& operator=(const Deeper&) = delete;

        Parser& parser;
    };

    Maker& m_maker;
    NamedValues& m_names;
    std::string m_parameter;
    std::string_view m_text;
    std::size_t m_at = 0;
    int m_depth = 0;
};

/// What does not depend on the point.
NamedValues settings_of(Maker& m, const FormulaSetting& setting) {
    return {{"width", {m.number(setting.picture.width)}},
            {"height", {m.number(setting.picture.height)}},
            {"src_width", {m.number(setting.source.width)}},
            {"src_height", {m.number(setting.source.height)}},
            {"frame", {m.number(setting.frame)}},
            {"pi", {m.constant(DoubleDouble::pi())}}};
}

NamedValues names_of(Maker& m, const FormulaSetting& setting) {
    const Size& place = setting.pushes ? setting.source : setting.picture;
    const double width = place.width, height = place.height;
    const Value x = m.x(), y = m.y(), per_half = m.number(0.5 * std::min(width, height));
    const Value px = m.quotient(m.difference(x, m.number(0.5 * width)), per_half),
                py = m.quotient(m.difference(m.number(0.5 * height), y), per_half);
    NamedValues names = settings_of(m, setting);
    names.insert({{"x", {x}},
                  {"y", {y}},
                  {"s", {m.quotient(x, m.number(width))}},
                  {"t", {m.quotient(y, m.number(height))}},
                  {"px", {px}},
                  {"py", {py}},
                  {"r", {m.root(m.sum(m.square(px), m.square(py)))}},
                  {"a", {m.angle(py, px)}}});
    return names;
}

/// The names of pixels of an equirectangular picture of all directions.
NamedValues names_of(Maker& m, const FormulaSetting& setting, const Size& globe) {
    const auto part = [&](const Value& at, int of) { return m.quotient(at, m.number(of)); };
    const auto turns = [&](const Value& count, DoubleDouble whole) {
        return m.product(count, m.constant(whole * DoubleDouble::pi()));
    };
    NamedValues names = settings_of(m, setting);
    names["lon"] = {turns(m.difference(part(m.x(), globe.width), m.number(0.5)), 2)};
    names["lat"] = {turns(m.difference(m.number(0.5), part(m.y(), globe.height)), 1)};
    return names;
}

/// v counts up.
NamedValues names_of(Maker& m, const SurfaceSetting& setting) {
    return {{"u", {m.x()}},
            {"v", {m.difference(m.number(1), m.y())}},
            {"aspect", {m.number(setting.aspect)}},
            {"frame", {m.number(setting.frame)}},
            {"pi", {m.constant(DoubleDouble::pi())}}};
}

NamedValues names_of_displacement(Maker& m, double frame) {
    return {{"u", {m.x()}},
            {"v", {m.y()}},
            {"frame", {m.number(frame)}},
            {"pi", {m.constant(DoubleDouble::pi())}}};
}

/// By the stereographic projection of the unit sphere from the pole of the other half.
NamedValues names_of(Maker& m, const SolidSetting& setting) {
    const Value s = m.x(), t = m.y(), square = m.sum(m.square(s), m.square(t)), one = m.number(1),
                below = m.sum(one, square);
    const Value away = m.quotient(m.difference(one, square), below);
    const auto twice = [&](const Value& a) { return m.quotient(m.product(m.number(2), a), below); };
    const auto along = [&](int axis, const Value& unit) {
        return m.product(m.number(setting.axes[static_cast<std::size_t>(axis)]), unit);
    };
    return {{"x", {along(0, twice(s))}},
            {"y", {along(1, twice(t))}},
            {"z", {along(2, setting.behind ? away : m.negated(away))}},
            {"own_red", {m.number(setting.own[0])}},
            {"own_green", {m.number(setting.own[1])}},
            {"own_blue", {m.number(setting.own[2])}},
            {"scale", {m.number(setting.scale)}},
            {"frame", {m.number(setting.frame)}},
            {"pi", {m.constant(DoubleDouble::pi())}}};
}

/// What `parse` makes of a text. What is too much for a program is told of the text, too.
template <class Parse>
auto named(const std::string& name, const std::string& text, const Parse& parse) {
    try {
        return parse();
    } catch (const Error& error) {
        if (!error.parameter().empty()) throw;
        throw Error(name, printable(text), error.what());
    }
}
Value value_of(Maker& maker, NamedValues& names, const std::string& name, const std::string& expression) {
    return named(name, expression, [&] { return Parser(maker, names, name, expression).expression(); });
}

/// Names by keys of their own. Returns them.
std::set<std::string> define(Maker& maker, NamedValues& names, const std::vector<Assignment>& definitions) {
    std::set<std::string> given;
    for (const auto& [name, expression] : definitions) {
        if (!given.count(name) && names.count(name))
            throw Error(printable(name), printable(expression),
                        "every formula has this name: must be another");
        const Value value = value_of(maker, names, name, expression);
        names.insert_or_assign(name, NamedValue{value});
        given.insert(name);
    }
    return given;
}

/// Does a name stand in a text, as a word?
bool has_word(std::string_view text, std::string_view name) {
    for (std::size_t at = text.find(name); at != text.npos; at = text.find(name, at + 1)) {
        const std::size_t end = at + name.size();
        const bool begins = at == 0 || !continues_name(text[at - 1]);
        if (begins && (end == text.size() || !continues_name(text[end]))) return true;
    }
    return false;
}

[[noreturn]] void throw_unused(const std::string& name, const std::string& value) {
    throw Error(printable(name), printable(value),
                "there is no such parameter, and no formula uses the name");
}

/// A misspelt key is to be told before its value makes no sense as a formula.
void expect_words(const std::vector<Assignment>& definitions, const std::string& let,
                  const std::vector<Assignment>& expressions) {
    for (const auto& [name, value] : definitions) {
        Parser::check_name(name, value);
        bool stands = has_word(let, name);
        for (const auto& [other, expression] : expressions) stands = stands || has_word(expression, name);
        for (const auto& [other, expression] : definitions)
            stands = stands || (other != name && has_word(expression, name));
        if (!stands) throw_unused(name, value);
    }
}

/// The expressions, each with the name that errors give it, after all definitions.
std::vector<Value> values_of(Maker& maker, NamedValues& names, const std::vector<Assignment>& definitions,
                             const std::string& let, const std::vector<Assignment>& expressions) {
    std::set<std::string> fixed;
    for (const auto& [name, value] : names) fixed.insert(name);
    expect_words(definitions, let, expressions);
    const std::set<std::string> given = define(maker, names, definitions);
    named("let", let, [&] { Parser::define(maker, names, "let", let, given, fixed); });
    std::vector<Value> values;
    values.reserve(expressions.size());
    for (const auto& [name, expression] : expressions)
        values.push_back(value_of(maker, names, name, expression));
    for (const auto& [name, expression] : definitions)
        if (!names.at(name).used) throw_unused(name, expression);
    return values;
}

/// Where all of them are to be had.
std::optional<Result> domain_of(Maker& maker, const std::vector<Value>& values) {
    std::optional<Result> domain;
    for (const Value& value : values) domain = maker.needs(domain, value.domain);
    return domain;
}

/// What `make` makes of the domain of values; what is too much for a program is told of the keys.
template <class Make>
auto programs_of(const char* keys, Graph& graph, Maker& maker, const std::vector<Value>& values,
                 const Make& make) {
    try {
        const std::optional<Result> domain = domain_of(maker, values);
        return make(domain ? *domain : graph.number(1), !domain);
    } catch (const Error& error) {
        throw Error(std::string(keys) + ": the formula " + error.what());
    }
}

PlaneFormula plane_formula(const char* keys, Graph& graph, Maker& maker, const std::vector<Value>& point) {
    return programs_of(keys, graph, maker, point, [&](Result positive, bool is_everywhere) {
        return PlaneFormula{graph.program({point[0].at, point[1].at}), graph.program({positive, positive}),
                            is_everywhere};
    });
}
SpaceFormula space_formula(const char* keys, Graph& graph, Maker& maker, const std::vector<Value>& point) {
    return programs_of(keys, graph, maker, point, [&](Result positive, bool is_everywhere) {
        return SpaceFormula{graph.program({point[0].at, point[1].at, point[2].at}), graph.program({positive}),
                            is_everywhere};
    });
}

bool is_same(const FormulaProgram& a, const FormulaProgram& b) {
    const auto parts = [](const ProgramStep& s) { return std::array{s.result, s.a, s.b, s.c}; };
    return std::equal(a.steps.begin(), a.steps.end(), b.steps.begin(), b.steps.end(),
                      [&](const ProgramStep& p, const ProgramStep& q) {
                          return p.kind == q.kind && parts(p) == parts(q);
                      }) &&
           std::equal(a.constants.begin(), a.constants.end(), b.constants.begin(), b.constants.end(),
                      [](const Constant& p, const Constant& q) { return p.precise() == q.precise(); }) &&
           a.numbers == b.numbers && a.outputs == b.outputs;
}

}  // namespace

PlaneFormula parse_formula(const FormulaText& text, const FormulaSetting& setting) {
    Graph graph;
    Maker maker(graph);
    NamedValues names = names_of(maker, setting);
    std::vector<Value> point =
        values_of(maker, names, text.definitions, text.let, {{"u", text.u}, {"v", text.v}});
    if (setting.in_fractions) {
        const Size& to = setting.pushes ? setting.picture : setting.source;
        point[0] = maker.product(point[0], maker.number(to.width));
        point[1] = maker.product(point[1], maker.number(to.height));
    }
    return plane_formula("u and v", graph, maker, point);
}

SpaceFormula parse_surface(const SurfaceText& text, const SurfaceSetting& setting) {
    Graph graph;
    Maker maker(graph);
    NamedValues names = names_of(maker, setting);
    return space_formula("px, py and pz", graph, maker,
                         values_of(maker, names, text.definitions, text.let,
                                   {{"px", text.px}, {"py", text.py}, {"pz", text.pz}}));
}

SpaceFormula parse_rays(const RayText& text, const FormulaSetting& setting) {
    Graph graph;
    Maker maker(graph);
    NamedValues names = names_of(maker, setting);
    std::vector<Value> ray = values_of(maker, names, text.definitions, text.let,
                                       {{"ray_x", text.x}, {"ray_y", text.y}, {"ray_z", text.z}});
    ray[1] = maker.negated(ray[1]);
    return space_formula("ray_x, ray_y and ray_z", graph, maker, ray);
}

PlaneFormula parse_directions(const DirectionText& text, const FormulaSetting& setting, const Size& globe) {
    Graph graph;
    Maker maker(graph);
    NamedValues names = names_of(maker, setting, globe);
    std::vector<Value> point =
        values_of(maker, names, text.definitions, text.let, {{"point_x", text.x}, {"point_y", text.y}});
    const double width = setting.picture.width, height = setting.picture.height;
    const Value half = maker.number(0.5 * std::min(width, height));
    point[0] = maker.sum(maker.number(0.5 * width), maker.product(point[0], half));
    point[1] = maker.difference(maker.number(0.5 * height), maker.product(point[1], half));
    return plane_formula("point_x and point_y", graph, maker, point);
}

SpaceFormula parse_displacement(const DisplacementText& text, double frame) {
    Graph graph;
    Maker maker(graph);
    NamedValues names = names_of_displacement(maker, frame);
    const auto or_zero = [](const std::string& expression) {
        return expression.empty() ? std::string("0") : expression;
    };
    const std::vector<Value> moved = values_of(
        maker, names, {}, text.let, {{"x", or_zero(text.x)}, {"y", or_zero(text.y)}, {"z", or_zero(text.z)}});
    return space_formula("x, y and z", graph, maker, moved);
}

SpaceFormula parse_solid(const SolidText& text, const SolidSetting& setting) {
    Graph graph;
    Maker maker(graph);
    NamedValues names = names_of(maker, setting);
    return space_formula("red, green and blue", graph, maker,
                         values_of(maker, names, {}, text.let,
                                   {{"red", text.red}, {"green", text.green}, {"blue", text.blue}}));
}

bool operator==(const SpaceFormula& a, const SpaceFormula& b) {
    return is_same(a.point, b.point) && is_same(a.domain, b.domain) && a.is_everywhere == b.is_everywhere;
}

}  // namespace anamorph
