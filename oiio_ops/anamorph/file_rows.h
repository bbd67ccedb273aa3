// SPDX-License-Identifier: Apache-2.0
// The pixels of a file, decoded once and kept: an ImageCache would hold a file without tiles as one tile, and in float
// where its host asks for that, or what the cache has no type for.
#pragma once

#include <OpenImageIO/imageio.h>

#include <atomic>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <string>

#include "anamorph/image/pages.h"
#include "anamorph/image/view.h"

namespace anamorph {

/// A subimage of a file, row by row, in the file's own order and in a packed type. Rows are decoded when they are
/// first needed, together with those between them and the rows that are there, so that memory and time are those of
/// the rows that a view reaches; a format that can only be decoded from its beginning is stopped after the last of them.
/// Thread safe.
class FileRows {
  public:
    using Opener = std::function<std::unique_ptr<OIIO::ImageInput>()>;

    /// The numbers that are kept of each pixel: so many of a type, decoded as `format`; unknown: as the file
    /// stores them.
    struct Pixels {
        PixelType type;
        int channels;
        OIIO::TypeDesc format;
    };
    /// The number of rows of a file that are decoded together: 64, or as many as whole rows of its tiles have.
    static int unit_of(const OIIO::ImageSpec& spec);

    /// Reads nothing yet. `file`: its name. `spec`: that of the file when it was opened. `opened`: the file, where it is open
    /// already, or null. Throws std::bad_alloc.
    FileRows(Opener open, const std::string& file, int subimage, const OIIO::ImageSpec& spec,
             const Pixels& pixels, std::unique_ptr<OIIO::ImageInput> opened = nullptr);
    ~FileRows();
    FileRows(const FileRows&) = delete;
    FileRows& operator=(const FileRows&) = delete;

    /// The whole image; only rows that need() was asked for hold pixels.
    const ConstImageView& view() const { return m_view; }
    /// Decodes rows first to end - 1 where they are not there yet. Throws Error, the reason alone, where the file cannot be
    /// opened, is another one by now, or is damaged; what was damaged once is not tried again.
    void need(int first, int end);

  private:
    bool has(int first, int end) const {
        return m_first.load(std::memory_order_acquire) <= first &&
               end <= m_end.load(std::memory_order_acquire);
    }
    /// Where decoding begins anew for rows from `first` on, above those that are there. A format that is passed through from its top
    /// costs the same wherever its rows begin to be kept, and a view that goes up once more as much again: half of those above `first`
    /// are kept as well.
    int above(int first);
    void decode(int first, int end);

    const Opener m_open;
    const std::string m_file, m_state;
    const int m_subimage;
    const OIIO::ImageSpec m_spec;
    const OIIO::TypeDesc m_format;
    const int m_unit;  ///< unit_of()
    const Pages m_pages;
    const ConstImageView m_view;
    /// The rows that are decoded. The first is set before the end, so that a reader who sees the end sees it.
    std::atomic<int> m_first{std::numeric_limits<int>::max()}, m_end{0};
    std::mutex m_mutex;
    std::unique_ptr<OIIO::ImageInput> m_input;  ///< kept open where more rows may follow, from m_next on
    int m_next = 0;                             ///< the row that m_input decodes next
    std::string m_failure;                      ///< why nothing more can be decoded
};

}  // namespace anamorph
