// SPDX-License-Identifier: Apache-2.0
#include "anamorph/lens_search.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <functional>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

#ifdef ANAMORPH_LENSFUN
#include <lensfun/lensfun.h>
#endif

namespace anamorph {
namespace {

constexpr std::string_view kPrefix = "lensfun";

constexpr std::array<std::string_view, 4> kKeys = {"lens", "camera", "focal", "crop"};

/// Where the next KEY= stands behind a comma, from `at` on, or the end: names may have commas themselves.
std::size_t next_key(std::string_view text, std::size_t at) {
    for (; (at = text.find(',', at)) != std::string_view::npos; ++at)
        for (const std::string_view key : kKeys) {
            const std::string_view rest = text.substr(at + 1);
            if (rest.starts_with(key) && rest.substr(key.size()).starts_with('=')) return at;
        }
    return text.size();
}

double positive_number(const std::string& parameter, const std::string& text, std::string_view key,
                       std::string_view value) {
    double number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc() || end != value.data() + value.size() || !(number >= 0.01 && number <= 1e5))
        throw Error(
            parameter, printable(text),
            std::string(key) +
                " must be a number from 0.01 to 100000, and the only keys are lens, camera, focal and crop");
    return number;
}

}  // namespace

bool is_of_lens_database(std::string_view text) {
    return text.starts_with(kPrefix) && (text.size() == kPrefix.size() || text[kPrefix.size()] == ':');
}

LensName parse_lens_name(const std::string& parameter, const std::string& text) {
    LensName name;
    name.text = printable(text);
    std::vector<std::string_view> seen;
    for (std::size_t at = kPrefix.size() + 1; at < text.size();) {
        const std::size_t end = next_key(text, at);
        const std::string_view part = std::string_view(text).substr(at, end - at);
        const std::string_view key = part.substr(0, part.find('='));
        if (key.size() == part.size() || std::find(kKeys.begin(), kKeys.end(), key) == kKeys.end())
            throw Error(parameter, name.text,
                        "lensfun: must be followed by lens=, camera=, focal= and crop=, as in "
                        "lensfun:lens=NAME,camera=NAME,focal=35");
        if (std::find(seen.begin(), seen.end(), key) != seen.end())
            throw Error(parameter, name.text, std::string(key) + " must be given once");
        seen.push_back(key);
        const std::string_view value = part.substr(key.size() + 1);
        if (value.empty()) throw Error(parameter, name.text, std::string(key) + " must not be empty");
        if (key == "lens") name.lens = value;
        if (key == "camera") name.camera = value;
        if (key == "focal") name.focal = positive_number(parameter, text, key, value);
        if (key == "crop") name.crop = positive_number(parameter, text, key, value);
        at = end + 1;
    }
    return name;
}

#ifdef ANAMORPH_LENSFUN

namespace {

/// What a search found, the best first.
template <class Item>
std::vector<const Item*> listed(const Item** found) {
    std::vector<const Item*> list;
    for (const Item** at = found; at && *at; ++at) list.push_back(*at);
    lf_free(found);
    return list;
}

/// A name of the database: the first of several, which is the same whatever the locale is.
template <class Item>
std::string name_of(const Item& item) {
    const std::string by = item.Maker ? item.Maker : "", what = item.Model ? item.Model : "";
    return what.starts_with(by) ? what : by + " " + what;
}

/// Leaves those alone that are named in full, if there are some: others may have more words.
template <class Item>
void prefer_full_names(std::vector<const Item*>& found, const std::string& asked) {
    const auto is_full = [&](const Item* item) { return item->Model == asked || name_of(*item) == asked; };
    if (std::any_of(found.begin(), found.end(), is_full)) std::erase_if(found, std::not_fn(is_full));
}

/// The names of the first three different ones, for messages.
template <class Item>
std::string near_names(const std::vector<const Item*>& list) {
    std::vector<std::string> names;
    for (const Item* item : list)
        if (const std::string name = printable(name_of(*item));
            names.size() < 3 && std::find(names.begin(), names.end(), name) == names.end())
            names.push_back(name);
    std::string text;
    for (const std::string& name : names) text += (text.empty() ? "" : ", ") + name;
    return text.empty() ? "there is none like it" : "near are " + text;
}

class Search {
  public:
    Search(const lfDatabase& database, const std::string& parameter, const LensName& asked)
        : m_parameter(parameter), m_asked(asked), m_database(database) {}

    /// The camera; null where none is named.
    const lfCamera* camera() const {
        if (m_asked.camera.empty()) return nullptr;
        std::vector<const lfCamera*> found = cameras(0);
        prefer_full_names(found, m_asked.camera);
        if (found.empty()) {
            // By metadata alone it serves for its crop factor, which may be given.
            if (m_asked.crop && !m_asked.lens.empty()) return nullptr;
            refuse("camera " + printable(m_asked.camera) +
                   " is not in Lensfun's database: " + near_names(cameras(LF_SEARCH_LOOSE)));
        }
        // Models that differ by more words than were asked for have a lower score.
        for (const lfCamera* other : found)
            if (other->Score == found[0]->Score && other->CropFactor != found[0]->CropFactor)
                refuse("camera " + printable(m_asked.camera) +
                       " may be several of Lensfun's database: " + near_names(found));
        return found[0];
    }
    const lfLens& lens(const lfCamera* camera, double crop) const {
        std::vector<const lfLens*> found = lenses(camera, crop, 0);
        if (m_asked.lens.empty() && (!camera || !is_one(found)))
            refuse(
                "the lens is not said, nor does the camera have but one: must be given, as in "
                "lensfun:lens=NAME");
        if (found.empty())
            refuse("lens " + printable(m_asked.lens) + " is not in Lensfun's database" +
                   (camera ? " for " + printable(name_of(*camera)) : std::string()) + ": " +
                   near_names(lenses(camera, crop, LF_SEARCH_LOOSE)));
        prefer_full_names(found, m_asked.lens);
        // Of calibrations on several sensors that are as good, that of the smallest one, which is nearest to the camera's.
        const int best = found[0]->Score;
        std::stable_sort(found.begin(), found.end(), [](const lfLens* a, const lfLens* b) {
            return a->Score != b->Score ? a->Score > b->Score : a->CropFactor > b->CropFactor;
        });
        for (const lfLens* other : found)
            if (other->Score == best && name_of(*other) != name_of(*found[0]))
                refuse("lens " + printable(m_asked.lens) +
                       " may be several of Lensfun's database: " + near_names(found));
        return *found[0];
    }

  private:
    [[noreturn]] void refuse(const std::string& why) const { throw Error(m_parameter, m_asked.text, why); }

    std::vector<const lfCamera*> cameras(int flags) const {
        const auto search = [&](const std::string& maker, const std::string& model) {
            return listed(m_database.FindCamerasExt(maker.c_str(), model.c_str(), flags));
        };
        std::vector<const lfCamera*> found = search(m_asked.maker, m_asked.camera);
        // The first word may be the maker's, where the database has it apart.
        const std::size_t blank = m_asked.camera.find(' ');
        if (found.empty() && blank != std::string::npos)
            found = search(m_asked.camera.substr(0, blank), m_asked.camera.substr(blank + 1));
        return found;
    }
    /// The lenses that fit a camera with a sensor of this crop factor.
    std::vector<const lfLens*> lenses(const lfCamera* camera, double crop, int flags) const {
        lfLens like;
        if (!m_asked.lens.empty()) like.SetModel(m_asked.lens.c_str());
        if (camera && camera->Mount) like.AddMount(camera->Mount);
        like.GuessParameters();
        like.CropFactor = static_cast<float>(crop);
        return listed(m_database.FindLenses(&like, flags));
    }
    static bool is_one(const std::vector<const lfLens*>& list) {
        return !list.empty() && std::all_of(list.begin(), list.end(), [&](const lfLens* lens) {
            return name_of(*lens) == name_of(*list[0]);
        });
    }

    const std::string& m_parameter;
    const LensName& m_asked;
    const lfDatabase& m_database;
};

/// The focal length at which a lens is used.
double focal_of(const std::string& parameter, const LensName& asked, const lfLens& lens) {
    const double shortest_focal = lens.MinFocal, longest = lens.MaxFocal;
    if (!asked.focal && !(shortest_focal > 0 && shortest_focal == longest))
        throw Error(parameter, asked.text,
                    "the focal length is not said: must be given, as in lensfun:focal=35, by mm as the lens "
                    "shows them");
    const double focal = asked.focal.value_or(shortest_focal);
    // Metadata are rounded, as the ends of zooms are.
    if (shortest_focal > 0 && longest > 0 && !(focal >= 0.95 * shortest_focal && focal <= 1.05 * longest))
        throw Error(parameter, asked.text,
                    "focal " + brief(focal) + " must be " +
                        (shortest_focal == longest ? brief(longest)
                                                   : brief(shortest_focal) + " to " + brief(longest)) +
                        " mm for " + printable(name_of(lens)));
    return focal;
}

/// The radius of 1 of Lensfun's models, in pixels. They are calibrated in halves of the smaller side of another picture, of its own crop
/// factor and aspect ratio; crop factors are of diagonals. Lensfun counts from pixel's middle to pixel's middle: a side is one pixel shorter.
double radius_of_one(const lfLens& lens, double crop, const Size& size) {
    const double width = std::max(size.width - 1, 1), height = std::max(size.height - 1, 1);
    const double aspect = lens.AspectRatio;
    return std::hypot(width, height) / 2 * (crop / lens.CropFactor) / std::hypot(aspect, 1.0);
}

/// Lensfun's models by powers of r: what S is more than 1 by, in the unit in which they are calibrated.
std::array<double, 5> powers_of(const lfLensCalibDistortion& found) {
    const double a = found.Terms[0], b = found.Terms[1], c = found.Terms[2];
    switch (found.Model) {
        case LF_DIST_MODEL_POLY3:
            return {-a, 0, a, 0, 0};
        case LF_DIST_MODEL_POLY5:
            return {0, 0, a, 0, b};
        default:
            return {-a - b - c, c, b, a, 0};
    }
}

std::optional<Projection> projection_of(lfLensType type) {
    switch (type) {
        case LF_RECTILINEAR:
            return Projection::rectilinear;
        case LF_FISHEYE:
            return Projection::fisheye;
        case LF_FISHEYE_ORTHOGRAPHIC:
            return Projection::orthographic;
        case LF_FISHEYE_STEREOGRAPHIC:
            return Projection::stereographic;
        case LF_FISHEYE_EQUISOLID:
            return Projection::equisolid;
        default:
            return {};
    }
}

}  // namespace

FoundLens find_lens(const lfDatabase& database, const std::string& parameter, const LensName& asked,
                    const Size& size) {
    const Search search(database, parameter, asked);
    const lfCamera* const camera = search.camera();
    if (!camera && !asked.crop)
        throw Error(parameter, asked.text,
                    "the camera is not said: must be given, as in lensfun:camera=NAME, or its crop factor, "
                    "as in crop=1.5");
    const double crop = asked.crop.value_or(camera ? camera->CropFactor : 1);
    const lfLens& lens = search.lens(camera, crop);
    const double focal = focal_of(parameter, asked, lens);
    lfLensCalibDistortion distortion;
    if (!lens.InterpolateDistortion(static_cast<float>(focal), distortion))
        throw Error(parameter, asked.text,
                    printable(name_of(lens)) + " has no distortion in Lensfun's database");
    const double smaller = std::min(size.width, size.height),
                 to_half = smaller / 2 / radius_of_one(lens, crop, size);
    FoundLens found;
    found.model = {LensModel::Kind::poly, {}};
    double scale = 1;
    for (const double power : powers_of(distortion)) {
        found.model.values.push_back(power * scale);
        scale *= to_half;
    }
    // Shifts are in halves of the smaller side, as Lensfun measures it.
    for (const double shift : {lens.CenterX, lens.CenterY})
        found.model.values.push_back(shift * std::max(smaller - 1, 1.0) / 2);
    found.projection = projection_of(lens.Type);
    // A real focal length is that in the middle of the picture as it was taken, a nominal one is that without distortion; a diagonal of
    // crop factor 1 is that of 36 x 24 mm.
    lfLensCalibRealFocal real;
    const bool is_real = lens.InterpolateRealFocal(static_cast<float>(focal), real);
    const double millimetres = is_real ? real.RealFocal / found.model.magnification() : focal;
    found.focal_length = millimetres * crop / std::hypot(36, 24) * std::hypot(size.width, size.height);
    const bool is_lens = found.focal_length > 0 && found.focal_length < HUGE_VAL &&
                         std::all_of(found.model.values.begin(), found.model.values.end(),
                                     [](double value) { return std::fabs(value) <= LensModel::kMostValue; });
    if (!is_lens)
        throw Error(parameter, asked.text,
                    "what Lensfun's database says of " + printable(name_of(lens)) +
                        " must be finite numbers, and focal lengths and crop factors above 0");
    found.name = name_of(lens) + ", " + shortest(static_cast<float>(focal)) + " mm, crop factor " +
                 shortest(static_cast<float>(crop)) + " (Lensfun)";
    return found;
}

#endif

}  // namespace anamorph
