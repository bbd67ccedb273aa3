// SPDX-License-Identifier: Apache-2.0
// Pictures read through maps that are known in closed form, against a sampler and borders written out here in
// long double: nearest and bilinear, every type, border and number of channels, exact and in blocks.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <numbers>
#include <random>

#include "anamorph/mesh/mesh_warp.h"
#include "anamorph/panorama/reproject.h"

namespace anamorph::test_reading {
namespace {

using Real = long double;

class Random {
  public:
    explicit Random(unsigned seed) : m_random(seed) {}
    int whole(int low, int high) {
        return low + static_cast<int>(m_random() % static_cast<unsigned>(high - low + 1));
    }
    double between(double low, double high) { return low + (high - low) * (m_random() / 4294967296.0); }

  private:
    std::mt19937 m_random;
};

/// Random pixels, as bytes of some type and as the numbers they stand for.
struct Texels {
    int width, height, channels, alpha;
    PixelType type;
    std::vector<std::byte> bytes;
    std::vector<Real> values;

    Texels(Random& random, int w, int h)
        : width(w),
          height(h),
          channels(random.whole(1, 8)),
          alpha(-1),
          type(static_cast<PixelType>(random.whole(0, 3))) {
        if (random.whole(0, 3) == 0) alpha = random.whole(0, channels - 1);
        for (int i = 0; i < w * h * channels; ++i) add(random);
    }
    Real at(int x, int y, int c) const {
        return values[static_cast<std::size_t>((y * width + x) * channels + c)];
    }
    MemorySource source() const {
        return MemorySource(packed_view(bytes.data(), type, width, height, channels), alpha);
    }

  private:
    void add(Random& random) {
        const auto put = [&](auto stored, Real value) {
            bytes.resize(bytes.size() + sizeof stored);
            std::memcpy(bytes.data() + bytes.size() - sizeof stored, &stored, sizeof stored);
            values.push_back(value);
        };
        if (type == PixelType::uint8) {
            const int n = random.whole(0, 255);
            put(static_cast<std::uint8_t>(n), Real(n) / 255);
        } else if (type == PixelType::uint16) {
            const int n = random.whole(0, 65535);
            put(static_cast<std::uint16_t>(n), Real(n) / 65535);
        } else if (type == PixelType::half) {
            // (1024 + fraction) 2^(exponent - 25), below 1.
            const int exponent = random.whole(8, 14), fraction = random.whole(0, 1023);
            put(static_cast<std::uint16_t>(exponent << 10 | fraction),
                std::ldexp(Real(1024 + fraction), exponent - 25));
        } else {
            const auto value = static_cast<float>(random.between(0, 1));
            put(value, value);
        }
    }
};

/// Where a texel beyond the edges stands, -1: nowhere.
int beyond(int at, int size, Wrap wrap) {
    if (at >= 0 && at < size) return at;
    switch (wrap) {
        case Wrap::clamp:
            return at < 0 ? 0 : size - 1;
        case Wrap::periodic:
            while (at < 0) at += size;
            while (at >= size) at -= size;
            return at;
        case Wrap::mirror:
            while (at < 0 || at >= size) at = at < 0 ? -1 - at : 2 * size - 1 - at;
            return at;
        default:
            return -1;
    }
}

/// The texel at (x, y), all around the sphere where the source is one.
Real texel(const Texels& t, int x, int y, int c, Wrap wrap, bool sphere) {
    if (sphere && wrap == Wrap::automatic) {
        const bool over = y < 0 || y >= t.height;
        if (over) y = y < 0 ? -1 - y : 2 * t.height - 1 - y;
        x = beyond(over ? x + t.width / 2 : x, t.width, Wrap::periodic);
    } else {
        x = beyond(x, t.width, wrap);
        y = beyond(y, t.height, wrap);
    }
    if (x < 0 || y < 0) return 0;
    const Real value = t.at(x, y, c);
    return t.alpha >= 0 && c != t.alpha ? value * t.at(x, y, t.alpha) : value;
}

Real read(const Texels& t, Filter filter, Real x, Real y, int c, Wrap wrap, bool sphere) {
    const auto at = [&](int i, int j) { return texel(t, i, j, c, wrap, sphere); };
    if (filter == Filter::nearest)
        return at(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y)));
    const int i = static_cast<int>(std::floor(x - 0.5L)), j = static_cast<int>(std::floor(y - 0.5L));
    const Real u = x - 0.5L - i, v = y - 0.5L - j;
    return (1 - v) * ((1 - u) * at(i, j) + u * at(i + 1, j)) +
           v * ((1 - u) * at(i, j + 1) + u * at(i + 1, j + 1));
}

struct Case {
    Wrap wrap;
    Filter filter;
    double tol;
    bool sphere;
    int width, height;
    std::function<void(Real, Real, Real&, Real&)> map;  ///< target pixel to source pixel
};

/// Are all pixels of the picture what is read at their points, moved by no more than the tolerance? Counts
/// the values that were compared.
int expect_read(const Case& c, const Texels& t, const std::vector<float>& picture) {
    // Beside the tolerance, formulas in double.
    const Real off = c.tol + 1e-9L;
    const auto near_edge = [&](Real at) { return std::fabs(at - std::round(at)) <= off; };
    int wrong = 0, compared = 0;
    for (int y = 0; y < c.height; ++y)
        for (int x = 0; x < c.width; ++x) {
            Real px = 0, py = 0;
            c.map(x + 0.5L, y + 0.5L, px, py);
            if (c.filter == Filter::nearest && (near_edge(px) || near_edge(py))) continue;
            const Real slack = (c.filter == Filter::nearest ? 0 : 2 * off) + 2e-6L;
            const Real alpha = t.alpha < 0 ? 1 : read(t, c.filter, px, py, t.alpha, c.wrap, c.sphere);
            for (int k = 0; k < t.channels; ++k) {
                const Real got = picture[static_cast<std::size_t>((y * c.width + x) * t.channels + k)];
                Real value = read(t, c.filter, px, py, k, c.wrap, c.sphere), room = slack;
                if (t.alpha >= 0 && k != t.alpha && alpha != 0) {
                    if (alpha < 0.05L) continue;
                    value /= alpha;
                    room = 2 * slack / (alpha - slack);
                }
                ++compared;
                wrong += !(std::fabs(got - value) <= room);
            }
        }
    EXPECT_EQ(wrong, 0) << "of " << compared;
    return compared;
}

Case random_case(Random& random) {
    Case c{};
    c.wrap = static_cast<Wrap>(random.whole(0, 4));
    c.filter = random.whole(0, 1) ? Filter::nearest : Filter::bilinear;
    c.tol = random.whole(0, 1) ? 0 : 0.01;
    c.width = random.whole(1, 90);
    c.height = random.whole(1, 70);
    return c;
}

template <class Picture>
std::vector<float> draw(const Picture& job, const Case& c, const Texels& t) {
    std::vector<float> values(static_cast<std::size_t>(c.width * c.height * t.channels));
    const MemorySource source = t.source();
    EXPECT_TRUE(job.draw(&source, {0, 0, c.width, c.height},
                         packed_view(reinterpret_cast<std::byte*>(values.data()), PixelType::float32, c.width,
                                     c.height, t.channels)));
    return values;
}

constexpr int kCases = 150;

TEST(Reading, ThroughAffineMeshes) {
    int compared = 0;
    for (unsigned seed = 0; seed < kCases; ++seed) {
        SCOPED_TRACE(seed);
        Random random(seed);
        Case c = random_case(random);
        const Texels t(random, random.whole(1, 40), random.whole(1, 40));
        const double angle = random.whole(0, 2) ? random.between(-4, 4) : 0, size = random.between(0.2, 1.5);
        const double a = size * std::cos(angle), b = size * std::sin(angle), x0 = random.between(-30, 40),
                     y0 = random.between(-30, 40);
        c.map = [=](Real x, Real y, Real& u, Real& v) {
            u = x0 + Real(a) * x - Real(b) * y;
            v = y0 + Real(b) * x + Real(a) * y;
        };
        ControlMesh mesh;
        mesh.columns = random.whole(1, 3);
        mesh.rows = random.whole(1, 3);
        for (int j = 0; j <= mesh.rows; ++j)
            for (int i = 0; i <= mesh.columns; ++i) {
                Real u = 0, v = 0;
                c.map(Real(c.width) * i / mesh.columns, Real(c.height) * j / mesh.rows, u, v);
                mesh.vertices.push_back({static_cast<double>(u), static_cast<double>(v)});
            }
        MeshWarpOptions options;
        options.tol = c.tol;
        options.filter = c.filter;
        options.wrap = c.wrap;
        if (c.wrap == Wrap::automatic) c.wrap = Wrap::black;
        const auto warp = warped_picture({"mesh", mesh}, {t.width, t.height}, {c.width, c.height}, options);
        compared += expect_read(c, t, draw(warp, c, t));
    }
    EXPECT_GT(compared, 100'000);
}

TEST(Reading, AroundAPanorama) {
    int compared = 0;
    for (unsigned seed = 0; seed < kCases; ++seed) {
        SCOPED_TRACE(seed);
        Random random(1000 + seed);
        Case c = random_case(random);
        c.sphere = true;
        c.width = 2 * c.height;
        const int half = random.whole(1, 25);
        const Texels t(random, 2 * half, half);
        const double yaw = random.between(-400, 400);
        const Chart from(Projection::equirectangular, t.width, t.height),
            to(Projection::equirectangular, c.width, c.height);
        const Real size = Real(t.width) / c.width;
        c.map = [&](Real x, Real y, Real& u, Real& v) {
            u = x * size + Real(yaw) / 360 * t.width;
            u -= std::floor(u / t.width) * t.width;
            v = y * size;
        };
        ReprojectOptions options;
        options.tol = c.tol;
        options.filter = c.filter;
        options.wrap = c.wrap;
        const auto job = reprojected_picture(Panorama(from, to, {yaw, 0, 0}), options);
        compared += expect_read(c, t, draw(job, c, t));
    }
    EXPECT_GT(compared, 100'000);
}

TEST(Reading, ThroughALensThatRolls) {
    int compared = 0;
    for (unsigned seed = 0; seed < kCases; ++seed) {
        SCOPED_TRACE(seed);
        Random random(2000 + seed);
        Case c = random_case(random);
        const Texels t(random, random.whole(1, 40), random.whole(1, 40));
        const double roll = random.between(-180, 180), from_fov = random.between(20, 120),
                     to_fov = random.between(20, 120);
        const Real degree = std::numbers::pi_v<Real> / 180;
        const Real size =
            (t.width / std::tan(from_fov * degree / 2)) / (c.width / std::tan(to_fov * degree / 2));
        const Real cosine = std::cos(roll * degree), sine = std::sin(roll * degree);
        c.map = [&](Real x, Real y, Real& u, Real& v) {
            const Real dx = (x - c.width * 0.5L) * size, dy = (y - c.height * 0.5L) * size;
            u = t.width * 0.5L + cosine * dx - sine * dy;
            v = t.height * 0.5L + sine * dx + cosine * dy;
        };
        ReprojectOptions options;
        options.tol = c.tol;
        options.filter = c.filter;
        options.wrap = c.wrap;
        const auto job =
            reprojected_picture(Panorama({Projection::rectilinear, t.width, t.height, from_fov},
                                         {Projection::rectilinear, c.width, c.height, to_fov}, {0, 0, roll}),
                                options);
        compared += expect_read(c, t, draw(job, c, t));
    }
    EXPECT_GT(compared, 100'000);
}

}  // namespace
}  // namespace anamorph::test_reading
