// SPDX-License-Identifier: Apache-2.0
// A picture drawn through maps of blocks, any part of it at a time: one source is seen through each layer of
// each map, and their colours are mixed. A panorama and a warp have one layer, a morph one for each picture.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "anamorph/error.h"
#include "anamorph/image/attribute.h"
#include "anamorph/image/border.h"
#include "anamorph/image/filter.h"
#include "anamorph/image/source.h"
#include "anamorph/parallel_for.h"
#include "anamorph/plan/block.h"

namespace anamorph {

/// What is drawn: colour; the source point as (u, v), v down, (-1, -1) where there is none; the distance of
/// the source point used from the exact one; its proven bound; the source point with v up. Distances in source
/// pixels, of several layers the largest. u and v are in 0..1 on the source: across the seam of one that closes they start anew. Points
/// beyond the edges of any other have values beyond; what is read there is the border's affair. coverage: how much of what the
/// filter takes for a pixel is the source's own, 0 to 1, whatever a border shows beyond, of several layers by their weights.
enum class Output { color, stmap, error, bound, stmap_up, coverage };

/// Is the source point drawn?
constexpr bool is_stmap(Output output) {
    return output == Output::stmap || output == Output::stmap_up;
}
/// v as an output has it, of one that goes down.
constexpr double v_of(Output output, double down) {
    return output == Output::stmap_up ? 1 - down : down;
}

/// Is nothing drawn where all that a pixel would read lies beyond the source's edges? Source points go on there, and so do
/// their errors and bounds.
constexpr bool ends_at_edges(Wrap wrap, Output output) {
    return ((wrap == Wrap::automatic || wrap == Wrap::black) && output == Output::color) ||
           output == Output::coverage;
}

/// Channels, by number, that are read by a filter of their own.
struct DataChannels {
    std::vector<int> channels = {};
    Filter filter = Filter::nearest;

    friend bool operator==(const DataChannels&, const DataChannels&) = default;
};

/// Pixels of a box of the picture, row by row.
struct PixelRows {
    Box box;
    int channels;
    float* values;

    /// The channels of pixel (x, y) of the picture.
    float* at(int x, int y) const {
        return values + (std::ptrdiff_t{y - box.y0} * box.width() + x - box.x0) * channels;
    }
};

/// A picture that is ready to draw any box in any order from any number of threads: the bits of a pixel
/// depend on nothing but the members and the sources.
struct Picture {
    /// A source seen through one layer of a map.
    struct Layer {
        Border border;      ///< knows the source's chart, which has the size of its level 0
        int source = 0;     ///< position among the sources that draw() is given
        double weight = 1;  ///< weight of its colour; the sum over all layers is 1
        /// The factor of `weight` at each pixel of a box, row by row, where it is not 1. False where it is 0
        /// everywhere.
        std::function<bool(const Box& box, float* weights)> weights = {};
    };
    /// A map, and what is seen through each of its layers.
    struct Map {
        std::shared_ptr<const BlockMap> blocks;
        std::vector<Layer> layers;  ///< as many as the map has
    };

    /// The maps that the picture is drawn through, at least one; all cover the same pixels of the same
    /// target. ST-maps need a single layer.
    std::vector<Map> maps;
    Filter filter = Filter::antialias;
    /// Channels of the sources that hold no colour, and the filter they are read by: ids have no mean. Where layers are mixed,
    /// those of a pixel are of the layer that has the greatest weight there, of equal ones of the first.
    DataChannels data = {};
    Output output = Output::color;
    /// Has colour one channel more than the sources, the last: their coverage?
    bool adds_alpha = false;
    /// Does a pixel show the layer that has the greatest weight there, of equal ones the first, in place of the mean?
    bool chooses = false;
    /// A function of each pixel's centre that the picture shows, in one channel, in place of `output`, where
    /// it is given.
    std::function<float(double x, double y)> value;
    /// Draws over the colours before they are stored.
    std::function<void(const PixelRows& pixels)> overlay;
    /// A source that is the picture as it stands, pixel for pixel and whatever the filter.
    std::optional<int> same_as;
    /// How many pixels beyond its edges the picture has (overscan), across and down, on either side: its pixels are counted from
    /// there on, those of its maps from its own corner.
    Size overscan = {};
    /// The number of sources, null or not, that draw() has to be given, where it is fixed.
    std::optional<int> source_count = {};
    /// Finds what the picture says of itself, over all of it, beyond what was reached.
    std::function<Attributes(const ParallelFor& parallel_for)> says = {};
    /// Does reached() compute every pixel, so that it takes as long as drawing all of them?
    bool reached_by_drawing = false;

    int width() const { return maps.front().blocks->width(); }
    int height() const { return maps.front().blocks->height(); }

    /// The picture of which `data` shows channels: by the filter of these, chosen and not mixed, with nothing drawn over it.
    Picture of_data() const;

    /// Is what is drawn made of the sources' colours?
    bool shows_color() const { return !value && output == Output::color; }
    /// Are colours of this source read?
    bool reads(int source) const;
    /// Channels of the picture: those of the sources, of which `first` is one, for colour, and alpha where it is added; 2 for
    /// stmap; else 1. Throws Error where colour lacks a source.
    int channels(const Source* first) const;

    /// The largest proven bound in use (source pixels) and the fraction of pixels computed exactly, over the
    /// whole picture and all layers.
    Reached reached(const ParallelFor& parallel_for = serial_for) const;

    /// Draws the pixels of `box` (of the picture) to `view`, whose pixel (0, 0) is (box.x0, box.y0). Sources
    /// that no layer names may be null, and all but for colour and coverage. False when one could not be read: the picture
    /// is then incomplete. Throws Error where sizes, channels or the number of sources do not fit.
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for = serial_for) const;
    /// Draws a picture of one source, or, with null, of none.
    bool draw(const Source* source, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for = serial_for) const {
        return draw(std::vector<const Source*>{source}, box, view, parallel_for);
    }

  private:
    /// The picture of the sources' coverage, as a colour.
    Picture of_coverage() const;
    /// Draws colours or what stands for them: all channels by the one filter, then those of data by their own.
    bool draw_channels(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
                       const ParallelFor& parallel_for) const;
    bool draw_pixels(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
                     const ParallelFor& parallel_for) const;
};

/// A picture of one source, seen through a map of one layer.
Picture picture_through(std::shared_ptr<const BlockMap> blocks, const Border& border, Filter filter,
                        Output output);

/// Checks the size of a picture that `name` is said to have. Throws Error unless it is 1 to kMaxSide pixels either way.
void check_picture_size(const std::string& name, const Size& size);

}  // namespace anamorph
