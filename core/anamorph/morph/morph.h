// SPDX-License-Identifier: Apache-2.0
// Feature morphs: two or more pictures, each drawn through its map of feature lines to a proven tolerance,
// and blended; any part at a time (Kim 2003, 5.6).
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/geometry/size.h"
#include "anamorph/image/picture.h"
#include "anamorph/morph/feature_lines.h"

namespace anamorph {

/// How a morph is approximated. exact: every pixel in double. automatic: near/far, the fastest that holds the
/// tolerance.
enum class MorphScheme { automatic, exact };

/// How a morph is drawn, and what is shown of it.
struct MorphOptions {
    MorphScheme scheme = MorphScheme::automatic;
    double tol = 0.01;  ///< source pixels; 0: every pixel exactly in double
    Filter filter = Filter::antialias;
    DataChannels data = {};       ///< channels that are not blended (Picture::data)
    Wrap wrap = Wrap::automatic;  ///< automatic is clamp: a morph has no edges of its own
    Output output = Output::color;
    /// One picture alone, warped, in place of the blend: 0 is the first. An ST-map is of one alone, the first
    /// unless this is given.
    std::optional<int> picture = {};
    bool lines = false;  ///< draws the features of every shape over the colours
    /// Has colour a channel more, of how much of a pixel the pictures cover (Picture::adds_alpha)?
    bool adds_alpha = false;
    Size overscan = {};  ///< pixels beyond the edges of the picture, across and down, on either side

    static constexpr double kMostT = 1e6;
    double t = 0.5;                      ///< the shape's time: 0 is A's, 1 is B's; kMostT at most, either way
    std::optional<double> t_color = {};  ///< the colours' time; t unless it is given
    /// One weight a key shape, kMostT at most, with sum 1: in place of t and t_color, of which there are but
    /// two.
    std::vector<double> shape_weights = {}, color_weights = {};

    double weight_a = 1, weight_b = 2, weight_p = 0.5;  ///< a, b and p of eq. 5.11
};

/// Are these weights of the key shapes? Throws Error: `name`, the value as it was written and what it must
/// be.
void check_mixture(const std::string& name, const std::string& text, const std::vector<double>& weights,
                   int shapes);

/// The weights of so many key shapes in the shape of a morph: those that are given, or of t. Throws Error on weights and times that are
/// out of range or not as many.
std::vector<double> shape_mixture(const MorphOptions& options, int shapes);
/// The weights of so many pictures in what is drawn: as of the shapes, or of the one picture that is shown. Throws Error likewise.
std::vector<double> color_mixture(const MorphOptions& options, int shapes);
/// The border of one of a morph's pictures.
Border morph_border(const Size& picture, Wrap wrap);
/// Throws Error unless the sizes of a morph and of its pictures are in range.
void check_morph_sizes(const std::vector<Size>& pictures, const Size& target);

/// The picture, of so many, whose pixels a morph in colour shows as they are, moved and never blended; none
/// for other morphs.
std::optional<std::size_t> moved_picture(const MorphOptions& options, int pictures);

/// Pictures morphed, of which `pictures` are the sizes at level 0, one a shape. All that are read have as many channels; the bits of a
/// pixel depend on nothing but the features, the options, the sizes and the pictures.
///
/// At t = 0 the shape is A's and the colours too: the picture is A, bit for bit at tol 0 where the sizes are
/// the same (with filters that keep a picture that is read at its pixels' centres), and B at t = 1. A picture
/// whose colour has weight 0 is not read (Picture::reads), and may be null; draw() is given one source a shape.
///
/// Throws Error: a line that has no length at t, named; a tolerance below 0; parameters out of range; sizes that do not fit.
Picture morphed_picture(const std::shared_ptr<const Features>& features, const std::vector<Size>& pictures,
                        const Size& target, const MorphOptions& options);

}  // namespace anamorph
