// SPDX-License-Identifier: Apache-2.0
// Drapes drawn by the machine of 1987 (machine/block_machine.h): scheme hardware.
#pragma once

#include <memory>
#include <optional>

#include "anamorph/geometry/box.h"
#include "anamorph/image/picture.h"
#include "anamorph/machine/block_machine.h"
#include "anamorph/operation/operation.h"
#include "anamorph/surface/camera.h"
#include "anamorph/surface/drape.h"
#include "anamorph/surface/surface.h"

namespace anamorph {

/// What a picture by the machine is made of.
struct BlockDrape {
    machine::BlockMachine machine;
    surface::SurfaceSum sum;  ///< what `surface` is made of, by which the processors' work is counted
    std::shared_ptr<const surface::DrapedSurface> surface;
    surface::Camera camera;
    Size source;  ///< pixels of the picture that is draped
    /// Of these the filter, the border, the output, the light and the channel of alpha count.
    surface::DrapeOptions options;
    Size shown;              ///< pixels of the screen, without overscan
    DataChannels data = {};  ///< channels that hold no colour
};

/// The machine that the values of a drape ask for by scheme=hardware, which draws the bare picture; none with other schemes, with
/// which what is said of a machine is checked too. Throws Error naming what the machine cannot do.
std::optional<machine::BlockMachine> drape_machine(const ParameterValues& values,
                                                   const surface::DrapeOptions& options);

/// The picture of the first source by the machine. The largest error that it says is measured, in pixels of the screen. Throws Error
/// where there are more than four million blocks.
std::unique_ptr<const SolvedPicture> solved_by_blocks(const BlockDrape& drape);

}  // namespace anamorph
