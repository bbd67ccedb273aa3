// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/key_frames_file.h"

#include <array>
#include <utility>

#include "anamorph/parameter/json_file.h"

namespace anamorph {
namespace {

using text_file::excerpt;
using text_file::fail;
using text_file::in_entry;
using text_file::Json;

constexpr std::array<std::pair<const char*, KeyInterpolation>, 4> kInterpolations = {
    {{"step", KeyInterpolation::step},
     {"linear", KeyInterpolation::linear},
     {"catmull_rom", KeyInterpolation::catmull_rom},
     {"monotone_cubic", KeyInterpolation::monotone_cubic}}};

KeyInterpolation interpolation_of(const Json& json) {
    if (!json.contains("interpolation")) return KeyInterpolation::monotone_cubic;
    const Json name = json.member("interpolation");
    for (const auto& [known, interpolation] : kInterpolations)
        if (name.is_string() && name.string() == known) return interpolation;
    throw Error("must be one of step, linear, catmull_rom, monotone_cubic");
}

KeyFrames read_frames(const Json& list, KeyInterpolation interpolation) {
    if (!list.is_array() || list.empty() || list.size() > kMostKeyFrames)
        throw Error("must be a list of 1 to " + std::to_string(kMostKeyFrames) + " key frames");
    std::vector<double> times;
    std::vector<std::vector<double>> values;
    for (const Json& entry : list.entries()) {
        if (!entry.is_array() || entry.size() < 2 || !entry.all_numbers())
            throw Error("a key frame must be a list of numbers, the frame and one or more values");
        times.push_back(entry[0].number());
        values.emplace_back();
        for (std::size_t i = 1; i < entry.size(); ++i) values.back().push_back(entry[i].number());
    }
    return KeyFrames(std::move(times), std::move(values), interpolation);
}

}  // namespace

std::vector<NamedKeyFrames> parse_key_frames_json(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    const text_file::JsonFile file(text, name);
    const Json json = file.top();
    if (!json.is_object() || !json.contains("keys") || !json.member("keys").is_object() ||
        json.size() != (json.contains("interpolation") ? 2u : 1u))
        fail(name, "", "must be an object with keys and, if wanted, interpolation");
    KeyInterpolation interpolation{};
    in_entry(name, "interpolation", [&] { interpolation = interpolation_of(json); });
    std::vector<NamedKeyFrames> all;
    for (const auto& member : json.member("keys").members())
        in_entry(name, excerpt(member.first), [&] {
            all.push_back({member.first, read_frames(member.second, interpolation)});
        });
    return all;
}

}  // namespace anamorph
