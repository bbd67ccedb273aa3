// SPDX-License-Identifier: Apache-2.0
// Six rectilinear faces of 90 degrees in a vertical strip, in OpenEXR's order and orientation.

struct Cubemap : CubeFamily {
    static constexpr int columns = 1, rows = 6;

    static double aspect(double) { return 6; }
    /// OpenEXR hinges the upper and lower face to the back (its x axis points to our left, its y axis up).
    static std::vector<Face> faces() {
        const glm::dmat3 up(-1, 0, 0, 0, 0, -1, 0, -1, 0), down(-1, 0, 0, 0, 0, 1, 0, 1, 0);
        using namespace anamorph::faces;
        return {{kLeft, 0, 0}, {kRight, 0, 1}, {up, 0, 2}, {down, 0, 3}, {kFront, 0, 4}, {kBack, 0, 5}};
    }
};
