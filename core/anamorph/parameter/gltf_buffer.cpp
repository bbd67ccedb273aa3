// SPDX-License-Identifier: Apache-2.0
#include "anamorph/parameter/gltf_buffer.h"

#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "anamorph/error.h"
#include "anamorph/version.h"

namespace anamorph::gltf {
namespace {

constexpr int kFloat = 5126, kShort = 5123, kInt = 5125, kElementArray = 34963;

void add_words(std::string& file, std::initializer_list<std::uint32_t> words) {
    for (const std::uint32_t word : words)
        for (int k = 0; k < 4; ++k) file += static_cast<char>(word >> (8 * k) & 0xff);
}

}  // namespace

int Buffer::add_floats(const std::vector<float>& values, int width, bool bounds, int target) {
    static constexpr const char* kTypes[] = {"", "SCALAR", "VEC2", "VEC3", "VEC4"};
    Json accessor = view(values.data(), values.size() * sizeof(float), target);
    accessor["componentType"] = kFloat;
    accessor["count"] = values.size() / static_cast<std::size_t>(width);
    accessor["type"] = kTypes[width];
    if (bounds)
        for (int c = 0; c < width; ++c) {
            float least = HUGE_VALF, most = -HUGE_VALF;
            for (std::size_t i = static_cast<std::size_t>(c); i < values.size();
                 i += static_cast<std::size_t>(width)) {
                least = std::min(least, values[i]);
                most = std::max(most, values[i]);
            }
            accessor["min"].push_back(least);
            accessor["max"].push_back(most);
        }
    return add(accessor);
}

int Buffer::add_indices(std::span<const std::uint32_t> indices, std::size_t points) {
    const bool fit_short = points <= 0xffff;
    std::vector<std::uint16_t> narrow;
    if (fit_short)
        for (const std::uint32_t index : indices) narrow.push_back(static_cast<std::uint16_t>(index));
    Json accessor = fit_short ? view(narrow.data(), narrow.size() * sizeof(narrow[0]), kElementArray)
                              : view(indices.data(), indices.size_bytes(), kElementArray);
    accessor["componentType"] = fit_short ? kShort : kInt;
    accessor["count"] = indices.size();
    accessor["type"] = "SCALAR";
    return add(accessor);
}

Json Buffer::view(const void* data, std::size_t size, int target) {
    Json view{{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}};
    if (target) view["target"] = target;
    bytes.append(static_cast<const char*>(data), size);
    bytes.append((4 - bytes.size() % 4) % 4, '\0');
    views.push_back(view);
    return {{"bufferView", views.size() - 1}};
}

int Buffer::add(const Json& accessor) {
    accessors.push_back(accessor);
    return static_cast<int>(accessors.size()) - 1;
}

std::string document(Json json, const Buffer& buffer, const std::string& uri) {
    json["asset"] = {{"version", "2.0"}, {"generator", std::string("Anamorph ") + version()}};
    json["accessors"] = buffer.accessors;
    json["bufferViews"] = buffer.views;
    json["buffers"] = Json::array({Json{{"byteLength", buffer.bytes.size()}}});
    if (!uri.empty()) json["buffers"][0]["uri"] = uri;
    return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

std::string glb(const Json& json, const Buffer& buffer) {
    std::string text = document(json, buffer);
    text.append((4 - text.size() % 4) % 4, ' ');
    constexpr std::uint32_t kMagic = 0x46546c67, kVersion = 2, kJson = 0x4e4f534a, kBinary = 0x004e4942;
    std::string file;
    const std::size_t size = 12 + 8 + text.size() + 8 + buffer.bytes.size();
    if (size > 0xffffffff) throw Error("it does not fit a file of 4 GB");
    add_words(file, {kMagic, kVersion, static_cast<std::uint32_t>(size),
                     static_cast<std::uint32_t>(text.size()), kJson});
    file += text;
    add_words(file, {static_cast<std::uint32_t>(buffer.bytes.size()), kBinary});
    return file + buffer.bytes;
}

}  // namespace anamorph::gltf
