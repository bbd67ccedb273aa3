// SPDX-License-Identifier: Apache-2.0
// Equi-angular cube map: as a cube map, but on a face X is the angle atan(x / z) over 45 degrees. Left, front, right;
// and below, each turned by 90 degrees: down, back, up. This is the layout that ffmpeg's v360 calls eac.

struct Eac : CubeFamily {
    static constexpr int columns = 3, rows = 2;
    static constexpr bool has_oblong_faces = true;
    static constexpr double per_radian = 4 / std::numbers::pi;

    static double aspect(double) { return 2.0 / 3; }
    static std::vector<Face> faces() {
        using namespace anamorph::faces;
        // Turned so that the lower row shows what goes on from below over behind to above.
        const glm::dmat3 down(0, 0, -1, -1, 0, 0, 0, 1, 0), back(0, -1, 0, -1, 0, 0, 0, 0, -1),
            up(0, 0, 1, -1, 0, 0, 0, -1, 0);
        return {{kLeft, 0, 0}, {kFront, 1, 0}, {kRight, 2, 0}, {down, 0, 1}, {back, 1, 1}, {up, 2, 1}};
    }

    /// The local ray (tan u, tan v, 1) cos u cos v.
    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting&) {
        const auto eighth = kEighth.as<T>();
        T su, cu, sv, cv;
        sin_cos(T(p.x * eighth), su, cu);
        sin_cos(T(p.y * eighth), sv, cv);
        return {su * cv, cu * sv, cu * cv};
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting&) {
        const auto per_eighth = kPerEighth.as<T>();
        return {atan2(r.x, r.z) * per_eighth, atan2(r.y, r.z) * per_eighth};
    }

  private:
    static inline const Constant kEighth{DoubleDouble::pi() / 4}, kPerEighth{4 / DoubleDouble::pi()};
};
