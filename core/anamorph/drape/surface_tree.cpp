// SPDX-License-Identifier: Apache-2.0
#include "anamorph/drape/surface_tree.h"

#include <algorithm>
#include <cmath>

namespace anamorph {
namespace {

/// What a camera's arithmetic may lose of a vector: sums of a few products, in units of 2^-53 of their parts.
constexpr double kRounding = 0x1p-48;

// Patches that bend by less, in their own size, are flat.
constexpr double kFlat = 1e-9;

void put(const Interval& range, double& middle, double& radius) {
    middle = range.lo / 2 + range.hi / 2;
    radius = std::max(range.hi - middle, middle - range.lo);
    radius += (radius + std::fabs(middle)) * kRounding;
}

/// Coefficient k of x, y and z, `times` over.
VectorRange range_of(const SurfaceRange& range, int k, double times) {
    VectorRange r;
    for (int i = 0; i < 3; ++i)
        put(range[static_cast<std::size_t>(i)].c[k] * times, r.middle[i], r.radius[i]);
    return r;
}

/// The size of the longest vector of a range, at most.
double longest(const VectorRange& r) {
    double squared = 0;
    for (int i = 0; i < 3; ++i) squared += square(std::fabs(r.middle[i]) + r.radius[i]);
    return std::sqrt(squared);
}

/// By the mean value theorem: the surface is near the middle of the patch, as far as its slopes let it. `middle`: where
/// that is, `off` or less away.
void tighten(VectorRange& position, const glm::dvec3& middle, double off, const SurfacePatch& patch) {
    for (int i = 0; i < 3; ++i) {
        const double along_u = (std::fabs(patch.by_u.middle[i]) + patch.by_u.radius[i]) * patch.side_u() / 2,
                     along_v = (std::fabs(patch.by_v.middle[i]) + patch.by_v.radius[i]) * patch.side_v() / 2;
        const double radius =
            off + (along_u + along_v + std::fabs(middle[i])) * kRounding + along_u + along_v;
        if (!(radius < position.radius[i])) continue;
        position.middle[i] = middle[i];
        position.radius[i] = radius;
    }
}

}  // namespace

SurfaceTree::SurfaceTree(std::shared_ptr<const DrapedSurface> surface) : m_surface(std::move(surface)) {
    m_patches.push_back(bounded(0, 0, 0, 0));
}

std::int32_t SurfaceTree::halves(std::int32_t index) {
    SurfacePatch& parent = m_patches[static_cast<std::size_t>(index)];
    if (parent.children != SurfacePatch::kNone) return parent.children;
    const int most = parent.across ? parent.level_u : parent.level_v;
    if (most >= kMostLevels) return SurfacePatch::kNone;
    const auto first = static_cast<std::int32_t>(m_patches.size());
    for (std::uint64_t half = 0; half < 2; ++half) {
        const std::uint64_t iu = parent.across ? 2 * parent.iu + half : parent.iu,
                            iv = parent.across ? parent.iv : 2 * parent.iv + half;
        m_patches.push_back(bounded(iu, iv, parent.level_u + (parent.across ? 1 : 0),
                                    parent.level_v + (parent.across ? 0 : 1)));
    }
    parent.children = first;
    return first;
}

SurfacePatch SurfaceTree::bounded(std::uint64_t iu, std::uint64_t iv, int level_u, int level_v) const {
    SurfacePatch patch;
    patch.iu = iu;
    patch.iv = iv;
    patch.level_u = static_cast<std::uint8_t>(level_u);
    patch.level_v = static_cast<std::uint8_t>(level_v);
    const double u = patch.u0(), v = patch.v0(), width = patch.side_u(), height = patch.side_v();
    const Certainty missing = m_surface->missing({u, u + width}, {v, v + height});
    patch.missing = missing == Certainty::yes;
    if (missing != Certainty::no) {
        // Nothing is said of a patch with a part that is missing: it is cut until it is whole or missing.
        patch.position.radius = patch.by_u.radius = patch.by_v.radius = patch.by_uu.radius =
            patch.by_uv.radius = patch.by_vv.radius = glm::dvec3(HUGE_VAL);
        patch.across = (level_u <= level_v && level_u < kMostLevels) || level_v == kMostLevels;
        return patch;
    }
    const SurfaceRange range = m_surface->range({u, u + width}, {v, v + height});
    // A Taylor coefficient of degree 2 along one variable is half of the derivative.
    patch.position = range_of(range, 0, 1);
    patch.by_u = range_of(range, 1, 1);
    patch.by_v = range_of(range, 2, 1);
    patch.by_uu = range_of(range, 3, 2);
    patch.by_uv = range_of(range, 4, 1);
    patch.by_vv = range_of(range, 5, 2);
    // It grows with the magnitudes that a formula meets, which are largest at corners.
    patch.rounding = m_surface->rounding(u + width / 2, v + height / 2);
    tighten(patch.position, m_surface->position(u + width / 2, v + height / 2), patch.rounding, patch);
    for (const double s : {u, u + width})
        for (const double t : {v, v + height})
            patch.rounding = std::max(patch.rounding, m_surface->rounding(s, t));
    // Across the direction that bends more; where neither bends, or that is not known, across the longer side.
    const double bends_u = longest(patch.by_uu) * width * width,
                 bends_v = longest(patch.by_vv) * height * height;
    const double long_u = longest(patch.by_u) * width, long_v = longest(patch.by_v) * height;
    patch.across = std::isfinite(bends_u + bends_v) && bends_u + bends_v > kFlat * (long_u + long_v)
                       ? bends_u >= bends_v
                       : long_u >= long_v;
    if (level_u == kMostLevels) patch.across = false;
    if (level_v == kMostLevels) patch.across = true;
    return patch;
}

}  // namespace anamorph
