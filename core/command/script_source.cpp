// SPDX-License-Identifier: Apache-2.0
#include "script_source.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iostream>

#include "anamorph/error.h"
#include "anamorph/figure/files/motion_file.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph::command {
using namespace figure;
namespace {

/// At most one byte more than a file may have: the parser says what is wrong with it.
std::string read_all(std::istream& in, const std::string& name, std::size_t most = kMaxScriptText) {
    std::string text;
    char block[1 << 16];
    while (text.size() <= most && in.read(block, sizeof block).gcount() > 0)
        text.append(block, static_cast<std::size_t>(in.gcount()));
    if (in.bad()) throw Error("cannot read " + name);
    return text;
}

/// `any`: pipes and devices, too.
std::optional<std::string> read_file(const std::string& path, bool any, std::size_t most = kMaxScriptText) {
    std::error_code error;
    if (any ? std::filesystem::is_directory(path, error) : !std::filesystem::is_regular_file(path, error))
        return std::nullopt;
    std::ifstream in(path, std::ios::binary);
    if (!in) return std::nullopt;
    return read_all(in, path, most);
}

}  // namespace

Script read_script(const ScriptSource& source) {
    const bool standard = source.path == "-";
    ScriptOptions options;
    options.dialect = source.dialect;
    options.libraries = source.libraries;
    options.include = [&](const std::string& name) {
        const auto& libraries = source.libraries;
        if (std::find(libraries.begin(), libraries.end(), name) != libraries.end())
            return read_file(name, true);
        const std::filesystem::path folder =
            standard ? std::filesystem::path() : std::filesystem::path(source.path).parent_path();
        return read_file((folder / name).string(), false);
    };
    if (standard) return parse_script(read_all(std::cin, "the standard input"), "stdin", options);
    const std::optional<std::string> text = read_file(source.path, true);
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
