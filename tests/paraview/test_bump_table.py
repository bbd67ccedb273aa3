# SPDX-License-Identifier: Apache-2.0
# host: pvpython
"""The table of ParaView's Deform: it and its parts follow each other, rows take all of their own along, in states, files and undo too."""
import math
import os
import tempfile

from paraview import simple
from paraview.simple import *

LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
globals().update(vars(simple))
sphere = Sphere(Radius=1, ThetaResolution=60, PhiResolution=60)
sphere.UpdatePipeline()


def row(k, name=0):
    """c, a, V, kernel, on, side, q, mirror, at, name"""
    return [.1 * k, .2, .3, .4, .5, .6, 0, 0, .01 * k, 0, 1, k % 3, 1, .1 * k, 0, 0, k % 2, .05 * k, name]


def parts_of(rows):
    flat = [rows[i:i + 19] for i in range(0, len(rows), 19)]
    return ([x for r in flat for x in r[0:2] + r[3:5] + r[6:9] + r[9:11]],
            [x for r in flat for x in [r[2], r[5], r[11]]], [x for r in flat for x in r[12:19]])


def expect(deform, rows):
    deform.UpdatePipeline()
    assert list(deform.Bumps) == rows, list(deform.Bumps)
    own, depths, frames = parts_of(rows)
    assert list(deform.Deformations) == own and list(deform.Depths) == depths and list(deform.Frames) == frames
    deform.SMProxy.UpdatePropertyInformation()
    assert list(deform.GetPropertyValue("DeformationsInfo")) == own
    assert list(deform.GetPropertyValue("DepthsInfo")) == depths
    info = list(deform.GetPropertyValue("FramesInfo"))
    assert [x for i, x in enumerate(info) if i % 7 != 6] == [x for i, x in enumerate(frames) if i % 7 != 6], info


# ---- The table and its parts ----

deform = AnamorphDeform(Input=sphere, AutomaticPlane=0)
# The one it begins with leaves the far side of a closed surface alone; a list of a script that knows nothing of that is without.
assert len(deform.Bumps) == 19 and deform.Depths[1] > 0 and len(deform.Frames) == 7
assert list(deform.Bumps)[16:] == [0, 0, 0]
deform.Deformations = [.5, 0, .2, .2, 0, 0, .3, 0, 1]
assert list(deform.Depths) == [] and list(deform.Frames) == [] and list(deform.Bumps)[12:] == [1, 0, 0, 0, 0, 0, 0]
assert list(deform.Bumps)[:3] == [.5, 0, 0] and deform.Bumps[8] == .3
rows = [row(1), row(2), row(3), row(4)]
deform.Names = ["brow", "chin"]
deform.Bumps = sum(rows, [])
expect(deform, sum(rows, []))
# A row that is removed takes its depth, frame and name along, though all others are alike.
alike = [list(row(1)) for _ in range(4)]
for k in range(4):
    alike[k][2], alike[k][13], alike[k][18] = .1 * k, .2 * k, k % 3
deform.Bumps = sum(alike, [])
expect(deform, sum(alike, []))
deform.Bumps = sum(alike[:1] + alike[2:], [])
expect(deform, sum(alike[:1] + alike[2:], []))
# Moved ones, too.
deform.Bumps = sum([alike[3], alike[0]], [])
expect(deform, sum([alike[3], alike[0]], []))
# A handle edits its row alone.
deform.SelectedDeformation = 1
deform.SelectedVector = [0, .1, .2]
moved = list(alike[0])
moved[6:9] = [0, .1, .2]
expect(deform, sum([alike[3], moved], []))
# Scripts that know the parts alone.
deform.Depths = [1, .5, 0, 0, .6, 1]
deform.UpdatePipeline()
assert deform.Bumps[2] == 1 and deform.Bumps[19 + 11] == 1
deform.Bumps = []
deform.UpdatePipeline()
assert list(deform.Deformations) == [] and list(deform.Depths) == [] and list(deform.Frames) == []

# ---- Files and states ----

with tempfile.TemporaryDirectory() as folder:
    deform.Names = ["brow", "chin"]
    named = sum([row(1, 2), row(2, 0), row(3, 1)], [])
    deform.Bumps = named
    deform.UpdatePipeline()
    for ending in ["json", "csv"]:
        path = os.path.join(folder, "list." + ending)
        deform.ExportFile = path
        deform.UpdatePipeline()
        text = open(path).read()
        assert text.index("chin") < text.index("brow"), text
        other = AnamorphDeform(Input=sphere, AutomaticPlane=0)
        other.ImportFile = path
        other.UpdatePipeline()
        assert list(other.Names) == ["chin", "brow"], list(other.Names)
        assert list(other.Bumps) == sum([row(1, 1), row(2, 0), row(3, 2)], []), list(other.Bumps)
        Delete(other)
    state = os.path.join(folder, "state.pvsm")
    SaveState(state)
    ResetSession()
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
    globals().update(vars(simple))
    LoadState(state)
    deform = [p for (n, i), p in GetSources().items() if p.GetXMLName() == "AnamorphDeform"][0]
    expect(deform, named)
    assert list(deform.Names) == ["brow", "chin"]
    # A state from before there was a table.
    import re
    old = re.sub(r'<Property name="(Bumps|Frames|Names)".*?</Property>', "", open(state).read(), flags=re.S)
    open(state, "w").write(old)
    ResetSession()
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
    globals().update(vars(simple))
    LoadState(state)
    deform = [p for (n, i), p in GetSources().items() if p.GetXMLName() == "AnamorphDeform"][0]
    deform.UpdatePipeline()
    assert list(deform.Deformations) == parts_of(named)[0] and list(deform.Frames) == []
    assert deform.Bumps[12:19] == [1, 0, 0, 0, 0, 0, 0] and deform.Bumps[2] == .3

# ---- The anchor ----

sphere = [p for (n, i), p in GetSources().items() if p.GetXMLName() == "SphereSource"][0]
deform = AnamorphDeform(Input=sphere, AutomaticPlane=0)
deform.Bumps = [.6, -.5, 0, .2, .3, 0, 0, 0, .5, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0]
deform.SelectedDeformation = 0
deform.UpdatePipeline()
deform.SMProxy.InvokeCommand("AnchorSelected")
deform.UpdatePipeline()
u, v, w = .6, -.5, math.sqrt(1 - .36 - .25)
assert abs(deform.Bumps[2] - w) < 5e-3 and deform.Bumps[5] == .2
for c, at in enumerate([u, v, w]):
    assert abs(deform.Bumps[6 + c] - .5 * at) < 5e-3, list(deform.Bumps)
assert list(deform.Depths)[:2] == [deform.Bumps[2], .2] and len(deform.Frames) == 7
from vtkmodules.vtkCommonDataModel import vtkPolyData
moved = servermanager.Fetch(deform).GetPointData().GetArray("Displacement")
lengths = [math.sqrt(sum(x * x for x in moved.GetTuple3(i))) for i in range(moved.GetNumberOfTuples())]
assert .45 < max(lengths) <= .5001 and sum(length > 1e-6 for length in lengths) < len(lengths) / 2
print("bump table: all right")
