// SPDX-License-Identifier: Apache-2.0
#include "pano_rivals.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <type_traits>

#ifdef ANAMORPH_HAVE_OPENCV
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#endif

namespace anamorph::bench {
namespace {

constexpr int kStrip = 16;

void for_strips(int rows, const ParallelFor& parallel_for, const std::function<void(int, int)>& body) {
    parallel_for((rows + kStrip - 1) / kStrip, [&](std::int64_t strip) {
        const int first = static_cast<int>(strip) * kStrip;
        body(first, std::min(first + kStrip, rows));
    });
}

}  // namespace

PlainView::PlainView(const Panorama& map, const Orientation& orientation)
    : cylinder(map.source().projection() == Projection::cylindrical),
      target(map.target().projection()),
      source_width(map.source().width()),
      source_height(map.source().height()),
      width(map.target().width()),
      height(map.target().height()),
      faces(target == Projection::cubemap ? 6 : 1),
      scale_x(map.source().scale_x()),
      scale_y(map.source().scale_y()),
      step(1 / map.target().scale_x()),
      first_x((0.5 - 0.5 * width) * step),
      first_y((0.5 - 0.5 * height / faces) * step) {
    const glm::dmat3 m = anamorph::rotation(orientation);
    for (int face = 0; face < faces; ++face) {
        const glm::dmat3 turned = m * map.target().pieces()[static_cast<std::size_t>(face)].axes;
        for (int row = 0; row < 3; ++row)
            for (int column = 0; column < 3; ++column) rotation[face][3 * row + column] = turned[column][row];
    }
}

Point<double> double_point(const PlainView& view, int i, int j) {
    const double* r = view.rotation_of(j);
    double x = view.first_x + i * view.step, y = view.first_y + view.row_of_face(j) * view.step, z = 1;
    if (view.target == Projection::fisheye) {
        const double angle = std::hypot(x, y), k = angle > 0 ? std::sin(angle) / angle : 1;
        x *= k, y *= k, z = std::cos(angle);
    } else if (view.target == Projection::stereographic) {
        z = 1 - (x * x + y * y) / 4;
    } else if (view.target == Projection::equirectangular || view.target == Projection::mercator) {
        const double longitude = x, latitude = view.latitude(y);
        x = std::sin(longitude) * std::cos(latitude);
        y = std::sin(latitude);
        z = std::cos(longitude) * std::cos(latitude);
    }
    const double rx = r[0] * x + r[1] * y + r[2] * z;
    const double ry = r[3] * x + r[4] * y + r[5] * z;
    const double rz = r[6] * x + r[7] * y + r[8] * z;
    const double rho = std::sqrt(rx * rx + rz * rz);
    const double down = view.cylinder ? ry / rho : std::atan2(ry, rho);
    return {std::atan2(rx, rz) * view.scale_x + 0.5 * view.source_width,
            down * view.scale_y + 0.5 * view.source_height};
}

template <class Texel>
void draw_double(const PlainView& view, const Texel* source, Texel* picture,
                 const ParallelFor& parallel_for) {
    const int w = view.source_width, h = view.source_height;
    for_strips(view.height, parallel_for, [&](int first, int last) {
        for (int j = first; j < last; ++j)
            for (int i = 0; i < view.width; ++i) {
                const Point<double> p = double_point(view, i, j);
                const double x = p.x - 0.5, y = p.y - 0.5;
                const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
                const float fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
                const int x0 = ix < 0 ? ix + w : ix, x1 = x0 + 1 < w ? x0 + 1 : 0;
                const int y0 = std::clamp(iy, 0, h - 1), y1 = std::clamp(iy + 1, 0, h - 1);
                const std::size_t above = static_cast<std::size_t>(y0) * static_cast<std::size_t>(w);
                const std::size_t below = static_cast<std::size_t>(y1) * static_cast<std::size_t>(w);
                const Texel* a = source + 3 * (above + static_cast<std::size_t>(x0));
                const Texel* b = source + 3 * (above + static_cast<std::size_t>(x1));
                const Texel* c = source + 3 * (below + static_cast<std::size_t>(x0));
                const Texel* d = source + 3 * (below + static_cast<std::size_t>(x1));
                Texel* out =
                    picture + 3 * (static_cast<std::size_t>(j) * static_cast<std::size_t>(view.width) +
                                   static_cast<std::size_t>(i));
                for (int k = 0; k < 3; ++k) {
                    const float value =
                        (1 - fy) * ((1 - fx) * static_cast<float>(a[k]) + fx * static_cast<float>(b[k])) +
                        fy * ((1 - fx) * static_cast<float>(c[k]) + fx * static_cast<float>(d[k]));
                    out[k] = std::is_integral_v<Texel> ? static_cast<Texel>(value + 0.5f)
                                                       : static_cast<Texel>(value);
                }
            }
    });
}
template void draw_double(const PlainView&, const float*, float*, const ParallelFor&);
template void draw_double(const PlainView&, const std::uint8_t*, std::uint8_t*, const ParallelFor&);
template void draw_double(const PlainView&, const std::uint16_t*, std::uint16_t*, const ParallelFor&);

PaddedSource::PaddedSource(const PlainView& view, const float* source, const ParallelFor& parallel_for)
    : texels(static_cast<std::size_t>(view.source_width + 2 * kColumns) *
             static_cast<std::size_t>(view.source_height + 2 * kRows) * 12),
      row_floats(3 * (view.source_width + 2 * kColumns)),
      origin(texels.as<float>() + kRows * row_floats + 3 * kColumns) {
    const int w = view.source_width, h = view.source_height;
    float* first = texels.as<float>() + 3 * kColumns;
    for_strips(h + 2 * kRows, parallel_for, [&](int begin, int end) {
        for (int y = begin; y < end; ++y) {
            const float* from = source + std::ptrdiff_t{3} * w * std::clamp(y - kRows, 0, h - 1);
            float* to = first + y * row_floats;
            std::memcpy(to, from, static_cast<std::size_t>(w) * 12);
            std::memcpy(to - 3 * kColumns, from + 3 * (w - kColumns), kColumns * 12);
            std::memcpy(to + 3 * w, from, kColumns * 12);
        }
    });
}

Point<double> opencv_point(const PlainView& view, int i, int j) {
    const Point<double> p = double_point(view, i, j);
    const auto rounded = [](double c) {
        return std::nearbyint(static_cast<double>(static_cast<float>(c - 0.5)) * 32) / 32 + 0.5;
    };
    return {rounded(p.x), rounded(p.y)};
}

#ifdef ANAMORPH_HAVE_OPENCV

bool have_opencv() {
    return true;
}

template <class Texel>
OpenCv<Texel>::OpenCv(const PlainView& view, const Texel* source, Texel* picture, int threads,
                      const ParallelFor& parallel_for)
    : m_view(view),
      m_source(source),
      m_picture(picture),
      m_threads(threads),
      m_parallel_for(parallel_for),
      m_x(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height)),
      m_y(m_x.size()) {}

template <class Texel>
void OpenCv<Texel>::compute_map() {
    for_strips(m_view.height, m_parallel_for, [&](int first, int last) {
        for (int j = first; j < last; ++j)
            for (int i = 0; i < m_view.width; ++i) {
                const Point<double> p = double_point(m_view, i, j);
                const std::size_t at = static_cast<std::size_t>(j) * static_cast<std::size_t>(m_view.width) +
                                       static_cast<std::size_t>(i);
                m_x[at] = static_cast<float>(p.x - 0.5);
                m_y[at] = static_cast<float>(p.y - 0.5);
            }
    });
}

template <class Texel>
template <class Map>
void OpenCv<Texel>::remap_by(const Map& first, const Map& second) {
    const int depth = std::is_same_v<Texel, float> ? CV_32F : sizeof(Texel) == 1 ? CV_8U : CV_16U;
    const int type = CV_MAKETYPE(depth, 3);
    const cv::Mat from(m_view.source_height, m_view.source_width, type, const_cast<Texel*>(m_source));
    cv::Mat to(m_view.height, m_view.width, type, m_picture);
    cv::setNumThreads(m_threads);
    cv::remap(from, to, first, second, cv::INTER_LINEAR, cv::BORDER_WRAP);
}

template <class Texel>
void OpenCv<Texel>::remap() {
    const int w = m_view.width, h = m_view.height;
    remap_by(cv::Mat(h, w, CV_32FC1, m_x.data()), cv::Mat(h, w, CV_32FC1, m_y.data()));
}

template <class Texel>
void OpenCv<Texel>::fix_map() {
    const int w = m_view.width, h = m_view.height;
    m_whole.resize(2 * m_x.size());
    m_fraction.resize(m_x.size());
    cv::Mat whole(h, w, CV_16SC2, m_whole.data()), fraction(h, w, CV_16UC1, m_fraction.data());
    cv::convertMaps(cv::Mat(h, w, CV_32FC1, m_x.data()), cv::Mat(h, w, CV_32FC1, m_y.data()), whole, fraction,
                    CV_16SC2);
}

template <class Texel>
void OpenCv<Texel>::remap_fixed() {
    const int w = m_view.width, h = m_view.height;
    remap_by(cv::Mat(h, w, CV_16SC2, m_whole.data()), cv::Mat(h, w, CV_16UC1, m_fraction.data()));
}

#else

bool have_opencv() {
    return false;
}

template <class Texel>
OpenCv<Texel>::OpenCv(const PlainView& view, const Texel* source, Texel* picture, int threads,
                      const ParallelFor& parallel_for)
    : m_view(view), m_source(source), m_picture(picture), m_threads(threads), m_parallel_for(parallel_for) {
    throw Error("this benchmark was built without OpenCV");
}
template <class Texel>
void OpenCv<Texel>::compute_map() {}
template <class Texel>
void OpenCv<Texel>::remap() {}
template <class Texel>
void OpenCv<Texel>::fix_map() {}
template <class Texel>
void OpenCv<Texel>::remap_fixed() {}

#endif

template class OpenCv<float>;
template class OpenCv<std::uint8_t>;
template class OpenCv<std::uint16_t>;

Traffic::Traffic(const PlainView& view, const std::byte* source, int texel_bytes,
                 const ParallelFor& parallel_for)
    : m_picture_bytes(static_cast<std::size_t>(view.width) * static_cast<std::size_t>(view.height) *
                      static_cast<std::size_t>(texel_bytes)) {
    constexpr std::size_t kLine = 64;
    const std::int64_t row = std::int64_t{view.source_width} * texel_bytes;
    const std::size_t lines = static_cast<std::size_t>(row * view.source_height + 63) / kLine;
    std::vector<std::atomic<bool>> touched(lines);
    const auto touch = [&](std::int64_t x, std::int64_t y) {
        const std::int64_t at = std::clamp<std::int64_t>(y, 0, view.source_height - 1) * row +
                                std::clamp<std::int64_t>(x, 0, view.source_width - 1) * texel_bytes;
        for (const std::int64_t byte : {at, at + texel_bytes - 1})
            touched[static_cast<std::size_t>(byte) / kLine].store(true, std::memory_order_relaxed);
    };
    for_strips(view.height, parallel_for, [&](int first, int last) {
        for (int j = first; j < last; ++j)
            for (int i = 0; i < view.width; ++i) {
                const Point<double> p = double_point(view, i, j);
                const auto x = static_cast<std::int64_t>(std::floor(p.x - 0.5));
                const auto y = static_cast<std::int64_t>(std::floor(p.y - 0.5));
                for (int k = 0; k < 4; ++k) touch(x + (k & 1), y + (k >> 1));
            }
    });
    for (std::size_t i = 0; i < lines; ++i) {
        if (!touched[i]) continue;
        if (i > 0 && touched[i - 1])
            m_runs.back().bytes += kLine;
        else
            m_runs.push_back({source + i * kLine, kLine});
    }
}

std::size_t Traffic::bytes_read() const {
    std::size_t bytes = 0;
    for (const Run& run : m_runs) bytes += run.bytes;
    return bytes;
}

void Traffic::copy(std::byte* picture, const ParallelFor& parallel_for) const {
    // Each run with its share of the picture, so that reading and writing alternate as in a resampler.
    const std::size_t runs = m_runs.size();
    const std::int64_t tasks = static_cast<std::int64_t>((runs + kStrip - 1) / kStrip);
    parallel_for(tasks, [&](std::int64_t task) {
        const std::size_t first = static_cast<std::size_t>(task) * kStrip,
                          last = std::min(first + kStrip, runs);
        for (std::size_t i = first; i < last; ++i) {
            const std::size_t begin = m_picture_bytes * i / runs / 64 * 64;
            const std::size_t end = m_picture_bytes * (i + 1) / runs / 64 * 64;
            stream(m_runs[i].begin, m_runs[i].bytes, picture + begin, end - begin);
        }
    });
}

}  // namespace anamorph::bench
