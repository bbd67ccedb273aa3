// SPDX-License-Identifier: Apache-2.0
#include "anamorph/panorama/panorama.h"

#include "anamorph/error.h"
#include "anamorph/number/hypot.h"
#include "anamorph/number/quarter_turns.h"

namespace anamorph {
namespace {

using Turn = std::array<std::array<Constant, 3>, 3>;

/// Sine and cosine of an angle in degrees. A turn is taken off, then right angles, all of them exactly: no
/// angle is too large, and multiples of 90 degrees give 0 and 1.
struct Angle {
    DoubleDouble sin, cos;

    explicit Angle(double degrees) {
        const double angle = std::fmod(degrees, 360.0), quarters = std::round(angle / 90);
        sin_cos(DoubleDouble(angle - 90 * quarters) * DoubleDouble::pi() / 180, sin, cos);
        turn_by_quarters(static_cast<long long>(quarters), sin, cos);
    }
};

/// yaw * pitch * roll, by columns.
Turn turn_of(const Orientation& orientation) {
    const Angle y(orientation.yaw), p(orientation.pitch), r(orientation.roll);
    // A sine or cosine is off by its argument's rounding and libm's, two products and a sum by a unit each:
    // 32 units of each term.
    const auto sum = [](DoubleDouble a, DoubleDouble b) {
        return Constant(a + b, static_cast<double>(fabs(a) + fabs(b)) * 32 * Rounded<DoubleDouble>::kUnit);
    };
    const auto product = [](DoubleDouble a) { return Constant(a); };
    return {{{sum(y.cos * r.cos, y.sin * p.sin * r.sin), product(p.cos * r.sin),
              sum(-y.sin * r.cos, y.cos * p.sin * r.sin)},
             {sum(-y.cos * r.sin, y.sin * p.sin * r.cos), product(p.cos * r.cos),
              sum(y.sin * r.sin, y.cos * p.sin * r.cos)},
             {product(y.sin * p.cos), product(-p.sin), product(y.cos * p.cos)}}};
}

double error_of(const Constant& constant) {
    return constant.as<Rounded<DoubleDouble>>().error;
}

/// An entry that is off by `error`; where nothing is left of it, it is known no better than that it is small.
Constant constant_of(DoubleDouble value, double error) {
    return Constant(value == 0 ? error * 0x1p-20 : value, 2 * error);
}

/// The inverse of the one times the other, by columns: dot products of their columns. Sums of three products are off by
/// 3 units of each in DoubleDouble, and by what the entries are off, of which products of two are next to nothing.
Turn relative(const Turn& held, const Turn& look) {
    Turn turn;
    for (std::size_t column = 0; column < 3; ++column)
        for (std::size_t row = 0; row < 3; ++row) {
            DoubleDouble sum = 0, size = 0, off = 0;
            for (std::size_t i = 0; i < 3; ++i) {
                const Constant &a = held[row][i], &b = look[column][i];
                const DoubleDouble product = a.precise() * b.precise();
                sum += product;
                size += fabs(product);
                off += fabs(a.precise()) * error_of(b) + fabs(b.precise()) * error_of(a);
            }
            const double error = static_cast<double>(off + size * 6 * Rounded<DoubleDouble>::kUnit);
            turn[column][row] = constant_of(sum, error);
        }
    return turn;
}

/// A turn after that of a face, whose axes are axes of the cube, one way or the other.
Turn of_face(const Turn& turn, const glm::dmat3& face) {
    Turn all;
    for (std::size_t column = 0; column < 3; ++column)
        for (std::size_t i = 0; i < 3; ++i) {
            const double along = face[static_cast<int>(column)][static_cast<int>(i)];
            for (std::size_t row = 0; along != 0 && row < 3; ++row)
                all[column][row] = Constant(along * turn[i][row].precise(), error_of(turn[i][row]));
        }
    return all;
}

/// The entry of I - c n^T times a direction: of c, `camera`, and of the direction by `row`.
template <class T>
T transferred(double camera, const std::array<Constant, 3>& normal, const std::array<Constant, 3>& direction,
              std::size_t row) {
    const auto along = [&](std::size_t i) { return T(normal[i].as<T>()) * T(direction[i].as<T>()); };
    return T(direction[row].as<T>()) - T(camera) * (along(0) + along(1) + along(2));
}

/// (I - c n^T) of the columns of a turn.
Turn transferred(const PlaneTransfer& transfer, const Turn& turn) {
    const std::array<Constant, 3> normal = turn_of({transfer.yaw, transfer.pitch})[2];
    Turn all;
    for (std::size_t column = 0; column < 3; ++column)
        for (std::size_t row = 0; row < 3; ++row) {
            const double camera = transfer.camera[row];
            const auto value = transferred<DoubleDouble>(camera, normal, turn[column], row);
            const double error = transferred<Rounded<DoubleDouble>>(camera, normal, turn[column], row).error;
            all[column][row] = constant_of(value, error);
        }
    return all;
}

glm::dmat3 matrix_of(const Turn& turn) {
    glm::dmat3 matrix;
    for (int column = 0; column < 3; ++column)
        for (int row = 0; row < 3; ++row)
            matrix[column][row] =
                turn[static_cast<std::size_t>(column)][static_cast<std::size_t>(row)].value();
    return matrix;
}

}  // namespace

glm::dmat3 rotation(const Orientation& orientation) {
    return matrix_of(turn_of(orientation));
}

glm::dvec3 PlaneTransfer::normal() const {
    return rotation({yaw, pitch})[2];
}

namespace {

/// How much longer than a direction what a camera sees of it may be. Throws Error where the camera is in its plane.
double most_stretch(const PlaneTransfer& transfer) {
    constexpr double kFarthest = 1e6, kLeast = 1e-6;
    const auto [x, y, z] = transfer.camera;
    const double far = hypot(x, y, z);
    const double from_plane = std::fabs(1 - glm::dot(transfer.normal(), glm::dvec3(x, y, z)));
    if (!(far <= kFarthest && from_plane >= kLeast))
        throw Error("TrX, TrY, TrZ", std::to_string(x) + ", " + std::to_string(y) + ", " + std::to_string(-z),
                    "must be a place at most 1e6 away, and at least 1e-6 from the plane 1 away, which Tpy "
                    "and Tpp turn");
    return (1 + far) * rounded_detail::kUp;
}

}  // namespace

Panorama::Panorama(const Chart& source, const Chart& target, const Orientation& orientation,
                   const Orientation& held)
    : m_source(source), m_target(target) {
    const std::pair<const char*, double> angles[] = {{"yaw", orientation.yaw},
                                                     {"pitch", orientation.pitch},
                                                     {"roll", orientation.roll},
                                                     {"srcyaw", held.yaw},
                                                     {"srcpitch", held.pitch},
                                                     {"srcroll", held.roll},
                                                     {"srccrop", held.ahead},
                                                     {"lens yaw", held.lens[0]},
                                                     {"lens pitch", held.lens[1]},
                                                     {"lens roll", held.lens[2]},
                                                     {"Tpy", held.transfer ? held.transfer->yaw : 0},
                                                     {"Tpp", held.transfer ? held.transfer->pitch : 0}};
    for (const auto& [name, value] : angles)
        if (!std::isfinite(value))
            throw Error(name, std::to_string(value), "must be a finite angle in degrees");
    m_turn = turn_of(orientation);
    if (orientation.face != glm::dmat3(1)) m_turn = of_face(m_turn, orientation.face);
    if (held.transfer) {
        m_local_error = kLocalError * most_stretch(*held.transfer);
        m_turn = transferred(*held.transfer, m_turn);
    }
    if (held.yaw != 0 || held.pitch != 0 || held.roll != 0) m_turn = relative(turn_of(held), m_turn);
    if (held.ahead != 0) m_turn = relative(turn_of({held.ahead}), m_turn);
    if (const auto& [yaw, pitch, roll] = held.lens; yaw != 0 || pitch != 0 || roll != 0)
        m_turn = relative(turn_of({yaw, pitch, roll}), m_turn);
    m_rotation = matrix_of(m_turn);
}

Panorama::Local Panorama::local_around(double x, double y, int piece) const {
    const Ray<double> ray = m_target.ray(x, y, piece);
    return local_around(ray, piece, transform(m_rotation, ray));
}

Panorama::Local Panorama::local_around(double x, double y, int piece, const Ray<double>& source_ray) const {
    return local_around(m_target.ray(x, y, piece), piece, source_ray);
}

Panorama::Local Panorama::local_around(const Ray<double>& target_ray, int piece,
                                       const Ray<double>& source_ray) const {
    Local local;
    // The target's own angles count from this point only where that narrows intervals; its piece is given.
    local.target = m_target.branch_around(target_ray);
    if (local.target.piece != piece) local.target = m_target.branch(piece);
    local.source = m_source.branch_around(source_ray);
    local.rotation = glm::transpose(local.source.axes) * m_rotation * local.target.axes;
    return local;
}

std::vector<Box> Panorama::target_pieces() const {
    std::vector<Box> boxes;
    for (const Piece& piece : m_target.pieces()) boxes.push_back(piece.box);
    return boxes;
}

SourceEdges Panorama::source_edges() const {
    const bool whole = m_source.pieces().size() == 1;
    return {whole && !m_source.closed(), whole && !m_source.reaches_poles()};
}

bool Panorama::ends_by_lens(const Ray<Interval>& ray, const Local& local) const {
    // The lens's formula goes on behind its end; its root does not.
    if (!m_source.lens() || !m_source.lens()->terms().to_observed) return false;
    return m_source.sees_without_lens(ray, local.source.piece).lo > 0;
}

bool Panorama::is_unseen(const Ray<Interval>& ray, const Local& local) const {
    if (m_source.pieces_see_all()) return false;
    if (m_source.pieces().size() == 1) return true;
    // Lenses end a hair farther out than they see, which is more than axes are off.
    const Ray<Interval> r = transform(local.source.axes, ray);
    for (int piece = 0; piece < static_cast<int>(m_source.pieces().size()); ++piece)
        if (piece != local.source.piece && !(seen(r, piece).hi < 0)) return false;
    return true;
}

namespace {

bool one_signed(const Interval& a) {
    return a.lo > 0 || a.hi < 0;
}

}  // namespace

Cover Panorama::target_cover(const Interval& x, const Interval& y, int piece) const {
    const Interval in = m_target.inside(x, y, piece);
    if (in.hi < 0) return Cover::outside;
    return in.lo >= 0 && one_signed(m_target.crease(x, y, piece)) ? Cover::inside : Cover::mixed;
}

Cover Panorama::cover(const Interval& x, const Interval& y, int piece, const Local& local,
                      bool across_seam) const {
    const Cover target = target_cover(x, y, piece);
    return target == Cover::inside ? cover(local_ray(x, y, local), local, across_seam) : target;
}

Cover Panorama::cover(const Ray<Interval>& ray, const Local& local, bool across_seam) const {
    const Interval sees = m_source.sees(ray, local.source.piece);
    if (sees.hi < 0 && is_unseen(ray, local)) return Cover::outside;
    if (!one_signed(m_source.crease(ray))) return Cover::mixed;
    if (!(sees.lo > 0)) return ends_by_lens(ray, local) ? Cover::partial : Cover::mixed;
    if (m_source.counted() == Counted::azimuth) {
        // A branch that is turned serves less than half a turn. None may cross the far side where the image has an edge; what
        // crosses it has angles up to both of its ends.
        if (!m_source.lens() && !(ray.z.lo > 0)) return Cover::mixed;
        const Interval azimuth = atan2(ray.x, ray.z) + local.source.around.angle;
        if (!(m_source.closed() && across_seam) &&
            !(azimuth.lo > -std::numbers::pi && azimuth.hi < std::numbers::pi))
            return Cover::mixed;
    }
    return Cover::inside;
}

template <class T>
T Panorama::seen_by_any(const Ray<T>& ray) const {
    T most = seen(ray, 0);
    for (int i = 1; i < static_cast<int>(m_source.pieces().size()); ++i) most = max(most, seen(ray, i));
    return most;
}

double Panorama::end(double x, double y, int piece) const {
    const double inside = m_target.inside(x, y, piece);
    if (!(inside > 0) || m_source.pieces_see_all()) return inside;
    return std::min(inside, seen_by_any(source_ray(x, y, piece)));
}

Interval Panorama::end(const Interval& x, const Interval& y, int piece) const {
    const Interval inside = m_target.inside(x, y, piece);
    if (!(inside.lo > 0) || m_source.pieces_see_all()) return inside;
    const Interval sees = seen_by_any(source_ray(x, y, piece));
    return {std::min(inside.lo, sees.lo), std::min(inside.hi, sees.hi)};
}

template <class Real>
double Panorama::exact_error(const Interval& x, const Interval& y, int piece, double off) const {
    using R = Rounded<Real>;
    if (!(m_target.inside(x, y, piece).hi >= 0)) return 0;
    return exact_error(source_ray(R(x, 0, off), R(y, 0, off), piece));
}
template double Panorama::exact_error<double>(const Interval&, const Interval&, int, double) const;
template double Panorama::exact_error<DoubleDouble>(const Interval&, const Interval&, int, double) const;

template <class Real>
double Panorama::exact_error(const Ray<Rounded<Real>>& ray) const {
    using R = Rounded<Real>;
    const std::size_t pieces = m_source.pieces().size();
    // Whichever piece may come out as the one that looks most along the ray.
    std::array<R, 6> along;
    double most = -HUGE_VAL;
    for (std::size_t i = 0; i < pieces && pieces > 1; ++i) {
        const glm::dvec3& f = m_source.pieces()[i].toward;
        along[i] = ray.x * f[0] + ray.y * f[1] + ray.z * f[2];
        most = std::max(most, lower_end(along[i]));
    }
    double error = 0;
    for (std::size_t i = 0; i < pieces; ++i) {
        if (pieces > 1 && along[i].range.hi + along[i].error < most) continue;
        if (!m_source.pieces_see_all()) {
            const R sees = seen(ray, static_cast<int>(i));
            if (sees.range.hi + sees.error <= 0) continue;
            if (!(lower_end(sees) > 0)) return HUGE_VAL;
        }
        const Point<R> p = m_source.point(ray, static_cast<int>(i));
        const double distance = kept_error(p);
        if (!(distance <= error)) error = distance;
    }
    // Straight behind a lens that shows it all around its rim, nothing is known but that.
    const double widest = m_source.widest();
    return error <= widest ? error : widest;
}
template double Panorama::exact_error(const Ray<Rounded<double>>&) const;
template double Panorama::exact_error(const Ray<Rounded<DoubleDouble>>&) const;

}  // namespace anamorph
