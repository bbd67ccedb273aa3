# SPDX-License-Identifier: Apache-2.0
"""A script of NUDES in ParaView: surfaces in their colors, with outlines over them, as an animation.

    pvbatch figures.py [SCRIPT [FOLDER]]

Writes FOLDER/figures.png (a frame from the middle) and FOLDER/figures.pvsm (the state, for ParaView's File > Load
State). SCRIPT is the walker beside this example by default, FOLDER, which is made, the working folder. The plugin is
found by ParaView itself or through PV_PLUGIN_PATH, or its file is named by ANAMORPH_PLUGIN.
"""
import os
import sys
import tempfile

from paraview.simple import (ColorBy, CreateRenderView, GetAnimationScene, LoadPlugin, OpenDataFile, Render,
                             SaveScreenshot, SaveState, Show)
from paraview import simple

if "ANAMORPH_PLUGIN" in os.environ:
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
here = os.path.dirname(os.path.abspath(__file__))
script = sys.argv[1] if len(sys.argv) > 1 else os.path.join(here, "..", "figures", "walker.nudes")
folder = sys.argv[2] if len(sys.argv) > 2 else "."
os.makedirs(folder, exist_ok=True)

figures = OpenDataFile(os.path.abspath(script))
figures.UpdatePipeline()
if figures.GetDataInformation().GetNumberOfPoints() == 0:
    sys.exit(f"{script}: there are no figures")
view = CreateRenderView()
view.ViewSize = [600, 600]
view.Background = [1, 1, 1]
view.UseColorPaletteForBackground = 0
view.OrientationAxesVisibility = 0
# NUDES shows a window of 1000 x 1000 units, without perspective.
view.CameraParallelProjection = 1
view.CameraParallelScale = 500
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [500, 500, 3000], [500, 500, -500], [0, 1, 0]

surfaces = simple.AnamorphFigureGeometry(Input=figures, Tolerance=0.5)
shown = Show(surfaces, view)
ColorBy(shown, ("CELLS", "Color"))
shown.MapScalars = 0

# Towards the observer by more than any body is deep, so that lines lie before the surfaces that they belong to.
outlines = simple.AnamorphFigureOutline(Input=figures, ViewSize=[600, 600])
lines = Show(outlines, view)
ColorBy(lines, None)
lines.AmbientColor = lines.DiffuseColor = [0, 0, 0]
lines.LineWidth = 2
# ParaView 6 calls it the translation.
setattr(lines, "Translation" if "Translation" in lines.ListProperties() else "Position", [0, 0, 1000])

scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
times = list(figures.TimestepValues)
if times:
    scene.AnimationTime = times[len(times) // 2]
Render(view)
# ParaView does not say what it could not write. Older files stay until there are new ones.
with tempfile.TemporaryDirectory(dir=folder) as new:
    SaveScreenshot(os.path.join(new, "figures.png"), view, ImageResolution=[600, 600])
    SaveState(os.path.join(new, "figures.pvsm"))
    for name in ("figures.png", "figures.pvsm"):
        if not os.path.exists(os.path.join(new, name)) or os.path.getsize(os.path.join(new, name)) == 0:
            sys.exit(f"{os.path.join(folder, name)}: cannot be written")
        os.replace(os.path.join(new, name), os.path.join(folder, name))
print(len(times), "frames;", surfaces.GetDataInformation().GetNumberOfCells(), "triangles")
