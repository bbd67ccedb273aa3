// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <cstring>

#include "anamorph/image/picture.h"
#include "anamorph/machine/machine_map.h"
#include "anamorph/mesh/mesh_plan.h"
#include "anamorph/operation/operation.h"

namespace anamorph::test_machine_map {
using namespace machine;
namespace {

constexpr Size kSize{300, 200};

std::shared_ptr<const BlockMap> nothing_moves() {
    ControlMesh mesh;
    mesh.vertices = {{0, 0}, {300, 0}, {0, 200}, {300, 200}};
    return std::make_shared<MeshPlan>(Mesh(mesh, kSize, kSize, 1), WarpScheme::exact, 0);
}

/// A machine that is right, and counts what it computes.
class CountingMachine final : public MachineMap {
  public:
    CountingMachine() : MachineMap(nothing_moves(), {{0, 0, 300, 200}}, kSize, HUGE_VAL, 8) {}
    std::int64_t count() const { return m_count; }

  protected:
    UnitCoordinates coordinates(int x, int y, int) const override {
        ++m_count;
        return {{(x + 0.5) / kSize.width, (y + 0.5) / kSize.height}, x == y};
    }
    double rounding(const Box&, int) const override { return 0; }

  private:
    mutable std::atomic<std::int64_t> m_count{0};
};

Picture picture_of(const std::shared_ptr<const BlockMap>& map) {
    Picture picture;
    picture.maps = {
        {map, {{Border(Chart(Projection::rectilinear, kSize.width, kSize.height), Wrap::automatic)}}}};
    picture.output = Output::stmap;
    return picture;
}

void draw(const Picture& picture, const Box& box) {
    std::vector<float> points(static_cast<std::size_t>(2 * box.width() * box.height()));
    EXPECT_TRUE(picture.draw({}, box,
                             packed_view(reinterpret_cast<std::byte*>(points.data()), PixelType::float32,
                                         box.width(), box.height(), 2),
                             serial_for));
}

TEST(MachineMap, ComputesEachPixelOnceAndOnlyThoseAboutATile) {
    const auto machine = std::make_shared<CountingMachine>();
    const Picture picture = picture_of(machine);
    draw(picture, {0, 0, 64, 64});
    EXPECT_EQ(machine->count(), 128 * 128);
    draw(picture, {0, 0, 300, 200});
    EXPECT_EQ(machine->count(), 300 * 200);
    EXPECT_EQ(machine->saturated_pixels(serial_for), 200);
    EXPECT_LT(machine->reached(serial_for).max_error, 0.01);
    EXPECT_EQ(machine->count(), 300 * 200);
}

}  // namespace
}  // namespace anamorph::test_machine_map
