// SPDX-License-Identifier: Apache-2.0
// Tours of any bytes: what is read leads to panoramas that are there, and any direction may be asked for.
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "anamorph/projector/tour_file.h"
#include "expect_error.h"

using namespace anamorph;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    fuzz::expect_no_failure_but_error([&] {
        const Tour tour = parse_tour_json(text, "fuzz.json");
        fuzz::require(!tour.empty(), "a tour begins somewhere");
        for (const TourPanorama& panorama : tour)
            for (const HotSpot& spot : panorama.spots) {
                fuzz::require(spot.target < tour.size(), "a spot leads to a panorama");
                fuzz::require(panorama.spot_at(spot.yaw, spot.pitch) >= 0, "a spot holds its own centre");
            }
    });
    return 0;
}
