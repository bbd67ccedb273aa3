// SPDX-License-Identifier: Apache-2.0
// Operations on arrays in memory, for bindings of any language: arrays in, arrays out, and no host's types between.
#pragma once

#include <OpenImageIO/imagebuf.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/buffer_picture.h"
#include "anamorph/operation/operation.h"
#include "anamorph/plan/block.h"

namespace anamorph {

/// Pixels in memory, row by row from the top; the channels of a pixel stand next to each other, strides are in bytes.
struct ArrayPixels {
    void* data = nullptr;
    OIIO::TypeDesc type;
    std::int64_t width = 0, height = 0, channels = 0;
    std::ptrdiff_t pixel_stride = 0, row_stride = 0;
};

/// What an array does not say of itself.
struct ArrayFacts {
    std::vector<std::string> channels;  ///< their names; by default Y, RGB or RGBA
    bool unassociated = false;          ///< are colours not yet multiplied by alpha?
    int x = 0, y = 0;                   ///< the upper left corner of its pixels
    Box display;                        ///< the display window; where it is empty, all of its pixels
    Attributes metadata;
};

/// An image that operations read: an array, which must outlive it, or a file.
class ArraySource {
  public:
    ArraySource(const ArrayPixels& pixels, const ArrayFacts& facts);
    explicit ArraySource(const std::string& file);

    const OIIO::ImageBuf& image() const { return m_image; }

  private:
    OIIO::ImageBuf m_image;
};

/// Side files that are not files: texts and arrays by the names that values give them.
struct ArrayFiles {
    std::map<std::string, std::string> texts;
    std::map<std::string, std::shared_ptr<const ArraySource>> images;
};

/// Points of a picture or of its source, in pixels, x right, y down, the centre of the first pixel at (0.5, 0.5).
struct PointArrays {
    const double *x, *y;
    std::int64_t count;
};

/// A picture of arrays and of other such pictures, which live as long as it does.
class ArrayPicture {
  public:
    struct Input {
        std::shared_ptr<const ArraySource> array = {};
        std::shared_ptr<const ArrayPicture> picture = {};
    };
    /// Opens a picture of an operation. Throws Error.
    ArrayPicture(const Operation& operation, const std::vector<Assignment>& values,
                 const std::vector<Input>& sources, const ArrayFiles& files, int subimage,
                 const ParallelFor& parallel_for);

    const OIIO::ImageSpec& spec() const { return m_picture->spec(); }
    PixelKind pixels() const { return m_picture->pixels(); }
    int subimages() const { return m_picture->subimages(); }
    const Attributes& said() const { return m_picture->said(); }
    Attributes reached(const ParallelFor& parallel_for) const { return m_picture->reached(parallel_for); }

    /// Draws the pixels of a picture from (x, y) on, counted as its windows are, into an array as large as what is drawn, of any type.
    /// `progress`, where there is one, is called with the number of rows that were drawn since. Throws Error.
    void draw(const ArrayPixels& to, int x, int y, const ParallelFor& parallel_for,
              const std::function<void(int rows)>& progress = {}) const;

    /// The source points of points of the picture, by the formula in double: NaN where there is none. Throws Error where the picture is
    /// not one map of one source.
    void source_points(const PointArrays& points, double* x, double* y,
                       const ParallelFor& parallel_for) const;
    /// The derivatives of the map there, four numbers a point: d(source x)/dx, d(source x)/dy, d(source y)/dx, d(source y)/dy; NaN
    /// where there is no source point.
    void jacobians(const PointArrays& points, double* derivatives, const ParallelFor& parallel_for) const;

  private:
    /// The one map of the picture. Throws Error where there are several, or none.
    const BlockMap& map() const;
    /// Calls `found(i, map, at, piece)` for each point, as the map counts it; piece -1 beside the picture.
    template <class Found>
    void each(const PointArrays& points, const ParallelFor& parallel_for, const Found& found) const;

    const Operation* m_operation;
    std::vector<Input> m_sources;
    ArrayFiles m_files;
    std::shared_ptr<const BufferPicture> m_picture;
};

}  // namespace anamorph
