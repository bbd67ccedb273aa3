// SPDX-License-Identifier: Apache-2.0
// Proves nothing: numbers are moved from table to table; morph/near_far_lanes.cpp bounds them.
#include "anamorph/morph/near_far_candidates.h"

namespace anamorph::near_far {

void Candidates::take(const std::vector<FieldLine>& all, const std::vector<float>& slopes) {
    reset(all.size());
    own_table();
    for (std::size_t i = 0; i < all.size(); ++i) {
        const FieldLine& l = all[i];
        m_own_ids[i] = static_cast<std::int32_t>(i);
        m_factor[i] = l.factor;
        const auto put = [&](std::size_t f, float v) { m_own[f * m_stride + i] = v; };
        put(LineTable::kBefore, l.before);
        put(LineTable::kBehind, l.behind);
        put(LineTable::kBeside, l.beside);
        put(LineTable::kAlongX, l.along_x);
        put(LineTable::kAlongY, l.along_y);
        put(LineTable::kSlope, slopes[i]);
        for (std::size_t c = 0; c < kComponents; ++c) {
            put(LineTable::kAt + c, l.at[c]);
            put(LineTable::kRight + c, l.right[c]);
            put(LineTable::kDown + c, l.down[c]);
        }
    }
}

void Candidates::take_near(const Candidates& from) {
    const auto count = static_cast<std::size_t>(from.near_count);
    if (padded(count) == from.m_stride) {
        reset(from.m_count);
        m_table = from.m_table;
        m_ids = from.m_ids;
        for (std::size_t j = 0; j < count; ++j) {
            const auto i = static_cast<std::size_t>(from.near[j]);
            m_factor[i] = from.m_factor[i];
        }
        return;
    }
    reset(count);
    own_table();
    for (std::size_t f = 0; f < LineTable::kFields; ++f)
        for (std::size_t j = 0; j < count; ++j)
            m_own[f * m_stride + j] =
                from.m_table[f * from.m_stride + static_cast<std::size_t>(from.near[j])];
    for (std::size_t j = 0; j < count; ++j) {
        const auto i = static_cast<std::size_t>(from.near[j]);
        m_factor[j] = from.m_factor[i];
        m_own_ids[j] = from.m_ids[i];
    }
}

simd::LineSums Candidates::select(const simd::LineBounds& bounds, float spread, float unit) {
    const simd::Selection s = simd::select_lines(table(), bounds, reach(), error(), spread, unit, array(11),
                                                 near.data(), far.data());
    near_count = s.near;
    far_count = s.far;
    return s.sums;
}

void Candidates::reset(std::size_t count) {
    m_count = count;
    m_stride = padded(count);
    if (m_bounds.size() < kBounds * m_stride) m_bounds.resize(kBounds * m_stride);
    if (near.size() < m_stride + 16) {
        near.resize(m_stride + 16);
        far.resize(m_stride + 16);
    }
    m_factor.assign(m_stride, 0.0f);
}

void Candidates::own_table() {
    if (m_own.size() < LineTable::kFields * m_stride) m_own.resize(LineTable::kFields * m_stride);
    m_own_ids.resize(m_count);
    // Lines of factor 0 fill up the last vector, far from everything.
    for (std::size_t f = 0; f < LineTable::kFields; ++f)
        for (std::size_t i = m_count; i < m_stride; ++i)
            m_own[f * m_stride + i] = f == LineTable::kBefore ? 1e6f : f == LineTable::kAlongX ? 1.0f : 0.0f;
    m_table = m_own.data();
    m_ids = m_own_ids.data();
}

}  // namespace anamorph::near_far
