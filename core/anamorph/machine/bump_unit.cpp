// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/bump_unit.h"

#include <algorithm>
#include <cmath>
#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

#include "anamorph/error.h"
#include "anamorph/machine/bump_table.h"
#include "anamorph/panorama/panorama_plan.h"

namespace anamorph::machine {
namespace {

/// What section 4.4 says of a card.
struct CardFacts {
    BumpCard card;
    const char* name;
    bool per_pixel;  ///< can it perturb coordinates that both stages project per pixel (4.4.1)?
    bool sixteen;    ///< has it bump maps of V16U16 (4.4.3)?
};
constexpr CardFacts kCards[] = {
    {BumpCard::reference, "reference", true, true},   {BumpCard::geforce3, "geforce3", false, false},
    {BumpCard::geforce4, "geforce4", true, false},    {BumpCard::radeon, "radeon", false, false},
    {BumpCard::radeon8500, "radeon8500", true, true}, {BumpCard::radeon9700, "radeon9700", true, true}};

const CardFacts* facts_of(BumpCard card) {
    const auto* found = std::find_if(std::begin(kCards), std::end(kCards),
                                     [&](const CardFacts& f) { return f.card == card; });
    return found == std::end(kCards) ? nullptr : found;
}

const Panorama& checked(const Panorama& map, const BumpUnit& unit) {
    check_card(unit);
    check_texture_side(map.source_size(), unit.texture_side);
    return map;
}

PlanOptions exactly() {
    PlanOptions options;
    options.scheme = Scheme::exact;
    options.tol = 0;
    return options;
}

std::vector<std::array<double, 2>> own_coordinates(int size, const NumberFormat& format) {
    std::vector<std::array<double, 2>> texels;
    const auto at = [&](int i) { return nearest(format, (i + 0.5) / size); };
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) texels.push_back({at(i), at(j)});
    return texels;
}

/// Does a bump map have texels that lie outside of the plane's range?
bool has_border(const BumpUnit& unit) {
    return unit.edge == BumpUnit::Edge::border && unit.size > 2;
}

glm::dvec3 eye_ray(const EyeCorners& eye, double s, double t) {
    return {eye.first + (eye.last - eye.first) * glm::dvec2(s, t), 1.0};
}

}  // namespace

void check_card(const BumpUnit& unit) {
    const CardFacts* card = facts_of(unit.card);
    if (!card) return;
    const std::string with = std::string(" with card=") + card->name;
    if (unit.projecting == BumpUnit::Projecting::pixel && !card->per_pixel)
        throw Error("machine: projecting", "pixel",
                    "must be vertex" + with + ", which perturbs no coordinates that are projected per pixel");
    const bool fits = unit.texel == kSigned8 || (unit.texel == kSigned16 && card->sixteen);
    if (!fits && unit.size > 0)
        throw Error("machine: texel", name_of(unit.texel),
                    std::string("must be V8U8") + (card->sixteen ? " or V16U16" : "") + with);
}

void check_on_scene(const BumpUnit& unit, const Chart& source) {
    const auto refuse = [](const char* key, const std::string& value, const std::string& rule) {
        throw Error(std::string("machine: ") + key, value, rule + " on a scene");
    };
    if (unit.projecting != BumpUnit::Projecting::pixel)
        refuse("projecting", "vertex", "must be pixel, which cards other than geforce3 and radeon can do,");
    if (unit.size < 2) refuse("size", std::to_string(unit.size), "must be at least 2");
    if (unit.edge != BumpUnit::Edge::clamp)
        refuse("edge", "border",
               "must be clamp, as the outer texels' centres lie on the border of the plane");
    if (unit.arithmetic != kFloat32)
        refuse("arithmetic", name_of(unit.arithmetic),
               "must be float32, in which the graphics card computes,");
    constexpr auto kAddressBits = static_cast<int>(kBumpAddressRow.standard);
    if (unit.address_bits != kAddressBits)
        refuse("address_bits", std::to_string(unit.address_bits),
               "must be " + std::to_string(kAddressBits) + ", as the graphics card reads the panorama,");
    check_bump_source(source);
    check_texture_side({source.width(), source.height()}, unit.texture_side);
}

NumberFormat texel_of(BumpCard card) {
    const CardFacts* facts = facts_of(card);
    return facts && !facts->sixteen ? kSigned8 : kSigned16;
}

std::string name_of(BumpCard card) {
    const CardFacts* facts = facts_of(card);
    return facts ? facts->name : "any";
}

BumpStage::BumpStage(const Chart& source, const Chart& target, const ProjectionPlane& plane,
                     const BumpUnit& unit)
    : m_unit(unit), m_eye(eye_corners(target)) {
    set_matrices(plane);
    set_corners(plane);
    if (unit.size > 0) make_bumps(source, plane);
}

/// Eq. 4.5, by rows: those of M0 lead to u q, v q and q.
void BumpStage::set_matrices(const ProjectionPlane& plane) {
    const glm::dmat3 rows = glm::transpose(plane.from_eye);
    // Of the bump map the range covers all but the outermost texels, or all of it.
    const double covered = has_border(m_unit) ? (m_unit.size - 2.0) / m_unit.size : 1;
    const auto matrix = [&](const glm::dvec2& by, const glm::dvec2& centre) {
        return glm::transpose(
            glm::dmat3(rows[0] * by.x + rows[2] * centre.x, rows[1] * by.y + rows[2] * centre.y, rows[2]));
    };
    m_linear = matrix({plane.right, plane.down}, plane.centre);
    m_bump = matrix(0.5 * covered / glm::dvec2(plane.x_max, plane.y_max), glm::dvec2(0.5));
}

/// Section 4.5.1: coordinates by matrices and a division, in double, and from these what hardware interpolates.
void BumpStage::set_corners(const ProjectionPlane& plane) {
    for (const glm::dvec2& corner : plane.corners) {
        const glm::dvec3 ray(corner, 1.0), linear = m_linear * ray, bump = m_bump * ray;
        m_corners.push_back({(corner - m_eye.first) / (m_eye.last - m_eye.first),
                             {linear.x, linear.y, bump.x, bump.y, linear.z}});
    }
}

void BumpStage::make_bumps(const Chart& source, const ProjectionPlane& plane) {
    const double first = has_border(m_unit) ? 1 : 0, span = m_unit.size - 2 * first;
    const auto place = [&](int i, double most) { return ((i + 0.5 - first) / span * 2 - 1) * most; };
    BumpTexels residuals;
    for (int j = 0; j < m_unit.size; ++j)
        for (int i = 0; i < m_unit.size; ++i) {
            const glm::dvec2 r = plane_residual(source, plane, place(i, plane.x_max), place(j, plane.y_max));
            residuals.push_back({r.x, r.y});
        }
    BumpTable table = bump_table(residuals, m_unit.texel, m_unit.scaled);
    m_scale = table.scale;
    m_saturated = table.saturated;
    m_bumps = std::make_unique<MachineTexture<2>>(m_unit.size, m_unit.weight_bits, std::move(table.texels));
}

/// What a pixel divides: Corner::numbers there.
template <class T>
std::array<T, 5> BumpStage::numbers_at(double s, double t) const {
    std::array<T, 5> numbers;
    if (m_unit.projecting == BumpUnit::Projecting::pixel) {
        const glm::dvec3 eye = eye_ray(m_eye, s, t);
        const auto row = [&](const glm::dmat3& m, int i) {
            return T(eye.x) * T(m[0][i]) + T(eye.y) * T(m[1][i]) + T(eye.z) * T(m[2][i]);
        };
        return {row(m_linear, 0), row(m_linear, 1), row(m_bump, 0), row(m_bump, 1), row(m_linear, 2)};
    }
    // The triangle of the fan: the first whose far side, a diagonal or the last edge, the point is not beyond.
    const glm::dvec2 from = glm::dvec2(s, t) - m_corners[0].screen;
    const auto across = [](const glm::dvec2& a, const glm::dvec2& b) { return a.x * b.y - a.y * b.x; };
    for (std::size_t k = 1; k + 1 < m_corners.size(); ++k) {
        const Corner &a = m_corners[0], &b = m_corners[k], &c = m_corners[k + 1];
        const glm::dvec2 to_b = b.screen - a.screen, to_c = c.screen - a.screen;
        const double area = across(to_b, to_c), of_b = across(from, to_c) / area,
                     of_c = across(to_b, from) / area;
        if (of_b < 0 && k + 2 < m_corners.size()) continue;
        for (std::size_t i = 0; i < numbers.size(); ++i) {
            const T first(a.numbers[i]);
            numbers[i] = first + (T(b.numbers[i]) - first) * T(of_b) + (T(c.numbers[i]) - first) * T(of_c);
        }
        break;
    }
    return numbers;
}

UnitCoordinates BumpStage::operator()(double s, double t) const {
    return with_format(m_unit.arithmetic, [&](auto number) {
        using T = decltype(number);
        const std::array<T, 5> n = numbers_at<T>(s, t);
        Point<T> at{n[0] / n[4], n[1] / n[4]};
        if (m_bumps) {
            const T across = n[2] / n[4], down = n[3] / n[4];
            const auto bump = m_bumps->template read<T>(across.value * m_unit.size, down.value * m_unit.size);
            at = {at.x + bump[0] * m_scale[0], at.y + bump[1] * m_scale[1]};
        }
        return UnitCoordinates{{at.x.value, at.y.value}, at.x.beyond || at.y.beyond};
    });
}

ReadBack::ReadBack(int size, const NumberFormat& format, int weight_bits)
    : m_format(format), m_texture(size, weight_bits, own_coordinates(size, format)) {}

Point<double> ReadBack::operator()(const Point<double>& at) const {
    const auto seen = m_texture.read<double>(at.x * m_texture.size(), at.y * m_texture.size());
    return {nearest(m_format, seen[0]), nearest(m_format, seen[1])};
}

BumpedPanorama::BumpedPanorama(const Panorama& map, const BumpUnit& unit)
    : MachineMap(std::make_shared<PanoramaPlan>(checked(map, unit), exactly()), map.target_pieces(),
                 map.source_size(), map.source().turn(), unit.address_bits),
      m_map(map),
      m_eye(eye_corners(map.target())) {
    const std::vector<ProjectionPlane> planes = projection_planes(map, unit.planes);
    for (const ProjectionPlane& plane : planes)
        m_stages.emplace_back(map.source(), map.target(), plane, unit);
    // Half of the angle between two directions is where their right axes' sum points to the right.
    for (std::size_t i = 1; i < planes.size(); ++i) {
        const glm::dmat3 a = glm::transpose(planes[i - 1].from_eye), b = glm::transpose(planes[i].from_eye);
        m_between.push_back(a[0] + b[0]);
    }
}

int BumpedPanorama::saturated_texels() const {
    int all = 0;
    for (const BumpStage& stage : m_stages) all += stage.saturated_texels();
    return all;
}

UnitCoordinates BumpedPanorama::at(double s, double t) const {
    const glm::dvec3 ray = eye_ray(m_eye, s, t);
    const auto is_right = [&](const glm::dvec3& normal) { return glm::dot(normal, ray) >= 0; };
    return m_stages[static_cast<std::size_t>(std::count_if(m_between.begin(), m_between.end(), is_right))](s,
                                                                                                           t);
}

UnitCoordinates BumpedPanorama::coordinates(int x, int y, int) const {
    return at((x + 0.5) / width(), (y + 0.5) / height());
}

double BumpedPanorama::rounding(const Box& box, int piece) const {
    return m_map.exact_error<double>({box.x0 + 0.5, box.x1 - 0.5}, {box.y0 + 0.5, box.y1 - 0.5}, piece);
}

}  // namespace anamorph::machine
