// SPDX-License-Identifier: Apache-2.0
// A panorama of a file as a viewer needs it: opened once, read tile by tile and level by level as far as views reach, drawn
// by the operations pano and mosaic within their tolerance.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <glm/vec2.hpp>

#include "anamorph/operation/operation.h"
#include "anamorph/panorama/concentric.h"
#include "anamorph/panorama/panorama.h"
#include "anamorph/source_stack.h"
#include "card_texels.h"

namespace anamorph_viewer {

/// The direction of a view, in degrees, and the width that it covers.
struct View {
    double yaw = 0, pitch = 0, fov = 90;
};

/// The point of the sphere that a pixel shows, in degrees.
struct Direction {
    double yaw, pitch;
};

/// A panorama for a graphics card.
struct CardPicture {
    anamorph::Chart chart;
    anamorph::Orientation held;  ///< orientation of the panorama
    CardTexels texels;
    /// The circles whose panoramas stand one above the other, of which `chart` is that of one.
    std::optional<anamorph::ConcentricStack> stack = {};
};

class ViewedPanorama {
  public:
    /// Opens a panorama. `options`: keys of .pano, or of .mosaic where `circles` is among them; none of yaw,
    /// pitch, fov and size, which are the view's. Throws Error.
    ViewedPanorama(const std::string& file, const std::vector<anamorph::Assignment>& options);

    /// Is it concentric mosaics, whose viewpoint moves?
    bool is_mosaic() const;
    /// Moves the viewpoint, by radii of the outer circle; it stays where it is rather than to leave the
    /// circle.
    void move(double right, double ahead);
    /// The viewpoint, to the right and ahead.
    glm::dvec2 viewpoint() const { return {m_right, m_ahead}; }
    /// Are values linear and without an upper end?
    bool is_hdr() const { return m_hdr; }
    /// The channels of views: 1 or 2 of grey, else the first 3 or 4 are colours.
    int channels() const { return m_channels; }

    /// Draws the pixels of a view, row by row from the top. Throws Error.
    std::vector<float> draw(const View& view, const anamorph::Size& size) const;
    /// The whole panorama, at its finest level that a card takes: 8192 texels a side, and 2^25 in all. Throws
    /// Error: views that are not rectilinear have to be drawn by draw().
    CardPicture card_picture() const;
    /// The direction of the point that (x, y) of a view shows, in pixels from its upper left corner.
    Direction direction(const View& view, const anamorph::Size& size, double x, double y) const;

  private:
    CardPicture card_chart() const;
    anamorph::ParameterValues values(const View& view, const anamorph::Size& size) const;

    const anamorph::Operation* m_operation;
    std::vector<anamorph::Assignment> m_options;
    double m_right = 0, m_ahead = 0;  ///< the viewpoint of mosaics
    bool m_hdr = false;
    int m_channels = 0;
    std::vector<anamorph::SourceImage> m_known;
    anamorph::SourceStacks m_stacks;
};

}  // namespace anamorph_viewer
