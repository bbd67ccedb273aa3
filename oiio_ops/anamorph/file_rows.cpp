// SPDX-License-Identifier: Apache-2.0
#include "anamorph/file_rows.h"

#include <algorithm>

#include "anamorph/error.h"
#include "anamorph/image_source.h"

namespace anamorph {
namespace {

constexpr int kRows = 64;      ///< decoded at a time: whole strips and blocks of most formats
constexpr int kMostOpen = 64;  ///< files kept open between two reads
std::atomic<int> open_files{0};

std::size_t bytes_of(const OIIO::ImageSpec& spec, PixelType type) {
    return static_cast<std::size_t>(spec.image_pixels()) *
           static_cast<std::size_t>(spec.nchannels * size_of(type));
}

}  // namespace

FileRows::FileRows(Opener open, const OIIO::ImageSpec& spec, PixelType type)
    : m_open(std::move(open)),
      m_spec(spec),
      m_pages(bytes_of(spec, type)),
      m_view(packed_view<const std::byte>(m_pages.data(), type, spec.width, spec.height, spec.nchannels)) {}

FileRows::~FileRows() {
    if (m_input) --open_files;
}

void FileRows::need(int first, int end) {
    if (has(first, end)) return;
    const std::lock_guard lock(m_mutex);
    if (has(first, end)) return;
    first = first / kRows * kRows;
    end = std::min((end + kRows - 1) / kRows * kRows, m_spec.height);
    const int have = m_first, until = m_end;
    if (until == 0) {
        decode(first, end);
        m_first.store(first, std::memory_order_release);
        m_end.store(end, std::memory_order_release);
        return;
    }
    if (first < have) {
        // Twice as many rows each time: a format without a way back begins anew.
        first = std::max(0, std::min(first, have - (until - have)));
        decode(first, have);
        m_first.store(first, std::memory_order_release);
    }
    if (end > until) {
        decode(until, end);
        m_end.store(end, std::memory_order_release);
    }
}

void FileRows::decode(int first, int end) {
    if (!m_failure.empty()) throw Error(m_failure);
    if (m_input) --open_files;
    std::unique_ptr<OIIO::ImageInput> input = m_input ? std::move(m_input) : m_open();
    const auto fail = [&](const std::string& why) {
        m_failure = why.empty() ? "cannot be read" : why;
        throw Error(m_failure);
    };
    if (!input) fail(OIIO::geterror());
    const OIIO::ImageSpec& spec = input->spec();
    if (spec.width != m_spec.width || spec.height != m_spec.height || spec.nchannels != m_spec.nchannels)
        fail("has changed since it was opened");
    // OpenImageIO's pool must not be waited on inside a read of its host.
    input->threads(1);
    if (!input->read_scanlines(0, 0, spec.y + first, spec.y + end, spec.z, 0, spec.nchannels,
                               oiio_type(m_view.type), m_pages.data() + first * m_view.row_stride))
        fail(input->geterror());
    if (end == m_spec.height || open_files >= kMostOpen) return;
    ++open_files;
    m_input = std::move(input);
}

}  // namespace anamorph
