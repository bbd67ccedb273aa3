// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/shader_program.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::machine {
namespace {

struct OpcodeFacts {
    const char* name;
    ShaderOpcode opcode;
    std::size_t sources;
    int slots = 1;
    std::uint8_t scalars = 0;  ///< bit k: source k must be one component
};
constexpr OpcodeFacts kOpcodes[] = {
    {"texld", ShaderOpcode::texld, 2},   {"texldp", ShaderOpcode::texldp, 2},
    {"texldb", ShaderOpcode::texldb, 2}, {"texkill", ShaderOpcode::texkill, 1},
    {"nop", ShaderOpcode::nop, 0},       {"mov", ShaderOpcode::mov, 1},
    {"add", ShaderOpcode::add, 2},       {"sub", ShaderOpcode::sub, 2},
    {"mul", ShaderOpcode::mul, 2},       {"mad", ShaderOpcode::mad, 3},
    {"lrp", ShaderOpcode::lrp, 3, 2},    {"abs", ShaderOpcode::abs, 1},
    {"frc", ShaderOpcode::frc, 1},       {"dp2add", ShaderOpcode::dp2add, 3, 2, 4},
    {"dp3", ShaderOpcode::dp3, 2},       {"dp4", ShaderOpcode::dp4, 2},
    {"crs", ShaderOpcode::crs, 2, 2},    {"nrm", ShaderOpcode::nrm, 1, 3},
    {"rcp", ShaderOpcode::rcp, 1, 1, 1}, {"rsq", ShaderOpcode::rsq, 1, 1, 1},
    {"exp", ShaderOpcode::exp, 1, 1, 1}, {"log", ShaderOpcode::log, 1, 1, 1},
    {"pow", ShaderOpcode::pow, 2, 3, 3}, {"sincos", ShaderOpcode::sincos, 3, 8, 1},
    {"min", ShaderOpcode::min, 2},       {"max", ShaderOpcode::max, 2},
    {"cmp", ShaderOpcode::cmp, 3}};

const OpcodeFacts& facts_of(ShaderOpcode opcode) {
    return *std::find_if(std::begin(kOpcodes), std::end(kOpcodes),
                         [&](const OpcodeFacts& f) { return f.opcode == opcode; });
}

bool is_texture(ShaderOpcode opcode) {
    return samples(opcode) || opcode == ShaderOpcode::texkill;
}

/// What is expanded to products with consecutive registers, one for each component.
struct MatrixFacts {
    const char* name;
    ShaderOpcode product;
    int rows;
};
constexpr MatrixFacts kMatrices[] = {{"m3x2", ShaderOpcode::dp3, 2},
                                     {"m3x3", ShaderOpcode::dp3, 3},
                                     {"m3x4", ShaderOpcode::dp3, 4},
                                     {"m4x3", ShaderOpcode::dp4, 3},
                                     {"m4x4", ShaderOpcode::dp4, 4}};

// D3DSINCOSCONST1 and 2: -1 / (7! 128), -1 / (6! 64), 1 / (4! 16), 1 / (5! 32); -1 / (3! 8), -1 / (2! 4), 1, 1 / 2.
constexpr double kSinCos[2][4] = {{-1.5500992e-6, -2.1701389e-5, 0.0026041667, 0.00026041668},
                                  {-0.020833334, -0.125, 1, 0.5}};

struct BankFacts {
    const char* name;
    ShaderBank bank;
    int count;
};
constexpr BankFacts kBanks[] = {{"r", ShaderBank::temporary, ShaderProgram::kTemporaries},
                                {"c", ShaderBank::constant, ShaderProgram::kConstants},
                                {"t", ShaderBank::coordinate, ShaderProgram::kCoordinates},
                                {"v", ShaderBank::color, ShaderProgram::kColors},
                                {"s", ShaderBank::sampler, ShaderProgram::kSamplers},
                                {"oC", ShaderBank::output, ShaderProgram::kOutputs},
                                {"oDepth", ShaderBank::depth, 1}};

constexpr std::size_t kBankCount = std::size(kBanks);
constexpr std::string_view kSwizzles[] = {"xyzw", "yzxw", "zxyw", "wzyx"};

std::string quoted(std::string_view text) {
    return "\"" + printable(text) + "\"";
}

[[noreturn]] void refuse(std::string_view word, const std::string& rule) {
    throw Error(quoted(word) + ": " + rule);
}

/// "xw" of "ra"; none where there is another letter.
std::optional<std::string> in_xyzw(std::string_view letters) {
    std::string all;
    for (const char letter : letters) {
        const std::size_t at = std::string_view("xyzwrgba").find(letter);
        if (at == std::string_view::npos) return {};
        all += "xyzw"[at % 4];
    }
    return all;
}

std::string register_name(ShaderBank bank, int number) {
    if (bank == ShaderBank::depth) return "oDepth";
    return kBanks[static_cast<std::size_t>(bank)].name + std::to_string(number);
}

/// ".xy", or nothing for all four.
std::string mask_text(std::uint8_t mask) {
    if (mask == 15) return "";
    std::string text = ".";
    for (std::size_t c = 0; c < 4; ++c)
        if (mask >> c & 1) text += "xyzw"[c];
    return text;
}

/// r5.xy in its parts.
struct RegisterText {
    ShaderBank bank;
    int number;
    std::string components;  ///< in x, y, z, w; empty where there are none
};

RegisterText parse_register(std::string_view word) {
    const std::size_t point = word.find('.');
    const std::string_view name = word.substr(0, point);
    if (word == "oDepth") return {ShaderBank::depth, 0, ""};
    for (const BankFacts& bank : kBanks) {
        if (bank.bank == ShaderBank::depth || !name.starts_with(bank.name)) continue;
        const std::string_view digits = name.substr(std::string_view(bank.name).size());
        if (digits.empty() || digits.size() > 2 ||
            digits.find_first_not_of("0123456789") != std::string_view::npos)
            continue;
        const int number = std::stoi(std::string(digits));
        if (number >= bank.count)
            refuse(word, "must be " + std::string(bank.name) + "0 to " + bank.name +
                             std::to_string(bank.count - 1));
        if (point == std::string_view::npos) return {bank.bank, number, ""};
        const auto components = in_xyzw(word.substr(point + 1));
        if (!components || components->empty() || components->size() > 4)
            refuse(word, "must have x, y, z, w or r, g, b, a behind the point");
        return {bank.bank, number, *components};
    }
    refuse(word, "no such register; there are r, c, t, v, s and oC with a number, and oDepth");
}

std::uint8_t mask_of(std::string_view word, const std::string& components) {
    if (components.empty()) return 15;
    std::uint8_t mask = 0;
    int last = -1;
    for (const char letter : components) {
        const int at = static_cast<int>(std::string_view("xyzw").find(letter));
        if (at <= last) refuse(word, "components of a mask must be in the order x, y, z, w");
        mask = static_cast<std::uint8_t>(mask | 1 << at);
        last = at;
    }
    return mask;
}

std::array<std::uint8_t, 4> swizzle_of(std::string_view word, const std::string& components) {
    const std::string full = components.size() == 1 ? std::string(4, components[0])  // r0.x is r0.xxxx
                             : components.empty()   ? "xyzw"
                                                    : components;
    if (components.size() > 1 &&
        std::find(std::begin(kSwizzles), std::end(kSwizzles), full) == std::end(kSwizzles))
        refuse(word, "a swizzle must be one component, or xyzw, yzxw, zxyw or wzyx");
    std::array<std::uint8_t, 4> swizzle{};
    for (std::size_t i = 0; i < 4; ++i)
        swizzle[i] = static_cast<std::uint8_t>(std::string_view("xyzw").find(full[i]));
    return swizzle;
}

/// Which components of its source k an instruction reads, before swizzles, for the components that it writes.
std::uint8_t components_read(const ShaderInstruction& i, std::size_t k) {
    constexpr std::uint8_t kOthers[8] = {0, 6, 5, 7, 3, 7, 7, 7};  // of a cross product
    switch (i.opcode) {
        case ShaderOpcode::texld:
            return 3;
        case ShaderOpcode::texldp:
        case ShaderOpcode::texldb:
            return 11;
        case ShaderOpcode::texkill:
        case ShaderOpcode::dp3:
            return 7;
        case ShaderOpcode::dp2add:
            return k < 2 ? 3 : 1;
        case ShaderOpcode::dp4:
            return 15;
        case ShaderOpcode::crs:
            return kOthers[i.mask & 7];
        case ShaderOpcode::nrm:
            return 7 | i.mask;
        default:
            return i.mask;
    }
}

/// Reads a text line by line.
class Assembler {
  public:
    explicit Assembler(const ShaderSlots& slots) : m_slots(slots) {}

    void line(std::string_view text) {
        text = text_file::trimmed(text.substr(0, std::min(text.find(';'), text.find("//"))));
        if (text.empty()) return;
        const std::size_t end = text.find_first_of(" \t");
        const std::string_view word = text.substr(0, end);
        std::vector<std::string_view> operands;
        if (end != std::string_view::npos)
            operands = text_file::fields_of(text_file::trimmed(text.substr(end)));
        if (!m_versioned) {
            if (text != "ps_2_0" && text != "ps.2.0") refuse(text, "the first line must be ps_2_0");
            m_versioned = true;
        } else if (word == "dcl" || word.starts_with("dcl_"))
            declare(word, operands);
        else if (word == "def")
            define(operands);
        else
            instruct(word, operands);
    }

    ShaderProgram finish() {
        if (!m_versioned) throw Error("is empty: the first line must be ps_2_0");
        if (written(ShaderBank::output, 0) != 15)
            throw Error("is the last one, and all of oC0 has not been written: must be by then");
        for (int n = 2; n < ShaderProgram::kOutputs; ++n)
            if (written(ShaderBank::output, n) != 0 && written(ShaderBank::output, n - 1) == 0)
                throw Error("is the last one, and oC" + std::to_string(n) + " has been written and oC" +
                            std::to_string(n - 1) + " has not: must be by then");
        return std::move(m_program);
    }

  private:
    void expect(const std::vector<std::string_view>& operands, std::size_t count,
                std::string_view word) const {
        if (operands.size() != count)
            refuse(word, "must have " + std::to_string(count) + " operands, and has " +
                             std::to_string(operands.size()));
    }
    void expect_ahead(std::string_view word) const {
        if (!m_program.instructions.empty()) refuse(word, "must stand before the first instruction");
    }

    /// `count`: of the registers of its kind that whoever runs the program fills.
    static void expect_given(const RegisterText& r, int count, std::string_view word) {
        if (r.number < count) return;
        refuse(word, count == 0 ? "is not given to this program"
                                : "is not given to this program: must be " + register_name(r.bank, 0) +
                                      " to " + register_name(r.bank, count - 1));
    }

    void declare(std::string_view word, const std::vector<std::string_view>& operands) {
        expect_ahead(word);
        expect(operands, 1, word);
        const RegisterText r = parse_register(operands[0]);
        if (word == "dcl_2d") {
            if (r.bank != ShaderBank::sampler || !r.components.empty())
                refuse(operands[0], "must be s0 to s15");
            expect_given(r, m_slots.samplers, operands[0]);
            if (m_program.samplers >> r.number & 1) refuse(operands[0], "is declared twice");
            m_program.samplers |= 1u << r.number;
            return;
        }
        // Every sample of a pixel is its middle, the centroid too.
        if (word != "dcl" && word != "dcl_pp" && word != "dcl_centroid")
            refuse(word, "must be dcl or dcl_2d: there are no other textures");
        if (r.bank != ShaderBank::coordinate && r.bank != ShaderBank::color)
            refuse(operands[0], "must be t0 to t7, v0 or v1");
        expect_given(r, r.bank == ShaderBank::coordinate ? m_slots.coordinates : m_slots.colors, operands[0]);
        std::uint8_t& mask = written(r.bank, r.number);
        if (mask != 0) refuse(operands[0], "is declared twice");
        mask = mask_of(operands[0], r.components);
        const auto number = static_cast<std::size_t>(r.number);
        (r.bank == ShaderBank::coordinate ? m_program.coordinates[number] : m_program.colors[number]) = mask;
    }

    void define(const std::vector<std::string_view>& operands) {
        expect_ahead("def");
        expect(operands, 5, "def");
        const RegisterText r = parse_register(operands[0]);
        if (r.bank != ShaderBank::constant || !r.components.empty()) refuse(operands[0], "must be c0 to c31");
        if (!m_defined.insert(r.number).second) refuse(operands[0], "is defined twice");
        ShaderConstant constant{r.number, {}};
        for (std::size_t i = 0; i < 4; ++i) {
            std::string_view text = operands[i + 1];
            if (!text_file::take_number(text, constant.value[i]) || !text.empty() ||
                !std::isfinite(constant.value[i]))
                refuse(operands[i + 1], "must be a finite number");
        }
        m_program.constants.push_back(constant);
    }

    void instruct(std::string_view word, const std::vector<std::string_view>& operands) {
        const std::string_view name = word.substr(0, word.find('_'));
        ShaderInstruction made;
        for (const MatrixFacts& matrix : kMatrices)
            if (name == matrix.name) return multiply(matrix, made, word, operands);
        const auto* facts = std::find_if(std::begin(kOpcodes), std::end(kOpcodes),
                                         [&](const OpcodeFacts& f) { return name == f.name; });
        if (facts == std::end(kOpcodes)) refuse(word, "no such instruction; there are " + opcode_names());
        made.opcode = facts->opcode;
        read_modifiers(made, word);
        const bool writes = made.opcode != ShaderOpcode::texkill && made.opcode != ShaderOpcode::nop;
        expect(operands, facts->sources + writes, word);
        made.mask = 0;
        if (writes) read_destination(made, operands[0]);
        for (std::size_t k = 0; k < facts->sources; ++k)
            made.sources[k] = read_source(made, operands[k + writes], k);
        check_operands(made, operands);
        add(made);
    }

    static void read_modifiers(ShaderInstruction& made, std::string_view word) {
        for (std::string_view rest = word.substr(std::min(word.find('_'), word.size())); !rest.empty();) {
            const std::size_t next = std::min(rest.find('_', 1), rest.size());
            const std::string_view modifier = rest.substr(0, next);
            bool& flag = modifier == "_sat" ? made.saturated : made.partial;
            if ((modifier != "_sat" && modifier != "_pp") || flag)
                refuse(word, "must have _sat and _pp at most behind it, each once");
            flag = true;
            rest.remove_prefix(next);
        }
        if (made.saturated && (is_texture(made.opcode) || made.opcode == ShaderOpcode::frc ||
                               made.opcode == ShaderOpcode::sincos))
            refuse(word, "cannot have _sat");
    }

    static std::string opcode_names() {
        std::string names;
        for (const OpcodeFacts& f : kOpcodes) names += (names.empty() ? "" : ", ") + std::string(f.name);
        for (const MatrixFacts& f : kMatrices) names += ", " + std::string(f.name);
        return names;
    }

    /// A product for each component of the destination.
    void multiply(const MatrixFacts& matrix, ShaderInstruction& made, std::string_view word,
                  const std::vector<std::string_view>& operands) {
        made.opcode = matrix.product;
        read_modifiers(made, word);
        expect(operands, 3, word);
        read_destination(made, operands[0]);
        const int all = (1 << matrix.rows) - 1;
        if (made.mask != all)
            refuse(operands[0],
                   std::string("what ") + matrix.name + " writes must be " +
                       (all == 15 ? "all of a register"
                                  : "the components " + mask_text(static_cast<std::uint8_t>(all))));
        made.sources[0] = read_source(made, operands[1], 0);
        made.sources[1] = read_source(made, operands[2], 1);
        expect_plain(made.sources[1], operands[2]);
        const ShaderSource& first = made.sources[1];
        const int count = kBanks[static_cast<std::size_t>(first.bank)].count;
        if (first.number + matrix.rows > count)
            refuse(operands[2], "must be the first of " + std::to_string(matrix.rows) + " registers");
        expect_other(made, made.sources[0], operands[1]);
        for (int row = 0; row < matrix.rows; ++row) {
            ShaderInstruction product = made;
            product.mask = static_cast<std::uint8_t>(1 << row);
            product.sources[1].number += row;
            expect_other(product, product.sources[1], operands[2]);
            add(product);
        }
    }

    /// Is all that an instruction reads there? Then it is the next one.
    void add(const ShaderInstruction& made) {
        const OpcodeFacts& facts = facts_of(made.opcode);
        check_reads(made, facts.sources);
        count(made, facts.slots);
        track(made, facts.sources);
        m_program.instructions.push_back(made);
    }

    void read_destination(ShaderInstruction& made, std::string_view word) {
        const RegisterText r = parse_register(word);
        const bool is_output = r.bank == ShaderBank::output || r.bank == ShaderBank::depth;
        if (r.bank != ShaderBank::temporary && !is_output)
            refuse(word, "must be a register that can be written, r0 to r11, oC0 to oC3 or oDepth");
        made.bank = r.bank;
        made.number = r.number;
        made.mask = mask_of(word, r.components);
        if (samples(made.opcode) && (r.bank != ShaderBank::temporary || made.mask != 15))
            refuse(word, "what texld writes must be all of a register r0 to r11");
        if (!is_output) return;
        if (made.mask != 15 || made.opcode != ShaderOpcode::mov || made.saturated || made.partial)
            refuse(word, "must be written by mov, all of it");
        if (written(r.bank, r.number) != 0) refuse(word, "is written twice: must be written once");
    }

    static bool is_plain(const ShaderSource& source) {
        return !source.negated && source.swizzle == ShaderSource{}.swizzle;
    }
    static void expect_plain(const ShaderSource& source, std::string_view word) {
        if (!is_plain(source)) refuse(word, "must be without swizzle and minus");
    }
    /// Another register than the one that is written.
    static void expect_other(const ShaderInstruction& made, const ShaderSource& source,
                             std::string_view word) {
        if (source.bank == made.bank && source.number == made.number)
            refuse(word, "must be another register than the one that is written");
    }

    ShaderSource read_source(const ShaderInstruction& made, std::string_view word, std::size_t k) const {
        ShaderSource source;
        std::string_view name = word;
        if (name.starts_with('-')) {
            source.negated = true;
            name = text_file::trimmed(name.substr(1));
        }
        RegisterText r = parse_register(name);
        if (r.components == std::string(4, r.components[0])) r.components.resize(1);
        source.bank = r.bank;
        source.number = r.number;
        source.swizzle = swizzle_of(word, r.components);
        const bool is_sampler = r.bank == ShaderBank::sampler,
                   is_texture_place = samples(made.opcode) && k == 1;
        if (is_texture_place != is_sampler)
            refuse(word, is_texture_place ? "must be a texture, s0 to s15"
                                          : "a texture can be read by texld, texldp and texldb only");
        if (r.bank == ShaderBank::output || r.bank == ShaderBank::depth) refuse(word, "cannot be read");
        if (is_texture(made.opcode) && (source.negated || !r.components.empty() ||
                                        r.bank == ShaderBank::constant || r.bank == ShaderBank::color))
            refuse(word, facts_of(made.opcode).name +
                             std::string(
                                 samples(made.opcode)
                                     ? " must have a register r or t and a texture, without swizzle and minus"
                                     : " must have a register r or t, without components and minus"));
        if (is_sampler && (m_program.samplers >> r.number & 1) == 0)
            refuse(word, "must be declared by dcl_2d");
        if ((facts_of(made.opcode).scalars >> k & 1) != 0 && r.components.size() != 1)
            refuse(word, "must be one component, as in r0.x");
        return source;
    }

    /// What the reference says of single instructions.
    void check_operands(const ShaderInstruction& made, const std::vector<std::string_view>& operands) const {
        const auto& sources = made.sources;
        if (made.bank == ShaderBank::output) expect_plain(sources[0], operands[1]);
        if (made.bank == ShaderBank::depth) {
            const auto& from = sources[0].swizzle;
            if (sources[0].negated || std::count(from.begin(), from.end(), from[0]) != 4)
                refuse(operands[1], "must be one component without a minus, as in r0.x");
        }
        if (made.opcode == ShaderOpcode::nrm) expect_other(made, sources[0], operands[1]);
        if (made.opcode == ShaderOpcode::pow) expect_other(made, sources[1], operands[2]);
        if (made.opcode == ShaderOpcode::crs) {
            if (made.mask > 7) refuse(operands[0], "what crs writes must be of x, y and z alone");
            for (std::size_t k = 0; k < 2; ++k) {
                expect_other(made, sources[k], operands[k + 1]);
                if (sources[k].swizzle != ShaderSource{}.swizzle)
                    refuse(operands[k + 1], "must be without swizzle");
            }
        }
        if (made.opcode == ShaderOpcode::sincos) check_sincos(made, operands);
    }

    void check_sincos(const ShaderInstruction& made, const std::vector<std::string_view>& operands) const {
        if (made.mask > 3) refuse(operands[0], "what sincos writes must be .x, .y or .xy");
        for (std::size_t k = 1; k <= 2; ++k) {
            const ShaderSource& source = made.sources[k];
            if (source.bank != ShaderBank::constant || !is_plain(source) ||
                source.number == made.sources[3 - k].number)
                refuse(operands[k + 1], "must be one of two different constants, without swizzle and minus");
            const auto& wanted = kSinCos[k - 1];
            for (const ShaderConstant& constant : m_program.constants)
                if (constant.number == source.number &&
                    !std::equal(std::begin(wanted), std::end(wanted), constant.value.begin(),
                                [](double a, double b) { return std::fabs(a - b) <= 1e-6 * std::fabs(a); })) {
                    std::string text;
                    for (const double value : wanted) text += (text.empty() ? "" : ", ") + shortest(value);
                    refuse(operands[k + 1], "must be " + text + " (D3DSINCOSCONST" + std::to_string(k) + ")");
                }
        }
    }

    /// Is all that an instruction reads there, and can it be read at once?
    void check_reads(const ShaderInstruction& made, std::size_t sources) {
        std::set<int> constants, coordinates, colors;
        for (std::size_t k = 0; k < sources; ++k) {
            const ShaderSource& s = made.sources[k];
            if (s.bank == ShaderBank::constant) constants.insert(s.number);
            if (s.bank == ShaderBank::coordinate) coordinates.insert(s.number);
            if (s.bank == ShaderBank::color) colors.insert(s.number);
            if (s.bank == ShaderBank::constant || s.bank == ShaderBank::sampler) continue;
            for (std::size_t i = 0; i < 4; ++i) {
                if ((components_read(made, k) >> i & 1) == 0) continue;
                if ((written(s.bank, s.number) >> s.swizzle[i] & 1) == 0)
                    refuse(register_name(s.bank, s.number) + "." + "xyzw"[s.swizzle[i]],
                           s.bank == ShaderBank::temporary ? "is read before it is written"
                                                           : "must be declared by dcl");
            }
        }
        if (constants.size() > 2) throw Error("an instruction can read two different constants at most");
        if (coordinates.size() > 1) throw Error("an instruction can read one of t0 to t7 at most");
        if (colors.size() > 1) throw Error("an instruction can read one of v0 and v1 at most");
    }

    void count(const ShaderInstruction& made, int slots) {
        const bool is_texture_slot = is_texture(made.opcode);
        int& so_far = is_texture_slot ? m_program.texture : m_program.arithmetic;
        const int most = is_texture_slot ? ShaderProgram::kMostTexture : ShaderProgram::kMostArithmetic;
        so_far += slots;
        if (so_far > most)
            throw Error("is one instruction too many: a program can have " + std::to_string(most) +
                        (is_texture_slot ? " texture instructions" : " slots of arithmetic instructions"));
    }

    /// The order of a read of a texture: 0 where it depends on no register r.
    int order_of(const ShaderInstruction& made) {
        const ShaderSource& at = made.sources[0];
        int order = 0;
        if (at.bank == ShaderBank::temporary) order = 1 + m_order[static_cast<std::size_t>(at.number)];
        if (written(made.bank, made.number) != 0)
            order = std::max(order, 1 + m_order[static_cast<std::size_t>(made.number)]);
        if (order > ShaderProgram::kMostOrder)
            throw Error("is a dependent read of order " + std::to_string(order) + ": must be of order " +
                        std::to_string(ShaderProgram::kMostOrder) +
                        " at most (one more than those whose registers it reads or writes again)");
        return order;
    }

    /// What has been written, and of which order the reads are that it depends on.
    void track(const ShaderInstruction& made, std::size_t sources) {
        if (made.mask == 0) return;
        std::uint8_t& mask = written(made.bank, made.number);
        if (made.bank == ShaderBank::temporary) {
            int& kept = m_order[static_cast<std::size_t>(made.number)];
            int order = samples(made.opcode) ? order_of(made) : made.mask == 15 ? 0 : kept;
            for (std::size_t k = 0; k < sources; ++k)
                if (made.sources[k].bank == ShaderBank::temporary)
                    order = std::max(order, m_order[static_cast<std::size_t>(made.sources[k].number)]);
            kept = order;
        }
        // Of the three components that sincos works in, those that it does not write are undefined.
        if (made.opcode == ShaderOpcode::sincos) mask &= 8;
        mask = static_cast<std::uint8_t>(mask | made.mask);
    }

    std::uint8_t& written(ShaderBank bank, int number) {
        return m_written[static_cast<std::size_t>(bank)][static_cast<std::size_t>(number)];
    }

    ShaderSlots m_slots;
    ShaderProgram m_program;
    bool m_versioned = false;
    std::set<int> m_defined;
    std::array<std::array<std::uint8_t, ShaderProgram::kConstants>, kBankCount> m_written{};
    std::array<int, ShaderProgram::kTemporaries> m_order{};
};

std::string text_of(const ShaderSource& source) {
    std::string text = source.negated ? "-" : "";
    text += register_name(source.bank, source.number);
    std::string swizzle;
    for (const std::uint8_t from : source.swizzle) swizzle += "xyzw"[from];
    if (swizzle == std::string(4, swizzle[0])) return text + "." + swizzle[0];
    return swizzle == "xyzw" ? text : text + "." + swizzle;
}

}  // namespace

ShaderProgram assemble_shader(std::string_view text, const std::string& name, const ShaderSlots& slots) {
    text_file::check_size(text, name);
    text = text_file::without_byte_order_mark(text);
    Assembler assembler(slots);
    ShaderProgram program;
    for (std::size_t number = 1;; ++number) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const bool is_last = end + 1 >= text.size();
        text_file::in_entry(name, "line " + std::to_string(number), [&] {
            assembler.line(text.substr(0, end));
            if (is_last) program = assembler.finish();
        });
        if (is_last) return program;
        text.remove_prefix(end + 1);
    }
}

std::string shader_listing(const ShaderProgram& program) {
    std::string text = "ps_2_0\n";
    const auto declare = [&](const char* bank, const auto& masks) {
        for (std::size_t n = 0; n < masks.size(); ++n)
            if (masks[n] != 0)
                text += "dcl " + std::string(bank) + std::to_string(n) + mask_text(masks[n]) + "\n";
    };
    declare("t", program.coordinates);
    declare("v", program.colors);
    for (int n = 0; n < ShaderProgram::kSamplers; ++n)
        if (program.samplers >> n & 1) text += "dcl_2d s" + std::to_string(n) + "\n";
    for (const ShaderConstant& c : program.constants) {
        text += "def c" + std::to_string(c.number);
        for (const double value : c.value) text += ", " + shortest(value);
        text += "\n";
    }
    for (const ShaderInstruction& i : program.instructions) {
        const OpcodeFacts& facts = facts_of(i.opcode);
        text += std::string(facts.name) + (i.saturated ? "_sat" : "") + (i.partial ? "_pp" : "");
        if (i.mask != 0) text += " " + register_name(i.bank, i.number) + mask_text(i.mask);
        for (std::size_t k = 0; k < facts.sources; ++k)
            text += (k == 0 && i.mask == 0 ? " " : ", ") + text_of(i.sources[k]);
        text += "\n";
    }
    return text;
}

}  // namespace anamorph::machine
