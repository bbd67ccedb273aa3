// SPDX-License-Identifier: Apache-2.0
// The bodies that the pixels of a picture show: the nearest surface of each view ray, or of the 16 x 16 rays
// of each pixel.
//
// Pixels of which a body provably covers all before every other have it whole; only the others are sampled,
// and of bodies only those that may show there. So what a pixel is told is exactly what all of its rays say.
// It depends on nothing but the pixel: not on the box that is asked for.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "anamorph/figure/image/seen_surface.h"
#include "anamorph/parallel_for.h"

namespace anamorph::figure {

/// The part of a pixel that shows one body.
struct VisiblePart {
    int body = 0;
    bool far_side = false;
    int samples = 0;      ///< number of samples, of VisibleSurfaces::kSamples
    double x = 0, y = 0;  ///< the samples' middle, in pixels of the picture; of all: the pixel's middle
};

/// The parts of all pixels of a box, row by row.
struct VisibleParts {
    Box box;
    std::vector<VisiblePart> parts;
    std::vector<std::size_t> first;  ///< position of the first part of each pixel, and the end

    std::span<const VisiblePart> of(int x, int y) const {
        const auto i = static_cast<std::size_t>(std::int64_t{y - box.y0} * box.width() + (x - box.x0));
        return {parts.data() + first[i], first[i + 1] - first[i]};
    }
};

/// The body that the ray through the middle of a pixel meets first.
struct VisiblePoint {
    int body = -1;  ///< -1: nothing
    SurfaceHit hit;
};

/// A scene, ready to be looked at. Of surfaces that are equally near the first body's is seen. Thread safe.
class VisibleSurfaces {
  public:
    static constexpr int kSide = 16, kSamples = kSide * kSide;

    /// `view`: of a picture of this height in pixels, its screen's origin at the lower left. Throws Error as
    /// `outlines` does.
    VisibleSurfaces(std::span<const Ellipsoid> bodies, const View& view, double height,
                    const std::vector<std::string>& names = {}, const ParallelFor& parallel_for = serial_for);

    const SeenSurface& surface(int body) const { return m_surfaces[static_cast<std::size_t>(body)]; }
    bool perspective() const { return m_perspective; }

    /// Finds the parts of the pixels of a small box; samples that are in no part show nothing.
    VisibleParts parts(const Box& box) const;
    /// Finds what the middles of the pixels of a small box show, row by row.
    std::vector<VisiblePoint> points(const Box& box) const;

  private:
    std::vector<SeenSurface> m_surfaces;
    bool m_perspective;
};

}  // namespace anamorph::figure
