// SPDX-License-Identifier: Apache-2.0
#include "anamorph/render/mesh_warp.h"

#include <atomic>

#include "anamorph/approx/inverse.h"
#include "anamorph/approx/mesh_scattered.h"
#include "anamorph/render/canvas.h"
#include "anamorph/render/draw.h"

namespace anamorph {
namespace {

// Rows that one thread counts or draws at a time where there are no blocks.
constexpr int kRows = 16;

std::unique_ptr<const WarpPlan> make_plan(const WarpMap& map, const Size& source, const Size& target,
                                          const MeshWarpOptions& options) {
    if (const ControlPoints* points = std::get_if<ControlPoints>(&map.shape))
        return std::make_unique<ScatteredPlan>(Scattered(*points, target, source, options.amount, map.name),
                                               options.scheme, options.tol);
    const ControlMesh& mesh = std::get<ControlMesh>(map.shape);
    if (mesh.direction == Direction::push)
        return std::make_unique<InversePlan>(Mesh(mesh, source, target, options.amount, map.name),
                                             options.scheme, options.tol, map.name);
    return std::make_unique<MeshPlan>(Mesh(mesh, target, source, options.amount, map.name), options.scheme,
                                      options.tol);
}

Output output_of(WarpOutput output) {
    switch (output) {
        case WarpOutput::stmap:
            return Output::stmap;
        case WarpOutput::error:
            return Output::error;
        case WarpOutput::bound:
            return Output::bound;
        default:
            return Output::color;
    }
}

void check_size(const char* name, int width, int height) {
    if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
        throw Error(name, std::to_string(width) + "x" + std::to_string(height),
                    "must be 1 to " + std::to_string(kMaxSide) + " pixels either way");
}

/// body(rows) for boxes of a few whole rows of `box`.
void for_each_rows(const Box& box, const ParallelFor& parallel_for,
                   const std::function<void(const Box&)>& body) {
    if (box.empty()) return;
    parallel_for((box.height() + kRows - 1) / kRows, [&](std::int64_t i) {
        const int y = box.y0 + static_cast<int>(i) * kRows;
        body({box.x0, y, box.x1, std::min(y + kRows, box.y1)});
    });
}

}  // namespace

struct MeshWarp::State {
    State(const WarpMap& map, const Size& source, const Size& target, const MeshWarpOptions& warp)
        : options(warp),
          plan(make_plan(map, source, target, warp)),
          border(Chart(Projection::rectilinear, source.width, source.height), warp.wrap) {}

    void draw_folds(const Box& box, const ImageView& picture, const ParallelFor& parallel_for) const {
        if (picture.channels != 1) throw Error("channels", std::to_string(picture.channels), "needed are 1");
        const Canvas canvas(picture, box);
        const Box whole{0, 0, plan->width(), plan->height()};
        if (!plan->covers(box)) canvas.fill(box, 0);
        for_each_rows(intersection(box, whole), parallel_for, [&](const Box& rows) {
            float values[simd::kMaxRow + 16] = {};
            for (int y = rows.y0; y < rows.y1; ++y)
                for (int x = rows.x0; x < rows.x1; x += simd::kMaxRow) {
                    const int count = std::min(simd::kMaxRow, rows.x1 - x);
                    for (int i = 0; i < count; ++i) values[i] = plan->folds(x + i + 0.5, y + 0.5);
                    canvas.store(x, y, count, values);
                }
            simd::finish_stores();
        });
    }

    MeshWarpOptions options;
    std::unique_ptr<const WarpPlan> plan;
    Border border;
};

MeshWarp::MeshWarp(const WarpMap& map, int source_width, int source_height, int width, int height,
                   const MeshWarpOptions& options) {
    check_size("source size", source_width, source_height);
    check_size("size", width, height);
    m_state = std::make_unique<State>(map, Size{source_width, source_height}, Size{width, height}, options);
}
MeshWarp::~MeshWarp() = default;
MeshWarp::MeshWarp(MeshWarp&&) noexcept = default;
MeshWarp& MeshWarp::operator=(MeshWarp&&) noexcept = default;

int MeshWarp::width() const {
    return m_state->plan->width();
}
int MeshWarp::height() const {
    return m_state->plan->height();
}
const MeshWarpOptions& MeshWarp::options() const {
    return m_state->options;
}
const BlockMap& MeshWarp::blocks() const {
    return *m_state->plan;
}
int MeshWarp::channels(const Source& source) const {
    if (m_state->options.output == WarpOutput::folds) return 1;
    return channels_of(output_of(m_state->options.output), &source);
}
Reached MeshWarp::reached(const ParallelFor& parallel_for) const {
    return m_state->plan->reached(parallel_for);
}

double MeshWarp::folded_fraction(const ParallelFor& parallel_for) const {
    const Box whole{0, 0, width(), height()};
    std::atomic<std::int64_t> folded{0};
    for_each_rows(whole, parallel_for,
                  [&](const Box& rows) { folded += m_state->plan->folded_pixels(rows); });
    return static_cast<double>(folded) / (double(whole.width()) * whole.height());
}

bool MeshWarp::draw(const Source* source, const Box& box, const ImageView& picture,
                    const ParallelFor& parallel_for) const {
    const MeshWarpOptions& options = m_state->options;
    if (options.output == WarpOutput::folds) {
        m_state->draw_folds(box, picture, parallel_for);
        return true;
    }
    return draw_blocks(*m_state->plan, m_state->border, options.filter, output_of(options.output), source,
                       box, picture, parallel_for);
}

}  // namespace anamorph
