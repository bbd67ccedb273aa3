// SPDX-License-Identifier: Apache-2.0
// Filters of several ports say in words of their own which of them are not connected.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphDeform.h>
#include <vtkAnamorphDrape.h>
#include <vtkAnamorphImageMorph.h>
#include <vtkAnamorphImageWarp.h>
#include <vtkAnamorphNonlinearTexture.h>
#include <vtkAnamorphPanoramaProjection.h>
#include <vtkAnamorphProjectionBake.h>
#include <vtkNew.h>
#include <vtkPlaneSource.h>

#include "support.h"

namespace test_inputs {
namespace {

using testing::HasSubstr;
using testing::Not;

/// What a filter says that executes as it is.
std::string said_by(vtkAlgorithm* filter) {
    const Errors errors(filter);
    filter->Update();
    EXPECT_THAT(errors.text(), Not(HasSubstr("not optional")));
    return errors.text();
}

TEST(VtkInputs, WhatIsNotConnectedIsSaidInOurWords) {
    EXPECT_THAT(said_by(vtkNew<vtkAnamorphDeform>()),
                HasSubstr("the surface is not given: input port 0 must be connected"));
    EXPECT_THAT(said_by(vtkNew<vtkAnamorphDrape>()),
                HasSubstr("the texture is not given: input port 0 must be connected"));
    EXPECT_THAT(said_by(vtkNew<vtkAnamorphPanoramaProjection>()),
                HasSubstr("the scene is not given: input port 0 must be connected"));
    EXPECT_THAT(said_by(vtkNew<vtkAnamorphNonlinearTexture>()),
                HasSubstr("the mesh is not given: input port 0 must be connected"));
    EXPECT_THAT(said_by(vtkNew<vtkAnamorphImageWarp>()),
                HasSubstr("the image is not given: input port 0 must be connected"));
    EXPECT_THAT(said_by(vtkNew<vtkAnamorphImageMorph>()),
                HasSubstr("the first image is not given: input port 0 must be connected"));
    vtkNew<vtkAnamorphProjectionBake> bake;
    EXPECT_THAT(said_by(bake), HasSubstr("the mesh is not given: input port 0 must be connected"));
    vtkNew<vtkPlaneSource> plane;
    bake->SetInputConnection(plane->GetOutputPort());
    EXPECT_THAT(said_by(bake), HasSubstr("the panorama is not given: input port 1 must be connected"));
}

}  // namespace
}  // namespace test_inputs
