#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""vtkAnamorphPanoramaProjection, vtkAnamorphProjectionBake and vtkAnamorphInbetween with their defaults on scenes of many triangles.

Scenes: a ball of 4 STEPS (STEPS - 1) triangles about the projector (inside) or before it (outside), and a room of 12 triangles with 9 blocks
and a ball in it (room). Each is cut with occlusion and without, and the ball outside and the room are baked to a texture of SIZE x SIZE. A blend
is of ten surfaces of SIDE x SIDE points that share nothing, the first time and with other weights, beside NumPy's sum of the same
arrays. Times are the least of all rounds, of the processor, on one thread unless --threads says more.

Needs plain VTK (not ParaView's, which is built for debugging) and the module anamorph. Fails if the blend is not the sum, and if a scene is
not painted whole where nothing hides it."""
import argparse
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints, vtkSMPTools
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkFiltersCore import vtkAppendPolyData, vtkTriangleFilter
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkPlaneSource, vtkSphereSource

from anamorph import vtkAnamorphInbetween, vtkAnamorphPanoramaProjection, vtkAnamorphProjectionBake

WEIGHTS = [.3, .2, -.1, .4, .1, .05, .05, .2, -.3, .1]


def ball(steps, radius, *centre):
    source = vtkSphereSource()
    source.SetThetaResolution(2 * steps)
    source.SetPhiResolution(steps + 1)
    source.SetRadius(radius)
    source.SetCenter(*centre)
    source.Update()
    return source.GetOutput()


def room():
    random, parts, filter_ = np.random.default_rng(3), vtkAppendPolyData(), vtkTriangleFilter()

    def block(centre, lengths):
        cube = vtkCubeSource()
        cube.SetCenter(*centre)
        cube.SetXLength(lengths[0])
        cube.SetYLength(lengths[1])
        cube.SetZLength(lengths[2])
        cube.Update()
        parts.AddInputData(cube.GetOutput())
    block((0, 0, 0), (8, 3, 6))
    for k in range(9):
        angle = 2 * np.pi * (k + .3) / 9
        block((2.6 * np.cos(angle), -.8, 2 * np.sin(angle)), random.uniform((.3, .5, .3), (.7, 1.4, .7)))
    parts.AddInputData(ball(10, .4, 1.2, .3, -1.5))
    filter_.SetInputConnection(parts.GetOutputPort())
    filter_.Update()
    return filter_.GetOutput()


def apart(mesh):
    """Its triangles with a place for each in a texture."""
    corners = vtk_to_numpy(mesh.GetPoints().GetData())[vtk_to_numpy(mesh.GetPolys().GetConnectivityArray())]
    count, points, cells, result = len(corners) // 3, vtkPoints(), vtkCellArray(), vtkPolyData()
    points.SetData(numpy_to_vtk(corners, deep=True))
    cells.SetData(3, numpy_to_vtk(np.arange(3 * count), deep=True, array_type=cells.GetConnectivityArray().GetDataType()))
    across, k = int(np.ceil(np.sqrt(count))), np.arange(count)
    within = np.array([[.05, .05], [.95, .05], [.05, .95]])
    places = (np.stack([k % across, k // across], 1)[:, None] + within) / across
    array = numpy_to_vtk(places.reshape(-1, 2).astype(np.float32), deep=True)
    array.SetName("places")
    result.SetPoints(points)
    result.SetPolys(cells)
    result.GetPointData().SetTCoords(array)
    return result


def noise(width, height):
    image = vtkImageData()
    image.SetDimensions(width, height, 1)
    image.GetPointData().SetScalars(
        numpy_to_vtk(np.random.default_rng(1).integers(0, 256, (width * height, 3)).astype(np.uint8), deep=True))
    return image


def least(rounds, run):
    times = []
    for _ in range(rounds):
        begin = time.process_time()
        result = run()
        times.append(time.process_time() - begin)
    return min(times), result


def updated(filter_):
    filter_.Update()
    return filter_


def projection(mesh, occlusion, tolerance):
    filter_ = vtkAnamorphPanoramaProjection()
    filter_.SetInputData(mesh)
    filter_.SetTolerance(tolerance)
    filter_.SetOcclusion(occlusion)
    return updated(filter_)


def bake(mesh, image, size, occlusion):
    filter_ = vtkAnamorphProjectionBake()
    filter_.SetInputData(0, mesh)
    filter_.SetInputData(1, image)
    filter_.AddProjector(.1, .2, .05, 0, 0, -1, 0, 1, 0)
    filter_.SetWidth(size)
    filter_.SetHeight(size)
    filter_.SetOcclusion(occlusion)
    return updated(filter_)


def shapes_of(side):
    plane, random = vtkPlaneSource(), np.random.default_rng(0)
    plane.SetResolution(side - 1, side - 1)
    plane.Update()
    shapes, arrays = [], []
    for _ in WEIGHTS:
        shape, points = vtkPolyData(), vtkPoints()
        shape.DeepCopy(plane.GetOutput())
        shape.GetPointData().Initialize()
        arrays.append(random.random((side * side, 3), dtype=np.float32))
        points.SetData(numpy_to_vtk(arrays[-1], deep=True))
        shape.SetPoints(points)
        shapes.append(shape)
    return shapes, arrays


def blend(shapes):
    filter_ = vtkAnamorphInbetween()
    for k, (shape, weight) in enumerate(zip(shapes, WEIGHTS)):
        filter_.AddInputData(shape)
        filter_.SetWeight(k, weight)
    return updated(filter_)


def reweighed(filter_):
    filter_.SetWeight(0, filter_.GetWeight(1))
    filter_.SetWeight(1, .5 - filter_.GetWeight(0))
    return updated(filter_)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--steps", type=int, default=158)
    parser.add_argument("--tolerance", type=float, default=.125)
    parser.add_argument("--size", type=int, default=2048)
    parser.add_argument("--side", type=int, default=1000)
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--threads", type=int, default=1)
    parser.add_argument("--case", help="inside, outside, room, bake_outside, bake_room or blend; all of them if missing")
    arguments = parser.parse_args()
    vtkSMPTools.Initialize(arguments.threads)
    failed = False

    def wants(case):
        return arguments.case in (None, case)

    def report(case, seconds, words):
        print(f"{case:24} {1000 * seconds:9.1f} ms  {words}", flush=True)

    scenes = {"inside": lambda: ball(arguments.steps, 3, .3, .2, -.4), "outside": lambda: ball(arguments.steps, 1, .3, .2, -3), "room": room}
    for case, make in scenes.items():
        for occlusion in (True, False):
            name = case if occlusion else case + ", none hides"
            if wants(case):
                seconds, filter_ = least(arguments.rounds, lambda: projection(make(), occlusion, arguments.tolerance))
                painted, rest = (filter_.GetOutputDataObject(port).GetNumberOfCells() for port in (0, 1))
                failed = failed or painted == 0 or (not occlusion and rest > 0)
                report(name, seconds, f"{make().GetNumberOfCells()} triangles, {painted} painted, {rest} not")
            if case != "inside" and wants("bake_" + case):
                mesh, image = apart(make()), noise(1024, 512)
                seconds, filter_ = least(arguments.rounds, lambda: bake(mesh, image, arguments.size, occlusion))
                texels = int(filter_.GetOutputDataObject(0).GetFieldData().GetArray("anamorph:painted").GetValue(0))
                failed = failed or texels == 0
                report("bake_" + name, seconds, f"{texels} texels of {arguments.size}^2")
    if wants("blend"):
        shapes, arrays = shapes_of(arguments.side)
        plain, truth = least(arguments.rounds, lambda: sum(np.float32(w) * a for w, a in zip(WEIGHTS, arrays)))
        first, filter_ = least(arguments.rounds, lambda: blend(shapes))
        failed = failed or np.abs(vtk_to_numpy(filter_.GetOutputDataObject(0).GetPoints().GetData()) - truth).max() > 2.0 ** -20
        again, _ = least(arguments.rounds, lambda: reweighed(filter_))
        report("NumPy's sum", plain, f"{len(WEIGHTS)} shapes of {arguments.side}^2 points")
        report("blend", first, f"{first / plain:.2f} of it")
        report("blend, other weights", again, f"{again / plain:.2f} of it")
    if failed:
        sys.exit("something is not as it should be")


main()
