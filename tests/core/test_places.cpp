// SPDX-License-Identifier: Apache-2.0
// Every projection, lens model and surface at places that were worked out by other means (tests/data/places).
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <numbers>
#include <set>

#include "anamorph/chart/chart.h"
#include "anamorph/error.h"
#include "anamorph/formula/formula_text.h"
#include "anamorph/operation/operation.h"
#include "anamorph/surface/shape/all.h"
#include "anamorph/surface/surface.h"
#include "places_file.h"

namespace anamorph::test_places {
using namespace surface;
namespace {

using namespace places;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::size_t kFewest = 8;
constexpr Real kDegree = std::numbers::pi_v<Real> / 180;

/// What is wrong, each with its file and line.
using Complaints = std::vector<std::string>;

void append(Complaints& to, const Complaints& more) {
    to.insert(to.end(), more.begin(), more.end());
}

std::string written(const std::optional<Numbers>& numbers) {
    if (!numbers) return "none";
    std::ostringstream out;
    out.precision(17);
    for (std::size_t i = 0; i < numbers->size(); ++i) out << (i > 0 ? " " : "") << (*numbers)[i];
    return out.str();
}

// --- both ways

/// From one of two sides, or nothing where there is no counterpart.
using Map = std::function<std::optional<Numbers>(const Numbers&)>;
using Distance = std::function<Real(const Numbers&, const Numbers&)>;

/// What a file speaks of: `map[0]` leads from its first side to the second, and `map[1]` back.
struct TwoWays {
    Map map[2];
    Distance apart[2];  ///< on each side
};

/// A place read one way, from side `from`.
struct OneWay {
    const Place* place;
    std::size_t from;
    Numbers given;
    std::optional<Numbers> wanted;
};

std::vector<OneWay> ways_of(const FileKind& kind, const Place& place) {
    if (!place.side.empty())
        return {{&place, place.side == kind.sides[1] ? 1u : 0u, place.accept, place.expect}};
    std::vector<OneWay> ways = {{&place, 0, place.accept, place.expect}};
    if (place.expect) ways.push_back({&place, 1, *place.expect, place.accept});
    return ways;
}

Complaints complaints_of(const FileKind& kind, const OneWay& way, const TwoWays& two) {
    const std::optional<Numbers> found = two.map[way.from](way.given);
    Real off = found || way.wanted ? HUGE_VAL : 0;
    if (found && way.wanted) off = two.apart[1 - way.from](*found, *way.wanted);
    if (off <= way.place->tolerance[way.from]) return {};
    return {way.place->at + ": " + kind.sides[way.from] + " " + written(way.given) + " has " +
            written(found) + ", expected " + written(way.wanted) + ", " + written(Numbers{off}) + " off"};
}

/// Are there places just within and just outside an end of this side?
bool shows_end(const std::vector<OneWay>& ways, std::size_t side, const TwoWays& two) {
    for (const OneWay& out : ways)
        for (const OneWay& in : ways)
            if (out.from == side && in.from == side && !out.wanted && in.wanted &&
                two.apart[side](out.given, in.given) <= 1)
                return true;
    return false;
}

/// Of all places of a file, whose groups `make` reads.
Complaints compare_both_ways(const FileKind& kind, const std::string& file, const std::vector<Group>& groups,
                             const std::function<TwoWays(const Group&)>& make) {
    Complaints wrong;
    std::set<std::string> ended;
    for (const Group& group : groups) {
        const TwoWays two = make(group);
        std::vector<OneWay> ways;
        for (const Place& place : group.places)
            for (const OneWay& way : ways_of(kind, place)) ways.push_back(way);
        for (const OneWay& way : ways) append(wrong, complaints_of(kind, way, two));
        for (std::size_t side = 0; side < 2; ++side)
            if (shows_end(ways, side, two)) ended.insert(kind.sides[side]);
        ended.insert(group.all.begin(), group.all.end());
    }
    for (const std::string& side : kind.sides)
        if (!ended.contains(side))
            wrong.push_back(file + ": no place of side " + side + " shows where it ends" + kFormat);
    return wrong;
}

// --- charts

/// Sine and cosine of an angle in degrees, of which quarters of a turn are taken off without rounding.
struct SineCosine {
    Real sin, cos;

    explicit SineCosine(Real degrees) {
        const Real rest = std::remainder(degrees, Real(90));
        const Real s = std::sin(rest * kDegree), c = std::cos(rest * kDegree);
        const int quarters = static_cast<int>(std::lround((degrees - rest) / 90)) & 3;
        sin = quarters == 0 ? s : quarters == 1 ? c : quarters == 2 ? -s : -c;
        cos = quarters == 0 ? c : quarters == 1 ? -s : quarters == 2 ? -c : s;
    }
};

Ray<Real> ray_of(const Numbers& angles) {
    const SineCosine a(angles[0]), e(angles[1]);
    return {a.sin * e.cos, -e.sin, a.cos * e.cos};
}

Numbers angles_of(const Ray<double>& r) {
    const Real x = r.x, y = r.y, z = r.z;
    return {std::atan2(x, z) / kDegree, std::atan2(-y, std::hypot(x, z)) / kDegree};
}

Real degrees_apart(const Numbers& one, const Numbers& other) {
    const Ray<Real> a = ray_of(one), b = ray_of(other);
    const Real across = std::hypot(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
    return std::atan2(across, a.x * b.x + a.y * b.y + a.z * b.z) / kDegree;
}

Real pixels_apart(const Numbers& a, const Numbers& b) {
    return std::hypot(a[0] - b[0], a[1] - b[1]);
}

std::optional<Numbers> pixel_of(const Chart& chart, const Numbers& angles) {
    const Ray<Real> r = ray_of(angles);
    const Ray<double> ray{double(r.x), double(r.y), double(r.z)};
    const int piece = chart.piece_of(ray);
    const Ray<double> local = transform(glm::transpose(chart.branch(piece).axes), ray);
    if (!chart.pieces_see_all() && !(chart.sees(local, piece) > 0)) return {};
    const Point<double> p = chart.local_point(local, chart.branch(piece));
    return Numbers{p.x, p.y};
}

std::optional<Numbers> angles_at(const Chart& chart, const Numbers& pixel) {
    const double x = double(pixel[0]), y = double(pixel[1]);
    const std::vector<Piece>& pieces = chart.pieces();
    for (std::size_t i = 0; i < pieces.size(); ++i) {
        const Box& box = pieces[i].box;
        const bool holds = x >= box.x0 && x <= box.x1 && y >= box.y0 && y <= box.y1;
        const int piece = static_cast<int>(i);
        if ((pieces.size() == 1 || holds) && chart.inside(x, y, piece) >= 0)
            return angles_of(chart.ray(x, y, piece));
    }
    return {};
}

TwoWays ways_of_chart(const Chart& chart) {
    return {{[chart](const Numbers& angles) { return pixel_of(chart, angles); },
             [chart](const Numbers& pixel) { return angles_at(chart, pixel); }},
            {degrees_apart, pixels_apart}};
}

/// Of a lens: pixels of the ideal and of the observed picture, which share scale and middle.
TwoWays ways_of_lens(const Chart& chart) {
    const double middle_x = 0.5 * chart.width(), middle_y = 0.5 * chart.height();
    const auto plane = [=](const Numbers& pixel) {
        return Point<double>{(double(pixel[0]) - middle_x) / chart.scale_x(),
                             (double(pixel[1]) - middle_y) / chart.scale_y()};
    };
    const auto pixel = [=](const Point<double>& p) -> std::optional<Numbers> {
        return Numbers{p.x * chart.scale_x() + middle_x, p.y * chart.scale_y() + middle_y};
    };
    const auto there = [=](const Numbers& ideal) -> std::optional<Numbers> {
        const Point<double> p = plane(ideal);
        return chart.lens()->sees(p) >= 0 ? pixel(chart.lens()->observed(p)) : std::nullopt;
    };
    const auto back = [=](const Numbers& observed) -> std::optional<Numbers> {
        const Point<double> p = plane(observed);
        return chart.lens()->inside(p) >= 0 ? pixel(chart.lens()->ideal(p)) : std::nullopt;
    };
    return {{there, back}, {pixels_apart, pixels_apart}};
}

Chart chart_of(const Group& group, std::string_view projection) {
    const auto number = [&](const std::string& name, const char* otherwise) {
        return double(number_of(group.at, group.setting(name, otherwise)));
    };
    const std::string size = group.setting("size", ""), pixels = group.setting("pixels", "edges");
    const std::size_t x = size.find('x');
    if (x == std::string::npos) refuse(group.at, "size=WIDTHxHEIGHT is missing");
    if (pixels != "edges" && pixels != "centers") refuse(group.at, "pixels must be edges or centers");
    const int width = int(number_of(group.at, size.substr(0, x))),
              height = int(number_of(group.at, size.substr(x + 1)));
    try {
        return Chart(projection_from_name(projection), width, height, number("fov", "0"),
                     pixels == "edges" ? PixelSpacing::edges : PixelSpacing::centers, "",
                     {number("d", "1"), number("e", "0.5")}, LensModel::parse(group.setting("lens", "none")));
    } catch (const Error& e) {
        refuse(group.at, e.what());
    }
}

/// Rays all around.
std::vector<Numbers> many_rays() {
    std::vector<Numbers> rays;
    for (int i = 0; i < 2000; ++i)
        rays.push_back({std::remainder(i * 137.50776L, 360.0L), std::asin((i + 0.5L) / 1000 - 1) / kDegree});
    return rays;
}
/// Pixels of every face; of a picture without faces, also as far again around it.
std::vector<Numbers> many_pixels(const Chart& chart) {
    const int around = has_faces(chart.projection()) ? 0 : 1;
    std::vector<Numbers> pixels;
    for (const Piece& piece : chart.pieces()) {
        const Box& box = piece.box;
        for (int i = 0; i < 60; ++i)
            for (int j = 0; j < 60; ++j) {
                const Real x = (i + 0.5L) / 60 * (1 + 2 * around) - around,
                           y = (j + 0.5L) / 60 * (1 + 2 * around) - around;
                pixels.push_back({box.x0 + box.width() * x, box.y0 + box.height() * y});
            }
    }
    return pixels;
}

/// What a group says of all rays or pixels.
Complaints compare_all(const Group& group, const Chart& chart) {
    Complaints wrong;
    const TwoWays two = ways_of_chart(chart);
    for (const std::string& side : group.all) {
        const std::size_t from = side == kProjectionFiles.sides[1] ? 1 : 0;
        for (const Numbers& given : from == 0 ? many_rays() : many_pixels(chart))
            if (wrong.empty() && !two.map[from](given))
                wrong.push_back(group.at + ": not all: " + side + " " + written(given) + " has none");
    }
    return wrong;
}

// --- files

/// What is wrong with the groups of a file.
using Compare = std::function<Complaints(const std::string& file, const std::vector<Group>&)>;

Complaints compare_text(const FileKind& kind, const std::string& file, std::istream& in,
                        const Compare& compare) {
    try {
        const std::vector<Group> groups = read_places(kind, file, in);
        Complaints wrong = compare(file, groups);
        std::size_t count = 0;
        for (const Group& group : groups) count += group.places.size();
        if (count < kFewest)
            wrong.push_back(file + ": has " + std::to_string(count) + " places, must have at least " +
                            std::to_string(kFewest) + kFormat);
        return wrong;
    } catch (const std::exception& e) {
        return {std::string(e.what()) + "\n" + file + kFormat};
    }
}

/// A toy's file is among the toys.
Complaints compare_file(const FileKind& kind, const std::string& name, const Compare& compare) {
    const std::string file = kind.folder + "/" + name + ".txt";
    for (const std::string folder : {ANAMORPH_PLACES "/", ANAMORPH_TOY_PLACES "/"})
        if (std::ifstream in(folder + file); in) return compare_text(kind, folder + file, in, compare);
    return {ANAMORPH_PLACES "/" + file + " is missing" + kFormat};
}

void expect_none(const Complaints& complaints) {
    for (const std::string& complaint : complaints) ADD_FAILURE() << complaint;
}

Compare compare_projection(const std::string& projection) {
    return [projection](const std::string& file, const std::vector<Group>& groups) {
        Complaints wrong = compare_both_ways(kProjectionFiles, file, groups, [&](const Group& group) {
            group.allow({"size", "fov", "pixels", "d", "e", "lens"});
            return ways_of_chart(chart_of(group, projection));
        });
        for (const Group& group : groups) append(wrong, compare_all(group, chart_of(group, projection)));
        return wrong;
    };
}

TEST(Places, OfEveryProjection) {
    for (const Projection projection : kProjections) {
        const std::string name(name_of(projection));
        expect_none(compare_file(kProjectionFiles, name, compare_projection(name)));
    }
}

/// The models in the list, without none: they are told to who asks for one that is not there.
Words lens_models() {
    std::string text;
    try {
        LensModel::parse("?");
    } catch (const Error& e) {
        text = e.what();
    }
    const std::string before = "one of none, ";
    std::istringstream in(text.substr(text.find(before) + before.size()));
    Words models;
    for (std::string word; std::getline(in, word, ',');)
        models.push_back(word.substr(word.find_first_not_of(' ')));
    return models;
}

Compare compare_lens(const std::string& model) {
    return [model](const std::string& file, const std::vector<Group>& groups) {
        return compare_both_ways(kLensFiles, file, groups, [&](const Group& group) {
            group.allow({"projection", "size", "fov", "pixels", "lens"});
            if (!group.setting("lens", "").starts_with(model + ":"))
                refuse(group.at, "lens must be of " + model);
            return ways_of_lens(chart_of(group, group.setting("projection", "")));
        });
    };
}

TEST(Places, OfEveryLens) {
    EXPECT_THAT(lens_models(), Contains("kb4"));
    for (const std::string& model : lens_models())
        expect_none(compare_file(kLensFiles, model, compare_lens(model)));
}

// --- surfaces

template <class Formula>
Numbers normal_of(const SurfaceShape& shape, const Numbers& at) {
    if constexpr (requires(const Formula& formula) { formula.normal(0.0, 0.0); }) {
        const auto normal = Formula(shape).normal(double(at[0]), double(at[1]));
        return {normal.x, normal.y, normal.z};
    } else {
        return {};
    }
}

/// In the order of surface_names().
constexpr Numbers (*kNormals[])(const SurfaceShape&, const Numbers&) = {
#define ANAMORPH_SURFACE(name, Type) normal_of<shapes::Type>,
#include "anamorph/surface/shape/list.h"
#undef ANAMORPH_SURFACE
};

constexpr std::pair<const char*, double SurfaceShape::*> kMembers[] = {
    {"aspect", &SurfaceShape::aspect},
    {"radius", &SurfaceShape::radius},
    {"angle", &SurfaceShape::angle},
    {"tube", &SurfaceShape::tube},
    {"amplitude", &SurfaceShape::amplitude},
    {"wavelength", &SurfaceShape::wavelength},
    {"phase", &SurfaceShape::phase},
    {"direction", &SurfaceShape::direction},
    {"turn", &SurfaceShape::turn}};

SurfaceShape shape_of(const Group& group) {
    SurfaceShape shape;
    Words names;
    for (const auto& [name, member] : kMembers) {
        names.emplace_back(name);
        if (const std::string value = group.setting(name, ""); !value.empty())
            shape.*member = double(number_of(group.at, value));
    }
    group.allow(names);
    return shape;
}

Complaints compare_vectors(const Place& place, const std::string& what, const Numbers& found,
                           const Numbers& wanted) {
    Real off = found.size() == wanted.size() ? 0 : HUGE_VAL;
    for (std::size_t i = 0; i < std::min(found.size(), wanted.size()); ++i)
        off = std::hypot(off, found[i] - wanted[i]);
    if (off <= place.tolerance[0]) return {};
    return {place.at + ": " + what + " is " + written(found) + ", expected " + written(wanted) + ", " +
            written(Numbers{off}) + " off"};
}

Compare compare_surface(std::size_t which) {
    return [which](const std::string&, const std::vector<Group>& groups) {
        Complaints wrong;
        for (const Group& group : groups) {
            const SurfaceShape shape = shape_of(group);
            const auto surface = make_surface(which, shape);
            for (const Place& place : group.places) {
                const glm::dvec3 p = surface->position(double(place.accept[0]), double(place.accept[1]));
                append(wrong, compare_vectors(place, "point", {p.x, p.y, p.z}, *place.expect));
                append(wrong,
                       compare_vectors(place, "normal", kNormals[which](shape, place.accept), place.normal));
            }
        }
        return wrong;
    };
}

TEST(Places, OfEverySurface) {
    for (std::size_t which = 0; which < surface_names().size(); ++which) {
        EXPECT_EQ(has_smooth_normals(which), !kNormals[which]({}, {0.5, 0.5}).empty());
        expect_none(compare_file(kSurfaceFiles, surface_names()[which], compare_surface(which)));
    }
}

// --- maps

/// A recipe's text with the keys of a group.
ParameterValues values_of_map(const std::string& map, const Group& group) {
    std::ifstream in(ANAMORPH_MAPS "/" + map + ".map");
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    ParameterValues values(*find_operation("map")->parameters);
    values.assign(parse_recipe(text));
    std::vector<Assignment> own;
    for (const auto& [key, value] : group.settings)
        if (key != "picture" && key != "source") own.push_back({key, value});
    values.assign(own);
    return values;
}

Size size_of(const Group& group, const std::string& name) {
    int width = 0, height = 0;
    if (std::sscanf(group.setting(name, "").c_str(), "%dx%d", &width, &height) != 2)
        refuse(group.at, name + "=WIDTHxHEIGHT is missing");
    return {width, height};
}

PlaneFormula formula_of_map(const std::string& map, const Group& group) {
    const ParameterValues values = values_of_map(map, group);
    FormulaText text;
    text.u = values.text("u");
    text.v = values.text("v");
    text.definitions = values.definitions();
    return parse_formula(text, {size_of(group, "picture"), size_of(group, "source"), values.number("frame"),
                                false, values.text("direction") == "push"});
}

std::optional<Numbers> point_of_map(const PlaneFormula& formula, const Numbers& at) {
    const double x = double(at[0]), y = double(at[1]);
    if (!formula.is_everywhere && !(read_program<2>(formula.domain, x, y)[0] > 0)) return {};
    const auto p = read_program<2>(formula.point, x, y);
    return Numbers{p[0], p[1]};
}

/// What a group says of all points of its picture, or of its source.
Complaints compare_all(const Group& group, const PlaneFormula& formula, const Size& size) {
    if (group.all.empty()) return {};
    for (int i = 0; i <= 60; ++i)
        for (int j = 0; j <= 60; ++j) {
            const Numbers at{Real(size.width) * i / 60, Real(size.height) * j / 60};
            if (!point_of_map(formula, at))
                return {group.at + ": not all: point " + written(at) + " has none"};
        }
    return {};
}

bool shows_end(const std::vector<Place>& places) {
    for (const Place& out : places)
        for (const Place& in : places)
            if (!out.expect && in.expect && pixels_apart(out.accept, in.accept) <= 1) return true;
    return false;
}

Compare compare_map(const std::string& map) {
    return [map](const std::string& file, const std::vector<Group>& groups) {
        Complaints wrong;
        bool ends = false, ended = false;
        for (const Group& group : groups) {
            const PlaneFormula formula = formula_of_map(map, group);
            const bool pushes = values_of_map(map, group).text("direction") == "push";
            append(wrong, compare_all(group, formula, size_of(group, pushes ? "source" : "picture")));
            for (const Place& place : group.places) {
                const std::optional<Numbers> found = point_of_map(formula, place.accept);
                if (found && place.expect)
                    append(wrong, compare_vectors(place, "point", *found, *place.expect));
                else if (found || place.expect)
                    wrong.push_back(place.at + ": point is " + written(found) + ", expected " +
                                    written(place.expect));
            }
            ends = ends || !formula.is_everywhere;
            ended = ended || shows_end(group.places) || !group.all.empty();
        }
        if (ends && !ended) wrong.push_back(file + ": no place shows where it ends" + kFormat);
        return wrong;
    };
}

TEST(Places, OfEveryMap) {
    int count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(ANAMORPH_MAPS)) {
        if (entry.path().extension() != ".map") continue;
        ++count;
        const std::string name = entry.path().stem().string();
        expect_none(compare_file(kMapFiles, name, compare_map(name)));
    }
    EXPECT_GT(count, 0);
}

// --- what is demanded of files

Complaints compare_fisheye(const std::string& text) {
    std::istringstream in(text);
    return compare_text(kProjectionFiles, "f", in, compare_projection("fisheye"));
}

const std::string kMiddle = "accept 0 0\nexpect 50 50\n";
/// Ten places of a fisheye that shows all of the sphere.
const std::string kFisheye = "chart size=100x100 fov=360\ntolerance 1e-9 1e-9\n" + kMiddle + kMiddle +
                             kMiddle + kMiddle + kMiddle + kMiddle + kMiddle + kMiddle +
                             "accept pixel 99.9 50\nexpect 179.64 0\naccept pixel 100.1 50\nexpect none\n";

TEST(Places, AFileThatIsMissingIsNamedWithItsFormat) {
    const Complaints wrong = compare_file(kProjectionFiles, "nowhere", compare_projection("fisheye"));
    ASSERT_EQ(wrong.size(), 1u);
    EXPECT_THAT(wrong[0], HasSubstr("places/projection/nowhere.txt is missing"));
    EXPECT_THAT(wrong[0], HasSubstr("tolerance 1e-9"));
}

TEST(Places, AreManyAndShowWhereThingsEnd) {
    EXPECT_THAT(compare_fisheye(kFisheye + "all ray\n"), IsEmpty());
    EXPECT_THAT(compare_fisheye(kFisheye),
                Contains(HasSubstr("f: no place of side ray shows where it ends")));
    EXPECT_THAT(compare_fisheye(kFisheye + "all ray\nall pixel\n"),
                Contains(HasSubstr("f:1: not all: pixel")));
    EXPECT_THAT(compare_fisheye("chart size=100x100\ntolerance 1 1\n" + kMiddle),
                Contains(HasSubstr("f: has 1 places, must have at least 8")));
}

TEST(Places, AreComparedBothWays) {
    const auto wrong = [](const std::string& more) { return compare_fisheye(kFisheye + "all ray\n" + more); };
    EXPECT_THAT(wrong("accept 18 0\nexpect 55.001 50\n"),
                testing::ElementsAre(HasSubstr("f:24: ray 18 0 has 55"), HasSubstr("f:24: pixel 55.001")));
    EXPECT_THAT(wrong("accept ray 18 0\nexpect 55.001 50\n").size(), 1u);
    EXPECT_THAT(wrong("accept 18 0\nexpect none\n"), Contains(HasSubstr("expected none")));
    EXPECT_THAT(wrong("accept pixel 0 0\nexpect 10 20\n"), Contains(HasSubstr("has none, expected 10 20")));
}

TEST(Places, FilesAreReadStrictly) {
    const std::pair<const char*, const char*> cases[] = {
        {"accept 1 2\n", "f:23: no expect follows"},
        {"accept 1 2\naccept 1 2\n", "f:23: no expect follows"},
        {"expect 1 2\n", "f:23: no accept stands before"},
        {"accept 1\n", "f:23: must have 2 numbers"},
        {"accept 1 2,5\n", "f:23: 2,5 is no number"},
        {"tolerance inf 1\n", "f:23: inf is no number"},
        {"accept sky 1 2\n", "f:23: must have 2 numbers"},
        {"exspect 1 2\n", "f:23: unknown: exspect"},
        {"normal 0 0 1\n", "f:23: unknown: normal"},
        {"all sky\n", "f:23: unknown: all"},
        {"tolerance 1e-9\n", "f:23: must have 2 numbers"},
        {"chart size=100x100 radius=2\n", "f:23: unknown: radius"},
        {"chart size=100x100 radius\n", "f:23: unknown: radius"},
        {"chart size=100x100 fov=1 fov=2\n", "f:23: fov stands there twice"},
        {"chart fov=100\n", "f:23: size=WIDTHxHEIGHT is missing"},
        {"chart size=100x100 pixels=corners\n", "f:23: pixels must be edges or centers"},
        {"chart size=100x100 fov=400\n", "f:23: fov=400: must be"}};
    for (const auto& [line, complaint] : cases)
        EXPECT_THAT(compare_fisheye(kFisheye + line), Contains(testing::StartsWith(complaint))) << line;
    EXPECT_THAT(compare_fisheye("accept 1 2\n"), Contains(HasSubstr("f:1: no tolerance stands before")));
    EXPECT_THAT(compare_fisheye("tolerance 1 1\naccept 1 2\n"),
                Contains(HasSubstr("f:2: no chart stands before")));
}

}  // namespace
}  // namespace anamorph::test_places
