// SPDX-License-Identifier: Apache-2.0
// Frames of figures, one after the other: of a script that is performed (performance.h), or read from a file
// (motion_file.h).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "anamorph/figure/body/frame.h"

namespace anamorph::figure {

/// A sequence of frames of figures. A motion must not be used by two threads at once.
class Motion {
  public:
    virtual ~Motion() = default;

    /// The number of the first frame that is shown. The frames shown are first_frame() + i frame_step() up to last_frame(),
    /// none where last_frame() is less than first_frame().
    virtual int first_frame() const { return 1; }
    /// The number of the last frame that is shown.
    virtual int last_frame() = 0;
    virtual int frame_step() const { return 1; }
    /// The number of frames that are shown.
    int frame_count();

    /// Makes any frame from 0 on, shown or not; frame 0 is the figures at rest. A frame has the same bits in whatever order
    /// frames are asked for. Throws Error on numbers out of range.
    virtual FigureFrame frame(int number) = 0;
    /// Calls `body` for the frames that are shown, in order, until it returns false.
    virtual void for_each_frame(const std::function<bool(const FigureFrame&)>& body);

    /// The rate at which the frames are meant to be shown.
    virtual double frames_per_second() const { return 25; }
    /// Warnings about contents of a file that are not drawn as the file says, one line each, with the file's name.
    virtual const std::vector<std::string>& warnings() const;
    /// The names of the pictures that bodies may have for textures.
    virtual const std::vector<std::string>& images() const;
};

}  // namespace anamorph::figure
