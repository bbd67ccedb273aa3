// SPDX-License-Identifier: Apache-2.0
// What files of glTF 2.0 have in common: a buffer of bytes with the accessors that say what is in it, and the container .glb.
// For the files that write them alone, as it includes the library of JSON.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace anamorph::gltf {

using Json = nlohmann::json;

/// What glTF calls its numbers.
constexpr int kArrayBuffer = 34962;

/// The bytes of a glTF file and what they hold.
class Buffer {
  public:
    /// An accessor of `width` floats each (1 to 4); `bounds`: with the least and greatest of each. Returns its number.
    int add_floats(const std::vector<float>& values, int width, bool bounds, int target = 0);
    /// Numbers of points, of which there are `points` in all; in two bytes each where these hold them.
    int add_indices(std::span<const std::uint32_t> indices, std::size_t points);

    std::string bytes;
    Json views = Json::array(), accessors = Json::array();

  private:
    Json view(const void* data, std::size_t size, int target);
    int add(const Json& accessor);
};

/// The text of a document whose other members are `json`. `uri`: the file of the buffer's bytes; none in a .glb.
std::string document(Json json, const Buffer& buffer, const std::string& uri = {});
/// The document and its bytes in one file. Throws Error if that takes 4 GB.
std::string glb(const Json& json, const Buffer& buffer);

}  // namespace anamorph::gltf
