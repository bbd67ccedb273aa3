# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphProjectionBake in pipelines: times, pieces, ghosts, composite data, and what filters behind it are told.
import math

import numpy as np
from conformance import Source, errors_of, ghosts_of, picture, pixels, steps_of, time_of, wall
from vtkmodules.vtkCommonCore import VTK_FLOAT, VTK_UNSIGNED_CHAR
from vtkmodules.vtkCommonDataModel import (vtkCellArray, vtkDataObject, vtkImageData, vtkMultiBlockDataSet,
                                           vtkPartitionedDataSetCollection, vtkPolyData)
from vtkmodules.vtkFiltersSources import vtkSphereSource
from vtkmodules.vtkFiltersTexture import vtkTextureMapToSphere
from vtkmodules.vtkImagingCore import vtkImageFlip

import anamorph

HIDDEN_CELL, DUPLICATE_CELL = 32, 1


def bake_of(mesh=None, image=None, others=None, size=(20, 16)):
    """Thrown from the origin towards -z. The inputs are data or algorithms."""
    bake = anamorph.vtkAnamorphProjectionBake()
    bake.AddProjector(0, 0, 0, 0, 0, -1, 0, 1, 0)
    bake.SetWidth(size[0])
    bake.SetHeight(size[1])
    bake.SetMargin(0)
    for port, given in enumerate((mesh, image, others)):
        if isinstance(given, vtkDataObject):
            bake.AddInputDataObject(port, given)
        elif given:
            bake.AddInputConnection(port, given.GetOutputPort())
    return bake


def baked(*arguments, **settings):
    bake = bake_of(*arguments, **settings)
    bake.Update()
    return pixels(bake.GetOutput())


def painted(texture):
    return texture[..., -1] != 0


def times_are_those_of_all_inputs():
    pictures, meshes, others = (lambda t: picture(1 + t)), (lambda t: wall(-1 - t)), (lambda t: wall(-0.5, half=0.2 + t / 8))
    for steps in ((0.0, 1.0, 2.0), None, None), (None, (0.0, 1.0, 2.0), None), (None, None, (0.0, 1.0, 2.0)):
        sources = [Source(make, given) for make, given in zip((meshes, pictures, others), steps)]
        bake = bake_of(*sources)
        assert steps_of(bake) == [0, 1, 2], (steps, steps_of(bake))
        for time in (1.0, 2.0):
            bake.UpdateTimeStep(time)
            assert time_of(bake.GetOutput()) == time, (steps, time)
            # What does not vary is asked for once, at whatever time.
            at = [time if given else 1.0 for given in steps]
            expected = baked(meshes(at[0]), pictures(at[1]), others(at[2]))
            assert (pixels(bake.GetOutput()) == expected).all(), (steps, time)
    first, second = Source(meshes, (0.0, 2.0)), Source(pictures, (1.0, 2.0))
    bake = bake_of(first, second)
    assert steps_of(bake) == [0, 1, 2]
    for source, left in ((second, [0, 2]), (first, [])):
        source.steps = None
        source.Modified()
        assert steps_of(bake) == left, "no longer"
    still = bake_of(Source(meshes), Source(pictures))
    assert steps_of(still) == []
    still.Update()
    assert time_of(still.GetOutput()) is None


def a_piece_is_baked_of_the_whole_mesh():
    def sphere():
        source, coordinates = vtkSphereSource(), vtkTextureMapToSphere()
        source.SetThetaResolution(24)
        source.SetPhiResolution(13)
        coordinates.SetInputConnection(source.GetOutputPort())
        coordinates.PreventSeamOff()
        return coordinates

    whole = baked(sphere(), picture(), size=(40, 40))
    assert painted(whole).mean() > 0.8
    for piece in range(2):
        bake = bake_of(sphere(), picture(), size=(40, 40))
        bake.UpdatePiece(piece, 2, 0)
        x0, x1, y0, y1, _, _ = bake.GetOutput().GetExtent()
        assert (pixels(bake.GetOutput()) == whole[y0:y1 + 1, x0:x1 + 1]).all(), piece
        mesh, others = Source(lambda t: wall()), Source(lambda t: wall(-0.5, half=0.2))
        bake_of(mesh, picture(), others).UpdatePiece(piece, 2, 1)
        assert mesh.asked == others.asked == [(0, 0, 1)], (mesh.asked, others.asked)
        shown = Source(lambda t: picture())
        bake_of(wall(), shown).UpdatePiece(piece, 2, 0)
        assert shown.asked == [(0, 0, 1)], shown.asked


def hidden_cells_are_not_there():
    mesh, plain = wall(), baked(wall(), picture())
    assert painted(plain).all()
    # Rows of 4 cells from the bottom up: the lower half.
    mesh.GetCellData().AddArray(ghosts_of([HIDDEN_CELL] * 8 + [0] * 8))
    half = baked(mesh, picture())
    assert not painted(half)[:8].any() and (half[8:] == plain[8:]).all()
    # With other cells before the polygons.
    other, cells = wall(), vtkCellArray()
    cells.InsertNextCell(2, [0, 1])
    other.SetVerts(cells)
    other.SetLines(cells)
    other.GetCellData().AddArray(ghosts_of([HIDDEN_CELL, 0] + [HIDDEN_CELL] * 8 + [0] * 8))
    assert (baked(other, picture()) == half).all()
    # Nor do they hide anything: half of what the wall behind does not show is seen.
    assert not painted(baked(wall(-2), picture(), wall())).any()
    seen = painted(baked(wall(-2), picture(), mesh))
    assert seen[:7].all() and not seen[9:].any()
    # Cells that another piece has, too, are.
    mesh.GetCellData().AddArray(ghosts_of([DUPLICATE_CELL] * 8 + [0] * 8))
    assert (baked(mesh, picture()) == plain).all()


def blocks_cast_shadows_together_and_are_baked_apart():
    mesh, left, right = wall(-3), wall(-1, half=0.3), wall(-2, half=0.3)
    both = vtkMultiBlockDataSet()
    both.SetBlock(1, left)
    inner = vtkMultiBlockDataSet()
    inner.SetBlock(0, right)
    inner.SetBlock(2, vtkPolyData())
    inner.SetBlock(3, picture())
    both.SetBlock(3, inner)
    collection = vtkPartitionedDataSetCollection()
    collection.SetPartition(0, 0, left)
    collection.SetPartition(1, 1, right)
    alone = [baked(mesh, picture(), each) for each in (left, right)]
    expected = painted(alone[0]) & painted(alone[1])
    assert 0 < expected.sum() < expected.size
    for others in (both, collection):
        bake = bake_of(mesh, picture(), others)
        bake.Update()
        assert bake.GetOutputDataObject(0).IsA("vtkImageData")
        assert (painted(pixels(bake.GetOutput())) == expected).all()
    for others in (vtkMultiBlockDataSet(), vtkPolyData()):
        assert (baked(mesh, picture(), others) == baked(mesh, picture())).all()
    # A texture for each mesh.
    collection.SetPartition(2, 0, vtkPolyData())
    bake = bake_of(collection, picture())
    bake.Update()
    out = bake.GetOutputDataObject(0)
    for i, each in enumerate((left, right)):
        assert (pixels(out.GetPartition(i, i)) == baked(each, picture())).all()
    assert not pixels(out.GetPartition(2, 0)).any()
    # Of a piece, its rows of each; more pieces than rows have none.
    wholes = [pixels(out.GetPartition(i, i)).copy() for i in range(2)]
    height = wholes[0].shape[0]
    for pieces in (2, 3, height + 2):
        rows = []
        for piece in range(pieces):
            bake = bake_of(collection, picture())
            bake.UpdatePiece(piece, pieces, 0)
            first, end = height * piece // pieces, height * (piece + 1) // pieces
            part = bake.GetOutputDataObject(0)
            for i, whole in enumerate(wholes):
                assert part.GetPartition(i, i).GetNumberOfPoints() == (end - first) * whole.shape[1]
                if first < end:
                    assert part.GetPartition(i, i).GetExtent()[2:4] == (first, end - 1)
                    assert (pixels(part.GetPartition(i, i)) == whole[first:end]).all(), (piece, pieces, i)
            rows += range(first, end)
        assert rows == list(range(height))


def filters_behind_it_know_its_numbers():
    for kinds, kind in (((np.uint8,), VTK_UNSIGNED_CHAR), ((np.float32,), VTK_FLOAT), ((np.uint8, np.uint16), VTK_FLOAT)):
        flip, bake = vtkImageFlip(), bake_of(wall())
        for i, each in enumerate(kinds):
            bake.AddInputDataObject(1, picture(kind=each))
            if i:
                bake.AddProjector(0.1, 0, 0, 0, 0, -1, 0, 1, 0)
        flip.SetInputConnection(bake.GetOutputPort())
        flip.SetFilteredAxis(1)
        flip.Update()
        assert flip.GetOutput().GetScalarType() == bake.GetOutput().GetScalarType() == kind
        assert (pixels(flip.GetOutput()) == pixels(bake.GetOutput())[::-1]).all()


def missing_and_odd_inputs():
    assert "port 0" in errors_of(bake_of(None, picture())) and "port 1" in errors_of(bake_of(wall()))
    thick = vtkImageData()
    thick.SetDimensions(8, 4, 2)
    thick.AllocateScalars(VTK_FLOAT, 1)
    for image, said in ((thick, "panorama=0: has 2 slices, but must have 1"), (vtkImageData(), "panorama=0: must be an image")):
        bake = bake_of(wall(), image)
        assert said in errors_of(bake), said
        assert bake.GetOutput().GetNumberOfPoints() == 0
        bake.SetInputDataObject(1, picture())
        assert errors_of(bake) == "" and painted(pixels(bake.GetOutput())).all()
    # What is not finite in a panorama stays where it is.
    image, plain = picture(), baked(wall(), picture())
    image.GetPointData().GetScalars().SetValue(64 * 16 + 32, math.nan)
    texture = baked(wall(), image)
    assert 0 < np.isnan(texture[..., 0]).sum() < 10 and (texture == plain)[~np.isnan(texture[..., 0])].all()


times_are_those_of_all_inputs()
a_piece_is_baked_of_the_whole_mesh()
hidden_cells_are_not_there()
blocks_cast_shadows_together_and_are_baked_apart()
filters_behind_it_know_its_numbers()
missing_and_odd_inputs()
