// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/image/visible_surfaces.h"

#include <algorithm>
#include <array>

#include "anamorph/figure/outline/outline_body.h"

namespace anamorph::figure {
namespace {

constexpr int kSide = VisibleSurfaces::kSide, kSamples = VisibleSurfaces::kSamples;

/// Where samples are in a pixel, either way.
constexpr std::array<double, kSide> kPlaces = [] {
    std::array<double, kSide> places{};
    for (std::size_t i = 0; i < kSide; ++i) places[i] = (static_cast<double>(i) + 0.5) / kSide;
    return places;
}();

/// The least and the greatest nearness of a body over a pixel that it covers wholly, with one of its sides.
struct Cover {
    double least = -HUGE_VAL, greatest = -HUGE_VAL;
    bool far_side = false;

    bool whole() const { return least > -HUGE_VAL; }
};

/// `corners`: the nearness of the near side, -infinity where there is none.
Cover near_cover(const std::array<double, 4>& corners, double middle) {
    const double least = *std::min_element(corners.begin(), corners.end());
    if (!(least > -HUGE_VAL)) return {};
    return {least, 2 * middle - least, false};
}

/// The cover by a body that meets the near plane: by the inside of it, where nothing else of it shows.
Cover far_cover(const SeenSurface& surface, int x, int y) {
    double greatest = -HUGE_VAL;
    for (const auto& [dx, dy] : {std::pair{0, 0}, {1, 0}, {0, 1}, {1, 1}}) {
        const SurfaceHit hit = surface.hit(x + dx, y + dy);
        if (!hit.far_side) return {};
        greatest = std::max(greatest, hit.nearness);
    }
    const SurfaceHit middle = surface.hit(x + 0.5, y + 0.5);
    return middle.far_side ? Cover{2 * middle.nearness - greatest, greatest, true} : Cover{};
}

/// The work of one box.
class Tile {
  public:
    Tile(const std::vector<SeenSurface>& surfaces, const Box& box) : m_surfaces(surfaces), m_box(box) {
        for (std::size_t i = 0; i < surfaces.size(); ++i)
            if (!intersection(surfaces[i].box(), box).empty()) m_bodies.push_back(static_cast<int>(i));
    }

    std::vector<VisiblePoint> take_points() {
        std::vector<VisiblePoint> points(pixels());
        // From the nearest on: most of what is behind need not be met.
        std::sort(m_bodies.begin(), m_bodies.end(),
                  [&](int a, int b) { return at(a).nearest() > at(b).nearest(); });
        for (const int body : m_bodies) {
            const SeenSurface& surface = at(body);
            const double nearest = surface.nearest();
            for_each_pixel(surface, [&](int x, int y) {
                VisiblePoint& point = points[index(x, y)];
                if (nearest < point.hit.nearness) return;
                const SurfaceHit hit = surface.hit(x + 0.5, y + 0.5);
                if (hit.nearness > point.hit.nearness ||
                    (hit.nearness == point.hit.nearness && body < point.body))
                    point = {body, hit};
            });
        }
        return points;
    }

    VisibleParts take_parts() {
        m_pixels.resize(pixels());
        for (const int body : m_bodies) cover_with(body);
        for (const int body : m_bodies) contend_with(body);
        VisibleParts out{m_box, {}, {}};
        out.first.reserve(m_pixels.size() + 1);
        for (int y = m_box.y0; y < m_box.y1; ++y)
            for (int x = m_box.x0; x < m_box.x1; ++x) {
                out.first.push_back(out.parts.size());
                const Pixel& pixel = m_pixels[index(x, y)];
                if (pixel.contender >= 0)
                    sample(x, y, pixel, out.parts);
                else if (pixel.owner >= 0)
                    out.parts.push_back({pixel.owner, pixel.far_side, kSamples, x + 0.5, y + 0.5});
            }
        out.first.push_back(out.parts.size());
        return out;
    }

  private:
    struct Pixel {
        double least = -HUGE_VAL;  ///< nearness that everything seen has
        int owner = -1;            ///< the body that has it, and covers the pixel
        int contender = -1;        ///< the last in m_contenders, of others that may be seen
        bool far_side = false;     ///< of the owner
    };
    struct Contender {
        int body, before;
    };
    struct Here {
        int body;
        double least, greatest;  ///< nearness of what the pixel shows of it
    };

    const SeenSurface& at(int body) const { return m_surfaces[static_cast<std::size_t>(body)]; }
    std::size_t pixels() const {
        return static_cast<std::size_t>(m_box.width()) * static_cast<std::size_t>(m_box.height());
    }
    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y - m_box.y0) * static_cast<std::size_t>(m_box.width()) +
               static_cast<std::size_t>(x - m_box.x0);
    }

    template <class Body>
    void for_each_pixel(const SeenSurface& surface, const Body& body) const {
        const Box box = intersection(surface.box(), m_box);
        for (int y = box.y0; y < box.y1; ++y) {
            const auto [x0, x1] = surface.columns(y + 0.5, box.x0, box.x1);
            for (int x = x0; x < x1; ++x) body(x, y);
        }
    }

    void own(int x, int y, int body, const Cover& cover) {
        Pixel& pixel = m_pixels[index(x, y)];
        if (!(cover.least > pixel.least)) return;
        pixel.least = cover.least;
        pixel.owner = body;
        pixel.far_side = cover.far_side;
    }

    /// Finds the pixels that a body covers. Corners are shared by the pixels about them.
    void cover_with(int body) {
        const SeenSurface& surface = at(body);
        if (surface.meets_near_plane()) {
            for_each_pixel(surface, [&](int x, int y) { own(x, y, body, far_cover(surface, x, y)); });
            return;
        }
        const Box box = intersection(surface.box(), m_box);
        for (int y = box.y0; y < box.y1; ++y) {
            const auto [x0, x1] = surface.columns(y + 0.5, box.x0, box.x1);
            double above = -HUGE_VAL, below = -HUGE_VAL;
            for (int x = x0; x <= x1; ++x) {
                const double next_above = surface.near_side(x, y), next_below = surface.near_side(x, y + 1);
                const double least = std::min({above, below, next_above, next_below});
                if (x > x0 && least > -HUGE_VAL) own(x - 1, y, body, {least, least, false});
                above = next_above, below = next_below;
            }
        }
    }

    /// Finds the pixels of which a body may show something that does not own them.
    void contend_with(int body) {
        const SeenSurface& surface = at(body);
        const double nearest = surface.nearest();
        for_each_pixel(surface, [&](int x, int y) {
            Pixel& pixel = m_pixels[index(x, y)];
            if (pixel.owner == body || !(nearest > pixel.least) || !may_show(surface, x, y, pixel.least))
                return;
            m_contenders.push_back({body, pixel.contender});
            pixel.contender = static_cast<int>(m_contenders.size()) - 1;
        });
    }

    static bool may_show(const SeenSurface& surface, int x, int y, double least) {
        if (!(surface.nearest_in_pixel(x + 0.5, y + 0.5) > least)) return false;
        if (surface.meets_near_plane()) {
            const Cover cover = far_cover(surface, x, y);
            return !cover.whole() || cover.greatest > least;
        }
        const Cover cover = near_cover({surface.near_side(x, y), surface.near_side(x + 1, y),
                                        surface.near_side(x, y + 1), surface.near_side(x + 1, y + 1)},
                                       surface.near_side(x + 0.5, y + 0.5));
        return !cover.whole() || cover.greatest > least;
    }

    /// All samples of a pixel, of the bodies that may show.
    void sample(int x, int y, const Pixel& pixel, std::vector<VisiblePart>& parts) {
        m_here.clear();
        if (pixel.owner >= 0) add_body(pixel.owner, x, y);
        for (int i = pixel.contender; i >= 0; i = m_contenders[static_cast<std::size_t>(i)].before)
            add_body(m_contenders[static_cast<std::size_t>(i)].body, x, y);
        m_seen.fill(-1);
        if (put_in_order()) {
            for (std::size_t k = m_here.size(); k-- > 0;) cover_samples(x, y, k);
        } else {
            m_nearness.fill(-HUGE_VAL);
            for (std::size_t k = 0; k < m_here.size(); ++k) sample_body(x, y, k);
        }
        add_parts(x, y, parts);
    }

    void add_body(int body, int x, int y) {
        const SeenSurface& surface = at(body);
        m_here.push_back(
            {body, surface.farthest_in_pixel(x + 0.5, y + 0.5), surface.nearest_in_pixel(x + 0.5, y + 0.5)});
    }

    /// True where each body is before all that come after it: then it is enough to know what they cover.
    /// Otherwise they are in their own order, of which the first has what is equally near.
    bool put_in_order() {
        std::sort(m_here.begin(), m_here.end(),
                  [](const Here& a, const Here& b) { return a.least > b.least; });
        bool apart = true;
        double least = HUGE_VAL;
        for (const Here& here : m_here) {
            apart = apart && here.greatest < least;
            least = here.least;
        }
        if (!apart)
            std::sort(m_here.begin(), m_here.end(),
                      [](const Here& a, const Here& b) { return a.body < b.body; });
        return apart;
    }

    /// m_seen: twice the position in m_here, and one more for the far side. The samples of a row that a body
    /// covers follow each other.
    void cover_samples(int x, int y, std::size_t k) {
        const SeenSurface& surface = at(m_here[k].body);
        for (std::size_t row = 0; row < kSide; ++row) {
            const auto covers = [&](int i) {
                return surface.covers(x + kPlaces[static_cast<std::size_t>(i)], y + kPlaces[row]);
            };
            int from = 0, to = kSide;
            const bool first = covers(0), last = covers(kSide - 1);
            if (!first || !last) {
                // One that is covered, if any is.
                int inside = first ? 0 : kSide - 1;
                if (!first && !last) {
                    const double middle = (surface.middle_of_row(y + kPlaces[row]) - x) * kSide - 0.5;
                    inside = static_cast<int>(std::clamp(std::round(middle), 0.0, kSide - 1.0));
                    if (!covers(inside)) continue;
                }
                if (!first) from = border(covers, -1, inside);
                if (!last) to = border(covers, kSide, inside) + 1;
            }
            std::fill(m_seen.begin() + static_cast<std::ptrdiff_t>(row * kSide) + from,
                      m_seen.begin() + static_cast<std::ptrdiff_t>(row * kSide) + to,
                      2 * static_cast<int>(k));
        }
    }

    /// The covered sample next to those that are not, between one of these and one that is covered.
    template <class Covers>
    static int border(const Covers& covers, int outside, int inside) {
        while (std::abs(inside - outside) > 1) {
            const int middle = (inside + outside) / 2;
            (covers(middle) ? inside : outside) = middle;
        }
        return inside;
    }

    void sample_body(int x, int y, std::size_t k) {
        const SeenSurface& surface = at(m_here[k].body);
        const int seen = 2 * static_cast<int>(k);
        for (std::size_t i = 0; i < kSamples; ++i) {
            const SurfaceHit hit = surface.hit(x + kPlaces[i % kSide], y + kPlaces[i / kSide]);
            if (!(hit.nearness > m_nearness[i])) continue;
            m_nearness[i] = hit.nearness;
            m_seen[i] = seen + hit.far_side;
        }
    }

    void add_parts(int x, int y, std::vector<VisiblePart>& parts) {
        for (std::size_t s = 0; s < 2 * m_here.size(); ++s) {
            const int body = m_here[s / 2].body, seen = static_cast<int>(s);
            if (s % 2 == 1 && !at(body).meets_near_plane()) continue;
            int samples = 0, columns = 0, rows = 0;
            for (std::size_t row = 0; row < kSide; ++row) {
                int here = 0;
                for (std::size_t i = 0; i < kSide; ++i) {
                    const int is = m_seen[row * kSide + i] == seen;
                    here += is;
                    columns += is * static_cast<int>(i);
                }
                samples += here;
                rows += here * static_cast<int>(row);
            }
            if (samples == 0) continue;
            const double column = double(columns) / samples, row = double(rows) / samples;
            parts.push_back({body, s % 2 == 1, samples, x + (column + 0.5) / kSide, y + (row + 0.5) / kSide});
        }
    }

    const std::vector<SeenSurface>& m_surfaces;
    Box m_box;
    std::vector<int> m_bodies;  ///< whose boxes meet the box
    std::vector<Pixel> m_pixels;
    std::vector<Contender> m_contenders;
    std::vector<Here> m_here;  ///< those that may be seen in one pixel
    std::array<double, kSamples> m_nearness{};
    std::array<int, kSamples> m_seen{};
};

}  // namespace

VisibleSurfaces::VisibleSurfaces(std::span<const Ellipsoid> bodies, const View& view, double height,
                                 const std::vector<std::string>& names, const ParallelFor& parallel_for)
    : m_surfaces(bodies.size()), m_perspective(view.perspective()) {
    check(view);
    for (std::size_t i = 0; i < bodies.size(); ++i) check(bodies[i], i, names);
    constexpr std::size_t kBatch = 64;
    parallel_for(static_cast<std::int64_t>((bodies.size() + kBatch - 1) / kBatch), [&](std::int64_t k) {
        const std::size_t from = static_cast<std::size_t>(k) * kBatch;
        for (std::size_t i = from; i < std::min(from + kBatch, bodies.size()); ++i)
            m_surfaces[i] = SeenSurface(bodies[i], view, height);
    });
}

VisibleParts VisibleSurfaces::parts(const Box& box) const {
    return Tile(m_surfaces, box).take_parts();
}

std::vector<VisiblePoint> VisibleSurfaces::points(const Box& box) const {
    return Tile(m_surfaces, box).take_points();
}

}  // namespace anamorph::figure
