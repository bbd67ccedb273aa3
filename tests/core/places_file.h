// SPDX-License-Identifier: Apache-2.0
// Files of places (tests/data/places): what goes in, and what has to come out.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <istream>
#include <map>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace anamorph::places {

using Real = long double;
using Numbers = std::vector<Real>;
using Words = std::vector<std::string>;

inline constexpr const char* kFormat = R"(
A file has lines that begin with these words. A # begins a comment; the first ones say what is meant and where
the numbers are from.
  chart size=600x400 fov=180
      of a projection; also pixels=centers, d=1, e=0.5, lens=MODEL:name=value
  chart projection=fisheye size=600x400 fov=180 lens=kb4:k1=0.1
      of a lens; also pixels=centers
  surface aspect=1.5 radius=0.4
      of a surface: members of SurfaceShape
  map picture=480x320 source=600x400 turn=2
      of a map: both sizes, and keys of its own
  tolerance 1e-9 1e-9
      there in pixels, and back in degrees, of a lens in pixels; of a surface and a map one number
  accept 30 -20
      a ray's azimuth to the right and elevation up in degrees; an ideal pixel of a lens; u, v of a surface; a point
      of a map's picture, of one that pushes of its source
  expect 406.9 124.9
      its pixel; of a lens the observed one; of a surface x, y and z; of a map the point that it leads to; or none
  normal 0 0 1
      of a surface that has normals, behind expect
Both ways are read, but for expect none. One alone: accept ray, accept pixel; accept ideal, accept observed.
  all ray
      every ray has a pixel; all pixel: every pixel has a ray. If not, a place with expect none lies within a
      degree, or a pixel, of one that has a counterpart: just outside and just inside the end. Of a map: all point.
)";

/// The words and numbers that the files of one of the lists have.
struct FileKind {
    std::string folder, group;
    Words sides;
    bool may_have_all;
    std::size_t results, tolerances;
};
inline const FileKind kProjectionFiles{"projection", "chart", {"ray", "pixel"}, true, 2, 2};
inline const FileKind kLensFiles{"lens", "chart", {"ideal", "observed"}, false, 2, 2};
inline const FileKind kSurfaceFiles{"surface", "surface", {}, false, 3, 1};
inline const FileKind kMapFiles{"map", "map", {"point"}, true, 2, 1};

/// A place: the numbers that are accepted, and those that are expected.
struct Place {
    std::string at;    ///< file and line
    std::string side;  ///< the only side that is read from, if one is named
    Numbers accept;
    bool answered = false;
    std::optional<Numbers> expect;
    Numbers normal, tolerance;
};

[[noreturn]] inline void refuse(const std::string& at, const std::string& why) {
    throw std::runtime_error(at + ": " + why);
}

/// Places of one chart or surface.
struct Group {
    std::string at;
    std::map<std::string, std::string> settings;
    Words all;
    std::vector<Place> places;

    std::string setting(const std::string& name, const std::string& otherwise) const {
        const auto found = settings.find(name);
        return found == settings.end() ? otherwise : found->second;
    }
    void allow(const Words& names) const {
        for (const auto& [name, value] : settings)
            if (std::find(names.begin(), names.end(), name) == names.end()) refuse(at, "unknown: " + name);
    }
};

inline Real number_of(const std::string& at, const std::string& word) {
    Real value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size() || !std::isfinite(value))
        refuse(at, word + " is no number");
    return value;
}

/// Reads a file line by line; what it does not know it refuses.
class PlacesReader {
  public:
    explicit PlacesReader(const FileKind& kind) : m_kind(kind) {}

    void read(const std::string& at, const std::string& line) {
        std::istringstream in(line.substr(0, line.find('#')));
        Words words;
        for (std::string word; in >> word;) words.push_back(word);
        if (words.empty()) return;
        m_at = at;
        const std::string key = words.front();
        words.erase(words.begin());
        take(key, words);
    }
    /// The groups of all lines that were read.
    const std::vector<Group>& groups() const {
        check_answered();
        return m_groups;
    }

  private:
    void take(const std::string& key, const Words& words) {
        if (key == m_kind.group)
            begin(words);
        else if (key == "tolerance")
            m_tolerance = numbers(words, m_kind.tolerances);
        else if (key == "accept")
            accept(words);
        else if (key == "expect")
            expect(words);
        else if (key == "normal" && m_kind.group == "surface")
            open_place(true).normal = numbers(words, 3);
        else if (key == "all" && m_kind.may_have_all && words.size() == 1 && is_side(words[0]))
            group().all.push_back(words[0]);
        else
            refuse(m_at, "unknown: " + key);
    }
    void begin(const Words& words) {
        check_answered();
        m_groups.push_back({m_at, {}, {}, {}});
        for (const std::string& word : words) {
            const std::size_t equals = std::min(word.find('='), word.size());
            const std::string name = word.substr(0, equals);
            if (equals == word.size()) refuse(m_at, "unknown: " + word);
            if (!group().settings.emplace(name, word.substr(equals + 1)).second)
                refuse(m_at, name + " stands there twice");
        }
    }
    void accept(Words words) {
        check_answered();
        Place place;
        place.at = m_at;
        if (!words.empty() && is_side(words[0])) {
            place.side = words[0];
            words.erase(words.begin());
        }
        place.accept = numbers(words, 2);
        if (m_tolerance.empty()) refuse(m_at, "no tolerance stands before");
        place.tolerance = m_tolerance;
        group().places.push_back(place);
    }
    void expect(const Words& words) {
        Place& place = open_place(false);
        if (words != Words{"none"})
            place.expect = numbers(words, m_kind.results);
        else if (m_kind.group == "surface")
            refuse(m_at, "a surface has a point everywhere");
        place.answered = true;
    }

    Group& group() {
        if (m_groups.empty()) refuse(m_at, "no " + m_kind.group + " stands before");
        return m_groups.back();
    }
    /// The last place, which has to have been answered or not, as `answered` says.
    Place& open_place(bool answered) {
        if (group().places.empty() || group().places.back().answered != answered ||
            !group().places.back().normal.empty())
            refuse(m_at, answered ? "no expect stands before" : "no accept stands before");
        return group().places.back();
    }
    void check_answered() const {
        if (m_groups.empty() || m_groups.back().places.empty()) return;
        const Place& last = m_groups.back().places.back();
        if (!last.answered) refuse(last.at, "no expect follows");
    }
    Numbers numbers(const Words& words, std::size_t count) const {
        if (words.size() != count) refuse(m_at, "must have " + std::to_string(count) + " numbers");
        Numbers values;
        for (const std::string& word : words) values.push_back(number_of(m_at, word));
        return values;
    }
    bool is_side(const std::string& word) const { return contains(m_kind.sides, word); }
    static bool contains(const Words& words, const std::string& word) {
        return std::find(words.begin(), words.end(), word) != words.end();
    }

    FileKind m_kind;
    std::string m_at;
    Numbers m_tolerance;
    std::vector<Group> m_groups;
};

inline std::vector<Group> read_places(const FileKind& kind, const std::string& file, std::istream& in) {
    PlacesReader reader(kind);
    int number = 0;
    for (std::string line; std::getline(in, line);) reader.read(file + ":" + std::to_string(++number), line);
    return reader.groups();
}

}  // namespace anamorph::places
