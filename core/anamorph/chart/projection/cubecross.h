// SPDX-License-Identifier: Apache-2.0
// Six rectilinear faces of 90 degrees as a cross: up; left, front, right, back; down.

struct Cubecross : CubeFamily {
    static constexpr int columns = 4, rows = 3;

    static double aspect(double) { return 3.0 / 4; }
    static std::vector<Face> faces() {
        using namespace anamorph::faces;
        return {{kUp, 1, 0}, {kLeft, 0, 1}, {kFront, 1, 1}, {kRight, 2, 1}, {kBack, 3, 1}, {kDown, 1, 2}};
    }
};
