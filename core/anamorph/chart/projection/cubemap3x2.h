// SPDX-License-Identifier: Apache-2.0
// Six rectilinear faces of 90 degrees: right, left, up; down, front, back. Each is upright as seen from inside.

struct Cubemap3x2 : CubeFamily {
    static constexpr int columns = 3, rows = 2;

    static double aspect(double) { return 2.0 / 3; }
    static std::vector<Face> faces() {
        using namespace anamorph::faces;
        return {{kRight, 0, 0}, {kLeft, 1, 0}, {kUp, 2, 0}, {kDown, 0, 1}, {kFront, 1, 1}, {kBack, 2, 1}};
    }
};
