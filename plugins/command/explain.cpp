// SPDX-License-Identifier: Apache-2.0
#include "explain.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <functional>
#include <iomanip>
#include <map>
#include <mutex>
#include <sstream>
#include <utility>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/file_names.h"
#include "anamorph/image/picture.h"
#include "anamorph/parallel.h"
#include "anamorph/parameter/parameter.h"
#include "recipe.h"
#include "recipe_content.h"

namespace anamorph::command {
namespace {

using OIIO::ImageSpec;

// Pictures are drawn in strips of so many rows.
constexpr int kStrip = 256;
// What is asked for of a source is kept by squares of so many texels.
constexpr Size kSquare{32, 32};

/// The cells of a grid over a box that some of it was asked for in.
class Touched {
  public:
    /// Cells count from the corner of the box.
    Touched(const Box& box, const Size& cell)
        : m_box(box),
          m_cell(cell),
          m_columns((box.width() + cell.width - 1) / cell.width),
          m_cells(static_cast<std::size_t>(m_columns) *
                  static_cast<std::size_t>((box.height() + cell.height - 1) / cell.height)) {}

    void add(const Box& box) {
        const Box part = intersection(box, m_box);
        if (part.empty()) return;
        for (int y = (part.y0 - m_box.y0) / m_cell.height; y <= (part.y1 - 1 - m_box.y0) / m_cell.height; ++y)
            for (int x = (part.x0 - m_box.x0) / m_cell.width; x <= (part.x1 - 1 - m_box.x0) / m_cell.width;
                 ++x)
                m_cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(m_columns) +
                        static_cast<std::size_t>(x)] = true;
    }
    /// Calls body(cell) for those cells.
    template <class Body>
    void each(const Body& body) const {
        for (std::size_t i = 0; i < m_cells.size(); ++i) {
            if (!m_cells[i]) continue;
            const int x = m_box.x0 + static_cast<int>(i % static_cast<std::size_t>(m_columns)) * m_cell.width,
                      y = m_box.y0 +
                          static_cast<int>(i / static_cast<std::size_t>(m_columns)) * m_cell.height;
            body(intersection({x, y, x + m_cell.width, y + m_cell.height}, m_box));
        }
    }
    std::int64_t count() const { return std::ranges::count(m_cells, true); }
    std::size_t cells() const { return m_cells.size(); }
    const Box& box() const { return m_box; }

  private:
    Box m_box;
    Size m_cell;
    int m_columns;
    std::vector<bool> m_cells;
};

/// A source like another one, all of whose texels are 0, which remembers what it was asked for.
class BlankSource final : public Source {
  public:
    explicit BlankSource(const Source& like) : m_like(like) {
        for (int level = 0; level < like.levels(); ++level)
            m_touched.emplace_back(like.extent(level), kSquare);
    }

    PixelType type() const noexcept override { return m_like.type(); }
    int channels() const noexcept override { return m_like.channels(); }
    int unassociated_alpha() const noexcept override { return m_like.unassociated_alpha(); }
    int levels() const noexcept override { return m_like.levels(); }
    Size size(int level) const noexcept override { return m_like.size(level); }
    Box extent(int level) const noexcept override { return m_like.extent(level); }
    Box data_window() const noexcept override { return m_like.data_window(); }
    bool read(int level, const Box& box, std::byte* texels,
              std::ptrdiff_t row_stride) const noexcept override {
        const std::size_t row =
            static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(channels() * size_of(type()));
        for (int y = box.y0; y < box.y1; ++y, texels += row_stride) std::memset(texels, 0, row);
        const std::lock_guard lock(m_mutex);
        m_touched[static_cast<std::size_t>(level)].add(box);
        return true;
    }
    /// What was asked for of each level.
    const std::vector<Touched>& touched() const { return m_touched; }

  private:
    const Source& m_like;
    mutable std::mutex m_mutex;
    mutable std::vector<Touched> m_touched;
};

class Stopwatch {
  public:
    /// The seconds since the last call, or since it was made.
    double lap() {
        const auto now = std::chrono::steady_clock::now();
        const double seconds = std::chrono::duration<double>(now - m_last).count();
        m_last = now;
        return seconds;
    }

  private:
    std::chrono::steady_clock::time_point m_last = std::chrono::steady_clock::now();
};

std::string shown(double value) {
    std::ostringstream text;
    text << std::setprecision(4) << value;
    return text.str();
}
std::string percent(double part, double of) {
    return shown(of > 0 ? 100 * part / of : 0) + "%";
}
std::string bytes(double count) {
    static constexpr std::array kUnits{"bytes", "kB", "MB", "GB", "TB"};
    std::size_t unit = 0;
    for (; count >= 1000 && unit + 1 < kUnits.size(); ++unit) count /= 1000;
    std::ostringstream text;
    text << std::setprecision(3) << count << " " << kUnits[unit];
    return text.str();
}
std::string size_text(int width, int height) {
    return std::to_string(width) + " x " + std::to_string(height);
}
std::string box_text(const Box& box) {
    return std::to_string(box.width()) + "x" + std::to_string(box.height()) + (box.x0 < 0 ? "" : "+") +
           std::to_string(box.x0) + (box.y0 < 0 ? "" : "+") + std::to_string(box.y0);
}

/// A line: a word in a column, and what there is to say of it.
void line(std::ostream& to, const std::string& word, const std::string& text) {
    to << std::left << std::setw(18) << word << " " << text << "\n";
}

/// Reads "WxH+X+Y".
Box crop_of(const std::string& text, const Box& whole) {
    std::array<int, 4> n{};
    std::istringstream from(text);
    char by = 0, rest = 0;
    const bool good =
        from >> n[0] >> by >> n[1] >> n[2] >> n[3] && by == 'x' && !(from >> rest) && n[0] > 0 && n[1] > 0;
    const auto beyond = [](std::int64_t first, std::int64_t length) { return first + length > INT32_MAX; };
    if (!good || beyond(n[2], n[0]) || beyond(n[3], n[1]))
        throw Error("crop", printable(text), "must be WIDTHxHEIGHT+X+Y");
    const Box part = intersection({n[2], n[3], n[2] + n[0], n[3] + n[1]}, whole);
    if (part.empty()) throw Error("crop", printable(text), "must meet the picture, " + box_text(whole));
    return part;
}

/// The way in which a block finds source points.
std::string way_of(const Block& block) {
    switch (block.kind) {
        case Block::Kind::polynomial:
            return "quadratic";
        case Block::Kind::bicubic:
            return block.precise ? "quartic in double" : "cubic";
        case Block::Kind::computed:
            return block.precise ? "direct in double" : "direct";
        case Block::Kind::exact:
            return block.precise ? "exact in pairs of doubles" : "exact";
        case Block::Kind::outside:
            break;
    }
    return "outside";
}

/// What there is of blocks of one kind in a part of a picture.
struct Share {
    std::int64_t blocks = 0, pixels = 0;
    double bound = 0;
    Box around{};

    void add(const Block& block, const Box& part) {
        around = blocks == 0 ? part
                             : Box{std::min(around.x0, part.x0), std::min(around.y0, part.y0),
                                   std::max(around.x1, part.x1), std::max(around.y1, part.y1)};
        ++blocks;
        pixels += std::int64_t{part.width()} * part.height();
        bound = std::max(bound, block.bound);
    }
};

void tell_blocks(const Picture& picture, const Box& box, const Point<int>& corner, std::ostream& to) {
    const Box in_maps = moved(box, -picture.overscan.width, -picture.overscan.height);
    for (std::size_t k = 0; k < picture.maps.size(); ++k) {
        const BlockMap& map = *picture.maps[k].blocks;
        std::map<std::string, Share> shares;
        std::int64_t all = 0;
        for (const std::int64_t region : map.regions_in(in_maps))
            for (const Block& block : map.blocks(region)) {
                const Box part = intersection(block.box, in_maps);
                if (part.empty()) continue;
                shares[way_of(block)].add(block, part);
                all += std::int64_t{part.width()} * part.height();
            }
        const std::string number = picture.maps.size() > 1 ? " of map " + std::to_string(k + 1) : "";
        std::vector<std::pair<std::string, Share>> most_first(shares.begin(), shares.end());
        std::ranges::stable_sort(most_first, std::greater(), [](const auto& of) { return of.second.pixels; });
        for (const auto& [way, share] : most_first) {
            std::string text = percent(double(share.pixels), double(all)) + number + ", " +
                               std::to_string(share.blocks) + (share.blocks == 1 ? " block" : " blocks");
            if (way != "outside") text += ", bound " + shown(share.bound);
            // Where the map is dear.
            if (way.starts_with("exact"))
                text += ", within " + box_text(moved(share.around, picture.overscan.width + corner.x,
                                                     picture.overscan.height + corner.y));
            line(to, way, text);
        }
    }
}

/// What is read of a level of a file for the texels that were touched, in pixels of its data window.
std::string read_of(const ImageSpec& spec, const Touched& touched) {
    const Box data{0, 0, spec.width, spec.height};
    // Texels count from the corner of the display window.
    const auto in_data = [&](const Box& square) {
        return intersection(moved(square, spec.full_x - spec.x, spec.full_y - spec.y), data);
    };
    const double pixel = double(spec.pixel_bytes(true));
    if (spec.tile_width == 0) {
        int first = spec.height, end = 0;
        touched.each([&](const Box& square) {
            const Box part = in_data(square);
            if (part.empty()) return;
            first = std::min(first, part.y0);
            end = std::max(end, part.y1);
        });
        const int unit = FileRows::unit_of(spec);
        first = first / unit * unit;
        end = std::min((end + unit - 1) / unit * unit, spec.height);
        if (end <= first) return "nothing of its pixels";
        return "rows " + std::to_string(first) + " to " + std::to_string(end - 1) + " of " +
               std::to_string(spec.height) + ", " + bytes(double(end - first) * spec.width * pixel);
    }
    Touched tiles(data, {spec.tile_width, spec.tile_height});
    touched.each([&](const Box& square) { tiles.add(in_data(square)); });
    return std::to_string(tiles.count()) + " of " + std::to_string(tiles.cells()) + " tiles, " +
           bytes(double(tiles.count()) * spec.tile_width * spec.tile_height * pixel);
}

void tell_source(const SourceStack& stack, const BlankSource& blank, std::ostream& to) {
    const CacheSource* file = stack.file();
    // The texels of an image that is turned, cut or converted first are not those of the file.
    const bool as_stored = file == &stack.full();
    const std::string name = file ? printable(file->name()) : "six files";
    const std::string kind = file && operation_of(file->name()) ? ", a recipe that is drawn first" : "";
    const Size size = blank.size(0);
    line(to, "source", name + ", " + size_text(size.width, size.height) + kind);
    const std::vector<ImageSpec> specs = as_stored ? file->specs() : std::vector<ImageSpec>();
    bool any = false;
    for (int level = 0; level < blank.levels(); ++level) {
        const Touched& touched = blank.touched()[static_cast<std::size_t>(level)];
        if (touched.count() == 0) continue;
        any = true;
        std::string text;
        if (as_stored) {
            text = read_of(specs[static_cast<std::size_t>(level)], touched);
        } else {
            double texels = 0;
            touched.each([&](const Box& square) { texels += double(square.width()) * square.height(); });
            const Box& all = touched.box();
            text = percent(texels, double(all.width()) * all.height()) + " of its texels";
        }
        line(to, "  level " + std::to_string(level), text);
    }
    if (!any) line(to, "  no level", "is read");
}

/// Calls body(strip) for the strips of a box.
template <class Body>
void each_strip(const Box& box, const Body& body) {
    for (int y = box.y0; y < box.y1; y += kStrip) body(Box{box.x0, y, box.x1, std::min(box.y1, y + kStrip)});
}

}  // namespace

void explain(const std::string& recipe, const std::optional<std::string>& crop, int subimage, bool timed,
             std::ostream& to) {
    if (!operation_of(recipe)) throw Error("RECIPE", printable(recipe), "must be the name of a recipe");
    Stopwatch watch;
    const std::shared_ptr<const Content> content = open_recipe(recipe, {});
    if (subimage < 0 || subimage >= content->subimages())
        throw Error("subimage", std::to_string(subimage),
                    "must be an integer from 0 to " + std::to_string(content->subimages() - 1));
    const ImageSpec& header = content->header(subimage, 0);
    const double opened = watch.lap();
    const ImageSpec& spec = content->spec(subimage, 0);
    const double planned = watch.lap();

    const Point<int> corner{header.x, header.y};
    const Box all{header.x, header.y, header.x + header.width, header.y + header.height};
    const Box part = crop ? crop_of(*crop, all) : all, box = moved(part, -corner.x, -corner.y);
    line(to, "picture",
         size_text(header.width, header.height) + ", " + std::to_string(header.nchannels) +
             (header.nchannels == 1 ? " channel, " : " channels, ") + header.format.c_str() +
             (content->subimages() > 1 ? ", one of " + std::to_string(content->subimages()) : ""));
    if (crop) line(to, "part", box_text(part));
    for (const OIIO::ParamValue& said : spec.extra_attribs)
        if (const std::string name = said.name().string(); name.starts_with("anamorph:"))
            line(to, name.substr(name.find(':') + 1), printable(said.get_string()));

    const std::optional<JoinSource> made = content->join_source(subimage);
    if (const Picture* picture = made ? made->picture->of_maps() : nullptr)
        tell_blocks(*picture, box, corner, to);
    double drawn = 0;
    if (made) {
        // Drawn with sources that have no pixels, it asks for those that it would read.
        std::vector<std::unique_ptr<BlankSource>> blanks;
        std::vector<std::unique_ptr<Source>> tops;
        std::vector<const Source*> sources;
        for (const auto& stack : *made->stacks) {
            blanks.push_back(stack ? std::make_unique<BlankSource>(stack->full()) : nullptr);
            tops.push_back(stack ? stack->levels_over(*blanks.back()) : nullptr);
            sources.push_back(tops.back().get());
        }
        const bool in_float =
            !made->stacks->empty() && made->stacks->front() && made->stacks->front()->space();
        const StoredPixels as = in_float       ? StoredPixels{PixelType::float32, header.nchannels}
                                : made->stored ? stored_pixels(header)
                                               : StoredPixels{pixel_type(header.format), header.nchannels};
        std::vector<std::byte> pixels(static_cast<std::size_t>(box.width()) * kStrip *
                                      static_cast<std::size_t>(as.channels * size_of(as.type)));
        watch.lap();
        each_strip(box, [&](const Box& strip) {
            made->picture->draw(
                sources, strip,
                packed_view(pixels.data(), as.type, strip.width(), strip.height(), as.channels),
                default_parallel_for());
        });
        drawn = watch.lap();
        for (std::size_t i = 0; i < blanks.size(); ++i)
            if (blanks[i]) tell_source(*(*made->stacks)[i], *blanks[i], to);
    }
    if (!timed) return;
    std::vector<std::byte> pixels(static_cast<std::size_t>(box.width()) * kStrip * header.pixel_bytes(true));
    watch.lap();
    each_strip(box, [&](const Box& strip) { content->read(subimage, 0, strip, pixels.data()); });
    const double read = watch.lap();
    line(to, "time",
         "opened in " + shown(opened) + " s, planned in " + shown(planned) + ", drawn in " + shown(read) +
             ", of which " + shown(std::max(0.0, read - drawn)) + " for reading");
}

}  // namespace anamorph::command
