// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/rows.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <optional>
#include <set>
#include <string_view>

#include "anamorph/image/source.h"
#include "anamorph/number/portable.h"
#include "anamorph/plan/scheme.h"

namespace anamorph::rows {
namespace {

constexpr double kMaxTile = 4096;

Parameter row(const char* name, ParameterType type, const std::string& doc) {
    Parameter parameter;
    parameter.name = name;
    parameter.type = type;
    parameter.documentation = doc;
    return parameter;
}

Parameter extent(const char* name, std::string value, double least, double most, const std::string& doc) {
    Parameter parameter = row(name, ParameterType::extent, doc);
    parameter.unit = "pixels";
    parameter.default_value = std::move(value);
    parameter.minimum = least;
    parameter.maximum = most;
    return parameter;
}

// What the words of all operations mean. In functions, since tables may be made before main() begins.
const std::vector<Word>& shared_schemes() {
    static const std::vector<Word> words = {
        {"auto", Scheme::automatic, "the fastest that holds tol"},
        {"exact", Scheme::exact, "every pixel by the formula"},
        {"blocks", Scheme::blocks, "polynomials of degree 2 to 4 on blocks"},
        {"residual", Scheme::residual, "linear maps and a table of what remains"},
        {"direct", Scheme::direct,
         "every pixel by the formula, in float where that holds tol, near the middle of its block"},
        {"hardware", Word::kNone,
         "as the number formats and the stages of a machine make it, with the error that comes out"}};
    return words;
}
const std::vector<Word>& shared_outputs() {
    static const std::vector<Word> words = {
        {"color", Output::color},
        {"stmap", Output::stmap,
         "the source point (u, v) with v down, in 0 to 1 on the source, "
         "beyond that beyond its edges, (-1, -1) where there is none or the source is far"},
        {"error", Output::error, "its distance from the exact one in source pixels"},
        {"bound", Output::bound, "the proven bound of that"},
        {"coverage", Output::coverage, "how much of the pixel the source covers, 0 to 1, as filter has it"}};
    return words;
}

/// "exact, every pixel by the formula; blocks, ...", of those that have a meaning.
std::string meanings_of(const std::vector<Word>& words) {
    std::string text;
    for (const Word& word : words)
        if (!word.meaning.empty()) text += (text.empty() ? "" : "; ") + word.name + ", " + word.meaning;
    return text;
}

}  // namespace

Parameter enumeration(const char* name, std::string value, const std::vector<Word>& words,
                      const std::string& doc) {
    Parameter parameter = choice(name, std::move(value), {}, doc);
    for (const Word& word : words) {
        parameter.choices.push_back(word.name);
        parameter.enumerators.push_back(word.enumerator);
    }
    return parameter;
}

Parameter choice(const char* name, std::string value, std::vector<std::string> choices,
                 const std::string& doc) {
    Parameter parameter = row(name, ParameterType::choice, doc);
    parameter.default_value = std::move(value);
    parameter.choices = std::move(choices);
    return parameter;
}

Parameter number(const char* name, const char* unit, std::string value, double least, double most,
                 const std::string& doc) {
    Parameter parameter = row(name, ParameterType::number, doc);
    parameter.unit = unit;
    parameter.default_value = std::move(value);
    parameter.minimum = least;
    parameter.maximum = most;
    return parameter;
}

Parameter number(const char* name, const char* unit, const NumberRow& shared, const std::string& doc) {
    return number(name, unit, std::isnan(shared.standard) ? "" : shortest(shared.standard), shared.least,
                  shared.most, doc);
}

Parameter above(Parameter number) {
    number.above_minimum = true;
    return number;
}

Parameter whole(const char* name, const char* unit, std::string value, int least, int most,
                const std::string& doc) {
    Parameter parameter = number(name, unit, std::move(value), least, most, doc);
    parameter.type = ParameterType::whole;
    return parameter;
}

Parameter numbers(const char* name, double least, const std::string& doc) {
    Parameter parameter = row(name, ParameterType::numbers, doc);
    parameter.minimum = least;
    parameter.maximum = kInfinity;
    return parameter;
}

Parameter toggle(const char* name, const char* value, const std::string& doc) {
    Parameter parameter = row(name, ParameterType::toggle, doc);
    parameter.default_value = std::string(value);
    return parameter;
}

Parameter text(const char* name, const std::string& doc) {
    return row(name, ParameterType::text, doc);
}
Parameter definitions(const char* name, const std::string& doc) {
    Parameter parameter = text(name, doc);
    parameter.definitions = true;
    return parameter;
}
Parameter image(const char* name, const std::string& doc) {
    return row(name, ParameterType::image, doc);
}
Parameter file(const char* name, const std::string& doc) {
    return row(name, ParameterType::file, doc);
}

Parameter size(const std::string& doc) {
    return extent("size", "", 1, kMaxSide, doc);
}

Parameter overscan() {
    return text("overscan",
                "pixels that the picture has beyond each of its edges, or per cent of its width and height, "
                "across and down if they differ: 32, 5%, 64x16; they belong to the data window, and size, "
                "fields of view and formulas are of the display window");
}

Parameter subimage() {
    return text(
        "subimage",
        "of a source of several parts, pages or frames, the one that is drawn: its number, from 0, or its "
        "name; by default all of them, one after the other, and of a film the first");
}

namespace {

/// "32" or "5%" of `side`, in whole pixels; none where the text is neither.
std::optional<int> overscan_along(std::string_view text, int side) {
    const bool is_share = text.ends_with('%');
    if (is_share) text.remove_suffix(1);
    double number = 0;
    const auto [end, error] = from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !(number >= 0)) return {};
    const double pixels = is_share ? std::round(number / 100 * side) : number;
    if (pixels > kMaxSide || pixels != std::floor(pixels)) return {};
    return static_cast<int>(pixels);
}

}  // namespace

Size overscan_of(const ParameterValues& values, const Size& shown) {
    if (!values.knows("overscan") || !values.given("overscan")) return {};
    const std::string& text = values.text("overscan");
    const std::size_t cross = text.find('x');
    const std::string_view across = std::string_view(text).substr(0, cross);
    const std::string_view down =
        cross == std::string::npos ? across : std::string_view(text).substr(cross + 1);
    const std::optional<int> x = overscan_along(across, shown.width), y = overscan_along(down, shown.height);
    if (!x || !y)
        throw Error("overscan", printable(text),
                    "must be whole pixels or per cent, N, P%, NxN or P%xP%, from 0 to " +
                        std::to_string(kMaxSide) + " pixels");
    const std::int64_t width = shown.width + std::int64_t{2} * *x,
                       height = shown.height + std::int64_t{2} * *y;
    if (width > kMaxSide || height > kMaxSide)
        throw Error("overscan", printable(text),
                    "makes " + std::to_string(width) + "x" + std::to_string(height) +
                        " pixels: must be at most " + std::to_string(kMaxSide) + " either way");
    return {*x, *y};
}

void check_overscan(const ParameterValues& values, int pieces) {
    if (!values.given("overscan")) return;
    const std::string text = printable(values.text("overscan"));
    if (pieces > 1) throw Error("overscan", text, "must be of a picture in one piece, without faces");
    if (values.text("scheme") == "hardware")
        throw Error("overscan", text, "must not be given with scheme=hardware");
}

void check_scheme_of(const ParameterValues& values, const char* name,
                     const std::vector<std::string>& schemes) {
    if (!values.given(name) ||
        std::find(schemes.begin(), schemes.end(), values.text("scheme")) != schemes.end())
        return;
    std::string words;
    for (const std::string& scheme : schemes) words += (words.empty() ? "" : " or ") + scheme;
    throw Error(name, printable(values.text(name)), "must be given with scheme=" + words + " only");
}

Parameter concatenate() {
    return toggle("concatenate", "1",
                  "1: a source that is itself a recipe of one picture is not drawn first, but both maps are "
                  "joined and their "
                  "source is sampled once, where that can be done; 0: it is drawn, and sampled again");
}

Parameter tile() {
    return extent("tile", "256", 0, kMaxTile, "tile size that a host is told; 0 for scanlines");
}

Parameter mip() {
    return toggle("mip", "0", "1: the picture has MIP levels");
}

Parameter hash() {
    return toggle(
        "hash", "0",
        "1: the picture says its hash, anamorph:hash, for which all of it is drawn when it is opened");
}

/// `where`: the schemes of which it says more.
Parameter reached(const std::string& where) {
    return toggle("reached", "0",
                  where +
                      ": 1: the picture says what it reached, anamorph:max_error and what else is counted, "
                      "which takes as "
                      "long as drawing all of it when it is opened");
}

Parameter tol() {
    return number("tol", "source pixels", "0.01", 0, kInfinity,
                  "most that a source point may be off; 0: every pixel exactly");
}

Parameter colorspace(const std::string& doc) {
    return text("colorspace", doc);
}

Parameter filter(const std::vector<Word>& own) {
    std::vector<Word> words = {{"nearest", Filter::nearest},
                               {"bilinear", Filter::bilinear},
                               {"bicubic", Filter::bicubic},
                               {"sharp_bicubic", Filter::sharp_bicubic},
                               {"antialias", Filter::antialias}};
    words.insert(words.end(), own.begin(), own.end());
    return enumeration("filter", "antialias", words,
                       "antialias is bilinear where the map magnifies; sharp_bicubic keeps what repeats "
                       "every 5 texels to 1%, "
                       "where bicubic loses 3 and bilinear 12" +
                           (own.empty() ? "" : "; " + meanings_of(own)));
}

Parameter data_channels() {
    return text(
        "data_channels",
        "the names of channels that hold no color, as in Z,id; none: all hold color; by default those of "
        "Cryptomatte by its metadata, and those that are named Z, ZBack, depth or id or end in Id, ID or "
        "_id");
}

Parameter data_filter() {
    Parameter row = filter();
    row.name = "data_filter";
    row.default_value = "nearest";
    row.documentation = "of channels that hold no color, in place of filter; nearest mixes nothing";
    return row;
}

namespace {

/// The channels that a list names.
std::vector<int> named_channels(const std::string& all, const SourceFacts& facts) {
    std::vector<int> channels;
    if (all == "none") return channels;
    for (std::size_t at = 0; at <= all.size();) {
        const std::size_t end = std::min(all.find(',', at), all.size());
        const std::string name = all.substr(at, end - at);
        const auto found = std::find(facts.channel_names.begin(), facts.channel_names.end(), name);
        if (found == facts.channel_names.end()) {
            std::string names;
            for (const std::string& known : facts.channel_names) names += (names.empty() ? "" : ", ") + known;
            throw Error(
                "data_channels", printable(all),
                "must be none, or some of the source's channels, " + printable(names) + ", with commas");
        }
        channels.push_back(static_cast<int>(found - facts.channel_names.begin()));
        at = end + 1;
    }
    return channels;
}

}  // namespace

Parameter clamp() {
    return toggle(
        "clamp", "0",
        "1: what filter=bicubic or sharp_bicubic overshoots is cut off: a channel stays between the least "
        "and the greatest of the 4x4 texels that are read; the other filters do not overshoot");
}

Filter filter_of(const ParameterValues& values, std::string_view name) {
    const auto filter = chosen<Filter>(values, name);
    if (!is_cubic(filter) || !values.toggle("clamp")) return filter;
    return is_sharp(filter) ? Filter::sharp_bicubic_clamped : Filter::bicubic_clamped;
}

DataChannels data_of(const ParameterValues& values, const SourceFacts& facts, Filter& filter) {
    DataChannels data{facts.data_channels, filter_of(values, "data_filter")};
    if (values.given("data_channels")) data.channels = named_channels(values.text("data_channels"), facts);
    const std::set<int> different(data.channels.begin(), data.channels.end());
    // Then what is only moved keeps all its bits.
    if (!different.empty() && different.size() == facts.channel_names.size()) filter = data.filter;
    return data;
}

Parameter wrap(const std::string& automatic) {
    return enumeration("wrap", "automatic",
                       {{"automatic", Wrap::automatic},
                        {"black", Wrap::black},
                        {"clamp", Wrap::clamp},
                        {"periodic", Wrap::periodic},
                        {"mirror", Wrap::mirror}},
                       "what lies beyond a source's edge; automatic " + automatic);
}

Parameter scheme(const std::vector<Word>& words) {
    std::vector<Word> known = words;
    for (Word& word : known)
        for (const Word& shared : shared_schemes())
            if (word.name == shared.name) word.meaning = shared.meaning;
    return enumeration("scheme", "auto", known, "how source points are found: " + meanings_of(known));
}

Parameter output(const std::vector<Word>& own) {
    std::vector<Word> words = shared_outputs();
    // A word that means something else here keeps its place.
    for (const Word& word : own) {
        const auto same = std::find_if(words.begin(), words.end(),
                                       [&](const Word& other) { return other.name == word.name; });
        if (same != words.end())
            same->meaning = word.meaning;
        else
            words.push_back(word);
    }
    return enumeration("output", "color", words, "color, or per pixel: " + meanings_of(words));
}

Parameter alpha(const std::string& wraps) {
    return toggle("alpha", "0",
                  "1: where the source has no alpha, the picture has one, how much of each pixel the source "
                  "covers, by which colors are faded " +
                      wraps);
}

bool adds_alpha(const ParameterValues& values, bool source_has_alpha, bool is_faded) {
    if (!values.toggle("alpha")) return false;
    if (const std::string& output = values.text("output");
        output != "color" && output != "lines" && output != "mesh")
        throw Error("alpha", "1", "is of output=color: must not be given with output=" + output);
    if (source_has_alpha) return false;
    if (values.knows("scheme") && values.text("scheme") == "hardware")
        throw Error("alpha", "1", "must not be given with scheme=hardware");
    if (!is_faded)
        throw Error("alpha", "1", "must be given with wrap=black, which fades colors at the source's edges");
    return true;
}

Parameter flip_v(const std::string& more) {
    return toggle(
        "flip_v", "0",
        "1: v of the ST-map that output=stmap draws" + more +
            " goes up, 0 at the lower edge and 1 at the upper one, as Nuke, Gaffer and Natron have it");
}

Size size_of(const ParameterValues& values, const Size& natural) {
    if (!values.given("size")) return natural;
    Size size = values.extent("size");
    if (size.height < 0) {
        const double height = std::round(double(size.width) * natural.height / natural.width);
        size.height = static_cast<int>(std::clamp(height, 1.0, double{kMaxSide}));
    }
    return size;
}

glm::dvec3 three_numbers(const ParameterValues& values, std::string_view name, double least, double most) {
    const std::vector<double> v = values.numbers(name);
    const auto allowed = [&](double x) { return x >= least && x <= most; };
    if (v.size() != 3 || !std::all_of(v.begin(), v.end(), allowed))
        throw Error(std::string(name), printable(values.text(name)),
                    "must be three numbers from " + shortest(least) + " to " + shortest(most));
    return {v[0], v[1], v[2]};
}

double flat_field_of_view(int width, double focal_length) {
    return 2 * std::atan(width / (2 * focal_length)) * 180 / std::numbers::pi;
}

std::string rounded_degrees(double degrees) {
    char text[32];
    std::snprintf(text, sizeof text, "%.6g", degrees);
    return text;
}

bool has_shared_output(const ParameterValues& values) {
    return values.choice("output") < shared_outputs().size();
}

Output chosen_output(const ParameterValues& values) {
    if (!has_shared_output(values)) return Output::color;
    const auto output = chosen<Output>(values, "output");
    return output == Output::stmap && values.toggle("flip_v") ? Output::stmap_up : output;
}

}  // namespace anamorph::rows
