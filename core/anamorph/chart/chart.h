// SPDX-License-Identifier: Apache-2.0
// Charts: the flat pictures of the sphere of directions. A chart maps a point of its image to a ray and a ray
// to a point of its image; each formula is written once, as a template over the scalar.
//
// Frames. Image: pixels, x right, y down, the centre of pixel (i, j) at (i + 0.5, j + 0.5). Ray: x right, y
// down, z forward, any length. Chart plane: (X, Y) = (image - centre) / pixels per unit, in the unit of the
// projection (radians for angles). A picture taken through a lens (lens.h) is in the observed plane, from which
// the lens leads to that of the projection.
//
// Projections: chart/projection/, one a file, in the order of chart/projection/list.h.
//
// What is read from formulas is defined in chart_formulas.h, and compiled in chart_numbers.cpp for the numbers of chart_numbers.h,
// chart_jets.h, chart_near.h and chart_glsl.h: a projection that changes is compiled there and for vectors alone. To read one with
// another number takes the sources: chart_formulas.h is not installed.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/mat3x3.hpp>
#include <memory>
#include <numbers>
#include <string>
#include <string_view>
#include <vector>

#include "anamorph/chart/lens.h"
#include "anamorph/chart/projection/facts.h"
#include "anamorph/geometry/box.h"
#include "anamorph/geometry/point.h"
#include "anamorph/number/jet.h"

namespace anamorph {

/// The projections, each in a file of chart/projection/.
enum class Projection {
#define ANAMORPH_PROJECTION(name, Type) name,
#include "anamorph/chart/projection/list.h"
#undef ANAMORPH_PROJECTION
};

/// All projections, in the order of their list.
inline constexpr Projection kProjections[] = {
#define ANAMORPH_PROJECTION(name, Type) Projection::name,
#include "anamorph/chart/projection/list.h"
#undef ANAMORPH_PROJECTION
};

/// How a field of view spreads over W pixels: edge to edge, or from the first pixel's centre to the last
/// one's.
enum class PixelSpacing { edges, centers };

/// Finds a projection by its name ("equirectangular") or alias ("latlong"). Throws Error naming `parameter`.
Projection projection_from_name(std::string_view name, const std::string& parameter = "projection");
/// The name of a projection in recipes; never an alias.
std::string_view name_of(Projection projection);
/// The names of all projections, separated by ", ", for messages and documentation.
std::string projection_names();
/// The names of all projections, followed by the aliases.
std::vector<std::string> projection_name_list();
/// A projection's default field of view and its limits.
FieldOfView fov_of(Projection projection);
/// The numbers of faces across and down a picture; 0 where the picture is one piece of any shape.
struct FaceGrid {
    int columns = 0, rows = 0;
    bool joined = false;  ///< the faces are parts of one picture, which has no edges where they meet
};
/// How a projection's picture is divided into faces.
FaceGrid faces_of(Projection projection);
/// Is a projection's picture divided into faces?
inline bool has_faces(Projection projection) {
    return faces_of(projection).columns > 0;
}
/// Are the rows of a projection's picture circles around the vertical axis, and those of 360 degrees closed?
bool rows_turn(Projection projection);
/// How many numbers a projection's picture depends on: none, d, or d and e.
int numbers_of(Projection projection);
/// The height over the width of a projection's picture with a horizontal field of view in degrees.
double natural_aspect(Projection projection, double fov);

/// The width of the plane that a horizontal field of view in degrees covers, in radians, tangents and so on, as the projection's formulas
/// have it. 0 where there is none. `d`: the numbers of projections that have some.
double plane_width(Projection projection, double fov, const Distance& d = {});
double plane_height(Projection projection, double vfov,
                    const Distance& d = {});  ///< The height, of a vertical one.
/// The horizontal field of view that covers a width of the plane, at most what the projection shows.
double fov_of_plane_width(Projection projection, double width, const Distance& d = {});
double vfov_of_plane_height(Projection projection, double height,
                            const Distance& d = {});  ///< The vertical one, of a height.

/// How a picture lies in its projection's plane from top to bottom.
struct VerticalField {
    double fov =
        0;  ///< vertical field of view in degrees, as if the plane's middle were the picture's; 0: square pixels
    std::optional<double> horizon =
        {};  ///< pixels from the upper edge to the plane's middle; by default half the height
};

/// How many pixels within its edges the field of view of an image ends.
struct Padding {
    double pixels = 0;
    /// Around each row of faces alone, of those that follow each other there (eac), not around every face.
    bool around_rows = false;

    /// So many pixels, around every face or around rows.
    Padding(double within = 0, bool rows = false) : pixels(within), around_rows(rows) {}
    bool operator==(const Padding&) const = default;
    /// "2", "rows:2".
    std::string text() const;
    /// What text() makes; none of other words.
    static std::optional<Padding> parse(std::string_view text);
};

/// One smooth piece of a chart: its place in the image, and its axes (right, down, forward) as columns
/// in the frame of rays. Layouts of faces have more than one.
struct Piece {
    Box box;
    glm::dmat3 axes{1};
    glm::dvec3 toward{0, 0, 1};  ///< a ray belongs to the piece whose `toward` it is nearest to
};

/// The place on a chart where its formulas are read: the piece, and the direction from which angles are
/// counted. A local ray has that direction straight ahead: ray = axes * local ray.
struct Branch : Setting {
    int piece = 0;
    glm::dmat3 axes{1};
    double pixel_x = 0, pixel_y = 0;  ///< the image point, in pixels, of the piece's (centre_x, centre_y)
};

/// A flat picture of directions: a projection, its field of view and its pixels.
class Chart {
  public:
    /// The least and the largest value of d of any projection; e is from 0 to 1.
    static constexpr double kLeastDistance = -0.999, kMostDistance = 1000;

    /// `fov`: the horizontal field of view of the whole image without distortion, or of each face, in degrees; 0
    /// takes the projection's default (default_fov). `d`: the numbers of projections that have some. `vertical`: only of images that
    /// are one piece, and a horizon only of those without a lens. `padding`: how many pixels within each edge of the image, or of
    /// every face, the field of view ends, less than a quarter of its sides; only of layouts of separate faces and of fisheyes
    /// without a lens. The columns of such faces need not be whole pixels wide, unless each has a padding: edges between them are then within pixels.
    /// `prefix` is put before "fov", "vfov", "size", "d", "e", "lens" and "padding" in errors, and "src" before "size"
    /// is "source ". Throws Error on a value out of range.
    Chart(Projection projection, int width, int height, double fov = 0,
          PixelSpacing spacing = PixelSpacing::edges, const std::string& prefix = "", const Distance& d = {},
          const LensModel& lens = {}, const VerticalField& vertical = {}, const Padding& padding = {});

    /// The horizontal field of view that a chart of this projection has unless it is given one, in degrees.
    static double default_fov(Projection projection);
    /// A chart of the same picture with another size in pixels. Throws Error on a size out of range, or one that does
    /// not give square faces.
    Chart resized(int width, int height) const;

    Projection projection() const { return m_projection; }
    int width() const { return m_width; }
    int height() const { return m_height; }
    double fov() const { return m_fov; }
    const VerticalField& vertical() const { return m_vertical; }
    /// The numbers of projections that have some.
    const Distance& distance() const { return m_setting.distance; }
    PixelSpacing spacing() const { return m_spacing; }
    /// How far within each edge of the image, or of every face, the field of view ends; there the plane goes on.
    const Padding& padding() const { return m_padding; }
    const std::vector<Piece>& pieces() const { return m_pieces; }
    /// The lens; null where there is none, as in most pictures.
    const Lens* lens() const { return m_lens.get(); }

    /// Does azimuth close on itself in this image (a full turn)? Its period in pixels is then period().
    bool closed() const { return m_closed; }
    /// The width of a full turn in pixels: that of the image, or one less where fields of view run between pixel centres.
    int period() const { return m_spacing == PixelSpacing::edges ? m_width : m_width - 1; }
    /// Do the first and last rows touch the poles (a closed equirectangular image over the full 180 degrees)?
    bool reaches_poles() const { return m_poles; }
    /// Pixels per unit of the chart plane at pieces()[0].
    double scale_x() const { return m_sx.value(); }
    double scale_y() const { return m_sy.value(); }
    /// scale_x(), known better than double holds it.
    const Constant& pixels_per_unit() const { return m_sx; }
    const Constant& units_per_pixel() const { return m_per_x; }
    /// The same from row to row.
    const Constant& pixels_per_unit_down() const { return m_sy; }
    const Constant& units_per_pixel_down() const { return m_per_y; }
    /// Pixels per radian straight ahead of a piece.
    double pixels_per_radian() const;
    /// The distance in pixels, or any multiple of it, between two points of one ray: a full turn; infinite where rows
    /// do not run around the sphere.
    double turn() const {
        return m_closed ? period() : m_turns ? 2 * std::numbers::pi * scale_x() : HUGE_VAL;
    }
    /// The largest distance, in pixels, of a computed point of a ray from the exact point of another, where the plane is
    /// bounded; else infinite.
    ///
    /// Exact points lie within the plane's radius R of its middle. Computed ones do but for rounding, at most that of a lens's
    /// polynomial: 14 units of 2^-53 times its condition, which lens.cpp takes to be below 2^40. But straight behind, next to the
    /// axis, x^2 + y^2 may underflow: it is a multiple of 2^-1074, and each square is off by half of that at most. Where the sum
    /// is not 0 it then is at least half of the exact one, and the radius, for which formulas divide by its root, at most
    /// sqrt 2 R, or infinite, which is no point. The two are less than 2.42 R apart. Of the 2.5 R that are returned the rest is
    /// more than a thirtieth of 2 R, which is a pixel at least: far above the rounding of coordinates, which are below 2^24.
    double widest() const;

    /// The local ray through an image point; valid where inside() >= 0.
    template <class T>
    Ray<T> local_ray(const T& x, const T& y, const Branch& branch) const;

    /// A number that is >= 0 where the image point has a ray. For an interval the sign holds for all members, or is open.
    template <class T>
    T inside(const T& x, const T& y, int piece = 0) const;

    /// The image point of a local ray.
    template <class T>
    Point<T> local_point(const Ray<T>& local, const Branch& branch) const;

    /// A number that is > 0 where a local ray is seen by the lens and lies on the piece. A projection that cannot show all
    /// directions ends where their tangents are 1024 times those of its image's edges, and of 45 degrees.
    template <class T>
    T sees(const Ray<T>& local, int piece = 0) const;
    /// The number that sees() would give if the chart's lens did not end.
    template <class T>
    T sees_without_lens(const Ray<T>& local, int piece = 0) const;

    /// Are there several pieces, and does each see all rays that are nearest to it?
    bool pieces_see_all() const { return m_pieces_see_all; }

    /// A function of image points that has one sign where one smooth formula holds.
    template <class T>
    T crease(const T& x, const T& y, int piece) const;
    /// crease() as a function of local rays.
    template <class T>
    T crease(const Ray<T>& local) const;
    /// Do formulas count azimuths, or angles about the axis of sight?
    Counted counted() const { return m_counted; }

    /// The branch for single points of a piece: azimuths counted from straight ahead, in [-180, 180].
    const Branch& branch(int piece = 0) const { return m_branches[static_cast<std::size_t>(piece)]; }
    /// The branch for a neighbourhood of an image point.
    Branch branch_around(double x, double y, int piece) const;
    /// The branch for a neighbourhood of a ray.
    Branch branch_around(const Ray<double>& ray) const;

    /// The piece that sees a ray.
    template <class T>
    int piece_of(const Ray<T>& ray) const;

    /// The ray through an image point.
    template <class T>
    Ray<T> ray(const T& x, const T& y, int piece = 0) const {
        return transform(branch(piece).axes, local_ray(x, y, branch(piece)));
    }
    /// The image point of a ray, on the piece that sees it.
    template <class T>
    Point<T> point(const Ray<T>& ray, int piece) const {
        return local_point(transform(glm::transpose(branch(piece).axes), ray), branch(piece));
    }

    /// Pixels for a unit of the plane, and units for a pixel, in double.
    struct Scale {
        double x, y, per_x, per_y;
    };
    /// The scale, which all pieces have in common.
    Scale scale() const { return {m_sx.value(), m_sy.value(), m_per_x.value(), m_per_y.value()}; }

  private:
    template <class T>
    Point<T> to_observed_plane(const T& x, const T& y, const Branch& branch) const;
    template <class T>
    Point<T> to_plane(const T& x, const T& y, const Branch& branch) const;

    void check_numbers(const std::string& prefix) const;
    void check_vertical(const std::string& prefix, const LensModel& lens) const;
    void check_padding(const std::string& prefix, const LensModel& lens) const;
    /// Do faces follow each other in rows, edge to edge, so that these edges may be within pixels?
    bool has_joined_rows() const;
    void set_scale(const std::string& prefix, const LensModel& lens);
    void set_branches();

    Projection m_projection;
    int m_width, m_height;
    double m_fov;
    PixelSpacing m_spacing;
    VerticalField m_vertical;
    Padding m_padding;
    Setting m_setting;
    Counted m_counted = Counted::none;
    /// Pixels per unit of the plane, and units per pixel.
    Constant m_sx, m_sy, m_per_x, m_per_y;
    bool m_closed = false, m_poles = false, m_turns = false, m_pieces_see_all = false;
    std::vector<Piece> m_pieces;
    std::vector<Branch> m_branches;
    std::shared_ptr<const Lens> m_lens;
};

// ---------------------------------------------------------------------------------------------------------

template <class T>
int Chart::piece_of(const Ray<T>& ray) const {
    int best = 0;
    T most = T(0);
    for (std::size_t i = 0; i < m_pieces.size() && m_pieces.size() > 1; ++i) {
        const glm::dvec3& f = m_pieces[i].toward;
        const T along = ray.x * f[0] + ray.y * f[1] + ray.z * f[2];
        if (i == 0 || along > most) {
            most = along;
            best = static_cast<int>(i);
        }
    }
    return best;
}

}  // namespace anamorph
