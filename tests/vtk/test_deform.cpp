// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <vtkAnamorphDeform.h>
#include <vtkNew.h>
TEST(VtkDeform, New) {
    vtkNew<vtkAnamorphDeform> f;
    EXPECT_TRUE(f);
}
