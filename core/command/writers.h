// SPDX-License-Identifier: Apache-2.0
// Drawings in files.
#pragma once

#include <memory>
#include <string>

#include "anamorph/figure/outline/drawing.h"
#include "output_file.h"

namespace anamorph::command {

/// Writes drawings one after the other; throws Error where it cannot.
class DrawingWriter {
  public:
    virtual ~DrawingWriter() = default;
    virtual void add(const figure::Drawing& drawing) = 0;
    virtual void finish() {}
};

/// Frames are numbered files where there are several.
std::unique_ptr<DrawingWriter> svg_writer(const std::string& name, bool several);
std::unique_ptr<DrawingWriter> png_writer(const std::string& name, bool several);
/// A page for each frame.
std::unique_ptr<DrawingWriter> pdf_writer(const std::string& name);

enum class Characters {
    braille,  ///< 2 x 4 dots each
    ascii     ///< 1 x 2 dots each
};

/// Pixels across a picture of so many characters.
int text_size(int columns, Characters characters);
std::unique_ptr<DrawingWriter> text_writer(const std::string& name, int columns, Characters characters);

}  // namespace anamorph::command
