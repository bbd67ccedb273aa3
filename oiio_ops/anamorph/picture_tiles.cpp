// SPDX-License-Identifier: Apache-2.0
#include "anamorph/picture_tiles.h"

namespace anamorph {

HashedPicture hashed_picture(const OIIO::ImageSpec& spec) {
    std::vector<HashedPicture::Channel> channels;
    for (int c = 0; c < spec.nchannels; ++c) {
        const OIIO::TypeDesc type = spec.channelformat(c);
        channels.push_back({spec.channel_name(c),
                            type.c_str(),
                            {static_cast<int>(type.basesize()), type.is_floating_point()}});
    }
    return {{spec.x, spec.y, spec.x + spec.width, spec.y + spec.height},
            {spec.full_x, spec.full_y, spec.full_x + spec.full_width, spec.full_y + spec.full_height},
            std::move(channels)};
}

}  // namespace anamorph
