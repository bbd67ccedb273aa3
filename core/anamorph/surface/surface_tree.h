// SPDX-License-Identifier: Apache-2.0
// A surface's parameters cut into ever smaller patches, each with bounds of the surface and its derivatives on it. They
// do not depend on the camera, and are kept: another view of the same surface computes none of them again.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <glm/vec3.hpp>
#include <memory>
#include <vector>

#include "anamorph/surface/range_rows.h"
#include "anamorph/surface/surface.h"

namespace anamorph::surface {

/// All vectors within `radius` of `middle`, coordinate by coordinate; rounding of up to 2^-48 of their size included.
struct VectorRange {
    glm::dvec3 middle{0.0}, radius{0.0};
};

/// A point that patches have as a corner.
struct SurfaceCorner {
    double u, v;
    glm::dvec3 position;
};

/// A side of patches, the same one for both that it lies between: they are halved where they like, but a side in one place.
struct SurfaceSide {
    std::int32_t middle = -1;  ///< the corner in its middle, or none
    std::int32_t halves = -1;  ///< the first of its halves, which follow each other, along u or v
};

/// A rectangle of parameters, i / 2^level to (i + 1) / 2^level either way.
struct SurfacePatch {
    static constexpr std::int32_t kNone = -1;

    std::uint64_t iu = 0, iv = 0;
    std::uint8_t level_u = 0, level_v = 0;
    bool across = false;            ///< is it halved along u?
    bool missing = false;           ///< is there no surface?
    bool open = false;              ///< is there none of a part, or is that not known?
    std::int32_t children = kNone;  ///< the first of its halves, which follow each other
    double rounding = 0;            ///< rounding of positions on it, DrapedSurface::rounding
    VectorRange position;
    simd::FloatRange bends[3];   ///< h^2 f_uu / 8, h k f_uv / 4 and k^2 f_vv / 8 with the sides h and k
    simd::FloatRange slopes[2];  ///< f_u and f_v
    /// Corners from the least u and v on, along u first and round; side i is between corners i and i + 1.
    std::array<std::int32_t, 4> corners{}, sides{};

    double u0() const { return static_cast<double>(iu) * side_u(); }
    double v0() const { return static_cast<double>(iv) * side_v(); }
    double side_u() const { return std::ldexp(1.0, -level_u); }
    double side_v() const { return std::ldexp(1.0, -level_v); }
};

/// A tree of patches, which are halved when they are asked for. One thread at a time.
class SurfaceTree {
  public:
    /// The most times that a patch is halved either way.
    static constexpr int kMostLevels = 48;

    explicit SurfaceTree(std::shared_ptr<const DrapedSurface> surface);

    const DrapedSurface& surface() const { return *m_surface; }
    const std::shared_ptr<const DrapedSurface>& shared_surface() const { return m_surface; }
    /// A patch; number 0 is the whole surface. References last.
    const SurfacePatch& patch(std::int32_t index) const {
        const auto i = static_cast<std::size_t>(index);
        return (*m_patches[i / kPage])[i % kPage];
    }
    /// Prefetches a patch.
    void prefetch(std::int32_t index) const {
        const char* const at = reinterpret_cast<const char*>(&patch(index));
        for (std::size_t line = 0; line < sizeof(SurfacePatch); line += 64) __builtin_prefetch(at + line);
    }
    std::size_t size() const { return m_size; }
    const std::vector<SurfaceCorner>& corners() const { return m_corners; }
    const SurfaceSide& side(std::int32_t index) const { return m_sides[static_cast<std::size_t>(index)]; }
    /// Halves a patch, unless that is done. Returns the first half, or kNone where the patch is as small as
    /// it gets.
    std::int32_t halves(std::int32_t index);

  private:
    // Patches lie in pages, which stay where they are.
    static constexpr std::size_t kPage = 256;

    SurfacePatch& own(std::int32_t index) {
        const auto i = static_cast<std::size_t>(index);
        return (*m_patches[i / kPage])[i % kPage];
    }
    std::int32_t add_patch(const SurfacePatch& patch);
    SurfacePatch bounded(std::uint64_t iu, std::uint64_t iv, int level_u, int level_v) const;
    std::int32_t add_corner(double u, double v);
    std::int32_t add_sides(int count);
    void halve_side(std::int32_t index, std::int32_t from, std::int32_t to);
    void share_corners(const SurfacePatch& parent, SurfacePatch& first, SurfacePatch& second);

    std::shared_ptr<const DrapedSurface> m_surface;
    std::vector<std::unique_ptr<std::array<SurfacePatch, kPage>>> m_patches;
    std::size_t m_size = 0;
    std::vector<SurfaceCorner> m_corners;
    std::vector<SurfaceSide> m_sides;
};

}  // namespace anamorph::surface
