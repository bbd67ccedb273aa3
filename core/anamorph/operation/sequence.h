// SPDX-License-Identifier: Apache-2.0
// Films: the frames that are drawn, and the numbers that key frames give to an operation's parameters at each.
#pragma once

#include <vector>

#include "anamorph/deform/key_frames_file.h"
#include "anamorph/operation/operation.h"

namespace anamorph {

namespace rows {

/// The rows of a film but for `frame`: frames and keys. `numbers`: what may be keyed.
ParameterTable sequence(const std::string& numbers);

}  // namespace rows

/// The frames of a film, by the rows frames, frame and keys.
class Sequence {
  public:
    /// A host that asks how many subimages there are looks at each.
    static constexpr int kMostFrames = 100'000;

    /// Reads the key frames. Throws Error.
    explicit Sequence(const OperationInput& input);

    int frames() const { return m_frames; }
    /// The time of the i-th frame, counted from 0.
    double time_of(int i) const { return m_first + i; }
    bool has_keys() const { return !m_keys.empty(); }
    bool is_film() const { return m_frames > 1 || has_keys(); }
    /// The values at a time.
    ParameterValues values_at(double time) const;

  private:
    void read_keys(const std::string& text, const std::string& name);
    void choose_frames();

    ParameterValues m_values;
    int m_frames = 1;
    double m_first = 0;
    std::vector<NamedKeyFrames> m_keys;
};

}  // namespace anamorph
