// SPDX-License-Identifier: Apache-2.0
#include "anamorph/side_files.h"

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/strutil.h>

#include <filesystem>
#include <fstream>
#include <vector>

#include "anamorph/file_names.h"
#include "anamorph/image_source.h"
#include "anamorph/map/features_file.h"
#include "anamorph/map/mesh_file.h"
#include "anamorph/memo.h"
#include "anamorph/orientation.h"
#include "anamorph/text_file.h"

namespace anamorph {
namespace {

namespace fs = std::filesystem;
namespace Strutil = OIIO::Strutil;

/// The whole of a text file of at most `most` bytes.
std::string read_text(const std::string& name, std::size_t most) {
    const std::string what = "file \"" + printable(name) + "\"";
    std::error_code failure;
    const fs::file_status status = fs::status(name, failure);
    if (!fs::exists(status)) throw Error(what + " does not exist");
    if (!fs::is_regular_file(status)) throw Error(what + " is not a file");
    const std::uintmax_t size = fs::file_size(name, failure);
    if (failure || size > most)
        throw Error(what + " has " + std::to_string(size) + " bytes: must have at most " +
                    std::to_string(most));
    std::string text(static_cast<std::size_t>(size), '\0');
    std::ifstream file(name, std::ios::binary);
    if (!file || (size > 0 && !file.read(text.data(), static_cast<std::streamsize>(size))))
        throw Error(what + " cannot be read");
    return text;
}

/// Read past any cache, on this thread alone: a read may go on around us.
WarpMap read_stmap(const std::string& name, int step) {
    const std::string what = "ST-map \"" + printable(name) + "\"";
    check_file_name("mesh", name);
    const auto input = OIIO::ImageInput::open(name);
    if (!input) {
        const std::string why = reason_of(OIIO::geterror(), name, name);
        throw Error(what + ": " + (why.empty() ? "cannot be read" : why));
    }
    input->threads(1);
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.deep || spec.depth > 1) throw Error(what + " is deep or a volume: must be a flat image");
    if (spec.nchannels < 2) throw Error(what + " has one channel: must have two, u and v");
    constexpr std::int64_t kMostPixels = std::int64_t{1} << 28;
    if (std::int64_t{spec.width} * spec.height > kMostPixels)
        throw Error(what + " has " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                    " pixels: must have at most " + std::to_string(kMostPixels));
    const auto vertices = [&](int size) { return std::int64_t{(size - 1) / step} + 2; };
    if (vertices(spec.width) * vertices(spec.height) > ControlMesh::kMaxVertices)
        throw Error("step", std::to_string(step),
                    what + " of " + std::to_string(spec.width) + "x" + std::to_string(spec.height) +
                        " makes too many vertices: must make at most " +
                        std::to_string(ControlMesh::kMaxVertices));
    std::vector<float> uv(static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.height) * 2);
    if (!input->read_image(0, 0, 0, 2, OIIO::TypeFloat, uv.data())) {
        throw Error(what + ": " + reason_of(input->geterror(), name, name));
    }
    const StoredOrder order(spec);
    if (order.is_upright())
        return mesh_from_stmap(uv.data(), spec.width, spec.height, 2, std::ptrdiff_t{2} * spec.width, step,
                               name);
    const Size size = order.upright_size({spec.width, spec.height});
    constexpr std::ptrdiff_t kPixel = 2 * sizeof(float);
    std::vector<float> turned(uv.size());
    order.turn(reinterpret_cast<const std::byte*>(uv.data()), reinterpret_cast<std::byte*>(turned.data()),
               size.width, size.height, kPixel, kPixel * size.width);
    return mesh_from_stmap(turned.data(), size.width, size.height, 2, std::ptrdiff_t{2} * size.width, step,
                           name);
}

/// What make() makes, kept for the next who asks where the file's state has an identity.
template <class Value, class Make>
std::shared_ptr<const Value> keep(const SideFile& file, const std::string& how, const Make& make) {
    const auto made = [&] { return std::make_shared<const Value>(make()); };
    static auto& memo = *new Memo<const Value>(4);
    return file.identity.empty() ? made() : memo.get(how + "\n" + file.identity, made);
}

}  // namespace

std::shared_ptr<const WarpMap> read_warp_map(const SideFile& file, int step) {
    const bool text = Strutil::iends_with(file.name, ".json");
    if (text && step != 1) throw Error("step", std::to_string(step), "must be given with ST-maps only");
    return keep<WarpMap>(file, "mesh " + std::to_string(step), [&] {
        return text ? parse_warp_file(read_text(file.name, text_file::kMostBytes), file.name)
                    : read_stmap(file.name, step);
    });
}

std::shared_ptr<const WarpMap> read_points(const SideFile& file) {
    return keep<WarpMap>(file, "points", [&] {
        return parse_warp_file(read_text(file.name, text_file::kMostBytes), file.name);
    });
}

std::shared_ptr<const Features> read_features(const SideFile& file) {
    return keep<Features>(file, "features", [&] {
        return parse_features_file(read_text(file.name, text_file::kMostBytes), file.name);
    });
}

}  // namespace anamorph
