// SPDX-License-Identifier: Apache-2.0
// Sources whose pixels go on beyond the edges of their picture: the same as a larger picture of which that is a part.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "anamorph/image/border.h"
#include "anamorph/image/coverage_source.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/pyramid.h"
#include "anamorph/image/summed_areas.h"
#include "anamorph/lens/lens_plan.h"
#include "anamorph/mesh/mesh_warp.h"
#include "anamorph/operation/operation.h"
#include "anamorph/panorama/reproject.h"

namespace anamorph::test_overscan {
namespace {

/// Seeded noise with a slope, in memory.
class Large {
  public:
    Large(const Size& size, PixelType type, int channels)
        : m_bytes(static_cast<std::size_t>(size.width * size.height * channels * size_of(type))),
          m_view(packed_view<const std::byte>(m_bytes.data(), type, size.width, size.height, channels)) {
        std::mt19937 random(7);
        std::uniform_real_distribution<float> value(0.1f, 0.9f);
        for (std::size_t i = 0; i < m_bytes.size(); i += static_cast<std::size_t>(size_of(type)))
            store_channel(value(random), &m_bytes[i], type);
    }
    const ConstImageView& view() const { return m_view; }
    MemorySource source(int alpha = -1) const { return MemorySource(m_view, alpha); }

  private:
    std::vector<std::byte> m_bytes;
    ConstImageView m_view;
};

/// The part `shown` of an image as the picture, with the rest around it.
class Framed final : public Source {
  public:
    Framed(const ConstImageView& all, const Box& shown, int alpha = -1)
        : m_all(all, alpha), m_size{all.width, all.height}, m_shown(shown) {}

    PixelType type() const noexcept override { return m_all.type(); }
    int channels() const noexcept override { return m_all.channels(); }
    int unassociated_alpha() const noexcept override { return m_all.unassociated_alpha(); }
    int levels() const noexcept override { return 1; }
    Size size(int) const noexcept override { return {m_shown.width(), m_shown.height()}; }
    Box extent(int) const noexcept override {
        return {-m_shown.x0, -m_shown.y0, m_size.width - m_shown.x0, m_size.height - m_shown.y0};
    }
    bool read(int, const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const noexcept override {
        const Box in_all{box.x0 + m_shown.x0, box.y0 + m_shown.y0, box.x1 + m_shown.x0, box.y1 + m_shown.y0};
        EXPECT_EQ(intersection(in_all, {0, 0, m_size.width, m_size.height}), in_all);
        return m_all.read(0, in_all, texels, row_stride);
    }

  private:
    MemorySource m_all;
    Size m_size;
    Box m_shown;
};

/// A white image of one channel whose data window is any rectangle.
class White final : public Source {
  public:
    White(const Size& size, const Box& data) : m_size(size), m_data(data) {}

    PixelType type() const noexcept override { return PixelType::float32; }
    int channels() const noexcept override { return 1; }
    int levels() const noexcept override { return 1; }
    Size size(int) const noexcept override { return m_size; }
    Box extent(int) const noexcept override {
        return {std::min(0, m_data.x0), std::min(0, m_data.y0), std::max(m_size.width, m_data.x1),
                std::max(m_size.height, m_data.y1)};
    }
    Box data_window() const noexcept override { return m_data; }
    bool read(int, const Box& box, std::byte* texels, std::ptrdiff_t row_stride) const noexcept override {
        for (int y = box.y0; y < box.y1; ++y, texels += row_stride)
            for (int x = box.x0; x < box.x1; ++x) {
                const bool has = m_data.x0 <= x && x < m_data.x1 && m_data.y0 <= y && y < m_data.y1;
                reinterpret_cast<float*>(texels)[x - box.x0] = has ? 1.0f : 0.0f;
            }
        return true;
    }

  private:
    Size m_size;
    Box m_data;
};

std::vector<float> level_of(const Source& source, int level, const Box& box) {
    std::vector<float> texels(static_cast<std::size_t>(box.width() * box.height()));
    EXPECT_TRUE(source.read(level, box, reinterpret_cast<std::byte*>(texels.data()),
                            box.width() * std::ptrdiff_t{sizeof(float)}));
    return texels;
}

// On every level, of any sizes and windows: what a pyramid makes of an image that is 1 where the file has something.
TEST(Overscan, CoverageIsAWhiteWindowOnEveryLevel) {
    const unsigned seed = 20261128;
    std::printf("seed %u\n", seed);
    std::mt19937 random(seed);
    const auto any = [&](int least, int most) {
        return std::uniform_int_distribution<int>(least, most)(random);
    };
    int partly = 0;
    for (int round = 0; round < 60; ++round) {
        const Size size{any(1, 150), any(1, 150)};
        const int x = any(-60, size.width + 30), y = any(-60, size.height + 30);
        const White white(size, {x, y, x + any(1, 200), y + any(1, 200)});
        const Pyramid pyramid(white);
        const CoverageSource coverage(pyramid);
        ASSERT_EQ(coverage.levels(), pyramid.levels());
        for (int level = 0; level < pyramid.levels(); ++level) {
            const Box all = pyramid.extent(level);
            ASSERT_EQ(coverage.extent(level), all);
            const std::vector<float> truth = level_of(pyramid, level, all),
                                     found = level_of(coverage, level, all);
            for (std::size_t i = 0; i < truth.size(); ++i) {
                ASSERT_NEAR(found[i], truth[i], 1e-6) << round << " " << level << " " << i;
                partly += truth[i] > 0 && truth[i] < 1;
            }
            // Any part of it is the same.
            const Box part{all.x0 + all.width() / 3, all.y0 + all.height() / 4, all.x1, all.y1};
            const std::vector<float> some = level_of(coverage, level, part);
            for (int j = 0; j < part.height(); ++j)
                for (int i = 0; i < part.width(); ++i)
                    ASSERT_EQ(some[static_cast<std::size_t>(j * part.width() + i)],
                              found[static_cast<std::size_t>((part.y0 - all.y0 + j) * all.width() + part.x0 -
                                                             all.x0 + i)]);
        }
    }
    EXPECT_GT(partly, 500);
}

constexpr Wrap kWraps[] = {Wrap::automatic, Wrap::black, Wrap::clamp, Wrap::periodic, Wrap::mirror};

TEST(Overscan, TexelsBeyondAFlatPicturesEdgesStandForThemselves) {
    const SourceLevel level({12, 8}, {-3, -2, 17, 9});
    const Size size = level.size;
    for (const Chart& chart :
         {Chart(Projection::rectilinear, 12, 8), Chart(Projection::equirectangular, 12, 8, 200)})
        for (const Wrap wrap : kWraps) {
            const Border border(chart, wrap);
            ASSERT_EQ(border.interior(0, level), level.extent);
            for (int y = -30; y < 40; ++y)
                for (int x = -40; x < 50; ++x) {
                    const bool there = x >= -3 && x < 17 && y >= -2 && y < 9;
                    const Texel texel = border.resolve(x, y, 0, level);
                    const Texel expected = there ? Texel{x, y} : border.resolve(x, y, 0, size);
                    ASSERT_EQ(texel.none, expected.none) << x << " " << y;
                    ASSERT_TRUE(texel.none || (texel.x == expected.x && texel.y == expected.y))
                        << x << " " << y;
                    for (const int limit : {1, 5, 100}) {
                        const TexelRun run = border.resolve_run(x, y, 0, level, limit);
                        ASSERT_TRUE(run.count >= 1 && run.count <= limit);
                        for (int k = 0; k < run.count; ++k) {
                            const Texel one = border.resolve(x + k, y, 0, level);
                            ASSERT_EQ(one.none, run.first.none);
                            ASSERT_TRUE(one.none || one.x == run.first.x + k);
                        }
                    }
                }
        }
}

TEST(Overscan, PicturesThatGoOnByThemselvesHaveNone) {
    const SourceLevel level({24, 12}, {-5, -5, 40, 20}), cross({24, 18}, {-5, -5, 40, 20});
    const Chart closed[] = {Chart(Projection::equirectangular, 24, 12),
                            Chart(Projection::cylindrical, 24, 12, 360),
                            Chart(Projection::hammer, 24, 12, 360), Chart(Projection::cubecross, 24, 18)};
    for (const Chart& chart : closed)
        for (const Wrap wrap : kWraps) {
            const SourceLevel& of = chart.height() == 18 ? cross : level;
            const Border border(chart, wrap);
            ASSERT_EQ(border.interior(0, of), border.interior(0, of.size));
            for (int y = -20; y < 40; ++y)
                for (int x = -20; x < 60; ++x) {
                    const Texel a = border.resolve(x, y, 0, of), b = border.resolve(x, y, 0, of.size);
                    ASSERT_TRUE(a.none == b.none && (a.none || (a.x == b.x && a.y == b.y)));
                }
        }
}

std::vector<std::byte> texels_of(const Source& source, int level, const Box& box) {
    const std::ptrdiff_t row = std::ptrdiff_t{box.width()} * source.channels() * size_of(source.type());
    std::vector<std::byte> bytes(static_cast<std::size_t>(row * box.height()));
    EXPECT_TRUE(source.read(level, box, bytes.data(), row));
    return bytes;
}

TEST(Overscan, LevelsAreThoseOfTheLargerPicture) {
    for (const PixelType type : {PixelType::uint8, PixelType::uint16, PixelType::half, PixelType::float32})
        for (const int alpha : {-1, 3}) {
            const Large large({640, 320}, type, 4);
            const MemorySource all = large.source(alpha);
            const Framed part(large.view(), {64, 32, 576, 288}, alpha);
            const Pyramid whole(all), framed(part);
            ASSERT_EQ(framed.size(0), (Size{512, 256}));
            for (int level = 0; level < 5; ++level) {
                const int x = 64 >> level, y = 32 >> level;
                const Size size = whole.size(level);
                EXPECT_EQ(framed.extent(level), (Box{-x, -y, size.width - x, size.height - y}));
                EXPECT_EQ(texels_of(framed, level, framed.extent(level)),
                          texels_of(whole, level, {0, 0, size.width, size.height}))
                    << level;
            }
            EXPECT_NE(whole.view(1), nullptr);
            EXPECT_EQ(framed.view(1), nullptr);
        }
}

// Where the extent ends within a texel of a coarser level, the rest of that is 0.
TEST(Overscan, OutermostTexelsOfLevelsAreFadedWhereTheyAreNotFull) {
    const Large large({47, 31}, PixelType::float32, 1);
    const Box shown{7, 5, 38, 24};
    const Framed part(large.view(), shown);
    const Pyramid pyramid(part);
    const Size fine = pyramid.size(0), coarse = pyramid.size(1);
    const Box extent = pyramid.extent(1);
    const auto texel = [&](int x, int y) {
        const int i = x + shown.x0, j = y + shown.y0;
        return i < 0 || j < 0 || i >= 47 || j >= 31
                   ? 0.0
                   : double{load_channel(large.view().at(i, j), PixelType::float32)};
    };
    const auto share = [](int i, double from, double to) {
        return std::max(0.0, std::min(to, i + 1.0) - std::max(from, double(i)));
    };
    const double rx = double(fine.width) / coarse.width, ry = double(fine.height) / coarse.height;
    // Nothing of the base is left out.
    EXPECT_LE(extent.x0 * rx, -shown.x0);
    EXPECT_GE(extent.x1 * rx, 47 - shown.x0);
    EXPECT_LE(extent.y0 * ry, -shown.y0);
    EXPECT_GE(extent.y1 * ry, 31 - shown.y0);
    const std::vector<std::byte> bytes = texels_of(pyramid, 1, extent);
    for (int y = extent.y0; y < extent.y1; ++y)
        for (int x = extent.x0; x < extent.x1; ++x) {
            double sum = 0;
            for (int j = -10; j < 40; ++j)
                for (int i = -10; i < 50; ++i)
                    sum += texel(i, j) * share(i, x * rx, (x + 1) * rx) * share(j, y * ry, (y + 1) * ry);
            const std::ptrdiff_t at = std::ptrdiff_t{y - extent.y0} * extent.width() + x - extent.x0;
            EXPECT_NEAR(load_channel(bytes.data() + 4 * at, PixelType::float32), sum / (rx * ry), 1e-6)
                << x << " " << y;
        }
}

// What is faded at the outermost texels of a level does not get into a picture that goes on beyond them.
TEST(Overscan, NoEdgeIsSeenInAPictureOfOneColor) {
    for (const int more : {1, 2, 3, 10, 37}) {
        const Size shown{301, 203}, all{shown.width + 2 * more, shown.height + 2 * more};
        const std::vector<float> ones(static_cast<std::size_t>(all.width * all.height), 1.0f);
        const Framed part(packed_view(reinterpret_cast<const std::byte*>(ones.data()), PixelType::float32,
                                      all.width, all.height, 1),
                          {more, more, more + shown.width, more + shown.height});
        const Pyramid pyramid(part);
        for (int level = 0; level < pyramid.levels(); ++level) {
            const SourceLevel of = pyramid.level(level);
            const Box display{0, 0, of.size.width, of.size.height};
            ASSERT_EQ(intersection(of.whole, display), display);
            ASSERT_EQ(intersection(of.whole, of.extent), of.whole);
            const std::vector<std::byte> texels = texels_of(pyramid, level, of.whole);
            for (std::size_t i = 0; i < texels.size(); i += 4)
                ASSERT_NEAR(load_channel(&texels[i], PixelType::float32), 1, 1e-6);
        }
        ControlMesh mesh;
        mesh.vertices = {{-100, -70}, {410, -60}, {-90, 290}, {390, 300}};
        MeshWarpOptions options;
        for (const Wrap wrap : {Wrap::clamp, Wrap::periodic, Wrap::mirror})
            for (const Size& target : {Size{150, 100}, Size{61, 43}, Size{20, 14}}) {
                options.wrap = wrap;
                const Picture picture = warped_picture({"one", mesh}, shown, target, options);
                std::vector<float> values(static_cast<std::size_t>(target.width * target.height));
                ASSERT_TRUE(picture.draw(&pyramid, {0, 0, target.width, target.height},
                                         packed_view(reinterpret_cast<std::byte*>(values.data()),
                                                     PixelType::float32, target.width, target.height, 1)));
                for (const float value : values) ASSERT_NEAR(value, 1, 1e-5) << more << " " << target.width;
            }
    }
}

TEST(Overscan, SumsAreThoseOfTheLargerPicture) {
    const Large large({60, 40}, PixelType::uint8, 3);
    const Box shown{10, 6, 45, 33};
    const MemorySource all = large.source();
    const Framed part(large.view(), shown);
    const SummedAreas whole(all), framed(part);
    const std::vector<std::byte> shown_only = texels_of(part, 0, {0, 0, 35, 27});
    const MemorySource cut(packed_view<const std::byte>(shown_only.data(), PixelType::uint8, 35, 27, 3));
    const SummedAreas alone(cut);
    std::mt19937 random(5);
    std::uniform_real_distribution<double> place(-20, 60), side(0.5, 50);
    float a[3], b[3];
    for (int i = 0; i < 500; ++i) {
        const double x = place(random), y = place(random), w = side(random), h = side(random);
        for (const Wrap wrap : kWraps) {
            const bool black = wrap == Wrap::black || wrap == Wrap::automatic;
            framed.mean(x, y, w, h, wrap, a);
            if (black)
                whole.mean(x + shown.x0, y + shown.y0, w, h, wrap, b);
            else
                alone.mean(x, y, w, h, wrap, b);
            for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-6);
        }
        framed.mean_over_poles(x, y, w, h, a);
        alone.mean_over_poles(x, y, w, h, b);
        for (int c = 0; c < 3; ++c) EXPECT_NEAR(a[c], b[c], 1e-6);
    }
}

constexpr Size kTarget = {300, 200};

std::vector<float> drawn(const Picture& picture, const Source& source) {
    const int channels = picture.channels(&source);
    std::vector<float> values(static_cast<std::size_t>(kTarget.width * kTarget.height * channels));
    EXPECT_TRUE(picture.draw(&source, {0, 0, kTarget.width, kTarget.height},
                             packed_view(reinterpret_cast<std::byte*>(values.data()), PixelType::float32,
                                         kTarget.width, kTarget.height, channels)));
    return values;
}

double largest(const std::vector<float>& a, const std::vector<float>& b) {
    double most = a.size() == b.size() ? 0 : HUGE_VAL;
    for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
        most = std::max(most, std::fabs(double{a[i]} - double{b[i]}));
    return most;
}

/// The pictures of the larger source by `whole` and of the framed one by `framed` are the same but for rounding, and the
/// picture of what is shown alone is another.
void expect_one(const Picture& whole, const Picture& framed, const Large& large, const Box& shown, int alpha,
                bool by_levels) {
    const MemorySource all = large.source(alpha);
    const Framed part(large.view(), shown, alpha);
    const Pyramid all_levels(all), part_levels(part);
    const Source& a = by_levels ? static_cast<const Source&>(all_levels) : all;
    const Source& b = by_levels ? static_cast<const Source&>(part_levels) : part;
    const std::vector<float> expected = drawn(whole, a);
    EXPECT_LT(largest(drawn(framed, b), expected), 2e-5);
    const Box only{0, 0, shown.width(), shown.height()};
    const std::vector<std::byte> bytes = texels_of(part, 0, only);
    const MemorySource cut(
        packed_view<const std::byte>(bytes.data(), part.type(), only.width(), only.height(), part.channels()),
        alpha);
    const Pyramid cut_levels(cut);
    EXPECT_GT(largest(drawn(framed, by_levels ? static_cast<const Source&>(cut_levels) : cut), expected),
              0.1);
}

// A pixel of the nearest texel, where two meet, may be either's.
constexpr Filter kFilters[] = {Filter::bilinear,  Filter::bicubic, Filter::sharp_bicubic,
                               Filter::antialias, Filter::pyramid, Filter::summed_area};

TEST(Overscan, PanoramasOfItAreThoseOfTheLargerPicture) {
    const Box shown{32, 16, 224, 144};
    const Size size{256, 160};
    const double pi = std::acos(-1.0), fov = 80,
                 wider = 2 * std::atan(std::tan(fov * pi / 360) * size.width / shown.width()) * 180 / pi;
    for (const int alpha : {-1, 3})
        for (const Scheme scheme : {Scheme::automatic, Scheme::exact, Scheme::blocks, Scheme::residual})
            for (const Filter filter : kFilters)
                for (const double to : {120.0, 155.0}) {
                    SCOPED_TRACE(testing::Message()
                                 << alpha << " " << int(scheme) << " " << int(filter) << " " << to);
                    const Large large(size, PixelType::float32, 4);
                    const Chart target(Projection::rectilinear, kTarget.width, kTarget.height, to);
                    const Orientation turned{3, -2, 5};
                    ReprojectOptions options;
                    options.scheme = scheme;
                    options.filter = filter;
                    options.tol = 1e-5;
                    // Of both, so that nothing is left out that lies beyond either's edges, and blocks are the same.
                    options.source_overscan = true;
                    const Picture whole = reprojected_picture(
                        Panorama(Chart(Projection::rectilinear, size.width, size.height, wider), target,
                                 turned),
                        options);
                    const Picture framed = reprojected_picture(
                        Panorama(Chart(Projection::rectilinear, shown.width(), shown.height(), fov), target,
                                 turned),
                        options);
                    expect_one(whole, framed, large, shown, alpha, filter != Filter::bilinear);
                }
}

TEST(Overscan, WarpsOfItAreThoseOfTheLargerPicture) {
    const Box shown{20, 30, 220, 150};
    const Size size{260, 170};
    ControlMesh mesh;
    mesh.columns = mesh.rows = 2;
    mesh.vertices = {{-31, -42}, {97, -33},  {251, -29}, {-25, 51}, {120, 66},
                     {240, 77},  {-40, 160}, {103, 149}, {241, 139}};
    ControlMesh moved = mesh;
    for (Point<double>& vertex : moved.vertices) {
        vertex.x += shown.x0;
        vertex.y += shown.y0;
    }
    for (const PixelType type : {PixelType::uint16, PixelType::half, PixelType::float32})
        for (const WarpScheme scheme : {WarpScheme::automatic, WarpScheme::exact}) {
            const Large large(size, type, 3);
            MeshWarpOptions options;
            options.scheme = scheme;
            options.tol = 1e-5;
            for (const Filter filter :
                 {Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic, Filter::antialias}) {
                options.filter = filter;
                expect_one(warped_picture({"all", moved}, size, kTarget, options),
                           warped_picture({"part", mesh}, {shown.width(), shown.height()}, kTarget, options),
                           large, shown, -1, true);
            }
        }
}

TEST(Overscan, KeysTellIt) {
    const Operation& operation = *find_operation("lens");
    const ParameterValues values(*operation.parameters);
    SourceImage image;
    image.facts.width = image.facts.height = 8;
    SourceImage more = image;
    more.facts.overscan = Box{-1, 0, 8, 9};
    EXPECT_NE(operation_key(operation, values, {image}, {}), operation_key(operation, values, {more}, {}));
}

}  // namespace
}  // namespace anamorph::test_overscan
