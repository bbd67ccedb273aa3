# SPDX-License-Identifier: Apache-2.0
"""The states of examples/paraview/make_states.py open from any folder without an error, and show what they are to show: as many colors and as much of the picture
as was looked at; made again by their script, they show the same."""
import os
import subprocess

from display import xvfb_run

SCRIPT = r'''
import os
import sys

import numpy as np
from paraview import servermanager, simple
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader


def picture(folder, name):
    ResetSession()
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
    LoadState(f"{folder}/{name}.pvsm", data_directory=folder)
    view = GetActiveViewOrCreate("RenderView")
    SaveScreenshot("seen.png", view, ImageResolution=[320, 240])
    reader = vtkPNGReader()
    reader.SetFileName("seen.png")
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())[:, :3].astype(int)


def points(name, port=0):
    data = servermanager.Fetch(OutputPort(FindSource(name), port))
    while data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def bumps():
    # A nose 0.16 before the ball, nothing behind it that is not of the ball.
    p = points("face")
    assert abs(p[:, 2].max() - 0.66) < 0.02 and abs(np.linalg.norm(p[p[:, 2] < -0.1], axis=1) - 0.5).max() < 1e-6, p.max(0)
    assert len(FindSource("face").Bumps) == 5 * 19 and list(FindSource("face").Names)[1] == "nose"


def expressions():
    reader, own = FindSource("expressions.glb"), FindSource("own weights")
    base, smile, frown = (points(name) for name in ("face", "smile", "frown"))
    assert np.abs(points("own weights") - (base + (smile - base) + 0.8 * (frown - base))).max() < 1e-6
    assert list(reader.TimestepValues) == [0, 1, 2, 3, 4]
    assert GetAnimationScene().AnimationTime == 1 and np.abs(points("expressions.glb") - smile).max() < 1e-6


def splats():
    assert len(points("splats.ply")) == 4000


def atoms():
    assert len(points("benzene.cif")) == 12


# How much of the picture is not background, and how many colors there are, of 8 levels a channel.
for name, check, covered, colors in (("bumps", bumps, 0.2, 15), ("expressions", expressions, 0.2, 20), ("splats", splats, 0.1, 60), ("atoms", atoms, 0.05, 15)):
    seen = picture(sys.argv[1], name)
    check()
    ground = (np.abs(seen - [33, 41, 54]).max(1) <= 2).mean()
    found = len(np.unique(seen // 32, axis=0))
    assert covered < 1 - ground < 0.9 and found >= colors, (name, 1 - ground, found)
    again = picture(sys.argv[2], name)
    assert (np.abs(again - seen).max(1) > 2).mean() < 0.01, name
print("worked states: as they should be")
'''

examples = os.environ["ANAMORPH_SOURCE_DIR"] + "/examples/paraview"
plugin = os.environ["ANAMORPH_PLUGIN"]
environment = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", "PV_PLUGIN_PATH": os.path.dirname(plugin)}
with open("worked_states.py", "w") as file:
    file.write(SCRIPT)
for command in ([examples + "/make_states.py", "made"], ["worked_states.py", examples, os.path.abspath("made")]):
    done = subprocess.run([*xvfb_run(378), "pvpython", *command], env=environment, capture_output=True, text=True, timeout=140)
    assert done.returncode == 0, (done.stdout[-3000:], done.stderr[-5000:])
    assert "ERR" not in done.stderr, done.stderr[-5000:]
assert "as they should be" in done.stdout, done.stdout
