// SPDX-License-Identifier: Apache-2.0
// Two equidistant fisheyes side by side, as cameras with two lenses write them: the back on the left, the front on the
// right (ffmpeg's v360 calls it dfisheye). The field of view is that of one of them.

struct DualFisheye : Fisheye {
    static constexpr int columns = 2, rows = 1;
    static constexpr Lensed lensed = Lensed::no;

    static double aspect(double) { return 0.5; }
    static std::vector<Face> faces() {
        return {{anamorph::faces::kBack, 0, 0}, {anamorph::faces::kFront, 1, 0}};
    }

    /// Each lens sees a circle, and no further than right behind.
    template <class T>
    static T inside(const Point<T>& p, const Setting& s) {
        const double radius = std::min(s.half_width, std::numbers::pi);
        return 1 * kSlack - (square(p.x) + square(p.y)) * (1 / (radius * radius));
    }
    static bool faces_see_all(const Setting& s) { return s.half_width >= std::numbers::pi / 2; }
    /// Each picture shows its half of the sphere, or what its lens sees of it: z / rho is at least that of an angle of
    /// half_width.
    template <class T>
    static T sees(const Ray<T>& r, const Setting& s) {
        if (faces_see_all(s)) return r.z;
        return r.z * (std::sin(s.half_width) * kSlack) - length(r.x, r.y) * std::cos(s.half_width);
    }
};
