// SPDX-License-Identifier: Apache-2.0
#include "anamorph/projector/projection_bake.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <glm/geometric.hpp>
#include <memory>
#include <optional>

#include "anamorph/error.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

constexpr int kMostChannels = 64;
constexpr double kMostFade = 1 << 24, kMostMargin = 64;

/// A triangle in texels of its texture.
struct FlatTriangle {
    std::array<glm::dvec2, 3> corners;
    double twice_area;
    std::array<double, 3> sides;  ///< their lengths, each opposite of its corner

    FlatTriangle(const BakedTriangle& t, const Size& size) {
        for (std::size_t i = 0; i < 3; ++i)
            corners[i] = {t.coordinates[i].x * size.width, (1 - t.coordinates[i].y) * size.height};
        const glm::dvec2 p = corners[1] - corners[0], q = corners[2] - corners[0];
        twice_area = p.x * q.y - p.y * q.x;
        for (std::size_t i = 0; i < 3; ++i)
            sides[i] = glm::length(corners[(i + 2) % 3] - corners[(i + 1) % 3]);
    }

    bool counts() const {
        for (const glm::dvec2& c : corners)
            if (!(std::isfinite(c.x) && std::isfinite(c.y))) return false;
        return std::isfinite(twice_area) && twice_area != 0;
    }

    /// Weights of the corners.
    glm::dvec3 weights(const glm::dvec2& p) const {
        glm::dvec3 w;
        for (std::size_t i = 0; i < 3; ++i) w[static_cast<int>(i)] = area_from(i, p) / twice_area;
        return w;
    }
    /// What twice areas of a side and a point, as far from it as margins are, may be off by: a few roundings of products of such
    /// lengths.
    double rounding(double margin) const {
        const double reach = std::max({sides[0], sides[1], sides[2]}) + 2 * (margin + 1);
        return 0x1p-48 * reach * reach;
    }
    /// Is a point certainly farther away than `margin`? So it is if it is from the line of a side, and on its other side.
    bool is_beyond(const glm::dvec2& p, double margin, double rounding) const {
        for (std::size_t i = 0; i < 3; ++i) {
            const double twice = area_from(i, p);
            if ((twice_area > 0 ? -twice : twice) > margin * sides[i] + rounding) return true;
        }
        return false;
    }

    /// A triangle of points of a plane, given those of the corners, that has what is no farther than `margin` from this one.
    std::array<glm::dvec3, 3> enlarged(const std::array<glm::dvec3, 3>& points, double margin) const {
        // A corner's weight falls to -margin over its height, as far from the side that is opposite.
        const double area = std::fabs(twice_area);
        glm::dvec3 beyond;
        for (std::size_t i = 0; i < 3; ++i)
            beyond[static_cast<int>(i)] = (sides[i] * margin + rounding(margin)) / area + 1e-9;
        std::array<glm::dvec3, 3> result{};
        for (std::size_t i = 0; i < 3; ++i) {
            glm::dvec3 weights = -beyond;
            weights[static_cast<int>(i)] =
                1 + beyond[static_cast<int>((i + 1) % 3)] + beyond[static_cast<int>((i + 2) % 3)];
            result[i] = points[0] * weights.x + points[1] * weights.y + points[2] * weights.z;
        }
        return result;
    }

    double distance(const glm::dvec2& p) const {
        double least = HUGE_VAL;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec2 a = corners[i], along = corners[(i + 1) % 3] - a;
            const double t = std::clamp(glm::dot(p - a, along) / glm::dot(along, along), 0.0, 1.0);
            least = std::min(least, glm::length(p - a - t * along));
        }
        return least;
    }

  private:
    /// Twice the area of the side opposite of corner i and a point, turned as the triangle's is where the point is inside.
    double area_from(std::size_t i, const glm::dvec2& p) const {
        const glm::dvec2 a = corners[(i + 1) % 3] - p, b = corners[(i + 2) % 3] - p;
        return a.x * b.y - a.y * b.x;
    }
};

/// Bilinear, within the face that a texel lies on; across the seam of a closed panorama.
void read_pixel(const Chart& chart, const float* pixels, int channels, const Point<double>& texel,
                const glm::dvec3& ray, double share, double* sum) {
    const Box& box =
        chart.pieces()[static_cast<std::size_t>(chart.piece_of(Ray<double>{ray.x, ray.y, ray.z}))].box;
    const bool faces = chart.pieces().size() > 1 && !faces_of(chart.projection()).joined;
    const double x0 = faces ? box.x0 : 0, x1 = faces ? box.x1 : chart.width();
    const double y0 = faces ? box.y0 : 0, y1 = faces ? box.y1 : chart.height();
    const double x = texel.x - 0.5, y = std::clamp(texel.y - 0.5, y0, y1 - 1);
    const auto column = [&](double at) {
        if (!chart.closed()) return static_cast<std::int64_t>(std::clamp(at, x0, x1 - 1));
        const double wrapped = std::fmod(at, chart.period());
        return static_cast<std::int64_t>(wrapped < 0 ? wrapped + chart.period() : wrapped);
    };
    const double s = x - std::floor(x), t = y - std::floor(y);
    const std::int64_t left = column(std::floor(x)), right = column(std::floor(x) + 1);
    const auto top = static_cast<std::int64_t>(y),
               bottom = std::min(top + 1, static_cast<std::int64_t>(y1) - 1);
    const auto at = [&](std::int64_t i, std::int64_t j, int c) {
        return double{pixels[(j * chart.width() + i) * channels + c]};
    };
    for (int c = 0; c < channels; ++c)
        sum[c] += share * ((1 - t) * ((1 - s) * at(left, top, c) + s * at(right, top, c)) +
                           t * ((1 - s) * at(left, bottom, c) + s * at(right, bottom, c)));
}

/// What may hide points of the triangles of a mesh, found for a triangle when it is first asked for; several threads may ask at once.
class HidersOfTriangles {
  public:
    /// What may hide a triangle: few triangles, or too many to try them all at every point.
    struct Found {
        bool few = false;
        std::vector<std::int32_t> triangles;
    };

    explicit HidersOfTriangles(std::size_t count) : m_of(count) {}
    ~HidersOfTriangles() {
        for (const auto& found : m_of) delete found.load();
    }
    HidersOfTriangles(const HidersOfTriangles&) = delete;
    HidersOfTriangles& operator=(const HidersOfTriangles&) = delete;

    /// What hides triangle i, whose corners and margin lie in the triangle that `about` gives.
    template <class About>
    const Found& of(std::size_t i, const Occluders& occluders, const About& about) {
        const Found* known = m_of[i].load(std::memory_order_acquire);
        if (known) return *known;
        auto found = std::make_unique<Found>();
        found->few = occluders.find_before(about(), kFew, found->triangles);
        // Another thread may have been quicker, with the same.
        if (m_of[i].compare_exchange_strong(known, found.get(), std::memory_order_acq_rel))
            known = found.release();
        return *known;
    }

  private:
    static constexpr std::size_t kFew = 64;
    std::vector<std::atomic<const Found*>> m_of;
};

/// The baking of one texture.
class Baking {
  public:
    Baking(const std::vector<BakedTriangle>& mesh, const std::vector<ThrownPicture>& pictures,
           const BakeOptions& options)
        : m_mesh(mesh),
          m_pictures(pictures),
          m_options(options),
          m_rows(static_cast<std::size_t>(options.size.height)) {
        m_stride = options.channels + 1;
        m_begin = std::min(options.begin_row, options.size.height);
        m_end = std::clamp(options.end_row, m_begin, options.size.height);
        m_texture.pixels.assign(static_cast<std::size_t>(options.size.width) *
                                    static_cast<std::size_t>(m_end - m_begin) *
                                    static_cast<std::size_t>(m_stride),
                                0.0F);
        for (const ThrownPicture& picture : pictures)
            m_hiders.push_back(picture.occluders ? std::make_unique<HidersOfTriangles>(mesh.size())
                                                 : nullptr);
        for (std::size_t i = 0; i < mesh.size(); ++i) {
            m_flat.emplace_back(mesh[i], options.size);
            if (!m_flat.back().counts()) continue;
            const auto& c = m_flat.back().corners;
            const auto row = [&](double y) {
                return static_cast<std::size_t>(
                    std::clamp(y, 0.0, static_cast<double>(options.size.height - 1)));
            };
            const double low = std::min({c[0].y, c[1].y, c[2].y}) - options.margin - 1,
                         high = std::max({c[0].y, c[1].y, c[2].y}) + options.margin + 1;
            if (high < 0 || low > options.size.height) continue;
            for (std::size_t j = row(low); j <= row(high); ++j)
                if (is_asked_for(j)) m_rows[j].push_back(i);
        }
    }

    void row(std::int64_t j) {
        RowState state{j, std::vector<char>(static_cast<std::size_t>(m_options.size.width), 0)};
        for (const bool beyond : {false, true})
            for (const std::size_t triangle : m_rows[static_cast<std::size_t>(j)])
                span(triangle, beyond, state);
        m_painted += state.painted;
        m_unseen += state.unseen;
    }

    BakedTexture take() {
        m_texture.painted = m_painted;
        m_texture.unseen = m_unseen;
        return std::move(m_texture);
    }

  private:
    bool is_asked_for(std::size_t row) const {
        const auto first = static_cast<std::size_t>(m_options.first_row);
        return row >= static_cast<std::size_t>(m_begin) && row < static_cast<std::size_t>(m_end) &&
               row >= first && (row - first) % static_cast<std::size_t>(m_options.row_step) == 0;
    }

    /// Neighbouring texels of a row, of one triangle.
    struct Texels {
        static constexpr std::size_t kMost = 16;
        std::size_t count = 0;
        std::array<std::int64_t, kMost> columns = {};
        std::array<glm::dvec3, kMost> points = {};
    };
    /// A row while it is baked.
    struct RowState {
        std::int64_t row;
        std::vector<char> taken;  ///< the columns that a triangle has
        std::int64_t painted = 0, unseen = 0;
        Texels texels = {};
        // Memory that is used again.
        std::vector<double> sums = {};
        std::vector<std::int32_t> before = {};
    };

    /// The texels of a row that a triangle has, or those that it has beyond its border.
    void span(std::size_t triangle, bool beyond, RowState& state) {
        const FlatTriangle& flat = m_flat[triangle];
        const auto& c = flat.corners;
        const double low = std::min({c[0].x, c[1].x, c[2].x}), high = std::max({c[0].x, c[1].x, c[2].x});
        const double width = m_options.size.width;
        const auto begin = static_cast<std::int64_t>(std::clamp(low - m_options.margin - 1, 0.0, width));
        const auto end = static_cast<std::int64_t>(std::clamp(high + m_options.margin + 1, 0.0, width));
        const double rounding = flat.rounding(m_options.margin);
        Texels& texels = state.texels;
        const auto& q = m_mesh[triangle].points;
        for (std::int64_t i = begin; i < end; ++i) {
            char& mine = state.taken[static_cast<std::size_t>(i)];
            if (mine) continue;
            const glm::dvec2 p(static_cast<double>(i) + 0.5, static_cast<double>(state.row) + 0.5);
            if (flat.is_beyond(p, beyond ? m_options.margin : 0, rounding)) continue;
            const glm::dvec3 weights = flat.weights(p);
            const bool inside = std::min({weights.x, weights.y, weights.z}) >= 0;
            if (!inside && !(beyond && flat.distance(p) <= m_options.margin)) continue;
            mine = 1;
            texels.columns[texels.count] = i;
            texels.points[texels.count++] = q[0] * weights.x + q[1] * weights.y + q[2] * weights.z;
            if (texels.count == Texels::kMost) paint(triangle, state);
        }
        if (texels.count > 0) paint(triangle, state);
    }

    /// Paints the texels that have been gathered of a triangle.
    void paint(std::size_t triangle, RowState& state) {
        Texels& texels = state.texels;
        const auto& q = m_mesh[triangle].points;
        const glm::dvec3 normal = glm::cross(q[1] - q[0], q[2] - q[0]);
        const std::size_t channels = static_cast<std::size_t>(m_options.channels);
        std::vector<double>& sums = state.sums;
        sums.assign(texels.count * channels, 0.0);
        std::array<double, Texels::kMost> all = {};
        for (std::size_t p = 0; p < m_pictures.size(); ++p) {
            const ThrownPicture& picture = m_pictures[p];
            const std::vector<std::int32_t>* before = nullptr;
            for (std::size_t k = 0; k < texels.count; ++k) {
                const glm::dvec3& point = texels.points[k];
                Point<double> at{};
                const double share = share_of(picture.projector, point, normal, m_options.fade, at);
                if (!(share > 0)) continue;
                if (picture.occluders && !before) before = &hiders(p, triangle, state);
                if (before && picture.occluders->hides(point, *before)) continue;
                all[k] += share;
                read_pixel(picture.projector.panorama(), picture.pixels, m_options.channels, at,
                           picture.projector.ray(point), share, sums.data() + k * channels);
            }
        }
        for (std::size_t k = 0; k < texels.count; ++k) {
            if (!(all[k] > 0)) {
                ++state.unseen;
                continue;
            }
            ++state.painted;
            float* to = &m_texture.pixels[static_cast<std::size_t>(
                ((state.row - m_begin) * m_options.size.width + texels.columns[k]) * m_stride)];
            for (std::size_t c = 0; c < channels; ++c)
                to[c] = static_cast<float>(sums[k * channels + c] / all[k]);
            to[channels] = 1;
        }
        texels.count = 0;
    }

    /// What may hide the texels that have been gathered of a triangle from a picture's projector.
    const std::vector<std::int32_t>& hiders(std::size_t picture, std::size_t triangle, RowState& state) {
        const Occluders& occluders = *m_pictures[picture].occluders;
        const auto about = [&] {
            return m_flat[triangle].enlarged(m_mesh[triangle].points, m_options.margin);
        };
        const auto& found = m_hiders[picture]->of(triangle, occluders, about);
        if (found.few) return found.triangles;
        occluders.find_before({state.texels.points.data(), state.texels.count}, state.before);
        return state.before;
    }

    const std::vector<BakedTriangle>& m_mesh;
    const std::vector<ThrownPicture>& m_pictures;
    const BakeOptions& m_options;
    std::vector<FlatTriangle> m_flat;
    std::vector<std::unique_ptr<HidersOfTriangles>> m_hiders;  ///< of each picture; null where nothing hides
    std::vector<std::vector<std::size_t>> m_rows;
    std::int64_t m_stride;
    int m_begin = 0, m_end = 0;  ///< of the rows that the texture holds
    BakedTexture m_texture;
    std::atomic<std::int64_t> m_painted{0}, m_unseen{0};
};

void check(const std::vector<ThrownPicture>& pictures, const BakeOptions& options) {
    const auto refuse = [](const char* name, double value, const std::string& range) {
        throw Error(name, shortest(value), "must be " + range);
    };
    for (const int side : {options.size.width, options.size.height})
        if (side < 1 || side > 1 << 15) refuse("size", side, "from 1 to 32768");
    if (options.channels < 1 || options.channels > kMostChannels)
        refuse("channels", options.channels, "from 1 to 64");
    if (!(options.fade >= 0 && options.fade <= kMostFade)) refuse("fade", options.fade, "from 0 to 16777216");
    if (!(options.margin >= 0 && options.margin <= kMostMargin))
        refuse("margin", options.margin, "from 0 to 64");
    if (options.first_row < 0) refuse("first_row", options.first_row, "at least 0");
    if (options.row_step < 1) refuse("row_step", options.row_step, "at least 1");
    if (options.begin_row < 0) refuse("begin_row", options.begin_row, "at least 0");
    if (options.end_row < options.begin_row) refuse("end_row", options.end_row, "at least begin_row");
    for (const ThrownPicture& picture : pictures)
        if (!picture.pixels) throw Error("pictures", "none", "must have pixels");
}

}  // namespace

double share_of(const Projector& projector, const glm::dvec3& point, const glm::dvec3& normal, double fade,
                Point<double>& texel) {
    if (projector.receive(point, texel) != Received::texel) return 0;
    const glm::dvec3 ray = point - projector.pose().position;
    const double distance = glm::length(ray), across = glm::length(normal);
    const double cosine = std::fabs(glm::dot(ray, normal)) / (distance * across);
    if (!(cosine > 0)) return 0;
    const Chart& chart = projector.panorama();
    double within = HUGE_VAL;
    // Full circles have no border to the left and right, faces and poles none at all.
    if (chart.pieces().size() == 1) {
        if (!chart.closed()) within = std::min(texel.x, chart.width() - texel.x);
        if (!chart.reaches_poles()) within = std::min({within, texel.y, chart.height() - texel.y});
    }
    const double faded = fade > 0 ? std::min(1.0, within / fade) : 1;
    return faded * cosine / (distance * distance);
}

BakedTexture bake(const std::vector<BakedTriangle>& mesh, const std::vector<ThrownPicture>& pictures,
                  const BakeOptions& options, const ParallelFor& parallel_for) {
    check(pictures, options);
    Baking baking(mesh, pictures, options);
    parallel_for(options.size.height, [&](std::int64_t j) { baking.row(j); });
    return baking.take();
}

}  // namespace anamorph
