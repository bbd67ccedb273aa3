// SPDX-License-Identifier: Apache-2.0
// A view of concentric mosaics: every pixel is a mixture of the two panoramas whose circles its line of sight passes
// between, each drawn through its map to a proven tolerance.
#pragma once

#include <functional>
#include <optional>

#include "anamorph/panorama/concentric.h"
#include "anamorph/panorama/reproject.h"

namespace anamorph {

/// One view, ready to draw any box of the picture in any order from any number of threads.
class ConcentricView {
  public:
    /// `view`: as ConcentricMap takes it. `circle`: one panorama alone, in place of the mixture; stmap shows the middle one
    /// unless this is given. Throws Error.
    ConcentricView(const Panorama& view, const ConcentricStack& stack, const ReprojectOptions& options,
                   std::optional<int> circle = {});

    /// Its source i is the panorama of circle i.
    const Picture& picture() const { return m_picture; }
    const ConcentricStack& stack() const { return m_stack; }

  private:
    void add(const Panorama& view, int circle, bool mixed, const ReprojectOptions& options);

    ConcentricStack m_stack;
    Picture m_picture;
};

/// What ConcentricStack::vertical_distortion() says at each pixel of a view, of things `nearest` or farther from the centre.
std::function<float(double x, double y)> distortion_of(const Panorama& view, const ConcentricStack& stack,
                                                       double nearest);

}  // namespace anamorph
