// SPDX-License-Identifier: Apache-2.0
// What figures may come in, for all filters that read them: collections with gaps, arrays of any layout.
#include <gtest/gtest.h>
#include <vtkAnamorphFigureGeometry.h>
#include <vtkAnamorphFigureOutline.h>
#include <vtkAnamorphFigureSkeleton.h>
#include <vtkNew.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSOADataArrayTemplate.h>
#include <vtkStringArray.h>
#include <vtkUnsignedCharArray.h>

#include "figure_support.h"
#include "support.h"

namespace test_figure_inputs {
namespace {

template <class Filter>
class VtkFigureInput : public testing::Test {};
using Filters =
    testing::Types<vtkAnamorphFigureGeometry, vtkAnamorphFigureOutline, vtkAnamorphFigureSkeleton>;
TYPED_TEST_SUITE(VtkFigureInput, Filters);

const std::vector<Ball> kBalls = {{{510, 500, 20}, {21, 64, 24}, {0.5, -0.1, 0.7, 0.3}},
                                  {{540, 510, -80}, {9, 30, 12}, {1, 0.2, 0, 0.4}}};

TYPED_TEST(VtkFigureInput, CollectionsWithNoneAndEmptyParts) {
    vtkNew<vtkPartitionedDataSetCollection> collection;
    collection->SetNumberOfPartitionedDataSets(3);
    collection->SetPartition(0, 0, figures(kBalls));
    collection->SetPartition(1, 1, vtkNew<vtkPolyData>());
    vtkNew<TypeParam> filter;
    Errors errors(filter);
    filter->SetInputData(collection);
    filter->Update();
    auto* output = vtkPartitionedDataSetCollection::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(output);
    EXPECT_EQ(errors.text(), "");
    auto* first = vtkPolyData::SafeDownCast(output->GetPartition(0, 0));
    ASSERT_TRUE(first);
    const std::vector<double> alone = coordinates(drawn<TypeParam>(figures(kBalls)));
    EXPECT_GT(alone.size(), 6u);
    EXPECT_EQ(coordinates(first), alone);
}

vtkSmartPointer<vtkDataArray> by_component(vtkDataArray* array) {
    auto copy = vtkSmartPointer<vtkSOADataArrayTemplate<double>>::New();
    copy->SetName(array->GetName());
    copy->SetNumberOfComponents(array->GetNumberOfComponents());
    copy->SetNumberOfTuples(array->GetNumberOfTuples());
    for (vtkIdType i = 0; i < array->GetNumberOfTuples(); ++i)
        for (int c = 0; c < array->GetNumberOfComponents(); ++c)
            copy->SetTypedComponent(i, c, array->GetComponent(i, c));
    return copy;
}

TYPED_TEST(VtkFigureInput, ArraysStoredByComponent) {
    const auto input = figures(kBalls), other = figures(kBalls);
    other->GetPoints()->SetData(by_component(input->GetPoints()->GetData()));
    for (const char* name : {"Axes", "Orientation"})
        other->GetPointData()->AddArray(by_component(input->GetPointData()->GetArray(name)));
    const std::vector<double> wanted = coordinates(drawn<TypeParam>(input));
    EXPECT_GT(wanted.size(), 6u);
    EXPECT_EQ(coordinates(drawn<TypeParam>(other)), wanted);
}

TYPED_TEST(VtkFigureInput, GhostsStayGhostsAndHiddenBodiesAreNotThere) {
    const auto input = figures({kBalls[0], kBalls[1], kBalls[1]});
    vtkUnsignedCharArray* ghosts = input->AllocatePointGhostArray();
    ghosts->SetValue(1, vtkDataSetAttributes::DUPLICATEPOINT);
    ghosts->SetValue(2, vtkDataSetAttributes::HIDDENPOINT);
    const auto data = drawn<TypeParam>(input);
    EXPECT_EQ(coordinates(data), coordinates(drawn<TypeParam>(figures(kBalls))));
    const std::vector<double> bodies = cell_numbers(data, "BodyId"),
                              marks = numbers(data->GetCellGhostArray());
    ASSERT_GT(bodies.size(), 1u);
    ASSERT_EQ(marks.size(), bodies.size());
    for (std::size_t k = 0; k < bodies.size(); ++k)
        ASSERT_EQ(marks[k], bodies[k] == 1 ? vtkDataSetAttributes::DUPLICATECELL : 0);
}

TYPED_TEST(VtkFigureInput, ArraysThatAreTooShortAreNotRead) {
    for (const char* name : {"Axes", "Orientation"}) {
        const auto input = figures(kBalls);
        input->GetPointData()->GetArray(name)->SetNumberOfTuples(1);
        EXPECT_THAT(errors_of<TypeParam>(input), testing::HasSubstr("1 tuples, but must have 2"));
    }
    const auto input = figures(kBalls);
    vtkNew<vtkStringArray> names;
    names->SetName("Name");
    names->InsertNextValue("alone");
    input->GetPointData()->AddArray(names);
    input->AllocatePointGhostArray()->SetNumberOfTuples(0);
    const auto data = drawn<TypeParam>(input);
    EXPECT_EQ(coordinates(data), coordinates(drawn<TypeParam>(figures(kBalls))));
    EXPECT_FALSE(data->GetCellData()->HasArray("Name"));
}

TYPED_TEST(VtkFigureInput, TheInputIsLeftAsItIs) {
    const auto input = figures(kBalls);
    vtkNew<vtkPolyData> before;
    before->DeepCopy(input);
    drawn<TypeParam>(input);
    EXPECT_EQ(coordinates(input), coordinates(before));
    ASSERT_EQ(input->GetPointData()->GetNumberOfArrays(), before->GetPointData()->GetNumberOfArrays());
    for (int k = 0; k < before->GetPointData()->GetNumberOfArrays(); ++k)
        EXPECT_EQ(numbers(input->GetPointData()->GetArray(k)), numbers(before->GetPointData()->GetArray(k)));
}

}  // namespace
}  // namespace test_figure_inputs
