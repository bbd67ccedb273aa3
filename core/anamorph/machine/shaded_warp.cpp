// SPDX-License-Identifier: Apache-2.0
#include "anamorph/machine/shaded_warp.h"

#include <algorithm>

#include "anamorph/machine/shader_run.h"
#include "anamorph/mesh/mesh_residual.h"

namespace anamorph::machine {

const char* const kHermiteShader = R"(ps_2_0
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

bool reads_picture_once(const ShaderProgram& program) {
    return std::count_if(
               program.instructions.begin(), program.instructions.end(),
               [](const ShaderInstruction& i) { return samples(i.opcode) && i.sources[1].number == 0; }) == 1;
}

namespace {

/// The products four by four; texels stand from edge to edge of the cell.
std::vector<MachineTexture<4>> product_textures(const ShaderUnit& unit) {
    constexpr std::size_t kTextures = 4;
    std::vector<std::vector<MachineTexture<4>::Texel>> texels(kTextures);
    for (int j = 0; j < unit.table_size; ++j)
        for (int i = 0; i < unit.table_size; ++i) {
            const double last = unit.table_size - 1;
            const auto products = residual_products(i / last, j / last);
            for (std::size_t k = 0; k < kTextures; ++k) {
                MachineTexture<4>::Texel& texel = texels[k].emplace_back();
                for (std::size_t c = 0; c < 4; ++c)
                    texel[c] = 4 * k + c < products.size() ? nearest(unit.texel, products[4 * k + c]) : 0;
            }
        }
    std::vector<MachineTexture<4>> all;
    for (auto& t : texels) all.emplace_back(unit.table_size, unit.weight_bits, std::move(t));
    return all;
}

const Mesh& checked(const Mesh& mesh, const ShaderUnit& unit) {
    check_texture_side(mesh.to(), unit.texture_side);
    return mesh;
}

}  // namespace

ShadedWarp::ShadedWarp(const Mesh& mesh, const ShaderUnit& unit)
    : ShadedWarp(mesh, unit, assemble_shader(kHermiteShader, "hermite", kWarpSlots)) {}

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

/// What kWarpSlots says, at a point.
template <class T>
ShaderInputs<T> ShadedWarp::inputs(double x, double y) const {
    const Mesh& mesh = m_plan->mesh();
    const Patch patch = mesh.patch(mesh.cell_at(x, y));
    const ResidualPatch residual(patch);
    const double s = (x - patch.x0) / (patch.x1 - patch.x0), t = (y - patch.y0) / (patch.y1 - patch.y0);
    const ResidualPatch::Triangle& plane = residual.triangles[s + t <= 1 ? 0 : 1];
    const double width = mesh.to().width, height = mesh.to().height, last = m_unit.table_size - 1;
    ShaderInputs<T> given(m_program);
    given.coordinates[0] = {
        T((x * mesh.scale().x + plane.origin.x + plane.right.x * s + plane.down.x * t) / width),
        T((y * mesh.scale().y + plane.origin.y + plane.right.y * s + plane.down.y * t) / height), T(0.0),
        T(1.0)};
    given.coordinates[1] = {T((s * last + 0.5) / (last + 1)), T((t * last + 0.5) / (last + 1)), T(0.0),
                            T(1.0)};
    for (std::size_t k = 0; k < 4; ++k) {
        std::array<double, 4> of_u{}, of_v{};
        for (std::size_t i = 0; i < 4; ++i) {
            of_u[i] = double{plane.x[4 * k + i]} / width;
            of_v[i] = double{plane.y[4 * k + i]} / height;
        }
        given.give(k, of_u);
        given.give(4 + k, of_v);
    }
    const double across = mesh.from().width, down = mesh.from().height;
    given.give(8, {width, height, 1 / width, 1 / height});
    given.give(9, {across, down, 1 / across, 1 / down});
    return given;
}

/// Runs the program for a pixel. read(u, v) -> ShaderVector<T> reads the picture.
template <class T, class Read>
ShadedWarp::Drawn<T> ShadedWarp::run(int x, int y, const Read& read) const {
    const ShaderInputs<T> given = inputs<T>(x + 0.5, y + 0.5);
    ShaderMachine<T> machine(m_program, given);
    const ShaderVector<T> color = machine.run([&](int number, const T& u, const T& v) {
        if (number == 0) return read(u, v);
        const double size = m_unit.table_size;
        return m_products[static_cast<std::size_t>(number - 1)].template read<T>(u.value * size,
                                                                                 v.value * size);
    });
    return {color, machine.killed()};
}

UnitCoordinates ShadedWarp::coordinates(int x, int y, int) const {
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
    double most = 0;
    for (const std::int64_t region : m_plan->regions_in(box))
        for (const Block& block : m_plan->blocks(region))
            if (!intersection(block.box, box).empty()) most = std::max(most, block.bound);
    return most;
}

}  // namespace anamorph::machine
