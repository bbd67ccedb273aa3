// SPDX-License-Identifier: Apache-2.0
// Panorama reprojection: a picture drawn through a pull map to a proven tolerance, any part of it at a time.
#pragma once

#include <memory>

#include "anamorph/image/picture.h"
#include "anamorph/panorama/panorama.h"
#include "anamorph/parallel_for.h"
#include "anamorph/plan/scheme.h"

namespace anamorph {

struct PlanOptions;

/// How a reprojection is drawn.
struct ReprojectOptions {
    Scheme scheme = Scheme::automatic;
    double tol = 0.01;  ///< source pixels; 0: every pixel exactly in double
    Filter filter = Filter::antialias;
    Wrap wrap = Wrap::automatic;
    Output output = Output::color;
};

/// How its map is approximated.
PlanOptions plan_options(const ReprojectOptions& options);

/// One reprojection, ready to draw any box of the picture in any order from any number of threads: the bits
/// of a pixel depend on nothing but the map, the options and the source.
class Reprojection {
  public:
    /// Throws Error.
    Reprojection(const Panorama& map, const ReprojectOptions& options);
    ~Reprojection();
    Reprojection(Reprojection&&) noexcept;
    Reprojection& operator=(Reprojection&&) noexcept;

    const Panorama& map() const;
    const ReprojectOptions& options() const;
    const Picture& picture() const;

    /// Channels of the picture: the source's for color, 2 for stmap, 1 for error and bound.
    int channels(const Source& source) const;

    /// The largest proven bound in use (source pixels) and the fraction of pixels computed exactly, over the
    /// whole picture.
    Reached reached(const ParallelFor& parallel_for = serial_for) const;

    /// Draws the pixels of `box` (of the target image) to `view`, whose pixel (0, 0) is (box.x0, box.y0).
    /// `source` has the size of the map's source chart at level 0; it is not read for the other outputs and
    /// may then be null. False when the source could not be read: the picture is then incomplete.
    bool draw(const Source* source, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for = serial_for) const;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace anamorph
