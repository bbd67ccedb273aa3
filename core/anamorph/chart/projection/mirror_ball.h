// SPDX-License-Identifier: Apache-2.0
// Mirror ball: a ball that reflects, photographed from far away. In its middle it shows the camera, which is straight behind for one
// who looks on as the camera does, and all around its rim what is straight ahead. The radius is 2 sin(t / 2), t the angle from
// straight behind; right is right, so that the picture is an equisolid one of what is behind, mirrored.

struct MirrorBall : Equisolid {
    static constexpr std::string_view alias = "mirrorball";
    static constexpr FieldOfView fov{360, 360};
    static constexpr Lensed lensed = Lensed::no;
    static constexpr bool looks_back = true;

    template <class T>
    static Ray<T> ray(const Point<T>& p, const Setting& s) {
        return turned(Equisolid::ray(p, s));
    }
    template <class T>
    static Point<T> point(const Ray<T>& r, const Setting& s) {
        return Equisolid::point(turned(r), s);
    }

  private:
    template <class T>
    static Ray<T> turned(const Ray<T>& r) {
        return {r.x, r.y, -r.z};
    }
};
