// SPDX-License-Identifier: Apache-2.0
// gemmi reads such files too, but the headers of it that do (0.5.7) do not compile as C++20.
#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <map>
#include <numbers>
#include <optional>

#include "anamorph/figure/body/displacement.h"
#include "anamorph/figure/body/eigenvectors.h"
#include "anamorph/figure/body/elements.h"
#include "anamorph/figure/body/rotation.h"
#include "anamorph/figure/body/window_fit.h"
#include "anamorph/figure/files/cif_symmetry.h"
#include "anamorph/figure/files/motion_file.h"
#include "anamorph/figure/files/space_group.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

constexpr std::size_t kMostAtoms = 20000, kMostBonds = 500000, kMostOperations = 1000, kMostWarnings = 20;
/// The least length of a cell's edge, in Angstrom.
constexpr double kLeastLength = 0.1;
/// The radius of atoms without displacement, and the length that bonds may have beyond radii; Angstrom.
constexpr double kPlainRadius = 0.15, kBondSlack = 0.4;

/// The tags of the operations of symmetry, the newest one first; the last of modulated structures, in four dimensions or more.
constexpr std::string_view kOperations[] = {"_space_group_symop_operation_xyz", "_symmetry_equiv_pos_as_xyz",
                                            "_space_group_symop_ssg_operation_algebraic"};

// --- The file ----------------------------------------------------------------------------------------------

enum class TokenKind { end, data, loop, tag, value, other };

struct Token {
    TokenKind kind = TokenKind::end;
    std::string text;     ///< of tags in small letters
    bool quoted = false;  ///< "." and "?" then are themselves
    int line = 0;
};

/// Tokens of CIF 1.1.
class Tokens {
  public:
    explicit Tokens(std::string_view text) : m_text(text) {}

    Token next() {
        skip_blanks();
        Token token;
        token.line = m_line;
        if (m_at == m_text.size()) return token;
        const char c = m_text[m_at];
        if (c == ';' && (m_at == 0 || m_text[m_at - 1] == '\n'))
            token = text_field();
        else if (c == '\'' || c == '"')
            token = quoted(c);
        else
            token = word();
        return token;
    }

  private:
    static bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r') || c == '\0'; }

    void skip_blanks() {
        while (m_at < m_text.size()) {
            if (m_text[m_at] == '#')
                m_at = std::min(m_text.find('\n', m_at), m_text.size());
            else if (is_blank(m_text[m_at]))
                m_line += m_text[m_at++] == '\n';
            else
                return;
        }
    }
    Token text_field() {
        const std::size_t end = m_text.find("\n;", m_at);
        const std::size_t stop = std::min(end, m_text.size());
        Token token{TokenKind::value, std::string(m_text.substr(m_at + 1, stop - m_at - 1)), true, m_line};
        m_line += static_cast<int>(std::count(token.text.begin(), token.text.end(), '\n'));
        m_line += end != std::string_view::npos;
        m_at = end == std::string_view::npos ? m_text.size() : end + 2;
        return token;
    }
    /// A quote ends a text only before a blank; a text does not go beyond its line.
    Token quoted(char quote) {
        std::size_t end = m_at + 1;
        while (end < m_text.size() && m_text[end] != '\n' &&
               !(m_text[end] == quote && (end + 1 == m_text.size() || is_blank(m_text[end + 1]))))
            ++end;
        Token token{TokenKind::value, std::string(m_text.substr(m_at + 1, end - m_at - 1)), true, m_line};
        m_at = std::min(end + (end < m_text.size() && m_text[end] == quote), m_text.size());
        return token;
    }
    Token word() {
        std::size_t end = m_at;
        while (end < m_text.size() && !is_blank(m_text[end])) ++end;
        Token token{TokenKind::value, std::string(m_text.substr(m_at, end - m_at)), false, m_line};
        m_at = end;
        std::string lower = token.text;
        for (char& c : lower) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        if (lower[0] == '_') {
            token.kind = TokenKind::tag;
            token.text = lower;
        } else if (lower.starts_with("data_")) {
            token.kind = TokenKind::data;
        } else if (lower == "loop_") {
            token.kind = TokenKind::loop;
        } else if (lower.starts_with("save_") || lower == "global_" || lower == "stop_") {
            token.kind = TokenKind::other;
        }
        return token;
    }

    std::string_view m_text;
    std::size_t m_at = 0;
    int m_line = 1;
};

/// Values of one tag.
struct Column {
    std::vector<std::string> values;  ///< empty where a value is unknown
    std::vector<int> lines;           ///< of the values
};
/// The first structure's tags.
using CifBlock = std::map<std::string, Column>;

std::string known(const Token& token) {
    return !token.quoted && (token.text == "." || token.text == "?") ? std::string() : token.text;
}

/// The tags of a loop and their values, row by row; `token` is `loop_`, and then the one behind the loop.
void read_loop(Tokens& tokens, Token& token, CifBlock& block, std::string_view file) {
    const int line = token.line;
    token = tokens.next();
    std::vector<std::string> tags;
    for (; token.kind == TokenKind::tag; token = tokens.next()) tags.push_back(token.text);
    std::vector<Column*> columns;
    for (const std::string& tag : tags) {
        Column& column = block[tag];
        column = {};
        columns.push_back(&column);
    }
    std::size_t count = 0;
    for (; token.kind == TokenKind::value; token = tokens.next(), ++count) {
        if (columns.empty()) continue;
        Column& column = *columns[count % columns.size()];
        column.values.push_back(known(token));
        column.lines.push_back(token.line);
    }
    // Faults elsewhere in a file do not matter.
    const bool matters = std::any_of(tags.begin(), tags.end(), [](const std::string& tag) {
        return tag.starts_with("_atom_site_") ||
               std::count(std::begin(kOperations), std::end(kOperations), tag);
    });
    if (matters && count % columns.size() != 0)
        text_file::fail(file, "line " + std::to_string(line),
                        "a loop of " + std::to_string(tags.size()) + " tags ends before line " +
                            std::to_string(token.line) + ", after " + std::to_string(count) +
                            " values: must have whole rows");
}

CifBlock read_block(std::string_view text, std::string_view file) {
    Tokens tokens(text);
    CifBlock block;
    Token token = tokens.next();
    while (token.kind != TokenKind::end) {
        if (token.kind == TokenKind::data) {
            if (block.contains("_atom_site_fract_x")) break;
            block.clear();
            token = tokens.next();
        } else if (token.kind == TokenKind::loop) {
            read_loop(tokens, token, block, file);
        } else if (token.kind == TokenKind::tag) {
            const std::string tag = token.text;
            const int line = token.line;
            token = tokens.next();
            if (token.kind != TokenKind::value)
                text_file::fail(file, "line " + std::to_string(line), tag + " has no value");
            block[tag] = {{known(token)}, {token.line}};
            token = tokens.next();
        } else {
            token = tokens.next();
        }
    }
    return block;
}

// --- The structure -----------------------------------------------------------------------------------------

struct Atom {
    std::string label;
    const ChemicalElement* element = nullptr;
    Ellipsoid shape;                   ///< Angstrom, right-handed
    glm::dvec3 place{0.0};             ///< in fractions of the cell
    std::optional<glm::dmat3> tensor;  ///< mean square displacement, where it is anisotropic
    std::optional<double> isotropic;   ///< the same, where it is not and given

    /// How far its bonds reach.
    double bond_radius() const { return element ? element->covalent_radius + 0.5 * kBondSlack : 0; }
};

class Structure {
  public:
    Structure(std::string_view text, std::string_view file) : m_file(file) {
        text_file::check_size(text, file);
        m_block = read_block(text, file);
        read_cell();
        read_displacements();
        read_atoms();
        std::vector<SymmetryOperation> operations = read_operations();
        if (operations.empty()) operations = operations_of_group();
        find_flat_atoms();
        if (operations.size() > 1)
            expand(operations);
        else
            find_bonds();
    }

    std::vector<Atom> atoms;
    std::vector<CrystalBond> bonds;
    std::vector<std::string> warnings;

  private:
    void warn(const std::string& where, const std::string& what) {
        if (warnings.size() == kMostWarnings)
            warnings.push_back(printable(m_file) + ": and more of that kind");
        if (warnings.size() > kMostWarnings) return;
        warnings.push_back(printable(m_file) + ": " + where + ": " + what);
    }
    const Column* find(const std::string& tag) const {
        const auto found = m_block.find(tag);
        return found == m_block.end() ? nullptr : &found->second;
    }
    /// A number, without the uncertainty behind it: 1.234(5), or as some programs write it 1.234+5.
    double number(const std::string& tag, std::size_t row, double most) const {
        const Column& column = m_block.at(tag);
        std::string_view rest = column.values[row];
        double value = 0;
        const bool read = text_file::take_number(rest, value);
        if (!read || !(rest.empty() || rest[0] == '(' || rest[0] == '+') || !(std::fabs(value) <= most))
            text_file::fail(m_file, "line " + std::to_string(column.lines[row]),
                            tag + "=" + text_file::excerpt(column.values[row]) + ": must be a number from " +
                                shortest(-most) + " to " + shortest(most));
        return value;
    }
    std::optional<double> number_if_given(const std::string& tag, std::size_t row, double most) const {
        const Column* column = find(tag);
        if (!column || row >= column->values.size() || column->values[row].empty()) return std::nullopt;
        return number(tag, row, most);
    }

    /// The matrix that takes fractions of the cell to Angstrom: a along x, b in the x-y-plane.
    void read_cell() {
        double length[3], cosine[3], sine[3];
        static constexpr const char* kLengths[] = {"_cell_length_a", "_cell_length_b", "_cell_length_c"};
        static constexpr const char* kAngles[] = {"_cell_angle_alpha", "_cell_angle_beta",
                                                  "_cell_angle_gamma"};
        for (int c = 0; c < 3; ++c) {
            for (const char* tag : {kLengths[c], kAngles[c]})
                if (!number_if_given(tag, 0, 1e6)) text_file::fail(m_file, tag, "is missing");
            length[c] = number(kLengths[c], 0, 1e6);
            const double angle = number(kAngles[c], 0, 180) * kRadiansPerDegree;
            cosine[c] = std::cos(angle);
            sine[c] = std::sin(angle);
            if (!(length[c] >= kLeastLength)) text_file::fail(m_file, kLengths[c], "must be at least 0.1");
        }
        const double skew = (cosine[0] - cosine[1] * cosine[2]) / sine[2];
        const double height = std::sqrt(sine[1] * sine[1] - skew * skew);
        if (!(sine[2] > 1e-6 && height > 1e-6))
            text_file::fail(m_file, "_cell_angle_alpha", "the angles of the cell must span a volume");
        m_cell = {{length[0], 0, 0},
                  {length[1] * cosine[2], length[1] * sine[2], 0},
                  length[2] * glm::dvec3(cosine[1], skew, height)};
    }

    /// By label: U of the anisotropic atoms, in the axes of the cell, Angstrom^2. B = 8 pi^2 U.
    void read_displacements() {
        const Column* labels = find("_atom_site_aniso_label");
        if (!labels) return;
        static constexpr const char* kPairs[] = {"11", "22", "33", "12", "13", "23"};
        for (std::size_t row = 0; row < labels->values.size(); ++row) {
            std::array<double, 6> u{};
            bool all = true;
            for (std::size_t k = 0; k < 6; ++k) {
                auto value = number_if_given(std::string("_atom_site_aniso_u_") + kPairs[k], row, 1e6);
                if (!value) {
                    value = number_if_given(std::string("_atom_site_aniso_b_") + kPairs[k], row, 1e6);
                    if (value) *value /= kEightPiSquared;
                }
                all = all && value;
                u[k] = value.value_or(0);
            }
            if (all) m_aniso[labels->values[row]] = u;
        }
    }

    void read_atoms() {
        static constexpr const char* kPlaces[] = {"_atom_site_fract_x", "_atom_site_fract_y",
                                                  "_atom_site_fract_z"};
        const Column *x = find(kPlaces[0]), *labels = find("_atom_site_label");
        if (!x || !find(kPlaces[1]) || !find(kPlaces[2]) || !labels)
            text_file::fail(m_file, "", "has no loop of _atom_site_label and _atom_site_fract_x, y and z");
        const std::size_t rows = x->values.size();
        if (rows > kMostAtoms || labels->values.size() != rows)
            text_file::fail(m_file, kPlaces[0], "must have up to 20000 values, and as many labels");
        for (std::size_t row = 0; row < rows; ++row) {
            glm::dvec3 place;
            bool is_known = true;
            for (int c = 0; c < 3; ++c) {
                const auto value = number_if_given(kPlaces[c], row, 1e3);
                is_known = is_known && value;
                place[c] = value.value_or(0);
            }
            if (!is_known) continue;
            Atom atom;
            atom.label = labels->values[row];
            atom.element = element_of(row);
            atom.place = place;
            set_displacement(atom, row);
            atom.shape.center = m_cell * place;
            atoms.push_back(std::move(atom));
        }
        if (atoms.empty()) text_file::fail(m_file, "", "has no atom whose place is known");
    }

    const ChemicalElement* element_of(std::size_t row) const {
        const Column* types = find("_atom_site_type_symbol");
        const bool typed = types && row < types->values.size() && !types->values[row].empty();
        const std::string& text = typed ? types->values[row] : m_block.at("_atom_site_label").values[row];
        std::string symbol;
        for (const char c : text.substr(0, 2)) {
            if (!std::isalpha(static_cast<unsigned char>(c))) break;
            const auto letter = static_cast<unsigned char>(c);
            symbol += static_cast<char>(symbol.empty() ? std::toupper(letter) : std::tolower(letter));
        }
        const ChemicalElement* element = find_element(symbol);
        return element || symbol.empty() ? element : find_element(symbol.substr(0, 1));
    }

    /// Sets an atom's shape to that of U in the axes of the cell, whose lengths are those of the reciprocal
    /// cell: A N U N^T A^T.
    void set_displacement(Atom& atom, std::size_t row) const {
        const auto aniso = m_aniso.find(atom.label);
        if (aniso == m_aniso.end()) {
            auto u = number_if_given("_atom_site_u_iso_or_equiv", row, 1e6);
            if (!u) {
                u = number_if_given("_atom_site_b_iso_or_equiv", row, 1e6);
                if (u) *u /= kEightPiSquared;
            }
            atom.isotropic = u;
            atom.shape.axes = glm::dvec3(u && *u > 0 ? kHalfProbability * std::sqrt(*u) : kPlainRadius);
            return;
        }
        const std::array<double, 6>& u = aniso->second;
        const glm::dmat3 reciprocal = glm::transpose(glm::inverse(m_cell));
        glm::dmat3 scaled = m_cell;
        for (int c = 0; c < 3; ++c) scaled[c] *= glm::length(reciprocal[c]);
        const glm::dmat3 tensor({u[0], u[3], u[4]}, {u[3], u[1], u[5]}, {u[4], u[5], u[2]});
        set_tensor(atom, scaled * tensor * glm::transpose(scaled));
    }

    static void set_tensor(Atom& atom, const glm::dmat3& tensor) {
        atom.tensor = tensor;
        atom.shape.rotation = eigenvectors(tensor);
        // Where U is not positive definite the ellipsoid is flat, which find_flat_atoms() says.
        for (int c = 0; c < 3; ++c) {
            const glm::dvec3 axis = atom.shape.rotation[c];
            atom.shape.axes[c] = kHalfProbability * std::sqrt(std::max(glm::dot(axis, tensor * axis), 0.0));
        }
    }

    static std::string text_of_tensor(const glm::dmat3& u) {
        std::string text;
        for (const auto& [i, j] : {std::pair{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}})
            text += (text.empty() ? "" : ", ") + shortest(static_cast<float>(u[i][j]));
        return text;
    }

    /// Names the atoms whose U is not positive definite.
    void find_flat_atoms() {
        for (const Atom& atom : atoms) {
            if (atom.isotropic && *atom.isotropic < 0)
                warn(printable(atom.label), "U = " + shortest(static_cast<float>(*atom.isotropic)) +
                                                " is negative: the atom is drawn as a small sphere");
            const auto given = m_aniso.find(atom.label);
            if (!atom.tensor || given == m_aniso.end()) continue;
            const glm::dvec3& axis = atom.shape.rotation[2];
            const double least = glm::dot(axis, *atom.tensor * axis);
            const glm::dmat3& tensor = *atom.tensor;
            // A value that is all rounding is none.
            if (least > 1e-9 * (tensor[0][0] + tensor[1][1] + tensor[2][2])) continue;
            const std::array<double, 6>& u = given->second;
            warn(printable(atom.label),
                 "U11, U22, U33, U12, U13, U23 = " +
                     text_of_tensor({{u[0], u[3], u[4]}, {u[3], u[1], u[5]}, {u[4], u[5], u[2]}}) +
                     " is not positive definite (the least of its principal values is " +
                     shortest(static_cast<float>(least)) + "): the ellipsoid is drawn flat");
        }
    }

    /// The first value of the tags that is known.
    std::string text_of(std::initializer_list<const char*> tags, std::string* tag_of = nullptr) const {
        for (const char* tag : tags)
            if (const Column* column = find(tag);
                column && !column->values.empty() && !column->values[0].empty()) {
                if (tag_of) *tag_of = "line " + std::to_string(column->lines[0]) + ": " + tag;
                return column->values[0];
            }
        return "";
    }

    /// The operations, for a file that lists none, of the space group that it names; or none.
    std::vector<SymmetryOperation> operations_of_group() {
        SpaceGroupName name;
        std::string tag;
        name.number = text_of({"_space_group_it_number", "_symmetry_int_tables_number"}, &tag);
        name.short_name = text_of({"_space_group_name_h-m_alt", "_symmetry_space_group_name_h-m",
                                   "_space_group_name_h-m_full", "_space_group_name_h-m_ref"},
                                  &tag);
        name.hall = text_of({"_space_group_name_hall", "_symmetry_space_group_name_hall"},
                            name.short_name.empty() ? &tag : nullptr);
        name.alpha = number("_cell_angle_alpha", 0, 180);
        name.gamma = number("_cell_angle_gamma", 0, 180);
        if (tag.empty()) return {};
        SpaceGroup group = space_group(name);
        const std::string& said = !name.short_name.empty() ? name.short_name
                                  : !name.hall.empty()     ? name.hall
                                                           : name.number;
        if (group.operations.empty())
            warn(tag + "=" + text_file::excerpt(said),
                 "is no space group that is known, and no operations are listed: atoms are drawn as they are "
                 "listed");
        if (!group.one_of_two.empty())
            warn(tag + "=" + text_file::excerpt(said),
                 "has two origins, and no operations are listed: " + group.one_of_two + " is taken");
        return std::move(group.operations);
    }

    /// x,y,z and the others, in the order of the file; nothing where none is listed.
    std::vector<SymmetryOperation> read_operations() const {
        std::vector<SymmetryOperation> operations{{}};
        for (const std::string_view tag : kOperations)
            if (const Column* column = find(std::string(tag))) {
                if (std::all_of(column->values.begin(), column->values.end(),
                                std::mem_fn(&std::string::empty)))
                    continue;
                read_operations(std::string(tag), *column, operations);
                return operations;
            }
        return {};
    }

    void read_operations(const std::string& tag, const Column& column,
                         std::vector<SymmetryOperation>& operations) const {
        if (column.values.size() > kMostOperations)
            text_file::fail(m_file, tag, "must have up to 1000 values");
        for (std::size_t row = 0; row < column.values.size(); ++row) {
            const std::string& text = column.values[row];
            if (text.empty()) continue;
            text_file::in_entry(m_file, "line " + std::to_string(column.lines[row]) + ": " + tag, [&] {
                const SymmetryOperation operation =
                    symmetry_operation(tag == kOperations[2] ? of_average(text) : text);
                const bool same = operation.turn == glm::dmat3(1.0) && operation.shift == glm::dvec3(0.0);
                if (!same) operations.push_back(operation);
            });
        }
    }

    /// `-x1,1/2+x2,-x3,x4` of a modulated structure, for the average one: `-x,1/2+y,-z`.
    static std::string of_average(const std::string& text) {
        std::string average;
        int sums = 1;
        for (std::size_t i = 0; i < text.size(); ++i) {
            if (text[i] == ',' && ++sums == 4) break;
            const bool axis =
                text[i] == 'x' && i + 1 < text.size() && text[i + 1] >= '1' && text[i + 1] <= '3';
            average += axis ? "xyz"[text[++i] - '1'] : text[i];
        }
        return average;
    }

    /// All atoms of the cell, and their bonds.
    void expand(const std::vector<SymmetryOperation>& operations) {
        std::vector<glm::dvec3> places;
        std::vector<double> radii;
        for (const Atom& atom : atoms) {
            places.push_back(atom.place);
            radii.push_back(atom.bond_radius());
        }
        Crystal crystal;
        text_file::in_entry(m_file, "", [&] {
            crystal = crystal_of(places, radii, operations, m_cell, {kMostAtoms, kMostBonds});
        });
        std::vector<Atom> all;
        for (const CrystalSite& site : crystal.sites) {
            Atom atom = atoms[site.atom];
            atom.place = site.place;
            if (site.operation > 0) atom.label += "_" + std::to_string(site.operation + 1);
            if (site.operation > 0 && atom.tensor) {
                const glm::dmat3 turn = m_cell * operations[site.operation].turn * glm::inverse(m_cell);
                set_tensor(atom, turn * *atom.tensor * glm::transpose(turn));
            }
            atom.shape.center = m_cell * atom.place;
            all.push_back(std::move(atom));
        }
        atoms = std::move(all);
        bonds = std::move(crystal.bonds);
    }

    /// Finds the bonds between the atoms as they are listed.
    void find_bonds() {
        for (std::size_t i = 0; i < atoms.size(); ++i)
            for (std::size_t j = i + 1; j < atoms.size(); ++j) {
                const Atom &a = atoms[i], &b = atoms[j];
                const double most = a.bond_radius() + b.bond_radius();
                const glm::dvec3 d = a.shape.center - b.shape.center;
                if (!a.element || !b.element || !(glm::dot(d, d) < most * most)) continue;
                if (bonds.size() == kMostBonds)
                    text_file::fail(m_file, "",
                                    "atoms lie so close together that there are over 500000 bonds");
                bonds.push_back({i, j});
            }
    }

    static constexpr double kEightPiSquared = 8 * std::numbers::pi * std::numbers::pi;

    std::string_view m_file;
    CifBlock m_block;
    glm::dmat3 m_cell{1.0};
    std::map<std::string, std::array<double, 6>> m_aniso;
};

// --- The frame ---------------------------------------------------------------------------------------------

/// From Angstrom to the window.
WindowFit fit_of(const std::vector<Atom>& atoms) {
    glm::dvec3 least(HUGE_VAL), most(-HUGE_VAL);
    for (const Atom& atom : atoms) {
        const Ellipsoid& e = atom.shape;
        const glm::dvec3 reach(std::max({e.axes.x, e.axes.y, e.axes.z}));
        least = glm::min(least, e.center - reach);
        most = glm::max(most, e.center + reach);
    }
    return {least, most};
}

class CrystalMotion final : public Motion {
  public:
    CrystalMotion(std::string_view text, std::string_view name, double probability) {
        const double larger = displacement_scale(probability) / kHalfProbability;
        const Structure structure(text, name);
        m_warnings = structure.warnings;
        const std::vector<Atom>& atoms = structure.atoms;
        const WindowFit fit = fit_of(atoms);
        m_frame.number = 1;
        m_frame.figures = {"structure"};
        for (const Atom& atom : atoms) {
            Body body;
            body.name = atom.label;
            body.shape = fit.ellipsoid(atom.shape);
            // The view stays that of 1/2, and so do atoms without displacement.
            if (probability != 0.5 && (atom.tensor || (atom.isotropic && *atom.isotropic > 0)))
                body.shape.axes *= larger;
            if (atom.element) body.color = atom.element->color;
            m_frame.bodies.push_back(std::move(body));
        }
        for (const CrystalBond& bond : structure.bonds) {
            const Atom &a = atoms[bond.first], &b = atoms[bond.second];
            m_frame.joints.push_back({a.label + "-" + b.label, static_cast<int>(bond.first),
                                      static_cast<int>(bond.second),
                                      fit.point(0.5 * (a.shape.center + b.shape.center))});
        }
    }

    int last_frame() override { return 1; }
    FigureFrame frame(int number) override {
        if (number < 0 || number > 1)
            throw Error("frame", std::to_string(number), "must be 0 or 1: a structure has one frame");
        FigureFrame frame = m_frame;
        frame.number = number;
        return frame;
    }
    const std::vector<std::string>& warnings() const override { return m_warnings; }

  private:
    FigureFrame m_frame;
    std::vector<std::string> m_warnings;
};

}  // namespace

std::unique_ptr<Motion> read_cif(std::string_view text, std::string_view name, double probability) {
    return std::make_unique<CrystalMotion>(text, name, probability);
}

}  // namespace anamorph::figure
