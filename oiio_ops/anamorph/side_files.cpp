// SPDX-License-Identifier: Apache-2.0
#include "anamorph/side_files.h"

#include <OpenImageIO/imageio.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <mutex>
#include <set>
#include <vector>

#include "anamorph/file_names.h"
#include "anamorph/image_source.h"
#include "anamorph/open_image.h"
#include "anamorph/orientation.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

namespace fs = std::filesystem;

class OiioImage final : public SideImage {
  public:
    OiioImage(const std::string& key, const std::string& name)
        : m_name(name), m_what("image \"" + printable(name) + "\"") {
        check_file_name(key, name);
        // The numbers that are stored, whatever alpha is.
        OIIO::ImageSpec config;
        config.attribute("oiio:UnassociatedAlpha", 1);
        m_input = open_image(name, &config);
        if (!m_input) {
            const std::string why = reason_of(OIIO::geterror(), name, name);
            throw Error(m_what + ": " + (why.empty() ? "cannot be read" : why));
        }
        // A read may go on around us.
        m_input->threads(1);
        const OIIO::ImageSpec& spec = m_input->spec();
        if (spec.deep || spec.depth > 1) throw Error(m_what + " is deep or a volume: must be a flat image");
        check_windows(spec, m_what);
        m_has_more_parts = m_input->seek_subimage(1, 0);
        if (!m_has_more_parts)
            static_cast<void>(m_input->geterror());  // that there is no such part is no error
        m_input->seek_subimage(0, 0);
    }

    bool has_more_parts() const { return m_has_more_parts; }

    Size size() const override {
        const OIIO::ImageSpec& spec = m_input->spec();
        return StoredOrder(spec).upright_size({spec.width, spec.height});
    }
    Box display() const override {
        const OIIO::ImageSpec& spec = m_input->spec();
        const int x = spec.full_x - spec.x, y = spec.full_y - spec.y;
        return StoredOrder(spec).upright_box({x, y, x + spec.full_width, y + spec.full_height},
                                             {spec.width, spec.height});
    }
    int channels() const override { return m_input->spec().nchannels; }
    int alpha() const override { return m_input->spec().alpha_channel; }

    std::vector<float> read(int count) override {
        const OIIO::ImageSpec& spec = m_input->spec();
        std::vector<float> stored(static_cast<std::size_t>(spec.width) *
                                  static_cast<std::size_t>(spec.height) * static_cast<std::size_t>(count));
        if (!m_input->read_image(0, 0, 0, count, OIIO::TypeFloat, stored.data()))
            throw Error(m_what + ": " + reason_of(m_input->geterror(), m_name, m_name));
        const StoredOrder order(spec);
        if (order.is_upright()) return stored;
        const auto pixel = static_cast<std::ptrdiff_t>(sizeof(float)) * count;
        std::vector<float> turned(stored.size());
        order.turn(reinterpret_cast<const std::byte*>(stored.data()),
                   reinterpret_cast<std::byte*>(turned.data()), size().width, size().height, pixel,
                   pixel * size().width);
        return turned;
    }

  private:
    std::string m_name, m_what;
    std::unique_ptr<OIIO::ImageInput> m_input;
    bool m_has_more_parts = false;
};

/// The identities of files with several parts: what is kept of a file is not opened again.
class FilesOfParts {
  public:
    static FilesOfParts& instance() {
        static auto& files = *new FilesOfParts;
        return files;
    }
    void add(const std::string& identity) {
        const std::lock_guard lock(m_mutex);
        m_identities.insert(identity);
    }
    bool has(const std::string& identity) const {
        const std::lock_guard lock(m_mutex);
        return m_identities.count(identity) > 0;
    }

  private:
    mutable std::mutex m_mutex;
    std::set<std::string> m_identities;
};

/// An image in memory, as its numbers are stored.
class MemoryImage final : public SideImage {
  public:
    explicit MemoryImage(const OIIO::ImageBuf& image) : m_image(image) {}
    Size size() const override { return {m_image.spec().width, m_image.spec().height}; }
    Box display() const override {
        const OIIO::ImageSpec& spec = m_image.spec();
        const int x = spec.full_x - spec.x, y = spec.full_y - spec.y;
        return {x, y, x + spec.full_width, y + spec.full_height};
    }
    int channels() const override { return m_image.nchannels(); }
    int alpha() const override { return m_image.spec().alpha_channel; }
    std::vector<float> read(int count) override {
        std::vector<float> pixels(static_cast<std::size_t>(size().width) *
                                  static_cast<std::size_t>(size().height) * static_cast<std::size_t>(count));
        OIIO::ROI roi = m_image.roi();
        roi.chend = count;
        if (!m_image.get_pixels(roi, OIIO::TypeFloat, pixels.data())) throw Error(m_image.geterror());
        return pixels;
    }

  private:
    const OIIO::ImageBuf& m_image;
};

class FileReader final : public SideFileReader {
  public:
    std::string text(const std::string& name) const override {
        const std::string what = "file \"" + printable(name) + "\"";
        std::error_code failure;
        const fs::file_status status = fs::status(name, failure);
        if (!fs::exists(status)) throw Error(what + " does not exist");
        if (!fs::is_regular_file(status)) throw Error(what + " is not a file");
        const std::uintmax_t size = fs::file_size(name, failure);
        if (failure || size > text_file::kMostBytes)
            throw Error(what + " has " + std::to_string(size) + " bytes: must have at most " +
                        std::to_string(text_file::kMostBytes));
        std::string text(static_cast<std::size_t>(size), '\0');
        std::ifstream file(name, std::ios::binary);
        if (!file || (size > 0 && !file.read(text.data(), static_cast<std::streamsize>(size))))
            throw Error(what + " cannot be read");
        return text;
    }

    bool exists(const std::string& name) const override {
        std::error_code failure;
        return fs::is_regular_file(name, failure);
    }

    std::unique_ptr<SideImage> image(const std::string& key, const std::string& name) const override {
        return std::make_unique<OiioImage>(key, name);
    }
};

}  // namespace

const SideFileReader& side_file_reader() {
    static const FileReader reader;
    return reader;
}

std::string MemoryFileReader::text(const std::string& name) const {
    const auto found = m_files.texts.find(name);
    return found != m_files.texts.end() ? found->second : side_file_reader().text(name);
}

bool MemoryFileReader::exists(const std::string& name) const {
    return m_files.texts.count(name) > 0 || side_file_reader().exists(name);
}

std::unique_ptr<SideImage> MemoryFileReader::image(const std::string& key, const std::string& name) const {
    const auto found = m_files.images.find(name);
    if (found != m_files.images.end()) return std::make_unique<MemoryImage>(*found->second);
    return side_file_reader().image(key, name);
}

namespace {

/// What `read` returns; an error of it that names no key names this one.
template <class Read>
auto naming(const std::string& key, const Read& read) {
    try {
        return read();
    } catch (const Error& error) {
        if (key.empty() || !error.parameter().empty()) throw;
        throw Error(key + ": " + error.what());
    }
}

}  // namespace

std::string KeyedFileReader::text(const std::string& name) const {
    const auto named = std::find_if(m_files.begin(), m_files.end(),
                                    [&](const auto& file) { return file.second.name == name; });
    return naming(named == m_files.end() ? "" : named->first, [&] { return m_reader.text(name); });
}

std::unique_ptr<SideImage> KeyedFileReader::image(const std::string& key, const std::string& name) const {
    std::unique_ptr<SideImage> image = naming(key, [&] { return m_reader.image(key, name); });
    if (const auto* opened = dynamic_cast<const OiioImage*>(image.get()); opened && opened->has_more_parts())
        for (const auto& [k, file] : m_files)
            if (file.name == name && !file.identity.empty()) FilesOfParts::instance().add(file.identity);
    return image;
}

bool is_first_of_parts(const SideFile& file) {
    return !file.identity.empty() && FilesOfParts::instance().has(file.identity);
}

}  // namespace anamorph
