// SPDX-License-Identifier: Apache-2.0
#include "picture_reader.h"

#include <algorithm>
#include <cstring>

#include "anamorph/error.h"
#include "anamorph/file_names.h"
#include "anamorph/open_image.h"
#include "anamorph/parameter/parameter.h"
#include "recipe.h"
#include "recipe_content.h"

namespace anamorph::command {

using OIIO::ImageSpec;
using OIIO::TypeDesc;

namespace {

/// A recipe, without what all of it would have to be planned for.
class RecipePicture final : public PictureReader {
  public:
    RecipePicture(const std::string& name, const std::vector<Assignment>& given)
        : m_name(name), m_given(given), m_content(open_recipe(name, given)) {}
    int subimages() override { return m_content->subimages(); }
    const ImageSpec& spec(int subimage) override { return m_content->header(subimage, 0); }
    void read(int subimage, const Box& box, std::byte* pixels) override {
        m_content->read(subimage, 0, box, pixels);
    }
    std::string state() const override { return RecipeReader().load(m_name, m_given).identity; }

  private:
    std::string m_name;
    std::vector<Assignment> m_given;
    std::shared_ptr<const Content> m_content;
};

/// A file that OpenImageIO reads, one row of tiles of ours after the other.
class FilePicture final : public PictureReader {
  public:
    explicit FilePicture(const std::string& name) : m_name(name) {
        check_file_name("FILE", name);
        m_file = open_image(name);
        if (!m_file) throw Error(OIIO::geterror());
        while (m_file->seek_subimage(static_cast<int>(m_specs.size()), 0)) {
            m_specs.push_back(m_file->spec());
            if (m_specs.back().deep || m_specs.back().depth > 1)
                throw Error(printable(name) + ": must be a flat image");
        }
    }
    int subimages() override { return static_cast<int>(m_specs.size()); }
    const ImageSpec& spec(int subimage) override { return m_specs.at(static_cast<std::size_t>(subimage)); }
    void read(int subimage, const Box& box, std::byte* pixels) override {
        const ImageSpec& s = spec(subimage);
        if (subimage != m_subimage || box.y0 < m_begin || box.y1 > m_end) read_rows(subimage, box.y0, box.y1);
        const std::size_t pixel = s.pixel_bytes(true), row = pixel * static_cast<std::size_t>(s.width);
        for (int y = box.y0; y < box.y1; ++y, pixels += pixel * static_cast<std::size_t>(box.width()))
            std::memcpy(pixels,
                        m_rows.data() + row * static_cast<std::size_t>(y - m_begin) +
                            pixel * static_cast<std::size_t>(box.x0),
                        pixel * static_cast<std::size_t>(box.width()));
    }

  private:
    /// Reads whole rows: those asked for, and those that are in the same tiles of the file.
    void read_rows(int subimage, int begin, int end) {
        const ImageSpec& s = spec(subimage);
        const int high = std::max(1, s.tile_height);
        m_begin = begin / high * high;
        m_end = std::min(s.height, (end + high - 1) / high * high);
        m_subimage = subimage;
        m_rows.resize(s.pixel_bytes(true) * static_cast<std::size_t>(s.width) *
                      static_cast<std::size_t>(m_end - m_begin));
        const bool done =
            s.tile_width > 0 ? m_file->read_tiles(subimage, 0, s.x, s.x + s.width, s.y + m_begin, s.y + m_end,
                                                  0, 1, 0, s.nchannels, TypeDesc::UNKNOWN, m_rows.data())
                             : m_file->read_scanlines(subimage, 0, s.y + m_begin, s.y + m_end, 0, 0,
                                                      s.nchannels, TypeDesc::UNKNOWN, m_rows.data());
        if (!done) throw Error(printable(m_name) + ": " + m_file->geterror());
    }

    std::string m_name;
    std::unique_ptr<OIIO::ImageInput> m_file;
    std::vector<ImageSpec> m_specs;
    std::vector<std::byte> m_rows;  ///< from m_begin to m_end of m_subimage
    int m_subimage = -1, m_begin = 0, m_end = 0;
};

}  // namespace

std::unique_ptr<PictureReader> open_picture(const std::string& name, const std::vector<Assignment>& given) {
    if (operation_of(name)) return std::make_unique<RecipePicture>(name, given);
    return std::make_unique<FilePicture>(name);
}

PictureHash hash_of(PictureReader& picture) {
    FileHasher hasher;
    for (int s = 0; s < picture.subimages(); ++s)
        hasher.add_picture(hashed_picture(picture.spec(s)),
                           [&](const Box& box, std::byte* pixels) { picture.read(s, box, pixels); });
    return hasher.hash();
}

}  // namespace anamorph::command
