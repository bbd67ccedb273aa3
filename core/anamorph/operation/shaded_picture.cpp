// SPDX-License-Identifier: Apache-2.0
#include "anamorph/operation/shaded_picture.h"

#include <algorithm>
#include <array>
#include <atomic>

#include "anamorph/image/canvas.h"
#include "anamorph/image/pixel.h"
#include "anamorph/image/strips.h"
#include "anamorph/machine/machine_text.h"
#include "anamorph/operation/solved.h"
#include "anamorph/parameter/left_out.h"

namespace anamorph {
namespace {

std::shared_ptr<const machine::ShadedWarp> shaded_warp(const WarpMap& map, const WarpRequest& request) {
    const ControlMesh* mesh = std::get_if<ControlMesh>(&map.shape);
    if (!mesh || mesh->direction == Direction::push)
        throw Error("machine: " + std::string(machine::kShaderPreset) +
                    " draws meshes that pull, and no other warps");
    check_tol(request.options.tol);
    const Mesh made(*mesh, request.target, request.source, request.options.amount, map.name);
    return request.program ? std::make_shared<machine::ShadedWarp>(made, *request.machine, *request.program)
                           : std::make_shared<machine::ShadedWarp>(made, *request.machine);
}

Border border_of(const WarpRequest& request) {
    return {Chart(Projection::rectilinear, request.source.width, request.source.height),
            request.options.wrap};
}

/// A warp drawn by a pixel-shader unit.
Picture warped_by_shader(const WarpMap& map, const WarpRequest& request) {
    const std::shared_ptr<const machine::ShadedWarp> warp = shaded_warp(map, request);
    Picture picture =
        picture_through(warp, border_of(request), request.options.filter, request.options.output);
    if (request.options.folds)
        picture.value = [warp](double x, double y) { return warp->exact_plan().folds(x, y); };
    picture.says = [warp](const ParallelFor& parallel_for) -> Attributes {
        return {{"anamorph:saturated_pixels", double(warp->saturated_pixels(parallel_for))}};
    };
    picture.reached_by_drawing = true;
    return picture;
}

/// The colors that a program of the user's makes.
class ProgrammedPicture final : public SolvedPicture {
  public:
    ProgrammedPicture(const WarpMap& map, const WarpRequest& request)
        : m_warp(shaded_warp(map, request)),
          m_border(border_of(request)),
          m_filter(request.options.filter),
          m_is_map(machine::reads_picture_once(m_warp->program())) {}

    Attributes reached(const ParallelFor& parallel_for) const override {
        if (!m_is_map) return {{"anamorph:exact_fraction", 0.0}};
        return {{"anamorph:max_error", m_warp->reached(parallel_for).max_error},
                {"anamorph:exact_fraction", 0.0},
                {"anamorph:saturated_pixels", double(m_warp->saturated_pixels(parallel_for))}};
    }
    bool reached_by_drawing() const override { return m_is_map; }
    bool draw(const std::vector<const Source*>& sources, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        const Source* source = sources.empty() ? nullptr : sources[0];
        if (!source) throw Error("a picture in colour needs a source");
        const Canvas canvas(view, box);
        const Box whole{0, 0, m_warp->width(), m_warp->height()};
        if (!m_warp->covers(box)) canvas.fill(box, 0);
        std::atomic<bool> ok{true};
        for_each_square(intersection(box, whole), parallel_for, [&](const Box& square) {
            if (!draw_square(*source, square, canvas)) ok = false;
            simd::finish_stores();
        });
        return ok;
    }

  private:
    bool draw_square(const Source& source, const Box& square, const Canvas& canvas) const {
        const auto channels = static_cast<std::size_t>(source.channels());
        PointSampler sampler(source, m_border);
        bool ok = true;
        const machine::ShadedWarp::ReadPicture read = register_reader(sampler, m_filter, channels, ok);
        float row[simd::kMaxRow * 4 + 16] = {};
        for (int y = square.y0; y < square.y1; ++y)
            for (int x = square.x0; x < square.x1; x += simd::kMaxRow) {
                const int count = std::min(simd::kMaxRow, square.x1 - x);
                for (int i = 0; i < count; ++i) {
                    const std::array<double, 4> color = m_warp->color(x + i, y, read);
                    float* to = row + static_cast<std::size_t>(i) * channels;
                    for (std::size_t c = 0; c < channels; ++c) to[c] = static_cast<float>(color[c]);
                    if (source.unassociated_alpha() >= 0)
                        unassociate_alpha(to, source.channels(), source.unassociated_alpha());
                }
                canvas.store(x, y, count, row);
            }
        return ok;
    }

    std::shared_ptr<const machine::ShadedWarp> m_warp;
    Border m_border;
    Filter m_filter;
    bool m_is_map;
};

}  // namespace

machine::ShadedWarp::ReadPicture register_reader(PointSampler& sampler, Filter filter, std::size_t channels,
                                                 bool& ok) {
    return [&sampler, &ok, filter, channels](const Point<double>& at) {
        float pixel[4];
        if (!sampler.sample(filter, 0, 0, at.x, at.y, pixel)) ok = false;
        std::array<double, 4> components{0, 0, 0, 1};
        std::copy_n(pixel, channels, components.begin());
        return components;
    };
}

bool runs_program(const WarpRequest& request) {
    return request.program || (request.machine && request.machine->layout != machine::ShaderLayout::ours);
}

std::optional<machine::ShaderProgram> read_shader(const OperationInput& input) {
    const auto file = input.files.find("program");
    if (file == input.files.end()) return {};
    const std::string& name = file->second.name;
    if constexpr (kIsSmall) refuse_left_out("program=" + printable(name));
    machine::ShaderProgram program =
        machine::assemble_shader(input.reader.text(name), name, machine::kWarpSlots);
    if (input.values.text("scheme") != "hardware")
        throw Error("program", printable(name), "must be given with scheme=hardware only");
    if (input.values.text("output") != "color" && !machine::reads_picture_once(program))
        throw Error("output", input.values.text("output"),
                    "must be color with a program that does not read s0 exactly once");
    return program;
}

void check_program_channels(const WarpRequest& request, int channels) {
    if (runs_program(request) && channels > 4)
        throw Error("src has " + std::to_string(channels) + " channels: must have at most 4 with " +
                    (request.program ? "program" : std::string("machine=") + machine::kPrintedPreset));
}

std::unique_ptr<const SolvedPicture> shaded_picture(const WarpMap& map, const WarpRequest& request) {
    if constexpr (kIsSmall) refuse_left_out("scheme=hardware");
    const bool is_color = !request.options.folds && request.options.output == Output::color;
    if (is_color && runs_program(request)) return std::make_unique<ProgrammedPicture>(map, request);
    return solved(warped_by_shader(map, request));
}

}  // namespace anamorph
