// SPDX-License-Identifier: Apache-2.0
#include "anamorph/parameter/json_file.h"

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

namespace anamorph::text_file {
namespace {

using Value = nlohmann::json;

const Value& value_at(const void* value) {
    return *static_cast<const Value*>(value);
}

Value parsed(std::string_view text, std::string_view file) {
    // A file that is nothing but brackets must not fill the memory.
    constexpr int kDepth = 8;
    // Of the objects that are open, the outermost first.
    std::vector<std::set<std::string>> keys;
    const auto check_keys = [&](Value::parse_event_t event, const Value& value) {
        if (event == Value::parse_event_t::object_start) keys.emplace_back();
        if (event == Value::parse_event_t::object_end) keys.pop_back();
        if (event == Value::parse_event_t::key && !keys.back().insert(value.get<std::string>()).second)
            fail(file, "",
                 "\"" + excerpt(value.get<std::string>()) + "\" is given twice: must be given once");
    };
    try {
        return Value::parse(text, [&](int depth, Value::parse_event_t event, const Value& value) {
            if (depth > kDepth)
                fail(file, "", "brackets stand more than " + std::to_string(kDepth) + " deep");
            check_keys(event, value);
            return true;
        });
    } catch (const Value::exception& error) {
        // The reader's own prefix is left out.
        const std::string_view what = error.what();
        const std::size_t end = what.find("] ");
        fail(file, "", "is no JSON: " + excerpt(end == std::string_view::npos ? what : what.substr(end + 2)));
    }
}

/// From the leaves up: the library's own way to free a tree asks for memory, and ends the program where there is none.
void clear(Value& tree) {
    if (!tree.is_structured()) return;
    for (Value& part : tree) clear(part);
    tree.clear();
}
std::shared_ptr<void> shared(Value&& tree) {
    return {new Value(std::move(tree)), [](Value* value) {
                clear(*value);
                delete value;
            }};
}

}  // namespace

bool Json::is_object() const {
    return value_at(m_value).is_object();
}
bool Json::is_array() const {
    return value_at(m_value).is_array();
}
bool Json::is_string() const {
    return value_at(m_value).is_string();
}
bool Json::is_boolean() const {
    return value_at(m_value).is_boolean();
}
bool Json::is_number() const {
    return value_at(m_value).is_number();
}
bool Json::is_float() const {
    return value_at(m_value).is_number_float();
}

double Json::number() const {
    return value_at(m_value).get<double>();
}
bool Json::boolean() const {
    return value_at(m_value).get<bool>();
}
const std::string& Json::string() const {
    return value_at(m_value).get_ref<const std::string&>();
}
std::string Json::text() const {
    return value_at(m_value).dump(-1, ' ', true, Value::error_handler_t::replace);
}

std::size_t Json::size() const {
    return value_at(m_value).size();
}
Json Json::operator[](std::size_t i) const {
    return Json(&value_at(m_value)[i]);
}
std::vector<Json> Json::entries() const {
    std::vector<Json> all;
    for (const Value& entry : value_at(m_value)) all.push_back(Json(&entry));
    return all;
}
bool Json::all_numbers() const {
    const Value& list = value_at(m_value);
    return std::all_of(list.begin(), list.end(), [](const Value& v) { return v.is_number(); });
}
bool Json::contains(const std::string& key) const {
    return value_at(m_value).contains(key);
}
Json Json::member(const std::string& key) const {
    return Json(&value_at(m_value)[key]);
}
std::vector<std::pair<std::string, Json>> Json::members() const {
    std::vector<std::pair<std::string, Json>> all;
    for (const auto& item : value_at(m_value).items()) all.emplace_back(item.key(), Json(&item.value()));
    return all;
}

JsonFile::JsonFile() : m_top(shared(Value::object())) {}
JsonFile::JsonFile(std::string_view text, std::string_view file) : m_top(shared(parsed(text, file))) {}

void JsonFile::set(const std::string& key, double number) {
    (*static_cast<Value*>(m_top.get()))[key] = number;
}
void JsonFile::set(const std::string& key, bool value) {
    (*static_cast<Value*>(m_top.get()))[key] = value;
}
void JsonFile::set(const std::string& key, std::string_view text) {
    (*static_cast<Value*>(m_top.get()))[key] = std::string(text);
}

}  // namespace anamorph::text_file
