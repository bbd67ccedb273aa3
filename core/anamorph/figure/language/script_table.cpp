// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/language/script_table.h"

#include <algorithm>

namespace anamorph::figure {
namespace script_table {
namespace {

constexpr Entry declaration(std::string_view word, Keyword keyword, std::string_view usage = {}) {
    return {word, keyword, Distribution::repeat, Action::call, {}, usage};
}

constexpr Entry distribution(std::string_view word, Distribution d) {
    return {word, Keyword::distribution, d, Action::call, {}, "frame frame action ..."};
}

constexpr Entry action(std::string_view word, Action a, std::string_view operands, std::string_view usage) {
    return {word, Keyword::action, Distribution::repeat, a, operands, usage};
}

/// `call` both begins a statement and is an action.
constexpr Entry call() {
    return {"call",
            Keyword::distribution,
            Distribution::call,
            Action::call,
            "s",
            "frame frame subroutine [count value ...]"};
}

constexpr Entry kEntries[] = {
    declaration("figure", Keyword::figure, "name count ellipsoid ..."),
    declaration("ellipsoid", Keyword::ellipsoid, "name x y z"),
    declaration("joint", Keyword::joint, "name ellipsoid x y z ellipsoid x y z"),
    declaration("copy", Keyword::dead),
    distribution("accelerate", Distribution::accelerate),
    declaration("subroutine", Keyword::subroutine, "name [count parameter ...]"),
    action("balance", Action::balance, "ejea", "ellipsoid joint ellipsoid axis"),
    action("attach", Action::attach, "eJennn", "ellipsoid new-joint ellipsoid x y z"),
    action("detach", Action::detach, "ejF", "ellipsoid joint new-figure"),
    distribution("decelerate", Distribution::decelerate),
    action("grofig", Action::grofig, "fennn", "figure ellipsoid x y z"),
    action("spinto", Action::spinto, "feennn", "figure ellipsoid ellipsoid angle angle angle"),
    action("moveby", Action::moveby, "fennn", "figure ellipsoid x y z"),
    action("add", Action::add, "vnn", "variable number number"),
    action("touch", Action::touch, "eeeeja", "ellipsoid ellipsoid ellipsoid ellipsoid joint axis"),
    declaration("stop", Keyword::stop),
    action("spinby", Action::spinby, "feena", "figure ellipsoid ellipsoid angle axis"),
    action("ground", Action::ground, "f", "figure"),
    action("bendby", Action::bendby, "ejena", "ellipsoid joint ellipsoid angle axis"),
    action("set", Action::set, "v*", "variable value"),
    action("bendto", Action::bendto, "ejennn", "ellipsoid joint ellipsoid angle angle angle"),
    declaration("debug", Keyword::debug, "number"),
    distribution("repeat", Distribution::repeat),
    distribution("quadratic", Distribution::quadratic),
    distribution("linear", Distribution::linear),
    action("observe", Action::observe, "nnn", "angle angle angle"),
    action("moveto", Action::moveto, "fennn", "figure ellipsoid x y z"),
    call(),
    declaration("endsub", Keyword::endsub, "subroutine"),
    declaration("speed", Keyword::speed, "number"),
    action("invert", Action::invert, "v", "variable"),
    declaration("variables", Keyword::variables, "count name ..."),
    declaration("view", Keyword::view, "frame frame"),
    action("groell", Action::groell, "ennn", "ellipsoid x y z"),
    action("grojnt", Action::grojnt, "ejnnn", "ellipsoid joint x y z"),
    action("angles", Action::angles, "eevvv", "ellipsoid ellipsoid variable variable variable"),
    action("centre", Action::centre, "evvv", "ellipsoid variable variable variable"),
    action("flex", Action::flex, "ejn", "ellipsoid joint angle"),
    action("rotate", Action::rotate, "ejn", "ellipsoid joint angle"),
    action("abduct", Action::abduct, "ejn", "ellipsoid joint angle"),
    action("negate", Action::negate, "v", "variable"),
    action("subtract", Action::subtract, "vnn", "variable number number"),
    action("divide", Action::divide, "vnn", "variable number number"),
    action("multiply", Action::multiply, "vnn", "variable number number"),
    declaration("read", Keyword::dead),
    distribution("cubic", Distribution::cubic),
    action("place", Action::place, "nnn", "x y z"),
    action("axes", Action::axes, "evvv", "ellipsoid variable variable variable"),
    action("linkx", Action::linkx, "jvvv", "joint variable variable variable"),
    action("colour", Action::colour, "ennn", "ellipsoid red green blue"),
    action("print", Action::print, "v", "variable"),
    action("texture", Action::texture, "einn", "ellipsoid picture x y"),
    action("drag", Action::drag, "eejea", "ellipsoid ellipsoid joint ellipsoid axis"),
    declaration("limit", Keyword::limit, "joint xmin xmax ymin ymax zmin zmax"),
    action("abut", Action::abut, "eeea", "ellipsoid ellipsoid ellipsoid axis"),
    action("movjnt", Action::movjnt, "jennn", "joint ellipsoid x y z"),
    // The interpreter of 2005 added these.
    action("growto", Action::growto, "fennn", "figure ellipsoid x y z"),
    action("color", Action::colour, "ennn", "ellipsoid red green blue"),
    action("center", Action::centre, "evvv", "ellipsoid variable variable variable"),
    declaration("opacty", Keyword::ignored),
    declaration("lghtng", Keyword::ignored),
    action("allow", Action::allow, "ee", "ellipsoid ellipsoid"),
    action("forbid", Action::forbid, "ee", "ellipsoid ellipsoid"),
    declaration("include", Keyword::include, "file"),
};

bool begins_statement(const Entry& entry) {
    return entry.keyword != Keyword::action;
}

bool is_action(const Entry& entry) {
    return !entry.operands.empty() || entry.keyword == Keyword::ignored;
}

template <class Allowed>
const Entry* first_with(std::string_view word, const Allowed& allowed) {
    if (word.empty()) return nullptr;
    for (const Entry& entry : kEntries)
        if (entry.word.starts_with(word) && allowed(entry)) return &entry;
    return nullptr;
}

}  // namespace

std::span<const Entry> entries() {
    return kEntries;
}

std::string_view operands_of(Action action) {
    for (const Entry& entry : kEntries)
        if (!entry.operands.empty() && entry.action == action) return entry.operands;
    return {};
}

const Entry* find_statement(std::string_view word) {
    return first_with(word, begins_statement);
}

const Entry* find_action(std::string_view word) {
    return first_with(word, is_action);
}

const Entry* rival_of(const Entry& entry, std::string_view word, bool among_actions) {
    if (word == entry.word) return nullptr;
    return first_with(word, [&](const Entry& other) {
        const bool same = other.keyword == entry.keyword && other.distribution == entry.distribution &&
                          other.action == entry.action;
        return (among_actions ? is_action(other) : begins_statement(other)) &&
               other.keyword != Keyword::dead && !same;
    });
}

std::vector<std::string_view> words(bool of_actions) {
    std::vector<std::string_view> all;
    for (const Entry& entry : kEntries)
        if ((of_actions ? is_action(entry) : begins_statement(entry)) && entry.keyword != Keyword::dead)
            all.push_back(entry.word);
    return all;
}

bool is_keyword(std::string_view word) {
    return std::any_of(std::begin(kEntries), std::end(kEntries),
                       [&](const Entry& entry) { return entry.word == word; });
}

}  // namespace script_table

const char* name_of(Action action) {
    for (const auto& entry : script_table::entries())
        if (!entry.operands.empty() && entry.action == action) return entry.word.data();
    return "";
}

const char* name_of(Distribution distribution) {
    for (const auto& entry : script_table::entries())
        if (entry.keyword == script_table::Keyword::distribution && entry.distribution == distribution)
            return entry.word.data();
    return "";
}

}  // namespace anamorph::figure
