// SPDX-License-Identifier: Apache-2.0
// Rows of numbers, and that what the core accepts is what they say, to the last bit of both ends.
#include "anamorph/parameter/number_row.h"

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <vector>

#include "anamorph/deform/deform_rows.h"
#include "anamorph/deform/deformed_surface.h"
#include "anamorph/figure/body/figure_rows.h"
#include "anamorph/figure/outline/level_of_detail.h"
#include "anamorph/figure/outline/outline.h"
#include "anamorph/figure/outline/spheres.h"
#include "anamorph/surface/texture_rows.h"

namespace anamorph::test_number_row {
using namespace figure;
namespace {

TEST(NumberRow, SaysItsRange) {
    EXPECT_EQ((NumberRow{"x", 0}.range()), "a finite number");
    EXPECT_EQ((NumberRow{"x", 0, 1}.range()), "a number of at least 1");
    EXPECT_EQ((NumberRow{"x", 0, 1, NumberRow::kNoEnd, NumberRow::above_least}.range()), "a number above 1");
    EXPECT_EQ((NumberRow{"x", 0, 1, 2}.range()), "a number from 1 to 2");
    EXPECT_EQ((NumberRow{"x", 0, 1, 2, NumberRow::closed, true}.range()), "an integer from 1 to 2");
    EXPECT_EQ((NumberRow{"x", 0, 1, 2, NumberRow::above_least}.range()), "a number above 1 and at most 2");
    EXPECT_EQ((NumberRow{"x", 0, 1, 2, NumberRow::between}.range()), "a number above 1 and below 2");
}

TEST(NumberRow, HoldsDefaultsAndFiniteNumbersOnly) {
    std::vector<NumberRow> rows(std::begin(kDeformRows), std::end(kDeformRows));
    rows.insert(rows.end(), std::begin(kFigureRows), std::end(kFigureRows));
    rows.insert(rows.end(), std::begin(surface::kTextureRows), std::end(surface::kTextureRows));
    for (const NumberRow& row : rows) {
        EXPECT_TRUE(row.holds(row.standard)) << row.name;
        for (const double none : {HUGE_VAL, -HUGE_VAL, std::nan("")})
            EXPECT_FALSE(row.holds(none)) << row.name;
    }
    EXPECT_FALSE(kViewSizeRow.holds(1.5));
}

/// Goes to both ends of a row and one step beyond: `use` throws Error naming `parameter` where the row says so.
void expect_row(const NumberRow& row, const char* parameter, const std::function<void(double)>& use) {
    const double least = std::max(row.least, -1e300), most = std::min(row.most, 1e300);
    for (const double end : {least, most})
        for (const double value : {end, std::nextafter(end, -HUGE_VAL), std::nextafter(end, HUGE_VAL)}) {
            std::string error;
            try {
                use(value);
            } catch (const Error& e) {
                error = e.what();
            }
            const std::string rule = std::string(parameter) + "=";
            if (row.holds(value))
                EXPECT_THAT(error, testing::Not(testing::HasSubstr("must be " + row.range())))
                    << row.name << " " << value;
            else
                EXPECT_THAT(error, testing::AllOf(testing::StartsWith(rule),
                                                  testing::HasSubstr("must be " + row.range())))
                    << row.name << " " << value;
        }
}

TEST(NumberRow, IsWhatTheCoreAccepts) {
    expect_row(kExtentRow, "extent", [](double v) { check_deformation({{}, {}, {1, v}}); });
    expect_row(kExtentRow, "extent", [](double v) { check_deformation({{}, {}, {v, 1}}); });
    expect_row(kCutoffRow, "cutoff", [](double v) { DisplacementSum({v}); });
    const std::vector<Ellipsoid> bodies{{{0, 0, 5}, {1, 2, 3}}};
    expect_row(kLevelOfDetailRow, "lod", [&](double v) { levels_of_detail(bodies, {}, {v}); });
    const Outlines seen = outlines(bodies, {});
    expect_row(kOutlineTolRow, "tol", [&](double v) { chord_angles(seen.bodies[0], {0, 1}, {}, v); });
    OutlineOptions options;
    options.crossings = true;
    expect_row(kOutlineTolRow, "tol", [&](double v) {
        options.tol = v;
        outlines(bodies, {}, options);
    });
    expect_row(kSphereTolRow, "tol", [&](double v) { fill_with_spheres(bodies[0], {v, 10}); });
}

}  // namespace
}  // namespace anamorph::test_number_row
