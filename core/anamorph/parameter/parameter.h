// SPDX-License-Identifier: Apache-2.0
// The parameters of an operation: one table says what there is, and the parser of recipe files and names, the
// checks and the reference page all read that table.
//
// A recipe file has one `key=value` a line. Blank lines say nothing, nor what follows a # that begins a line or stands behind a
// blank, unless the value is in double quotes; blanks around key and value do not count; a byte order mark and Windows line
// ends are read over. A recipe name is `BASE?key=value&key=value`. Its values may hold any character but `&`, with one exception: a value that is
// itself a recipe name with arguments (it holds a `?`) takes all the rest of the name, so it stands last, or
// it stands in brackets: `a=(x.pano?yaw=3&fov=40)&b=y.exr`. Nothing is decoded: %20 stays %20. Keys are read
// in upper or lower case.
#pragma once

#include <cstddef>
#include <exception>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/geometry/size.h"

namespace anamorph {

/// The kind of value that a parameter takes.
enum class ParameterType {
    number,   ///< a finite decimal number, with a point whatever the locale
    whole,    ///< an integer
    toggle,   ///< 0 or 1
    choice,   ///< one of `choices`
    extent,   ///< N or NxM, integers, or one of `choices`
    numbers,  ///< one or more numbers, separated by commas
    image,    ///< the name of an image, or of a recipe
    file,     ///< the name of another file
    text      ///< any text that is not empty
};

/// A row of the table.
struct Parameter {
    std::string name;
    ParameterType type = ParameterType::text;
    std::string unit;
    std::string default_value;  ///< as written in a recipe; may be empty, which `documentation` then explains
    std::vector<std::string> choices;
    /// The value of each choice in an enumeration of the core, where there is one.
    std::vector<int> enumerators;
    double minimum = 0, maximum = 0;  ///< the range of a number, whole, numbers or extent
    bool above_minimum = false;       ///< the minimum itself is not accepted (for number and numbers)
    std::string documentation;        ///< one line
    bool definitions = false;         ///< keys that are not in the table define names for it

    /// The accepted values in words: "a number from 0 to 10", "edges, centers".
    std::string accepted() const;
    /// The allowed values for a message: "must be a number from 0 to 10", "must be one of edges, centers".
    std::string rule() const;
};

/// All parameters of an operation, in the order of its documentation.
using ParameterTable = std::vector<Parameter>;

/// One `key=value`, as written.
struct Assignment {
    std::string key, value;
};

/// The values given to an operation's parameters, checked against a table; later values replace earlier ones.
class ParameterValues {
  public:
    /// Constructs values of which none is given yet. Keeps a reference to the table.
    explicit ParameterValues(const ParameterTable& table) : m_table(&table) {}

    /// Takes the assignments of one place (a file, a name, a call). Throws Error on an unknown key, a key
    /// given twice and a value that is not allowed. Where a parameter takes definitions, a key that is a name is never
    /// unknown: whoever reads them has to say which are of no use.
    void assign(const std::vector<Assignment>& place);

    /// Sets a parameter of type number, whole or toggle, or a name that is defined. Throws Error on a name that is not
    /// known and a value that is not allowed.
    void set(std::string_view name, double value) { set(name, std::vector<double>{value}); }
    /// Takes one value of type numbers.
    void set(std::string_view name, const std::vector<double>& values);
    /// Takes one value of type extent.
    void set(std::string_view name, const Size& value);
    /// Takes one value of any type, as it is written.
    void set(std::string_view name, const std::string& text);

    const ParameterTable& table() const { return *m_table; }
    /// Does the table have a parameter of this name?
    bool knows(std::string_view name) const;
    /// Was this parameter assigned a value?
    bool given(std::string_view name) const { return m_given.find(name) != m_given.end(); }
    /// The value as it was written, or the default.
    const std::string& text(std::string_view name) const;
    /// The value of a parameter of type number, whole, numbers, toggle and extent that were given or have a default. Numbers are those
    /// that were given, read once.
    double number(std::string_view name) const;
    /// The value of a whole number.
    int whole(std::string_view name) const;
    /// The values of a list of numbers.
    std::vector<double> numbers(std::string_view name) const;
    /// Is a toggle on?
    bool toggle(std::string_view name) const { return text(name) == "1"; }
    /// The choice that a parameter has, counted from 0; the number of choices where it has none of them.
    std::size_t choice(std::string_view name) const;
    /// The value that the choice of a parameter has in its enumeration (Parameter::enumerators).
    int enumerator(std::string_view name) const;
    /// The value of an extent. Its height is -1 where only one number was given.
    Size extent(std::string_view name) const;

    /// The definitions, by keys that are not in the table, in the order in which each key first came.
    const std::vector<Assignment>& definitions() const { return m_definitions; }
    /// Throws Error of the first definition, as assign() does of a key that is unknown: for operations that
    /// read no definitions.
    void refuse_definitions() const;

    /// All values as one text, which differs where any value does; `without` names the parameters to leave out.
    std::string key(const std::vector<std::string>& without = {}) const;

  private:
    /// A value as written, and the numbers in it, if there are any; for an extent its width and height.
    struct Given {
        std::string text;
        std::vector<double> numbers;
    };

    const ParameterTable* m_table;
    std::map<std::string, Given, std::less<>> m_given;
    std::vector<Assignment> m_definitions;

    bool defines(std::string_view name) const;
    void define(const Assignment& name);
    const Parameter& row_of(std::string_view name) const;
    /// The numbers of the given value, or those of the default. Throws Error where there are none.
    std::vector<double> numbers_of(std::string_view name) const;
};

/// Parses the text of a recipe file. Throws Error naming the line.
std::vector<Assignment> parse_recipe(std::string_view text);
/// The largest size of a recipe file, in bytes; parse_recipe() refuses longer ones.
inline constexpr std::size_t kMaxRecipeBytes = std::size_t{1} << 20;

/// A recipe name in its parts.
struct RecipeName {
    std::string base;
    std::vector<Assignment> assignments;
};

/// Splits a recipe name. Throws Error on an argument that is not key=value.
RecipeName parse_recipe_name(std::string_view name);

/// Returns `text` made fit for a message: at most 100 bytes of it, all printable.
std::string printable(std::string_view text);

/// The message of `error` as one printable line; where memory was short, "not enough memory for" `what`.
std::string message_of(const std::exception& error, const std::string& what);

/// A number in the fewest digits that read back as the same number.
std::string shortest(double value);
/// A float in the fewest digits that read back as the same float.
std::string shortest(float value);
/// A number to ten digits, for messages.
std::string brief(double value);

/// A page of Markdown with `title` and the parameters of the table.
std::string reference_page(const std::string& title, const ParameterTable& table);

}  // namespace anamorph
