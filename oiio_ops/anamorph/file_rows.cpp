// SPDX-License-Identifier: Apache-2.0
#include "anamorph/file_rows.h"

#include <algorithm>
#include <string_view>

#include "anamorph/error.h"
#include "anamorph/file_names.h"
#include "anamorph/image_source.h"

namespace anamorph {
namespace {

constexpr int kRows = 64;      ///< decoded at a time: whole strips and blocks of most formats
constexpr int kMostOpen = 64;  ///< files kept open between two reads
std::atomic<int> open_files{0};

std::size_t bytes_of(const OIIO::ImageSpec& spec, const FileRows::Pixels& pixels) {
    return static_cast<std::size_t>(spec.image_pixels()) *
           static_cast<std::size_t>(pixels.channels * size_of(pixels.type));
}

}  // namespace

int FileRows::unit_of(const OIIO::ImageSpec& spec) {
    if (spec.tile_width == 0) return kRows;
    return std::max(1, kRows / spec.tile_height) * spec.tile_height;
}

FileRows::FileRows(Opener open, const std::string& file, int subimage, const OIIO::ImageSpec& spec,
                   const Pixels& pixels, std::unique_ptr<OIIO::ImageInput> opened)
    : m_open(std::move(open)),
      m_file(file),
      m_state(content_state(file)),
      m_subimage(subimage),
      m_spec(spec),
      m_format(pixels.format),
      m_unit(unit_of(spec)),
      m_pages(bytes_of(spec, pixels)),
      m_view(packed_view<const std::byte>(m_pages.data(), pixels.type, spec.width, spec.height,
                                          pixels.channels)) {
    if (!opened || open_files >= kMostOpen) return;
    ++open_files;
    m_input = std::move(opened);
}

FileRows::~FileRows() {
    if (m_input) --open_files;
}

void FileRows::need(int first, int end) {
    if (has(first, end)) return;
    const std::lock_guard lock(m_mutex);
    if (has(first, end)) return;
    first = first / m_unit * m_unit;
    end = std::min((end + m_unit - 1) / m_unit * m_unit, m_spec.height);
    const int have = m_first, until = m_end;
    if (until == 0) {
        decode(first, end);
        m_first.store(first, std::memory_order_release);
        m_end.store(end, std::memory_order_release);
        return;
    }
    if (first < have) {
        // Twice as many rows each time: a format without a way back begins anew.
        first = above(std::max(0, std::min(first, have - (until - have)) / m_unit * m_unit));
        decode(first, have);
        m_first.store(first, std::memory_order_release);
    }
    if (end > until) {
        decode(until, end);
        m_end.store(end, std::memory_order_release);
    }
}

int FileRows::above(int first) {
    if (!m_input) {
        m_input = m_open();
        m_next = 0;
        if (!m_input) return first;
        ++open_files;
    }
    const std::string_view format = m_input->format_name();
    return format == "png" || format == "jpeg" ? first / 2 / m_unit * m_unit : first;
}

void FileRows::decode(int first, int end) {
    if (!m_failure.empty()) throw Error(m_failure);
    std::unique_ptr<OIIO::ImageInput> input;
    // Not every reader finds its way back; one that has read no row can begin anywhere.
    if (m_input && (m_next == 0 || first == m_next)) {
        --open_files;
        input = std::move(m_input);
    } else {
        input = m_open();
    }
    if (!input) throw Error(OIIO::geterror());
    const bool is_there = input->seek_subimage(m_subimage, 0);
    const OIIO::ImageSpec& spec = input->spec();
    const std::string state = content_state(m_file);
    if (!is_there || spec.width != m_spec.width || spec.height != m_spec.height ||
        spec.nchannels != m_spec.nchannels || spec.tile_height != m_spec.tile_height ||
        (!state.empty() && state != m_state))
        throw Error("has changed since it was opened");
    // OpenImageIO's pool must not be waited on inside a read of its host.
    input->threads(1);
    std::byte* const to = m_pages.data() + first * m_view.row_stride;
    const bool done = spec.tile_width > 0 ? input->read_tiles(m_subimage, 0, spec.x, spec.x + spec.width,
                                                              spec.y + first, spec.y + end, spec.z,
                                                              spec.z + 1, 0, spec.nchannels, m_format, to)
                                          : input->read_scanlines(m_subimage, 0, spec.y + first, spec.y + end,
                                                                  spec.z, 0, spec.nchannels, m_format, to);
    // Some readers say that all went well and leave an error.
    if (!done || input->has_error()) {
        const std::string why = input->geterror();
        m_failure = why.empty() ? "cannot be read" : why.substr(0, why.find('\n'));
        throw Error(m_failure);
    }
    // Of two readers the one that is farther down is kept: rows above it are there.
    if (end == m_spec.height || (m_input ? m_next > end : open_files >= kMostOpen)) return;
    if (!m_input) ++open_files;
    m_input = std::move(input);
    m_next = end;
}

}  // namespace anamorph
