// SPDX-License-Identifier: Apache-2.0
// What a panorama can be reprojected with instead: the loop that one writes in an afternoon, an exact loop
// with all the tricks of vector units and caches, OpenCV, and the memory traffic alone, below which nobody
// gets. All draw three channels, bilinear.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/panorama/panorama.h"
#include "anamorph/parallel_for.h"
#include "pixels.h"

namespace anamorph::bench {

/// The numbers of a view of a 360 degree panorama, as a plain program keeps them.
struct PlainView {
    PlainView(const Panorama& map, const Orientation& orientation);

    /// The row of its face that row j is, from 0.
    int row_of_face(int j) const { return j % (height / faces); }
    /// The rotation of a row, row by row: the source's ray of a pixel is that times the target's ray.
    const double* rotation_of(int j) const { return rotation[j / (height / faces)]; }

    /// The latitude of a height in the plane of an equirectangular or Mercator picture.
    double latitude(double y) const { return target == Projection::mercator ? std::atan(std::sinh(y)) : y; }

    bool cylinder;
    Projection
        target;  ///< rectilinear or a cubemap of such faces, fisheye, stereographic, equirectangular, mercator
    int source_width, source_height, width, height, faces;
    double scale_x, scale_y;  ///< source pixels per radian; per unit of height where the source is a cylinder
    double step, first_x, first_y;  ///< distance of target pixels in their plane, and the first pixel's place
    double rotation[6][9];
};

// (1) Every pixel with double trigonometry, row after row.
Point<double> double_point(const PlainView& view, int i, int j);
template <class Texel>
void draw_double(const PlainView& view, const Texel* source, Texel* picture, const ParallelFor& parallel_for);

// (2) Every pixel with float polynomials for the trigonometry, a vector of pixels at once, in tiles of 64 x
// 32; both taps and all channels of a texel row by one load; streaming stores. The source has a border to
// read without tests.
struct PaddedSource {
    PaddedSource(const PlainView& view, const float* source, const ParallelFor& parallel_for);

    static constexpr int kColumns = 32, kRows = 2;  ///< size of the border at each side
    Buffer texels;
    std::ptrdiff_t row_floats;
    const float* origin;  ///< address of texel (0, 0)
};
constexpr int kSimdTileHeight = 32;
void draw_simd_exact(const PlainView& view, const PaddedSource& source, float* picture,
                     const ParallelFor& parallel_for);
/// The source points that draw_simd_exact() uses, pixel centres at + 0.5, row by row.
std::vector<Point<float>> simd_exact_points(const PlainView& view);
std::string simd_target();

// (3) OpenCV: the map computed with double_point, then its remap; or its remap with the map given, in float or fixed.
bool have_opencv();
template <class Texel>
class OpenCv {
  public:
    OpenCv(const PlainView& view, const Texel* source, Texel* picture, int threads,
           const ParallelFor& parallel_for);

    void compute_map();
    void remap();
    /// Puts the last map that was computed into fixed point, as cv::convertMaps does, for remap_fixed().
    void fix_map();
    void remap_fixed();

  private:
    template <class Map>
    void remap_by(const Map& first, const Map& second);

    PlainView m_view;
    const Texel* m_source;
    Texel* m_picture;
    int m_threads;
    ParallelFor m_parallel_for;
    std::vector<float> m_x, m_y;
    std::vector<std::int16_t> m_whole;
    std::vector<std::uint16_t> m_fraction;
};
/// The source point that OpenCV uses: its map is rounded to 1/32 pixel (INTER_BITS = 5).
Point<double> opencv_point(const PlainView& view, int i, int j);

// (4) Reads every cache line of the source that holds a tap, once and in order, and writes the picture with
// streaming stores.
class Traffic {
  public:
    Traffic(const PlainView& view, const std::byte* source, int texel_bytes, const ParallelFor& parallel_for);

    std::size_t bytes_read() const;
    void copy(std::byte* picture, const ParallelFor& parallel_for) const;

  private:
    struct Run {
        const std::byte* begin;
        std::size_t bytes;
    };
    std::vector<Run> m_runs;
    std::size_t m_picture_bytes;
};

/// Sums all bytes of [source, source + read) and fills [target, target + written), streaming; both 64-byte
/// aligned, sizes multiples of 64. The sum is what is written.
void stream(const std::byte* source, std::size_t read, std::byte* target, std::size_t written);

}  // namespace anamorph::bench
