// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/bump_unit.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "anamorph/error.h"
#include "anamorph/panorama/panorama_plan.h"

namespace anamorph::machine {
namespace {

/// A texture holds one image, of limited size.
const Panorama& checked(const Panorama& map, const BumpUnit& unit) {
    if (map.source().pieces().size() > 1)
        throw Error("machine: the source must be one image and no cube map; its projection is " +
                    std::string(name_of(map.source().projection())));
    check_texture_side(map.source_size(), unit.texture_side);
    return map;
}

PlanOptions exactly() {
    PlanOptions options;
    options.scheme = Scheme::exact;
    options.tol = 0;
    return options;
}

/// The linear part of pixels, in texture coordinates and for screen coordinates from -1 to 1.
LinearPart in_texture_coordinates(const LinearPart& pixels, const Box& box, const Size& source) {
    const auto divided = [&](const Point<double>& p, double k) {
        return Point<double>{p.x * k / source.width, p.y * k / source.height};
    };
    return {0, 0, divided(pixels.origin, 1), divided(pixels.right, 0.5 * box.width()),
            divided(pixels.down, 0.5 * box.height())};
}

std::vector<std::array<double, 2>> own_coordinates(int size, const NumberFormat& format) {
    std::vector<std::array<double, 2>> texels;
    const auto at = [&](int i) { return nearest(format, (i + 0.5) / size); };
    for (int j = 0; j < size; ++j)
        for (int i = 0; i < size; ++i) texels.push_back({at(i), at(j)});
    return texels;
}

}  // namespace

BumpStage::BumpStage(const Panorama& map, int piece, const BumpUnit& unit) : m_unit(unit) {
    const LinearPart linear = linear_part(map, piece);
    const Box box = map.target_pieces()[static_cast<std::size_t>(piece)];
    m_linear = in_texture_coordinates(linear, box, map.source_size());
    if (unit.size > 0) make_bumps(map, piece, linear);
}

/// The residuals at the texels' centres, in texture coordinates.
std::vector<std::array<double, 2>> BumpStage::residuals(const Panorama& map, int piece,
                                                        const LinearPart& linear) const {
    const Box box = map.target_pieces()[static_cast<std::size_t>(piece)];
    const Size source = map.source_size();
    std::vector<std::array<double, 2>> all;
    for (int j = 0; j < m_unit.size; ++j)
        for (int i = 0; i < m_unit.size; ++i) {
            const double x = box.x0 + (i + 0.5 - m_first) / m_span * box.width();
            const double y = box.y0 + (j + 0.5 - m_first) / m_span * box.height();
            Point<double> r = residual_at(map, linear, map.local_around(x, y, piece), x, y);
            // Around the source the nearest way is taken.
            if (map.period() > 0) r.x -= std::round(r.x / map.period()) * map.period();
            // Where the map has no point there is nothing to be perturbed.
            if (!std::isfinite(r.x) || !std::isfinite(r.y)) r = {0, 0};
            all.push_back({r.x / source.width, r.y / source.height});
        }
    return all;
}

void BumpStage::make_bumps(const Panorama& map, int piece, const LinearPart& linear) {
    const bool border = m_unit.edge == BumpUnit::Edge::border && m_unit.size > 2;
    m_span = border ? m_unit.size - 2 : m_unit.size;
    m_first = border ? 1 : 0;
    std::vector<std::array<double, 2>> texels = residuals(map, piece, linear);
    for (std::size_t c = 0; c < 2; ++c) {
        double most = 0;
        for (const auto& texel : texels) most = std::max(most, std::fabs(texel[c]));
        if (m_unit.scaled && m_unit.texel.kind == NumberFormat::Kind::fixed && most > 0)
            m_scale[c] = most / largest(m_unit.texel);
    }
    for (auto& texel : texels) {
        bool beyond = false;
        for (std::size_t c = 0; c < 2; ++c) texel[c] = nearest(m_unit.texel, texel[c] / m_scale[c], beyond);
        m_saturated += beyond;
    }
    m_bumps = std::make_unique<MachineTexture<2>>(m_unit.size, m_unit.weight_bits, std::move(texels));
}

UnitCoordinates BumpStage::operator()(double s, double t) const {
    return with_format(m_unit.arithmetic, [&](auto number) {
        using T = decltype(number);
        Point<T> at = m_linear.at(T(2 * s - 1), T(2 * t - 1));
        if (m_bumps) {
            const T across(s), down(t);
            const auto bump =
                m_bumps->template read<T>(across.value * m_span + m_first, down.value * m_span + m_first);
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
      m_pieces(map.target_pieces()) {
    for (std::size_t piece = 0; piece < m_pieces.size(); ++piece)
        m_stages.emplace_back(map, static_cast<int>(piece), unit);
}

int BumpedPanorama::saturated_texels() const {
    int all = 0;
    for (const BumpStage& stage : m_stages) all += stage.saturated_texels();
    return all;
}

UnitCoordinates BumpedPanorama::coordinates(int x, int y, int piece) const {
    const auto i = static_cast<std::size_t>(piece);
    const Box& box = m_pieces[i];
    return m_stages[i]((x + 0.5 - box.x0) / box.width(), (y + 0.5 - box.y0) / box.height());
}

double BumpedPanorama::rounding(const Box& box, int piece) const {
    return m_map.exact_error<double>({box.x0 + 0.5, box.x1 - 0.5}, {box.y0 + 0.5, box.y1 - 0.5}, piece);
}

}  // namespace anamorph::machine
