# SPDX-License-Identifier: Apache-2.0
"""While ParaView's view is turned, the representation Ellipsoids draws the largest bodies alone, each where it is in the still picture; which is the same before and after."""
import os
import subprocess

from display import xvfb_run

SCRIPT = r'''
import os

import numpy as np
from paraview import simple
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray

LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
bodies = ProgrammableSource(Script="""
import numpy as np
from paraview.vtk.util.numpy_support import numpy_to_vtk
from paraview.vtk.vtkCommonCore import vtkPoints
random, points = np.random.default_rng(1), vtkPoints()
points.SetData(numpy_to_vtk(random.uniform(-1, 1, (3000, 3)), deep=1))
output.SetPoints(points)
for name, values in (("Axes", 0.05 * random.uniform(0.3, 1, (3000, 3))), ("Orientation", random.normal(size=(3000, 4)))):
    array = numpy_to_vtk(values, deep=1)
    array.SetName(name)
    output.GetPointData().AddArray(array)
""")
bodies.UpdatePipeline()
view = CreateRenderView()
view.ViewSize, view.UseColorPaletteForBackground, view.Background, view.OrientationAxesVisibility = [300, 300], 0, [0, 0, 0], 0
shown = Show(bodies, view)
shown.SetRepresentationType("Ellipsoids")
shown.EllipsoidAxes, shown.EllipsoidOrientation, shown.EllipsoidInteractiveBodies = "Axes", "Orientation", 100
ResetCamera(view)
Render(view)


def seen(render):
    render()
    pixels = vtkUnsignedCharArray()
    view.GetRenderWindow().GetPixelData(0, 0, 299, 299, 0, pixels, 0)
    return vtk_to_numpy(pixels).reshape(-1, 3).copy()


still = seen(view.SMProxy.StillRender)
turned = seen(view.SMProxy.InteractiveRender)
assert np.array_equal(seen(view.SMProxy.StillRender), still)
few, all_of_them = (turned.sum(1) > 0).mean(), (still.sum(1) > 0).mean()
assert 0.01 < few < 0.5 * all_of_them, (few, all_of_them)
shown.EllipsoidInteractiveBodies = 0
Render(view)
assert np.array_equal(seen(view.SMProxy.InteractiveRender), still)
print("as it should be", few, all_of_them)
'''
with open("interaction.py", "w") as file:
    file.write(SCRIPT)
done = subprocess.run([*xvfb_run(379), "pvpython", "interaction.py"], env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}, capture_output=True,
                      text=True, timeout=200)
assert done.returncode == 0 and "as it should be" in done.stdout, (done.stdout[-3000:], done.stderr[-5000:])
print(done.stdout)
