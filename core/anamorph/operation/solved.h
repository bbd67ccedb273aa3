// SPDX-License-Identifier: Apache-2.0
// What operations that draw a Picture share.
#pragma once

#include <memory>
#include <utility>

#include "anamorph/image/picture.h"
#include "anamorph/operation/operation.h"

namespace anamorph {

inline PixelKind pixels_of(Output output) {
    switch (output) {
        case Output::stmap:
            return PixelKind::point;
        case Output::error:
        case Output::bound:
            return PixelKind::value;
        default:
            return PixelKind::color;
    }
}

/// A reprojection, a mesh warp, a morph: what has a picture().
template <class Solver>
class Solved final : public SolvedPicture {
  public:
    /// What it says of itself beyond what every picture reached.
    using More = Attributes (*)(const Solver& solver, const ParallelFor& parallel_for);

    explicit Solved(Solver solver, More more = nullptr, bool by_drawing = false)
        : m_solver(std::move(solver)), m_more(more), m_by_drawing(by_drawing) {}

    Attributes reached(const ParallelFor& parallel_for) const override {
        const Reached reached = m_solver.picture().reached(parallel_for);
        Attributes all = {{"anamorph:max_error", reached.max_error},
                          {"anamorph:exact_fraction", reached.exact_fraction}};
        if (m_more)
            for (Attribute& attribute : m_more(m_solver, parallel_for)) all.push_back(std::move(attribute));
        return all;
    }
    bool reached_by_drawing() const override { return m_by_drawing; }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        return m_solver.picture().draw(sources, box, view, parallel_for);
    }

  private:
    Solver m_solver;
    More m_more;
    bool m_by_drawing;
};

}  // namespace anamorph
