// SPDX-License-Identifier: Apache-2.0
// The keywords of the language, in the order in which a shortened one is looked up.
#pragma once

#include <span>
#include <string_view>
#include <vector>

#include "anamorph/figure/language/program.h"

namespace anamorph::figure::script_table {

enum class Keyword {
    figure,
    ellipsoid,
    joint,
    limit,
    variables,
    subroutine,
    endsub,
    speed,
    view,
    debug,
    include,
    stop,
    distribution,  ///< a distribution, and `call` where a statement begins
    action,
    ignored,  ///< a statement or action that is passed over
    dead      ///< keywords of the first versions
};

struct Entry {
    std::string_view word;
    Keyword keyword;
    Distribution distribution = Distribution::repeat;
    Action action = Action::call;
    /// The kinds of an action's operands, a letter each: n number, v variable, e ellipsoid, j joint, J joint
    /// made here, f figure, F figure made here, a axis, s subroutine, i image, * anything.
    std::string_view operands = {};
    /// The operands as people read them: a name for each, after the word.
    std::string_view usage = {};
};

std::span<const Entry> entries();

/// The letters of an action's operands.
std::string_view operands_of(Action action);
/// The first entry that begins with `word` and can begin a statement; nullptr where there is none.
const Entry* find_statement(std::string_view word);
/// The first entry that begins with `word` and is an action or ignored; nullptr where there is none.
const Entry* find_action(std::string_view word);
/// Another entry that a shortened `word` may mean where `entry` is the first; nullptr where there is none.
const Entry* rival_of(const Entry& entry, std::string_view word, bool among_actions);
/// All words that may stand where an action does, or else where a statement begins.
std::vector<std::string_view> words(bool of_actions);
/// Whether `word` is a keyword, written in full.
bool is_keyword(std::string_view word);

}  // namespace anamorph::figure::script_table
