// SPDX-License-Identifier: Apache-2.0
// Frames as the original programs print them, `.3` files: text, lengths in tenths, angles in tenths of a
// degree, all rounded to whole numbers.
//
//     count number px py pz o1 o2 o3                                       place, and the turn of `observe`
//     ax ay az  cx cy cz  t1 t2 t3  r g b  name index                      for each ellipsoid; from 1
//     ax ay az  cx cy cz  t1 t2 t3  -image xoffset yoffset  name picture   instead, where it has a picture
//     -1 joints
//     first second  x y z  name                                            for each joint; ellipsoids from 0
//     0 number px py pz o1 o2 o3                                           after the last frame
//
// Turns are triples of angles as in rotation.h. Pictures are numbered from 1 in the order of their first use
// in a frame. The files do not name figures: ellipsoids that joints connect are read as one, named after its
// first.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/figure/body/frame.h"

namespace anamorph::figure {

/// The record of a frame as text. Throws Error where a number does not fit a 32-bit integer.
std::string frame_text(const FigureFrame& frame);
/// The record that follows the last frame, as text.
std::string frames_end_text(const FigureFrame& last);

/// Reads frames one by one from a text, which must outlive the reader. Throws Error: one line that names the file
/// and the line.
class FrameReader {
  public:
    /// `name` is the file's name in messages.
    FrameReader(std::string_view text, std::string_view name);
    /// Reads the next frame. False at the end of the text or after the end record.
    bool read(FigureFrame& frame);

  private:
    std::string_view m_text;
    std::string m_name;
    int m_line = 0;
    bool m_ended = false;
};

/// Reads all frames of a text. Throws Error as FrameReader does.
std::vector<FigureFrame> parse_frames(std::string_view text, std::string_view name);

}  // namespace anamorph::figure
