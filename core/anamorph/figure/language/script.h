// SPDX-License-Identifier: Apache-2.0
// Reads scripts of NUDES, the animation language of Herbison-Evans (Chapman 1986, section 2), into a Program.
// The core opens no files: a host hands over what it has read, and names for messages.
//
// A script is free text: tokens between blanks, `*` starts a comment, keywords may be shortened (the first in
// the order of the language's table that begins so is meant), `stop` ends it. Figure libraries are texts
// without `stop`, included in two ways: ahead of the script (ScriptOptions::libraries), or where it says
// `include NAME`, a statement that the original does not have.
//
//     declarations   figure F N ellipsoid{N}    ellipsoid E x y z    joint J E x y z E x y z
//                    limit J xmin xmax ymin ymax zmin zmax    variables N variable{N}
//                    subroutine S ... endsub S    speed k    view f0 f1    debug n    include NAME
//     movements      DISTRIBUTION f0 f1 ACTION operands    call f0 f1 S
//
// Operands are numbers and names; any of them may be a variable. In the classic dialect every statement
// begins on a new line, and what follows a complete one on its line is passed over with a warning;
// ellipsoids, joints and figures may also be named before they are declared, a `-` anywhere in a number turns
// its sign, and names that clash give warnings. In the strict dialect only subroutines may be named early,
// and these are errors: clashes of names, declaring something twice, negative axes, joints that form a ring,
// subroutines that call themselves, frames that run backwards.
//
// Subroutines of the strict dialect may have parameters: `subroutine S n parameter{n}`, and in calls
// `call f0 f1 S n value{n}`. Within S a parameter is what the call hands over, as if that stood in its place, in every
// frame: a number, a variable, which may be set, or the name of anything. It may have the name of nothing else.
//
// `debug n` with n of 0 or less makes a performance tell every action, as it does in the original, in words of ours.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/figure/language/program.h"

namespace anamorph::figure {

/// The largest size of a script and all that it includes, in bytes; longer ones are refused.
inline constexpr std::size_t kMaxScriptText = std::size_t{64} << 20;
/// The largest number of items of any kind in a program; programs with more are refused.
inline constexpr std::size_t kMaxScriptItems = std::size_t{1} << 20;

/// How severe a diagnostic is: a script with an error cannot be performed, one with warnings can.
enum class Severity { warning, error };

/// A fault of a script, and its place.
struct Diagnostic {
    Severity severity = Severity::error;
    std::string file;
    int line = 0, column = 0;     ///< counted from 1; columns are bytes
    std::string found, expected;  ///< the words found and expected; empty where they do not apply
    std::string message;
    std::string included_from;  ///< where an included file is included; empty otherwise

    /// The diagnostic as one line: "walk.n:12:5: error: found \"hed\", expected an ellipsoid".
    std::string text() const;
};

/// How a script is read, and how it finds the files that it includes.
struct ScriptOptions {
    Dialect dialect = Dialect::classic;
    /// Returns the text of an included file; nothing where there is no file of that name.
    std::function<std::optional<std::string>(const std::string& name)> include;
    std::vector<std::string> libraries;  ///< names of files to include ahead of the script
};

/// A program as it was read, and the diagnostics.
struct Script {
    Program program;  ///< to be performed only when ok()
    std::vector<Diagnostic> diagnostics;

    bool ok() const;
};

/// Reads a script. Never throws for errors of the script: those are in the diagnostics, several of them where reading
/// can go on.
Script parse_script(std::string_view text, std::string_view name, const ScriptOptions& options = {});

/// Reads a script and returns the program alone. Throws Error with the text of the first error.
Program parse_program(std::string_view text, std::string_view name, const ScriptOptions& options = {});

}  // namespace anamorph::figure
