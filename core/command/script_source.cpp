// SPDX-License-Identifier: Apache-2.0
#include "script_source.h"

#include <algorithm>
#include <filesystem>
#include <iostream>

#include "anamorph/error.h"
#include "anamorph/figure/files/motion_file.h"
#include "anamorph/parameter/text_file.h"
#include "input_file.h"

namespace anamorph::command {
using namespace figure;
Script read_script(const ScriptSource& source) {
    const bool standard = source.path == "-";
    ScriptOptions options;
    options.dialect = source.dialect;
    options.libraries = source.libraries;
    options.include = [&](const std::string& name) {
        const auto& libraries = source.libraries;
        if (std::find(libraries.begin(), libraries.end(), name) != libraries.end())
            return read_file(name, true, kMaxScriptText);
        const std::filesystem::path folder =
            standard ? std::filesystem::path() : std::filesystem::path(source.path).parent_path();
        return read_file((folder / name).string(), false, kMaxScriptText);
    };
    // The parser says what is wrong with a text that is too long.
    if (standard)
        return parse_script(read_all(std::cin, "the standard input", kMaxScriptText), "stdin", options);
    const std::optional<std::string> text = read_file(source.path, true, kMaxScriptText);
    if (!text) throw Error("cannot read " + source.path);
    return parse_script(*text, source.path, options);
}

std::unique_ptr<Motion> open_motion(const ScriptSource& source, const PerformanceOptions& options) {
    if (is_motion_file(source.path)) {
        const std::optional<std::string> text = read_file(source.path, true, text_file::kMostBytes);
        if (!text) throw Error("cannot read " + source.path);
        return read_motion(*text, source.path);
    }
    Script script = read_script(source);
    for (const Diagnostic& d : script.diagnostics)
        if (d.severity == Severity::error) throw Error(d.text());
    return std::make_unique<Performance>(std::move(script.program), options);
}

}  // namespace anamorph::command
