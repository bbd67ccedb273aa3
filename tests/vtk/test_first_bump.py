# SPDX-License-Identifier: Apache-2.0
# The bump that a list begins with (AddDefaultDeformation), and surfaces that are subdivided for it.
import math

import anamorph
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkStringOutputWindow, vtkOutputWindow
from vtkmodules.vtkCommonDataModel import VTK_VERTEX, vtkCellArray, vtkPolyData, vtkUnstructuredGrid
from vtkmodules.vtkFiltersCore import vtkAppendFilter, vtkReverseSense
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkPlaneSource, vtkSphereSource

said = vtkStringOutputWindow()
vtkOutputWindow.SetInstance(said)
EYE = np.ones(3) / math.sqrt(3)


def begun(source):
    """A Deform with its first bump, executed, and the points before and after."""
    deform = anamorph.vtkAnamorphDeform()
    deform.SetInputConnection(source.GetOutputPort())
    deform.Update()
    assert deform.AddDefaultDeformation() == 0
    deform.Update()
    mesh = deform.GetOutputDataObject(0)
    moved = vtk_to_numpy(mesh.GetPointData().GetArray("Displacement")).astype(float)
    return deform, vtk_to_numpy(mesh.GetPoints().GetData()) - moved, moved


def errors_of(algorithm, call):
    """The texts of its errors."""
    texts = []

    def listen(_, __, text):
        texts.append(text)
    listen.CallDataType = "string0"
    for watched in (algorithm, algorithm.GetExecutive()):
        watched.AddObserver("ErrorEvent", listen)
    call()
    return texts


# A ball, of either sense: where the line from the eye meets it, along its normal, and in depth alone there.
ball = vtkSphereSource()
ball.SetRadius(2)
ball.SetCenter(10, 0, -5)
ball.SetThetaResolution(80)
ball.SetPhiResolution(81)
inside_out = vtkReverseSense()
inside_out.ReverseCellsOn()
inside_out.SetInputConnection(ball.GetOutputPort())
for source in (ball, inside_out):
    deform, rest, moved = begun(source)
    assert deform.GetSubdivisions() == 0
    height, peak = np.linalg.norm(moved, axis=1), np.linalg.norm(moved, axis=1).argmax()
    assert np.allclose(rest[peak], np.array([10, 0, -5]) + 2 * EYE, atol=.1), rest[peak]
    V = np.array(deform.GetDeformation(0)[4:7])
    assert np.allclose(V, 4 * math.sqrt(3) / 10 * EYE, atol=.01), V  # a tenth of the diagonal
    # A sixth of the size: there the Gaussian is 1/e.
    away = np.linalg.norm(rest - (np.array([10, 0, -5]) + 2 * EYE), axis=1)
    at = np.abs(away - 4 / 6) < .03
    assert at.sum() > 20 and np.abs(height[at] / height[peak] - math.exp(-1)).max() < .1
    assert height[(rest - [10, 0, -5]) @ EYE < 0].max() < 1e-3 * height[peak]

# What lies flat has it in its middle, and neither depth nor frame.
plane = vtkPlaneSource()
plane.SetOrigin(1, 2, 5)
plane.SetPoint1(4, 2, 5)
plane.SetPoint2(1, 8, 5)
plane.SetResolution(30, 30)
deform, rest, moved = begun(plane)
assert np.allclose(deform.GetDeformation(0), [2.5, 5, .5, 1, 0, 0, math.sqrt(45) / 10, 0, 1], rtol=1e-12, atol=0)
assert tuple(deform.GetDepth(0)) == (0, 0, 0) and tuple(deform.GetOrientation(0)) == (1, 0, 0, 0)
# Upside down it still stands up, where the eye is.
plane.SetPoint1(1, 8, 5)
plane.SetPoint2(4, 2, 5)
assert begun(plane)[2][:, 2].max() > .6

# A box of 24 points is cut: four times, each face into 2 * 4^4 triangles, of the same shape.
box = vtkCubeSource()
deform, rest, moved = begun(box)
assert deform.GetSubdivisions() == 4 and deform.GetOutputDataObject(0).GetNumberOfPolys() == 6 * 2 * 4**4
assert np.allclose(np.abs(rest).max(axis=1), .5) and len(rest) == 6 * 17 * 17
assert {tuple(p) for p in np.round(rest * 16 + 8, 4)} == {(x, y, z) for x in range(17) for y in range(17) for z in range(17)
                                                          if {x, y, z} & {0, 16}}
assert np.allclose(moved[np.abs(rest - .5).max(axis=1) < 1e-6], math.sqrt(3) / 10 * EYE)  # all three corners that are one
normals = vtk_to_numpy(deform.GetOutputDataObject(0).GetPointData().GetNormals())
assert np.allclose(np.linalg.norm(normals, axis=1), 1, atol=1e-6)
# An edit afterwards is of what it reaches, and cuts nothing anew.
cut = deform.GetOutputDataObject(0).GetPolys().GetConnectivityArray()
deform.AddDeformation(-.5, -.5, .05, .05, 0, 0, .1)
deform.Update()
assert 0 < deform.GetNumberOfPointsComputed() < len(rest) / 4
assert deform.GetOutputDataObject(0).GetPolys().GetConnectivityArray() is cut
deform.SetSubdivisions(0)
deform.Update()
assert deform.GetOutputDataObject(0).GetNumberOfPoints() == 24

# Of grids, and what has lines in it, no more points are made: the nearest one is pulled out, and that is said.
assert "the mesh is coarse" not in said.GetOutput(), said.GetOutput()
grid = vtkAppendFilter()
grid.AddInputConnection(box.GetOutputPort())
deform, rest, moved = begun(grid)
assert deform.GetSubdivisions() == 0 and np.allclose(moved[(rest == .5).all(axis=1)], math.sqrt(3) / 10 * EYE)
assert np.linalg.norm(moved[(rest < .4).any(axis=1)], axis=1).max() < .02
assert "the mesh is coarse: it has 1 of its points" in said.GetOutput(), said.GetOutput()

# What cannot be cut is refused in words.
points, cells, lines = vtkPoints(), vtkCellArray(), vtkCellArray()
for p in ([0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1]):
    points.InsertNextPoint(p)
for third in (2, 3, 4):
    cells.InsertNextCell(3, [0, 1, third])
lines.InsertNextCell(2, [0, 1])
for part, words in ((lambda mesh: mesh.SetPolys(cells), "more than two triangles"), (lambda mesh: mesh.SetLines(lines), "polygons alone")):
    mesh, deform = vtkPolyData(), anamorph.vtkAnamorphDeform()
    mesh.SetPoints(points)
    part(mesh)
    deform.SetInputDataObject(mesh)
    deform.SetSubdivisions(2)
    assert any(words in text for text in errors_of(deform, deform.Update)), words
    assert deform.GetOutputDataObject(0).GetNumberOfPoints() == 0

# Nothing to put it on, and points alone.
empty, deform = vtkPolyData(), anamorph.vtkAnamorphDeform()
deform.SetInputDataObject(empty)
deform.Update()
assert any("must have points" in text for text in errors_of(deform, deform.AddDefaultDeformation)) and deform.GetNumberOfDeformations() == 0
cloud = vtkUnstructuredGrid()
cloud.SetPoints(points)
for i in range(5):
    cloud.InsertNextCell(VTK_VERTEX, 1, [i])
deform = anamorph.vtkAnamorphDeform()
deform.SetInputDataObject(cloud)
deform.Update()
assert deform.AddDefaultDeformation() == 0
deform.Update()
moved = vtk_to_numpy(deform.GetOutputDataObject(0).GetPointData().GetArray("Displacement"))
assert np.linalg.norm(moved, axis=1).max() > .2
