// SPDX-License-Identifier: Apache-2.0
// Octahedral: the sphere's rays on an octahedron |x| + |y| + |z| = 1, unfolded into a square: the front half is the
// diamond in the middle, the back half is folded out at the four corners. The pieces are the quarters of the square.

struct Octahedral : AnyProjection {
    static constexpr FieldOfView fov{360, 360, false, true};
    static constexpr int columns = 2, rows = 2;

    static constexpr double face_centre = 0.5;

    static DoubleDouble width(DoubleDouble, const Setting&) { return 1; }
    static std::vector<Face> faces() {
        const glm::dmat3 axes(1);
        return {{axes, 0, 0, {-1, -1, 0}},
                {axes, 1, 0, {1, -1, 0}},
                {axes, 0, 1, {-1, 1, 0}},
                {axes, 1, 1, {1, 1, 0}}};
    }

    template <class T>
    static T sees(const Ray<T>& r, const Setting& s) {
        return min(T(r.x * (s.centre_x < 0 ? -1.0 : 1.0)), T(r.y * (s.centre_y < 0 ? -1.0 : 1.0)));
    }
    /// The formulas have creases at the diamond's edges.
    template <class T>
    static T plane_crease(const Point<T>& p) {
        return 1.0 - (max(p.x, T(-p.x)) + max(p.y, T(-p.y)));
    }
    template <class T>
    static T ray_crease(const Ray<T>& r) {
        return r.z;
    }

    /// A point outside the diamond is reflected at its edge.
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting&) {
        const T z = plane_crease(p), beyond = min(z, T(0));
        return {p.x + select(is_negative(p.x), T(-beyond), beyond),
                p.y + select(is_negative(p.y), T(-beyond), beyond), z};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        const double x_side = s.centre_x < 0 ? -1 : 1, y_side = s.centre_y < 0 ? -1 : 1;
        const T x = r.x * x_side, y = r.y * y_side;
        const T n = x + y + max(r.z, T(-r.z)), beyond = min(r.z, T(0));
        return {(x - beyond) / n * x_side, (y - beyond) / n * y_side};
    }
};
