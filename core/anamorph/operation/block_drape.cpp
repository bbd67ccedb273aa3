// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/block_drape.h"

#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "anamorph/machine/block_machine_map.h"
#include "anamorph/machine/block_pixels.h"
#include "anamorph/machine/block_schedule.h"
#include "anamorph/machine/machine_text.h"
#include "anamorph/operation/solved.h"

namespace anamorph {
namespace {

/// A drape of the first source by the machine of 1987.
class SolvedByBlocks final : public SolvedPicture {
  public:
    explicit SolvedByBlocks(const BlockDrape& drape)
        : m_map(std::make_shared<machine::BlockMachineMap>(drape.machine, drape.surface, drape.camera,
                                                           drape.source)),
          m_machine(drape.machine),
          m_cost(cost_of(drape)),
          m_source(drape.source),
          m_shown(drape.shown) {
        const surface::DrapeOptions& options = drape.options;
        const Chart flat(Projection::rectilinear, drape.source.width, drape.source.height);
        if (options.output == Output::color && options.own == surface::DrapeOutput::shared)
            m_pixels.emplace(m_map, drape.machine, Border(flat, options.wrap), options.filter);
        if (m_pixels && options.lighting.shading != surface::DrapeShading::none)
            m_pixels->light({drape.machine, drape.surface, drape.camera, drape.source,
                             m_map->blocks_of_machine(), options.lighting},
                            options.alpha);
        m_picture = picture_through(m_map, Border(flat, options.wrap), options.filter, options.output);
        m_picture.data = drape.data;
        if (options.output == Output::error)
            m_picture.value = [map = m_map.get()](double x, double y) {
                return static_cast<float>(
                    map->landing_error(static_cast<int>(std::floor(x)), static_cast<int>(std::floor(y))));
            };
    }

    bool reached_by_drawing() const override { return true; }
    Attributes known() const override {
        return {{"anamorph:patches", static_cast<int>(m_map->blocks_of_machine().made())}};
    }
    Attributes reached(const ParallelFor& parallel_for) const override {
        const machine::BlockCounts& counts = m_map->frame(parallel_for).counts;
        const machine::MachineSchedule schedule =
            machine::schedule_of(m_machine, counts, m_cost, m_source, m_shown);
        return {{"anamorph:max_error", m_picture.reached(parallel_for).max_error},
                {"anamorph:exact_fraction", 0.0},
                {"anamorph:patches", static_cast<int>(counts.blocks)},
                {"anamorph:saturated_pixels", static_cast<double>(counts.saturated)},
                {"anamorph:cracks", static_cast<double>(counts.cracks)},
                {"anamorph:misordered_pixels", static_cast<double>(counts.misordered)},
                {"anamorph:blocks_left_out", static_cast<int>(counts.left_out)},
                {"anamorph:frame_ms", schedule.frame_ms()},
                {"anamorph:shown_ms", schedule.shown_ms()},
                {"anamorph:bottleneck", schedule.bottleneck().name}};
    }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        if (!m_pixels) return m_picture.draw(sources[0], box, view, parallel_for);
        if (!m_pixels->draw(sources[0], box, view, parallel_for)) return false;
        return m_picture.data.channels.empty() || draw_data(*sources[0], box, view, parallel_for);
    }
    std::unique_ptr<const SolvedPicture> of_moved() const override {
        return moved_channels(m_picture.data).empty() ? nullptr : solved(m_picture.of_data());
    }

  private:
    static machine::SurfaceCost cost_of(const BlockDrape& drape) {
        machine::SurfaceCost cost = machine::cost_of(drape.sum);
        cost.light = machine::cost_of(drape.options.lighting);
        return cost;
    }
    /// Draws channels that hold no colour, which are read at the machine's addresses, but hold no numbers of its format.
    bool draw_data(const Source& source, const Box& box, const ImageView& to,
                   const ParallelFor& parallel_for) const {
        const auto pixels = static_cast<std::size_t>(box.width()) * static_cast<std::size_t>(box.height());
        std::vector<std::byte> drawn(pixels * static_cast<std::size_t>(to.channels * size_of(to.type)));
        const ImageView from = packed_view(drawn.data(), to.type, box.width(), box.height(), to.channels);
        if (!m_picture.of_data().draw(&source, box, from, parallel_for)) return false;
        copy_channels(m_picture.data.channels, from, to, [](int, int) { return true; });
        return true;
    }

    std::shared_ptr<const machine::BlockMachineMap> m_map;
    machine::BlockMachine m_machine;
    machine::SurfaceCost m_cost;
    Size m_source, m_shown;
    std::optional<machine::BlockPixels> m_pixels;  ///< of colours
    Picture m_picture;
};

}  // namespace

std::optional<machine::BlockMachine> drape_machine(const ParameterValues& values,
                                                   const surface::DrapeOptions& options) {
    const machine::BlockMachine machine = values.given("machine")
                                              ? machine::block_machine_from_text(values.text("machine"))
                                              : machine::BlockMachine{};
    if (values.text("scheme") != "hardware") return {};
    if (options.own != surface::DrapeOutput::shared)
        throw Error("output", values.text("output"),
                    "must be color, stmap, error or bound with scheme=hardware");
    for (const char* name : {"background", "backdrop", "back"})
        if (values.given(name))
            throw Error(name, printable(values.text(name)), "must not be given with scheme=hardware");
    if (options.filter != Filter::antialias && options.filter != Filter::bilinear &&
        options.filter != Filter::nearest)
        throw Error("filter", values.text("filter"),
                    "must be antialias, bilinear or nearest with scheme=hardware");
    return machine;
}

std::unique_ptr<const SolvedPicture> solved_by_blocks(const BlockDrape& drape) {
    return std::make_unique<SolvedByBlocks>(drape);
}

}  // namespace anamorph
