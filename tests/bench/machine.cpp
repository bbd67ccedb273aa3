// SPDX-License-Identifier: Apache-2.0
// The bump unit and the pixel shader of 2003 (Kim, section 4.6 and chapter 5): what sizes and formats do to source points.
//
// A cylinder of 360 degrees whose texture is 256 x 256 is seen level with 90 degrees, on a screen of 512 x 512 or less.
// Errors are in pixels of that texture, 256 times the paper's. `clamped` and `bordered` are the two edges of a bump map,
// `read_back` is clamped and read through a texture of 16 bits, as the paper did. Scheme `exact` is the formula. `pitched` is a
// view of 60 degrees, 15 degrees up, of a cylinder of 2048 x 1024, `pitched-pixel` the same, projected at each pixel (4.4.1), and
// `planes-N` a level view of 120 degrees by so many planes.
//
// `shader-NxN` are warps by meshes of N x N cells, drawn by the pixel shader with tables of so many texels and registers of
// a format; errors in pixels of 256 x 256 or less. `morph` is one picture of a morph along 32 lines as chapter 5 draws it, over
// meshes that are cut near lines or not; errors, in pixels of 512 x 512 or less, against the features' map. `blocks-N` are drapes by the machine of 1987 (block_machine.cpp).
#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <vector>

#include "anamorph/machine/bump_unit.h"
#include "anamorph/machine/morph_unit.h"
#include "anamorph/machine/shaded_warp.h"
#include "bench.h"
#include "block_machine.h"

namespace anamorph::bench::op_machine {
using namespace machine;
namespace {

constexpr int kTexture = 256, kMostScreen = 512;

/// 355 / 113 is pi up to 3e-7: so high is the view, and so wide the cylinder.
Panorama published_view(int screen) {
    return Panorama(Chart(Projection::cylindrical, 355, 113),
                    Chart(Projection::rectilinear, screen, screen, 90));
}
Panorama pitched_view(int screen) {
    return Panorama(Chart(Projection::cylindrical, 2048, 1024),
                    Chart(Projection::rectilinear, screen, screen, 60), {0, 15, 0});
}
Panorama wide_view(int screen) {
    return Panorama(Chart(Projection::cylindrical, 2048, 1024),
                    Chart(Projection::rectilinear, screen, screen / 2, 120));
}

struct MachineCase {
    std::string name;
    Panorama (*view)(int screen);
    Size texture;  ///< errors are in its pixels
    BumpUnit unit;
    bool read_back;
};
std::vector<MachineCase> cases() {
    BumpUnit unit, bordered, pixel;
    bordered.edge = BumpUnit::Edge::border;
    pixel.projecting = BumpUnit::Projecting::pixel;
    const Size published{kTexture, kTexture}, large{2048, 1024};
    std::vector<MachineCase> all = {{"clamped", published_view, published, unit, false},
                                    {"bordered", published_view, published, bordered, false},
                                    {"read_back", published_view, published, unit, true},
                                    {"pitched", pitched_view, large, unit, false},
                                    {"pitched-pixel", pitched_view, large, pixel, false}};
    for (const int planes : {1, 2, 4}) {
        unit.planes.count = planes;
        all.push_back({"planes-" + std::to_string(planes), wide_view, large, unit, false});
    }
    return all;
}

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

Point<double> exact_coordinates(const Panorama& map, int i, int j) {
    Point<double> at{};
    int piece = 0;
    map.exact(i + 0.5, j + 0.5, 0, at, piece);
    return {at.x / map.source().width(), at.y / map.source().height()};
}

/// A view drawn by contenders, as texture coordinates.
class Screen {
  public:
    explicit Screen(const Panorama& map)
        : m_map(map),
          m_drawn(static_cast<std::size_t>(map.target().width()) *
                  static_cast<std::size_t>(map.target().height())) {}

    const Panorama& map() const { return m_map; }
    std::size_t pixels() const { return m_drawn.size(); }
    void draw_exactly() {
        each_pixel([&](int i, int j, Point<double>& to) { to = exact_coordinates(m_map, i, j); });
    }
    void draw(const BumpedPanorama& drawn, const ReadBack* back) {
        const double width = m_map.target().width(), height = m_map.target().height();
        each_pixel([&](int i, int j, Point<double>& to) {
            const Point<double> used = drawn.at((i + 0.5) / width, (j + 0.5) / height).at;
            to = back ? (*back)(used) : used;
        });
    }
    /// Of what was drawn last, in pixels of the texture.
    Accuracy accuracy(const Size& texture) {
        std::vector<float> errors;
        each_pixel([&](int i, int j, const Point<double>& at) {
            const Point<double> off = at - exact_coordinates(m_map, i, j);
            errors.push_back(static_cast<float>(std::hypot(texture.width * off.x, texture.height * off.y)));
        });
        return accuracy_of(errors);
    }

  private:
    /// body(i, j, its coordinates) for all pixels.
    template <class Body>
    void each_pixel(const Body& body) {
        auto to = m_drawn.begin();
        for (int j = 0; j < m_map.target().height(); ++j)
            for (int i = 0; i < m_map.target().width(); ++i) body(i, j, *to++);
    }

    Panorama m_map;
    std::vector<Point<double>> m_drawn;
};

void measure(const Settings& settings, Report& report, const MachineCase& which) {
    const int side = std::min(settings.size, kMostScreen);
    Screen screen(which.view(side));
    const ReadBack back;
    std::vector<Row> rows(1);
    rows[0].scheme = "exact";
    rows[0].error = {0, 0, 0};
    std::vector<Timed> timed(1, {[&] { screen.draw_exactly(); }, 1});
    for (const Contender& contender : contenders()) {
        if (!settings.wants_scheme(contender.name)) continue;
        BumpUnit unit = contender.unit;
        unit.edge = which.unit.edge;
        unit.projecting = which.unit.projecting;
        unit.planes = which.unit.planes;
        const auto drawn = std::make_shared<BumpedPanorama>(screen.map(), unit);
        timed.push_back({[&, drawn] { screen.draw(*drawn, which.read_back ? &back : nullptr); }, 1});
        timed.back().draw();
        rows.emplace_back().scheme = contender.name;
        rows.back().error = screen.accuracy(which.texture);
    }
    const std::vector<Times> times = time_interleaved(timed, std::min(settings.rounds, 3));
    for (std::size_t k = 0; k < rows.size(); ++k) {
        Row& row = rows[k];
        row.op = "machine";
        row.case_name = which.name;
        row.size = side;
        row.ns_per_px = times[k].median / double(screen.pixels());
        row.best_ns_per_px = times[k].best / double(screen.pixels());
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

/// 32 lines of a tenth of the picture, which move by up to a thirtieth of it.
Features lines_of(int side) {
    Features features;
    for (int i = 0; i < 32; ++i) {
        const auto at = [&](double phase) { return side * (0.5 + 0.4 * std::sin(phase)); };
        const Point<double> p{at(7.0 * i), at(3.0 * i + 1)},
            along{0.1 * side * std::cos(5.0 * i), 0.1 * side * std::sin(5.0 * i)},
            by{side / 30.0 * std::sin(11.0 * i), side / 30.0 * std::cos(13.0 * i)};
        features.add_line({{p, p + along}, {p + by, p + along + by}});
    }
    return features;
}

void measure_morph(const Settings& settings, Report& report) {
    const int side = std::min(settings.size, kMostScreen);
    const Size size{side, side};
    const auto map = std::make_shared<const FeatureMap>(lines_of(side), std::vector<Size>{size, size}, size,
                                                        std::vector<double>{0.5, 0.5}, LineWeights{});
    for (const auto& [cells, levels] :
         {std::pair(12, 0), std::pair(12, 1), std::pair(12, 2), std::pair(24, 1)}) {
        Row row;
        row.op = "machine";
        row.case_name = "morph";
        row.scheme = std::to_string(cells) + "-cells-" + std::to_string(levels) + "-levels";
        if (!settings.wants_case(row.case_name) || !settings.wants_scheme(row.scheme)) continue;
        MorphUnit unit;
        unit.cells = cells;
        unit.levels = levels;
        const MorphMeshes meshes = morph_meshes(*map, unit);
        const MorphWarp warp(map, 1, meshes.meshes[1], unit, 1);
        std::vector<double> x(Block::kMaxSide + 16), y(x.size());
        std::vector<std::int32_t> piece(x.size());
        std::vector<float> errors;
        const auto read = [&](const Block& block) {
            for (int j = 0; j < block.box.height(); ++j) {
                warp.exact_rows(block, j, j + 1, {x.data(), y.data(), piece.data(), Block::kMaxSide + 16});
                for (std::size_t i = 0; i < std::size_t(block.box.width()); ++i) {
                    const Point<double> exact =
                        (*map)(block.box.x0 + double(i) + 0.5, block.box.y0 + j + 0.5, 1);
                    errors.push_back(static_cast<float>(std::hypot(x[i] - exact.x, y[i] - exact.y)));
                }
            }
        };
        const std::vector<Times> times =
            time_interleaved({{[&] {
                                   errors.clear();
                                   for (std::int64_t region = 0; region < warp.regions(); ++region)
                                       for (const Block& block : warp.blocks(region)) read(block);
                               },
                               1}},
                             1);
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
    measure_morph(settings, report);
    for (const int side : {512, 1024}) measure_blocks(settings, report, side);
    for (const int cells : {4, 12}) measure_shader(settings, report, cells);
    for (const MachineCase& which : cases())
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
    if (const Row* pitched = report.find("pitched", "embm-256-16bit"))
        report.add_limit("a pitched view, 256, 16 bits: mean error (pixels of 2048 x 1024)", 0.001,
                         pitched->error.mean);
}

const RegisterOp registered({"machine", run, nullptr});

}  // namespace
}  // namespace anamorph::bench::op_machine
