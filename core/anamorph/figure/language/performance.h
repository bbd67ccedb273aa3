// SPDX-License-Identifier: Apache-2.0
// Performs a program: what its ellipsoids do, frame by frame.
//
// A movement f0 f1 works on the frames f0 < f <= f1 (f0 = f1 counts as f1 + 1), in the order written. The
// smallest f0 of a subroutine, and of the script itself, is its zero (only numbers count; where all are
// variables, their values when the frame begins). Frame 0 is the figures at rest. Each frame takes a share of
// an action that increments (frac), or of what remains of one with a target (prop); see timing.h.
//
// Frames may be asked for in any order. States are kept at intervals, in at most `memory` bytes, so that a
// frame costs one interval at most; frames asked in order cost themselves alone. A frame is the same, to the
// bit, in whatever order it is asked for.
//
// Where the original searches: `touch` and `abut` find exact contact in both dialects (the contact function
// of figure/body/ellipsoid_distance.h is 1), the one closest to where the ellipsoids are, or where there is none the
// place where that function is closest to 1. Contacts of `touch` that come and go within 0.06 degrees may be
// missed. `drag` takes, in the classic dialect, the original's three rounds of samples, 0.01 degrees apart in
// the end and 11.1 degrees a frame at most. `movjnt`, which stops the original, works in both.
//
// The strict dialect differs so: `ground` ends grounded; `drag` finds the exact angle, about the axis asked
// for; `attach` counts its offset from the second ellipsoid; variables must have been set, and hold what is
// asked for; `limit` holds: the turn of a joint's second ellipsoid as seen from its first, as Rx Ry Rz, has
// each angle kept within its bounds whenever something bends at that joint.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/body/motion.h"
#include "anamorph/figure/language/program.h"

namespace anamorph::figure {

/// Options of a performance: its messages, and the memory that it uses.
struct PerformanceOptions {
    /// Receives the output of `print` and of `debug`, and warnings, one line each, once for each frame however often it is performed.
    std::function<void(const std::string& line)> message;
    std::size_t memory = std::size_t{32} << 20;  ///< bytes of states kept
};

/// A program that is performed. Where frame numbers of the script are variables, asking for the last one performs it. Frames may be asked
/// for up to the last that the script performs, shown or not; frame() throws Error, too, naming the line of
/// the script where performing it fails.
class Performance final : public Motion {
  public:
    /// `program`: the program of a script without errors.
    explicit Performance(Program program, PerformanceOptions options = {});
    ~Performance() override;
    Performance(Performance&&) noexcept;
    Performance& operator=(Performance&&) noexcept;

    int first_frame() const override;
    int last_frame() override;
    int frame_step() const override;
    FigureFrame frame(int number) override;
    void for_each_frame(const std::function<bool(const FigureFrame&)>& body) override;
    const std::vector<std::string>& images() const override;

    const Program& program() const;

  private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace anamorph::figure
