// SPDX-License-Identifier: Apache-2.0
// Pixels of a picture in the plane of its projection, as it was taken: without its lens. Templates over the number.
//
// No include guard and no namespace: vectors need the templates compiled for each instruction set, so whoever reads
// them includes this file inside a namespace of his own (chart/chart_formulas.h, panorama/panorama_rows_lanes.cpp).

/// The point of the plane at a pixel; `per_x` and `per_y`: its units for a pixel.
template <class T, class Scale>
inline Point<T> plane_of_pixel(const T& x, const T& y, const Branch& branch, const Scale& per_x,
                               const Scale& per_y) {
    return {(x - branch.pixel_x) * per_x + branch.centre_x, (y - branch.pixel_y) * per_y + branch.centre_y};
}
/// The pixel at a point of the plane; `scale_x` and `scale_y`: pixels for a unit of the plane.
template <class T, class Scale>
inline Point<T> pixel_of_plane(const Point<T>& p, const Branch& branch, const Scale& scale_x,
                               const Scale& scale_y) {
    return {(p.x - branch.centre_x) * scale_x + branch.pixel_x,
            (p.y - branch.centre_y) * scale_y + branch.pixel_y};
}
