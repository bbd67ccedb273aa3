// SPDX-License-Identifier: Apache-2.0
// The functions that the page's worker calls. Texts are UTF-8; those that are returned stay until the next call. Whatever fails is said as
// {"error": "..."}, and no exception leaves.
#include <emscripten/emscripten.h>

#include <cstdint>
#include <cstdlib>
#include <nlohmann/json.hpp>
#include <variant>

#include "anamorph/chart/chart.h"
#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/version.h"
#include "page.h"

namespace anamorph::web {
namespace {

using Json = nlohmann::json;

Page& page() {
    static Page page;
    return page;
}

/// The text of what `make` gives, or of why it does not.
template <class Make>
const char* answer(const Make& make) {
    static std::string text;
    try {
        text = make().dump(-1, ' ', false, Json::error_handler_t::replace);
    } catch (const std::exception& error) {
        text = Json{{"error", message_of(error, "the picture")}}.dump(-1, ' ', false,
                                                                      Json::error_handler_t::replace);
    }
    return text.c_str();
}

Json size_json() {
    return {{"width", page().source_size().width}, {"height", page().source_size().height}};
}

/// What a page offers to choose from, as the operations' own tables have it.
Json described() {
    Json projections = Json::array();
    for (const Projection p : kProjections) {
        const FieldOfView fov = fov_of(p);
        const FaceGrid faces = faces_of(p);
        projections.push_back({{"name", name_of(p)},
                               {"fov", fov.standard},
                               {"most", fov.most},
                               {"open", fov.open},
                               {"fixed", fov.fixed},
                               {"columns", faces.columns},
                               {"rows", faces.rows}});
    }
    Json operations_json = Json::object();
    for (const Operation* operation : page_operations()) {
        Json keys = Json::object();
        for (const Parameter& p : *operation->parameters)
            keys[p.name] = {{"default", p.default_value}, {"choices", p.choices}, {"help", p.documentation}};
        operations_json[operation->name] = {{"title", operation->title}, {"keys", keys}};
    }
    return {{"version", version()}, {"projections", projections}, {"operations", operations_json}};
}

}  // namespace
}  // namespace anamorph::web

using anamorph::web::answer;
using anamorph::web::Json;
using anamorph::web::page;

extern "C" {

EMSCRIPTEN_KEEPALIVE const char* anamorph_describe() {
    return answer([] { return anamorph::web::described(); });
}

/// Room for so many bytes; null where there is none.
EMSCRIPTEN_KEEPALIVE std::uint8_t* anamorph_room(std::size_t bytes) {
    return static_cast<std::uint8_t*>(std::malloc(bytes));
}
EMSCRIPTEN_KEEPALIVE void anamorph_free(std::uint8_t* room) {
    std::free(room);
}

EMSCRIPTEN_KEEPALIVE const char* anamorph_image(const std::uint8_t* rgba, int width, int height) {
    return answer([=] {
        page().take_image(rgba, {width, height});
        return anamorph::web::size_json();
    });
}
EMSCRIPTEN_KEEPALIVE const char* anamorph_sample(int height) {
    return answer([=] {
        page().take_sample(height);
        return anamorph::web::size_json();
    });
}
/// Red, green and blue of the image.
EMSCRIPTEN_KEEPALIVE const std::uint8_t* anamorph_image_pixels() {
    return page().source_pixels().data();
}

EMSCRIPTEN_KEEPALIVE const char* anamorph_file(const char* name, const char* text) {
    return answer([=] {
        page().add_file(name, text);
        return Json::object();
    });
}

EMSCRIPTEN_KEEPALIVE const char* anamorph_plan(const char* recipe) {
    return answer([=] {
        page().plan(recipe);
        Json says = Json::object();
        for (const anamorph::Attribute& attribute : page().says())
            std::visit([&](const auto& value) { says[attribute.name] = value; }, attribute.value);
        return Json{{"width", page().size().width}, {"height", page().size().height}, {"says", says}};
    });
}

EMSCRIPTEN_KEEPALIVE const char* anamorph_draw(int y0, int y1, std::uint8_t* rgba) {
    return answer([=] {
        page().draw(y0, y1, rgba);
        return Json::object();
    });
}
EMSCRIPTEN_KEEPALIVE const char* anamorph_hash(const std::uint8_t* rgba) {
    return answer([=] { return Json{{"hash", anamorph::hash_digits(page().hash(rgba))}}; });
}

}  // extern "C"
