// SPDX-License-Identifier: Apache-2.0
// What lies behind a surface: a colour, and over it a picture that fills the screen (Porter and Duff 1984: over).
#pragma once

#include <optional>
#include <vector>

#include "anamorph/geometry/box.h"
#include "anamorph/image/filter.h"
#include "anamorph/image/point_sampler.h"

namespace anamorph::surface {

/// The channel of a picture that is alpha, -1 where none is; and whether colours have been multiplied with
/// it.
struct AlphaChannel {
    int channel = -1;
    bool multiplied = true;

    bool exists() const { return channel >= 0; }
    bool straight() const { return exists() && !multiplied; }
};

/// Lays `over` on `under`, both multiplied with their alpha: over + (1 - alpha) under. What has no alpha is
/// opaque, where `share` of the pixel is covered.
void lay_over(const float* over, const float* under, int channels, int alpha, float share, float* to);

/// Gives the color of each pixel of a screen, multiplied with its alpha. One per thread. Keeps references to
/// its arguments.
class Backdrop {
  public:
    /// `color` is in the channels of the picture that lies in front, `front`, as that says of its alpha; channels that it
    /// lacks are 0, alpha 1. `picture` may be null; its colours are the channels besides `alpha`, as many as those of
    /// the picture in front. It covers a part of the screen, and goes on beyond it as at its edges.
    Backdrop(const std::vector<float>& color, const Source* picture, int alpha, const Box& covered,
             Filter filter, int channels, const AlphaChannel& front);
    Backdrop(const Backdrop&) = delete;
    Backdrop& operator=(const Backdrop&) = delete;

    /// Writes the `channels` floats of a pixel. False where the picture could not be read.
    bool at(int x, int y, float* pixel);

  private:
    bool sample(int x, int y);

    const Source* m_picture;
    int m_alpha, m_channels;
    AlphaChannel m_front;
    Filter m_filter;
    Box m_covered;
    Jacobian m_step;
    std::vector<float> m_color, m_texel, m_over;
    std::optional<FootprintChooser> m_chooser;
    std::optional<Border> m_border;
    std::optional<PointSampler> m_sampler;
};

}  // namespace anamorph::surface
