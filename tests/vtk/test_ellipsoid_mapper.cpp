// SPDX-License-Identifier: Apache-2.0
// What of vtkAnamorphEllipsoidMapper needs no display; ellipsoid_mapper.py draws.
#include <vtkAnamorphEllipsoidLocator.h>  // first: it stands alone
#include <vtkAnamorphEllipsoidMapper.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkCompositeDataDisplayAttributes.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkTexture.h>

#include <cmath>

#include "figure_support.h"
#include "support.h"

namespace test_ellipsoid_mapper {
namespace {

using testing::HasSubstr;
using Mapper = vtkAnamorphEllipsoidMapper;

const Ball kTurned{{1, 2, 3}, {3, 1, 2}, {std::sqrt(0.5), 0, 0, std::sqrt(0.5)}};  // a quarter about z

TEST(VtkEllipsoidMapper, BoundsAreThoseOfTheEllipsoids) {
    vtkNew<Mapper> mapper;
    mapper->SetInputData(figures({kTurned}));
    const double wanted[6] = {0, 2, -1, 5, 1, 5};
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(mapper->GetBounds()[k], wanted[k], 1e-12) << k;
    mapper->SetScaleFactor(2);
    EXPECT_NEAR(mapper->GetBounds()[3], 8, 1e-12);
    mapper->SetOrientationArray("");
    EXPECT_NEAR(mapper->GetBounds()[3], 4, 1e-12);
    EXPECT_EQ(mapper->GetNumberOfSkippedPoints(), 0);
}

TEST(VtkEllipsoidMapper, AnyDataSetHasPoints) {
    vtkNew<vtkImageData> image;
    image->SetDimensions(2, 3, 2);
    vtkNew<vtkDoubleArray> tensors;
    tensors->SetName("D");
    tensors->SetNumberOfComponents(9);
    for (vtkIdType i = 0; i < image->GetNumberOfPoints(); ++i)
        tensors->InsertNextTuple9(0.25, 0, 0, 0, 0.5, 0, 0, 0, i == 3 ? kNan : 1);
    image->GetPointData()->AddArray(tensors);
    vtkNew<Mapper> mapper;
    mapper->SetInputData(image);
    mapper->SetShape(Mapper::TENSOR);
    mapper->SetTensorArray("D");
    const double linear[6] = {-0.25, 1.25, -0.5, 2.5, -1, 2},
                 root[6] = {-0.5, 1.5, -std::sqrt(0.5), 2 + std::sqrt(0.5), -1, 2};
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(mapper->GetBounds()[k], linear[k], 1e-12) << k;
    EXPECT_EQ(mapper->GetNumberOfSkippedPoints(), 1);
    mapper->SetShape(Mapper::COVARIANCE);
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(mapper->GetBounds()[k], root[k], 1e-12) << k;
}

TEST(VtkEllipsoidMapper, ALineMeetsTheFirstBody) {
    // Half axes of 2 along y after the turn, of 1 along x, and 2 along z; the other one is behind it.
    const auto data = figures({{{1, 2, -9}, {1, 1, 1}, {1, 0, 0, 0}}, {{1, 2, 3}, {2, 1, 2}, kTurned.turn}});
    vtkNew<Mapper> mapper;
    mapper->SetInputData(data);
    const double from[3] = {1, 2, 13}, to[3] = {1, 2, -27};
    double t = -1;
    vtkIdType cell = 7;
    const auto meet = [&](const glm::dvec3& first, const glm::dvec3& last) {
        return mapper->IntersectWithLine(data, &first.x, &last.x, t, cell);
    };
    EXPECT_EQ(meet({1, 2, 13}, {1, 2, -27}), 1);
    EXPECT_NEAR(t, 8.0 / 40, 1e-12);
    EXPECT_EQ(cell, -1) << "the points are in no cell";
    EXPECT_EQ(meet({1, 2, 3}, {1, 2, 13}), 1);
    EXPECT_NEAR(t, 0.2, 1e-12) << "out of it";
    EXPECT_EQ(meet({1, 2, 0}, {1, 2, -10}), 0);
    EXPECT_EQ(meet({1, 2, 13}, {1, 2, 6}), -1) << "too short";
    EXPECT_EQ(meet({1, 3.9, 13}, {1, 3.9, -10}), 1);
    EXPECT_EQ(meet({1, 4.1, 13}, {1, 4.1, -10}), -1);
    EXPECT_EQ(meet({1, 2, 13}, {1, 2, 13}), -1) << "a line without length";
    EXPECT_EQ(meet({kNan, 2, 13}, {1, 2, 13}), -1);
    EXPECT_EQ(mapper->IntersectWithLine(vtkNew<vtkImageData>(), from, to, t, cell), -1);
    mapper->AddLocators(nullptr);
    vtkNew<vtkAnamorphEllipsoidLocator> locator;
    locator->SetDataSet(data);
    double x[3], where[3];
    int part = 0;
    EXPECT_EQ(locator->IntersectWithLine(from, to, 0, t, x, where, part, cell, nullptr), 0) << "no mapper";
}

TEST(VtkEllipsoidMapper, WhatCannotBeDoneIsAnError) {
    const auto error = [](const std::function<void(Mapper*)>& set) {
        vtkNew<Mapper> mapper;
        Errors errors(mapper);
        mapper->SetInputData(figures({kTurned}));
        set(mapper);
        mapper->GetBounds();
        return errors.text();
    };
    EXPECT_EQ(error([](Mapper*) {}), "");
    EXPECT_THAT(error([](Mapper* m) { m->SetAxesArray("none"); }),
                HasSubstr("AxesArray=\"none\": must be the name of"));
    EXPECT_THAT(error([](Mapper* m) { m->SetOrientationArray("Axes"); }),
                HasSubstr("OrientationArray=\"Axes\": has 3 components, but must have 4"));
    EXPECT_THAT(error([](Mapper* m) { m->SetShape(Mapper::TENSOR); }), HasSubstr("TensorArray=\"\""));
    for (const double scale : {0.0, -1.0, kNan, kInf})
        EXPECT_THAT(error([&](Mapper* m) { m->SetScaleFactor(scale); }), HasSubstr("ScaleFactor=")) << scale;
}

TEST(VtkEllipsoidMapper, AShallowCopyDrawsTheSame) {
    // No vtkPolyData, and nothing as it is by default.
    vtkNew<vtkImageData> points;
    points->SetDimensions(1, 1, 1);
    vtkNew<vtkDoubleArray> tensors;
    tensors->SetName("D");
    tensors->SetNumberOfComponents(9);
    tensors->InsertNextTuple9(1, 0, 0, 0, 4, 0, 0, 0, 9);
    points->GetPointData()->AddArray(tensors);
    vtkNew<vtkCompositeDataDisplayAttributes> blocks;
    vtkNew<Mapper> one, copy;
    one->SetInputData(points);
    one->SetShape(Mapper::COVARIANCE);
    one->SetAxesArray("a");
    one->SetOrientationArray("b");
    one->SetTensorArray("D");
    one->SetScaleFactor(2);
    one->SetTextureArray("c");
    one->SetTextureOffsetArray("d");
    one->SetTextureMapping(Mapper::LINEAR);
    one->AddTexture(vtkNew<vtkTexture>(), "wood");
    one->SetCompositeDataDisplayAttributes(blocks);
    one->ScalarVisibilityOff();
    copy->AddTexture(vtkNew<vtkTexture>());
    copy->AddTexture(vtkNew<vtkTexture>());
    copy->ShallowCopy(one);
    const double wanted[6] = {-2, 2, -4, 4, -6, 6};
    for (int k = 0; k < 6; ++k) EXPECT_NEAR(copy->GetBounds()[k], wanted[k], 1e-12) << k;
    EXPECT_EQ(copy->GetShape(), Mapper::COVARIANCE);
    EXPECT_STREQ(copy->GetAxesArray(), "a");
    EXPECT_STREQ(copy->GetOrientationArray(), "b");
    EXPECT_STREQ(copy->GetTextureArray(), "c");
    EXPECT_STREQ(copy->GetTextureOffsetArray(), "d");
    EXPECT_EQ(copy->GetTextureMapping(), Mapper::LINEAR);
    EXPECT_EQ(copy->GetNumberOfTextures(), 1);
    EXPECT_EQ(copy->GetCompositeDataDisplayAttributes(), blocks.Get());
    EXPECT_FALSE(copy->GetScalarVisibility());
    copy->ShallowCopy(copy);
    EXPECT_EQ(copy->GetNumberOfTextures(), 1);
    copy->ShallowCopy(vtkNew<Mapper>());
    EXPECT_EQ(copy->GetNumberOfInputConnections(0), 0);
    EXPECT_EQ(copy->GetNumberOfTextures(), 0);
}

TEST(VtkEllipsoidMapper, TheSameValueLeavesItsTime) {
    vtkNew<Mapper> mapper;
    vtkNew<vtkCompositeDataDisplayAttributes> blocks;
    expect_modified_by<Mapper>(
        mapper, {[](Mapper* m) { m->SetShape(Mapper::COVARIANCE); }, [](Mapper* m) { m->SetAxesArray("a"); },
                 [](Mapper* m) { m->SetOrientationArray("b"); }, [](Mapper* m) { m->SetTensorArray("c"); },
                 [](Mapper* m) { m->SetScaleFactor(3); }, [](Mapper* m) { m->SetTextureArray("d"); },
                 [](Mapper* m) { m->SetTextureOffsetArray("e"); },
                 [](Mapper* m) { m->SetTextureMapping(Mapper::LINEAR); },
                 [&](Mapper* m) { m->SetCompositeDataDisplayAttributes(blocks); }});
    const vtkMTimeType before = mapper->GetMTime();
    blocks->SetBlockVisibility(figures({kTurned}), false);
    EXPECT_GT(mapper->GetMTime(), before);
    mapper->SetAxesArray(nullptr);
    EXPECT_STREQ(mapper->GetAxesArray(), "");
}

TEST(VtkEllipsoidMapper, PrintsItsState) {
    expect_printed(vtkNew<Mapper>(),
                   {"Shape: axes", "AxesArray: Axes", "OrientationArray: Orientation",
                    "TensorArray: ", "ScaleFactor: 1", "NumberOfTextures: 0", "TextureArray: Texture",
                    "TextureOffsetArray: TextureOffset", "TextureMapping: latlong"});
}

TEST(VtkEllipsoidMapper, FactoriesMayOverrideIt) {
    expect_overridden<vtkAnamorphEllipsoidMapper>("vtkAnamorphEllipsoidMapper");
}

}  // namespace
}  // namespace test_ellipsoid_mapper
