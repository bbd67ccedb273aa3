// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/morph.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "anamorph/morph/feature_overlay.h"
#include "anamorph/morph/near_far.h"
#include "anamorph/parameter/parameter.h"

namespace anamorph {
namespace {

/// One weight a key shape: what was given, else those of t.
std::vector<double> mixture(const std::vector<double>& given, double t, int shapes, const char* name,
                            const char* t_name) {
    if (!given.empty()) {
        std::string text;
        for (const double w : given) text += (text.empty() ? "" : ",") + shortest(w);
        check_mixture(name, text, given, shapes);
        return given;
    }
    if (shapes != 2)
        throw Error(t_name, shortest(t),
                    std::string("must be given with two pictures only; for more, ") + name +
                        " takes a number for each");
    if (!(std::fabs(t) <= MorphOptions::kMostT))
        throw Error(t_name, shortest(t),
                    "must be a number from " + shortest(-MorphOptions::kMostT) + " to " +
                        shortest(MorphOptions::kMostT));
    return {1 - t, t};
}

bool only(const std::vector<double>& weights, std::size_t shape) {
    for (std::size_t k = 0; k < weights.size(); ++k)
        if (weights[k] != (k == shape ? 1 : 0)) return false;
    return true;
}

/// The weights of the pictures in what is drawn.
std::vector<double> color_weights(const MorphOptions& options, int shapes) {
    if (options.picture || options.output == Output::stmap) {
        const int k = options.picture.value_or(0);
        if (k < 0 || k >= shapes)
            throw Error("picture", std::to_string(k),
                        "must be an integer from 0 to " + std::to_string(shapes - 1));
        std::vector<double> one(static_cast<std::size_t>(shapes), 0.0);
        one[static_cast<std::size_t>(k)] = 1;
        return one;
    }
    if (options.color_weights.empty() && !options.t_color)
        return mixture(options.shape_weights, options.t, shapes, "shape_weights", "t");
    return mixture(options.color_weights, options.t_color.value_or(options.t), shapes, "color_weights",
                   "t_color");
}

std::vector<Size> sizes_of(const std::vector<Size>& pictures, int width, int height) {
    const auto check = [](const std::string& name, int w, int h) {
        if (!(w > 0 && h > 0 && w <= kMaxSide && h <= kMaxSide))
            throw Error(name, std::to_string(w) + "x" + std::to_string(h),
                        "must be 1 to " + std::to_string(kMaxSide) + " pixels either way");
    };
    check("size", width, height);
    std::vector<Size> sizes;
    for (const Size& s : pictures) {
        check("picture " + std::to_string(sizes.size() + 1), s.width, s.height);
        sizes.push_back({s.width, s.height});
    }
    return sizes;
}

Border border_of(const Size& size, Wrap wrap) {
    // The angle of the flat chart plays no part for a plain rectangle of pixels.
    return Border(Chart(Projection::rectilinear, size.width, size.height, 90),
                  wrap == Wrap::automatic ? Wrap::clamp : wrap);
}

}  // namespace

struct Morph::State {
    std::shared_ptr<const Features> features;
    MorphOptions options;
    FeatureMap map;
    std::vector<double> shape;  ///< weights of the key shapes
    std::vector<double> color;  ///< and of the pictures
    Picture picture;

    State(std::shared_ptr<const Features> given, const std::vector<Size>& pictures, int width, int height,
          const MorphOptions& morph)
        : features(std::move(given)),
          options(morph),
          map(*features, sizes_of(pictures, width, height), {width, height},
              mixture(morph.shape_weights, morph.t, features->shapes(), "shape_weights", "t"),
              {morph.weight_a, morph.weight_b, morph.weight_p}),
          shape(mixture(morph.shape_weights, morph.t, features->shapes(), "shape_weights", "t")),
          color(color_weights(morph, features->shapes())) {
        std::vector<int> drawn;
        for (int k = 0; k < map.shapes(); ++k)
            if (reads(k)) drawn.push_back(k);
        make_maps(drawn);
        picture.filter = options.filter;
        picture.output = options.output;
        picture.same_as = untouched();
        if (options.lines)
            picture.overlay = [this](const PixelRows& pixels) { draw_features(*features, map, pixels); };
    }

    bool reads(int k) const { return color[static_cast<std::size_t>(k)] != 0; }

  private:
    /// The picture that comes through untouched, if one does.
    std::optional<int> untouched() const {
        for (int k = 0; k < map.shapes(); ++k) {
            const auto i = static_cast<std::size_t>(k);
            const Size size = map.picture(k), target = map.target();
            if (only(shape, i) && only(color, i) && size.width == target.width &&
                size.height == target.height)
                return k;
        }
        return {};
    }

    void make_maps(const std::vector<int>& drawn) {
        NearFarOptions near_far;
        near_far.tol = options.scheme == MorphScheme::exact && options.tol >= 0 ? 0 : options.tol;
        // Two at a time share one plan.
        for (auto from = drawn.begin(); from != drawn.end();
             from += static_cast<int>(near_far.shapes.size())) {
            near_far.shapes.assign(from, from + std::min<std::ptrdiff_t>(2, drawn.end() - from));
            add(std::make_shared<NearFar>(map, near_far));
        }
    }

    /// A map, each of its layers with its shape's picture.
    void add(const std::shared_ptr<const FeatureBlocks>& blocks) {
        std::vector<Picture::Layer> layers;
        for (const int k : blocks->shapes())
            layers.push_back(
                {border_of(map.picture(k), options.wrap), k, color[static_cast<std::size_t>(k)]});
        picture.maps.push_back({blocks, std::move(layers)});
    }
};

void check_mixture(const std::string& name, const std::string& text, const std::vector<double>& weights,
                   int shapes) {
    constexpr double kMost = MorphOptions::kMostT;
    const double sum = std::accumulate(weights.begin(), weights.end(), 0.0);
    const bool in_range =
        std::all_of(weights.begin(), weights.end(), [](double w) { return std::fabs(w) <= kMost; });
    if (weights.size() != static_cast<std::size_t>(shapes) || !in_range || !(std::fabs(sum - 1) <= 1e-6))
        throw Error(name, printable(text),
                    "must be " + std::to_string(shapes) + " numbers from " + shortest(-kMost) + " to " +
                        shortest(kMost) + ", one for each picture, with sum 1");
}

std::optional<std::size_t> moved_picture(const MorphOptions& options, int pictures) {
    if (options.filter != Filter::nearest || options.lines) return {};
    const std::vector<double> weights = color_weights(options, pictures);
    for (std::size_t k = 0; k < weights.size(); ++k)
        if (only(weights, k)) return k;
    return {};
}

Morph::Morph(std::shared_ptr<const Features> features, const std::vector<Size>& pictures, int width,
             int height, const MorphOptions& options) {
    if (!features) throw Error("a morph needs features");
    m_state = std::make_unique<State>(std::move(features), pictures, width, height, options);
}
Morph::~Morph() = default;
Morph::Morph(Morph&&) noexcept = default;
Morph& Morph::operator=(Morph&&) noexcept = default;

int Morph::width() const {
    return m_state->map.target().width;
}
int Morph::height() const {
    return m_state->map.target().height;
}
const MorphOptions& Morph::options() const {
    return m_state->options;
}
const Picture& Morph::picture() const {
    return m_state->picture;
}

std::vector<bool> Morph::reads() const {
    std::vector<bool> all;
    for (int k = 0; k < m_state->map.shapes(); ++k)
        all.push_back(m_state->picture.shows_color() && m_state->reads(k));
    return all;
}

int Morph::channels(const Source* first) const {
    return m_state->picture.channels(first);
}

Reached Morph::reached(const ParallelFor& parallel_for) const {
    return m_state->picture.reached(parallel_for);
}

bool Morph::draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
                 const ParallelFor& parallel_for) const {
    const auto shapes = static_cast<std::size_t>(m_state->map.shapes());
    if (sources.size() != shapes)
        throw Error("pictures", std::to_string(sources.size()), "must be " + std::to_string(shapes));
    return m_state->picture.draw(sources, box, view, parallel_for);
}

}  // namespace anamorph
