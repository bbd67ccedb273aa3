// SPDX-License-Identifier: Apache-2.0
// A picture of a recipe over an image in memory, for the page: what plugins/imageio is to OpenImageIO's hosts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/image/picture_hash.h"
#include "anamorph/image/source.h"
#include "anamorph/operation/operation.h"

namespace anamorph::web {

/// The operations of the page: those on one image, and the core has others. What is not named here is not linked.
const std::vector<const Operation*>& page_operations();

/// An image of uint8, and the picture that a recipe makes of it.
class Page {
  public:
    Page();
    ~Page();

    /// Takes pixels of red, green, blue and alpha as a browser has them; alpha is left out.
    void take_image(const std::uint8_t* rgba, const Size& size);
    /// Takes the sample, a panorama (sample.h).
    void take_sample(int height);
    Size source_size() const { return m_source_size; }
    /// Red, green, blue of the image, row by row.
    const std::vector<std::uint8_t>& source_pixels() const { return m_source_pixels; }

    /// A text that recipes may name as a file.
    void add_file(const std::string& name, const std::string& text) { m_files[name] = text; }

    /// Reads a recipe without the name of its source, pano?to=fisheye, and plans it. Throws Error.
    void plan(const std::string& recipe);
    Size size() const { return m_size; }
    /// What the picture says of itself: anamorph:tol, anamorph:max_error and so on.
    const Attributes& says() const { return m_says; }

    /// Draws rows [y0, y1) into rows of pixels of red, green, blue and alpha, of which the first is row y0. Throws Error.
    void draw(int y0, int y1, std::uint8_t* rgba) const;
    /// The hash of the picture that has these pixels, as the program anamorph prints it of the same recipe and image.
    PictureHash hash(const std::uint8_t* rgba) const;

  private:
    std::vector<std::uint8_t> m_source_pixels;
    Size m_source_size;
    std::map<std::string, std::string> m_files;
    std::unique_ptr<const Source> m_image, m_over, m_pyramid;
    SourceFaces m_faces;  ///< of which m_pyramid is made

    std::unique_ptr<const SolvedPicture> m_picture;
    Size m_size;
    Attributes m_says;
};

}  // namespace anamorph::web
