# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphDeform and its list from Python: properties, edits, tables, files, the transform.
import json
import math
import os
import tempfile

import anamorph
from conformance import Source, steps_of, time_of
from vtkmodules.vtkCommonDataModel import vtkPartitionedDataSetCollection, vtkTable
from vtkmodules.vtkFiltersGeneral import vtkTransformFilter
from vtkmodules.vtkFiltersSources import vtkPlaneSource


def points_of(mesh):
    return [mesh.GetPoint(i) for i in range(mesh.GetNumberOfPoints())]


plane = vtkPlaneSource()
plane.SetOrigin(-1, -1, 0)
plane.SetPoint1(1, -1, 0)
plane.SetPoint2(-1, 1, 0)
plane.SetResolution(20, 20)
plane.SetOutputPointsPrecision(1)

deform = anamorph.vtkAnamorphDeform()
deform.SetInputConnection(plane.GetOutputPort())
assert "AutomaticPlane" in str(deform)

# Every property: what is set is what is got; the same value again changes nothing.
for name, value in {"Cutoff": 1e-5, "ParameterMode": 1, "AutomaticPlane": False, "Origin": (1.0, 2.0, 3.0),
                    "Axis1": (0.0, 1.0, 0.0), "Axis2": (0.0, 0.0, 1.0), "ComputeNormals": False,
                    "ComputeDisplacement": False, "ComputeFolds": True, "GenerateOverlay": True, "OutputPointsPrecision": 1,
                    "FileName": "list.json", "FormulaX": "u", "FormulaY": "v*k", "FormulaZ": "frame",
                    "FormulaDefinitions": "k=2", "Frame": 2.5}.items():
    other = anamorph.vtkAnamorphDeform()
    default = getattr(other, "Get" + name)()
    assert default != value, name
    getattr(other, "Set" + name)(value)
    assert getattr(other, "Get" + name)() == value, name
    time = other.GetMTime()
    getattr(other, "Set" + name)(value)
    assert other.GetMTime() == time, name

for name, value in {"Inverse": True, "Interpolation": 2, "Background": -1.5, "FileName": "list.json", "Origin": (1.0, 2.0, 3.0),
                    "Axis1": (0.0, 1.0, 0.0), "Axis2": (0.0, 0.0, 1.0)}.items():
    image = anamorph.vtkAnamorphDeformImage()
    assert getattr(image, "Get" + name)() != value, name
    getattr(image, "Set" + name)(value)
    assert getattr(image, "Get" + name)() == value, name
    time = image.GetMTime()
    getattr(image, "Set" + name)(value)
    assert image.GetMTime() == time, name

# Frames, images and names of the list.
framed = anamorph.vtkAnamorphDeform()
framed.AddDeformation(0, 0, 1, 1, 0, 0, 1)
framed.SetDepth(0, 0, 1)
framed.SetOrientation(0, 1, 2, 3, 4)
framed.SetMirror(0, anamorph.vtkAnamorphDeformationList.MIRROR_V, 0.25)
framed.SetDeformationName(0, "brow")
assert framed.GetOrientation(0) == (1, 2, 3, 4) and framed.GetMirror(0) == (2, 0.25)
assert framed.GetDeformationName(0) == "brow" and framed.GetDeformationList().GetName(0) == "brow"

# The list.
assert deform.AddDeformation(0.25, 0, 0.3, 0.4, 0, 0, 1) == 0
deform.InsertDeformation(0, -0.5, 0.5, 0.2, 0.2, 0.1, 0, -0.5, anamorph.vtkAnamorphDeformationList.WENDLAND_C2, 0)
assert deform.GetNumberOfDeformations() == 2
assert deform.GetDeformation(0) == (-0.5, 0.5, 0.2, 0.2, 0.1, 0, -0.5, 1, 0)
assert not deform.GetDeformationEnabled(0)
deform.MoveDeformation(0, 1)
deform.Update()
top = max(z for _, _, z in points_of(deform.GetOutput()))
expected = max(math.exp(-((x - 0.25) / 0.3) ** 2 - (y / 0.4) ** 2) for x, y, _ in points_of(plane.GetOutput()))
assert abs(top - expected) <= deform.GetErrorBound(), (top, expected)
field = deform.GetOutput().GetFieldData().GetArray("anamorph:error_bound")
assert field.GetValue(0) == deform.GetErrorBound() > 0
once = points_of(deform.GetOutput())
deform.SetDeformationEnabled(1, True)
deform.Update()
assert points_of(deform.GetOutput()) != once
deform.RemoveDeformation(1)
deform.Update()
assert points_of(deform.GetOutput()) == once

# Files and tables: the same surface.
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "list.json")
    assert deform.GetDeformationList().WriteFile(path) == 1
    with open(path) as file:
        assert json.load(file)["deformations"][0]["extent"] == [0.3, 0.4]
    from_file = anamorph.vtkAnamorphDeform()
    from_file.SetInputConnection(plane.GetOutputPort())
    from_file.SetFileName(path)
    from_file.Update()
    assert points_of(from_file.GetOutput()) == once

table = vtkTable()
deform.GetDeformationList().WriteTable(table)
from_table = anamorph.vtkAnamorphDeform()
from_table.SetInputConnection(plane.GetOutputPort())
from_table.SetInputData(1, table)
from_table.Update()
assert points_of(from_table.GetOutput()) == once

# A table that varies in time, where the mesh does not.
def table_at(time):
    bump, made = anamorph.vtkAnamorphDeformationList(), vtkTable()
    bump.AddDeformation(0, 0, 0.3, 0.4, 0, 0, 1 + time)
    bump.WriteTable(made)
    return made


tables = Source(table_at, (0.0, 1.0, 2.0))
from_table = anamorph.vtkAnamorphDeform()
from_table.SetInputConnection(plane.GetOutputPort())
from_table.SetInputConnection(1, tables.GetOutputPort())
assert steps_of(from_table) == [0, 1, 2]
for time in (0.0, 2.0, 1.0):
    from_table.UpdateTimeStep(time)
    assert time_of(from_table.GetOutput()) == time
    assert abs(from_table.GetOutput().GetBounds()[5] - (1 + time)) < 1e-3, (time, from_table.GetOutput().GetBounds())
assert [asked[0] for asked in tables.asked] == [0, 2, 1]

# A collection.
collection = vtkPartitionedDataSetCollection()
collection.SetPartition(0, 0, plane.GetOutput())
collection.SetPartition(1, 1, plane.GetOutput())
deform.SetInputDataObject(collection)
deform.GenerateOverlayOn()
deform.Update()
assert points_of(deform.GetOutput().GetPartition(1, 1)) == once
assert deform.GetOverlay().GetNumberOfCells() == 3

# Formulas, and points where they have no value.
waves = anamorph.vtkAnamorphDeform()
waves.SetInputConnection(plane.GetOutputPort())
waves.SetFormulaZ("a*sin(6*u+frame)+sqrt(v)")
waves.SetFormulaDefinitions("a=0.1")
for frame in (0, 1.5):
    waves.SetFrame(frame)
    waves.Update()
    for (x, y, _), (_, _, z) in zip(points_of(plane.GetOutput()), points_of(waves.GetOutput())):
        expected = 0.1 * math.sin(6 * x + frame) + math.sqrt(y) if y > 0 else 0
        assert abs(z - expected) <= waves.GetErrorBound() + 1e-15, (x, y, z)
assert waves.GetNumberOfUndefinedPoints() == 21 * 11
assert waves.GetOutput().GetFieldData().GetArray("anamorph:undefined_points").GetValue(0) == 21 * 11

# The transform, forth and back.
transform = anamorph.vtkAnamorphDeformTransform()
transform.SetDeformationList(deform.GetDeformationList())
assert transform.GetFold() == transform.NO_FOLD
there = vtkTransformFilter()
there.SetInputConnection(plane.GetOutputPort())
there.SetOutputPointsPrecision(1)
there.SetTransform(transform)
back = vtkTransformFilter()
back.SetInputConnection(there.GetOutputPort())
back.SetOutputPointsPrecision(1)
back.SetTransform(transform.GetInverse())
back.Update()
for a, b in zip(points_of(there.GetOutput()), once):
    assert max(abs(x - y) for x, y in zip(a, b)) < 1e-6
for a, b in zip(points_of(back.GetOutput()), points_of(plane.GetOutput())):
    assert max(abs(x - y) for x, y in zip(a, b)) < 1e-12

# Errors reach Python as events.
errors = []
deform.AddObserver("ErrorEvent", lambda caller, event: errors.append(event))
deform.GetExecutive().AddObserver("ErrorEvent", lambda caller, event: errors.append(event))
deform.SetDeformation(0, 0, 0, -1, 1, 0, 0, 1)
deform.Update()
assert errors

# A point of the deformed surface is told by where it is in the list's (u, v): on top of a bump, on its underside, between points, in texture coordinates.
from vtkmodules.vtkFiltersSources import vtkSphereSource  # noqa: E402

ball = vtkSphereSource()
ball.SetRadius(1)
ball.SetThetaResolution(48)
ball.SetPhiResolution(49)
ball.SetOutputPointsPrecision(1)
picked = anamorph.vtkAnamorphDeform()
assert picked.GetPickedParameters() == (0, 0, 0, 0)
picked.SetInputConnection(ball.GetOutputPort())
picked.AutomaticPlaneOff()
picked.AddDeformation(0.2, 0.1, 0.5, 0.6, 0.3, 0, 0.7)
picked.Update()
flat, bent = ball.GetOutput(), picked.GetOutput()
time = picked.GetMTime()
for cell in range(0, flat.GetNumberOfCells(), 97):
    ids = [flat.GetCell(cell).GetPointId(i) for i in range(3)]
    for shares in ((1, 0, 0), (0.2, 0.3, 0.5), (0.5, 0.5, 0)):
        at, was = ([sum(s * mesh.GetPoint(i)[c] for s, i in zip(shares, ids)) for c in range(3)] for mesh in (bent, flat))
        picked.PickAt(*at)
        assert picked.GetPickedPoint() == tuple(at)
        u, v, w, found = picked.GetPickedParameters()
        assert found == 1 and max(abs(a - b) for a, b in zip((u, v, w), was)) < 1e-9, (at, was, (u, v, w))
assert picked.GetMTime() == time
# The first of what a line meets: the top from above, the other side from below; nothing beside the ball.
for x, y, up in ((0.1, 0.2, 1), (0.1, 0.2, -1), (0, -0.9, 1)):
    picked.PickOnLine(0, 0, 9 * up, 2 * x, 2 * y, -9 * up)
    found, at = picked.GetPickedParameters(), picked.GetPickedPoint()
    assert abs(at[0] - x * (9 - at[2] * up) / 9) < 1e-9 and at[2] * up > 0 and found[3] == 1, (at, found)
    assert found[2] * up > 0 and abs(math.hypot(*found[:3]) - 1) < 0.01, found
picked.PickOnLine(3, 0, 9, 3, 0, -9)
assert picked.GetPickedParameters() == (0, 0, 0, 0)
picked.SetInputConnection(plane.GetOutputPort())
picked.SetParameterModeToTextureCoordinates()
picked.RemoveAllDeformations()
picked.AddDeformation(0.5, 0.5, 0.2, 0.2, 0, 0, 0.5)
picked.Update()
picked.PickAt(*picked.GetOutput().GetPoint(10 * 21 + 12))
assert max(abs(a - b) for a, b in zip(picked.GetPickedParameters(), (0.6, 0.5, 0, 1))) < 1e-6
