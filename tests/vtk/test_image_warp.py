# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphImageWarp against numpy: planes that move an image as a whole, meshes whose vertices are anywhere, bicubic patches written out,
# parts, bumps on the mesh, and what is refused.
import math

import anamorph
import numpy as np
from conformance import Source, errors_of, pixels, steps_of, time_of
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersSources import vtkPlaneSource

seed = 23
print("seed", seed)
random = np.random.default_rng(seed)
WIDTH, HEIGHT, ORIGIN, SPACING = 120, 90, (3.0, -2.0, 5.0), (0.5, 0.25, 1.0)


def value(i, j):
    """At a pixel's index, from the left and from below; smooth, and never 0."""
    return 3 + np.sin(i / 11 + 1) * np.cos(j / 9) + 0.3 * np.sin((i + 2 * j) / 17)


def image(kind=np.float32):
    made = vtkImageData()
    made.SetDimensions(WIDTH, HEIGHT, 1)
    made.SetOrigin(ORIGIN)
    made.SetSpacing(SPACING)
    j, i = np.mgrid[0:HEIGHT, 0:WIDTH]
    array = numpy_to_vtk(value(i, j).astype(kind).ravel(), deep=True)
    array.SetName("height")
    made.GetPointData().SetScalars(array)
    return made


def plane(columns, rows):
    x, y, z = ORIGIN
    source = vtkPlaneSource()
    source.SetOrigin(x, y, z)
    source.SetPoint1(x + (WIDTH - 1) * SPACING[0], y, z)
    source.SetPoint2(x, y + (HEIGHT - 1) * SPACING[1], z)
    source.SetResolution(columns, rows)
    source.SetOutputPointsPrecision(1)
    return source


def moved(mesh, move):
    """A copy whose points, in indices of the image, go where move(i, j) says."""
    copy = vtkPolyData()
    copy.DeepCopy(mesh)
    points = vtk_to_numpy(copy.GetPoints().GetData()).copy()
    places = (points[:, :2] - ORIGIN[:2]) / SPACING[:2]
    points[:, :2] = np.stack(move(places[:, 0], places[:, 1]), axis=1) * SPACING[:2] + ORIGIN[:2]
    to = vtkPoints()
    to.SetData(numpy_to_vtk(points, deep=True))
    copy.SetPoints(to)
    return copy


def warp(mesh, picture=None, **properties):
    warped = anamorph.vtkAnamorphImageWarp()
    warped.SetInputDataObject(0, picture or image())
    if isinstance(mesh, vtkPolyData):
        warped.SetInputDataObject(1, mesh)
    else:
        warped.SetMeshConnection(mesh.GetOutputPort())
    warped.SetInterpolation(warped.CUBIC)
    for name, argument in properties.items():
        getattr(warped, "Set" + name)(argument)
    return warped


def drawn(warped):
    warped.Update()
    return pixels(warped.GetOutput())[:, :, 0]


def compare(picture, i, j, most=2e-3):
    """With what comes from (i, j), where that is well inside the image."""
    inside = (i > 2) & (i < WIDTH - 3) & (j > 2) & (j < HEIGHT - 3)
    off = np.abs(picture - value(i, j))[inside]
    assert inside.sum() > 2000 and off.max() < most, (inside.sum(), off.max())


def mesh_of(columns, rows):
    source = plane(columns, rows)
    source.Update()
    return source.GetOutput()


J, I = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)

# A plane on the bounds moves nothing, whatever the picture's type.
for kind in (np.float32, np.uint8, np.uint16):
    given = image(kind)
    still = warp(plane(7, 5), given, Interpolation=0)
    assert (drawn(still) == pixels(given)[:, :, 0]).all()
    out = still.GetOutput()
    assert out.GetOrigin() == ORIGIN and out.GetSpacing() == SPACING and out.GetExtent() == given.GetExtent()
    assert out.GetPointData().GetScalars().GetName() == "height"

# Turned, scaled and shifted: pushed it goes there, pulled it comes from there.
turn, scale = math.radians(20), 1.2
matrix = scale * np.array([[math.cos(turn), -math.sin(turn)], [math.sin(turn), math.cos(turn)]])
middle, shift = np.array([60.0, 45.0]), np.array([4.5, -3.25])


def affine(i, j):
    p = np.stack([i, j], -1) - middle
    return tuple(np.moveaxis(p @ matrix.T + middle + shift, -1, 0))


turned = moved(mesh_of(6, 4), affine)
back = (np.stack([I, J], -1) - shift - middle) @ np.linalg.inv(matrix).T + middle
pushed = warp(turned)
compare(drawn(pushed), back[..., 0], back[..., 1])
assert 0 <= pushed.GetMaxError() <= 0.01
fields = pushed.GetOutput().GetFieldData()
assert fields.GetArray("anamorph:max_error").GetValue(0) == pushed.GetMaxError()
assert fields.GetArray("anamorph:folded_fraction").GetValue(0) == 0
compare(drawn(warp(turned, Direction=1)), *affine(I, J))
half = ((I, J) + np.array(affine(I, J))) / 2
compare(drawn(warp(turned, Direction=1, Amount=0.5)), *half)

# A mesh with vertices anywhere, in any order: bicubic patches with slopes of Catmull and Rom, away from its border.
columns, rows = 8, 6
mesh = mesh_of(columns, rows)
order = random.permutation(mesh.GetNumberOfPoints())
jumbled, points, coordinates = vtkPolyData(), vtkPoints(), vtk_to_numpy(mesh.GetPointData().GetTCoords())[order]
points.SetDataTypeToDouble()
for k in order:
    points.InsertNextPoint(mesh.GetPoint(k))
jumbled.SetPoints(points)
jumbled.GetPointData().SetTCoords(numpy_to_vtk(np.ascontiguousarray(coordinates), deep=True))
offsets = random.uniform(-4, 4, (2, rows + 1, columns + 1))


def jolt(i, j):
    column, row = np.rint(i / (WIDTH - 1) * columns).astype(int), np.rint(j / (HEIGHT - 1) * rows).astype(int)
    return i + offsets[0, row, column], j + offsets[1, row, column]


def weights(t):
    return np.stack([(-t + 2 * t**2 - t**3) / 2, (2 - 5 * t**2 + 3 * t**3) / 2, (t + 4 * t**2 - 3 * t**3) / 2, (-t**2 + t**3) / 2], -1)


x, y = I / (WIDTH - 1) * columns, J / (HEIGHT - 1) * rows
column, row = np.clip(np.floor(x).astype(int), 0, columns - 1), np.clip(np.floor(y).astype(int), 0, rows - 1)
inner = (column > 0) & (column < columns - 1) & (row > 0) & (row < rows - 1)
wx, wy, source = weights(x - column), weights(y - row), np.zeros((2, HEIGHT, WIDTH))
for a in range(4):
    for b in range(4):
        c, r = np.clip(column + b - 1, 0, columns), np.clip(row + a - 1, 0, rows)
        vertex = np.array([c * (WIDTH - 1) / columns, r * (HEIGHT - 1) / rows]) + offsets[:, r, c]
        source += wy[..., a] * wx[..., b] * vertex
jolted = moved(jumbled, jolt)
pulled = warp(jolted, Direction=1)
off = np.abs(drawn(pulled) - value(*source))[inner]
assert inner.sum() > 4000 and off.max() < 4e-3, off.max()
assert pulled.GetMaxError() <= 0.01
# Pushed through the same, it comes back: there is what was here.
there = warp(jolted, Tolerance=0.0)
places = [np.clip(np.rint(s), 0, n - 1).astype(int) for s, n in zip(source, (WIDTH, HEIGHT))]
off = np.abs(drawn(there)[places[1], places[0]] - value(I, J))[inner]
assert off.max() < 0.2 and np.median(off) < 0.05, (off.max(), np.median(off))

# Any part is the same.
whole = drawn(pulled)
for extent in ([10, 30, 5, 60, 0, 0], [0, 119, 44, 44, 0, 0], [119, 119, 89, 89, 0, 0]):
    part = warp(jolted, Direction=1)
    part.UpdateExtent(extent)
    assert part.GetOutput().GetExtent() == tuple(extent)
    x0, x1, y0, y1, _, _ = extent
    assert (pixels(part.GetOutput())[:, :, 0] == whole[y0:y1 + 1, x0:x1 + 1]).all()

# A bump of Deform drags the picture: its centre is seen where the bump takes it.
deform = anamorph.vtkAnamorphDeform()
bent = plane(24, 18)
deform.SetInputConnection(bent.GetOutputPort())
deform.SetAutomaticPlane(False)
deform.SetOrigin(ORIGIN)
deform.SetAxis1((WIDTH - 1) * SPACING[0], 0, 0)
deform.SetAxis2(0, (HEIGHT - 1) * SPACING[1], 0)
deform.AddDeformation(0.5, 0.5, 0.15, 0.2, 6 * SPACING[0], -4 * SPACING[1], 0)
dragged = warp(deform)
picture = drawn(dragged)
centre = np.array([(WIDTH - 1) / 2, (HEIGHT - 1) / 2])
at = centre + (6, -4)
assert abs(picture[41, 65] + picture[41, 66] + picture[40, 65] + picture[40, 66] - 4 * value(*centre)) < 0.05, (at, picture[40:42, 65:67], value(*centre))
deform.SetDeformation(0, 0.5, 0.5, 0.15, 0.2, 0, 0, 0)
assert np.abs(drawn(dragged) - value(I, J)).max() < 1e-5, "and back"

# A mesh that moves over time, while the image does not.
over_time = Source(lambda time: moved(mesh, lambda i, j: (i + 5 * time, j)), [0, 1, 2])
timed = warp(mesh)
timed.SetMeshConnection(over_time.GetOutputPort())
assert steps_of(timed) == [0, 1, 2], steps_of(timed)
for time in (2, 0, 1):
    timed.UpdateTimeStep(time)
    assert time_of(timed.GetOutput()) == time
    compare(pixels(timed.GetOutput())[:, :, 0], I - 5 * time, J)


# Components keep their names.
named = image()
pair = numpy_to_vtk(np.zeros((named.GetNumberOfPoints(), 2), np.float32), deep=True)
pair.SetComponentName(1, "opacity")
named.GetPointData().SetScalars(pair)
made = warp(mesh, named)
made.Update()
assert [made.GetOutput().GetPointData().GetScalars().GetComponentName(c) for c in (0, 1)] == [None, "opacity"]


# What is refused, in words.
def said(warped):
    return errors_of(warped, warped.Update)


bare = vtkPolyData()
bare.SetPoints(mesh.GetPoints())
assert "has no texture coordinates" in said(warp(bare))
short = vtkPolyData()
short.DeepCopy(mesh)
short.GetPointData().SetTCoords(numpy_to_vtk(np.zeros((3, 2), np.float32), deep=True))
assert f"the mesh has 3 texture coordinates: must have one for each of its {mesh.GetNumberOfPoints()} points" in said(warp(short))
few = vtkPolyData()
few.DeepCopy(mesh)
vtk_to_numpy(few.GetPointData().GetTCoords())[3] = (0.123, 0.456)
assert "must be a grid" in said(warp(few))
doubled = vtkPolyData()
doubled.DeepCopy(mesh)
vtk_to_numpy(doubled.GetPointData().GetTCoords())[5] = vtk_to_numpy(doubled.GetPointData().GetTCoords())[4]
assert "must be a grid" in said(warp(doubled))
nowhere = moved(mesh, lambda i, j: (np.where(i == 0, np.nan, i), j))
assert "must be finite" in said(warp(nowhere))
assert "): Tolerance=nan: must be" in said(warp(mesh, Tolerance=math.nan))
assert warp(mesh, Tolerance=-1.0).GetTolerance() == 0
assert "): Amount=nan: must be" in said(warp(mesh, Amount=math.nan))
a_row = vtkImageData()
a_row.SetDimensions(1, 9, 1)
a_row.GetPointData().SetScalars(numpy_to_vtk(np.zeros(9, np.float32), deep=True))
assert "the image has 1 x 9 pixels: must be at least 2 x 2" in said(warp(mesh, a_row))
alone = anamorph.vtkAnamorphImageWarp()
assert "the image is not given" in said(alone)
alone.SetInputDataObject(0, image())
assert "the mesh is not given" in said(alone)
print("image warp: as it should be")
