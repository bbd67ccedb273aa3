// SPDX-License-Identifier: Apache-2.0
// What was added by a file and a line (tests/toys): the surface is drawn, blended and named by the filter and its proxy, the
// projection named.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphDrape.h>
#include <vtkAnamorphPanoramaProjection.h>
#include <vtkDataArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "anamorph/surface/surface.h"

namespace {

using Drape = vtkAnamorphDrape;
using testing::HasSubstr;

constexpr int kSide = 64;

/// How far, in pixels, points are seen from where the toy's formula, z = (x^2 - y^2) / 2, times a weight, has them: from the side,
/// along (-1, 0, -1), without perspective. The texture is as wide as it is high.
double off_the_toy(Drape& filter, double weight) {
    vtkNew<vtkImageData> texture;
    texture->SetDimensions(8, 8, 1);
    texture->AllocateScalars(VTK_UNSIGNED_CHAR, 3);
    filter.SetInputData(texture);
    filter.SetViewSize(kSide, kSide);
    filter.CameraParallelProjectionOn();
    filter.SetCameraParallelScale(0.5);
    filter.SetCameraPosition(2, 0, 2);
    filter.SetTolerance(0.01);
    filter.SetStyle(Drape::TEXTURE_COORDINATES);
    filter.Update();
    vtkDataArray* drawn = filter.GetOutput()->GetPointData()->GetScalars();
    double most = 0;
    int seen = 0;
    for (int k = 0; drawn && k < kSide * kSide; ++k) {
        const double x = drawn->GetComponent(k, 0) - 0.5, y = drawn->GetComponent(k, 1) - 0.5;
        if (x < -0.5) continue;
        const double z = weight * (x * x - y * y) / 2, across = (x - z) / std::sqrt(2.0);
        most = std::max({most, std::fabs((across + 0.5) * kSide - (k % kSide + 0.5)),
                         std::fabs((y + 0.5) * kSide - (k / kSide + 0.5))});
        ++seen;
    }
    return seen > 1000 ? most : HUGE_VAL;
}

TEST(ToySurface, HasAnEnumeratorAndPositionsKeepsItsValue) {
    EXPECT_EQ(anamorph::surface::surface_names().back(), "toy_saddle");
    EXPECT_EQ(int{Drape::POSITIONS}, 7) << "saved states have that number";
    EXPECT_EQ(int{Drape::FORMULA}, 8) << "and that one";
    EXPECT_EQ(int{Drape::TOY_SADDLE}, 9);
    EXPECT_EQ(int{Drape::NumberOfSurfaces}, 10);
    vtkNew<Drape> filter;
    filter->SetSurface(100);
    EXPECT_EQ(filter->GetSurface(), 9);
    filter->SetBlendWeight(9, 0.5);
    EXPECT_EQ(filter->GetBlendWeights()[9], 0.5);
}

TEST(ToySurface, IsDrawnAndBlended) {
    vtkNew<Drape> filter;
    filter->SetSurface(Drape::TOY_SADDLE);
    EXPECT_LT(off_the_toy(*filter, 1), 0.011);
    vtkNew<Drape> blended;
    blended->SetBlendWeight(Drape::TOY_SADDLE, 0.5);
    EXPECT_LT(off_the_toy(*blended, 0.5), 0.011);
    std::ostringstream text;
    filter->Print(text);
    EXPECT_THAT(text.str(), HasSubstr("Surface: toy_saddle"));
}

/// The file of a proxy.
std::stringstream proxy(const std::string& name) {
    std::ifstream file(TOY_PROXIES "/" + name + ".xml");
    std::stringstream text;
    text << file.rdbuf();
    return text;
}

TEST(ToyProjection, HasAnEnumeratorAndIsInTheProxy) {
    EXPECT_EQ(int{vtkAnamorphPanoramaProjection::CUBEMAP_3X2}, 8);
    EXPECT_EQ(int{vtkAnamorphPanoramaProjection::TOY}, 22);
    EXPECT_EQ(int{vtkAnamorphPanoramaProjection::NumberOfProjections}, 23);
    const std::string menu = proxy("panorama_view").str();
    EXPECT_THAT(menu, HasSubstr("<Entry value=\"0\" text=\"Equirectangular\"/>"));
    EXPECT_THAT(menu, HasSubstr("<Entry value=\"8\" text=\"Cubemap 3 x 2\"/>"));
    EXPECT_THAT(menu, HasSubstr("<Entry value=\"22\" text=\"Toy\"/>"));
}

TEST(ToySurface, IsInTheProxy) {
    const std::stringstream text = proxy("drape");
    EXPECT_THAT(text.str(), HasSubstr("<Entry value=\"7\" text=\"Positions\"/>"));
    EXPECT_THAT(text.str(), HasSubstr("<Entry value=\"9\" text=\"Toy saddle\"/>"));
    EXPECT_THAT(text.str(), HasSubstr("<ComponentLabel component=\"9\" label=\"Toy saddle\"/>"));
    EXPECT_THAT(text.str(), HasSubstr("number_of_elements=\"10\" argument_is_array"));
    EXPECT_THAT(text.str(), HasSubstr("default_values=\"0 0 0 0 0 0 0 0 0 0\""));
}

}  // namespace
