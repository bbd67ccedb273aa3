// SPDX-License-Identifier: Apache-2.0
// Rectangles in the plane, found by place: a binary tree of bounds.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace anamorph {

/// A closed rectangle.
struct Bounds {
    double x0, y0, x1, y1;

    bool meets(const Bounds& b) const { return x0 <= b.x1 && b.x0 <= x1 && y0 <= b.y1 && b.y0 <= y1; }
    void add(const Bounds& b) {
        x0 = std::min(x0, b.x0);
        y0 = std::min(y0, b.y0);
        x1 = std::max(x1, b.x1);
        y1 = std::max(y1, b.y1);
    }
};

class BoundsTree {
  public:
    BoundsTree() = default;
    explicit BoundsTree(std::vector<Bounds> items) : m_items(std::move(items)), m_order(m_items.size()) {
        for (std::size_t i = 0; i < m_order.size(); ++i) m_order[i] = static_cast<std::int32_t>(i);
        if (!m_items.empty()) build(0, m_order.size());
    }

    /// Calls body(index) for every rectangle that meets `place`, in an order that depends on nothing else.
    template <class Body>
    void each(const Bounds& place, const Body& body) const {
        for (std::size_t n = 0; n < m_nodes.size();) {
            const Node& node = m_nodes[n];
            const bool meets = node.bounds.meets(place);
            if (meets && node.last > node.first)
                for (std::size_t i = node.first; i < node.last; ++i) {
                    const std::int32_t item = m_order[i];
                    if (m_items[static_cast<std::size_t>(item)].meets(place)) body(item);
                }
            n = meets ? n + 1 : node.next;
        }
    }

  private:
    static constexpr std::size_t kLeaf = 4;
    /// A node of the tree. Nodes are in depth-first order: the first child follows its parent; `next` is the
    /// node after all descendants.
    struct Node {
        Bounds bounds;
        std::size_t next;
        std::size_t first = 0, last = 0;  ///< range of the order; empty for an inner node
    };

    void build(std::size_t first, std::size_t last) {
        Bounds all = item(first), centers = center(first);
        for (std::size_t i = first + 1; i < last; ++i) {
            all.add(item(i));
            centers.add(center(i));
        }
        const std::size_t self = m_nodes.size();
        m_nodes.push_back({all, 0});
        if (last - first <= kLeaf) {
            m_nodes[self].first = first;
            m_nodes[self].last = last;
        } else {
            const bool wide = centers.x1 - centers.x0 >= centers.y1 - centers.y0;
            const std::size_t middle = (first + last) / 2;
            const auto at = [&](std::size_t i) { return m_order.begin() + static_cast<std::ptrdiff_t>(i); };
            std::nth_element(at(first), at(middle), at(last), [&](std::int32_t a, std::int32_t b) {
                const Bounds &p = m_items[static_cast<std::size_t>(a)],
                             &q = m_items[static_cast<std::size_t>(b)];
                const double ca = wide ? p.x0 + p.x1 : p.y0 + p.y1, cb = wide ? q.x0 + q.x1 : q.y0 + q.y1;
                return ca != cb ? ca < cb : a < b;
            });
            build(first, middle);
            build(middle, last);
        }
        m_nodes[self].next = m_nodes.size();
    }
    const Bounds& item(std::size_t i) const { return m_items[static_cast<std::size_t>(m_order[i])]; }
    Bounds center(std::size_t i) const {
        const Bounds& b = item(i);
        return {b.x0 + b.x1, b.y0 + b.y1, b.x0 + b.x1, b.y0 + b.y1};
    }

    std::vector<Bounds> m_items;
    std::vector<std::int32_t> m_order;
    std::vector<Node> m_nodes;
};

}  // namespace anamorph
