// SPDX-License-Identifier: Apache-2.0
// From a pixel of a photograph to its ray, and on to the pixel of a panorama that shows the same.
#include <anamorph/chart.h>

#include <iostream>

using namespace anamorph;

int main() {
    // 60 degrees across, through a lens that bends lines as OpenCV's k1 = -0.1 does.
    const LensModel lens = LensModel::parse("brown:k1=-0.1");
    const Chart photograph(Projection::rectilinear, 1920, 1080, 60, PixelSpacing::edges, "", 1, lens);
    const Chart panorama(Projection::equirectangular, 4096, 2048);

    // x is to the right and y down, from the upper left corner. Rays: x to the right, y down, z ahead.
    const double x = 1500.5, y = 200.5;
    if (!(photograph.inside(x, y) >= 0)) return 1;
    const Ray<double> ray = photograph.ray(x, y);
    const Point<double> texel = panorama.point(ray, panorama.piece_of(ray));
    std::cout << "(" << x << ", " << y << ") is seen along " << ray.x / ray.z << ", " << ray.y / ray.z
              << ", 1, at (" << texel.x << ", " << texel.y << ") of the panorama\n";
}
