// SPDX-License-Identifier: Apache-2.0
// The block machine of 1987 (Oka, section 3) beside the plain drape of the same picture: the time of a frame in this
// program, cycles and frames a second of the machine, errors on the screen in pixels.
//
// A picture of n x n, three channels of floats, lies on waves before a screen as large. `drape` holds 1/8 of a pixel; blocks of
// 8 and of 4 are the machine's. The times faster are over `drape`.
#include "block_machine.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/machine/block_machine_map.h"
#include "anamorph/machine/block_pixels.h"
#include "anamorph/machine/block_schedule.h"
#include "anamorph/surface/drape.h"
#include "pixels.h"

namespace anamorph::bench {
using namespace machine;
using namespace surface;
namespace {

constexpr int kLeastSide = 512;

/// A picture on waves.
class Waves {
  public:
    explicit Waves(int side) : m_size{side, side}, m_texels(bytes()), m_picture(bytes()) {
        float* values = m_texels.as<float>();
        for (std::size_t i = 0; i < bytes() / sizeof(float); ++i)
            values[i] = static_cast<float>(i * 2654435761u % 65536) / 65536;
        m_surface = std::make_shared<SharedTree>(make_surface(waves_number(), SurfaceShape{}));
        m_pose.position = {0.3, 0.2, 1.3};
        m_options.tol = 0.125;
        m_options.filter = Filter::bilinear;
    }

    Drape drape(Output output) const {
        DrapeOptions options = m_options;
        options.output = output;
        return {m_surface, camera(), m_size, options};
    }
    void draw_plain() { drape(Output::color).draw(&source(), whole(), view(), serial_for); }

    std::shared_ptr<const BlockMachineMap> map(const BlockMachine& machine) const {
        return std::make_shared<BlockMachineMap>(
            machine, std::shared_ptr<const DrapedSurface>(m_surface, &m_surface->tree.surface()), camera(),
            m_size);
    }
    void draw(const BlockMachine& machine) {
        const Chart flat(Projection::rectilinear, m_size.width, m_size.height);
        BlockPixels(map(machine), machine, Border(flat, Wrap::clamp), m_options.filter)
            .draw(&source(), whole(), view(), serial_for);
    }
    static SurfaceCost cost() { return cost_of({.parts = {{waves_number()}}}); }
    /// How far what is shown is from where it belongs, of all pixels where something is.
    Accuracy accuracy(const BlockMachineMap& map) const {
        std::vector<float> errors;
        for (int y = 0; y < m_size.height; ++y)
            for (int x = 0; x < m_size.width; ++x)
                if (map.frame().block[map.frame().index(x, y)] != BlockFrame::kNone)
                    errors.push_back(static_cast<float>(map.landing_error(x, y)));
        return accuracy_of(errors);
    }
    /// The same of the plain drape.
    Accuracy plain_accuracy() const {
        std::vector<float> errors(static_cast<std::size_t>(m_size.width) *
                                  static_cast<std::size_t>(m_size.height));
        drape(Output::error)
            .draw(nullptr, whole(),
                  packed_view(reinterpret_cast<std::byte*>(errors.data()), PixelType::float32, m_size.width,
                              m_size.height, 1),
                  serial_for);
        std::erase(errors, 0.0f);
        return accuracy_of(errors);
    }
    const Size& size() const { return m_size; }

  private:
    static std::size_t waves_number() {
        const auto& names = surface_names();
        return static_cast<std::size_t>(std::find(names.begin(), names.end(), "waves") - names.begin());
    }
    std::size_t bytes() const {
        return 3 * sizeof(float) * static_cast<std::size_t>(m_size.width) *
               static_cast<std::size_t>(m_size.height);
    }
    Box whole() const { return {0, 0, m_size.width, m_size.height}; }
    Camera camera() const { return Camera(m_pose, glm::dmat3(1.0), glm::dvec3(0.0), m_size); }
    const MemorySource& source() {
        m_source = std::make_unique<MemorySource>(packed_view<const std::byte>(
            m_texels.bytes(), PixelType::float32, m_size.width, m_size.height, 3));
        return *m_source;
    }
    ImageView view() {
        return packed_view(m_picture.bytes(), PixelType::float32, m_size.width, m_size.height, 3);
    }

    Size m_size;
    Buffer m_texels, m_picture;
    std::unique_ptr<MemorySource> m_source;
    std::shared_ptr<SharedTree> m_surface;
    CameraPose m_pose;
    DrapeOptions m_options;
};

Row row_of(const std::string& scheme, int side) {
    Row row;
    row.op = "machine";
    row.case_name = "blocks-" + std::to_string(side);
    row.scheme = scheme;
    row.size = side;
    return row;
}

}  // namespace

void measure_blocks(const Settings& settings, Report& report, int side) {
    if (side > kLeastSide && side > settings.size) return;
    side = std::min(side, settings.size);
    if (!settings.wants_case("blocks-" + std::to_string(side))) return;
    Waves waves(side);
    std::vector<Row> rows(1, row_of("drape", side));
    rows[0].tol_px = 0.125;
    rows[0].error = waves.plain_accuracy();
    rows[0].bound_px = waves.drape(Output::color).reached(serial_for).max_error;
    std::vector<Timed> timed(1, {[&] { waves.draw_plain(); }, 1});
    for (const int block : {8, 4}) {
        BlockMachine machine;
        machine.block = block;
        Row row = row_of("oka-1987-" + std::to_string(block), side);
        if (!settings.wants_scheme(row.scheme)) continue;
        const auto map = waves.map(machine);
        const MachineSchedule schedule =
            schedule_of(machine, map->frame().counts, waves.cost(), waves.size(), waves.size());
        row.error = waves.accuracy(*map);
        row.cycles = schedule.bottleneck().cycles;
        row.frames_per_second = 1000 / schedule.shown_ms();
        timed.push_back({[&waves, machine] { waves.draw(machine); }, 1});
        rows.push_back(row);
    }
    const std::vector<Times> times = time_interleaved(timed, settings.rounds);
    for (std::size_t k = 0; k < rows.size(); ++k) {
        rows[k].ns_per_px = times[k].median / (double(side) * side);
        rows[k].best_ns_per_px = times[k].best / (double(side) * side);
        rows[k].ratio_to_exact = times[0].median / times[k].median;
        report.add(rows[k]);
        if (k > 0)
            report.add_limit(rows[k].case_name + ", " + rows[k].scheme + ": times the plain drape", 10,
                             times[k].median / times[0].median);
    }
}

}  // namespace anamorph::bench
