// SPDX-License-Identifier: Apache-2.0
// Mesh warps as they are drawn: the same bits however they are cut, and what the other outputs say.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "anamorph/image/pyramid.h"
#include "anamorph/mesh/mesh_file.h"
#include "anamorph/mesh/mesh_warp.h"
#include "mesh_cases.h"

namespace anamorph::test_mesh_warp {
namespace {

/// Packed float pixels.
struct Picture {
    int width, height, channels;
    std::vector<float> values;

    Picture(int w, int h, int c)
        : width(w),
          height(h),
          channels(c),
          values(static_cast<std::size_t>(w) * static_cast<std::size_t>(h * c)) {}
    ImageView view() {
        return packed_view(reinterpret_cast<std::byte*>(values.data()), PixelType::float32, width, height,
                           channels);
    }
    ConstImageView source() const {
        return packed_view(reinterpret_cast<const std::byte*>(values.data()), PixelType::float32, width,
                           height, channels);
    }
    float at(int x, int y, int c) const {
        return values[static_cast<std::size_t>((y * width + x) * channels + c)];
    }
};

Picture noise(test::Random& random, int width, int height) {
    Picture picture(width, height, 3);
    for (float& v : picture.values) v = static_cast<float>(random.between(0, 1));
    return picture;
}

void two_threads(std::int64_t count, const std::function<void(std::int64_t)>& body) {
    std::thread other([&] {
        for (std::int64_t i = count - 1; i >= 0; i -= 2) body(i);
    });
    for (std::int64_t i = count - 2; i >= 0; i -= 2) body(i);
    other.join();
}

double folded_fraction(const anamorph::Picture& picture, const ParallelFor& parallel_for = serial_for) {
    return std::get<double>(picture.says(parallel_for).at(0).value);
}

/// Draws the picture at once, and in pieces, last ones first, on two threads.
void expect_same_bits(const WarpMap& map, const MeshWarpOptions& options, const Size& target,
                      const Picture& texels) {
    SCOPED_TRACE(::testing::Message() << map.name << ", scheme " << static_cast<int>(options.scheme)
                                      << ", output " << static_cast<int>(options.output));
    const MemorySource source(texels.source());
    const auto make = [&] { return warped_picture(map, {texels.width, texels.height}, target, options); };
    const auto warp = make(), again = make();
    const int channels = warp.channels(&source);
    Picture whole(target.width, target.height, channels), cut(target.width, target.height, channels);
    ASSERT_TRUE(warp.draw(&source, {0, 0, target.width, target.height}, whole.view()));
    for (int y = 0; y < target.height; y += 97)
        for (int x = (target.width - 1) / 131 * 131; x >= 0; x -= 131) {
            const Box box{x, y, std::min(x + 131, target.width), std::min(y + 97, target.height)};
            ImageView view = cut.view();
            view.data = view.at(box.x0, box.y0);
            view.width = box.width();
            view.height = box.height();
            ASSERT_TRUE(again.draw(&source, box, view, two_threads));
        }
    EXPECT_EQ(whole.values, cut.values);
}

TEST(MeshWarp, SameBitsForAnyCutAndThreads) {
    constexpr unsigned kSeed = 541;
    SCOPED_TRACE(::testing::Message() << "seed " << kSeed);
    test::Random random(kSeed);
    const Size target{700, 530}, size{400, 300};
    const Picture texels = noise(random, size.width, size.height);
    const WarpMap pull{"pull", test::random_mesh(random, target, size, 5, 4, 0.4, true, 2)};
    ControlMesh mesh = test::random_mesh(random, size, target, 5, 4, 0.3, false, 1);
    mesh.direction = Direction::push;
    const WarpMap push{"push", mesh};
    ControlPoints pairs;
    for (int i = 0; i < 40; ++i) {
        const double x = random.between(0, 700), y = random.between(0, 530);
        pairs.pairs.push_back({x, y, x * 4 / 7 + random.between(-9, 9), y * 3 / 5.3 + random.between(-9, 9)});
    }
    const WarpMap points{"points", pairs};
    // Cells as small as pixels.
    const WarpMap dense{"dense", test::random_mesh(random, target, size, 400, 300, 0.4, true, 0)};
    MeshWarpOptions options;
    options.tol = 1.0 / 16;
    for (const WarpScheme scheme :
         {WarpScheme::automatic, WarpScheme::hermite, WarpScheme::residual, WarpScheme::exact}) {
        options.scheme = scheme;
        expect_same_bits(pull, options, target, texels);
    }
    options.scheme = WarpScheme::automatic;
    for (const WarpMap* map : {&push, &points, &dense}) expect_same_bits(*map, options, target, texels);
    for (const Output output : {Output::stmap, Output::error, Output::bound, Output::color}) {
        options.output = output;
        options.folds = output == Output::color;
        for (const WarpMap* map : {&pull, &push, &points, &dense})
            expect_same_bits(*map, options, target, texels);
    }
}

/// An ST-map that turns and shrinks, with a wave.
std::vector<float> smooth_stmap(const Size& size) {
    std::vector<float> uv;
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            const double s = (x + 0.5) / size.width, t = (y + 0.5) / size.height;
            uv.push_back(static_cast<float>(0.1 + 0.7 * s + 0.15 * t + 0.02 * std::sin(9 * t)));
            uv.push_back(static_cast<float>(0.05 - 0.1 * s + 0.8 * t + 0.02 * std::cos(7 * s)));
        }
    return uv;
}

TEST(MeshWarp, HolesOfAnStMapShowNothingAndNothingElseChanges) {
    test::Random random(11);
    const Size target{200, 140}, size{1150, 850};
    const Picture texels = noise(random, size.width, size.height);
    const std::vector<float> full = smooth_stmap(target);
    std::vector<float> uv = full;
    std::vector<bool> hole(static_cast<std::size_t>(target.width * target.height));
    const auto dig = [&](int x, int y) {
        const auto i = static_cast<std::size_t>(y * target.width + x);
        hole[i] = true;
        uv[2 * i + random.whole(0, 1)] = NAN;
    };
    for (int i = 0; i < 60; ++i) dig(random.whole(0, target.width - 1), random.whole(0, target.height - 1));
    for (int y = 64; y < 100; ++y)
        for (int x = 64; x < 130; ++x) dig(x, y);
    dig(0, 0);
    const WarpMap map = mesh_from_stmap(uv, target.width, target.height, "holes"),
                  whole = mesh_from_stmap(full, target.width, target.height, "full");
    const auto far_from_holes = [&](int x, int y) {
        for (int j = std::max(0, y - 3); j <= std::min(target.height - 1, y + 3); ++j)
            for (int i = std::max(0, x - 3); i <= std::min(target.width - 1, x + 3); ++i)
                if (hole[static_cast<std::size_t>(j * target.width + i)]) return false;
        return true;
    };
    const MemorySource source(texels.source());
    const auto draw = [&](const WarpMap& of, const MeshWarpOptions& options) {
        const auto warp = warped_picture(of, size, target, options);
        Picture picture(target.width, target.height, warp.channels(&source));
        EXPECT_TRUE(warp.draw(&source, {0, 0, target.width, target.height}, picture.view()));
        return picture;
    };
    MeshWarpOptions options;
    for (const double tol : {0.0, 0.01})
        for (const Filter filter :
             {Filter::nearest, Filter::bilinear, Filter::bicubic, Filter::sharp_bicubic, Filter::antialias}) {
            SCOPED_TRACE(::testing::Message() << tol << " " << static_cast<int>(filter));
            options.tol = tol;
            options.filter = filter;
            const Picture with = draw(map, options), without = draw(whole, options);
            for (int y = 0; y < target.height; ++y)
                for (int x = 0; x < target.width; ++x)
                    for (int c = 0; c < 3; ++c) {
                        const float value = with.at(x, y, c);
                        if (hole[static_cast<std::size_t>(y * target.width + x)]) {
                            ASSERT_EQ(value, 0.0f) << x << " " << y;
                            continue;
                        }
                        // Near a hole each pixel has a footprint of its own, and beside one other neighbours to go by.
                        const double most = filter == Filter::nearest     ? 0
                                            : filter != Filter::antialias ? 2e-3
                                            : far_from_holes(x, y)        ? 0.2
                                                                          : 0.25;
                        ASSERT_NEAR(value, without.at(x, y, c), most) << x << " " << y;
                    }
            expect_same_bits(map, options, target, texels);
        }
    options.output = Output::stmap;
    const Picture points = draw(map, options);
    options.output = Output::stmap_up;
    const Picture up = draw(map, options);
    for (int y = 0; y < target.height; ++y)
        for (int x = 0; x < target.width; ++x) {
            const bool is_hole = hole[static_cast<std::size_t>(y * target.width + x)];
            const std::size_t i = 2 * static_cast<std::size_t>(y * target.width + x);
            ASSERT_NEAR(points.at(x, y, 0), is_hole ? -1 : full[i], 1e-4);
            ASSERT_NEAR(points.at(x, y, 1), is_hole ? -1 : full[i + 1], 1e-4);
            ASSERT_EQ(up.at(x, y, 0), points.at(x, y, 0));
            ASSERT_NEAR(up.at(x, y, 1), is_hole ? -1 : 1 - full[i + 1], 1e-4);
        }
    for (const Output output : {Output::stmap, Output::error, Output::bound}) {
        options.output = output;
        expect_same_bits(map, options, target, texels);
    }
    EXPECT_GE(folded_fraction(warped_picture(map, size, target, options)), 0);
    // Between pixels nothing is known of holes.
    for (const auto& [wanted, direction] :
         {std::pair{Size{100, 70}, Direction::pull}, std::pair{target, Direction::push}}) {
        WarpMap other = map;
        std::get<ControlMesh>(other.shape).direction = direction;
        try {
            warped_picture(other, size, wanted, options);
            FAIL();
        } catch (const Error& error) {
            EXPECT_THAT(error.what(), ::testing::AllOf(::testing::HasSubstr("holes has 2"),
                                                       ::testing::HasSubstr("in its own size, 200x140")));
        }
    }
}

// Where a warp makes smaller, whole patches are read from coarse levels: the mean of a ramp about a point is
// its value there.
TEST(MeshWarp, AntialiasedPatchesStandWhereTheyBelong) {
    test::Random random(544);
    const Size target{128, 96}, size{2048, 1536};
    const WarpMap map{"grid", test::random_mesh(random, target, size, 2, 2, 0.5, false, 0)};
    Picture ramp(size.width, size.height, 3);
    for (int y = 0; y < size.height; ++y)
        for (int x = 0; x < size.width; ++x) {
            float* at = &ramp.values[static_cast<std::size_t>(y * size.width + x) * 3];
            at[0] = static_cast<float>(x) + 0.5f;
            at[1] = static_cast<float>(y) + 0.5f;
        }
    const MemorySource base(ramp.source());
    const Pyramid source(base);
    MeshWarpOptions options;
    options.tol = 1.0 / 64;
    options.filter = Filter::antialias;
    const auto warp = warped_picture(map, size, target, options);
    Picture drawn(target.width, target.height, 3);
    ASSERT_TRUE(warp.draw(&source, {0, 0, target.width, target.height}, drawn.view()));
    int checked = 0;
    for (int y = 0; y < target.height; ++y)
        for (int x = 0; x < target.width; ++x) {
            Point<double> p{};
            int piece = 0;
            ASSERT_TRUE(warp.maps[0].blocks->exact(x + 0.5, y + 0.5, 0, p, piece));
            constexpr double kEdge = 200;  // more than a footprint
            if (std::min({p.x, p.y, size.width - p.x, size.height - p.y}) < kEdge) continue;
            ++checked;
            ASSERT_NEAR(static_cast<double>(drawn.at(x, y, 0)), p.x, 0.1) << x << " " << y;
            ASSERT_NEAR(static_cast<double>(drawn.at(x, y, 1)), p.y, 0.1) << x << " " << y;
        }
    EXPECT_GT(checked, 3000);
}

TEST(MeshWarp, AmountZeroIsTheSourceToTheBit) {
    test::Random random(542);
    const Size size{300, 200};
    const Picture texels = noise(random, size.width, size.height);
    const MemorySource source(texels.source());
    const WarpMap map{"grid", test::random_mesh(random, size, size, 5, 4, 0.4, true, 2)};
    MeshWarpOptions options;
    options.amount = 0;
    options.tol = 0;
    options.filter = Filter::bilinear;
    const auto warp = warped_picture(map, size, size, options);
    Picture drawn(300, 200, 3);
    ASSERT_TRUE(warp.draw(&source, {0, 0, 300, 200}, drawn.view()));
    EXPECT_EQ(drawn.values, texels.values);
}

TEST(MeshWarp, OutputsAgree) {
    test::Random random(543);
    const Size target{256, 192}, size{400, 300};
    const WarpMap map{"grid", test::random_mesh(random, target, size, 3, 3, 0.9, false, 1)};
    MeshWarpOptions options;
    options.tol = 0.25;
    const auto draw = [&](Output output, int channels, bool folded = false) {
        options.output = output;
        options.folds = folded;
        const auto warp = warped_picture(map, size, target, options);
        Picture picture(target.width, target.height, channels);
        EXPECT_TRUE(warp.draw(nullptr, {0, 0, target.width, target.height}, picture.view()));
        return picture;
    };
    const Picture st = draw(Output::stmap, 2), error = draw(Output::error, 1), bound = draw(Output::bound, 1),
                  folds = draw(Output::color, 1, true);
    const Mesh mesh(std::get<ControlMesh>(map.shape), target, size, 1);
    double folded = 0, largest = 0;
    for (int y = 0; y < target.height; ++y)
        for (int x = 0; x < target.width; ++x) {
            const Point<double> p = mesh.at(x + 0.5, y + 0.5);
            const double off = std::hypot(double(st.at(x, y, 0)) * size.width - p.x,
                                          double(st.at(x, y, 1)) * size.height - p.y);
            EXPECT_NEAR(off, error.at(x, y, 0), 1e-3);
            EXPECT_LE(error.at(x, y, 0), bound.at(x, y, 0));
            largest = std::max(largest, double(bound.at(x, y, 0)));
            folded += folds.at(x, y, 0) != 0;
        }
    options.output = Output::color;
    options.folds = false;
    const auto warp = warped_picture(map, size, target, options);
    EXPECT_FLOAT_EQ(static_cast<float>(warp.reached().max_error), static_cast<float>(largest));
    EXPECT_GT(folded, 0);
    EXPECT_DOUBLE_EQ(folded_fraction(warp, two_threads), folded / (target.width * target.height));
}

TEST(MeshWarp, RefusesWhatDoesNotFit) {
    const WarpMap map{"grid", test::identity_mesh({10, 10}, 2, 2)};
    EXPECT_THROW(warped_picture(map, {0, 10}, {10, 10}, {}), Error);
    EXPECT_THROW(warped_picture(map, {10, 10}, {10, 1 << 30}, {}), Error);
    MeshWarpOptions options;
    options.tol = -1;
    EXPECT_THROW(warped_picture(map, {10, 10}, {10, 10}, options), Error);
    options.tol = 1;
    options.amount = HUGE_VAL;
    EXPECT_THROW(warped_picture(map, {10, 10}, {10, 10}, options), Error);
    Picture three(10, 10, 3);
    const auto warp = warped_picture(map, {10, 10}, {10, 10}, {});
    EXPECT_THROW(warp.draw(nullptr, {0, 0, 10, 10}, three.view()), Error);
}

/// A picture of one grey, with the mesh over it.
Picture with_mesh(const ControlMesh& mesh, const Size& size, const Box& box) {
    Picture grey(size.width, size.height, 3), drawn(box.width(), box.height(), 3);
    std::fill(grey.values.begin(), grey.values.end(), 0.5f);
    MeshWarpOptions options;
    options.draws_mesh = true;
    options.wrap = Wrap::clamp;
    const MemorySource source(grey.source());
    EXPECT_TRUE(warped_picture({"mesh", mesh}, size, size, options).draw(&source, box, drawn.view()));
    return drawn;
}

TEST(MeshWarp, DrawsTheMeshOverThePicture) {
    const Size size{80, 60};
    const Box whole{0, 0, 80, 60};
    // By the definition: one pixel and a half wide, so three quarters of the pixels on either side of a line between pixels.
    const float first[] = {1, 0.3f, 0.1f}, second[] = {0.1f, 0.55f, 1};
    const auto expect_line = [&](const Picture& picture, int x, int y, const float* color) {
        for (int c = 0; c < 3; ++c)
            EXPECT_NEAR(picture.at(x, y, c), 0.5 + 0.75 * (color[c] - 0.5), 1e-6) << x << "," << y;
    };
    const auto expect_none = [&](const Picture& picture, int x, int y) {
        for (int c = 0; c < 3; ++c) EXPECT_EQ(picture.at(x, y, c), 0.5f) << x << "," << y;
    };
    ControlMesh mesh = test::identity_mesh(size, 4, 3);
    mesh.levels.push_back({{{1, 1}}, {}});
    // Where vertices go moves no line of a mesh that pulls.
    mesh.vertices[6] = {31, 17};
    const Picture pulled = with_mesh(mesh, size, whole);
    for (const int x : {19, 20, 39, 40, 59, 60}) expect_line(pulled, x, 9, first);
    for (const int y : {19, 20, 39, 40}) expect_line(pulled, 50, y, first);
    for (const int x : {29, 30}) expect_line(pulled, x, 25, second);
    expect_line(pulled, 25, 30, second);
    for (const int x : {10, 18, 21, 30, 50}) expect_none(pulled, x, 10);
    expect_none(pulled, 25, 25);
    // In parts the same.
    const Box part{13, 11, 57, 48};
    const Picture cut = with_mesh(mesh, size, part);
    for (int y = part.y0; y < part.y1; ++y)
        for (int x = part.x0; x < part.x1; ++x)
            for (int c = 0; c < 3; ++c) ASSERT_EQ(cut.at(x - part.x0, y - part.y0, c), pulled.at(x, y, c));
    // Of one that pushes edges go where the vertices go: here by 5 to the right and 3 down.
    ControlMesh pushed = test::identity_mesh(size, 4, 3);
    pushed.direction = Direction::push;
    for (Point<double>& v : pushed.vertices) v = {v.x + 5, v.y + 3};
    const Picture moved = with_mesh(pushed, size, whole);
    for (const int x : {24, 25, 44, 45})
        for (const int y : {8, 13, 14, 15, 16}) expect_line(moved, x, y, first);
    expect_line(moved, 50, 42, first);
    expect_none(moved, 20, 13);
}

TEST(MeshWarp, SaysWhatHasNoMeshToDraw) {
    const auto refusal = [](const WarpMap& map) -> std::string {
        MeshWarpOptions options;
        options.draws_mesh = true;
        try {
            warped_picture(map, {400, 300}, {400, 300}, options);
        } catch (const Error& error) {
            return error.what();
        }
        return "";
    };
    EXPECT_THAT(refusal({"p.csv", ControlPoints{Units::pixels, {{0, 0, 0, 0}, {9, 0, 9, 1}, {0, 9, 1, 9}}}}),
                testing::HasSubstr("output=mesh: must be another of p.csv, which has points and no mesh"));
    EXPECT_THAT(refusal({"m.json", test::identity_mesh({400, 300}, 300, 220)}),
                testing::HasSubstr("which has 66000 cells: at most 65536 are drawn"));
    EXPECT_EQ(refusal({"m.json", test::identity_mesh({400, 300}, 256, 256)}), "");
    EXPECT_THAT(refusal(mesh_from_stmap(std::vector<float>{0, 0, 1, 0, 0, 1, 1, 1}, 2, 2, "map.exr")),
                testing::HasSubstr("map.exr, which is an ST-map taken pixel for pixel"));
}

}  // namespace
}  // namespace anamorph::test_mesh_warp
