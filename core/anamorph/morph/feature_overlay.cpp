// SPDX-License-Identifier: Apache-2.0
#include "anamorph/morph/feature_overlay.h"

#include "anamorph/image/line_overlay.h"

namespace anamorph {

void draw_features(const Features& features, const FeatureMap& map, const PixelRows& pixels) {
    const Size target = map.target();
    for (std::size_t i = 0; i < features.size(); ++i)
        for (int k = 0; k < features.shapes(); ++k) {
            const Features::Frame frame = features.frame(k);
            const double sx = target.width / (frame.width > 0 ? frame.width : map.picture(k).width);
            const double sy = target.height / (frame.height > 0 ? frame.height : map.picture(k).height);
            const Line& l = features.line(i, k);
            draw_line_over({{l.p.x * sx, l.p.y * sy}, {l.q.x * sx, l.q.y * sy}}, overlay_color(k), pixels);
        }
}

}  // namespace anamorph
