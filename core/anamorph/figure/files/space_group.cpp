// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/files/space_group.h"

#include <algorithm>
#include <cctype>
#include <gemmi/symmetry.hpp>
#include <string_view>

#include "anamorph/parameter/text_file.h"

namespace anamorph::figure {
namespace {

const auto& table() {
    return gemmi::spacegroup_tables::main;
}

/// A symbol with one blank for several and for `_`, in small letters.
std::string spaced(std::string_view symbol) {
    std::string text;
    for (const char c : symbol)
        if (c != '_' && !std::isspace(static_cast<unsigned char>(c)))
            text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        else if (!text.empty() && text.back() != ' ')
            text += ' ';
    return std::string(text_file::trimmed(text));
}

/// Without blanks.
std::string plain(std::string_view symbol) {
    std::string text;
    for (const char c : symbol)
        if (c != '_' && !std::isspace(static_cast<unsigned char>(c)))
            text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// A file may leave blanks out where no other group is meant then, as `P 3 2` would be by `P 32`.
const gemmi::SpaceGroup* by_hall(const std::string& symbol) {
    const gemmi::SpaceGroup* without_blanks = nullptr;
    int count = 0;
    for (const gemmi::SpaceGroup& group : table()) {
        if (spaced(group.hall) == spaced(symbol)) return &group;
        if (plain(group.hall) != plain(symbol)) continue;
        // Settings of one group may share a symbol.
        count += !without_blanks || spaced(group.hall) != spaced(without_blanks->hall);
        if (!without_blanks) without_blanks = &group;
    }
    return count == 1 ? without_blanks : nullptr;
}

const gemmi::SpaceGroup* by_symbol(std::string_view symbol, const SpaceGroupName& name) {
    symbol = text_file::trimmed(symbol);
    const std::string text(symbol);
    // gemmi takes numbers for names too.
    if (text.empty() || std::isdigit(static_cast<unsigned char>(text[0]))) return nullptr;
    if (const auto* group = gemmi::find_spacegroup_by_name(text, name.alpha, name.gamma)) return group;
    // Origins and axes behind a blank, as ICSD and others write them.
    constexpr std::string_view kLetters = "SZHR12", kExtensions = "12HR12";
    const std::size_t at =
        kLetters.find(static_cast<char>(std::toupper(static_cast<unsigned char>(text.back()))));
    if (at == std::string_view::npos) return nullptr;
    return gemmi::find_spacegroup_by_name(text.substr(0, text.size() - 1) + ":" + kExtensions[at]);
}

const gemmi::SpaceGroup* by_number(std::string_view text, const SpaceGroupName& name) {
    double number = 0;
    text = text_file::trimmed(text);
    if (!text_file::take_number(text, number) || !text.empty()) return nullptr;
    for (const gemmi::SpaceGroup& group : table())
        if (group.number == number) return group.ext == 'H' ? by_symbol(group.hm, name) : &group;
    return nullptr;
}

SymmetryOperation operation_of(const gemmi::Op& op) {
    SymmetryOperation operation;
    for (int row = 0; row < 3; ++row) {
        const auto r = static_cast<std::size_t>(row);
        for (int column = 0; column < 3; ++column)
            operation.turn[column][row] =
                static_cast<double>(op.rot[r][static_cast<std::size_t>(column)]) / gemmi::Op::DEN;
        operation.shift[row] = static_cast<double>(op.tran[r]) / gemmi::Op::DEN;
    }
    return operation;
}

/// Does it end in `:1`, ` Z` or the like?
bool says_origin(const std::string& symbol, const SpaceGroupName& name) {
    const std::string text(text_file::trimmed(symbol));
    return text.find(':') != std::string::npos ||
           !gemmi::find_spacegroup_by_name(text, name.alpha, name.gamma);
}

}  // namespace

SpaceGroup space_group(const SpaceGroupName& name) {
    const bool by_its_hall = !name.hall.empty(), named = !name.short_name.empty();
    const gemmi::SpaceGroup* group = by_its_hall ? by_hall(name.hall) : nullptr;
    if (!group) group = named ? by_symbol(name.short_name, name) : by_number(name.number, name);
    SpaceGroup found;
    if (!group) return found;
    const gemmi::GroupOps all = group->operations();
    for (const gemmi::Op op : all) found.operations.push_back(operation_of(op));
    const bool open = group->ext == '1' && !(by_its_hall && by_hall(name.hall)) &&
                      !(named && says_origin(name.short_name, name));
    if (open) found.one_of_two = group->xhm();
    return found;
}

}  // namespace anamorph::figure
