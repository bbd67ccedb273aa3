// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/face_files.h"

#include <algorithm>
#include <optional>

#include "anamorph/error.h"

namespace anamorph {
namespace {

constexpr std::string_view kFace = "{face}";

using Words = std::array<const char*, 6>;

/// A way of naming, in the order right, left, up, down, front, back of OpenGL's +x, -x, +y, -y, +z, -z.
struct Naming {
    Words words;
    /// Are they names of axes, or numbers of such, whose directions the layout says?
    bool are_axes;
    Projection layout = Projection::cubemap3x2;  ///< that of these names by default
};
constexpr Naming kNamings[] = {
    {{"px", "nx", "py", "ny", "pz", "nz"}, true},
    {{"posx", "negx", "posy", "negy", "posz", "negz"}, true},
    {{"+x", "-x", "+y", "-y", "+z", "-z"}, true, Projection::cubemap},
    {{"right", "left", "up", "down", "front", "back"}, false},
    {{"right", "left", "top", "bottom", "front", "back"}, false},
    {{"Right", "Left", "Up", "Down", "Front", "Back"}, false},
    {{"r", "l", "u", "d", "f", "b"}, false},
    {{"0", "1", "2", "3", "4", "5"}, true},
};

std::string list_of(const Words& words, const char* separator) {
    std::string list;
    for (const char* word : words) list += (list.empty() ? "" : separator) + std::string(word);
    return list;
}

std::string_view path_of(std::string_view name) {
    return name.substr(0, name.find('?'));
}

/// The name of a face's file.
std::string with_word(const std::string& name, const std::string& word) {
    std::string path(path_of(name));
    const std::string rest = name.substr(path.size());
    for (std::size_t at = 0; (at = path.find(kFace, at)) != std::string::npos; at += word.size())
        path.replace(at, kFace.size(), word);
    return path + rest;
}

std::array<std::string, 6> names_by(const Naming& naming, const std::string& name) {
    std::array<std::string, 6> names;
    std::transform(naming.words.begin(), naming.words.end(), names.begin(),
                   [&](const char* word) { return with_word(name, word); });
    return names;
}

/// The layout that is asked for, if one is.
std::optional<Projection> asked_layout(const ParameterValues& values) {
    if (!values.knows("from") || !values.given("from")) return {};
    const Projection from = projection_from_name(values.text("from"), "from");
    if (from != Projection::cubemap && from != Projection::cubemap3x2)
        throw Error("from", std::string(name_of(from)), "must be cubemap or cubemap3x2 of six files");
    return from;
}

/// Of six files none of whose namings is complete: which one is missing.
[[noreturn]] void throw_missing(const std::string& key, const std::string& name,
                                const std::function<bool(const std::string& name)>& exists) {
    const Naming* best = nullptr;
    std::ptrdiff_t most = 0;
    for (const Naming& naming : kNamings) {
        const std::array<std::string, 6> names = names_by(naming, name);
        const std::ptrdiff_t there = std::count_if(names.begin(), names.end(), exists);
        if (there > most) best = &naming;
        most = std::max(most, there);
    }
    if (!best)
        throw Error(
            key, printable(name),
            "there are no such files: must be six, with one of these in place of {face}: " + face_words());
    const std::array<std::string, 6> names = names_by(*best, name);
    const auto missing = std::find_if_not(names.begin(), names.end(), exists);
    throw Error(key, printable(name),
                "\"" + printable(*missing) + "\" is not there: must be six files, with " +
                    list_of(best->words, ", ") + " in place of {face}");
}

/// The pieces of a layout that the words of a naming stand for, in the words' order.
std::array<std::size_t, 6> pieces_of(const Naming& naming, Projection layout) {
    // OpenEXR's strip begins with its own +x, which is on the left.
    if (layout == Projection::cubemap && !naming.are_axes) return {1, 0, 2, 3, 4, 5};
    return {0, 1, 2, 3, 4, 5};
}

}  // namespace

bool has_face(std::string_view name) {
    return path_of(name).find(kFace) != std::string_view::npos;
}

std::string face_words() {
    std::string all;
    for (const Naming& naming : kNamings)
        all += (all.empty() ? "(" : ", (") + list_of(naming.words, " ") + ")";
    return all;
}

FaceFiles find_face_files(const std::string& key, const std::string& name, const ParameterValues& values,
                          const std::function<bool(const std::string& name)>& exists) {
    const Naming* found = nullptr;
    for (const Naming& naming : kNamings) {
        const std::array<std::string, 6> names = names_by(naming, name);
        if (!std::all_of(names.begin(), names.end(), exists)) continue;
        if (found)
            throw Error(key, printable(name),
                        "there are files for " + list_of(found->words, ", ") + " and for " +
                            list_of(naming.words, ", ") + ": must be one of them");
        found = &naming;
    }
    if (!found) throw_missing(key, name, exists);
    FaceFiles files{asked_layout(values).value_or(found->layout), {}, list_of(found->words, ", ")};
    const std::array<std::string, 6> names = names_by(*found, name);
    const std::array<std::size_t, 6> pieces = pieces_of(*found, files.layout);
    for (std::size_t i = 0; i < names.size(); ++i) files.names[pieces[i]] = names[i];
    return files;
}

}  // namespace anamorph
