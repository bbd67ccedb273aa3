// SPDX-License-Identifier: Apache-2.0
// vtkAnamorphDeform with formulas that are text, against the formulas written out in long double.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <vtkAnamorphDeform.h>
#include <vtkCellArray.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkMultiBlockDataSet.h>
#include <vtkNew.h>
#include <vtkPartitionedDataSet.h>
#include <vtkPartitionedDataSetCollection.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkTable.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <glm/geometric.hpp>
#include <limits>
#include <string>
#include <vector>

#include "anamorph/deform/deformation.h"
#include "support.h"

namespace test_deform_formula {
namespace {

using anamorph::Deformation;
using testing::HasSubstr;
using Real = long double;
using Three = std::array<Real, 3>;
using Filter = vtkAnamorphDeform*;

/// A square of n x n points of x and y in [-1, 1], with texture coordinates from 0 to 1. No grid in memory if a
/// point is off by a hair.
vtkSmartPointer<vtkPolyData> sheet(int n, int type = VTK_DOUBLE, bool is_grid = true) {
    vtkNew<vtkPoints> points;
    points->SetDataType(type);
    vtkNew<vtkFloatArray> coordinates;
    coordinates->SetName("uv");
    coordinates->SetNumberOfComponents(2);
    for (int k = 0; k < n * n; ++k) {
        const double s = static_cast<double>(k % n) / (n - 1), t = static_cast<double>(k / n) / (n - 1);
        points->InsertNextPoint(2 * s - 1, 2 * t - 1, 0);
        coordinates->InsertNextTuple2(s, t);
    }
    if (!is_grid) points->SetPoint(n + 1, -.987, -.953, 0);
    vtkNew<vtkCellArray> cells;
    for (int j = 0; j + 1 < n; ++j)
        for (int i = 0; i + 1 < n; ++i) {
            const vtkIdType at = j * n + i, quad[4] = {at, at + 1, at + n + 1, at + n};
            cells->InsertNextCell(4, quad);
        }
    auto mesh = vtkSmartPointer<vtkPolyData>::New();
    mesh->SetPoints(points);
    mesh->SetPolys(cells);
    mesh->GetPointData()->SetTCoords(coordinates);
    return mesh;
}

void set_formula(Filter filter, const char* x, const char* y, const char* z, const char* definitions = "") {
    filter->SetFormulaX(x);
    filter->SetFormulaY(y);
    filter->SetFormulaZ(z);
    filter->SetFormulaDefinitions(definitions);
}
void set_moebius(Filter filter) {
    set_formula(filter, "(1+w)*cos(pi*u)-u", "(1+w)*sin(pi*u)-v", "v/2*sin(pi*u/2)", "w=v/2*cos(pi*u/2)");
}
Three moebius(Real u, Real v) {
    const Real turn = acosl(-1) * u, wide = 1 + v * cosl(turn / 2) / 2;
    return {wide * cosl(turn) - u, wide * sinl(turn) - v, v * sinl(turn / 2) / 2};
}
void set_saddle(Filter filter) {
    set_formula(filter, "", "", "k*(u^2-v^2)", "k=0.75");
}
Three saddle(Real u, Real v) {
    return {0, 0, (u - v) * (u + v) * 3 / 4};
}

/// A formula as text, and what it is.
struct Known {
    void (*set)(Filter);
    Three (*moved)(Real, Real);
};
constexpr Known kSaddle{set_saddle, saddle}, kMoebius{set_moebius, moebius};

/// Three bumps: the first far out, the others small.
std::vector<Deformation> three_bumps() {
    return {{{.1, .2, .3}, {.4, -.2}, {.5, .3}},
            {{0, 0, -.2}, {-.5, -.5}, {.1, .2}},
            {{.1, 0, 0}, {-.5, .5}, {.2, .2}, anamorph::DeformationKernel::wendland_c2}};
}
void add(Filter filter, const std::vector<Deformation>& list) {
    for (const Deformation& d : list)
        filter->AddDeformation(d.center.x, d.center.y, d.extent.x, d.extent.y, d.vector.x, d.vector.y,
                               d.vector.z, d.kernel == anamorph::DeformationKernel::gaussian ? 0 : 1);
}

vtkPointSet* output(Filter filter) {
    return vtkPointSet::SafeDownCast(filter->GetOutputDataObject(0));
}
std::vector<double> array_of(Filter filter, const char* name) {
    return numbers(output(filter)->GetPointData()->GetArray(name));
}
double field_value(vtkDataObject* data, const char* name) {
    vtkDataArray* array = data->GetFieldData()->GetArray(name);
    return array ? array->GetComponent(0, 0) : kNan;
}
/// Everything that a filter makes, to the bit.
std::vector<double> all_of(Filter filter) {
    std::vector<double> all = coordinates(output(filter));
    for (const char* name : {"Displacement", "Normals"}) {
        const std::vector<double> more = array_of(filter, name);
        all.insert(all.end(), more.begin(), more.end());
    }
    return all;
}

/// The points of the output are those of the mesh, moved as `moved` says, within the bound and one rounding.
void expect_moved(vtkPointSet* mesh, vtkPointSet* out, double bound,
                  const std::function<Three(Real, Real)>& moved) {
    ASSERT_EQ(mesh->GetNumberOfPoints(), out->GetNumberOfPoints());
    const bool is_float = out->GetPoints()->GetDataType() == VTK_FLOAT;
    const double half_unit = is_float ? 0x1p-24 : 0x1p-53;
    vtkDataArray* displacement = out->GetPointData()->GetArray("Displacement");
    ASSERT_TRUE(displacement);
    for (vtkIdType i = 0; i < mesh->GetNumberOfPoints(); ++i) {
        double p[3], q[3], d[3];
        mesh->GetPoint(i, p);
        out->GetPoint(i, q);
        displacement->GetTuple(i, d);
        const Three exact = moved(p[0], p[1]);
        for (std::size_t c = 0; c < 3; ++c) {
            // In double, before it is rounded to float, a point is rounded too.
            ASSERT_LE(fabsl(q[c] - (p[c] + exact[c])),
                      bound + (half_unit + 0x1p-53) * (std::fabs(q[c]) + bound))
                << i;
            ASSERT_LE(fabsl(d[c] - exact[c]), bound + (is_float ? half_unit * std::fabs(d[c]) : 0)) << i;
        }
    }
}

}  // namespace

TEST(VtkDeformFormula, MovesPointsAsItSays) {
    for (const int type : {VTK_FLOAT, VTK_DOUBLE})
        for (const bool is_grid : {true, false})
            for (const bool normals : {true, false})
                for (const auto& [set, moved] : {kSaddle, kMoebius}) {
                    const auto mesh = sheet(41, type, is_grid);
                    vtkNew<vtkAnamorphDeform> filter;
                    filter->SetInputData(mesh);
                    filter->SetComputeNormals(normals);
                    set(filter);
                    filter->Update();
                    EXPECT_GT(filter->GetErrorBound(), 0);
                    EXPECT_LT(filter->GetErrorBound(), 1e-13);
                    EXPECT_EQ(field_value(output(filter), "anamorph:error_bound"), filter->GetErrorBound());
                    EXPECT_EQ(field_value(output(filter), "anamorph:undefined_points"), 0);
                    expect_moved(mesh, output(filter), filter->GetErrorBound(), moved);
                    EXPECT_EQ(filter->GetNumberOfPointsComputed(), 41 * 41);
                }
}

TEST(VtkDeformFormula, AddsToBumps) {
    const std::vector<Deformation> list = three_bumps();
    for (const bool is_grid : {true, false}) {
        const auto mesh = sheet(50, VTK_DOUBLE, is_grid);
        vtkNew<vtkAnamorphDeform> filter;
        filter->SetInputData(mesh);
        filter->SetCutoff(1e-15);
        set_moebius(filter);
        add(filter, list);
        filter->Update();
        EXPECT_LT(filter->GetErrorBound(), 1e-11);
        expect_moved(mesh, output(filter), filter->GetErrorBound() + 1e-15, [&](Real u, Real v) {
            Three sum = moebius(u, v);
            const glm::dvec3 bumps =
                displacement_at(list, {static_cast<double>(u), static_cast<double>(v)}).value;
            for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(c)] += bumps[c];
            return sum;
        });
        // Without the formula nothing of it is left.
        set_formula(filter, "", "", "", "not read");
        filter->Update();
        vtkNew<vtkAnamorphDeform> fresh;
        fresh->SetInputData(mesh);
        fresh->SetCutoff(1e-15);
        add(fresh, list);
        fresh->Update();
        EXPECT_EQ(all_of(filter), all_of(fresh));
        EXPECT_EQ(filter->GetErrorBound(), fresh->GetErrorBound());
        EXPECT_FALSE(output(filter)->GetFieldData()->GetArray("anamorph:undefined_points"));
    }
}

TEST(VtkDeformFormula, NormalsAreThoseOfItsDerivatives) {
    const std::vector<Deformation> list = three_bumps();
    for (const bool is_grid : {true, false})
        for (const bool given : {true, false}) {
            const auto mesh = sheet(30, VTK_DOUBLE, is_grid);
            if (given) {
                vtkNew<vtkDoubleArray> up;
                up->SetName("Normals");
                up->SetNumberOfComponents(3);
                for (int i = 0; i < 900; ++i) up->InsertNextTuple3(0, 0, 1);
                mesh->GetPointData()->SetNormals(up);
            }
            vtkNew<vtkAnamorphDeform> filter;
            filter->SetInputData(mesh);
            filter->SetCutoff(1e-15);
            set_saddle(filter);
            for (const bool bumps : {false, true}) {
                if (bumps) add(filter, list);
                filter->Update();
                const std::vector<double> normals = array_of(filter, "Normals");
                ASSERT_EQ(normals.size(), 2700u);
                for (vtkIdType i = 0; i < 900; ++i) {
                    double p[3];
                    mesh->GetPoint(i, p);
                    anamorph::DisplacementJet jet;
                    if (bumps) jet = displacement_at(list, {p[0], p[1]});
                    jet.by_u.z += 1.5 * p[0];
                    jet.by_v.z -= 1.5 * p[1];
                    const glm::dvec3 expected = normal_of(jet, {1, 0, 0}, {0, 1, 0});
                    const double* n = normals.data() + 3 * i;
                    ASSERT_LE(glm::length(glm::dvec3(n[0], n[1], n[2]) - expected), 1e-9) << i;
                }
            }
        }
}

TEST(VtkDeformFormula, EditsComputeWhatTheyReachAndLeaveNoTrace) {
    for (const bool is_grid : {true, false}) {
        const auto mesh = sheet(60, VTK_DOUBLE, is_grid);
        vtkNew<vtkAnamorphDeform> filter;
        filter->SetInputData(mesh);
        set_formula(filter, "", "sin(5*u)*v", "frame*u*v");
        filter->SetFrame(2);
        add(filter, three_bumps());
        filter->Update();
        const std::vector<double> first = all_of(filter);
        vtkNew<vtkPolyData> held;  // by somebody: it must not change under them
        held->ShallowCopy(output(filter));
        const std::vector<double> held_points = coordinates(held);

        filter->AddDeformation(.2, .3, .02, .02, .1, 0, .2);
        filter->Update();
        EXPECT_GT(filter->GetNumberOfPointsComputed(), 0);
        EXPECT_LT(filter->GetNumberOfPointsComputed(), 1600);
        vtkNew<vtkAnamorphDeform> fresh;
        fresh->SetInputData(mesh);
        set_formula(fresh, "", "sin(5*u)*v", "frame*u*v");
        fresh->SetFrame(2);
        fresh->AddDeformation(.2, .3, .02, .02, .1, 0, .2);
        add(fresh, three_bumps());
        fresh->Update();
        EXPECT_EQ(all_of(filter), all_of(fresh));
        EXPECT_EQ(filter->GetErrorBound(), fresh->GetErrorBound());
        EXPECT_NE(all_of(filter), first);
        EXPECT_EQ(coordinates(held), held_points);

        filter->RemoveDeformation(3);
        filter->Update();
        EXPECT_LT(filter->GetNumberOfPointsComputed(), 1600);
        EXPECT_EQ(all_of(filter), first);
        // Another frame moves all points, and the same again none.
        filter->SetFrame(3);
        filter->Update();
        EXPECT_EQ(filter->GetNumberOfPointsComputed(), 3600);
        EXPECT_NE(all_of(filter), first);
        filter->SetFrame(2);
        filter->SetDeformation(0, 0, 0, 1, 1, 0, 0, 1);
        filter->SetFormulaDefinitions("k=1");  // that nothing uses
        filter->Update();
        EXPECT_EQ(filter->GetNumberOfPointsComputed(), 3600);
        filter->SetFormulaDefinitions("");
        filter->Update();
        EXPECT_EQ(filter->GetNumberOfPointsComputed(), 0);
        const Deformation d = three_bumps()[0];
        filter->SetDeformation(0, d.center.x, d.center.y, d.extent.x, d.extent.y, d.vector.x, d.vector.y,
                               d.vector.z);
        filter->Update();
        EXPECT_EQ(all_of(filter), first);
    }
}

TEST(VtkDeformFormula, PointsWhereItHasNoValueStay) {
    const auto mesh = sheet(40);
    mesh->GetPoints()->SetPoint(0, kNan, 0, 0);  // not counted
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(mesh);
    filter->AutomaticPlaneOff();
    set_formula(filter, "1", "", "sqrt(0.5-u^2-v^2)");
    filter->Update();
    vtkIdType undefined = 0;
    for (vtkIdType i = 1; i < 1600; ++i) {
        double p[3], q[3];
        mesh->GetPoint(i, p);
        output(filter)->GetPoint(i, q);
        const Real square = Real(0.5) - Real(p[0]) * p[0] - Real(p[1]) * p[1];
        undefined += square <= 0 ? 1 : 0;
        EXPECT_NEAR(q[0], p[0] + (square > 0 ? 1 : 0), 1e-15);
        EXPECT_NEAR(q[2], square > 0 ? sqrtl(square) : 0, filter->GetErrorBound());
    }
    EXPECT_GT(undefined, 100);
    EXPECT_EQ(filter->GetNumberOfUndefinedPoints(), undefined);
    EXPECT_EQ(field_value(output(filter), "anamorph:undefined_points"), static_cast<double>(undefined));
    EXPECT_LT(filter->GetErrorBound(), 1e-12);
    for (const double n : array_of(filter, "Normals")) EXPECT_TRUE(std::isfinite(n));
}

TEST(VtkDeformFormula, JumpsHaveABound) {
    // No point of the mesh lies on a jump.
    const auto mesh = sheet(50);
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(mesh);
    set_formula(filter, "floor(3*v)", "", "if(u<0.123,u*v,5)");
    filter->Update();
    EXPECT_LT(filter->GetErrorBound(), 1e-13);
    expect_moved(mesh, output(filter), filter->GetErrorBound(), [](Real u, Real v) {
        return Three{floorl(3 * v), 0, u < Real(0.123) ? u * v : 5};
    });
    // 1/3 is next to one, and rounding decides.
    mesh->GetPoints()->SetPoint(700, 0, .1, 0);
    set_formula(filter, "floor(10*v*3/3)", "", "");
    mesh->Modified();
    filter->Update();
    EXPECT_GE(filter->GetErrorBound(), 1);
    EXPECT_LT(filter->GetErrorBound(), 1.01);
}

TEST(VtkDeformFormula, WhatIsRefused) {
    const auto mesh = sheet(6);
    const auto failure = [&](const std::function<void(Filter)>& set) {
        vtkNew<vtkAnamorphDeform> filter;
        filter->SetInputData(mesh);
        Errors errors(filter);
        set(filter);
        filter->Update();
        EXPECT_EQ(output(filter)->GetNumberOfPoints(), 0);
        return errors.text();
    };
    EXPECT_THAT(failure([](Filter f) { f->SetFormulaX("u+"); }),
                HasSubstr("FormulaX=u+: column 3: expected a number, a name or ("));
    EXPECT_THAT(failure([](Filter f) { f->SetFormulaY("aspect"); }),
                HasSubstr("FormulaY=aspect: column 1: expected a name that is known, not aspect"));
    EXPECT_THAT(failure([](Filter f) { f->SetFormulaZ("sin(u"); }),
                HasSubstr("FormulaZ=sin(u: column 6: expected )"));
    EXPECT_THAT(failure([](Filter f) { set_formula(f, "u", "", "", "k=1;l"); }),
                HasSubstr("FormulaDefinitions=k=1;l: column 6: expected ="));
    EXPECT_THAT(failure([](Filter f) { f->SetFrame(kNan); }),
                HasSubstr("Frame=nan: must be a finite number"));
    EXPECT_THAT(failure([](Filter f) { f->SetFrame(-kInf); }), HasSubstr("Frame=-inf"));
    // What is mended afterwards works.
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(mesh);
    Errors errors(filter);
    filter->SetFormulaZ("1+");
    filter->Update();
    EXPECT_NE(errors.text(), "");
    errors.clear();
    filter->SetFormulaZ("1");
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    EXPECT_EQ(output(filter)->GetPoint(0)[2], 1);
}

TEST(VtkDeformFormula, SameBitsForAnyThreads) {
    for (const bool is_grid : {true, false}) {
        const auto mesh = sheet(90, VTK_DOUBLE, is_grid);
        std::vector<double> first;
        double bound = 0;
        for_any_threads([&] {
            vtkNew<vtkAnamorphDeform> filter;
            filter->SetInputData(mesh);
            set_moebius(filter);
            add(filter, three_bumps());
            filter->Update();
            if (first.empty()) {
                first = all_of(filter);
                bound = filter->GetErrorBound();
            }
            EXPECT_EQ(all_of(filter), first);
            EXPECT_EQ(filter->GetErrorBound(), bound);
        });
        EXPECT_GT(bound, 0);
    }
}

TEST(VtkDeformFormula, Composites) {
    // Leaves that are parts of a mesh move as it does, each with a bound of its own.
    const auto mesh = sheet(40, VTK_DOUBLE), other = sheet(9, VTK_FLOAT), empty = sheet(2);
    empty->Initialize();
    vtkNew<vtkMultiBlockDataSet> blocks;
    blocks->SetBlock(0, mesh);
    blocks->SetBlock(2, empty);
    blocks->SetBlock(3, other);
    blocks->SetBlock(4, vtkNew<vtkTable>());
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(blocks);
    set_formula(filter, "", "", "sqrt(u)*exp(v)");
    Errors errors(filter);
    filter->Update();
    EXPECT_EQ(errors.text(), "");
    const auto moved = [](Real u, Real v) { return Three{0, 0, u > 0 ? sqrtl(u) * expl(v) : 0}; };
    auto* out = vtkMultiBlockDataSet::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(out);
    for (const unsigned i : {0u, 3u}) {
        const double bound = field_value(out->GetBlock(i), "anamorph:error_bound");
        EXPECT_GT(bound, 0);
        EXPECT_LE(bound, filter->GetErrorBound());
        expect_moved(vtkPointSet::SafeDownCast(blocks->GetBlock(i)),
                     vtkPointSet::SafeDownCast(out->GetBlock(i)), bound, moved);
    }
    EXPECT_EQ(field_value(out->GetBlock(0), "anamorph:undefined_points"), 20 * 40);
    EXPECT_EQ(field_value(out->GetBlock(2), "anamorph:undefined_points"), 0);
    EXPECT_EQ(filter->GetNumberOfUndefinedPoints(), 20 * 40 + 5 * 9);

    vtkNew<vtkPartitionedDataSetCollection> collection;
    vtkNew<vtkPartitionedDataSet> parts;
    parts->SetNumberOfPartitions(2);
    parts->SetPartition(1, mesh);
    collection->SetPartitionedDataSet(1, parts);
    filter->SetInputData(collection);
    filter->Update();
    auto* result = vtkPartitionedDataSetCollection::SafeDownCast(filter->GetOutputDataObject(0));
    ASSERT_TRUE(result);
    expect_moved(mesh, vtkPointSet::SafeDownCast(result->GetPartition(1, 1)), filter->GetErrorBound(), moved);
    EXPECT_EQ(errors.text(), "");
}

TEST(VtkDeformFormula, APieceIsAPartOfTheWhole) {
    const auto whole = sheet(24), piece = sheet(24);
    vtkNew<vtkPoints> lower;
    lower->SetDataTypeToDouble();
    for (vtkIdType i = 7 * 24 + 5; i < 24 * 24; ++i) lower->InsertNextPoint(whole->GetPoint(i));
    piece->SetPolys(nullptr);
    piece->GetPointData()->Initialize();
    piece->SetPoints(lower);
    std::vector<double> moved[2];
    for (const int k : {0, 1}) {
        vtkNew<vtkAnamorphDeform> filter;
        filter->SetInputData(k == 0 ? whole : piece);
        filter->AutomaticPlaneOff();
        set_moebius(filter);
        add(filter, three_bumps());
        filter->Update();
        moved[k] = coordinates(output(filter));
    }
    EXPECT_TRUE(std::equal(moved[1].rbegin(), moved[1].rend(), moved[0].rbegin()));
}

TEST(VtkDeformFormula, TextureCoordinates) {
    const auto mesh = sheet(20, VTK_FLOAT);
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(mesh);
    filter->SetParameterModeToTextureCoordinates();
    filter->SetOutputPointsPrecision(vtkAlgorithm::DOUBLE_PRECISION);
    set_formula(filter, "", "", "u+10*v");
    filter->Update();
    for (vtkIdType i = 0; i < 400; ++i) {
        const double* s = mesh->GetPointData()->GetTCoords()->GetTuple2(i);
        const double expected = s[0] + 10 * s[1];
        EXPECT_NEAR(output(filter)->GetPoint(i)[2], expected, 1e-14);
    }
}

TEST(VtkDeformFormula, TheOverlayLiesOnTheSurface) {
    const auto mesh = sheet(40);
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(mesh);
    filter->AddDeformation(.2, -.1, .3, .2, 0, 0, .5);
    set_formula(filter, "", "", "u*v");
    filter->GenerateOverlayOn();
    filter->Update();
    vtkPolyData* overlay = filter->GetOverlay();
    ASSERT_EQ(overlay->GetNumberOfCells(), 3);
    for (vtkIdType i = 0; i < overlay->GetNumberOfPoints(); ++i) {
        double p[3];
        overlay->GetPoint(i, p);
        const double x = (p[0] - .2) / .3, y = (p[1] + .1) / .2;
        EXPECT_NEAR(p[2], .5 * std::exp(-x * x - y * y) + p[0] * p[1], 1e-6);
    }
}

TEST(VtkDeformFormula, ExecutesOnlyWhenSomethingChanged) {
    vtkNew<vtkAnamorphDeform> filter;
    filter->SetInputData(sheet(20));
    expect_modified_by<vtkAnamorphDeform>(
        filter, {[](Filter f) { f->SetFormulaX("u"); }, [](Filter f) { f->SetFormulaY("v"); },
                 [](Filter f) { f->SetFormulaZ("frame"); }, [](Filter f) { f->SetFormulaDefinitions("k=1"); },
                 [](Filter f) { f->SetFrame(.5); }, [](Filter f) { f->SetFormulaX(nullptr); }});
    EXPECT_STREQ(filter->GetFormulaX(), "");
    expect_executed_once(filter);
    expect_printed(filter, {"FormulaX: \n", "FormulaY: v", "FormulaZ: frame", "FormulaDefinitions: k=1",
                            "Frame: 0.5", "NumberOfUndefinedPoints: 0"});
}

TEST(VtkDeformFormula, ProgressRisesAndItCanBeStopped) {
    const auto mesh = sheet(200);
    vtkNew<ProgressObserver> observer;
    vtkNew<vtkAnamorphDeform> filter;
    observer->algorithm = filter;
    filter->AddObserver(vtkCommand::ProgressEvent, observer);
    filter->SetInputData(mesh);
    set_moebius(filter);
    filter->Update();
    EXPECT_TRUE(std::is_sorted(observer->reports.begin(), observer->reports.end()));
    EXPECT_EQ(observer->reports.back(), 1);
    const std::vector<double> expected = all_of(filter);
    observer->abort_at = .1;
    filter->SetFrame(1);
    filter->Update();
    observer->abort_at = -1;
    filter->SetAbortExecute(0);
    filter->SetFrame(0);
    filter->Update();
    EXPECT_EQ(all_of(filter), expected);
}

}  // namespace test_deform_formula
