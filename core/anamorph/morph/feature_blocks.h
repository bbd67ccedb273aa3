// SPDX-License-Identifier: Apache-2.0
// The maps of a morph (morph/feature_lines.h) in blocks, one layer a shape: the members that all ways to plan
// them share.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "anamorph/morph/feature_lines.h"
#include "anamorph/plan/block.h"

namespace anamorph {

class FeatureBlocks : public BlockMap {
  public:
    using BlockMap::exact;
    /// The shapes that the layers show.
    const std::vector<int>& shapes() const { return m_shapes; }

    bool exact(double x, double y, int piece, Point<double>& source_point,
               int& source_piece) const noexcept override;
    bool seen(double x, double y, int piece) const noexcept override;
    bool truth(double x, double y, int piece, Point<DoubleDouble>& source_point,
               int& source_piece) const noexcept override;
    void exact_rows(const Block& block, int begin, int end, const DoubleRows& to) const noexcept override;
    Jacobian jacobian(double x, double y, int piece) const noexcept override;

  protected:
    static constexpr int kRegion = 128;

    /// Keeps a reference to the map. `overscan`: pixels beyond the edges of its picture.
    FeatureBlocks(const FeatureMap& map, std::vector<int> shapes, const Size& overscan);

    const FeatureMap& map() const { return m_map; }
    int shape(int layer) const { return m_shapes[static_cast<std::size_t>(layer)]; }

    /// Calls body(box) for the squares of a region of which each is one block.
    template <class Body>
    static void each_square(const Box& region, const Body& body) {
        constexpr int kSide = Block::kMaxSide;
        for (int y = region.y0; y < region.y1; y += kSide)
            for (int x = region.x0; x < region.x1; x += kSide)
                body(intersection({x, y, x + kSide, y + kSide}, region));
    }
    /// Writes a block for every layer. Its bound is below `tol` where that can be told.
    void add_exact(const Box& box, double tol, Blocks& blocks) const;

  private:
    /// Exact points of a layer's block, found with those of the layer before.
    struct Waiting {
        Box box;
        int begin, end, layer;
        std::ptrdiff_t stride;
        std::vector<double> x, y;

        Waiting(const Box& of, int from, int to, int of_layer)
            : box(of), begin(from), end(to), layer(of_layer), stride(of.width() + 16) {
            const auto room = static_cast<std::size_t>(stride) * static_cast<std::size_t>(to - from);
            x.resize(room);
            y.resize(room);
        }
    };
    /// The most threads that wait: with more, some points are computed twice.
    static constexpr std::size_t kMostWaiting = 64;

    std::unique_ptr<Waiting> room_for_next(const Block& block, int begin, int end) const noexcept;
    std::unique_ptr<Waiting> take_waiting(const Block& block, int begin, int end) const noexcept;
    void keep(std::unique_ptr<Waiting> rows) const noexcept;

    const FeatureMap& m_map;
    std::vector<int> m_shapes;
    mutable std::mutex m_mutex;
    mutable std::vector<std::unique_ptr<Waiting>> m_waiting;
};

}  // namespace anamorph
