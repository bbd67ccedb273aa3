// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/script_table.h"

#include <algorithm>

namespace anamorph {
namespace script_table {
namespace {

constexpr Entry declaration(std::string_view word, Keyword keyword) {
    return {word, keyword};
}

constexpr Entry distribution(std::string_view word, Distribution d) {
    return {word, Keyword::distribution, d};
}

constexpr Entry action(std::string_view word, Action a, std::string_view operands) {
    return {word, Keyword::action, Distribution::repeat, a, operands};
}

/// `call` both begins a statement and is an action.
constexpr Entry call() {
    return {"call", Keyword::distribution, Distribution::call, Action::call, "s"};
}

constexpr Entry kEntries[] = {
    declaration("figure", Keyword::figure),
    declaration("ellipsoid", Keyword::ellipsoid),
    declaration("joint", Keyword::joint),
    declaration("copy", Keyword::dead),
    distribution("accelerate", Distribution::accelerate),
    declaration("subroutine", Keyword::subroutine),
    action("balance", Action::balance, "ejea"),
    action("attach", Action::attach, "eJennn"),
    action("detach", Action::detach, "ejF"),
    distribution("decelerate", Distribution::decelerate),
    action("grofig", Action::grofig, "fennn"),
    action("spinto", Action::spinto, "feennn"),
    action("moveby", Action::moveby, "fennn"),
    action("add", Action::add, "vnn"),
    action("touch", Action::touch, "eeeeja"),
    declaration("stop", Keyword::stop),
    action("spinby", Action::spinby, "feena"),
    action("ground", Action::ground, "f"),
    action("bendby", Action::bendby, "ejena"),
    action("set", Action::set, "v*"),
    action("bendto", Action::bendto, "ejennn"),
    declaration("debug", Keyword::debug),
    distribution("repeat", Distribution::repeat),
    distribution("quadratic", Distribution::quadratic),
    distribution("linear", Distribution::linear),
    action("observe", Action::observe, "nnn"),
    action("moveto", Action::moveto, "fennn"),
    call(),
    declaration("endsub", Keyword::endsub),
    declaration("speed", Keyword::speed),
    action("invert", Action::invert, "v"),
    declaration("variables", Keyword::variables),
    declaration("view", Keyword::view),
    action("groell", Action::groell, "ennn"),
    action("grojnt", Action::grojnt, "ejnnn"),
    action("angles", Action::angles, "eevvv"),
    action("centre", Action::centre, "evvv"),
    action("flex", Action::flex, "ejn"),
    action("rotate", Action::rotate, "ejn"),
    action("abduct", Action::abduct, "ejn"),
    action("negate", Action::negate, "v"),
    action("subtract", Action::subtract, "vnn"),
    action("divide", Action::divide, "vnn"),
    action("multiply", Action::multiply, "vnn"),
    declaration("read", Keyword::dead),
    distribution("cubic", Distribution::cubic),
    action("place", Action::place, "nnn"),
    action("axes", Action::axes, "evvv"),
    action("linkx", Action::linkx, "jvvv"),
    action("colour", Action::colour, "ennn"),
    action("print", Action::print, "v"),
    action("texture", Action::texture, "einn"),
    action("drag", Action::drag, "eejea"),
    declaration("limit", Keyword::limit),
    action("abut", Action::abut, "eeea"),
    action("movjnt", Action::movjnt, "jennn"),
    // The interpreter of 2005 added these.
    action("growto", Action::growto, "fennn"),
    action("color", Action::colour, "ennn"),
    action("center", Action::centre, "evvv"),
    declaration("opacty", Keyword::ignored),
    declaration("lghtng", Keyword::ignored),
    action("allow", Action::allow, "ee"),
    action("forbid", Action::forbid, "ee"),
    declaration("include", Keyword::include),
};

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

const Entry* find_statement(std::string_view word) {
    return first_with(word, [](const Entry& entry) { return entry.keyword != Keyword::action; });
}

const Entry* find_action(std::string_view word) {
    return first_with(word, [](const Entry& entry) {
        return !entry.operands.empty() || entry.keyword == Keyword::ignored;
    });
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

}  // namespace anamorph
