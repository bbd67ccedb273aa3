# SPDX-License-Identifier: Apache-2.0
# Run by mpiexec: every rank deforms a part of a surface, throws a panorama onto it or bakes one, and has the bits that the whole has.
# Argument: how many ranks there have to be.
import math
import os
import sys
import traceback

import anamorph
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkIdList, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkMultiBlockDataSet, vtkPolyData, vtkTable
from vtkmodules.vtkFiltersSources import vtkPlaneSource, vtkSphereSource
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkParallelCore import vtkMultiProcessController

BUMPS = [(0.1 * k - 0.5, 0.3 - 0.05 * k, 0.2, 0.3, 0.05 * k, 0.1, 0.2, k % 2) for k in range(10)]


def part_of(mesh, begin, end):
    """Some cells of a mesh, and their points with normals."""
    points, normals, cells, places = vtkPoints(), vtkDoubleArray(), vtkCellArray(), {}
    points.SetDataTypeToDouble()
    normals.SetNumberOfComponents(3)
    normals.SetName("Normals")
    for cell in range(begin, end):
        ids = vtkIdList()
        mesh.GetCellPoints(cell, ids)
        for k in range(ids.GetNumberOfIds()):
            point = ids.GetId(k)
            if point not in places:
                places[point] = points.InsertNextPoint(mesh.GetPoint(point))
                normals.InsertNextTuple(mesh.GetPointData().GetNormals().GetTuple(point))
            ids.SetId(k, places[point])
        cells.InsertNextCell(ids)
    part = vtkPolyData()
    part.SetPoints(points)
    part.SetPolys(cells)
    part.GetPointData().SetNormals(normals)
    return part


def deformed(mesh, with_controller, has_table, formula=""):
    deform = anamorph.vtkAnamorphDeform()
    deform.SetInputData(mesh)
    deform.SetFormulaX(formula)
    if not with_controller:
        deform.SetController(None)
    table = vtkTable()
    if has_table:
        bumps = anamorph.vtkAnamorphDeformationList()
        for bump in BUMPS:
            bumps.AddDeformation(*bump)
        bumps.WriteTable(table)
    deform.SetInputData(1, table)
    deform.Update()
    after = deform.GetOutput()
    normals = after.GetPointData().GetNormals()
    return {mesh.GetPoint(i): (after.GetPoint(i), normals.GetTuple(i))
            for i in range(after.GetNumberOfPoints())}, deform


def painted(mesh, with_controller):
    """The triangles that are painted by a projector beside a ball, with their texture coordinates."""
    projection = anamorph.vtkAnamorphPanoramaProjection()
    projection.SetInputData(mesh)
    projection.SetPosition(0.1, 0.2, 1.5)
    projection.SetPanoramaWidth(512)
    projection.SetPanoramaHeight(256)
    if not with_controller:
        projection.SetController(None)
    projection.Update()
    after, rest = projection.GetOutputDataObject(0), projection.GetOutputDataObject(1)
    texels = after.GetPointData().GetTCoords()
    corners = [after.GetPoint(i) + texels.GetTuple(i) for i in range(after.GetNumberOfPoints())]
    ids = vtkIdList()
    triangles = []
    for cell in range(after.GetNumberOfCells()):
        after.GetCellPoints(cell, ids)
        triangles.append(tuple(corners[ids.GetId(k)] for k in range(3)))
    return sorted(triangles), rest.GetNumberOfCells()


def check_painted(mesh, part, controller):
    """What all ranks paint is what one paints: ranks hide from each other what is behind them."""
    (whole, hidden), (here, hidden_here) = painted(mesh, False), painted(part, True)
    assert whole and hidden, (len(whole), hidden)
    assert set(here) <= set(whole), "other triangles than those of the whole"
    sums = vtkDoubleArray(), vtkDoubleArray()
    for value in (len(here), hidden_here):
        sums[0].InsertNextValue(value)
    controller.AllReduce(sums[0], sums[1], 2)  # a sum
    assert [sums[1].GetValue(i) for i in range(2)] == [len(whole), hidden], (len(whole), hidden)


def strips(begin, end, count=6):
    """Some of the strips that a surface is cut into, each with its part of the texture."""
    points, coordinates, cells = vtkPoints(), vtkDoubleArray(), vtkCellArray()
    points.SetDataTypeToDouble()
    coordinates.SetNumberOfComponents(2)
    for strip in range(begin, end):
        ids = vtkIdList()
        for x, y in ((0, 0), (1, 0), (1, 1), (0, 1)):
            ids.InsertNextId(points.InsertNextPoint(strip + x - 3, 2 * y - 1, 0.5 * abs(strip + x - 3) * (strip % 2) - 2))
            coordinates.InsertNextTuple2((strip + x) / count, y)
        cells.InsertNextCell(ids)
    mesh = vtkPolyData()
    mesh.SetPoints(points)
    mesh.SetPolys(cells)
    mesh.GetPointData().SetTCoords(coordinates)
    return mesh


def bake_of(mesh):
    picture, bake = vtkRTAnalyticSource(), anamorph.vtkAnamorphProjectionBake()
    picture.SetWholeExtent(0, 63, 0, 31, 0, 0)
    bake.SetInputData(mesh)
    bake.AddPanoramaConnection(picture.GetOutputPort())
    bake.AddProjector(0.2, 0.1, 0, 0, 0, -1, 0, 1, 0)
    bake.SetWidth(120)
    bake.SetHeight(40)
    return bake


def texture_and_counts(texture):
    fields = [texture.GetFieldData().GetArray(name).GetValue(0) for name in ("anamorph:painted", "anamorph:unseen")]
    return vtk_to_numpy(texture.GetPointData().GetScalars()).tobytes(), fields


def baked(mesh, with_controller, occlusion=True):
    bake = bake_of(mesh)
    bake.SetOcclusion(occlusion)
    if not with_controller:
        bake.SetController(None)
    bake.Update()
    return texture_and_counts(bake.GetOutput())


def check_baked(rank, ranks):
    """Every rank has a part of the mesh, bakes some rows, and has the texture of all of it."""
    whole = baked(strips(0, 6), False)
    assert min(whole[1]) > 100, whole[1]
    assert baked(strips(rank * 6 // ranks, (rank + 1) * 6 // ranks), True) == whole
    assert baked(strips(0, 6 if rank == ranks - 1 else 0), True) == whole


def check_baked_by_pieces(rank, ranks):
    """Asked for a part of the texture each, ranks have that part of the whole, and the whole's counts."""
    whole = bake_of(strips(0, 6))
    whole.SetController(None)
    whole.Update()
    counts = texture_and_counts(whole.GetOutput())[1]
    texels = vtk_to_numpy(whole.GetOutput().GetPointData().GetScalars()).reshape(40, 120, -1)
    edges = [0, 7, *range(40 - ranks + 2, 40), 40][:ranks] + [40]
    for ends in (edges, [0] * ranks + [40]):  # one with all, too, and the others with none
        bake = bake_of(strips(rank * 6 // ranks, (rank + 1) * 6 // ranks))
        bake.UpdateExtent([0, 119, ends[rank], ends[rank + 1] - 1, 0, 0])
        part = bake.GetOutput()
        if ends[rank] == ends[rank + 1]:
            assert part.GetNumberOfPoints() == 0
            continue
        assert part.GetExtent() == (0, 119, ends[rank], ends[rank + 1] - 1, 0, 0), part.GetExtent()
        found = vtk_to_numpy(part.GetPointData().GetScalars()).reshape(-1, 120, texels.shape[2])
        assert np.array_equal(found, texels[ends[rank]:ends[rank + 1]]), rank
        assert texture_and_counts(part)[1] == counts, (texture_and_counts(part)[1], counts)


def check_other_blocks(rank, ranks):
    """What moves or paints blocks, of which every rank has others, waits for nobody, and makes what it makes of them alone."""
    blocks = vtkMultiBlockDataSet()
    blocks.SetNumberOfBlocks(ranks + 1)
    blocks.SetBlock(rank, strips(rank, rank + 1))  # the last is nobody's
    deform, projection = anamorph.vtkAnamorphDeform(), anamorph.vtkAnamorphPanoramaProjection()
    deform.AddDeformation(0, 0, 3, 3, 0, 0, 1)
    projection.SetPosition(0.2, 0.1, 1)
    for algorithm in (deform, projection):
        algorithm.SetInputData(blocks)
        algorithm.Update()
        made = algorithm.GetOutputDataObject(0)
        assert [k for k in range(ranks + 1) if made.GetBlock(k)] == [rank], (rank, algorithm.GetClassName())
        assert made.GetBlock(rank).GetNumberOfPoints() > 0 or algorithm is projection


def check_picks(rank, ranks):
    """What a line first meets, what is nearest to a point, where the selected bump is, and the first one of a list, all find, whoever has that part of a ball."""
    def deformed_ball(controller):
        ball, deform = vtkSphereSource(), anamorph.vtkAnamorphDeform()
        ball.SetRadius(1)
        ball.SetThetaResolution(48)
        ball.SetPhiResolution(49)
        deform.SetInputConnection(ball.GetOutputPort())
        deform.SetController(controller)
        deform.AutomaticPlaneOff()
        for center in ((0.21, 0.33), (-0.43, 0.13), (0.11, -0.37), (-0.3, -0.3)):
            deform.AddDeformation(*center, 0.3, 0.2, 0.1, 0, 0.4)
            deform.SetDepth(deform.GetNumberOfDeformations() - 1, 0, 0, 1)
        return ball, deform  # the first has to stay

    _, deform = deformed_ball(vtkMultiProcessController.GetGlobalController())
    deform.UpdatePiece(rank, ranks, 0)
    _, whole = deformed_ball(None)
    whole.Update()
    met = set()
    for k in range(12):
        x, y = 0.7 * math.cos(k * math.pi / 6 + 0.1), 0.7 * math.sin(k * math.pi / 6 + 0.1)
        for each in (deform, whole):
            each.PickOnLine(x, y, 9, x, y, -9)
        assert math.dist(deform.GetPickedPoint(), whole.GetPickedPoint()) < 1e-6 and whole.GetPickedParameters()[3] == 1
        assert math.dist(deform.GetPickedParameters(), whole.GetPickedParameters()) < 1e-5, k
        met.add(deform.GetPickedPoint())
        for each in (deform, whole):
            each.PickAt(x, y, 0.6)
        assert math.dist(deform.GetPickedParameters(), whole.GetPickedParameters()) < 1e-5, k
    assert len(met) == 12
    deform.PickOnLine(3, 0, 9, 3, 0, -9)
    assert deform.GetPickedParameters() == (0, 0, 0, 0)
    heights = set()
    for position in range(4):
        for each in (deform, whole):
            each.SetSelectedDeformation(position)
            each.FindSelected()
            each.FindAnchor()
        assert abs(deform.GetSelectedHeights()[0] - whole.GetSelectedHeights()[0]) < 1e-6, position
        assert math.dist(deform.GetSelectedAnchor(), whole.GetSelectedAnchor()) < 0.1, position
        heights.add(deform.GetSelectedHeights()[0])
    assert len(heights) == 4 and min(heights) > 1
    # The first bump of a list, too: on every rank, wherever the surface is met.
    for each in (deform, whole):
        each.FindDefault()
    assert math.dist(deform.GetDefaultDeformation(), whole.GetDefaultDeformation()) < 1e-6, deform.GetDefaultDeformation()
    assert min(whole.GetDefaultDeformation()[:7]) > 0.1


def errors_of(bake):
    errors = []
    for watched in (bake, bake.GetExecutive()):
        watched.AddObserver("ErrorEvent", lambda *_: errors.append(1))
    bake.Update()
    return errors


def check_blocks(rank, ranks):
    """Of composite data every rank has other blocks: each has the textures of all of them."""
    meshes = {0: (0, 3), 3: (3, 6)}
    blocks = vtkMultiBlockDataSet()
    blocks.SetNumberOfBlocks(4)
    for k, of in (0, 0), (3, ranks - 1):
        blocks.SetBlock(k, strips(*meshes[k]) if rank == of else None)
    bake = bake_of(blocks)
    bake.OcclusionOff()
    bake.Update()
    textures = bake.GetOutputDataObject(0)
    assert [k for k in range(4) if textures.GetBlock(k)] == list(meshes)
    for k, ends in meshes.items():
        assert texture_and_counts(textures.GetBlock(k)) == baked(strips(*ends), False, False), k
    # Asked for a piece, a rank has its rows of each, whoever has the mesh, and the counts of all of them.
    wholes = {k: texture_and_counts(textures.GetBlock(k)) for k in meshes}
    texels = {k: vtk_to_numpy(textures.GetBlock(k).GetPointData().GetScalars()).reshape(40, 120, -1).copy() for k in meshes}
    bake = bake_of(blocks)
    bake.OcclusionOff()
    bake.UpdatePiece(rank, ranks, 0)
    parts = bake.GetOutputDataObject(0)
    assert [k for k in range(4) if parts.GetBlock(k)] == list(meshes)
    first, end = 40 * rank // ranks, 40 * (rank + 1) // ranks
    for k in meshes:
        part = parts.GetBlock(k)
        assert part.GetExtent() == (0, 119, first, end - 1, 0, 0), part.GetExtent()
        found = vtk_to_numpy(part.GetPointData().GetScalars()).reshape(-1, 120, texels[k].shape[2])
        assert np.array_equal(found, texels[k][first:end]), (rank, k)
        assert texture_and_counts(part)[1] == wholes[k][1], (rank, k)
    # More pieces than rows: some have none of them.
    bake.SetHeight(ranks - 1)
    bake.UpdatePiece(rank, ranks, 0)
    rows = [(k + 1) * (ranks - 1) // ranks - k * (ranks - 1) // ranks for k in range(ranks)]
    assert 0 in rows and bake.GetOutputDataObject(0).GetBlock(0).GetNumberOfPoints() == 120 * rows[rank]
    # Another structure on each rank is an error on all.
    bake = bake_of(blocks)
    bake.OcclusionOff()
    blocks.SetNumberOfBlocks(4 + rank)
    assert errors_of(bake)


def check_failures(rank):
    """Where one rank cannot bake, none does, and none waits for it."""
    mesh = strips(rank, rank + 1)
    if rank == 0:
        mesh.GetPointData().SetTCoords(None)
    bake = bake_of(mesh)
    assert errors_of(bake) and bake.GetOutput().GetNumberOfPoints() == 0


def check_formula(mesh, part):
    """A formula moves a part as it does the whole; the bound is that of the part."""
    formula = "0.1*sin(3*u)*v"
    whole, _ = deformed(mesh, False, True, formula)
    points, deform = deformed(part, True, True, formula)
    for point, moved in points.items():
        assert moved == whole[point], (point, moved, whole[point])
    _, without = deformed(part, True, True)
    assert without.GetErrorBound() < deform.GetErrorBound() < without.GetErrorBound() + 1e-14


def check_grid(rank, ranks):
    """Every rank deforms its piece of a wavelet, an image, as it is deformed in the whole; blends of pieces too."""
    def points_of(piece, pieces, parallel):
        wavelet, deform, blend = vtkRTAnalyticSource(), anamorph.vtkAnamorphDeform(), anamorph.vtkAnamorphInbetween()
        wavelet.SetWholeExtent(-6, 6, -5, 5, -3, 4)
        deform.SetInputConnection(wavelet.GetOutputPort())
        deform.AddDeformation(1, 2, 3, 2, 0.5, 0.25, -1)
        if not parallel:
            deform.SetController(None)
        blend.AddInputConnection(wavelet.GetOutputPort())
        blend.AddInputConnection(wavelet.GetOutputPort())
        found = []
        for algorithm in (deform, blend):
            algorithm.UpdatePiece(piece, pieces, 0)
            grid, image = algorithm.GetOutputDataObject(0), wavelet.GetOutput()
            assert grid.GetClassName() == "vtkStructuredGrid" and grid.GetExtent() == image.GetExtent()
            found.append({image.GetPoint(i): grid.GetPoint(i) for i in range(grid.GetNumberOfPoints())})
        return found
    for whole, part in zip(points_of(0, 1, False), points_of(rank, ranks, True)):
        assert len(whole) == 13 * 11 * 8 and part and part.items() <= whole.items(), (len(whole), len(part))


def check_images(rank, ranks):
    """Every rank draws its part of an image as it is in the whole."""
    def pixels_of(name, piece, pieces):
        wavelet, made = vtkRTAnalyticSource(), getattr(anamorph, "vtkAnamorph" + name)()
        wavelet.SetWholeExtent(-16, 16, -12, 12, 0, 0)
        made.SetInputConnection(wavelet.GetOutputPort())
        if name == "DeformImage":
            made.AddDeformation(0, 0, 6, 6, 3, 2, 0)
        elif name == "ImageMorph":
            made.SetOtherConnection(wavelet.GetOutputPort())
        elif name == "ImageWarp":
            made.SetMeshConnection(plane.GetOutputPort())
        else:
            made.SetViewSize(40, 30)
        made.UpdatePiece(piece, pieces, 0)
        image, values = made.GetOutput(), made.GetOutput().GetPointData().GetScalars()
        return {image.GetPoint(i): values.GetTuple(i) for i in range(image.GetNumberOfPoints())}
    plane = vtkPlaneSource()
    plane.SetOrigin(-16, -12, 0)
    plane.SetPoint1(14, -11, 0)
    plane.SetPoint2(-15, 13, 0)
    plane.SetResolution(4, 3)
    for name in ("DeformImage", "Drape", "ImageMorph", "ImageWarp", "PanoramaView"):
        whole, part = pixels_of(name, 0, 1), pixels_of(name, rank, ranks)
        assert len(whole) > 800 and part and part.items() <= whole.items(), (name, len(whole), len(part))


def main():
    controller = vtkMultiProcessController.GetGlobalController()
    rank, ranks = controller.GetLocalProcessId(), controller.GetNumberOfProcesses()
    assert ranks == int(sys.argv[1]), ranks
    source = vtkSphereSource()
    source.SetThetaResolution(40)
    source.SetPhiResolution(30)
    source.SetOutputPointsPrecision(1)
    source.Update()
    mesh = source.GetOutput()
    count = mesh.GetNumberOfCells()
    whole, serial = deformed(mesh, False, True)
    assert serial.GetErrorBound() > 0
    part = part_of(mesh, rank * count // ranks, (rank + 1) * count // ranks)
    for table_on in [range(ranks), (0,), (ranks - 1,)]:
        points, deform = deformed(part, True, rank in table_on)
        assert 0 < len(points) < len(whole), len(points)
        # The plane is that of all, whichever part is here.
        for name in ["GetUsedOrigin", "GetUsedAxis1", "GetUsedAxis2", "GetErrorBound"]:
            assert getattr(deform, name)() == getattr(serial, name)(), name
        for point, moved in points.items():
            assert moved == whole[point], (point, moved, whole[point])
    check_formula(mesh, part)
    check_grid(rank, ranks)
    check_images(rank, ranks)
    check_painted(mesh, part, controller)
    check_baked(rank, ranks)
    check_baked_by_pieces(rank, ranks)
    check_blocks(rank, ranks)
    check_other_blocks(rank, ranks)
    check_picks(rank, ranks)
    check_failures(rank)
    print("rank", rank, "of", ranks, "agrees at", len(points), "points", flush=True)


try:
    main()
except BaseException:
    # The other ranks may wait for this one: mpiexec then ends them.
    traceback.print_exc()
    os._exit(1)
