// SPDX-License-Identifier: Apache-2.0
#include "anamorph/surface/surface_tree.h"

#include <algorithm>
#include <cmath>

namespace anamorph::surface {
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

/// `times` a range, rounded outwards.
simd::FloatRange to_floats(const VectorRange& range, double times) {
    simd::FloatRange r{};
    for (int i = 0; i < 3; ++i) {
        const double middle = range.middle[i] * times;
        r.middle[i] = static_cast<float>(middle);
        const double radius = range.radius[i] * times + std::fabs(middle - double{r.middle[i]});
        r.radius[i] = std::nextafter(static_cast<float>(radius), HUGE_VALF);
    }
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
void tighten(VectorRange& position, const glm::dvec3& middle, double off, const VectorRange& by_u,
             const VectorRange& by_v, double width, double height) {
    for (int i = 0; i < 3; ++i) {
        const double along_u = (std::fabs(by_u.middle[i]) + by_u.radius[i]) * width / 2,
                     along_v = (std::fabs(by_v.middle[i]) + by_v.radius[i]) * height / 2;
        const double radius =
            off + (along_u + along_v + std::fabs(middle[i])) * kRounding + along_u + along_v;
        if (!(radius < position.radius[i])) continue;
        position.middle[i] = middle[i];
        position.radius[i] = radius;
    }
}

}  // namespace

SurfaceTree::SurfaceTree(std::shared_ptr<const DrapedSurface> surface) : m_surface(std::move(surface)) {
    SurfacePatch whole = bounded(0, 0, 0, 0);
    whole.corners = {add_corner(0, 0), add_corner(1, 0), add_corner(1, 1), add_corner(0, 1)};
    add_sides(4);
    whole.sides = {0, 1, 2, 3};
    add_patch(whole);
}

std::int32_t SurfaceTree::add_patch(const SurfacePatch& patch) {
    if (m_size % kPage == 0) m_patches.push_back(std::make_unique<std::array<SurfacePatch, kPage>>());
    const auto index = static_cast<std::int32_t>(m_size++);
    own(index) = patch;
    return index;
}

std::int32_t SurfaceTree::halves(std::int32_t index) {
    SurfacePatch& parent = own(index);
    if (parent.children != SurfacePatch::kNone) return parent.children;
    const int most = parent.across ? parent.level_u : parent.level_v;
    if (most >= kMostLevels) return SurfacePatch::kNone;
    const auto half = [&](std::uint64_t i) {
        const std::uint64_t iu = parent.across ? 2 * parent.iu + i : parent.iu,
                            iv = parent.across ? parent.iv : 2 * parent.iv + i;
        return bounded(iu, iv, parent.level_u + (parent.across ? 1 : 0),
                       parent.level_v + (parent.across ? 0 : 1));
    };
    SurfacePatch first = half(0), second = half(1);
    share_corners(parent, first, second);
    parent.children = add_patch(first);
    add_patch(second);
    return parent.children;
}

std::int32_t SurfaceTree::add_corner(double u, double v) {
    m_corners.push_back({u, v, m_surface->position(u, v)});
    return static_cast<std::int32_t>(m_corners.size() - 1);
}

/// The first of them.
std::int32_t SurfaceTree::add_sides(int count) {
    const auto first = static_cast<std::int32_t>(m_sides.size());
    m_sides.resize(m_sides.size() + static_cast<std::size_t>(count));
    return first;
}

/// A side between two corners, `from` the one of less u or v.
void SurfaceTree::halve_side(std::int32_t index, std::int32_t from, std::int32_t to) {
    if (side(index).middle != SurfacePatch::kNone) return;
    const SurfaceCorner a = m_corners[static_cast<std::size_t>(from)],
                        b = m_corners[static_cast<std::size_t>(to)];
    const std::int32_t middle = add_corner((a.u + b.u) / 2, (a.v + b.v) / 2), halves = add_sides(2);
    m_sides[static_cast<std::size_t>(index)] = {middle, halves};
}

/// Gives halves their corners and sides.
void SurfaceTree::share_corners(const SurfacePatch& parent, SurfacePatch& first, SurfacePatch& second) {
    const auto& c = parent.corners;
    const auto& s = parent.sides;
    // Sides 1 and 3 are halved, or 0 and 2; from less to more of u and v.
    if (parent.across) {
        halve_side(s[0], c[0], c[1]);
        halve_side(s[2], c[3], c[2]);
    } else {
        halve_side(s[1], c[1], c[2]);
        halve_side(s[3], c[0], c[3]);
    }
    const SurfaceSide &one = side(parent.across ? s[0] : s[3]), &other = side(parent.across ? s[2] : s[1]);
    const std::int32_t p = one.middle, q = other.middle, one_half = one.halves, other_half = other.halves,
                       between = add_sides(1);
    if (parent.across) {
        first.corners = {c[0], p, q, c[3]};
        first.sides = {one_half, between, other_half, s[3]};
        second.corners = {p, c[1], c[2], q};
        second.sides = {one_half + 1, s[1], other_half + 1, between};
    } else {
        first.corners = {c[0], c[1], q, p};
        first.sides = {s[0], other_half, between, one_half};
        second.corners = {p, q, c[2], c[3]};
        second.sides = {between, other_half + 1, s[2], one_half + 1};
    }
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
    patch.open = missing == Certainty::open;
    patch.across = (level_u <= level_v && level_u < kMostLevels) || level_v == kMostLevels;
    const auto range_here = [&] { return m_surface->range({u, u + width}, {v, v + height}); };
    if (missing != Certainty::no) {
        // Of a patch with a part that is missing, no more is said than where the rest is.
        const VectorRange unknown{glm::dvec3(0.0), glm::dvec3(HUGE_VAL)};
        patch.position = patch.open ? range_of(range_here(), 0, 1) : unknown;
        for (simd::FloatRange& bend : patch.bends) bend = to_floats(unknown, 1);
        for (simd::FloatRange& slope : patch.slopes) slope = to_floats(unknown, 1);
        return patch;
    }
    const SurfaceRange range = range_here();
    // A Taylor coefficient of degree 2 along one variable is half of the derivative.
    patch.position = range_of(range, 0, 1);
    const VectorRange by_u = range_of(range, 1, 1), by_v = range_of(range, 2, 1),
                      by_uu = range_of(range, 3, 2), by_uv = range_of(range, 4, 1),
                      by_vv = range_of(range, 5, 2);
    patch.bends[0] = to_floats(by_uu, width * width / 8);
    patch.bends[1] = to_floats(by_uv, width * height / 4);
    patch.bends[2] = to_floats(by_vv, height * height / 8);
    patch.slopes[0] = to_floats(by_u, 1);
    patch.slopes[1] = to_floats(by_v, 1);
    patch.rounding = m_surface->rounding(Interval(u, u + width), Interval(v, v + height));
    tighten(patch.position, m_surface->position(u + width / 2, v + height / 2), patch.rounding, by_u, by_v,
            width, height);
    // Across the direction that bends more; where neither bends, or that is not known, across the longer side of the surface,
    // and where that is not known, of the parameters.
    const double bends_u = longest(by_uu) * width * width, bends_v = longest(by_vv) * height * height;
    const double long_u = longest(by_u) * width, long_v = longest(by_v) * height;
    if (std::isfinite(long_u + long_v))
        patch.across = std::isfinite(bends_u + bends_v) && bends_u + bends_v > kFlat * (long_u + long_v)
                           ? bends_u >= bends_v
                           : long_u >= long_v;
    if (level_u == kMostLevels) patch.across = false;
    if (level_v == kMostLevels) patch.across = true;
    return patch;
}

}  // namespace anamorph::surface
