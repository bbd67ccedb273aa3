// SPDX-License-Identifier: Apache-2.0
// The bump unit and the pixel shader of 2003 (Kim, section 4.6 and chapter 5): what sizes and formats do to source points.
//
// A cylinder of 360 degrees whose texture is 256 x 256 is seen level with 90 degrees, on a screen of 512 x 512 or less.
// Errors are in pixels of that texture, 256 times the paper's. `clamped` and `bordered` are the two edges of a bump map,
// `read_back` is clamped and read through a texture of 16 bits, as the paper did. Scheme `exact` is the formula.
//
// `shader-NxN` are warps by meshes of N x N cells, drawn by the pixel shader with tables of so many texels and registers of
// a format; errors in pixels of 256 x 256 or less. `blocks-N` are drapes by the machine of 1987 (block_machine.cpp).
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/machine/bump_unit.h"
#include "anamorph/machine/shaded_warp.h"
#include "bench.h"
#include "block_machine.h"

namespace anamorph::bench {
using namespace machine;
namespace {

constexpr int kTexture = 256, kMostScreen = 512;

struct MachineCase {
    std::string name;
    BumpUnit::Edge edge;
    bool read_back;
};
const MachineCase kCases[] = {{"clamped", BumpUnit::Edge::clamp, false},
                              {"bordered", BumpUnit::Edge::border, false},
                              {"read_back", BumpUnit::Edge::clamp, true}};

struct Contender {
    std::string name;
    BumpUnit unit;
};

std::vector<Contender> contenders() {
    struct TexelKind {
        const char* name;
        NumberFormat format;
        bool scaled;
    };
    constexpr TexelKind kKinds[] = {{"8bit", kSigned8, false},
                                    {"8bit-scaled", kSigned8, true},
                                    {"16bit", kSigned16, true},
                                    {"float", kFloat32, false}};
    std::vector<Contender> all(1, {"linear", {}});
    all[0].unit.size = 0;
    for (int size = 32; size <= 1024; size *= 2)
        for (const TexelKind& kind : kKinds) {
            BumpUnit unit;
            unit.size = size;
            unit.texel = kind.format;
            unit.scaled = kind.scaled;
            all.push_back({"embm-" + std::to_string(size) + "-" + kind.name, unit});
        }
    return all;
}

/// 355 / 113 is pi up to 3e-7: so high is the view, and so wide the cylinder.
Panorama view(int screen) {
    return Panorama(Chart(Projection::cylindrical, 355, 113),
                    Chart(Projection::rectilinear, screen, screen, 90));
}

/// body(i, j, s, t) for all pixels.
template <class Body>
void each_pixel(int screen, const Body& body) {
    for (int j = 0; j < screen; ++j)
        for (int i = 0; i < screen; ++i) body(i, j, (i + 0.5) / screen, (j + 0.5) / screen);
}

Point<double> exact_coordinates(const Panorama& map, int i, int j) {
    Point<double> at{};
    int piece = 0;
    map.exact(i + 0.5, j + 0.5, 0, at, piece);
    return {at.x / map.source().width(), at.y / map.source().height()};
}

/// A view drawn by contenders, as texture coordinates.
class Screen {
  public:
    explicit Screen(int side)
        : m_side(side),
          m_map(view(side)),
          m_drawn(static_cast<std::size_t>(side) * static_cast<std::size_t>(side)) {}

    const Panorama& map() const { return m_map; }
    void draw_exactly() {
        each_pixel(m_side, [&](int i, int j, double, double) { put(i, j, exact_coordinates(m_map, i, j)); });
    }
    void draw(const BumpStage& stage, const ReadBack* back) {
        each_pixel(m_side, [&](int i, int j, double s, double t) {
            const Point<double> used = stage(s, t).at;
            put(i, j, back ? (*back)(used) : used);
        });
    }
    /// Of what was drawn last, in pixels of the texture.
    Accuracy accuracy() const {
        std::vector<float> errors;
        each_pixel(m_side, [&](int i, int j, double, double) {
            const Point<double> off = m_drawn[index(i, j)] - exact_coordinates(m_map, i, j);
            errors.push_back(static_cast<float>(kTexture * std::hypot(off.x, off.y)));
        });
        return accuracy_of(errors);
    }

  private:
    std::size_t index(int i, int j) const {
        return static_cast<std::size_t>(j) * static_cast<std::size_t>(m_side) + static_cast<std::size_t>(i);
    }
    void put(int i, int j, const Point<double>& at) { m_drawn[index(i, j)] = at; }

    int m_side;
    Panorama m_map;
    std::vector<Point<double>> m_drawn;
};

void measure(const Settings& settings, Report& report, const MachineCase& which) {
    const int side = std::min(settings.size, kMostScreen);
    Screen screen(side);
    const ReadBack back;
    std::vector<Row> rows(1);
    rows[0].scheme = "exact";
    rows[0].error = {0, 0, 0};
    std::vector<Timed> timed(1, {[&] { screen.draw_exactly(); }, 1});
    for (const Contender& contender : contenders()) {
        if (!settings.wants_scheme(contender.name)) continue;
        BumpUnit unit = contender.unit;
        unit.edge = which.edge;
        const auto stage = std::make_shared<BumpStage>(screen.map(), 0, unit);
        timed.push_back({[&, stage] { screen.draw(*stage, which.read_back ? &back : nullptr); }, 1});
        timed.back().draw();
        rows.emplace_back().scheme = contender.name;
        rows.back().error = screen.accuracy();
    }
    const std::vector<Times> times = time_interleaved(timed, std::min(settings.rounds, 3));
    for (std::size_t k = 0; k < rows.size(); ++k) {
        Row& row = rows[k];
        row.op = "machine";
        row.case_name = which.name;
        row.size = side;
        row.ns_per_px = times[k].median / (double(side) * side);
        row.best_ns_per_px = times[k].best / (double(side) * side);
        row.ratio_to_exact = times[0].median / times[k].median;
        row.exact_fraction = k == 0 ? 1 : 0;
        report.add(row);
    }
}

/// A picture of side x side warped by a mesh of n x n cells, whose inner vertices move by up to a fifth of a cell.
Mesh wavy_mesh(int side, int cells) {
    const Size size{side, side};
    ControlMesh mesh;
    mesh.columns = mesh.rows = cells;
    for (int j = 0; j <= cells; ++j)
        for (int i = 0; i <= cells; ++i) {
            const bool inner = i > 0 && j > 0 && i < cells && j < cells;
            const double cell = double(side) / cells, by = inner ? 0.2 * cell : 0;
            mesh.vertices.push_back(
                {i * cell + by * std::sin(7.0 * i + 3.0 * j), j * cell + by * std::cos(5.0 * i - 2.0 * j)});
        }
    return Mesh(mesh, size, size, 1);
}

/// The pixel shader's source points: of meshes, sizes of tables and numbers.
void measure_shader(const Settings& settings, Report& report, int cells) {
    const int side = std::min(settings.size, kTexture);
    const Mesh mesh = wavy_mesh(side, cells);
    for (const NumberFormat& format : {kFloat32, kFloat24, kFixed16})
        for (const int table : {16, 64, 256}) {
            Row row;
            row.op = "machine";
            row.case_name = "shader-" + std::to_string(cells) + "x" + std::to_string(cells);
            row.scheme = "ps20-" + std::to_string(table) + "-" + name_of(format);
            if (!settings.wants_case(row.case_name) || !settings.wants_scheme(row.scheme)) continue;
            ShaderUnit unit;
            unit.arithmetic = format;
            unit.table_size = table;
            unit.address_bits = 16;
            const ShadedWarp warp(mesh, unit);
            std::vector<double> x(Block::kMaxSide + 16), y(x.size());
            std::vector<std::int32_t> piece(x.size());
            std::vector<float> errors;
            const auto read = [&](bool keep) {
                for (const Block& block : warp.blocks(0))
                    for (int j = 0; j < block.box.height(); ++j) {
                        warp.exact_rows(block, j, j + 1,
                                        {x.data(), y.data(), piece.data(), Block::kMaxSide + 16});
                        for (std::size_t i = 0; keep && i < std::size_t(block.box.width()); ++i) {
                            const Point<double> exact =
                                mesh.at(block.box.x0 + double(i) + 0.5, block.box.y0 + j + 0.5);
                            errors.push_back(static_cast<float>(std::hypot(x[i] - exact.x, y[i] - exact.y)));
                        }
                    }
            };
            read(true);
            const std::vector<Times> times = time_interleaved({{[&] { read(false); }, 1}}, 1);
            row.size = side;
            row.ns_per_px = times[0].median / (double(side) * side);
            row.best_ns_per_px = times[0].best / (double(side) * side);
            row.ratio_to_exact = kNone;
            row.bound_px = warp.reached(serial_for).max_error;
            row.error = accuracy_of(errors);
            report.add(row);
        }
}

void run(const Settings& settings, Report& report) {
    for (const int side : {512, 1024}) measure_blocks(settings, report, side);
    for (const int cells : {4, 12}) measure_shader(settings, report, cells);
    for (const MachineCase& which : kCases)
        if (settings.wants_case(which.name)) measure(settings, report, which);
    const Row *clamped = report.find("clamped", "embm-256-16bit"),
              *bordered = report.find("bordered", "embm-256-16bit"),
              *read = report.find("read_back", "embm-256-16bit"),
              *large = report.find("read_back", "embm-1024-16bit");
    if (read && read->size == kMostScreen) {
        report.add_limit("256, 16 bits, read back: mean error (texture coordinates, the paper's 8.66e-6)",
                         1.3e-5, read->error.mean / kTexture);
        report.add_limit("256, 16 bits, read back: largest error (the paper's 9.9e-4)", 1.2e-3,
                         read->error.max / kTexture);
    }
    if (read && large)
        report.add_limit("256 is enough: mean error over that of 1024, read back", 1.25,
                         read->error.mean / large->error.mean);
    if (clamped && bordered && clamped->size == kMostScreen)
        report.add_limit("a border of one texel: largest error over that without", 0.05,
                         bordered->error.max / clamped->error.max);
}

const RegisterOp registered({"machine", run, nullptr});

}  // namespace
}  // namespace anamorph::bench
