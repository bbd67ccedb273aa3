# SPDX-License-Identifier: Apache-2.0
"""The example of figures makes its picture, which shows a walker in red and blue, and a state that can be loaded."""
import os
import subprocess
import tempfile

from display import xvfb_run

SOURCE = os.environ["ANAMORPH_SOURCE_DIR"]
ENVIRONMENT = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}
AGAIN = """
import os, sys
import numpy as np
from paraview import simple
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader
reader = vtkPNGReader()
reader.SetFileName(sys.argv[1] + "/figures.png")
reader.Update()
red, green, blue = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int).T[:3]
assert (red - blue > 60).sum() > 1000 and (blue - red > 20).sum() > 1000, "no walker in the picture"
assert (np.minimum(np.minimum(red, green), blue) > 250).mean() > 0.8
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
LoadState(sys.argv[1] + "/figures.pvsm")
figures = [s for s in GetSources().values() if s.GetXMLName() == "AnamorphFigureReader"]
assert len(figures) == 1 and len(figures[0].TimestepValues) == 49
"""
# Two balls far from the window, which `place` brings to its middle; `observe` turns the second one, behind the first, to the side.
TURNED = """figure f 2 red blue
ellipsoid red 60 60 60
ellipsoid blue 60 60 60
joint j red 0 0 200 blue 0 0 -200
repeat 0 1 moveto f red 3000 500 500
repeat 0 1 place 3000 500 500
repeat 0 1 colour red 250 20 30
repeat 0 1 colour blue 20 30 250
linear 0 8 observe 0 90 0
stop
"""
SEEN = """
import math, os, sys
import numpy as np
from paraview import simple
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader


def places(name):
    # Columns and rows of the middles of what is red and of what is blue, from that of the picture.
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    colors = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int).reshape(600, 600, -1)
    masks = colors[..., 0] - colors[..., 2] > 80, colors[..., 2] - colors[..., 0] > 80
    assert all(mask.sum() > 1500 for mask in masks), [mask.sum() for mask in masks]
    return [np.argwhere(mask).mean(0)[::-1] - 299.5 for mask in masks]


def check(name, frame):
    red, blue = places(name)
    assert np.abs(red).max() < 6 and abs(blue[1]) < 6, (red, blue)  # light is not the same all around
    # 400 units of a window of 1000, in 600 pixels.
    assert abs(abs(blue[0]) - 240 * math.sin(math.radians(90 * frame / 8))) < 6, (frame, blue)


check(sys.argv[1] + "/figures.png", 5)
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
simple._DisableFirstRenderCameraReset()
LoadState(sys.argv[1] + "/figures.pvsm")
for frame in (8, 3):
    GetAnimationScene().AnimationTime = frame
    Render()
    SaveScreenshot(sys.argv[1] + "/later.png", GetActiveView(), ImageResolution=[600, 600])
    check(sys.argv[1] + "/later.png", frame)
"""


def run(*command):
    done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, (command, done.stdout[-2000:], done.stderr[-4000:])
    return done.stdout


def fails(*command):
    """Its exit status is not 0; what it says."""
    done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, timeout=250)
    assert done.returncode not in (0, -11), (command, done.returncode, done.stdout[-2000:], done.stderr[-4000:])
    return done.stdout + done.stderr


EXAMPLE = SOURCE + "/examples/paraview/figures.py"
WALKER = SOURCE + "/examples/figures/walker.nudes"
with tempfile.TemporaryDirectory() as folder:
    out = folder + "/not/there/yet"
    printed = run(*xvfb_run(311), "pvbatch", EXAMPLE, WALKER, out)
    assert "49 frames" in printed, printed
    assert sorted(os.listdir(out)) == ["figures.png", "figures.pvsm"]
    with open(folder + "/again.py", "w") as file:
        file.write(AGAIN)
    run(*xvfb_run(312), "pvbatch", folder + "/again.py", out)
    # The view is the script's, in the state as well.
    with open(folder + "/turned.nudes", "w") as file:
        file.write(TURNED)
    with open(folder + "/seen.py", "w") as file:
        file.write(SEEN)
    run(*xvfb_run(316), "pvbatch", EXAMPLE, folder + "/turned.nudes", folder + "/turned")
    run(*xvfb_run(317), "pvbatch", folder + "/seen.py", folder + "/turned")
    # A folder that cannot be made, and a script without figures, are failures.
    open(folder + "/file", "w").close()
    assert folder + "/file" in fails(*xvfb_run(313), "pvbatch", EXAMPLE, WALKER, folder + "/file/out")
    with open(folder + "/empty.nudes", "w") as file:
        file.write("stop\n")
    assert "there are no figures" in fails(*xvfb_run(314), "pvbatch", EXAMPLE, folder + "/empty.nudes", out)
    assert "none.nudes" in fails(*xvfb_run(315), "pvbatch", EXAMPLE, folder + "/none.nudes", out)
