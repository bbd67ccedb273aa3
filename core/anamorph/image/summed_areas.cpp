// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/summed_areas.h"

#include <algorithm>
#include <cmath>

#include "anamorph/error.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/weightless.h"

namespace anamorph {
namespace {

/// Texels [first, end) of an axis, so many times.
struct Run {
    int first, end;
    double weight;
};

/// What an interval of an axis covers.
class Runs {
  public:
    Runs(double from, double to, int size, Wrap wrap) : m_size(size) {
        switch (wrap) {
            case Wrap::clamp:
                add(0, 1, std::min(to, 0.0) - from);
                add(size - 1, size, to - std::max(from, double(size)));
                add_within(std::max(from, 0.0), std::min(to, double(size)));
                break;
            case Wrap::periodic:
                add_repeated(from, to, size, [&](double a, double b) { add_within(a, b); });
                break;
            case Wrap::mirror:
                add_repeated(from, to, 2.0 * size, [&](double a, double b) {
                    add_within(a, std::min(b, double(size)));
                    add_within(2.0 * size - b, std::min(2.0 * size - a, double(size)));
                });
                break;
            case Wrap::automatic:
            case Wrap::black:
                add_within(std::max(from, 0.0), std::min(to, double(size)));
                break;
        }
    }
    const Run* begin() const { return m_runs; }
    const Run* end() const { return m_runs + m_count; }

  private:
    void add(int first, int end, double weight) {
        if (first < end && weight > 0) m_runs[m_count++] = {first, end, weight};
    }
    /// Adds what is from 0 to the size: a part of a texel, whole ones, a part of another.
    void add_within(double from, double to) {
        if (!(from < to)) return;
        const int first = std::min(static_cast<int>(from), m_size - 1), last = static_cast<int>(to);
        if (first == last) return add(first, first + 1, to - from);
        add(first, first + 1, first + 1 - from);
        add(first + 1, last, 1);
        add(last, std::min(last + 1, m_size), to - last);
    }
    /// body(from, to) for the parts of an interval within one period, of an axis that repeats itself; whole periods weigh
    /// as much as there are of them.
    template <class Body>
    void add_repeated(double from, double to, double period, const Body& body) {
        const double length = to - from, start = std::max(0.0, from - std::floor(from / period) * period),
                     end = start + length, whole = std::floor(end / period);
        if (whole < 1) return body(std::min(start, period), std::min(end, period));
        body(std::min(start, period), period);
        if (whole > 1) add(0, m_size, (whole - 1) * period / m_size);
        body(0, std::clamp(end - whole * period, 0.0, period));
    }

    int m_size;
    // Four ends of two parts, each with whole texels between, and whole periods.
    Run m_runs[16];
    int m_count = 0;
};

/// The kind of a number that is not finite: no number, +infinite, -infinite.
std::size_t kind_of(double value) {
    return std::isnan(value) ? 0 : value > 0 ? 1 : 2;
}

}  // namespace

/// A source row by row, as it is averaged: in double, integers as they are stored, colour multiplied by alpha.
class SummedAreas::Texels {
  public:
    explicit Texels(const Source& source)
        : m_source(source), m_extent(source.extent(0)), m_channels(source.channels()) {
        const std::size_t values =
            static_cast<std::size_t>(m_extent.width()) * static_cast<std::size_t>(m_channels);
        m_bytes.resize(values * static_cast<std::size_t>(size_of(source.type())));
        m_values.resize(values);
    }

    /// Row y of the extent.
    const std::vector<double>& row(int y) {
        y += m_extent.y0;
        if (!m_source.read(0, {m_extent.x0, y, m_extent.x1, y + 1}, m_bytes.data(),
                           static_cast<std::ptrdiff_t>(m_bytes.size())))
            throw Error("a source cannot be read");
        const PixelType type = m_source.type();
        for (std::size_t i = 0; i < m_values.size(); ++i)
            m_values[i] = stored(m_bytes.data() + static_cast<std::ptrdiff_t>(i) * size_of(type), type);
        const int alpha = m_source.unassociated_alpha();
        for (std::size_t i = 0; alpha >= 0 && i < m_values.size();
             i += static_cast<std::size_t>(m_channels)) {
            double* const pixel = m_values.data() + i;
            for (int c = 0; c < m_channels; ++c)
                if (c != alpha) pixel[c] = pixel[alpha] == 0 ? 0 : pixel[c] * pixel[alpha];
        }
        return m_values;
    }
    /// What one stands for in a channel of a row.
    double scale(int channel) const {
        const double one = m_source.type() == PixelType::uint8    ? 255
                           : m_source.type() == PixelType::uint16 ? 65535
                                                                  : 1;
        const int alpha = m_source.unassociated_alpha();
        return alpha >= 0 && channel != alpha ? 1 / one / one : 1 / one;
    }

  private:
    static double stored(const std::byte* channel, PixelType type) {
        if (type == PixelType::uint8) return pixel_detail::get<std::uint8_t>(channel);
        if (type == PixelType::uint16) return pixel_detail::get<std::uint16_t>(channel);
        return double{load_channel(channel, type)};
    }

    const Source& m_source;
    Box m_extent;
    int m_channels;
    std::vector<std::byte> m_bytes;
    std::vector<double> m_values;
};

SummedAreas::SummedAreas(const Source& source)
    : m_size(source.size(0)),
      m_extent(source.extent(0)),
      m_units(static_cast<std::size_t>(source.channels()), 1.0) {
    Texels texels(source);
    for (int c = 0; c < source.channels(); ++c) m_scales.push_back(texels.scale(c));
    choose_units(texels);
    add_up(texels);
}

/// Units of which the magnitudes of all texels, rounded or not, add up to less than 2^62.
void SummedAreas::choose_units(Texels& texels) {
    const std::size_t channels = m_units.size();
    std::vector<double> total(channels, 0.0);
    std::array<bool, 3> there{};
    for (int y = 0; y < m_extent.height(); ++y) {
        const std::vector<double>& row = texels.row(y);
        for (std::size_t i = 0; i < row.size(); ++i)
            if (std::isfinite(row[i]))
                total[i % channels] += std::fabs(row[i]);
            else
                there[kind_of(row[i])] = true;
    }
    for (std::size_t c = 0; c < channels; ++c)
        m_units[c] = total[c] > 0 ? std::ldexp(1.0, std::max(std::ilogb(total[c]) - 60, -1000)) : 1;
    const std::size_t room = at(0, m_extent.height() + 1);
    m_sums.resize(room);
    for (std::size_t kind = 0; kind < there.size(); ++kind)
        if (there[kind]) m_special[kind].resize(room);
}

void SummedAreas::add_up(Texels& texels) {
    const std::size_t channels = m_units.size();
    std::vector<std::uint64_t> sum(channels);
    std::array<std::vector<std::uint64_t>, 3> special;
    for (int y = 0; y < m_extent.height(); ++y) {
        const std::vector<double>& row = texels.row(y);
        std::fill(sum.begin(), sum.end(), 0);
        for (std::vector<std::uint64_t>& of : special) of.assign(channels, 0);
        const std::size_t above = at(1, y), here = at(1, y + 1);
        for (std::size_t i = 0; i < row.size(); ++i) {
            const std::size_t c = i % channels;
            if (std::isfinite(row[i]))
                sum[c] += static_cast<std::uint64_t>(std::llrint(row[i] / m_units[c]));
            else
                ++special[kind_of(row[i])][c];
            m_sums[here + i] = m_sums[above + i] + sum[c];
            for (std::size_t kind = 0; kind < special.size(); ++kind)
                if (std::vector<std::uint64_t>& to = m_special[kind]; !to.empty())
                    to[here + i] = to[above + i] + special[kind][c];
        }
    }
}

/// A part of a rectangle; its runs are counted from texel (left, top) of the table.
struct SummedAreas::Part {
    Runs across, down;
    int left = 0, top = 0;
};

void SummedAreas::mean(double x, double y, double width, double height, Wrap wrap,
                       float* pixel) const noexcept {
    if (std::isnan(x) || std::isnan(y)) return clear(pixel);
    // Far beyond every edge all points are alike, and no picture is larger.
    constexpr double kFar = 0x1p30;
    const double w = width > 1 ? std::min(width, kFar) : 1, h = height > 1 ? std::min(height, kFar) : 1;
    x = std::clamp(x, -kFar, kFar);
    y = std::clamp(y, -kFar, kFar);
    if (wrap == Wrap::black || wrap == Wrap::automatic) {
        x -= m_extent.x0;
        y -= m_extent.y0;
        const Part all{{x - w / 2, x + w / 2, m_extent.width(), wrap},
                       {y - h / 2, y + h / 2, m_extent.height(), wrap}};
        return mean_of({&all, 1}, w * h, pixel);
    }
    const Part all{{x - w / 2, x + w / 2, m_size.width, wrap},
                   {y - h / 2, y + h / 2, m_size.height, wrap},
                   -m_extent.x0,
                   -m_extent.y0};
    mean_of({&all, 1}, w * h, pixel);
}

void SummedAreas::mean_over_poles(double x, double y, double width, double height,
                                  float* pixel) const noexcept {
    if (!std::isfinite(x) || !std::isfinite(y)) return clear(pixel);
    const double across = m_size.width, down = m_size.height;
    // On the picture, as one goes up and down a meridian and its opposite again and again.
    y -= std::floor(y / (2 * down)) * 2 * down;
    x += y > down ? across / 2 : 0;
    x -= std::floor(x / across) * across;
    y = std::clamp(y > down ? 2 * down - y : y, 0.0, down);
    const double w = width > 1 ? std::min(width, across) : 1, h = height > 1 ? std::min(height, down) : 1;
    const double above = y - h / 2, below = y + h / 2;
    const auto part = [&](double at, double from, double to) {
        return Part{{at - w / 2, at + w / 2, m_size.width, Wrap::periodic},
                    {from, to, m_size.height, Wrap::black},
                    -m_extent.x0,
                    -m_extent.y0};
    };
    const double opposite = x + across / 2;
    const Part parts[] = {part(x, above, below), part(opposite, 0, -above),
                          part(opposite, 2 * down - below, down)};
    mean_of(parts, w * h, pixel);
}

void SummedAreas::clear(float* pixel) const noexcept {
    std::fill_n(pixel, m_units.size(), 0.0f);
}

void SummedAreas::mean_of(std::span<const Part> parts, double area, float* pixel) const noexcept {
    for (std::size_t c = 0; c < m_units.size(); ++c) {
        const auto over = [&](const std::vector<std::uint64_t>& sums, const Part& part, const Run& i,
                              const Run& j) {
            const auto sum = [&](int x, int y) { return sums[at(part.left + x, part.top + y) + c]; };
            return sum(i.end, j.end) - sum(i.first, j.end) - sum(i.end, j.first) + sum(i.first, j.first);
        };
        double sum = 0;
        std::array<std::uint64_t, 3> special{};
        for (const Part& part : parts)
            for (const Run& j : part.down)
                for (const Run& i : part.across) {
                    sum += i.weight * j.weight *
                           static_cast<double>(static_cast<std::int64_t>(over(m_sums, part, i, j)));
                    const bool counts = i.weight >= kSameTexel && j.weight >= kSameTexel;
                    for (std::size_t kind = 0; counts && kind < special.size(); ++kind)
                        if (!m_special[kind].empty()) special[kind] |= over(m_special[kind], part, i, j);
                }
        const auto [none, high, low] = special;
        pixel[c] = none || (high && low) ? NAN
                   : high                ? HUGE_VALF
                   : low                 ? -HUGE_VALF
                                         : static_cast<float>(sum * m_units[c] * m_scales[c] / area);
    }
}

}  // namespace anamorph
