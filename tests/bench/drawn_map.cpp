// SPDX-License-Identifier: Apache-2.0
#include "drawn_map.h"

#include <optional>

#include "anamorph/image/picture.h"
#include "anamorph/image/pyramid.h"

namespace anamorph::bench {

PlanOptions options_of(double tol) {
    PlanOptions options;
    options.tol = tol;
    return options;
}

MapDrawing::MapDrawing(const Settings& settings)
    : m_settings(settings),
      m_pool(settings.threads),
      m_texels(bytes_of(4 * settings.size, 2 * settings.size)),
      m_picture(bytes_of(settings.size, settings.size)) {
    float* values = m_texels.as<float>();
    const std::size_t count = bytes_of(4 * settings.size, 2 * settings.size) / sizeof(float);
    for (std::size_t i = 0; i < count; ++i) values[i] = static_cast<float>(i * 2654435761u % 65536) / 65536;
}

void MapDrawing::draw(const DrawnMap& map, const PlanOptions& options, Filter filter) {
    draw(map, map.plan(options), filter);
}

void MapDrawing::draw(const DrawnMap& map, const std::shared_ptr<const BlockMap>& blocks, Filter filter) {
    Picture picture;
    picture.maps = {{blocks, {{Border(map.source, Wrap::automatic)}}}};
    picture.filter = filter;
    const MemorySource texels(packed_view<const std::byte>(m_texels.bytes(), PixelType::float32,
                                                           map.source.width(), map.source.height(), 3));
    std::optional<Pyramid> pyramid;
    if (filter == Filter::antialias) pyramid.emplace(texels);
    const Source* const source = pyramid ? static_cast<const Source*>(&*pyramid) : &texels;
    const int side = m_settings.size;
    picture.draw(source, {0, 0, side, side},
                 packed_view(m_picture.bytes(), PixelType::float32, side, side, 3), m_pool.parallel_for());
}

void MapDrawing::plan(const DrawnMap& map, const PlanOptions& options) {
    static_cast<void>(map.plan(options)->reached(m_pool.parallel_for()));
}

std::size_t MapDrawing::bytes_of(int width, int height) {
    return sizeof(float) * 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
}

Row row_of(const Settings& settings, const DrawnMap& map, const PlanOptions& options) {
    const Reached reached = map.plan(options)->reached(serial_for);
    Row row;
    row.case_name = map.name;
    row.tol_px = options.tol;
    row.size = settings.size;
    row.threads = settings.threads;
    row.ratio_to_exact = kNone;
    row.bound_px = reached.max_error;
    row.exact_fraction = reached.exact_fraction;
    return row;
}

void time_all(const Settings& settings, Report& report, std::vector<TimedRow>& timed) {
    std::vector<Timed> contenders;
    for (const TimedRow& t : timed) contenders.push_back({t.draw, settings.threads});
    const std::vector<Times> times = time_interleaved(contenders, settings.rounds);
    const double pixels = double(settings.size) * settings.size;
    for (std::size_t k = 0; k < timed.size(); ++k) {
        timed[k].row.ns_per_px = times[k].median / pixels;
        timed[k].row.best_ns_per_px = times[k].best / pixels;
        timed[k].row.sharing = times[k].sharing;
        report.add(timed[k].row);
    }
}

}  // namespace anamorph::bench
