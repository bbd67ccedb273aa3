// SPDX-License-Identifier: Apache-2.0
// The rows that the parameter tables of pictures share, and how rows are written.
#pragma once

#include <cstddef>
#include <glm/vec3.hpp>
#include <limits>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/image/picture.h"
#include "anamorph/operation/operation.h"
#include "anamorph/parameter/number_row.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph::rows {

inline constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// One of the values of a choice: its enumerator, and what it means where the row says so.
struct Word {
    template <class Enumeration>
    Word(const char* word, Enumeration value, std::string means = {})
        : name(word), meaning(std::move(means)), enumerator(static_cast<int>(value)) {}

    std::string name, meaning;
    int enumerator;
    static constexpr int kNone = -1;  ///< enumerator of a word that is none, and is asked for itself
};

Parameter enumeration(const char* name, std::string value, const std::vector<Word>& words,
                      const std::string& doc);
/// A row of type choice whose words are counted, or mean what they say.
Parameter choice(const char* name, std::string value, std::vector<std::string> choices,
                 const std::string& doc);
Parameter number(const char* name, const char* unit, std::string value, double least, double most,
                 const std::string& doc);
/// A row of type number with the default and the range of a row that other hosts share.
Parameter number(const char* name, const char* unit, const NumberRow& shared, const std::string& doc);
/// Returns a row of type number that does not accept its minimum.
Parameter above(Parameter number);
Parameter whole(const char* name, const char* unit, std::string value, int least, int most,
                const std::string& doc);
Parameter toggle(const char* name, const char* value, const std::string& doc);
Parameter numbers(const char* name, double least, const std::string& doc);
Parameter text(const char* name, const std::string& doc);
/// A row of type text for which other keys define names.
Parameter definitions(const char* name, const std::string& doc);
Parameter image(const char* name, const std::string& doc);
Parameter file(const char* name, const std::string& doc);

/// Keys that only files have a use for, recipes and what they are written to; other hosts draw one picture of what they are given.
inline constexpr const char* kKeysOfRecipes[] = {"subimage", "tile", "mip", "hash", "reached", "frames"};

Parameter size(const std::string& doc);
Parameter overscan();
Parameter subimage();
Parameter concatenate();
Parameter tile();
Parameter mip();
Parameter hash();
Parameter reached(const std::string& where);
Parameter tol();
Parameter colorspace(const std::string& doc);

/// The row of filters: those that all operations share, then the operation's own.
Parameter filter(const std::vector<Word>& own = {});
/// Is what a filter overshoots cut off?
Parameter clamp();
/// The filter that is asked for, clamped where that is too. `name`: of its row.
Filter filter_of(const ParameterValues& values, std::string_view name = "filter");
/// The rows of channels that hold no colour: which these are, and how they are filtered.
Parameter data_channels();
Parameter data_filter();
/// Which channels of a source these are, and how they are read. Where all are, `filter` becomes theirs. Throws Error.
DataChannels data_of(const ParameterValues& values, const SourceFacts& facts, Filter& filter);
/// The row `wrap`. `automatic`: what that is here, "is black".
Parameter wrap(const std::string& automatic);
/// The row of schemes. The words auto, exact, blocks, residual, direct and hardware mean the same everywhere
/// and need no meaning here.
Parameter scheme(const std::vector<Word>& words);
/// The row of outputs: the words that all operations share, then the operation's own; one that is among the former means what the
/// operation says.
Parameter output(const std::vector<Word>& own = {});
/// `wraps`: with which values of wrap.
Parameter alpha(const std::string& wraps = "with wrap=automatic or black");
/// Is the coverage of the source to be added as alpha? `is_faded`: do colours end at the source's edges? Throws Error.
bool adds_alpha(const ParameterValues& values, bool source_has_alpha, bool is_faded);
/// `more`: what else than the output it is of.
Parameter flip_v(const std::string& more = "");

/// Width and height asked for by `size`: those of `natural` where none is, its shape where only a width is
/// given.
Size size_of(const ParameterValues& values, const Size& natural);

/// The pixels that a picture of size `shown` is to have beyond its edges, across and down, on either side: as the row
/// `overscan` says. Throws Error.
Size overscan_of(const ParameterValues& values, const Size& shown);
/// Throws Error where the row is given in a picture of several faces, or with scheme=hardware.
void check_overscan(const ParameterValues& values, int pieces = 1);

/// Throws Error where a row is given with another scheme than those that read it: "must be given with scheme=oka or oka-z only".
void check_scheme_of(const ParameterValues& values, const char* name,
                     const std::vector<std::string>& schemes);

/// The three numbers of a row, each from `least` to `most`. Throws Error where there are not three such.
glm::dvec3 three_numbers(const ParameterValues& values, std::string_view name, double least, double most);

/// The enumerator of the word that a row has.
template <class Enumeration>
Enumeration chosen(const ParameterValues& values, std::string_view name) {
    return static_cast<Enumeration>(values.enumerator(name));
}

/// The horizontal field of view, in degrees, of a flat picture so many pixels wide, of a camera of that focal length in
/// pixels.
double flat_field_of_view(int width, double focal_length);
/// Degrees in six digits, for a picture's attributes.
std::string rounded_degrees(double degrees);

/// Has `output` one of the words that all operations share?
bool has_shared_output(const ParameterValues& values);
/// The value of the parameter `output`; colour for the operation's own words.
Output chosen_output(const ParameterValues& values);

}  // namespace anamorph::rows
