// SPDX-License-Identifier: Apache-2.0
// The programs of the essay's Appendix I (Chapman 1986): MRASEL, MTEXTURE and SHOWMAP.
//
// Pictures are PPM files, or the same triples without a header, which is what the essay's frames are without theirs
// ("imheadoff"; of that header it says nothing).
#pragma once

#include <functional>
#include <istream>
#include <string>

#include "anamorph/figure/image/figure_picture.h"

namespace anamorph::command {

/// How a picture is written.
struct PictureOutput {
    std::string name = "-";  ///< "-" is the standard output
    bool raw = false;        ///< without a header
};

/// MTEXTURE: reads a map of 512 x 512 triples, and writes NAME.512, NAME.256, ..., NAME.1. Throws Error.
void make_maps(std::istream& base, const std::string& name);

/// SHOWMAP: the nine smallest of these files in one picture. Throws Error.
void show_maps(const std::string& name, const PictureOutput& output);

/// MRASEL: reads a frame, and draws it with 512 x 512 pixels in `look`, textured, with the maps in the working directory. say(what)
/// hears of maps that cannot be read, and, where the frame's flag is -1, what is drawn. Throws Error.
void draw_mrasel(std::istream& frame, figure::FigureLook look, const PictureOutput& output,
                 const ParallelFor& parallel_for, const std::function<void(const std::string& what)>& say);

}  // namespace anamorph::command
