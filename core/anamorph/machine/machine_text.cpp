// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/machine_text.h"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/parameter/json_file.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::machine {
namespace {

using text_file::Json;

/// The members of an object. Errors name the parameter and the key.
class MachineMembers {
  public:
    /// Throws Error unless `text` is `preset`, with keys or without, or an object. `more`: what else might have been given.
    MachineMembers(std::string_view text, const std::string& preset, const std::string& more = "") {
        if (text == preset) return;
        if (text.starts_with(preset + ":")) {
            read_list(text.substr(preset.size() + 1));
            return;
        }
        if (!text_file::trimmed(text).starts_with('{'))
            throw Error("machine", printable(text),
                        "must be " + preset + ", " + preset +
                            ":key=value,key=value or an object of JSON, {...}" + more);
        m_json = text_file::JsonFile(text, "machine");
    }

    template <class Number>
    void read(const NumberRow& row, Number& value) {
        if (const auto json = member(row.name)) {
            if (!json->is_number() || !row.holds(json->number())) refuse(row.name, *json, row.range());
            value = static_cast<Number>(json->number());
        }
    }
    void read(const char* key, bool& value) {
        if (const auto json = member(key)) {
            if (!json->is_boolean()) refuse(key, *json, "true or false");
            value = json->boolean();
        }
    }
    /// One of `formats`.
    void read(const char* key, NumberFormat& value, const std::vector<NumberFormat>& formats) {
        std::map<std::string, NumberFormat> words;
        for (const NumberFormat& format : formats) words[name_of(format)] = format;
        read(key, value, words);
    }
    template <class Value>
    void read(const char* key, Value& value, const std::map<std::string, Value>& words) {
        if (const auto json = member(key)) {
            const auto found = json->is_string() ? words.find(json->string()) : words.end();
            if (found == words.end()) {
                std::string names;
                for (const auto& [name, meaning] : words) names += (names.empty() ? "" : ", ") + name;
                refuse(key, *json, "one of " + names);
            }
            value = found->second;
        }
    }
    /// After all were read: throws Error where there are others.
    void finish() const {
        std::string names;
        for (const std::string& key : m_known) names += (names.empty() ? "" : ", ") + key;
        for (const auto& [key, value] : m_json.top().members())
            if (std::find(m_known.begin(), m_known.end(), key) == m_known.end())
                throw Error("machine: \"" + text_file::excerpt(key) + "\": no such key; the keys are " +
                            names);
    }

  private:
    /// key=value,key=value: numbers, true, false and words.
    void read_list(std::string_view list) {
        for (const std::string_view field : text_file::fields_of(list)) {
            const std::size_t sign = field.find('=');
            const std::string key(field.substr(0, sign));
            if (sign == std::string_view::npos || m_json.top().contains(key))
                throw Error("machine", printable(field), "must be key=value, each key once");
            const std::string_view value = field.substr(sign + 1);
            std::string_view rest = value;
            double number = 0;
            if (text_file::take_number(rest, number) && rest.empty())
                m_json.set(key, number);
            else if (value == "true" || value == "false")
                m_json.set(key, value == "true");
            else
                m_json.set(key, value);
        }
    }

    std::optional<Json> member(const char* key) {
        m_known.emplace_back(key);
        if (!m_json.top().contains(key)) return {};
        return m_json.top().member(key);
    }
    [[noreturn]] static void refuse(const std::string& key, const Json& value, const std::string& rule) {
        // As it was written in a list: JSON has no name for what is no number.
        const std::string text = value.is_float() ? shortest(value.number()) : value.text();
        throw Error("machine: " + key, text_file::excerpt(text), "must be " + rule);
    }

    text_file::JsonFile m_json;
    std::vector<std::string> m_known;
};

const std::vector<NumberFormat>& arithmetics() {
    static const std::vector<NumberFormat> all = {kFloat16, kFloat24, kFloat32, kFixed16, kFixed32};
    return all;
}

void read_shader_keys(MachineMembers& members, ShaderUnit& unit) {
    members.read("arithmetic", unit.arithmetic, arithmetics());
    members.read("texel", unit.texel, {kSigned8, kSigned16, kFloat16, kFloat32});
    members.read(kTableSizeRow, unit.table_size);
    members.read(kTableWeightRow, unit.weight_bits);
    members.read(kShaderAddressRow, unit.address_bits);
    members.read(kShaderTextureRow, unit.texture_side);
}

}  // namespace

BumpUnit bump_unit_from_text(std::string_view text) {
    BumpUnit unit;
    MachineMembers members(text, kBumpPreset);
    std::map<std::string, BumpCard> cards;
    for (const BumpCard card : kBumpCards) cards[name_of(card)] = card;
    members.read("card", unit.card, cards);
    unit.texel = texel_of(unit.card);
    using Projecting = BumpUnit::Projecting;
    members.read("projecting", unit.projecting,
                 {{"vertex", Projecting::vertex}, {"pixel", Projecting::pixel}});
    members.read(kPlanesRow, unit.planes.count);
    members.read(kPlaneXRow, unit.planes.x_max);
    members.read(kPlaneYRow, unit.planes.y_max);
    members.read(kBumpSizeRow, unit.size);
    members.read("texel", unit.texel, {kSigned8, kSigned16, kFloat16, kFloat32});
    members.read("scaled", unit.scaled);
    members.read(kBumpWeightRow, unit.weight_bits);
    members.read("edge", unit.edge, {{"clamp", BumpUnit::Edge::clamp}, {"border", BumpUnit::Edge::border}});
    members.read("arithmetic", unit.arithmetic, arithmetics());
    members.read(kBumpAddressRow, unit.address_bits);
    members.read(kTextureSideRow, unit.texture_side);
    members.finish();
    check_card(unit);
    return unit;
}

ShaderUnit shader_unit_from_text(std::string_view text) {
    ShaderUnit unit;
    const bool printed = text == kPrintedPreset || text.starts_with(std::string(kPrintedPreset) + ":");
    if (printed) unit.layout = ShaderLayout::printed;
    MachineMembers members(text, printed ? kPrintedPreset : kShaderPreset,
                           ", or " + std::string(kPrintedPreset) + " likewise");
    read_shader_keys(members, unit);
    if (printed) members.read(kShaderAlphaRow, unit.alpha);
    members.finish();
    return unit;
}

MorphUnit morph_unit_from_text(std::string_view text) {
    MorphUnit unit;
    MachineMembers members(text, kPrintedPreset);
    read_shader_keys(members, unit.shader);
    members.read(kMorphCellsRow, unit.cells);
    members.read(kMorphLevelsRow, unit.levels);
    members.read("buffer", unit.buffer,
                 {{"X8R8G8B8", kUnsigned8}, {"A16B16G16R16", kUnsigned16}, {"float32", kFloat32}});
    members.finish();
    return unit;
}

BlockMachine block_machine_from_text(std::string_view text) {
    BlockMachine machine;
    MachineMembers members(text, kBlockPreset);
    members.read(kClockRow, machine.clock_mhz);
    members.read(kProcessorsRow, machine.processors);
    members.read(kMultipliersRow, machine.multipliers);
    members.read(kDivisionRow, machine.division_cycles);
    double products = kSurfaceRow.standard;
    members.read(kSurfaceRow, products);
    if (!std::isnan(products)) machine.surface_multiplies = static_cast<int>(products);
    members.read(kFunctionRow, machine.function_multiplies);
    members.read(kBucketsRow, machine.buckets);
    members.read(kSortRow, machine.sort_cycles);
    members.read("coordinates", machine.coordinates, {kFloat16, kFloat24, kFloat32});
    members.read("coefficients", machine.coefficients, {kFloat16, kFloat24, kFloat32});
    members.read(kHostRow, machine.host_cycles);
    members.read(kSetupRow, machine.block_cycles);
    members.read(kSegmentCyclesRow, machine.segment_cycles);
    members.read(kSegmentRow, machine.segment);
    members.read(kPixelUnitsRow, machine.pixel_units);
    members.read(kAddressBitsRow, machine.address_bits);
    members.read(kFractionBitsRow, machine.fraction_bits);
    members.read("addresses", machine.addresses,
                 {{"segments", Addressing::segments},
                  {"repeated", Addressing::repeated},
                  {"direct", Addressing::direct}});
    members.read("hidden", machine.hidden, {{"sort", Hiding::sort}, {"z-buffer", Hiding::z_buffer}});
    members.read(kDepthBitsRow, machine.depth_bits);
    members.read(kTapWeightRow, machine.weight_bits);
    members.read(kTexelBitsRow, machine.texel_bits);
    members.read(kLightBitsRow, machine.light_bits);
    members.read(kFrameClockRow, machine.frame_clock_ms);
    members.read(kOkaBlockRow, machine.block);
    members.read(kOkaOverlapRow, machine.overlap);
    members.finish();
    // With fewer, every address but those of the first texel is beyond the range.
    if (const int most = machine.address_bits - 2; machine.fraction_bits > most)
        throw Error("machine: fraction_bits", std::to_string(machine.fraction_bits),
                    "must be at most " + std::to_string(most) + " with address_bits=" +
                        std::to_string(machine.address_bits) + ", as an address has a sign and whole texels");
    return machine;
}

}  // namespace anamorph::machine
