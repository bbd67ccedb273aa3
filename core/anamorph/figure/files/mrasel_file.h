// SPDX-License-Identifier: Apache-2.0
// The frame that MRASEL draws (Chapman 1986, Appendix I), a text of numbers and names between blanks:
//
//     ellipsoids debug bands
//     y  red green blue                              for each band of the background: its last row, 0 to 511
//     a1 a2 a3  x y z  t1 t2 t3  map                 for each ellipsoid: half axes in pixels, the centre in
//                                                    tenths of pixels, the turn in tenths of degrees as in
//                                                    rotation.h, the name of its texture
//
// The screen of 512 by 512 pixels, its origin at the lower left, becomes the window of 1000 units.
#pragma once

#include <string_view>

#include "anamorph/figure/body/frame.h"

namespace anamorph::figure {

/// All that a text says.
struct MraselInput {
    FigureFrame frame;
    bool debug = false;  ///< the flag of debugging is -1
};

/// Reads a text. Throws Error naming the file (`name`) and the line.
MraselInput mrasel_input(std::string_view text, std::string_view name);
/// The frame of a text. Throws Error as mrasel_input() does.
FigureFrame mrasel_frame(std::string_view text, std::string_view name);

}  // namespace anamorph::figure
