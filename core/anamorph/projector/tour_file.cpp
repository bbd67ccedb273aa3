// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/tour_file.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <set>

#include "anamorph/number/hypot.h"
#include "anamorph/parameter/json_file.h"

namespace anamorph {
namespace {

using text_file::excerpt;
using text_file::in_entry;
using text_file::Json;

constexpr double kMostAngle = 36000;

/// The member of an object; it must be there.
Json member(const Json& object, const char* key) {
    if (!object.contains(key)) throw Error(std::string(key) + " is missing: must be given");
    return object.member(key);
}

void check_keys(const Json& object, const std::set<std::string>& known) {
    std::string names;
    for (const std::string& name : known) names += (names.empty() ? "" : ", ") + name;
    if (!object.is_object()) throw Error("must be an object with " + names);
    for (const auto& [key, value] : object.members())
        if (!known.contains(key)) throw Error("\"" + excerpt(key) + "\": must be one of " + names);
}

std::string text_of(const Json& object, const char* key) {
    const Json value = member(object, key);
    if (!value.is_string() || value.string().empty()) throw Error(std::string(key) + ": must be text");
    return value.string();
}

double number_of(const Json& object, const char* key, double least, double most) {
    const Json value = member(object, key);
    const double number = value.is_number() ? value.number() : std::nan("");
    if (!(number >= least && number <= most))
        throw Error(std::string(key) + ": must be a number from " + std::to_string(std::lround(least)) +
                    " to " + std::to_string(std::lround(most)));
    return number;
}

TourView view_of(const Json& object) {
    TourView view;
    if (object.contains("yaw")) view.yaw = number_of(object, "yaw", -kMostAngle, kMostAngle);
    if (object.contains("pitch")) view.pitch = number_of(object, "pitch", -90, 90);
    if (object.contains("fov")) view.fov = number_of(object, "fov", 1, 179);
    return view;
}

/// A list of 0 or more values; none where it is missing.
std::vector<Json> list_of(const Json& object, const char* key, std::size_t most) {
    if (!object.contains(key)) return {};
    if (!object.member(key).is_array() || object.member(key).size() > most)
        throw Error(std::string(key) + ": must be a list of at most " + std::to_string(most));
    return object.member(key).entries();
}

HotSpot spot_of(const Json& json, const std::map<std::string, std::size_t>& files) {
    check_keys(json, {"yaw", "pitch", "radius", "target", "view"});
    HotSpot spot;
    spot.yaw = number_of(json, "yaw", -kMostAngle, kMostAngle);
    spot.pitch = number_of(json, "pitch", -90, 90);
    spot.radius = number_of(json, "radius", 0, 180);
    const std::string target = text_of(json, "target");
    const auto found = files.find(target);
    if (found == files.end())
        throw Error("target \"" + excerpt(target) + "\": must be the file of a panorama");
    spot.target = found->second;
    if (json.contains("view")) {
        check_keys(json.member("view"), {"yaw", "pitch", "fov"});
        spot.view = view_of(json.member("view"));
    }
    return spot;
}

std::string entry_name(std::size_t i) {
    return "panorama " + std::to_string(i + 1);
}

}  // namespace

double angle_between(double yaw, double pitch, double other_yaw, double other_pitch) {
    const double per_degree = std::numbers::pi / 180;
    const double p = pitch * per_degree, q = other_pitch * per_degree;
    // A full turn is taken off exactly, before anything is rounded.
    const double turn = std::fmod(other_yaw - yaw, 360.0) * per_degree;
    // The tangent's form loses nothing at small angles.
    const double across = std::cos(q) * std::sin(turn);
    const double up = std::cos(p) * std::sin(q) - std::sin(p) * std::cos(q) * std::cos(turn);
    const double along = std::sin(p) * std::sin(q) + std::cos(p) * std::cos(q) * std::cos(turn);
    return std::atan2(hypot(across, up), along) / per_degree;
}

int TourPanorama::spot_at(double yaw, double pitch) const {
    int nearest = -1;
    double least = HUGE_VAL;
    for (std::size_t i = 0; i < spots.size(); ++i) {
        const double angle = angle_between(yaw, pitch, spots[i].yaw, spots[i].pitch);
        if (!(angle <= spots[i].radius && angle < least)) continue;
        least = angle;
        nearest = static_cast<int>(i);
    }
    return nearest;
}

Tour parse_tour_json(std::string_view text, std::string_view name) {
    text_file::check_size(text, name);
    const text_file::JsonFile file(text, name);
    const Json json = file.top();
    Tour tour;
    std::vector<Json> list;
    in_entry(name, "", [&] {
        check_keys(json, {"panoramas"});
        list = list_of(json, "panoramas", kMostTourPanoramas);
        if (list.empty()) throw Error("panoramas: must be a list of at least 1");
    });
    std::map<std::string, std::size_t> files;
    for (std::size_t i = 0; i < list.size(); ++i)
        in_entry(name, entry_name(i), [&] {
            check_keys(list[i], {"file", "options", "yaw", "pitch", "fov", "spots"});
            TourPanorama panorama{text_of(list[i], "file")};
            if (list[i].contains("options")) panorama.options = text_of(list[i], "options");
            panorama.view = view_of(list[i]);
            if (!files.emplace(panorama.file, i).second)
                throw Error("file \"" + excerpt(panorama.file) + "\" is given twice: must be given once");
            tour.push_back(std::move(panorama));
        });
    for (std::size_t i = 0; i < list.size(); ++i)
        in_entry(name, entry_name(i), [&] {
            for (const Json& spot : list_of(list[i], "spots", kMostHotSpots))
                tour[i].spots.push_back(spot_of(spot, files));
        });
    return tour;
}

}  // namespace anamorph
