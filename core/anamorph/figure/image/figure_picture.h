// SPDX-License-Identifier: Apache-2.0
// A frame of a figure as pixels.
//
// Every pixel's rays meet the ellipsoids themselves: nothing is tessellated. Colours are the mean of 16 x 16
// samples of a pixel: one that shows one body alone has its colour in the middle of it, any other what the
// bodies have in the middle of their samples, each by its share. Depth, id and uv are what the ray through
// the middle of a pixel meets. Pixels are the same for any box that they are drawn in.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/figure/body/body_mapping.h"
#include "anamorph/figure/body/frame.h"
#include "anamorph/figure/image/shading.h"
#include "anamorph/figure/image/solid_look.h"
#include "anamorph/figure/outline/drawing.h"
#include "anamorph/figure/outline/outline_view.h"
#include "anamorph/geometry/box.h"
#include "anamorph/geometry/size.h"
#include "anamorph/image/filter.h"
#include "anamorph/image/source.h"
#include "anamorph/image/view.h"
#include "anamorph/parallel_for.h"

namespace anamorph::figure {

/// The styles in which a figure is drawn.
enum class FigureStyle {
    shaded,   ///< bodies in their colours, lit
    outline,  ///< outlines, hidden lines removed
    stick,    ///< lines from joint to joint, or where there are no joints the longest axes
    depth,    ///< the depth (z of View::to_view), in units of the scene; kNoDepth where there is no body
    id,       ///< 1 for the frame's first body, 2 for the second ...; 0 where there is no body
    uv,       ///< the point of the body's texture; (-1, -1) where there is no body
    textured  ///< shaded, with textures
};

/// The depth of a pixel that shows no body.
inline constexpr float kNoDepth = 1e30f;

/// How a figure is drawn.
struct FigureLook {
    FigureStyle style = FigureStyle::shaded;
    Light light;
    double perturbation = 0;  ///< the most that a pixel's light is off at random (perturbation.h)
    int seed = 0;             ///< of these random numbers
    bool antialias = true;    ///< false: colours of the rays through the middle alone
    std::optional<glm::dvec3> background;  ///< red, green, blue, 0 to 1; where it is not given, `bands`
    std::vector<BackgroundBand> bands;     ///< the background; by default the frame's, or transparent
    bool backdrop = false;                 ///< a picture as large as the drawn one covers the background; its
                                           ///< source comes after those of the textures
    Size overscan = {};                    ///< pixels on either side that background and backdrop do not
                                           ///< count: they go on there as at the picture's edges
    BodyMapping mapping = BodyMapping::latlong;
    Filter filter = Filter::antialias;                   ///< how textures are sampled
    TextureAverage average = TextureAverage::footprint;  ///< how Filter::antialias averages textures
    std::vector<std::string> textures;                   ///< the names of the textures that are given
    std::optional<SolidLook> solid;                      ///< colors by formulas, below textures
    bool bumps =
        false;  ///< a picture of heights turns normals (bump_map.h); its source comes after the backdrop's
    double bump_scale = 10;  ///< how high brightness 1 is, in units of the scene
    DrawingOptions lines;    ///< how the styles outline and stick are drawn
};

/// The number of channels of a picture: four for red, green, blue and alpha (colour multiplied by alpha), two for
/// u and v, else one.
int channels_of(FigureStyle style);

/// A frame ready to be drawn, any part of it at a time. Thread safe.
class FigurePicture {
  public:
    /// `view`: the origin of its screen is the picture's lower left corner. Throws Error as outlines() does.
    FigurePicture(FigureFrame frame, const View& view, const Size& size, const FigureLook& look,
                  const ParallelFor& parallel_for = serial_for);
    ~FigurePicture();
    FigurePicture(FigurePicture&&) noexcept;

    /// Fills `pixels`, which has channels_of(style) channels, with the pixels of `box`; pixels beyond the picture are 0.
    /// `textures`: in the order of their names, then the backdrop and the heights, null where one is missing. Bodies whose texture is not there,
    /// or cannot be read, have their own colour. A texture's fourth channel (the second of two) is alpha.
    void draw(const Box& box, const ImageView& pixels, const ParallelFor& parallel_for = serial_for,
              const std::vector<const Source*>& textures = {}) const;

    /// How far the lines of the style outline are from bodies' outlines, at most; pixels (Drawing::max_error).
    double line_error() const;
    /// The names of bodies that the lines do not show (Drawing::left_out).
    std::vector<std::string> left_out() const;

  private:
    struct Impl;
    std::unique_ptr<const Impl> m_impl;
};

}  // namespace anamorph::figure
