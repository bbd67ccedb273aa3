// SPDX-License-Identifier: Apache-2.0
// A control mesh that pulls as a formula, cell by cell, for chains of maps. Alone it is drawn by MeshPlan, whose blocks are the
// cells' own polynomials; another map's formula turns these into something else.
#pragma once

#include <concepts>
#include <memory>
#include <mutex>
#include <vector>

#include "anamorph/mesh/hermite.h"
#include "anamorph/mesh/mesh.h"
#include "anamorph/number/rounded.h"
#include "anamorph/plan/costs.h"
#include "anamorph/plan/formula_map.h"

namespace anamorph {

class CellMap {
  public:
    static constexpr PlanCosts kCosts{.bound = 60, .further_bound = 12, .polynomial = 8, .rounding = 10};
    /// The least pixels that cells have on average: below, blocks in one cell would be too small to pay. In small pictures, as
    /// coarse levels are, that is no matter.
    static constexpr int kLeastPixels = 256, kSmallPicture = 1 << 16, kMostInSmall = 1024;

    explicit CellMap(std::shared_ptr<const Mesh> mesh);
    /// Are a mesh's cells large enough?
    static bool serves(const Mesh& mesh);

    // The members that make this a FormulaMap (plan/formula_map.h).

    /// A cell, its map in powers of the distance from a point in it, in pixels, and how far at most that is from the map of the
    /// given numbers.
    struct Local {
        MeshCell cell;
        Point<double> middle;
        Bicubic powers;
        double error;
    };
    Size target_size() const { return m_mesh->from(); }
    Size source_size() const { return m_mesh->to(); }
    /// The pixels whose centres lie in each cell.
    std::vector<Box> target_pieces() const { return m_pieces; }
    SourceEdges source_edges() const { return {}; }
    int source_piece(const Local&) const { return 0; }
    int period() const { return 0; }
    Local local_around(double x, double y, int piece) const;
    Cover cover(const Interval& x, const Interval& y, int piece, const Local& local, bool across_seam) const;

    template <class T>
    Point<T> operator()(const T& x, const T& y, const Local& local) const {
        return polynomial(x, y, local);
    }
    Point<Interval> operator()(const Interval& x, const Interval& y, const Local& local) const;
    /// The error of a cell's polynomial is one as well, of degree 3 in either parameter: such a one that is at most e on [-1, 1]
    /// has coefficients of at most e, 3 e, 2 e and 4 e (Markov), 10 e in all, and one in two parameters 100 e.
    Point<Rounded<double>> operator()(const Rounded<double>& x, const Rounded<double>& y,
                                      const Local& local) const;

    template <RealNumber Real>
    bool exact(const Real& x, const Real& y, int piece, Point<Real>& p, int& source_piece) const {
        source_piece = 0;
        const Point<double> at = this->at(static_cast<double>(x), static_cast<double>(y), piece);
        p = {Real(at.x), Real(at.y)};
        return is_near(at);
    }
    /// MapLink::jacobian(): the linear terms of the map in powers of the distance from the point.
    Jacobian jacobian(double x, double y, int piece) const {
        const Bicubic powers = local_around(x, y, piece).powers;
        return {powers.x[1][0], powers.y[1][0], powers.x[0][1], powers.y[0][1]};
    }
    template <class Real>
    double exact_error(const Interval& x, const Interval& y, int, double off = 0) const {
        return exact_error(x, y, off);
    }

  private:
    /// The map, from few products of its parameters.
    template <class T>
    static Point<T> polynomial(const T& x, const T& y, const Local& local) {
        const T s = x - local.middle.x, t = y - local.middle.y, s2 = square(s), t2 = square(t);
        const T s3 = s2 * s, t3 = t2 * t;
        const auto sum = [&](const double(&c)[4][4]) {
            const auto row = [&](int i) { return t * c[i][1] + t2 * c[i][2] + t3 * c[i][3] + c[i][0]; };
            return row(0) + row(1) * s + row(2) * s2 + row(3) * s3;
        };
        return {sum(local.powers.x), sum(local.powers.y)};
    }
    /// Is a point within what places are kept of?
    static bool is_near(const Point<double>& p);
    double exact_error(const Interval& x, const Interval& y, double off) const;

    /// What is made of a cell.
    struct Form {
        MeshCell cell;
        Patch patch;
        Bicubic powers;   ///< of its parameters
        double rounding;  ///< double_rounding()
    };
    Form form_of(const MeshCell& cell) const;
    Local local_of(const Form& form, double x, double y) const;
    /// Those of pieces, each made when it is first asked for.
    struct Kept {
        std::once_flag once;
        Form form;
    };
    /// Calls body(form) of the cell that a point is evaluated in, which may be that of `piece`.
    template <class Body>
    auto with_form(double x, double y, int piece, const Body& body) const {
        const MeshCell cell = m_mesh->cell_at(x, y), &own = m_cells[static_cast<std::size_t>(piece)];
        if (cell.level != own.level || cell.column != own.column || cell.row != own.row)
            return body(form_of(cell));
        Kept& kept = (*m_kept)[static_cast<std::size_t>(piece)];
        std::call_once(kept.once, [&] { kept.form = form_of(cell); });
        return body(static_cast<const Form&>(kept.form));
    }
    /// Mesh::at(), the same bits.
    Point<double> at(double x, double y, int piece) const {
        return with_form(x, y, piece, [&](const Form& form) { return m_mesh->at(form.patch, x, y); });
    }

    std::shared_ptr<const Mesh> m_mesh;
    std::vector<Box> m_pieces;
    std::vector<MeshCell> m_cells;              ///< of the pieces
    std::shared_ptr<std::vector<Kept>> m_kept;  ///< of the pieces
};

}  // namespace anamorph
