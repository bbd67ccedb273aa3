// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/sequence.h"

#include <algorithm>

#include "anamorph/operation/rows.h"
#include "anamorph/parameter/left_out.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {

ParameterTable rows::sequence(const std::string& numbers) {
    return {
        whole("frames", "", "", 1, Sequence::kMostFrames,
              "as many subimages, frames 0, 1 and so on of the key frames; by default up to the last key "
              "frame, and 1 without keys"),
        file("keys", "key frames of any numbers here" + numbers +
                         ", JSON: {\"keys\": {\"turn\": [[0, 0.1], [24, 0.9]]}}, each a frame and its "
                         "numbers; optional "
                         "\"interpolation\": step, linear, catmull_rom, or monotone_cubic, the default"),
    };
}

Sequence::Sequence(const OperationInput& input) : m_values(input.values) {
    if (const auto file = input.files.find("keys"); file != input.files.end())
        read_keys(input.reader.text(file->second.name), file->second.name);
    choose_frames();
}

ParameterValues Sequence::values_at(double time) const {
    ParameterValues values = m_values;
    values.set("frame", time);
    for (const NamedKeyFrames& keys : m_keys) values.set(keys.name, keys.frames.at(time));
    return values;
}

void Sequence::read_keys(const std::string& text, const std::string& name) {
    if (kIsSmall) refuse_left_out("keys=" + printable(name));
    m_keys = parse_key_frames_json(text, name);
    for (const NamedKeyFrames& keys : m_keys) {
        const ParameterTable& table = m_values.table();
        const auto row =
            std::find_if(table.begin(), table.end(), [&](const Parameter& p) { return p.name == keys.name; });
        const bool is_of_time = keys.name == "frame" || keys.name == "shutter";
        const bool number = row != table.end() && !is_of_time &&
                            (row->type == ParameterType::number || row->type == ParameterType::numbers);
        const auto& own = m_values.definitions();
        const bool defined =
            std::any_of(own.begin(), own.end(), [&](const Assignment& a) { return a.key == keys.name; });
        if ((!number || keys.name == "height_smooth") && !defined)
            text_file::fail(
                name, printable(keys.name),
                "is no key of numbers (but for whole ones, frame, shutter and height_smooth), and none "
                "that defines a name of a formula");
    }
}

void Sequence::choose_frames() {
    if (m_values.given("frame") && m_values.given("frames"))
        throw Error("frame", m_values.text("frame"), "must not be given together with frames");
    double last = 0;
    for (const NamedKeyFrames& keys : m_keys) last = std::max(last, keys.frames.times().back());
    if (m_values.given("frame"))
        m_first = m_values.number("frame");
    else if (m_values.given("frames"))
        m_frames = m_values.whole("frames");
    else if (last + 1 <= kMostFrames)
        m_frames = static_cast<int>(last) + 1;
    else
        throw Error::not_given("frames", " and the last key frame is " + shortest(last) +
                                             ": must be given where that is above " +
                                             std::to_string(kMostFrames - 1));
}

}  // namespace anamorph
