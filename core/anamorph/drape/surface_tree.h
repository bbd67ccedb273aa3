// SPDX-License-Identifier: Apache-2.0
// A surface's parameters cut into ever smaller patches, each with bounds of the surface and its derivatives on it. They
// do not depend on the camera, and are kept: another view of the same surface computes none of them again.
#pragma once

#include <cmath>
#include <cstdint>
#include <deque>
#include <glm/vec3.hpp>
#include <memory>

#include "anamorph/map/surface.h"

namespace anamorph {

/// All vectors within `radius` of `middle`, coordinate by coordinate; rounding of up to 2^-48 of their size included.
struct VectorRange {
    glm::dvec3 middle{0.0}, radius{0.0};
};

/// A rectangle of parameters, i / 2^level to (i + 1) / 2^level either way.
struct SurfacePatch {
    static constexpr std::int32_t kNone = -1;

    std::uint64_t iu = 0, iv = 0;
    std::uint8_t level_u = 0, level_v = 0;
    bool across = false;            ///< it is halved along u
    bool missing = false;           ///< there is no surface
    std::int32_t children = kNone;  ///< the first of two that follow each other
    VectorRange position, by_u, by_v, by_uu, by_uv, by_vv;
    double rounding = 0;  ///< of positions on it, DrapedSurface::rounding

    double u0() const { return static_cast<double>(iu) * side_u(); }
    double v0() const { return static_cast<double>(iv) * side_v(); }
    double side_u() const { return std::ldexp(1.0, -level_u); }
    double side_v() const { return std::ldexp(1.0, -level_v); }
};

/// Patches are halved when they are asked for. One thread at a time.
class SurfaceTree {
  public:
    /// Halved so often either way, patches are as small as they get.
    static constexpr int kMostLevels = 48;

    explicit SurfaceTree(std::shared_ptr<const DrapedSurface> surface);

    const DrapedSurface& surface() const { return *m_surface; }
    const std::shared_ptr<const DrapedSurface>& shared_surface() const { return m_surface; }
    /// Patch 0 is the whole surface. References last.
    const SurfacePatch& patch(std::int32_t index) const { return m_patches[static_cast<std::size_t>(index)]; }
    std::size_t size() const { return m_patches.size(); }
    /// The first of a patch's two halves, or kNone where it is as small as it gets.
    std::int32_t halves(std::int32_t index);

  private:
    SurfacePatch bounded(std::uint64_t iu, std::uint64_t iv, int level_u, int level_v) const;

    std::shared_ptr<const DrapedSurface> m_surface;
    std::deque<SurfacePatch> m_patches;
};

}  // namespace anamorph
