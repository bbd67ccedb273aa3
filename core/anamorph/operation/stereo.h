// SPDX-License-Identifier: Apache-2.0
// Sources that hold a picture for each of two eyes, and pictures of the same kind.
#pragma once

#include <memory>

#include "anamorph/operation/operation.h"

namespace anamorph {

namespace rows {

/// The rows stereo and eye.
ParameterTable stereo();

}  // namespace rows

/// The two eyes of a source, and those that are drawn.
class Eyes {
  public:
    /// Throws Error.
    Eyes(const ParameterValues& values, const SourceFacts& facts);

    /// What is known of one eye's part of the source.
    SourceFacts facts_of_one() const;
    /// The pictures of all eyes that are drawn, of pictures of one of them.
    std::unique_ptr<const Pictures> pictures(std::unique_ptr<const Pictures> of_one) const;

    bool are_above() const { return m_are_above; }
    int first() const { return m_first; }
    int count() const { return m_count; }
    /// The i-th of `count` equal parts of a picture.
    Box part(const Size& size, int i, int count) const;

  private:
    SourceFacts m_facts;
    bool m_are_two, m_are_above;
    int m_first = 0, m_count = 1;
};

}  // namespace anamorph
