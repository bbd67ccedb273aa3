# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphNonlinearTexture against slopes fitted and cubics written out in numpy: on a ball, by time, and in pieces.
import anamorph
import numpy as np
from conformance import Source, steps_of, time_of
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkFiltersSources import vtkSphereSource

seed = 41
print("seed", seed)
random = np.random.default_rng(seed)


def ball(resolution=10, bend=1.0):
    """A ball in triangles, whose texture coordinates are no linear function of space; cells have a number."""
    source = vtkSphereSource()
    source.SetThetaResolution(resolution)
    source.SetPhiResolution(resolution)
    source.SetOutputPointsPrecision(1)
    source.Update()
    mesh = vtkPolyData()
    mesh.ShallowCopy(source.GetOutput())
    p = vtk_to_numpy(mesh.GetPoints().GetData())
    st = np.stack([0.5 + 0.4 * p[:, 0] + 0.2 * bend * p[:, 1] * p[:, 2], 0.5 + bend * np.sin(2 * p[:, 1]) / 4], axis=1)
    array = numpy_to_vtk(st, deep=True)
    array.SetName("st")
    mesh.GetPointData().SetTCoords(array)
    numbers = numpy_to_vtk(np.arange(mesh.GetNumberOfCells()), deep=True)
    numbers.SetName("cell")
    mesh.GetCellData().AddArray(numbers)
    return mesh


def triangles_of(mesh):
    return vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).reshape(-1, 3)


def slopes_of(points, st, triangles):
    """Gradients of both coordinates, by least squares weighted by 1 / distance, across the sum of the normals."""
    slopes = np.zeros((len(points), 2, 3))
    for i, p in enumerate(points):
        about = triangles[(triangles == i).any(axis=1)]
        normal = sum(np.cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]) for t in about)
        normal /= np.linalg.norm(normal)
        others = np.setdiff1d(about, [i])
        along = points[others] - p
        along_plane = along - np.outer(along @ normal, normal)
        weight = 1 / np.linalg.norm(along, axis=1)[:, None]
        slopes[i] = np.linalg.lstsq(along_plane * weight, (st[others] - st[i]) * weight, rcond=1e-9)[0].T
    return slopes


def cubic(w, corners, points, st, slopes):
    """The cubic on a triangle at weights w: powers of the weights times Bernstein's points."""
    value = sum(st[c] * w[i] ** 3 for i, c in enumerate(corners))
    sides = 0
    for i, c in enumerate(corners):
        for j, d in enumerate(corners):
            if i != j:
                b = st[c] + slopes[c] @ (points[d] - points[c]) / 3
                sides, value = sides + b, value + 3 * w[i] ** 2 * w[j] * b
    return value + 6 * w[0] * w[1] * w[2] * (sides / 4 - sum(st[c] for c in corners) / 6)


mesh = ball()
texture = anamorph.vtkAnamorphNonlinearTexture()
for name, value in [("TextureWidth", 700), ("TextureHeight", 400), ("Tolerance", 0.25)]:
    getattr(texture, "Set" + name)(value)
    assert getattr(texture, "Get" + name)() == value, name
texture.SetInputData(mesh)
texture.Update()
out = texture.GetOutput()
points, st = vtk_to_numpy(mesh.GetPoints().GetData()), vtk_to_numpy(mesh.GetPointData().GetTCoords())
slopes = slopes_of(points, st, triangles_of(mesh))
bound = out.GetFieldData().GetArray("anamorph:max_error").GetValue(0)
places, shown = vtk_to_numpy(out.GetPoints().GetData()), vtk_to_numpy(out.GetPointData().GetTCoords())
assert (shown[:len(st)] == st).all() and (places[:len(st)] == points).all()
worst = 0
for part, cell in zip(triangles_of(out), vtk_to_numpy(out.GetCellData().GetArray("cell"))):
    corners = triangles_of(mesh)[cell]
    share = random.dirichlet([1, 1, 1])
    place, linear = share @ places[part], share @ shown[part]
    w = np.linalg.lstsq(np.vstack([points[corners].T, np.ones(3)]), np.append(place, 1), rcond=None)[0]
    off = (linear - cubic(w, corners, points, st, slopes)) * [700, 400]
    worst = max(worst, np.hypot(*off))
print("triangles", out.GetNumberOfCells(), "worst", worst, "bound", bound)
assert 0.1 < worst <= bound <= 0.25, (worst, bound)

# Over time.
moving = Source(lambda time: ball(8, 1 + time), (0.0, 1.0, 2.0))
texture = anamorph.vtkAnamorphNonlinearTexture()
texture.SetInputConnection(moving.GetOutputPort())
assert steps_of(texture) == [0, 1, 2]
counts = []
for time in (0.0, 2.0, 1.0):
    texture.UpdateTimeStep(time)
    assert time_of(texture.GetOutput()) == time
    counts.append(texture.GetOutput().GetNumberOfCells())
assert counts[0] < counts[2] < counts[1] and [asked[0] for asked in moving.asked] == [0, 2, 1], counts


class Quarters(Source):
    """Each piece has its quarter of the ball's triangles, and all others as ghosts."""

    def RequestData(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        piece, pieces = info.Get(Pipeline.UPDATE_PIECE_NUMBER()), info.Get(Pipeline.UPDATE_NUMBER_OF_PIECES())
        self.levels = info.Get(Pipeline.UPDATE_NUMBER_OF_GHOST_LEVELS())
        super().RequestData(request, inputs, outputs)
        output = outputs.GetInformationObject(0).Get(vtkPolyData.DATA_OBJECT())
        ghosts = np.where(np.arange(output.GetNumberOfCells()) % pieces == piece, 0, 1).astype(np.uint8)
        array = numpy_to_vtk(ghosts, deep=True)
        array.SetName("vtkGhostType")
        output.GetCellData().AddArray(array)
        return 1

    def RequestInformation(self, request, inputs, outputs):
        outputs.GetInformationObject(0).Set(self.CAN_HANDLE_PIECE_REQUEST(), 1)
        return super().RequestInformation(request, inputs, outputs)


def corners_of(data):
    places, shown = vtk_to_numpy(data.GetPoints().GetData()), vtk_to_numpy(data.GetPointData().GetTCoords())
    return sorted(tuple(np.hstack([places[t], shown[t]]).ravel()) for t in triangles_of(data))


texture = anamorph.vtkAnamorphNonlinearTexture()
texture.SetInputData(mesh)
texture.Update()
whole = corners_of(texture.GetOutput())
source = Quarters(lambda time: ball())
texture = anamorph.vtkAnamorphNonlinearTexture()
texture.SetInputConnection(source.GetOutputPort())
found = []
for piece in range(4):
    texture.UpdatePiece(piece, 4, 0)
    assert source.levels == 1
    found += corners_of(texture.GetOutput())
assert sorted(found) == whole, (len(found), len(whole))
