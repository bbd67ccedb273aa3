// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/concentric_view.h"

#include <cmath>

#include "anamorph/panorama/concentric_plan.h"

namespace anamorph {
namespace {

/// The source's ray of a target point; none is 0 0 0.
class Sights {
  public:
    explicit Sights(const Panorama& view) : m_view(view), m_pieces(view.target_pieces()) {}

    Ray<double> operator()(double x, double y) const {
        for (std::size_t i = 0; i < m_pieces.size(); ++i) {
            const Box& box = m_pieces[i];
            const int piece = static_cast<int>(i);
            const bool is_in = x > box.x0 && x < box.x1 && y > box.y0 && y < box.y1;
            if (is_in || m_pieces.size() == 1)
                return m_view.target().inside(x, y, piece) >= 0 ? m_view.source_ray(x, y, piece)
                                                                : Ray<double>{};
        }
        return {};
    }

  private:
    Panorama m_view;
    std::vector<Box> m_pieces;
};

/// The weights of one circle, pixel by pixel.
auto weights_of(const Panorama& view, const ConcentricStack& stack, int circle) {
    return [sights = Sights(view), stack, circle](const Box& box, float* weights) {
        bool any = false;
        for (int y = box.y0; y < box.y1; ++y)
            for (int x = box.x0; x < box.x1; ++x, ++weights) {
                *weights = static_cast<float>(stack.weight(circle, stack.offset(sights(x + 0.5, y + 0.5))));
                any |= *weights > 0;
            }
        return any;
    };
}

/// One circle's panorama in a view.
Picture::Map panorama_of(const Panorama& view, const ConcentricStack& stack, int circle, bool mixed,
                         const ReprojectOptions& options) {
    auto plan =
        std::make_shared<ConcentricPlan>(ConcentricMap(view, stack, circle, !mixed), plan_options(options));
    Picture::Layer layer{Border(view.source(), options.wrap), circle};
    if (mixed) layer.weights = weights_of(view, stack, circle);
    return {std::move(plan), {std::move(layer)}};
}

}  // namespace

Picture mosaic_picture(const Panorama& view, const ConcentricStack& stack, const ReprojectOptions& options,
                       std::optional<int> circle) {
    if (is_stmap(options.output) && !circle) circle = stack.circles / 2;
    Picture picture;
    picture.filter = options.filter;
    picture.data = options.data;
    picture.output = options.output;
    picture.overscan = options.overscan;
    picture.adds_alpha = options.adds_alpha;
    if (circle || stack.circles == 1)
        picture.maps = {panorama_of(view, stack, circle.value_or(0), false, options)};
    else
        for (int i = 0; i < stack.circles; ++i)
            picture.maps.push_back(panorama_of(view, stack, i, true, options));
    return picture;
}

std::function<float(double x, double y)> distortion_of(const Panorama& view, const ConcentricStack& stack,
                                                       double nearest) {
    return [sights = Sights(view), stack, nearest](double x, double y) {
        return static_cast<float>(stack.vertical_distortion(sights(x, y), nearest));
    };
}

}  // namespace anamorph
