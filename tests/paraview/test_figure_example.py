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


def run(*command):
    done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, (command, done.stdout[-2000:], done.stderr[-4000:])
    return done.stdout


with tempfile.TemporaryDirectory() as folder:
    walker = SOURCE + "/examples/figures/walker.nudes"
    printed = run(*xvfb_run(311), "pvbatch", SOURCE + "/examples/paraview/figures.py", walker, folder)
    assert "49 frames" in printed, printed
    with open(folder + "/again.py", "w") as file:
        file.write(AGAIN)
    run(*xvfb_run(312), "pvbatch", folder + "/again.py", folder)
