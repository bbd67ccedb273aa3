// SPDX-License-Identifier: Apache-2.0
#include "anamorph/map/chart.h"

#include <cstdio>
#include <utility>

#include "anamorph/error.h"

namespace anamorph {
namespace {

constexpr long double kDegree = std::numbers::pi_v<long double> / 180;
// How much farther out than an image, or than 45 degrees, the points of its lens may lie.
constexpr double kFarOut = 1024;
constexpr int kMaxSize = 1 << 24;

constexpr std::pair<std::string_view, Projection> kNames[] = {
    {"equirectangular", Projection::equirectangular},
    {"cylindrical", Projection::cylindrical},
    {"rectilinear", Projection::rectilinear},
    {"fisheye", Projection::fisheye},
    {"equisolid", Projection::equisolid},
    {"stereographic", Projection::stereographic},
    {"mercator", Projection::mercator},
    {"cubemap", Projection::cubemap},
    {"cubemap3x2", Projection::cubemap3x2},
    {"cubecross", Projection::cubecross},
};

std::string print(double value) {
    char text[32];
    std::snprintf(text, sizeof text, "%.10g", value);
    return text;
}

/// The largest field of view of a lens in degrees, and whether that value itself is allowed.
std::pair<double, bool> fov_limit(Projection projection) {
    switch (projection) {
        case Projection::rectilinear:
            return {180, false};
        case Projection::stereographic:
            return {360, false};
        default:
            return {360, true};
    }
}

/// tan of an angle of 0 to 90 degrees; the nearer to 90, the more the angle's distance from it matters, which
/// is exact.
long double tan_of(long double degrees) {
    return degrees > 45 ? 1 / std::tan((90 - degrees) * kDegree) : std::tan(degrees * kDegree);
}

/// The width of the chart plane that a horizontal field of view covers.
long double plane_width(Projection projection, long double fov) {
    switch (projection) {
        case Projection::rectilinear:
            return 2 * tan_of(fov / 2);
        case Projection::equisolid:
            return 4 * std::sin(fov / 4 * kDegree);
        case Projection::stereographic:
            return 4 * tan_of(fov / 4);
        default:
            return fov * kDegree;
    }
}

/// Columns and rows of faces in a cube layout.
std::pair<int, int> cube_grid(Projection projection) {
    if (projection == Projection::cubemap) return {1, 6};
    return projection == Projection::cubemap3x2 ? std::pair{3, 2} : std::pair{4, 3};
}

// Faces by their axes right, down, forward: six upright as seen from inside, the upper and lower one hinged
// to the front.
const glm::dmat3 kRight(0, 0, -1, 0, 1, 0, 1, 0, 0);
const glm::dmat3 kLeft(0, 0, 1, 0, 1, 0, -1, 0, 0);
const glm::dmat3 kUp(1, 0, 0, 0, 0, 1, 0, -1, 0);
const glm::dmat3 kDown(1, 0, 0, 0, 0, -1, 0, 1, 0);
const glm::dmat3 kFront(1, 0, 0, 0, 1, 0, 0, 0, 1);
const glm::dmat3 kBack(-1, 0, 0, 0, 1, 0, 0, 0, -1);
// OpenEXR hinges them to the back (its x axis points to our left, its y axis up).
const glm::dmat3 kUpExr(-1, 0, 0, 0, 0, -1, 0, -1, 0);
const glm::dmat3 kDownExr(-1, 0, 0, 0, 0, 1, 0, 1, 0);

std::vector<Piece> cube_pieces(Projection projection, int n) {
    struct Placed {
        glm::dmat3 axes;
        int column, row;
    };
    std::vector<Placed> placed;
    if (projection == Projection::cubemap)
        placed = {{kLeft, 0, 0},    {kRight, 0, 1}, {kUpExr, 0, 2},
                  {kDownExr, 0, 3}, {kFront, 0, 4}, {kBack, 0, 5}};
    else if (projection == Projection::cubemap3x2)
        placed = {{kRight, 0, 0}, {kLeft, 1, 0}, {kUp, 2, 0}, {kDown, 0, 1}, {kFront, 1, 1}, {kBack, 2, 1}};
    else
        placed = {{kUp, 1, 0}, {kLeft, 0, 1}, {kFront, 1, 1}, {kRight, 2, 1}, {kBack, 3, 1}, {kDown, 1, 2}};
    std::vector<Piece> pieces;
    pieces.reserve(placed.size());
    for (const Placed& p : placed)
        pieces.push_back({{p.column * n, p.row * n, (p.column + 1) * n, (p.row + 1) * n}, p.axes});
    return pieces;
}

}  // namespace

Projection projection_from_name(std::string_view name, const std::string& parameter) {
    if (name == "latlong") return Projection::equirectangular;
    for (const auto& [known, projection] : kNames)
        if (known == name) return projection;
    throw Error(parameter, std::string(name), "must be one of " + projection_names());
}

std::string_view name_of(Projection projection) {
    for (const auto& [name, known] : kNames)
        if (known == projection) return name;
    return "";
}

std::string projection_names() {
    std::string names;
    for (const auto& [name, projection] : kNames) names += (names.empty() ? "" : ", ") + std::string(name);
    return names;
}

bool is_cube(Projection projection) {
    return projection == Projection::cubemap || projection == Projection::cubemap3x2 ||
           projection == Projection::cubecross;
}

double Chart::default_fov(Projection projection) {
    switch (projection) {
        case Projection::equirectangular:
        case Projection::cylindrical:
        case Projection::mercator:
            return 360;
        case Projection::fisheye:
        case Projection::equisolid:
        case Projection::stereographic:
            return 180;
        default:
            return 90;
    }
}

Heading::Heading(double y, double x) {
    const double r = std::hypot(x, y);
    if (!(r > 0 && r < HUGE_VAL)) return;
    angle = std::atan2(y, x);
    cos = x / r;
    sin = y / r;
    error = kError;
}

Chart::Chart(Projection projection, int width, int height, double fov, PixelSpacing spacing,
             const std::string& prefix)
    : m_projection(projection), m_width(width), m_height(height), m_fov(fov), m_spacing(spacing) {
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    if (width < 1 || height < 1 || width > kMaxSize || height > kMaxSize)
        throw Error(prefix + "size", size, "must be 1x1 to 16777216x16777216 pixels");
    if (m_fov == 0) m_fov = default_fov(projection);
    const auto [limit, inclusive] = fov_limit(projection);
    if (is_cube(projection)) {
        if (m_fov != 90) throw Error(prefix + "fov", print(fov), "the faces of a cube have 90 degrees");
    } else if (!(m_fov > 0 && (m_fov < limit || (inclusive && m_fov == limit))))
        throw Error(prefix + "fov", print(fov),
                    "must be above 0 and " + std::string(inclusive ? "up to " : "below ") + print(limit) +
                        " degrees for " + std::string(name_of(projection)));

    int columns = width;
    long double plane = plane_width(is_cube(projection) ? Projection::rectilinear : projection, m_fov);
    if (is_cube(projection)) {
        const auto [faces_across, faces_down] = cube_grid(projection);
        if (width % faces_across != 0 || height % faces_down != 0 ||
            width / faces_across != height / faces_down)
            throw Error(prefix + "size", size,
                        std::string(name_of(projection)) + " needs square faces, " +
                            std::to_string(faces_across) + " across and " + std::to_string(faces_down) +
                            " down");
        columns = width / faces_across;
        plane = 2;
        m_pieces = cube_pieces(projection, columns);
    } else
        m_pieces = {Piece{{0, 0, width, height}}};

    const int rows = is_cube(projection) ? columns : height;
    long double across = columns / plane, down = across;
    if (spacing == PixelSpacing::centers) {
        if (columns < 2 || rows < 2)
            throw Error(prefix + "size", size, "pixels=centers needs at least 2 pixels each way");
        across = (columns - 1) / plane;
        down = (rows - 1) / (plane * rows / columns);
    }
    m_sx = Constant(across);
    m_sy = Constant(down);
    m_per_x = Constant(1 / across);
    m_per_y = Constant(1 / down);
    if (!is_cube(projection)) {
        // Of the corners' tangents, all in the plane of a rectilinear lens.
        const double wide = 0.5 * width / scale_x(), high = 0.5 * height / scale_y();
        const double tangent = projection == Projection::mercator      ? std::sinh(std::min(high, 600.0))
                               : projection == Projection::cylindrical ? high
                                                                       : std::max(wide, high);
        m_reach = kFarOut * std::max(1.0, tangent);
    }
    for (std::size_t i = 0; i < m_pieces.size(); ++i)
        m_branches.push_back({static_cast<int>(i), {}, {}, m_pieces[i].axes});
    m_closed = has_azimuth() && m_fov == 360;
    m_poles = projection == Projection::equirectangular && m_closed && width == 2 * height;
}

Branch Chart::branch_around(double x, double y, int piece) const {
    return branch_around(ray(x, y, piece));
}

Branch Chart::branch_around(const Ray<double>& ray) const {
    Branch b = branch(piece_of(ray));
    if (has_azimuth()) {
        b.around = {ray.x, ray.z};
        b.along = {ray.y, std::hypot(ray.x, ray.z)};
        b.axes = {b.around.cos, 0, -b.around.sin, 0, 1, 0, b.around.sin, 0, b.around.cos};
    } else if (m_projection == Projection::fisheye) {
        b.around = {ray.y, ray.x};
        b.along = {std::hypot(ray.x, ray.y), ray.z};
        b.axes = {b.around.cos, b.around.sin, 0, -b.around.sin, b.around.cos, 0, 0, 0, 1};
    }
    return b;
}

}  // namespace anamorph
