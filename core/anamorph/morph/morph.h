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
#include "anamorph/parallel_for.h"

namespace anamorph {

/// exact: every pixel in double. automatic: near/far, the fastest that holds the tolerance.
enum class MorphScheme { automatic, exact };

/// What a morph shows, and how it is drawn.
struct MorphOptions {
    MorphScheme scheme = MorphScheme::automatic;
    double tol = 0.01;  ///< source pixels; 0: every pixel exactly in double
    Filter filter = Filter::antialias;
    Wrap wrap = Wrap::automatic;  ///< automatic is clamp: a morph has no edges of its own
    Output output = Output::color;
    /// One picture alone, warped, in place of the blend: 0 is the first. An ST-map is of one alone, the first
    /// unless this is given.
    std::optional<int> picture;
    bool lines = false;  ///< draws the features of every shape over the colours

    static constexpr double kMostT = 1e6;
    double t = 0.5;                 ///< of the shape: 0 is A's, 1 is B's; kMostT at most, either way
    std::optional<double> t_color;  ///< of the colours; as t unless given
    /// One weight a key shape, kMostT at most, with sum 1: in place of t and t_color, of which there are but
    /// two.
    std::vector<double> shape_weights, color_weights;

    double weight_a = 1, weight_b = 2, weight_p = 0.5;  ///< a, b and p of eq. 5.11
};

/// Are these weights of the key shapes? Throws Error: `name`, the value as it was written and what it must
/// be.
void check_mixture(const std::string& name, const std::string& text, const std::vector<double>& weights,
                   int shapes);

/// The one of so many pictures whose pixels a morph in colour shows as they are, moved and never blended; none, of others.
std::optional<std::size_t> moved_picture(const MorphOptions& options, int pictures);

/// One morph, ready to draw any box of the picture in any order from any number of threads: the bits of a
/// pixel depend on nothing but the features, the options, the sizes and the pictures.
///
/// At t = 0 the shape is A's and the colours too: the picture is A, bit for bit at tol 0 where the sizes are
/// the same (with filters that keep a picture that is read at its pixels' centres), and B at t = 1. A picture
/// whose colour has weight 0 is not read.
class Morph {
  public:
    /// `pictures`: the size of every shape's picture. Throws Error: a line that has no length at t, named; a
    /// tolerance below 0; parameters out of range; sizes that do not fit.
    Morph(std::shared_ptr<const Features> features, const std::vector<Size>& pictures, int width, int height,
          const MorphOptions& options);
    ~Morph();
    Morph(Morph&&) noexcept;
    Morph& operator=(Morph&&) noexcept;

    int width() const;
    int height() const;
    const MorphOptions& options() const;
    const Picture& picture() const;

    /// Which pictures are read, shape by shape.
    std::vector<bool> reads() const;

    /// Channels of the picture: the first picture's for colours, 2 for ST-maps, else 1.
    int channels(const Source* first) const;

    /// The largest proven bound in use (source pixels) and the fraction of pixels
    /// computed exactly, over the whole picture.
    Reached reached(const ParallelFor& parallel_for = serial_for) const;

    /// Draws the pixels of `box` (of the target image) to `view`, whose pixel (0, 0) is (box.x0, box.y0).
    /// `sources`: one a shape, of the size given above at level 0 and all with as many channels; those that
    /// reads() does not name may be null. False when one could not be read: the picture is then incomplete.
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for = serial_for) const;

  private:
    struct State;
    std::unique_ptr<State> m_state;
};

}  // namespace anamorph
