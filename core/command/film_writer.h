// SPDX-License-Identifier: Apache-2.0
// Frames of pixels as a film or as numbered pictures.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

namespace anamorph::command {

/// Red, green and blue of each pixel, rows from the top.
struct FilmFrame {
    int number = 0;
    std::vector<std::uint8_t> pixels;
};

class FilmWriter {
  public:
    virtual ~FilmWriter() = default;
    virtual void add(const FilmFrame& frame) = 0;
    virtual void finish() {}
};

/// Whether the program ffmpeg can be started.
bool has_ffmpeg();
/// A film by ffmpeg, of the kind that the ending of `name` says. Sides of an odd number of pixels get one more,
/// which most codecs ask for. Throws Error with what ffmpeg says.
std::unique_ptr<FilmWriter> ffmpeg_writer(const std::string& name, int width, int height,
                                          double frames_per_second);
/// Numbered PNG files.
std::unique_ptr<FilmWriter> png_frames_writer(const std::string& name, int width, int height);

}  // namespace anamorph::command
