// SPDX-License-Identifier: Apache-2.0
#include "anamorph/figure/image/figure_picture.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <vector>

#include "anamorph/figure/image/backdrop.h"
#include "anamorph/figure/image/body_texture.h"
#include "anamorph/figure/image/bump_map.h"
#include "anamorph/figure/image/perturbation.h"
#include "anamorph/figure/image/solid_texture.h"
#include "anamorph/figure/image/visible_surfaces.h"
#include "anamorph/figure/outline/stroke_pixels.h"
#include "anamorph/image/canvas.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/strips.h"

namespace anamorph::figure {
namespace {

using Values = std::array<float, 4>;

std::vector<Ellipsoid> shapes_of(const FigureFrame& frame) {
    std::vector<Ellipsoid> shapes;
    for (const Body& body : frame.bodies) shapes.push_back(body.shape);
    return shapes;
}

std::vector<std::string> names_of(const FigureFrame& frame) {
    std::vector<std::string> names;
    for (const Body& body : frame.bodies) names.push_back(body.name);
    return names;
}

/// Half of a body's longest axis in pixels, as far away as its centre.
double half_longest(const Ellipsoid& shape, const View& view) {
    const double axis = std::max({shape.axes.x, shape.axes.y, shape.axes.z});
    if (!view.perspective()) return view.scale * axis;
    return view.scale * view.eye_distance / std::max(view.to_view(shape.center).z, view.near) * axis;
}

/// The gradient in space, as the observer has it, of heights of `scale` for 1, by their gradient over the unit sphere: that of the
/// inverse of the map to the ellipsoid, transposed.
glm::dmat3 slopes_of(const Ellipsoid& shape, const View& view, double scale) {
    // Axes that are shorter count as that (SeenSurface).
    const double least = 1e-9 * std::max({shape.axes.x, shape.axes.y, shape.axes.z});
    glm::dmat3 slopes = view.rotation * shape.rotation;
    for (int k = 0; k < 3; ++k) slopes[k] *= scale / std::max(shape.axes[k], least);
    return slopes;
}

bool is_lines(FigureStyle style) {
    return style == FigureStyle::outline || style == FigureStyle::stick;
}

bool is_shaded(FigureStyle style) {
    return style == FigureStyle::shaded || style == FigureStyle::textured;
}

/// Lines as `look` has them.
Drawing drawing_of(const FigureFrame& frame, const View& view, const Size& size, const FigureLook& look,
                   const ParallelFor& parallel_for) {
    DrawingOptions lines = look.lines;
    if (look.style == FigureStyle::stick) lines.sticks = frame.joints.empty() ? Sticks::axes : Sticks::joints;
    return draw(frame, view, {size.width, size.height}, lines, parallel_for);
}

/// The sources of a picture as one thread reads them: made when the first pixel needs them.
class Textures {
  public:
    Textures(const std::vector<const Source*>& sources, const FigureLook& look)
        : m_sources(sources), m_look(look), m_open(look.textures.size()) {}

    /// The texture of a number; null where there is none.
    BodyTexture* get(int index) {
        const auto i = static_cast<std::size_t>(index);
        if (index < 0 || i >= m_sources.size() || !m_sources[i]) return nullptr;
        if (!m_open[i])
            m_open[i] =
                std::make_unique<BodyTexture>(*m_sources[i], m_look.mapping, m_look.filter, m_look.average);
        return m_open[i].get();
    }
    /// The backdrop of a picture of this size; null where there is none.
    FigureBackdrop* backdrop(const Size& size) {
        const std::size_t i = m_look.textures.size();
        if (!m_look.backdrop || i >= m_sources.size() || !m_sources[i]) return nullptr;
        if (!m_backdrop) m_backdrop = std::make_unique<FigureBackdrop>(*m_sources[i], size);
        return m_backdrop.get();
    }
    /// The heights on bodies; null where there are none.
    BumpMap* bumps() {
        const std::size_t i = m_look.textures.size() + (m_look.backdrop ? 1 : 0);
        if (!m_look.bumps || i >= m_sources.size() || !m_sources[i]) return nullptr;
        if (!m_bumps) m_bumps = std::make_unique<BumpMap>(*m_sources[i], m_look.mapping);
        return m_bumps.get();
    }

  private:
    const std::vector<const Source*>& m_sources;
    const FigureLook& m_look;
    std::vector<std::unique_ptr<BodyTexture>> m_open;
    std::unique_ptr<FigureBackdrop> m_backdrop;
    std::unique_ptr<BumpMap> m_bumps;
};

}  // namespace

int channels_of(FigureStyle style) {
    switch (style) {
        case FigureStyle::depth:
        case FigureStyle::id:
            return 1;
        case FigureStyle::uv:
            return 2;
        default:
            return 4;
    }
}

struct FigurePicture::Impl {
    FigureFrame frame;
    View view;
    Size size;
    FigureLook look;
    std::vector<glm::dvec3> colors = {};    ///< of the bodies, 0 to 1
    std::vector<int> textures = {};         ///< of the bodies: positions in FigureLook::textures, -1 for none
    std::vector<double> longest = {};       ///< of the bodies: half the longest axis in pixels
    std::vector<SolidTexture> solids = {};  ///< of the bodies, where they are colored by formulas
    /// Of the bodies, where normals are turned: heights' gradients by the unit sphere, as the observer has them.
    std::vector<glm::dmat3> slopes = {};
    std::unique_ptr<const VisibleSurfaces> surfaces = {};
    std::unique_ptr<const StrokePixels> strokes = {};
    double line_error = 0;
    std::vector<int> left_out = {};

    /// Towards the eye, from what is seen at (x, y).
    glm::dvec3 toward_eye(double x, double y) const {
        if (!view.perspective()) return {0, 0, -1};
        const double zoom = view.scale * view.eye_distance;
        return -glm::normalize(
            glm::dvec3((x - view.middle.x) / zoom, (size.height - y - view.middle.y) / zoom, 1));
    }

    /// What is added to the light of a pixel. Pixels count from the display window's corner: overscan changes none.
    double perturbation(int x, int y) const {
        if (look.perturbation == 0) return 0;
        return look.perturbation *
               random_of_pixel(look.seed, frame.number, x - look.overscan.width, y - look.overscan.height);
    }

    /// `side`: of the square of pixels that shows the body.
    glm::dvec3 color(int body, double x, double y, bool far_side, double side, double perturbed,
                     Textures& open) const {
        const auto i = static_cast<std::size_t>(body);
        const SeenSurface& surface = surfaces->surface(body);
        glm::dvec3 outwards = glm::normalize(surface.gradient(x, y, far_side));
        if (BumpMap* bumps = slopes.empty() ? nullptr : open.bumps())
            outwards = bumped(outwards, slopes[i] * bumps->gradient(surface, x, y, far_side));
        glm::dvec3 own = solids.empty() ? colors[i] : solids[i].color(surface, x, y, far_side, side);
        if (BodyTexture* texture = open.get(textures[i]))
            own = texture->color({surface, frame.bodies[i].texture_offset, longest[i]}, x, y, far_side, own);
        // Only highlights are seen from somewhere.
        const bool seen_from = look.light.lighting == Lighting::blinn;
        return lit(own, look.light, far_side ? -outwards : outwards,
                   seen_from ? toward_eye(x, y) : glm::dvec3(0.0), perturbed);
    }

    /// Color and alpha of what lies behind all bodies, in a pixel.
    glm::dvec4 background(int of_x, int of_y, Textures& open) const {
        glm::dvec4 color(0.0);
        const int x = of_x - look.overscan.width, y = of_y - look.overscan.height;
        const Size shown{size.width - 2 * look.overscan.width, size.height - 2 * look.overscan.height};
        const std::vector<BackgroundBand>& bands = look.bands.empty() ? frame.bands : look.bands;
        if (look.background)
            color = glm::dvec4(*look.background, 1);
        else if (!bands.empty())
            color = band_color(bands, y, shown.height);
        FigureBackdrop* picture = open.backdrop(shown);
        return picture ? picture->color(x, y, color) : color;
    }

    bool has_background() const {
        return look.background || look.backdrop || !look.bands.empty() || !frame.bands.empty();
    }

    // Values are stored where they are known: one by one on the stack and then all four at once would be a stall for every pixel.

    /// Stores a color multiplied by alpha, before the background.
    template <class Store>
    void on_background(const glm::dvec3& c, double alpha, int x, int y, Textures& open,
                       const Store& store) const {
        if (!(alpha < 1 && has_background())) {
            store(x, y,
                  Values{static_cast<float>(c.r), static_cast<float>(c.g), static_cast<float>(c.b),
                         static_cast<float>(alpha)});
            return;
        }
        const glm::dvec4 all = glm::dvec4(c, alpha) + (1 - alpha) * background(x, y, open);
        store(x, y,
              Values{static_cast<float>(all.r), static_cast<float>(all.g), static_cast<float>(all.b),
                     static_cast<float>(all.a)});
    }

    template <class Store>
    void value(const VisiblePoint& seen, int x, int y, Textures& open, const Store& store) const {
        const double px = x + 0.5, py = y + 0.5;
        const bool none = seen.body < 0;
        switch (look.style) {
            case FigureStyle::depth:
                return store(
                    x, y,
                    Values{none ? kNoDepth
                                : static_cast<float>(depth_of(seen.hit.nearness, surfaces->perspective()))});
            case FigureStyle::id:
                return store(x, y, Values{static_cast<float>(seen.body + 1)});
            case FigureStyle::uv: {
                if (none) return store(x, y, Values{-1, -1});
                const glm::dvec2 uv = texture_point(
                    look.mapping, surfaces->surface(seen.body).unit_point(px, py, seen.hit.far_side));
                return store(x, y, Values{static_cast<float>(uv.x), static_cast<float>(uv.y)});
            }
            default:
                if (none) return on_background(glm::dvec3(0.0), 0, x, y, open, store);
                on_background(color(seen.body, px, py, seen.hit.far_side, 1, perturbation(x, y), open), 1, x,
                              y, open, store);
        }
    }

    template <class Store>
    void value(std::span<const VisiblePart> parts, int x, int y, Textures& open, const Store& store) const {
        glm::dvec3 sum(0.0);
        double alpha = 0;
        const double perturbed = perturbation(x, y);
        for (const VisiblePart& part : parts) {
            const double share = static_cast<double>(part.samples) / VisibleSurfaces::kSamples;
            sum += share * color(part.body, part.x, part.y, part.far_side, std::sqrt(share), perturbed, open);
            alpha += share;
        }
        on_background(sum, alpha, x, y, open, store);
    }

    /// store(x, y, values) for the pixels of a small box inside the picture.
    template <class Store>
    void draw(const Box& box, const std::vector<const Source*>& sources, const Store& store) const {
        Textures open(sources, look);
        const auto each = [&](const auto& value) {
            std::size_t i = 0;
            for (int y = box.y0; y < box.y1; ++y)
                for (int x = box.x0; x < box.x1; ++x) value(i++, x, y);
        };
        if (is_lines(look.style)) {
            const std::vector<LinePixel> lines = strokes->pixels(box);
            each([&](std::size_t i, int x, int y) {
                const LinePixel& p = lines[i];
                on_background({p.r, p.g, p.b}, static_cast<double>(p.a), x, y, open, store);
            });
        } else if (is_shaded(look.style) && look.antialias) {
            const VisibleParts seen = surfaces->parts(box);
            each([&](std::size_t, int x, int y) { value(seen.of(x, y), x, y, open, store); });
        } else {
            const std::vector<VisiblePoint> seen = surfaces->points(box);
            each([&](std::size_t i, int x, int y) { value(seen[i], x, y, open, store); });
        }
    }
};

FigurePicture::FigurePicture(FigureFrame frame, const View& view, const Size& size, const FigureLook& look,
                             const ParallelFor& parallel_for) {
    if (size.width < 1 || size.height < 1)
        throw Error("size", std::to_string(size.width) + "x" + std::to_string(size.height),
                    "must be at least 1x1 pixels");
    auto impl = std::make_unique<Impl>(Impl{std::move(frame), view, size, look});
    const FigureFrame& own = impl->frame;
    for (const Body& body : own.bodies) {
        impl->colors.push_back(body.color / 255.0);
        impl->longest.push_back(half_longest(body.shape, view));
        const auto found = std::find(look.textures.begin(), look.textures.end(), body.texture);
        const bool textured = look.style == FigureStyle::textured && found != look.textures.end();
        impl->textures.push_back(textured ? static_cast<int>(found - look.textures.begin()) : -1);
        if (look.solid && is_shaded(look.style)) impl->solids.emplace_back(*look.solid, body, own.number);
        if (look.bumps && is_shaded(look.style))
            impl->slopes.push_back(slopes_of(body.shape, view, look.bump_scale));
    }
    if (is_lines(look.style)) {
        Drawing lines = drawing_of(own, view, size, look, parallel_for);
        impl->line_error = lines.max_error;
        impl->left_out = lines.left_out;
        impl->strokes = std::make_unique<const StrokePixels>(std::move(lines));
    } else
        impl->surfaces = std::make_unique<const VisibleSurfaces>(shapes_of(own), view, size.height,
                                                                 names_of(own), parallel_for);
    m_impl = std::move(impl);
}

double FigurePicture::line_error() const {
    return m_impl->line_error;
}

std::vector<std::string> FigurePicture::left_out() const {
    std::vector<std::string> names;
    for (const int i : m_impl->left_out)
        names.push_back(m_impl->frame.bodies[static_cast<std::size_t>(i)].name);
    return names;
}

FigurePicture::~FigurePicture() = default;
FigurePicture::FigurePicture(FigurePicture&&) noexcept = default;

void FigurePicture::draw(const Box& box, const ImageView& pixels, const ParallelFor& parallel_for,
                         const std::vector<const Source*>& textures) const {
    check_room(pixels, box);
    const auto channels =
        static_cast<std::size_t>(std::min(channels_of(m_impl->look.style), pixels.channels));
    const Box picture = {0, 0, m_impl->size.width, m_impl->size.height};
    for_each_square(box, parallel_for, [&](const Box& square) {
        const auto store = [&](int x, int y, const Values& values) {
            std::byte* to = pixels.at(x - box.x0, y - box.y0);
            if (pixels.type == PixelType::float32 && channels == values.size()) {
                std::memcpy(to, values.data(), sizeof values);
                return;
            }
            if (pixels.type == PixelType::float32) {
                for (std::size_t c = 0; c < channels; ++c)
                    std::memcpy(to + c * sizeof(float), &values[c], sizeof(float));
                return;
            }
            for (std::size_t c = 0; c < channels; ++c)
                store_channel(values[c], to + c * static_cast<std::size_t>(size_of(pixels.type)),
                              pixels.type);
        };
        const Box inside = intersection(square, picture);
        if (!(inside == square))
            for (int y = square.y0; y < square.y1; ++y)
                for (int x = square.x0; x < square.x1; ++x) store(x, y, {});
        // Some rows at a time: what is known of their pixels stays near.
        constexpr int kRows = 16;
        for (Box rows = inside; !inside.empty() && rows.y0 < inside.y1; rows.y0 += kRows) {
            rows.y1 = std::min(rows.y0 + kRows, inside.y1);
            m_impl->draw(rows, textures, store);
        }
    });
}

}  // namespace anamorph::figure
