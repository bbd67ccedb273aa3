// SPDX-License-Identifier: Apache-2.0
#include "anamorph/deform/deformation_file.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "anamorph/parameter/json_file.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

using text_file::excerpt;
using text_file::fail;
using text_file::in_entry;
using text_file::Json;

constexpr char kColumns[] = "center_u,center_v,extent_u,extent_v,x,y,z,kernel,enabled";
constexpr char kDepthColumns[] = ",center_w,extent_w,side";
constexpr char kEntryColumns[] =
    ",orientation_w,orientation_x,orientation_y,orientation_z,mirror,mirror_at,name";
constexpr std::size_t kDepthEnd = 12, kOrientationEnd = 16, kMirrorEnd = 18, kMostFields = 19;

void check_count(const std::vector<DeformationEntry>& list, std::string_view name, const std::string& label) {
    if (list.size() > kMaxDeformations)
        fail(name, label, "must have at most " + std::to_string(kMaxDeformations) + " deformations");
}

// --- JSON

/// Copies the numbers of entry[key], and one more to `further` unless null, which is optional.
template <class Vector>
void read_numbers(const Json& entry, const char* key, Vector& to, double* further = nullptr) {
    constexpr auto size = static_cast<std::size_t>(Vector::length());
    const auto is_such = [&](const Json& v) {
        return v.is_array() && (v.size() == size || (further && v.size() == size + 1)) && v.all_numbers();
    };
    if (!entry.contains(key) || !is_such(entry.member(key)))
        throw Error(std::string(key) + ": must be a list of " + std::to_string(size) +
                    (further ? " or " + std::to_string(size + 1) : "") + " numbers");
    for (std::size_t i = 0; i < size; ++i) to[static_cast<int>(i)] = entry.member(key)[i].number();
    if (entry.member(key).size() > size) *further = entry.member(key)[size].number();
}

/// The text of entry[key].
std::string read_text(const Json& entry, const char* key) {
    if (!entry.member(key).is_string()) throw Error(std::string(key) + ": must be a name in quotes");
    return std::string(entry.member(key).string());
}

DeformationEntry read_entry(const Json& entry) {
    if (!entry.is_object()) throw Error("must be an object with vector, center and extent");
    constexpr std::string_view kKeys[] = {"vector", "center",      "extent", "kernel",    "enabled",
                                          "side",   "orientation", "mirror", "mirror_at", "name"};
    for (const auto& [key, value] : entry.members())
        if (std::find(std::begin(kKeys), std::end(kKeys), key) == std::end(kKeys))
            throw Error(
                excerpt(key) +
                ": must be one of vector, center, extent, kernel, enabled, side, orientation, mirror, "
                "mirror_at, name");
    DeformationEntry made;
    Deformation& d = made.deformation;
    read_numbers(entry, "vector", d.vector);
    read_numbers(entry, "center", d.center, &d.center_w);
    read_numbers(entry, "extent", d.extent, &d.extent_w);
    if (entry.contains("kernel")) d.kernel = kernel_named(read_text(entry, "kernel"));
    if (entry.contains("enabled")) {
        if (!entry.member("enabled").is_boolean()) throw Error("enabled: must be true or false");
        d.enabled = entry.member("enabled").boolean();
    }
    if (entry.contains("side")) d.side = side_named(read_text(entry, "side"));
    if (entry.contains("orientation")) read_numbers(entry, "orientation", d.orientation);
    if (entry.contains("mirror")) made.mirror = mirror_named(read_text(entry, "mirror"));
    if (entry.contains("mirror_at")) {
        if (!entry.member("mirror_at").is_number()) throw Error("mirror_at: must be a number");
        made.mirror_at = entry.member("mirror_at").number();
    }
    if (entry.contains("name")) made.name = read_text(entry, "name");
    check_entry(made);
    return made;
}

// --- CSV

DeformationEntry read_row(std::string_view row) {
    const std::vector<std::string_view> fields = text_file::fields_of(row);
    const bool cut = fields.size() == 10 || (fields.size() > kDepthEnd && fields.size() < kOrientationEnd) ||
                     fields.size() == kOrientationEnd + 1;
    if (fields.size() < 7 || fields.size() > kMostFields || cut)
        throw Error("must be " + std::string(kColumns) + kDepthColumns + kEntryColumns +
                    " (the first seven, and of the others those that are wanted), not " +
                    std::to_string(fields.size()) + " fields");
    DeformationEntry made;
    Deformation& d = made.deformation;
    double* const numbers[7] = {&d.center.x, &d.center.y, &d.extent.x, &d.extent.y,
                                &d.vector.x, &d.vector.y, &d.vector.z};
    for (std::size_t i = 0; i < 7; ++i) *numbers[i] = text_file::number(fields[i]);
    if (fields.size() > 7) d.kernel = kernel_named(fields[7]);
    if (fields.size() > 8) {
        if (fields[8] != "0" && fields[8] != "1")
            throw Error("enabled", excerpt(fields[8]), "must be 0 or 1");
        d.enabled = fields[8] == "1";
    }
    if (fields.size() > 9) {
        d.center_w = text_file::number(fields[9]);
        d.extent_w = text_file::number(fields[10]);
    }
    if (fields.size() > 11) d.side = side_named(fields[11]);
    if (fields.size() > kDepthEnd)
        for (int c = 0; c < 4; ++c)
            d.orientation[c] = text_file::number(fields[kDepthEnd + static_cast<std::size_t>(c)]);
    if (fields.size() > kOrientationEnd) {
        made.mirror = mirror_named(fields[kOrientationEnd]);
        made.mirror_at = text_file::number(fields[kOrientationEnd + 1]);
    }
    if (fields.size() > kMirrorEnd) made.name = std::string(fields[kMirrorEnd]);
    check_entry(made);
    return made;
}

std::string joined(std::initializer_list<double> numbers, const char* separator) {
    std::string text;
    for (const double v : numbers) {
        if (!text.empty()) text += separator;
        // JSON readers take -0 for a whole number, which has no sign.
        text += v == 0 && std::signbit(v) ? "-0.0" : shortest(v);
    }
    return text;
}

std::string joined_orientation(const Deformation& d, const char* separator) {
    return joined({d.orientation.x, d.orientation.y, d.orientation.z, d.orientation.w}, separator);
}

/// Is a frame, an image or a name to be written, used or not?
bool has_orientation(const Deformation& d) {
    const glm::dvec4 none = Deformation().orientation;
    return d.orientation != none || std::signbit(d.orientation.y) || std::signbit(d.orientation.z) ||
           std::signbit(d.orientation.w);
}
bool has_mirror(const DeformationEntry& entry) {
    return entry.mirror != DeformationMirror::none || entry.mirror_at != 0 || std::signbit(entry.mirror_at);
}

/// A name in quotes, as JSON has it. It has neither quotes nor control characters.
std::string quoted(const std::string& name) {
    std::string text = "\"";
    for (const char c : name) text += c == '\\' ? std::string("\\\\") : std::string(1, c);
    return text + "\"";
}

/// Are there numbers of depth to be written, used or not?
bool has_numbers_of_depth(const Deformation& d) {
    return d.has_depth() || d.center_w != 0 || std::signbit(d.center_w);
}

}  // namespace

const char* name_of(DeformationKernel kernel) {
    return kernel == DeformationKernel::gaussian ? "gaussian" : "wendland_c2";
}

DeformationKernel kernel_named(std::string_view name) {
    for (const DeformationKernel kernel : {DeformationKernel::gaussian, DeformationKernel::wendland_c2})
        if (name == name_of(kernel)) return kernel;
    throw Error("kernel", excerpt(name), "must be gaussian or wendland_c2");
}

const char* name_of(DeformationSide side) {
    return side == DeformationSide::both ? "both" : side == DeformationSide::front ? "front" : "back";
}

DeformationSide side_named(std::string_view name) {
    for (const DeformationSide side : {DeformationSide::both, DeformationSide::front, DeformationSide::back})
        if (name == name_of(side)) return side;
    throw Error("side", excerpt(name), "must be both, front or back");
}

const char* name_of(DeformationMirror mirror) {
    return mirror == DeformationMirror::none ? "none" : mirror == DeformationMirror::u ? "u" : "v";
}

DeformationMirror mirror_named(std::string_view name) {
    for (const DeformationMirror mirror :
         {DeformationMirror::none, DeformationMirror::u, DeformationMirror::v})
        if (name == name_of(mirror)) return mirror;
    throw Error("mirror", excerpt(name), "must be none, u or v");
}

std::vector<DeformationEntry> parse_entries_json(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    const text_file::JsonFile file(text, name);
    const Json json = file.top();
    if (!json.is_object() || json.size() != 1 || !json.contains("deformations") ||
        !json.member("deformations").is_array())
        fail(name, "", "must be an object with nothing but a list, deformations");
    std::vector<DeformationEntry> list;
    for (const Json& entry : json.member("deformations").entries()) {
        const std::string label = "deformations[" + std::to_string(list.size()) + "]";
        in_entry(name, label, [&] { list.push_back(read_entry(entry)); });
        check_count(list, name, label);
    }
    return list;
}

std::vector<DeformationEntry> parse_entries_csv(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    std::vector<DeformationEntry> list;
    bool first = true;
    text_file::each_row(text, [&](std::string_view row, const std::string& label) {
        const bool head = first && row.starts_with("center_u");
        first = false;
        if (head) return;
        in_entry(name, label, [&] { list.push_back(read_row(row)); });
        check_count(list, name, label);
    });
    return list;
}

std::vector<DeformationEntry> parse_entries_file(std::string_view text, std::string_view name) {
    return text_file::ends_with(name, ".csv") ? parse_entries_csv(text, name)
                                              : parse_entries_json(text, name);
}

std::vector<Deformation> parse_deformations_json(std::string_view text, std::string_view name) {
    return with_images(parse_entries_json(text, name)).list;
}
std::vector<Deformation> parse_deformations_csv(std::string_view text, std::string_view name) {
    return with_images(parse_entries_csv(text, name)).list;
}
std::vector<Deformation> parse_deformations_file(std::string_view text, std::string_view name) {
    return with_images(parse_entries_file(text, name)).list;
}

std::string entries_json(const std::vector<DeformationEntry>& list) {
    std::string text = "{\"deformations\": [";
    const char* separator = "\n";
    for (const DeformationEntry& entry : list) {
        const Deformation& d = entry.deformation;
        const bool deep = has_numbers_of_depth(d);
        text += std::string(separator) + "  {\"vector\": [" +
                joined({d.vector.x, d.vector.y, d.vector.z}, ", ") + "], \"center\": [" +
                joined({d.center.x, d.center.y}, ", ") + (deep ? ", " + joined({d.center_w}, "") : "") +
                "], \"extent\": [" + joined({d.extent.x, d.extent.y}, ", ") +
                (deep ? ", " + joined({d.extent_w}, "") : "") + "], \"kernel\": \"" + name_of(d.kernel) +
                "\", \"enabled\": " + (d.enabled ? "true" : "false") +
                (d.has_side() ? std::string(", \"side\": \"") + name_of(d.side) + "\"" : "");
        if (has_orientation(d)) text += ", \"orientation\": [" + joined_orientation(d, ", ") + "]";
        if (has_mirror(entry))
            text += std::string(", \"mirror\": \"") + name_of(entry.mirror) +
                    "\", \"mirror_at\": " + joined({entry.mirror_at}, "");
        if (!entry.name.empty()) text += ", \"name\": " + quoted(entry.name);
        text += "}";
        separator = ",\n";
    }
    return text + "\n]}\n";
}

std::string entries_csv(const std::vector<DeformationEntry>& list) {
    const bool whole = std::any_of(list.begin(), list.end(), [](const DeformationEntry& entry) {
        return has_orientation(entry.deformation) || has_mirror(entry) || !entry.name.empty();
    });
    const bool deep = whole || std::any_of(list.begin(), list.end(), [](const DeformationEntry& entry) {
                          return has_numbers_of_depth(entry.deformation) || entry.deformation.has_side();
                      });
    std::string text =
        kColumns + std::string(deep ? kDepthColumns : "") + (whole ? kEntryColumns : "") + "\n";
    for (const DeformationEntry& entry : list) {
        const Deformation& d = entry.deformation;
        text += joined({d.center.x, d.center.y, d.extent.x, d.extent.y, d.vector.x, d.vector.y, d.vector.z},
                       ",") +
                "," + name_of(d.kernel) + (d.enabled ? ",1" : ",0") +
                (deep ? "," + joined({d.center_w, d.extent_w}, ",") + "," + name_of(d.side) : "") +
                (whole ? "," + joined_orientation(d, ",") + "," + name_of(entry.mirror) + "," +
                             joined({entry.mirror_at}, "") + "," + entry.name
                       : "") +
                "\n";
    }
    return text;
}

std::string deformations_json(const std::vector<Deformation>& list) {
    return entries_json({list.begin(), list.end()});
}
std::string deformations_csv(const std::vector<Deformation>& list) {
    return entries_csv({list.begin(), list.end()});
}

}  // namespace anamorph
