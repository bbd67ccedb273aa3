// SPDX-License-Identifier: Apache-2.0
// JSON as its readers share it. The library that parses it is included by parameter/json_file.cpp alone: each
// file that includes it takes seconds more to compile.
#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "anamorph/parameter/text_file.h"

namespace anamorph::text_file {

/// A value in a JsonFile, which has to outlive it.
class Json {
  public:
    bool is_object() const;
    bool is_array() const;
    bool is_string() const;
    bool is_boolean() const;
    bool is_number() const;
    /// Is it a number with a point or an exponent?
    bool is_float() const;

    /// The value as a number; it has to be one. So it is with boolean() and string().
    double number() const;
    bool boolean() const;
    const std::string& string() const;
    /// The JSON of the value, on one line and in ASCII: for messages.
    std::string text() const;

    /// The number of members or entries.
    std::size_t size() const;
    bool empty() const { return size() == 0; }
    /// Entry i of a list; it must be there.
    Json operator[](std::size_t i) const;
    /// All entries of a list.
    std::vector<Json> entries() const;
    bool all_numbers() const;
    bool contains(const std::string& key) const;
    /// A member of an object; it must be there.
    Json member(const std::string& key) const;
    /// All members of an object, by name.
    std::vector<std::pair<std::string, Json>> members() const;

  private:
    friend class JsonFile;
    explicit Json(const void* value) : m_value(value) {}

    const void* m_value;
};

/// The value that a file of JSON holds.
class JsonFile {
  public:
    /// Makes an object without members.
    JsonFile();
    /// Parses a text. Throws Error naming the file, and the key that stands twice in an object.
    JsonFile(std::string_view text, std::string_view file);

    Json top() const { return Json(m_top.get()); }

    /// Gives the object a member.
    void set(const std::string& key, double number);
    void set(const std::string& key, bool value);
    void set(const std::string& key, std::string_view text);

  private:
    std::shared_ptr<void> m_top;
};

}  // namespace anamorph::text_file
