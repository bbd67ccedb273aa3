// SPDX-License-Identifier: Apache-2.0
// Two fisheyes back to back, each turned by itself and mixed where both see.
#pragma once

#include <array>
#include <memory>

#include "anamorph/operation/pano.h"

namespace anamorph {

namespace rows {

/// The rows front_yaw to back_roll and seam.
ParameterTable fisheye_pair();

}  // namespace rows

/// Two equidistant fisheyes, of a source dual_fisheye or dual_fisheye_tb, each a map of its own.
///
/// Of a direction at an angle a from a lens's axis, m = srcfov / 2 - a is how far within the rim it lies. What one lens alone sees
/// (m >= 0) has its colour. Where both see, with the margins m and n, and f the smaller one of seam and m + n, the front's weight
/// is 1/2 + (m - n) / 2f, between 0 and 1, and the back's is what is left; with seam=0 the larger margin counts alone.
class FisheyePair {
  public:
    /// Takes the lenses' angles and the seam from values. Throws Error where the source has no two fisheyes.
    FisheyePair(const ParameterValues& values, const Chart& source);

    /// The picture of two sources, the front lens's and the back one's. `request`: of the source that holds both. Throws Error.
    Picture picture(const ReprojectRequest& request) const;

    /// The places of the front's and the back's pictures in a source that holds both.
    static std::array<Box, 2> places(const Chart& source);

  private:
    std::array<std::array<double, 3>, 2>
        m_turns;    ///< yaw, pitch and roll of front and back, from straight ahead, in degrees
    double m_seam;  ///< radians
};

/// Is any of the rows of fisheye_pair() given, in the values or in the key frames?
bool asks_for_fisheye_pair(const OperationInput& input);

/// Pictures of two fisheyes, whose sources are the front's and the back's pictures, as pictures of the one source that holds both.
std::unique_ptr<const Pictures> pictures_of_both(std::unique_ptr<const Pictures> of_two, const Chart& source);

}  // namespace anamorph
