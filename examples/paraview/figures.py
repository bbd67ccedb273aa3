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

from paraview import servermanager, simple
from paraview.simple import (ColorBy, CompositeKeyFrame, CreateRenderView, GetAnimationScene, GetAnimationTrack, LoadPlugin,
                             OpenDataFile, Render, SaveScreenshot, SaveState, Show)

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
simple._DisableFirstRenderCameraReset()  # as the traces of ParaView begin: the camera is the script's
view = CreateRenderView()
view.ViewSize = [600, 600]
view.Background = [1, 1, 1]
view.UseColorPaletteForBackground = 0
view.OrientationAxesVisibility = 0
# NUDES shows a window of 1000 x 1000 units, without perspective, about the place and turned as the script's `place` and
# `observe` say: the field data of its figures.
view.CameraParallelProjection = 1
FAR = 3e4  # units from the place to the camera: before all that is seen
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
times = list(figures.TimestepValues) or [0]


def seen_at(time):
    """Where the camera is, what it looks at and what is up."""
    figures.UpdatePipeline(time)
    field = servermanager.Fetch(figures).GetFieldData()
    place, rotation = (field.GetArray(name).GetTuple(0) for name in ("ViewCenter", "ViewRotation"))
    up, away = rotation[3:6], rotation[6:]
    return [p - FAR * a for p, a in zip(place, away)], list(place), list(up)


def animate(proxy, name, vectors):
    """Gives a property of three numbers a vector for each of the times, where they are not all the same."""
    for i in range(3 if any(vector != vectors[0] for vector in vectors) else 0):
        keys = [CompositeKeyFrame(KeyTime=(time - times[0]) / (times[-1] - times[0]), KeyValues=[vector[i]])
                for time, vector in zip(times, vectors)]
        GetAnimationTrack(name, index=i, proxy=proxy).KeyFrames = keys
        for key in keys:  # a state has what is registered, and nothing else
            servermanager.ProxyManager().RegisterProxy("animation", f"{name} {i} {key.KeyTime}", key.SMProxy)


views = [seen_at(time) for time in times]
shown_frame = len(times) // 2
for k, name in enumerate(("CameraPosition", "CameraFocalPoint", "CameraViewUp")):
    animate(view, name, [view_then[k] for view_then in views])

# As fine as the pixels of that view need. (The representation "Surfaces of Ellipsoids" of the figures would follow the camera
# instead.)
surfaces = simple.AnamorphFigureGeometry(Input=figures, ToleranceMode="Pixels", Tolerance=0.25, ViewSize=[600, 600])
shown = Show(surfaces, view)
ColorBy(shown, ("CELLS", "Color"))
shown.MapScalars = 0

# Towards the observer by more than any body is deep, so that lines lie before the surfaces that they belong to.
outlines = simple.AnamorphFigureOutline(Input=figures, ViewSize=[600, 600])
lines = Show(outlines, view)
ColorBy(lines, None)
lines.AmbientColor = lines.DiffuseColor = [0, 0, 0]
lines.LineWidth = 2
nearer = [[(p - f) / 2 for p, f in zip(position, place)] for position, place, _ in views]
# ParaView 6 calls it the translation.
translation = "Translation" if "Translation" in lines.ListProperties() else "Position"
setattr(lines, translation, nearer[shown_frame])
animate(lines, translation, nearer)

scene.AnimationTime = times[shown_frame]
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = views[shown_frame]
view.CameraParallelScale = 500
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
