// SPDX-License-Identifier: Apache-2.0
#include "anamorph/chart/chart.h"

#include "anamorph/chart/chart_formulas.h"
#include "anamorph/error.h"
#include "anamorph/number/hypot.h"
#include "anamorph/parameter/parameter.h"
#include "anamorph/parameter/text_file.h"

namespace anamorph {
namespace {

// How much farther out than an image, or than 45 degrees, the points of its lens may lie.
constexpr double kFarOut = 1024;
constexpr int kMaxSize = 1 << 24;

constexpr std::string_view kNames[] = {
#define ANAMORPH_PROJECTION(name, Type) #name,
#include "anamorph/chart/projection/list.h"
#undef ANAMORPH_PROJECTION
};

std::string_view alias_of(Projection projection) {
    return with_projection(projection, [](auto formulas) -> std::string_view { return formulas.alias; });
}

/// Throws Error unless the projection has this field of view.
void check_fov(Projection projection, double fov, const Setting& setting, const std::string& parameter) {
    const FieldOfView limits = fov_of(projection);
    const double most =
        with_projection(projection, [&](auto formulas) { return formulas.most_fov(limits, setting); });
    const std::string name(name_of(projection));
    if (limits.fixed) {
        if (fov != limits.standard)
            throw Error(parameter, brief(fov), name + " always has " + brief(limits.standard) + " degrees");
    } else if (!(fov > 0 && (fov < most || (!limits.open && fov == most))))
        throw Error(parameter, brief(fov),
                    "must be above 0 and " + std::string(limits.open ? "below " : "up to ") + brief(most) +
                        " degrees for " + name);
}

/// A length of the plane, and how far it is off at most.
struct Length {
    DoubleDouble value;
    double error;
};

/// Twice the distance in the plane from its middle to the direction half of `degrees` above it. No number where there is none.
Length height_of(Projection projection, double degrees, const Setting& setting) {
    const DoubleDouble half = DoubleDouble::pi() / 180 * degrees / 2;
    DoubleDouble s, c;
    sin_cos(half, s, c);
    if (degrees == 180) c = 0;
    using R = Rounded<DoubleDouble>;
    // The angle is off by 3 units of it, at most pi, and libm by 8 of what it gives (Rounded::kLibm).
    const auto rounded = [](DoubleDouble value) { return projection::known_to(value, 18 * R::kUnit); };
    return with_projection(projection, [&](auto formulas) -> Length {
        const DoubleDouble z = formulas.looks_back ? -c : c;
        const Point<DoubleDouble> p = formulas.point(Ray<DoubleDouble>{0, -s, z}, setting);
        const Point<R> bound = formulas.point(Ray<R>{R(0), rounded(-s), rounded(z)}, setting);
        return {2 * fabs(p.y), 2 * bound.y.error};
    });
}

/// The largest vertical field of view of a projection, which is one piece.
double most_vfov(Projection projection) {
    const FieldOfView limits = fov_of(projection);
    return with_projection(projection, [](auto formulas) { return formulas.counted == Counted::azimuth; })
               ? 180
               : limits.most;
}
// Heights of the plane that are taken for endless.
constexpr double kEndless = 1e17;

/// The pixel edges of columns of faces that fill a width but for a margin: each has the pixels whose centres lie on it.
int column_edge(int column, int columns, int width, double margin) {
    if (column == 0 || column == columns) return column == 0 ? 0 : width;
    return static_cast<int>(std::ceil(margin + column * (width - 2 * margin) / columns - 0.5));
}

/// The faces of a layout at their places. Throws Error unless they are as large as each other, and square but where they need not be.
std::vector<Piece> face_pieces(Projection projection, int width, int height, double row_margin,
                               const std::string& parameter) {
    const FaceGrid grid = faces_of(projection);
    const bool may_be_oblong =
        with_projection(projection, [](auto formulas) { return formulas.has_oblong_faces; });
    const int w = width / grid.columns, h = height / grid.rows;
    const bool is_whole = w * grid.columns == width && w == h;
    if (h * grid.rows != height || !(is_whole || (may_be_oblong && width >= grid.columns)))
        throw Error(parameter, std::to_string(width) + "x" + std::to_string(height),
                    std::string(name_of(projection)) + " needs " +
                        (may_be_oblong ? "faces of equal height, " : "square faces, ") +
                        std::to_string(grid.columns) + " across and " + std::to_string(grid.rows) + " down");
    std::vector<Piece> pieces;
    for (const Face& f : with_projection(projection, [](auto formulas) { return formulas.faces(); }))
        pieces.push_back({{column_edge(f.column, grid.columns, width, row_margin), f.row * h,
                           column_edge(f.column + 1, grid.columns, width, row_margin), (f.row + 1) * h},
                          f.axes,
                          f.toward});
    return pieces;
}

/// What messages call a chart's size: a source's is no key.
std::string size_name(const std::string& prefix) {
    return (prefix == "src" ? "source " : prefix) + "size";
}

}  // namespace

Projection projection_from_name(std::string_view name, const std::string& parameter) {
    for (const Projection p : kProjections)
        if (!name.empty() && (name == name_of(p) || name == alias_of(p))) return p;
    throw Error(parameter, std::string(name), "must be one of " + projection_names());
}

std::string_view name_of(Projection projection) {
    return kNames[static_cast<std::size_t>(projection)];
}

std::vector<std::string> projection_name_list() {
    std::vector<std::string> names(std::begin(kNames), std::end(kNames));
    for (const Projection p : kProjections)
        if (!alias_of(p).empty()) names.emplace_back(alias_of(p));
    return names;
}

std::string projection_names() {
    std::string names;
    for (const std::string_view name : kNames) names += (names.empty() ? "" : ", ") + std::string(name);
    return names;
}

FieldOfView fov_of(Projection projection) {
    return with_projection(projection, [](auto formulas) { return formulas.fov; });
}

FaceGrid faces_of(Projection projection) {
    return with_projection(projection, [](auto formulas) {
        return FaceGrid{formulas.columns, formulas.rows, formulas.face_centre > 0};
    });
}

double natural_aspect(Projection projection, double fov) {
    return with_projection(projection, [&](auto formulas) { return formulas.aspect(fov); });
}

bool rows_turn(Projection projection) {
    return with_projection(
        projection, [](auto formulas) { return formulas.counted == Counted::azimuth && formulas.closes; });
}

int numbers_of(Projection projection) {
    return with_projection(projection, [](auto formulas) { return formulas.numbers; });
}

double Chart::default_fov(Projection projection) {
    return fov_of(projection).standard;
}

double plane_width(Projection projection, double fov, const Distance& d) {
    Setting setting;
    setting.distance = d;
    const DoubleDouble width =
        with_projection(projection, [&](auto formulas) { return formulas.width(fov, setting); });
    return isfinite(width) && width > 0 ? static_cast<double>(width) : 0;
}
double plane_height(Projection projection, double vfov, const Distance& d) {
    if (has_faces(projection) || !(vfov > 0 && vfov <= most_vfov(projection))) return 0;
    Setting setting;
    setting.distance = d;
    const DoubleDouble height = height_of(projection, vfov, setting).value;
    return height > 0 && height < kEndless ? static_cast<double>(height) : 0;
}
namespace {

/// The least number up to `most` for which a rising function is at least `wanted`, or `most`.
template <class Function>
double where_it_reaches(const Function& function, double wanted, double most) {
    double low = 0, high = most;
    for (double middle; (middle = 0.5 * (low + high)) > low && middle < high;)
        (function(middle) < wanted ? low : high) = middle;
    return high;
}

/// What plane_width() and plane_height() give, which is 0 where it is endless.
double or_endless(double length) {
    return length > 0 ? length : HUGE_VAL;
}

}  // namespace

double fov_of_plane_width(Projection projection, double width, const Distance& d) {
    Setting setting;
    setting.distance = d;
    const double most = with_projection(
        projection, [&](auto formulas) { return formulas.most_fov(fov_of(projection), setting); });
    const auto function = [&](double fov) { return or_endless(plane_width(projection, fov, d)); };
    return where_it_reaches(function, width, most);
}
double vfov_of_plane_height(Projection projection, double height, const Distance& d) {
    const auto function = [&](double vfov) { return or_endless(plane_height(projection, vfov, d)); };
    return where_it_reaches(function, height, most_vfov(projection));
}

Chart::Chart(Projection projection, int width, int height, double fov, PixelSpacing spacing,
             const std::string& prefix, const Distance& d, const LensModel& lens,
             const VerticalField& vertical, const Padding& padding)
    : m_projection(projection),
      m_width(width),
      m_height(height),
      m_fov(fov),
      m_spacing(spacing),
      m_vertical(vertical),
      m_padding(padding) {
    const std::string size = std::to_string(width) + "x" + std::to_string(height);
    if (width < 1 || height < 1 || width > kMaxSize || height > kMaxSize)
        throw Error(size_name(prefix), size, "must be 1x1 to 16777216x16777216 pixels");
    m_setting.distance = d;
    check_numbers(prefix);
    if (m_fov == 0) m_fov = default_fov(projection);
    check_fov(projection, m_fov, m_setting, prefix + "fov");
    // A margin that cannot be is refused below.
    const bool has_margin = padding.around_rows && padding.pixels > 0 && 4 * padding.pixels < width;
    const double row_margin = has_margin ? padding.pixels : 0;
    if (faces_of(projection).columns > 0)
        m_pieces = face_pieces(projection, width, height, row_margin, size_name(prefix));
    else
        m_pieces = {Piece{{0, 0, width, height}}};
    check_vertical(prefix, lens);
    check_padding(prefix, lens);
    set_scale(prefix, lens);
    set_branches();
}

void Chart::check_numbers(const std::string& prefix) const {
    with_projection(m_projection, [&](auto formulas) {
        const std::string of =
            formulas.numbers > 0 ? " for " + std::string(name_of(m_projection)) : std::string();
        const auto check = [&](const char* name, double value, double least, double most) {
            if (!(value >= least && value <= most))
                throw Error(prefix + name, brief(value),
                            "must be from " + brief(least) + " to " + brief(most) + of);
        };
        check("d", m_setting.distance.d, formulas.least_d, formulas.most_d);
        check("e", m_setting.distance.e, 0, 1);
    });
}

void Chart::check_vertical(const std::string& prefix, const LensModel& lens) const {
    const double vfov = m_vertical.fov;
    const std::string parameter = prefix + "vfov", name(name_of(m_projection));
    if (vfov != 0 && (m_pieces.size() > 1 || fov_of(m_projection).fixed))
        throw Error(parameter, brief(vfov), name + " has none but its own");
    if (vfov != 0 && plane_height(m_projection, vfov, m_setting.distance) == 0) {
        const double most = most_vfov(m_projection);
        const bool is_open = plane_height(m_projection, most, m_setting.distance) == 0;
        throw Error(parameter, brief(vfov),
                    "must be above 0 and " + std::string(is_open ? "below " : "up to ") + brief(most) +
                        " degrees for " + name);
    }
    if (!m_vertical.horizon) return;
    if (m_pieces.size() > 1 || lens.kind != LensModel::Kind::none)
        throw Error(prefix + "horizon", brief(*m_vertical.horizon),
                    "must be that of a picture in one piece, without a lens");
    if (!(std::fabs(*m_vertical.horizon) <= kMaxSize))
        throw Error(prefix + "horizon", brief(*m_vertical.horizon),
                    "must be a number up to " + std::to_string(kMaxSize));
}

void Chart::check_padding(const std::string& prefix, const LensModel& lens) const {
    const bool has_whole_faces =
        m_pieces.size() == 1 || m_width % std::max(1, faces_of(m_projection).columns) == 0;
    if (!has_whole_faces && m_spacing == PixelSpacing::centers)
        throw Error(size_name(prefix), std::to_string(m_width) + "x" + std::to_string(m_height),
                    "pixels=centers needs faces of whole pixels");
    const auto& [pixels, around_rows] = m_padding;
    if (pixels == 0) return;
    const Box& face = m_pieces[0].box;
    const FaceGrid grid = faces_of(m_projection);
    const Lensed lensed = with_projection(m_projection, [](auto formulas) { return formulas.lensed; });
    const bool is_round = lensed == Lensed::equidistant || lensed == Lensed::stereographic ||
                          (lensed == Lensed::axial && !rows_turn(m_projection));
    const std::string name(name_of(m_projection)), text = m_padding.text();
    if (grid.joined || (grid.columns == 0 && !is_round))
        throw Error(prefix + "padding", text,
                    "must be of a layout of faces or of a fisheye, which " + name + " is not");
    const bool may_be_oblong =
        with_projection(m_projection, [](auto formulas) { return formulas.has_oblong_faces; });
    const std::string allowed = "must be 0 or more, and less than a quarter of the sides, " +
                                std::to_string(face.width()) + "x" + std::to_string(face.height()) +
                                " pixels";
    if (around_rows && (!may_be_oblong || m_spacing == PixelSpacing::centers))
        throw Error(prefix + "padding", text,
                    may_be_oblong ? "rows: must not be given with pixels=centers"
                                  : "rows: must be of eac, not of " + name + ": " + allowed);
    if (!around_rows && !has_whole_faces)
        throw Error(prefix + "padding", text,
                    "must be of faces of whole pixels, or rows:" + brief(pixels) +
                        ", around each row of faces, where " + std::to_string(m_width) +
                        " pixels are no multiple of " + std::to_string(grid.columns));
    if (lens.kind != LensModel::Kind::none || m_vertical.fov != 0)
        throw Error(prefix + "padding", text,
                    "must not be given with " + prefix + (m_vertical.fov != 0 ? "vfov" : "lens"));
    // Angles of equi-angular faces then stay below 90 degrees up to the edges.
    if (!(pixels >= 0 && 4 * pixels < std::min(face.width(), face.height())))
        throw Error(prefix + "padding", text, allowed);
}

std::string Padding::text() const {
    return (around_rows ? "rows:" : "") + shortest(pixels);
}

std::optional<Padding> Padding::parse(std::string_view text) {
    constexpr std::string_view kRows = "rows:";
    const bool around_rows = text.starts_with(kRows);
    if (around_rows) text.remove_prefix(kRows.size());
    double pixels = 0;
    if (!text_file::take_number(text, pixels) || !text.empty()) return {};
    return Padding(pixels, around_rows);
}

bool Chart::has_joined_rows() const {
    const FaceGrid grid = faces_of(m_projection);
    return grid.columns > 0 && !grid.joined && (m_padding.around_rows || m_width % grid.columns != 0);
}

namespace {

/// Checks the lens of a picture whose columns are azimuths: what belongs to an axis has no meaning there, and a full turn has no edges
/// that could be bent.
void check_lens_of_rows(Projection projection, double fov, const LensModel& lens,
                        const std::string& parameter) {
    const std::string name(name_of(projection));
    if (fov == 360)
        throw Error(parameter, lens.text(),
                    "must be none for " + name + " of 360 degrees, which has no lens");
    if (lens.kind != LensModel::Kind::ptlens && lens.kind != LensModel::Kind::poly)
        throw Error(parameter, lens.text(), "must be ptlens or poly for " + name);
}

}  // namespace

void Chart::set_scale(const std::string& prefix, const LensModel& lens) {
    // A difference is off by a unit at most, which is within what width_units says.
    const DoubleDouble margin = 2.0 * m_padding.pixels;
    // Of joined rows the faces share what their margin leaves: a quotient more.
    const DoubleDouble columns = has_joined_rows() ? (m_width - margin) / faces_of(m_projection).columns
                                                   : m_pieces[0].box.width() - margin,
                       rows = m_pieces[0].box.height() - margin;
    const DoubleDouble plane =
        with_projection(m_projection, [&](auto formulas) { return formulas.width(m_fov, m_setting); });
    m_setting.half_width = static_cast<double>(plane / 2);
    const bool has_square_plane = m_pieces.size() > 1 && columns != rows;
    DoubleDouble plane_down = has_square_plane ? plane : plane / columns * rows;
    DoubleDouble across = columns / plane, down = has_square_plane ? rows / plane : across;
    if (m_spacing == PixelSpacing::centers) {
        if (columns < 2 || rows < 2)
            throw Error(size_name(prefix), std::to_string(m_width) + "x" + std::to_string(m_height),
                        "pixels=centers needs at least 2 pixels each way");
        // Of a face, or of all of those that are joined.
        const FaceGrid grid = faces_of(m_projection);
        const int faces_across = grid.joined ? grid.columns : 1, faces_down = grid.joined ? grid.rows : 1;
        across = (columns * faces_across - 1) / (plane * faces_across);
        down = (rows * faces_down - 1) / (plane_down * faces_down);
    }
    const double units =
        with_projection(m_projection, [&](auto formulas) { return formulas.width_units(m_fov, m_setting); });
    double error_down = units * Rounded<DoubleDouble>::kUnit;  // relative
    if (m_vertical.fov != 0) {
        const Length height = height_of(m_projection, m_vertical.fov, m_setting);
        plane_down = height.value;
        down = (m_spacing == PixelSpacing::centers ? rows - 1 : rows) / plane_down;
        error_down = height.error / static_cast<double>(height.value) + 8 * Rounded<DoubleDouble>::kUnit;
    }
    const auto constant = [&](DoubleDouble value, double relative) {
        return Constant(value, static_cast<double>(value) * relative);
    };
    m_sx = constant(across, units * Rounded<DoubleDouble>::kUnit);
    m_sy = constant(down, error_down);
    m_per_x = constant(1 / across, units * Rounded<DoubleDouble>::kUnit);
    m_per_y = constant(1 / down, error_down);
    if (lens.kind == LensModel::Kind::none) return;
    const Lens::Plane half{plane / 2, plane_down / 2, 1 / across, 1 / down};
    const Lensed lensed = with_projection(m_projection, [](auto formulas) { return formulas.lensed; });
    if (rows_turn(m_projection) && lensed != Lensed::no)
        check_lens_of_rows(m_projection, m_fov, lens, prefix + "lens");
    m_lens =
        std::make_shared<const Lens>(lens, lensed, std::string(name_of(m_projection)), half, prefix + "lens");
}

void Chart::set_branches() {
    with_projection(m_projection, [&](auto formulas) {
        m_counted = formulas.counted;
        m_closed = formulas.closes && m_fov == 360;
        m_turns = formulas.closes && !m_lens;
        m_pieces_see_all = m_pieces.size() > 1 && formulas.faces_see_all(m_setting);
        const double middle = m_vertical.horizon.value_or(0.5 * m_height);
        const bool is_whole = m_vertical.fov == 0 ? m_width == 2 * m_height : m_vertical.fov == 180;
        m_poles = formulas.has_pole_rows && m_closed && is_whole && middle == 0.5 * m_height;
        const double tangent = formulas.largest_tangent(
            0.5 * m_width / scale_x(), std::max(std::fabs(middle), std::fabs(m_height - middle)) / scale_y());
        m_setting.reach = kFarOut * std::max(1.0, tangent);
        const int across = m_pieces[0].box.width(), down = m_pieces[0].box.height();
        const bool joined = faces_of(m_projection).joined;
        for (std::size_t i = 0; i < m_pieces.size(); ++i) {
            const Box& box = m_pieces[i].box;
            Branch b{m_setting, static_cast<int>(i), m_pieces[i].axes};
            b.centre_x = box.x0 < across ? -formulas.face_centre : formulas.face_centre;
            b.centre_y = box.y0 < down ? -formulas.face_centre : formulas.face_centre;
            // Of joined faces the middle of all stands for (0, 0), without rounding: sides and scales are multiples of 1/2.
            b.pixel_x = joined ? 0.5 * m_width + b.centre_x * scale_x() : 0.5 * (box.x0 + box.x1);
            b.pixel_y = joined ? 0.5 * m_height + b.centre_y * scale_y() : 0.5 * (box.y0 + box.y1);
            if (m_vertical.horizon) b.pixel_y = middle;
            if (has_joined_rows()) {
                const int columns = faces_of(m_projection).columns, column = static_cast<int>(i) % columns;
                const double margin = m_padding.around_rows ? m_padding.pixels : 0,
                             sides = m_width - 2 * margin;
                if (std::floor(margin) == margin && std::fmod(sides, columns) == 0) {
                    b.pixel_x = margin + (column + 0.5) * (sides / columns);
                } else {
                    // From the picture's middle, which is a pixel edge or centre, faces are 2 units from each other: no rounding.
                    b.pixel_x = 0.5 * m_width;
                    b.centre_x = columns - 1 - 2 * column;
                }
            }
            m_branches.push_back(b);
        }
    });
}

Chart Chart::resized(int width, int height) const {
    VerticalField vertical = m_vertical;
    if (vertical.horizon) *vertical.horizon *= static_cast<double>(height) / m_height;
    Chart chart(m_projection, width, height, m_fov, m_spacing, "", m_setting.distance, {}, vertical,
                {m_padding.pixels * width / m_width, m_padding.around_rows});
    chart.m_lens = m_lens;
    chart.m_turns = m_turns;
    return chart;
}

double Chart::pixels_per_radian() const {
    return scale_x() * (m_lens ? m_lens->magnification() : 1) *
           with_projection(m_projection, [](auto formulas) { return formulas.per_radian; });
}

double Chart::widest() const {
    const double diameter =
        m_lens ? 2 * m_lens->reach() : with_projection(m_projection, [&](auto formulas) -> double {
            return formulas.diameter(m_setting);
        });
    return diameter * std::max(scale_x(), scale_y()) * 1.25;
}

Branch Chart::branch_around(double x, double y, int piece) const {
    return branch_around(ray(x, y, piece));
}

Branch Chart::branch_around(const Ray<double>& ray) const {
    Branch b = branch(piece_of(ray));
    const Ray<double> r = transform(glm::transpose(b.axes), ray);
    // A lens has its centre where azimuths are 0.
    if (m_counted == Counted::azimuth && m_lens) return b;
    if (m_counted == Counted::azimuth) {
        b.around = {r.x, r.z};
        b.along = {r.y, hypot(r.x, r.z)};
        b.axes *= glm::dmat3(b.around.cos, 0, -b.around.sin, 0, 1, 0, b.around.sin, 0, b.around.cos);
    } else if (m_counted == Counted::axis) {
        b.around = {r.y, r.x};
        b.along = {hypot(r.x, r.y), r.z};
        b.axes *= glm::dmat3(b.around.cos, b.around.sin, 0, -b.around.sin, b.around.cos, 0, 0, 0, 1);
    }
    return b;
}

}  // namespace anamorph
