# SPDX-License-Identifier: Apache-2.0
# host: pvpython
"""The list of deformations as a user edits it: defaults from the data, table, handles, files, a table as an input,
texture coordinates, the overlay."""
import csv
import random

import numpy as np
import surfaces
from paraview import servermanager
from paraview.simple import *

surfaces.LoadPlugin(surfaces.os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())


def close(found, wanted):
    assert len(found) == len(wanted), (found, wanted)
    assert all(abs(f - w) <= 1e-12 * (1 + abs(w)) for f, w in zip(found, wanted)), (list(found), wanted)


def bounds(source, port=0):
    source.UpdatePipeline()
    return OutputPort(source, port).GetDataInformation().GetBounds()


def check_default():
    plane = Plane(Origin=[1, 2, 5], Point1=[4, 2, 5], Point2=[1, 8, 5], XResolution=30, YResolution=30)
    plane.UpdatePipeline()
    deform = AnamorphDeform(Input=plane)
    close(deform.Deformations, [2.5, 5, 0.5, 1, 0, 0, 45 ** 0.5 / 10, 0, 1])
    close(deform.SelectedCenter, [2.5, 5, 5])
    found = bounds(deform)
    assert 5 <= found[4] < 5.01 and abs(found[5] - 5 - 45 ** 0.5 / 10) < 1e-6, found


def check_handles(plane, properties, centre, corner):
    """A row of the list and the handles follow each other; (u, v) = (2, 3) is at `centre`, (2.5, 3.25) at `corner`."""
    deform = AnamorphDeform(Input=plane, **properties)
    rows = [[0, 0, 1, 1, 0, 0, 1, 0, 1], [2, 3, 0.5, 0.25, 1, 2, 3, 1, 1]]
    deform.Deformations = sum(rows, [])
    deform.SelectedDeformation = 1
    close(deform.SelectedCenter, centre)
    close(deform.SelectedCorner, corner)
    close(deform.SelectedVector, [1, 2, 3])
    moved = [2 * q - p for p, q in zip(centre, corner)]  # by an extent
    deform.SelectedCenter = moved
    close(deform.Deformations, rows[0] + [3, 3.5, 0.5, 0.25, 1, 2, 3, 1, 1])
    close(deform.SelectedCorner, [p + q - c for p, q, c in zip(moved, corner, centre)])
    deform.SelectedCorner = [p + 3 * (q - c) for p, q, c in zip(moved, corner, centre)]
    close(deform.Deformations, rows[0] + [3, 3.5, 1.5, 0.75, 1, 2, 3, 1, 1])
    deform.SelectedVector = [0, 0, -1]
    close(deform.Deformations, rows[0] + [3, 3.5, 1.5, 0.75, 0, 0, -1, 1, 1])
    server = deform.SMProxy
    deform.UpdatePipeline()
    server.UpdatePropertyInformation()
    close(deform.GetPropertyValue("DeformationsInfo"), list(deform.Deformations))
    deform.SelectedDeformation = 7  # none: handles stay, and move nothing
    deform.SelectedCenter = [9, 9, 9]
    close(deform.Deformations, rows[0] + [3, 3.5, 1.5, 0.75, 0, 0, -1, 1, 1])


def check_depths():
    """A sphere gets a peak and no dent; handles are on the deformed surface; depths stay with rows, in files too."""
    sphere = Sphere(Radius=1, ThetaResolution=64, PhiResolution=65)
    deform = AnamorphDeform(Input=sphere, Deformations=[0, 0, .5, .5, 0, 0, 1, 0, 1], AutomaticPlane=0)
    both = bounds(deform)
    assert abs(both[5] - 2) < 1e-5 and both[4] > -1 + .2, both
    deform.Depths = [0, 0, 1]
    front = bounds(deform)
    assert abs(front[5] - 2) < 1e-5 and abs(front[4] + 1) < 1e-5, front
    deform.Depths = [1, .5, 0]
    deep = bounds(deform)
    assert abs(deep[5] - 2) < 1e-5 and abs(deep[4] + 1) < 1e-4, deep
    close([round(c, 5) for c in deform.SelectedCenter], [0, 0, 2])
    close([round(c, 5) for c in deform.SelectedTip], [0, 0, 3])
    assert .5 < deform.SelectedCorner[2] < 1.1, list(deform.SelectedCorner)
    # The tip's handle is the vector: dragged, the peak follows, and the handles with it.
    deform.SelectedTip = [.25, 0, deform.SelectedCenter[2] + .5]
    close(deform.Deformations, [0, 0, .5, .5, .25, 0, .5, 0, 1])
    close(deform.SelectedVector, [.25, 0, .5])
    deform.UpdatePipeline()
    assert abs(deform.SelectedCenter[2] - 1.5) < 1e-5, list(deform.SelectedCenter)
    close(deform.SelectedTip, [p + v for p, v in zip(deform.SelectedCenter, deform.SelectedVector)])
    close(deform.Deformations, [0, 0, .5, .5, .25, 0, .5, 0, 1])
    # A row more, a row less: the first keeps its depth.
    once = bounds(deform)
    deform.Deformations = list(deform.Deformations) + [1, 0, .1, .1, 0, 0, 0, 0, 1]
    deform.UpdatePipeline()
    deform.Deformations = list(deform.Deformations)[:9]
    assert bounds(deform) == once
    for name in ("deep.json", "deep.csv"):
        deform.ExportFile = name
        other = AnamorphDeform(Input=sphere, AutomaticPlane=0)
        other.ImportFile = name
        assert list(other.Deformations) == list(deform.Deformations) and list(other.Depths) == [1, .5, 0]
        assert bounds(other) == once
    deform.Depths = []
    assert bounds(deform) != once


def check_files(plane):
    deform = AnamorphDeform(Input=plane, Deformations=surfaces.BUMPS)
    for name in ("list.json", "list.csv"):
        deform.ExportFile = name
        assert deform.ExportFile == "" and open(name).read().count("gaussian") == 3
        other = AnamorphDeform(Input=plane)
        other.ImportFile = name
        assert list(other.Deformations) == surfaces.BUMPS and other.ImportFile == ""
        assert bounds(other) == bounds(deform)
        file = AnamorphDeform(Input=plane, FileName=name)
        assert list(file.Deformations) == [] and bounds(file) == bounds(deform)
    return deform


def check_table(deform, plane):
    table = CSVReader(FileName=["list.csv"])
    table.UpdatePipeline()
    with_table = AnamorphDeform(Input=plane, Table=table)
    assert list(with_table.Deformations) == [] and bounds(with_table) == bounds(deform)


def check_texture_coordinates(plane):
    """The plane's texture coordinates run from 0 to 1: a bump at 0.25 is a quarter along it."""
    deform = AnamorphDeform(Input=plane, Deformations=[0.25, 0.5, 0.01, 0.01, 0, 0, 1, 1, 1], ParameterMode=1,
                            TextureCoordinates=["POINTS", "TextureCoordinates"])
    deform.UpdatePipeline()
    data = servermanager.Fetch(deform)
    highest = max(range(data.GetNumberOfPoints()), key=lambda i: data.GetPoint(i)[2])
    close(data.GetPoint(highest), [-0.25, 0, 1])
    # Handles are where the parameters are, on the deformed surface, and say where the bump goes in its plane there.
    assert np.allclose(deform.SelectedCenter, [-0.25, 0, 1], atol=1e-5), deform.SelectedCenter
    assert np.allclose(deform.SelectedTip, [-0.25, 0, 2], atol=1e-5), deform.SelectedTip
    deform.SelectedCenter = [0.25, -0.1, 1]
    assert np.allclose(deform.Deformations[:2], [0.75, 0.4], atol=1e-5), list(deform.Deformations)
    deform.UpdatePipeline()
    assert np.allclose(deform.SelectedCenter[:2], [0.25, -0.1], atol=1e-5), deform.SelectedCenter
    # In one step with the choice of parameters, handles say nothing: where they belong is not known.
    fresh = AnamorphDeform(Input=plane, Deformations=[0.25, 0.5, 0.1, 0.1, 0, 0, 1, 1, 1], ParameterMode=1,
                           TextureCoordinates=["POINTS", "TextureCoordinates"], SelectedCenter=[7, 8, 9])
    fresh.UpdatePipeline()
    assert list(fresh.Deformations)[:2] == [0.25, 0.5], list(fresh.Deformations)


def check_depths_follow(plane):
    """Who removes a row of the list removes its depth; who sets the depths has the last word."""
    def row(i):
        return [i, 0.5, 0.1, 0.1, 0, 0, i, 0, 1]

    def depth(*rows):
        return [number for i in rows for number in (i, 1, 0)]

    deform = AnamorphDeform(Input=plane, Deformations=row(1) + row(2) + row(3) + row(4), Depths=depth(1, 2, 3, 4))
    for rows, kept in (((1, 3, 4), (1, 3, 4)), ((1, 3, 4, 5), (1, 3, 4)), ((3, 4, 5), (3, 4)), ((4, 5), (4,)), ((5,), ())):
        deform.UpdatePipeline()
        deform.Deformations = [number for i in rows for number in row(i)]
        assert list(deform.Depths) == depth(*kept), (rows, list(deform.Depths))
        deform.SMProxy.UpdatePropertyInformation()
        own = list(deform.GetPropertyValue("DepthsInfo"))
        assert own == [number for i in rows for number in ((i, 1, 0) if i in kept else (0, 0, 0))], own
    # One row goes, and another one is edited.
    deform.Deformations, deform.Depths = row(1) + row(2) + row(3), depth(1, 2, 3)
    deform.UpdatePipeline()
    deform.Deformations = row(2)[:6] + [9, 0, 1] + row(3)
    assert list(deform.Depths) == depth(2, 3), list(deform.Depths)
    # Another list altogether leaves the depths, and so does who sets both.
    deform.UpdatePipeline()
    deform.Deformations = [70, 71, 72, 73, 74, 75, 76, 1, 0]
    assert list(deform.Depths) == depth(2, 3), list(deform.Depths)
    deform.UpdatePipeline()
    deform.Deformations, deform.Depths = row(1) + row(2), depth(1, 2)
    deform.UpdatePipeline()
    deform.Depths = depth(5, 6)
    deform.Deformations = row(2)
    assert list(deform.Depths) == depth(5, 6), list(deform.Depths)


def check_overlay(deform):
    assert OutputPort(deform, 1).GetDataInformation().GetNumberOfCells() == 0
    deform.GenerateOverlay = 1
    deform.UpdatePipeline()
    overlay = servermanager.Fetch(ExtractSurface(Input=OutputPort(deform, 1)))
    cells = overlay.GetCellData()
    positions = {int(cells.GetArray("Deformation").GetTuple1(i)) for i in range(overlay.GetNumberOfCells())}
    assert positions == {0, 1, 2, 3}, positions


def used_plane(deform):
    deform.UpdatePropertyInformation()
    return [list(deform.GetPropertyValue(name)) for name in ("UsedOrigin", "UsedAxis1", "UsedAxis2")]


def check_plane():
    """The automatic plane stays while a surface turns, and handles with it; frozen, it stays with other cells too."""
    sphere = Sphere(ThetaResolution=64, PhiResolution=64)

    def turned_sphere(degrees):
        turned = Transform(Input=sphere, Transform="Transform")
        turned.Transform.Rotate = [degrees, 2 * degrees, 3 * degrees]
        turned.UpdatePipeline()
        return turned

    def chosen(degrees):
        alone = AnamorphDeform(Input=turned_sphere(degrees))
        alone.UpdatePipeline()
        return used_plane(alone)[1:]
    assert len({str(chosen(degrees)) for degrees in range(0, 40, 4)}) > 1
    turned = turned_sphere(0)
    deform = AnamorphDeform(Input=turned)
    deform.UpdatePipeline()
    axes = used_plane(deform)[1:]
    for degrees in range(4, 40, 4):
        turned.Transform.Rotate = [degrees, 2 * degrees, 3 * degrees]
        deform.UpdatePipeline()
        assert used_plane(deform)[1:] == axes, degrees
    for i in range(2):
        deform.SelectedCenter = [.1 * c for c in axes[i]]
        deform.UpdatePipeline()
        close(deform.Deformations[:2], [0 if i else .1, .1 if i else 0])
    turned.Transform.Scale = [1, 2, 3]
    plane = used_plane(deform)
    deform.InvokeCommand("FreezePlane")
    assert deform.AutomaticPlane == 0
    close(sum(used_plane(deform), []), sum(plane, []))
    assert [list(deform.Origin), list(deform.Axis1), list(deform.Axis2)] == used_plane(deform)
    sphere.PhiResolution = 20
    deform.UpdatePipeline()
    assert used_plane(deform)[1:] == axes
    # Of what has not been updated yet, too.
    new = AnamorphDeform(Input=Plane(Origin=[0, 0, 5], Point1=[1, 0, 5], Point2=[0, 1, 6]))
    new.InvokeCommand("FreezePlane")
    assert new.AutomaticPlane == 0 and list(new.Axis2) == [0, 1, 0] and new.Origin[2] == 5.5, list(new.Axis2)


def check_handles_in_any_order(plane):
    """What is set between two updates acts together; a corner beside the centre leaves the extent that way."""
    values = {"Deformations": [0, 0, 1, 1, 0, 0, 1, 0, 1, 2, 3, 0.5, 0.25, 1, 2, 3, 1, 1], "SelectedDeformation": 1,
              "AutomaticPlane": 0, "Origin": [1, 0, 0], "Axis1": [0, 2, 0], "Axis2": [0, 0, -1],
              "SelectedCenter": [1, 8, -1], "SelectedCorner": [1, 8, -5], "SelectedVector": [0, 0, 2]}
    for seed in range(10):
        names = list(values)
        random.Random(seed).shuffle(names)
        deform = AnamorphDeform(Input=plane)
        for name in names:
            setattr(deform, name, values[name])
        assert list(deform.Deformations) == values["Deformations"][:9] + [4, 1, 0.5, 4, 0, 0, 2, 1, 1], \
            (names, list(deform.Deformations))
        # The next update begins anew: the list as it is set then.
        deform.UpdatePipeline()
        deform.Deformations = values["Deformations"]
        assert list(deform.Deformations) == values["Deformations"]
        close(deform.SelectedCenter, [1, 4, -3])


def check_refusal(plane):
    """An extent of 0 is an error, not a crash; the next edit mends it."""
    deform = AnamorphDeform(Input=plane, Deformations=[0, 0, 0, 1, 0, 0, 1, 0, 1])
    deform.UpdatePipeline()
    assert deform.GetDataInformation().GetNumberOfPoints() == 0
    deform.Deformations = [0, 0, 1, 1, 0, 0, 1, 0, 1]
    assert bounds(deform)[5] == 1


square = Plane(XResolution=100, YResolution=100)
square.UpdatePipeline()
check_default()
check_depths()
check_handles(square, {}, [2, 3, 0], [2.5, 3.25, 0])
check_handles(square, {"AutomaticPlane": 0, "Origin": [1, 0, 0], "Axis1": [0, 2, 0], "Axis2": [0, 0, -1]},
              [1, 4, -3], [1, 5, -3.25])
check_table(check_files(square), square)
check_texture_coordinates(square)
check_depths_follow(square)
check_overlay(check_files(square))
check_plane()
check_handles_in_any_order(square)
check_refusal(square)
