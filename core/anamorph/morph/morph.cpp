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

/// The picture that comes through untouched, if one does.
std::optional<int> untouched(const FeatureMap& map, const std::vector<double>& shape,
                             const std::vector<double>& color) {
    for (int k = 0; k < map.shapes(); ++k) {
        const auto i = static_cast<std::size_t>(k);
        const Size size = map.picture(k), target = map.target();
        if (only(shape, i) && only(color, i) && size.width == target.width && size.height == target.height)
            return k;
    }
    return {};
}

/// A plan, and its map, which has to outlive it.
struct Planned {
    std::shared_ptr<const FeatureMap> map;
    NearFar blocks;
};

/// The maps of the pictures whose colours have a weight: two at a time share one plan; each of its layers has
/// its shape's picture.
std::vector<Picture::Map> maps_of(const std::shared_ptr<const FeatureMap>& map,
                                  const std::vector<double>& color, const MorphOptions& options) {
    std::vector<int> drawn;
    for (int k = 0; k < map->shapes(); ++k)
        if (color[static_cast<std::size_t>(k)] != 0) drawn.push_back(k);
    NearFarOptions near_far;
    near_far.tol = options.scheme == MorphScheme::exact && options.tol >= 0 ? 0 : options.tol;
    near_far.overscan = options.overscan;
    std::vector<Picture::Map> maps;
    for (auto from = drawn.begin(); from != drawn.end(); from += static_cast<int>(near_far.shapes.size())) {
        near_far.shapes.assign(from, from + std::min<std::ptrdiff_t>(2, drawn.end() - from));
        const std::shared_ptr<const Planned> planned(new Planned{map, NearFar(*map, near_far)});
        std::vector<Picture::Layer> layers;
        for (const int k : near_far.shapes)
            layers.push_back(
                {morph_border(map->picture(k), options.wrap), k, color[static_cast<std::size_t>(k)]});
        maps.push_back({{planned, &planned->blocks}, std::move(layers)});
    }
    return maps;
}

}  // namespace

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

std::vector<double> shape_mixture(const MorphOptions& options, int shapes) {
    return mixture(options.shape_weights, options.t, shapes, "shape_weights", "t");
}

std::vector<double> color_mixture(const MorphOptions& options, int shapes) {
    if (options.picture || is_stmap(options.output)) {
        const int k = options.picture.value_or(0);
        if (k < 0 || k >= shapes)
            throw Error("picture", std::to_string(k),
                        "must be an integer from 0 to " + std::to_string(shapes - 1));
        std::vector<double> one(static_cast<std::size_t>(shapes), 0.0);
        one[static_cast<std::size_t>(k)] = 1;
        return one;
    }
    if (options.color_weights.empty() && !options.t_color) return shape_mixture(options, shapes);
    return mixture(options.color_weights, options.t_color.value_or(options.t), shapes, "color_weights",
                   "t_color");
}

Border morph_border(const Size& size, Wrap wrap) {
    // The angle of the flat chart plays no part for a plain rectangle of pixels.
    return Border(Chart(Projection::rectilinear, size.width, size.height, 90),
                  wrap == Wrap::automatic ? Wrap::clamp : wrap);
}

void check_morph_sizes(const std::vector<Size>& pictures, const Size& target) {
    check_picture_size("size", target);
    for (std::size_t k = 0; k < pictures.size(); ++k)
        check_picture_size("picture " + std::to_string(k + 1), pictures[k]);
}

std::optional<std::size_t> moved_picture(const MorphOptions& options, int pictures) {
    if (options.filter != Filter::nearest || options.lines) return {};
    const std::vector<double> weights = color_mixture(options, pictures);
    for (std::size_t k = 0; k < weights.size(); ++k)
        if (only(weights, k)) return k;
    return {};
}

Picture morphed_picture(const std::shared_ptr<const Features>& features, const std::vector<Size>& pictures,
                        const Size& target, const MorphOptions& options) {
    if (!features) throw Error("a morph needs features");
    check_morph_sizes(pictures, target);
    const std::vector<double> shape = shape_mixture(options, features->shapes());
    const auto map =
        std::make_shared<const FeatureMap>(*features, pictures, target, shape,
                                           LineWeights{options.weight_a, options.weight_b, options.weight_p});
    const std::vector<double> color = color_mixture(options, features->shapes());
    Picture picture;
    picture.maps = maps_of(map, color, options);
    picture.filter = options.filter;
    picture.data = options.data;
    picture.output = options.output;
    picture.adds_alpha = options.adds_alpha;
    picture.overscan = options.overscan;
    if (options.overscan == Size{}) picture.same_as = untouched(*map, shape, color);
    picture.source_count = map->shapes();
    if (options.lines)
        picture.overlay = [features, map](const PixelRows& pixels) {
            draw_features(*features, *map, pixels);
        };
    return picture;
}

}  // namespace anamorph
