// SPDX-License-Identifier: Apache-2.0
// A recipe whose picture is drawn again and again while one of its files is edited: its images are opened once, and the operation
// reads that file's text from memory.
//
// Frames. The picture can be drawn in any size: of it all positions that are given here are pixels, x right, y down.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/image/picture.h"
#include "anamorph/operation/operation.h"
#include "anamorph/source_stack.h"

namespace anamorph {
struct Recipe;
}

namespace anamorph_editor {

/// A picture that is ready to be drawn.
class ReadyPicture {
  public:
    anamorph::Size size() const { return m_request.size; }
    /// The largest proven bound in use over the whole picture, in source pixels; NaN where it is none of maps, which prove nothing.
    double max_error() const;

  private:
    friend class DrawnRecipe;
    anamorph::PictureRequest m_request;
    std::unique_ptr<const anamorph::SolvedPicture> m_solved;
};

/// Rows of pixels as a screen shows them: red, green and blue of 8 bits, row by row from the top, of a box of a picture.
struct ScreenPixels {
    anamorph::Box box;
    std::vector<unsigned char> rgb;

    unsigned char* at(int x, int y) {
        return &rgb[3 * (static_cast<std::size_t>(y - box.y0) * static_cast<std::size_t>(box.width()) +
                         static_cast<std::size_t>(x - box.x0))];
    }
};

/// The file that is saved to: `asked`, or `own` where that is empty. Throws Error where `asked` has none of the endings, which say what
/// is written.
std::string saved_file(const std::string& asked, const std::string& own,
                       const std::vector<std::string>& endings);

class DrawnRecipe {
  public:
    /// Opens the images of a recipe. `name`: as for OpenImageIO, x.png.warp?mesh=bulge.json, or that of a recipe file. `edited`: the
    /// key of the file whose text is edited. Throws Error.
    DrawnRecipe(const std::string& name, const std::string& edited);
    /// The image at a position among those of a recipe, as it stands.
    DrawnRecipe(const DrawnRecipe& of, std::size_t image);

    const anamorph::Operation& operation() const { return *m_operation; }
    const anamorph::ParameterValues& values() const { return m_values; }
    anamorph::ParameterValues& values() { return m_values; }
    /// The name of the file that is edited.
    const std::string& edited_file() const { return m_edited_file; }
    std::size_t images() const { return m_known.size(); }
    const anamorph::SourceImage& image(std::size_t i) const { return m_known[i]; }
    const std::string& image_file(std::size_t i) const { return m_image_files[i]; }
    /// What is read of an image.
    const anamorph::SourceStack& stack(std::size_t i) const { return *m_stacks[i]; }
    /// The pixels' type of the first image.
    anamorph::PixelType type() const { return m_type; }
    /// Are its colours light, to be shown in the curve of a screen?
    bool is_hdr() const {
        return m_type == anamorph::PixelType::half || m_type == anamorph::PixelType::float32;
    }

    /// Reads the recipe with `text`, JSON, in place of the file that is edited. `size`: that of the picture; 0: as the recipe says.
    /// Throws Error.
    ReadyPicture ready(const std::string& text, const anamorph::Size& size) const;
    /// Draws a box of a picture, which lies inside of that of `to`. Throws Error.
    void draw(const ReadyPicture& picture, const anamorph::Box& box, ScreenPixels& to) const;

  private:
    DrawnRecipe(const anamorph::Recipe& recipe, const std::string& edited);
    void open(const std::vector<std::string>& files);

    const anamorph::Operation* m_operation;
    anamorph::ParameterValues m_values;
    anamorph::SideFiles m_files;
    std::string m_edited, m_edited_file;
    std::vector<std::string> m_image_files;
    std::vector<anamorph::SourceImage> m_known;
    anamorph::SourceStacks m_stacks;
    anamorph::PixelType m_type = anamorph::PixelType::uint8;  ///< of the first image
};

}  // namespace anamorph_editor
