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
            if (x > box.x0 && x < box.x1 && y > box.y0 && y < box.y1)
                return m_view.target().inside(x, y, piece) >= 0 ? m_view.source_ray(x, y, piece)
                                                                : Ray<double>{};
        }
        return {};
    }

  private:
    Panorama m_view;
    std::vector<Box> m_pieces;
};

/// Of one circle, pixel by pixel.
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

}  // namespace

ConcentricView::ConcentricView(const Panorama& view, const ConcentricStack& stack,
                               const ReprojectOptions& options, std::optional<int> circle)
    : m_stack(stack) {
    if (options.output == Output::stmap && !circle) circle = stack.circles / 2;
    m_picture.filter = options.filter;
    m_picture.output = options.output;
    if (circle || stack.circles == 1)
        add(view, circle.value_or(0), false, options);
    else
        for (int i = 0; i < stack.circles; ++i) add(view, i, true, options);
}

void ConcentricView::add(const Panorama& view, int circle, bool mixed, const ReprojectOptions& options) {
    auto plan =
        std::make_shared<ConcentricPlan>(ConcentricMap(view, m_stack, circle, !mixed), plan_options(options));
    Picture::Layer layer{Border(view.source(), options.wrap), circle};
    if (mixed) layer.weights = weights_of(view, m_stack, circle);
    m_picture.maps.push_back({std::move(plan), {std::move(layer)}});
}

std::function<float(double x, double y)> distortion_of(const Panorama& view, const ConcentricStack& stack,
                                                       double nearest) {
    return [sights = Sights(view), stack, nearest](double x, double y) {
        return static_cast<float>(stack.vertical_distortion(sights(x, y), nearest));
    };
}

}  // namespace anamorph
