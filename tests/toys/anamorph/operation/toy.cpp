// SPDX-License-Identifier: Apache-2.0
// A toy: a picture without sources, of squares whose colour says where they lie.
#include <algorithm>
#include <cmath>

#include "anamorph/image/pixel.h"
#include "anamorph/operation/operation.h"
#include "anamorph/operation/rows.h"

namespace anamorph {
namespace {

class Squares final : public SolvedPicture {
  public:
    Squares(const Size& size, double side) : m_size(size), m_side(side) {}

    Attributes reached(const ParallelFor&) const override {
        return {{"anamorph:max_error", 0.0}, {"anamorph:exact_fraction", 1.0}};
    }
    bool draw(const std::vector<const Source*>&, const Box& box, const ImageView& view,
              const ParallelFor& parallel_for) const override {
        parallel_for(box.height(), [&](std::int64_t row) {
            for (int x = box.x0; x < box.x1; ++x)
                for (int c = 0; c < view.channels; ++c)
                    store_channel(value(x, box.y0 + static_cast<int>(row), c),
                                  view.at(x - box.x0, row) + c * size_of(view.type), view.type);
        });
        return true;
    }

  private:
    float value(int x, int y, int channel) const {
        if (x >= m_size.width || y >= m_size.height) return 0;
        const double column = std::floor((x + 0.5) / m_side), row = std::floor((y + 0.5) / m_side);
        return static_cast<float>(0.5 + 0.5 * std::sin(3 * column + 5 * row + channel));
    }

    Size m_size;
    double m_side;
};

class Toys final : public Pictures {
  public:
    Toys(const Size& size, double side) : m_size(size), m_side(side) {}

    std::optional<PictureRequest> picture(int, int level) const override {
        const std::optional<Size> size = level_size(m_size, level);
        if (!size) return {};
        PictureRequest picture;
        picture.size = *size;
        picture.channels = {"R", "G", "B"};
        picture.says = {{"anamorph:tol", 0.0}};
        picture.solve = [size, side = m_side * size->width / m_size.width] {
            return std::make_unique<Squares>(*size, side);
        };
        return picture;
    }

  private:
    Size m_size;
    double m_side;
};

ParameterTable make_table() {
    using namespace rows;
    return {size("width and height of the picture"), tile(), mip(),
            number("side", "pixels", "8", 0.25, 1000, "side of a square")};
}

}  // namespace

const Operation& toy_operation() {
    static const ParameterTable table = make_table();
    static const Operation operation{
        "toy",
        "Squares",
        &table,
        {},
        0,
        {"size=48x24", {}},
        [](const OperationInput& input) -> std::unique_ptr<const Pictures> {
            return std::make_unique<Toys>(rows::size_of(input.values, {64, 64}), input.values.number("side"));
        }};
    return operation;
}

}  // namespace anamorph
