// SPDX-License-Identifier: Apache-2.0
// Two equidistant fisheyes above each other, the front above the back; otherwise as side by side.

struct DualFisheyeTb : DualFisheye {
    static constexpr int columns = 1, rows = 2;

    static double aspect(double) { return 2; }
    static std::vector<Face> faces() {
        return {{anamorph::faces::kFront, 0, 0}, {anamorph::faces::kBack, 0, 1}};
    }
};
