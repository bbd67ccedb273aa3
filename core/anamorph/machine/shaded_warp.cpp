// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/shaded_warp.h"

#include <algorithm>

#include "anamorph/machine/shader_run.h"
#include "anamorph/mesh/mesh_residual.h"

namespace anamorph::machine {

namespace {

const char* const kOurProgram = R"(ps_2_0
dcl t0.xy                ; linear texture coordinates
dcl t1.xy                ; where in the cell
dcl_2d s0                ; the picture
dcl_2d s1                ; products of basis functions
dcl_2d s2
dcl_2d s3
dcl_2d s4
texld r1, t1, s1
texld r2, t1, s2
texld r3, t1, s3
texld r4, t1, s4
dp4 r5.x, r1, c0         ; the perturbation of u, in four parts
dp4 r6.x, r2, c1
dp4 r7.x, r3, c2
dp4 r8.x, r4, c3
dp4 r5.y, r1, c4         ; of v
dp4 r6.y, r2, c5
dp4 r7.y, r3, c6
dp4 r8.y, r4, c7
add r5.xy, r5, r6
add r7.xy, r7, r8
add r5.xy, r5, r7
add r5.xy, r5, t0
texld r0, r5, s0
mov oC0, r0
)";

// The 17 instructions of Kim 2003, Appendix A.
const char* const kPrintedProgram = R"(ps.2.0
dcl t0.rg                ; linear texture coordinates
dcl t1.rg                ; s and t in the cell
dcl_2d s0                ; the picture
dcl_2d s1                ; products of both triangles, four by four
dcl_2d s2
dcl_2d s3                ; the product of the corner off the triangle's plane
dcl_2d s4
texld r1, t1, s1
texld r2, t1, s2
texld r3, t1, s3
texld r4, t1, s4
dp4 r5.x, r1, c0         ; the perturbation of u, but for the corner
dp4 r6.x, r2, c1
dp4 r7.x, r4, c5
dp4 r5.y, r1, c2         ; of v
dp4 r6.y, r2, c3
dp4 r7.y, r4, c6
add r5.xy, r5, r6
add r5.xy, r5, r7
mad r5.xy, r3.r, c4, r5  ; and the corner
add r0.xy, r5, t0
texld r0, r0, s0
mov r0.a, c4.a           ; for blending in the frame buffer
mov oC0, r0
)";

}  // namespace

const char* warp_program(ShaderLayout layout) {
    return layout == ShaderLayout::printed ? kPrintedProgram : kOurProgram;
}

bool reads_picture_once(const ShaderProgram& program) {
    return std::count_if(
               program.instructions.begin(), program.instructions.end(),
               [](const ShaderInstruction& i) { return samples(i.opcode) && i.sources[1].number == 0; }) == 1;
}

namespace {

/// The products that are components of a layout's textures; -1: 0. The last two products are those of either triangle alone.
using TextureProducts = std::array<int, 4>;
constexpr int kCorner[] = {12, 13};
std::vector<TextureProducts> products_of(ShaderLayout layout) {
    std::vector<TextureProducts> all = {{0, 1, 2, 3}, {4, 5, 6, 7}, {8, 9, 10, 11}};
    if (layout == ShaderLayout::ours)
        all.push_back({kCorner[0], kCorner[1], -1, -1});
    else
        for (const int corner : kCorner) all.push_back({corner, -1, -1, -1});
    return all;
}

std::vector<MachineTexture<4>> product_textures(const ShaderUnit& unit) {
    const auto parameter = [&](int i) {
        return unit.layout == ShaderLayout::ours ? i / (unit.table_size - 1.0) : (i + 0.5) / unit.table_size;
    };
    std::vector<MachineTexture<4>> all;
    for (const TextureProducts& shown : products_of(unit.layout)) {
        std::vector<MachineTexture<4>::Texel> texels;
        for (int j = 0; j < unit.table_size; ++j)
            for (int i = 0; i < unit.table_size; ++i) {
                const auto products = residual_products(parameter(i), parameter(j));
                MachineTexture<4>::Texel& texel = texels.emplace_back();
                for (std::size_t c = 0; c < 4; ++c)
                    texel[c] =
                        shown[c] < 0 ? 0 : nearest(unit.texel, products[static_cast<std::size_t>(shown[c])]);
            }
        all.emplace_back(unit.table_size, unit.weight_bits, std::move(texels));
    }
    return all;
}

const Mesh& checked(const Mesh& mesh, const ShaderUnit& unit) {
    check_texture_side(mesh.to(), unit.texture_side);
    return mesh;
}

}  // namespace

ShadedWarp::ShadedWarp(const Mesh& mesh, const ShaderUnit& unit)
    : ShadedWarp(mesh, unit, assemble_shader(warp_program(unit.layout), "warp", kWarpSlots)) {}

ShadedWarp::ShadedWarp(const Mesh& mesh, const ShaderUnit& unit, ShaderProgram program)
    : ShadedWarp(std::make_shared<MeshPlan>(checked(mesh, unit), WarpScheme::exact, 0), unit,
                 std::move(program)) {}

ShadedWarp::ShadedWarp(std::shared_ptr<const MeshPlan> plan, const ShaderUnit& unit, ShaderProgram program)
    : MachineMap(plan, {{0, 0, plan->width(), plan->height()}}, plan->mesh().to(), HUGE_VAL,
                 unit.address_bits),
      m_plan(std::move(plan)),
      m_unit(unit),
      m_program(std::move(program)),
      m_products(product_textures(unit)) {}

/// A point of the picture in its cell.
struct ShadedWarp::Place {
    double x, y;
    double s, t;
    int triangle;
    ResidualPatch residual;
};

ShadedWarp::Place ShadedWarp::place_of(double x, double y) const {
    const Mesh& mesh = m_plan->mesh();
    const Patch patch = mesh.patch(mesh.cell_at(x, y));
    const double s = (x - patch.x0) / (patch.x1 - patch.x0), t = (y - patch.y0) / (patch.y1 - patch.y0);
    return {x, y, s, t, s + t <= 1 ? 0 : 1, ResidualPatch(patch)};
}

/// What registers hold at a point, as the layout has it.
template <class T>
ShaderInputs<T> ShadedWarp::inputs(const Place& place) const {
    const Mesh& mesh = m_plan->mesh();
    const ResidualPatch::Triangle& plane = place.residual.triangles[place.triangle];
    const double width = mesh.to().width, height = mesh.to().height, s = place.s, t = place.t;
    ShaderInputs<T> given(m_program);
    given.coordinates[0] = {
        T((place.x * mesh.scale().x + plane.origin.x + plane.right.x * s + plane.down.x * t) / width),
        T((place.y * mesh.scale().y + plane.origin.y + plane.right.y * s + plane.down.y * t) / height),
        T(0.0), T(1.0)};
    const bool ours = m_unit.layout == ShaderLayout::ours;
    const double last = m_unit.table_size - 1;
    const auto in_table = [&](double at) { return T(ours ? (at * last + 0.5) / (last + 1) : at); };
    given.coordinates[1] = {in_table(s), in_table(t), T(0.0), T(1.0)};
    const auto factors = [&](std::size_t k, const float(&elements)[16], double size) {
        std::array<double, 4> four{};
        for (std::size_t i = 0; i < 4; ++i) four[i] = double{elements[4 * k + i]} / size;
        return four;
    };
    // The constants of the products' textures, for u and for v; of the printed layout the fourth is the corner's.
    static constexpr std::size_t kOurs[2][4] = {{0, 1, 2, 3}, {4, 5, 6, 7}},
                                 kPrinted[2][3] = {{0, 1, 5}, {2, 3, 6}};
    for (std::size_t k = 0; k < (ours ? 4 : 3); ++k) {
        given.give(ours ? kOurs[0][k] : kPrinted[0][k], factors(k, plane.x, width));
        given.give(ours ? kOurs[1][k] : kPrinted[1][k], factors(k, plane.y, height));
    }
    if (!ours) {
        const auto corner = static_cast<std::size_t>(kCorner[place.triangle]);
        given.give(4, {double{plane.x[corner]} / width, double{plane.y[corner]} / height, 0, m_unit.alpha});
    }
    const double across = mesh.from().width, down = mesh.from().height;
    given.give(8, {width, height, 1 / width, 1 / height});
    given.give(9, {across, down, 1 / across, 1 / down});
    return given;
}

/// The texture that a sampler reads on a triangle.
std::size_t ShadedWarp::texture_of(int sampler, int triangle) const {
    if (m_unit.layout == ShaderLayout::ours) return static_cast<std::size_t>(sampler - 1);
    constexpr std::size_t kCornerTextures = 3;
    switch (sampler) {
        case 3:
            return kCornerTextures + static_cast<std::size_t>(triangle);
        case 4:
            return 2;
        default:
            return static_cast<std::size_t>(sampler - 1);
    }
}

/// Runs the program for a pixel. read(u, v) -> ShaderVector<T> reads the picture.
template <class T, class Read>
ShadedWarp::Drawn<T> ShadedWarp::run(int x, int y, const Read& read) const {
    const Place place = place_of(x + 0.5, y + 0.5);
    const ShaderInputs<T> given = inputs<T>(place);
    ShaderMachine<T> machine(m_program, given);
    const ShaderVector<T> color = machine.run([&](int number, const T& u, const T& v) {
        if (number == 0) return read(u, v);
        const double size = m_unit.table_size;
        return m_products[texture_of(number, place.triangle)].template read<T>(u.value * size,
                                                                               v.value * size);
    });
    return {color, machine.killed()};
}

UnitCoordinates ShadedWarp::coordinates(int x, int y, int) const {
    return texture_coordinates(x, y);
}

UnitCoordinates ShadedWarp::texture_coordinates(int x, int y) const {
    return with_format(m_unit.arithmetic, [&](auto number) {
        using T = decltype(number);
        UnitCoordinates found{};
        const auto drawn = run<T>(x, y, [&](const T& u, const T& v) {
            found = {{u.value, v.value}, u.beyond || v.beyond};
            return ShaderVector<T>{};
        });
        found.seen = !drawn.killed;
        return found;
    });
}

std::array<double, 4> ShadedWarp::color(int x, int y, const ReadPicture& read) const {
    return with_format(m_unit.arithmetic, [&](auto number) {
        using T = decltype(number);
        const auto drawn = run<T>(x, y, [&](const T& u, const T& v) {
            const std::array<double, 4> at = read(source_point({{u.value, v.value}, false}));
            return ShaderVector<T>{T(at[0]), T(at[1]), T(at[2]), T(at[3])};
        });
        const ShaderVector<T>& made = drawn.color;
        return std::array<double, 4>{made[0].value, made[1].value, made[2].value, made[3].value};
    });
}

double ShadedWarp::rounding(const Box& box, int) const {
    return most_bound(*m_plan, box);
}

}  // namespace anamorph::machine
