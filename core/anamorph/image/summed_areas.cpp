// SPDX-License-Identifier: Apache-2.0
#include "anamorph/image/summed_areas.h"

#include <algorithm>
#include <cmath>
#include <new>

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

/// The sums of the texels of a tile, of each channel above and to the left of a corner.
struct SummedAreas::Tile {
    int width = 0;              ///< texels
    std::vector<double> units;  ///< of the sums, channel by channel
    // One of them is empty: sums that 32 bits hold, and others, modulo 2^64.
    std::vector<std::uint32_t> small;
    std::vector<std::uint64_t> large;
    /// Counts of texels that are no numbers, +infinite and -infinite; each empty where none is.
    std::array<std::vector<std::uint32_t>, 3> special;

    std::size_t at(int x, int y) const {
        return (static_cast<std::size_t>(y) * (static_cast<std::size_t>(width) + 1) +
                static_cast<std::size_t>(x)) *
               units.size();
    }
    /// What a box of texels has in a channel.
    template <class Whole>
    auto over(const std::vector<Whole>& sums, const Box& box, std::size_t c) const {
        return static_cast<Whole>(sums[at(box.x1, box.y1) + c] - sums[at(box.x0, box.y1) + c] -
                                  sums[at(box.x1, box.y0) + c] + sums[at(box.x0, box.y0) + c]);
    }
    /// Exact where it is less than 2^53 units.
    double sum(const Box& box, std::size_t c) const {
        return small.empty() ? static_cast<double>(static_cast<std::int64_t>(over(large, box, c))) * units[c]
                             : static_cast<double>(over(small, box, c));
    }
    std::size_t bytes() const {
        std::size_t all = small.size() * sizeof small[0] + large.size() * sizeof large[0];
        for (const auto& counts : special) all += counts.size() * sizeof counts[0];
        return all;
    }
};

/// A tile's table, where it is kept, and whether it was asked for lately.
struct SummedAreas::Slot {
    std::shared_ptr<const Tile> tile;
    bool recent = false;
};

/// What a rectangle has of a channel.
struct SummedAreas::Sums {
    double sum = 0;
    std::array<bool, 3> special{};
};

namespace {

double stored(const std::byte* channel, PixelType type) {
    if (type == PixelType::uint8) return pixel_detail::get<std::uint8_t>(channel);
    if (type == PixelType::uint16) return pixel_detail::get<std::uint16_t>(channel);
    return double{load_channel(channel, type)};
}

/// Texels of a box as they are averaged: in double, integers as they are stored, colour multiplied by alpha.
std::vector<double> values_of(const Source& source, int level, const Box& box) {
    const auto channels = static_cast<std::size_t>(source.channels()),
               row = static_cast<std::size_t>(box.width()) * channels;
    const PixelType type = source.type();
    std::vector<std::byte> bytes(row * static_cast<std::size_t>(box.height() * size_of(type)));
    if (!source.read(level, box, bytes.data(), static_cast<std::ptrdiff_t>(row) * size_of(type)))
        throw Error("a source cannot be read");
    std::vector<double> values(row * static_cast<std::size_t>(box.height()));
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = stored(bytes.data() + static_cast<std::ptrdiff_t>(i) * size_of(type), type);
    const int alpha = source.unassociated_alpha();
    for (std::size_t i = 0; alpha >= 0 && i < values.size(); i += channels) {
        double* const pixel = values.data() + i;
        for (int c = 0; c < source.channels(); ++c)
            if (c != alpha) pixel[c] = pixel[alpha] == 0 ? 0 : pixel[c] * pixel[alpha];
    }
    return values;
}

/// What one stands for in a channel.
double scale_of(const Source& source, int channel) {
    const double one = source.type() == PixelType::uint8    ? 255
                       : source.type() == PixelType::uint16 ? 65535
                                                            : 1;
    const int alpha = source.unassociated_alpha();
    return alpha >= 0 && channel != alpha ? 1 / one / one : 1 / one;
}

bool is_whole(PixelType type) {
    return type == PixelType::uint8 || type == PixelType::uint16;
}

/// Are all sums of a tile less than 2^32: kTile^2 = 2^14 times 255^2 or 65535?
bool is_small(const Source& source) {
    return source.type() == PixelType::uint8 ||
           (source.type() == PixelType::uint16 && source.unassociated_alpha() < 0);
}

int tiles_over(int texels) {
    return (texels + SummedAreas::kTile - 1) / SummedAreas::kTile;
}

}  // namespace

SummedAreas::SummedAreas(const Source& source, int level)
    : m_source(source),
      m_level(level),
      m_size(source.size(level)),
      m_extent(source.extent(level)),
      m_columns(tiles_over(m_extent.width())),
      m_rows(tiles_over(m_extent.height())),
      m_slots(
          std::make_unique<Slot[]>(static_cast<std::size_t>(m_columns) * static_cast<std::size_t>(m_rows))) {
    for (int c = 0; c < source.channels(); ++c) m_scales.push_back(scale_of(source, c));
}

SummedAreas::~SummedAreas() = default;

std::shared_ptr<const SummedAreas::Tile> SummedAreas::tile(int column, int row) const noexcept try {
    const std::size_t number = static_cast<std::size_t>(row) * static_cast<std::size_t>(m_columns) +
                               static_cast<std::size_t>(column);
    Slot& slot = m_slots[number];
    std::shared_ptr<const Tile> made;
    {
        const std::lock_guard lock(m_locks[number % kLocks]);
        slot.recent = true;
        if (slot.tile) return slot.tile;
        made = slot.tile = make_tile(column, row);
        m_bytes.fetch_add(made->bytes(), std::memory_order_relaxed);
    }
    if (bytes() > kMostBytes) forget_some();
    return made;
} catch (const std::exception&) {
    return nullptr;
}

/// Forgets tables that were not asked for since the last time around. Threads that have made one wait for each other here: else they would make
/// all others while one is forgetting.
void SummedAreas::forget_some() const noexcept {
    const std::lock_guard lock(m_forgetting);
    const std::size_t count = static_cast<std::size_t>(m_columns) * static_cast<std::size_t>(m_rows);
    for (std::size_t looked = 0; looked < 2 * count && bytes() > kMostBytes - kMostBytes / 4; ++looked) {
        const std::size_t number = m_hand++ % count;
        const std::lock_guard of_slot(m_locks[number % kLocks]);
        Slot& slot = m_slots[number];
        if (slot.tile && !slot.recent) {
            m_bytes.fetch_sub(slot.tile->bytes(), std::memory_order_relaxed);
            slot.tile = nullptr;
        }
        slot.recent = false;
    }
}

std::shared_ptr<const SummedAreas::Tile> SummedAreas::make_tile(int column, int row) const {
    const int left = m_extent.x0 + column * kTile, top = m_extent.y0 + row * kTile;
    const Box box = intersection(m_extent, {left, top, left + kTile, top + kTile});
    const std::vector<double> values = values_of(m_source, m_level, box);
    const std::size_t channels = m_scales.size();
    auto made = std::make_shared<Tile>();
    made->width = box.width();
    made->units.assign(channels, 1.0);
    const bool small = is_small(m_source);
    std::array<bool, 3> there{};
    if (!is_whole(m_source.type())) {
        // Units of which the magnitudes of all texels, rounded or not, add up to less than 2^62.
        std::vector<double> total(channels, 0.0);
        for (std::size_t i = 0; i < values.size(); ++i)
            if (std::isfinite(values[i]))
                total[i % channels] += std::fabs(values[i]);
            else
                there[kind_of(values[i])] = true;
        for (std::size_t c = 0; c < channels; ++c)
            if (total[c] > 0) made->units[c] = std::ldexp(1.0, std::max(std::ilogb(total[c]) - 60, -1000));
    }
    const std::size_t room = made->at(0, box.height() + 1);
    if (small)
        made->small.resize(room);
    else
        made->large.resize(room);
    for (std::size_t kind = 0; kind < there.size(); ++kind)
        if (there[kind]) made->special[kind].resize(room);
    const std::size_t of_row = static_cast<std::size_t>(box.width()) * channels;
    std::vector<std::uint64_t> sum(channels);
    std::array<std::vector<std::uint32_t>, 3> special;
    for (int y = 0; y < box.height(); ++y) {
        const double* const texels = values.data() + static_cast<std::size_t>(y) * of_row;
        std::fill(sum.begin(), sum.end(), 0);
        for (std::vector<std::uint32_t>& of : special) of.assign(channels, 0);
        const std::size_t above = made->at(1, y), here = made->at(1, y + 1);
        for (std::size_t i = 0; i < of_row; ++i) {
            const std::size_t c = i % channels;
            if (std::isfinite(texels[i]))
                sum[c] += static_cast<std::uint64_t>(std::llrint(texels[i] / made->units[c]));
            else
                ++special[kind_of(texels[i])][c];
            if (small)
                made->small[here + i] = made->small[above + i] + static_cast<std::uint32_t>(sum[c]);
            else
                made->large[here + i] = made->large[above + i] + sum[c];
            for (std::size_t kind = 0; kind < special.size(); ++kind)
                if (std::vector<std::uint32_t>& to = made->special[kind]; !to.empty())
                    to[here + i] = to[above + i] + special[kind][c];
        }
    }
    return made;
}

/// A part of a rectangle; its runs are counted from texel (left, top) of the table.
struct SummedAreas::Part {
    Runs across, down;
    int left = 0, top = 0;
};

bool SummedAreas::mean(double x, double y, double width, double height, Wrap wrap,
                       float* pixel) const noexcept {
    if (std::isnan(x) || std::isnan(y)) {
        clear(pixel);
        return true;
    }
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
    return mean_of({&all, 1}, w * h, pixel);
}

bool SummedAreas::mean_over_poles(double x, double y, double width, double height,
                                  float* pixel) const noexcept {
    if (!std::isfinite(x) || !std::isfinite(y)) {
        clear(pixel);
        return true;
    }
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
    return mean_of(parts, w * h, pixel);
}

void SummedAreas::clear(float* pixel) const noexcept {
    std::fill_n(pixel, m_scales.size(), 0.0f);
}

/// Adds a rectangle of whole texels of the tables, so often as its weights say, tile by tile. Sums of whole numbers below 2^53 are
/// exact before they are weighed: those of 2^21 texels of uint16 with alpha, of 2^37 of others.
bool SummedAreas::add(const Part& part, double weight_x, double weight_y, const Box& texels,
                      std::span<Sums> sums) const noexcept {
    const Box box{part.left + texels.x0, part.top + texels.y0, part.left + texels.x1, part.top + texels.y1};
    constexpr std::size_t kChannels = 16;
    const bool counts = weight_x >= kSameTexel && weight_y >= kSameTexel;
    for (std::size_t c0 = 0; c0 < sums.size(); c0 += kChannels) {
        const std::size_t c1 = std::min(sums.size(), c0 + kChannels);
        double total[kChannels] = {};
        for (int row = box.y0 / kTile; row * kTile < box.y1; ++row)
            for (int column = box.x0 / kTile; column * kTile < box.x1; ++column) {
                const std::shared_ptr<const Tile> table = tile(column, row);
                if (!table) return false;
                const int x0 = column * kTile, y0 = row * kTile;
                const Box here{std::max(box.x0 - x0, 0), std::max(box.y0 - y0, 0),
                               std::min(box.x1 - x0, kTile), std::min(box.y1 - y0, kTile)};
                for (std::size_t c = c0; c < c1; ++c) {
                    total[c - c0] += table->sum(here, c);
                    for (std::size_t kind = 0; counts && kind < table->special.size(); ++kind)
                        if (!table->special[kind].empty() && table->over(table->special[kind], here, c) != 0)
                            sums[c].special[kind] = true;
                }
            }
        for (std::size_t c = c0; c < c1; ++c) sums[c].sum += weight_x * weight_y * total[c - c0];
    }
    return true;
}

bool SummedAreas::mean_of(std::span<const Part> parts, double area, float* pixel) const noexcept {
    constexpr std::size_t kUsual = 8;
    std::array<Sums, kUsual> few{};
    std::vector<Sums> many;
    try {
        if (m_scales.size() > kUsual) many.resize(m_scales.size());
    } catch (const std::bad_alloc&) {
        clear(pixel);
        return false;
    }
    const std::span<Sums> sums =
        many.empty() ? std::span<Sums>(few).first(m_scales.size()) : std::span<Sums>(many);
    for (const Part& part : parts)
        for (const Run& j : part.down)
            for (const Run& i : part.across)
                if (!add(part, i.weight, j.weight, {i.first, j.first, i.end, j.end}, sums)) {
                    clear(pixel);
                    return false;
                }
    for (std::size_t c = 0; c < sums.size(); ++c) {
        const auto [none, high, low] = sums[c].special;
        pixel[c] = none || (high && low) ? NAN
                   : high                ? HUGE_VALF
                   : low                 ? -HUGE_VALF
                                         : static_cast<float>(sums[c].sum * m_scales[c] / area);
    }
    return true;
}

SummedLevels::SummedLevels(const Source& source) : m_source(source) {
    const Size base = source.size(0);
    for (int level = 0; level < source.levels(); ++level) {
        const Size size = source.size(level);
        m_levels.push_back({double(size.width) / base.width, double(size.height) / base.height, nullptr});
    }
}

const SummedLevels::Level& SummedLevels::level_for(double width, double height) {
    std::size_t level = 0;
    // A side that is no number is not long.
    const auto is_long = [&](const Level& l) {
        return width * l.scale_x >= kLeastTexels && height * l.scale_y >= kLeastTexels;
    };
    while (level + 1 < m_levels.size() && is_long(m_levels[level + 1])) ++level;
    Level& found = m_levels[level];
    if (!found.sums) found.sums = m_source.summed_areas(static_cast<int>(level));
    return found;
}

bool SummedLevels::mean(double x, double y, double width, double height, Wrap wrap, float* pixel) {
    const auto& [across, down, sums] = level_for(width, height);
    return sums && sums->mean(x * across, y * down, width * across, height * down, wrap, pixel);
}

bool SummedLevels::mean_over_poles(double x, double y, double width, double height, float* pixel) {
    const auto& [across, down, sums] = level_for(width, height);
    return sums && sums->mean_over_poles(x * across, y * down, width * across, height * down, pixel);
}

}  // namespace anamorph
