// SPDX-License-Identifier: Apache-2.0
#include "buffer_store.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <map>
#include <mutex>

#include "anamorph/parameter/parameter.h"
#include "recipe.h"

namespace anamorph {
namespace {

struct Stored {
    std::shared_ptr<const OIIO::ImageBuf> image;
    std::int64_t generation = 0;
};

struct Store {
    std::mutex mutex;
    std::map<std::string, Stored> images;
};

Store& store() {
    static auto& s = *new Store;
    return s;
}

/// The path in its shortest spelling, without ".XXXXXXXX.temp" in front of its extension.
std::string key_of(const std::string& path) {
    const std::string name = std::filesystem::path(path).lexically_normal().string();
    constexpr std::size_t kMark = 9, kTemp = 5;
    if (name.size() < kBufferExtension.size() + kTemp + kMark) return name;
    const std::size_t end = name.size() - kBufferExtension.size();
    const std::size_t begin = end - kTemp - kMark;
    const std::string mark = name.substr(begin, kMark);
    const bool hexadecimal = mark.find_first_not_of("0123456789abcdef", 1) == std::string::npos;
    const bool temporary = name.compare(end - kTemp, kTemp, ".temp") == 0 && mark[0] == '.' && hexadecimal;
    return temporary ? name.substr(0, begin) + name.substr(end) : name;
}

class BufferContent final : public Content {
  public:
    explicit BufferContent(std::shared_ptr<const OIIO::ImageBuf> image) : m_image(std::move(image)) {
        m_spec = m_image->spec();
        m_spec.tile_width = m_spec.tile_height = kTile;
        m_spec.tile_depth = 1;
    }

    int levels(int) const override { return 1; }
    const OIIO::ImageSpec& spec(int, int) const override { return m_spec; }

    void read(int, int, const Box& box, std::byte* pixels) const override {
        const Box inside = intersection(box, {0, 0, m_spec.width, m_spec.height});
        const auto pixel = static_cast<std::ptrdiff_t>(m_spec.pixel_bytes());
        const auto* from = static_cast<const std::byte*>(m_image->localpixels());
        for (int y = box.y0; y < box.y1; ++y) {
            std::byte* row = pixels + (y - box.y0) * box.width() * pixel;
            const int count = y < inside.y1 ? inside.width() : 0;
            if (count > 0)
                std::memcpy(row, from + y * m_image->scanline_stride() + box.x0 * pixel,
                            static_cast<std::size_t>(count * pixel));
            std::memset(row + count * pixel, 0, static_cast<std::size_t>((box.width() - count) * pixel));
        }
    }

  private:
    static constexpr int kTile = 256;

    std::shared_ptr<const OIIO::ImageBuf> m_image;
    OIIO::ImageSpec m_spec;
};

}  // namespace

void store_buffer(const std::string& name, std::shared_ptr<const OIIO::ImageBuf> image) {
    std::lock_guard lock(store().mutex);
    Stored& stored = store().images[key_of(name)];
    stored.image = std::move(image);
    ++stored.generation;
}

std::int64_t buffer_generation(const std::string& name) {
    std::lock_guard lock(store().mutex);
    const auto found = store().images.find(key_of(name));
    return found == store().images.end() ? 0 : found->second.generation;
}

std::shared_ptr<const Content> open_buffer(const std::string& name) {
    std::lock_guard lock(store().mutex);
    const auto found = store().images.find(key_of(name));
    if (found == store().images.end())
        throw Error("no image \"" + printable(name) + "\" is in memory: write it first in the same process");
    return std::make_shared<BufferContent>(found->second.image);
}

}  // namespace anamorph
