# SPDX-License-Identifier: Apache-2.0
"""The representation "Panorama" throws a picture onto surfaces as the formulas of Kim 2003, eq. 4.1, have it, written out here;
in every mode, on blocks, out of a state file, and on two ranks."""
import os
import subprocess

from display import xvfb_run

SCRIPT = r'''
import os
import sys

import anamorph
import numpy as np
from paraview import simple
from paraview.simple import *
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

SIZE, WIDTH, HEIGHT = 200, 512, 256
POSITION = np.array([0.3, -0.2, 0.4])
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))


def colour(u, v):
    """Smooth, over the panorama from left to right and from top to bottom, and the same at both ends."""
    return np.stack([127 + 100 * np.sin(2 * np.pi * u), 127 + 100 * np.cos(2 * np.pi * u), 20 + 200 * v], -1)


def write_panorama(name):
    y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
    image, writer = vtkImageData(), vtkPNGWriter()
    image.SetDimensions(WIDTH, HEIGHT, 1)
    rows = colour((x + 0.5) / WIDTH, (y + 0.5) / HEIGHT).round().astype(np.uint8)[::-1]
    image.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(rows).reshape(-1, 3), deep=True))
    writer.SetFileName(name)
    writer.SetInputData(image)
    writer.Write()


def pixels(view):
    Render(view)
    SaveScreenshot("view.png", view, ImageResolution=[SIZE, SIZE])
    reader = vtkPNGReader()
    reader.SetFileName("view.png")
    reader.Update()
    rows = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(SIZE, SIZE, -1)
    return rows[::-1, :, :3].astype(float)


def exact(cylinder_height=None):
    """What a camera at the origin with a view angle of 90 degrees sees of a room of side 4: towards -z, y up."""
    j, i = np.mgrid[0:SIZE, 0:SIZE]
    way = np.stack([(i + 0.5) * 2 / SIZE - 1, 1 - (j + 0.5) * 2 / SIZE, -np.ones((SIZE, SIZE))], -1)
    point = way * (2 / np.abs(way).max(-1))[..., None]
    x, y, z = np.moveaxis(point - POSITION, -1, 0)
    # Turned to the right by 90 degrees: the middle is at x.
    u = np.arctan2(z, x) / (2 * np.pi) + 0.5
    slope = y / np.hypot(x, z)
    v = 0.5 - np.arctan(slope) / np.pi if cylinder_height is None else 0.5 - slope / cylinder_height
    seen = (v >= 0) & (v <= 1)
    return np.where(seen[..., None], colour(u, v), 255), seen


def compare(view, wanted, most=2.0, but=0):
    """Not at borders of what is seen."""
    picture, seen = wanted
    off = np.abs(pixels(view) - picture).max(-1)
    inside = seen & np.roll(seen, 1, 0) & np.roll(seen, -1, 0) & np.roll(seen, 1, 1) & np.roll(seen, -1, 1)
    outside = ~(seen | np.roll(seen, 1, 0) | np.roll(seen, -1, 0) | np.roll(seen, 1, 1) | np.roll(seen, -1, 1))
    wrong = int((off[inside | outside] > most).sum())
    assert wrong <= but, (wrong, but, off[inside | outside].max())


def white(shown):
    shown.Ambient, shown.Diffuse, shown.Specular = 1, 0, 0
    shown.AmbientColor = shown.DiffuseColor = [1, 1, 1]
    shown.ColorArrayName = [None, ""]


write_panorama("panorama.png")
view = CreateRenderView(ViewSize=[SIZE, SIZE], OrientationAxesVisibility=0, UseColorPaletteForBackground=0, Background=[0, 0, 0],
                        UseFXAA=0)
room = Box(XLength=4, YLength=4, ZLength=4)
shown = Show(room, view)
white(shown)
shown.SetRepresentationType("Panorama")
Render(view)  # The first one moves the camera.
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp, view.CameraViewAngle = [0, 0, 0], [0, 0, -1], [0, 1, 0], 90
assert (pixels(view) > 250).all(), "no panorama, no change"
shown.Panorama = CreateTexture("panorama.png")
shown.ProjectorPosition, shown.ProjectorDirection = list(POSITION), [1, 0, 0]
for mode in ("Direct", "Residual", "Multipass"):
    shown.ProjectionMode = mode
    compare(view, exact(), 2.0 if mode != "Multipass" else 4.0)
shown.ProjectionMode = "Direct"
shown.PanoramaProjection = "Cylindrical"
height = 2 * np.pi * HEIGHT / WIDTH
compare(view, exact(height))
shown.HideUnpainted = 1
view.Background = [1, 1, 1]
compare(view, exact(height))
shown.HideUnpainted, shown.PanoramaProjection = 0, "Equirectangular"
SaveState(os.path.abspath("panorama.pvsm"))
# Surfaces as before, and back.
shown.SetRepresentationType("Surface")
assert (pixels(view) > 250).all()
shown.SetRepresentationType("Panorama")
compare(view, exact())
Hide(room, view)
blocks = GroupDatasets(Input=[room])
shown = Show(blocks, view)
white(shown)
shown.SetRepresentationType("Panorama")
shown.Panorama = CreateTexture("panorama.png")
shown.ProjectorPosition, shown.ProjectorDirection = list(POSITION), [1, 0, 0]
compare(view, exact())
Disconnect()
Connect()
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
LoadState(os.path.abspath("panorama.pvsm"))
view = GetActiveViewOrCreate("RenderView")
compare(view, exact())

# Defaults of the properties are those of the classes.
proxy = servermanager.ProxyManager().NewProxy("representations", "AnamorphPanoramaRepresentation")
projector, shader = anamorph.vtkAnamorphPanoramaProjector(), anamorph.vtkAnamorphProjectionShader()
for name, value in {"Projection": projector.GetProjection(), "FieldOfView": projector.GetFieldOfView(),
                    "PanniniDistance": projector.GetPanniniDistance(), "ProjectionMode": shader.GetMode(),
                    "HideUnpainted": shader.GetHideUnpainted(), "ProjectorPosition": projector.GetPosition(),
                    "ProjectorDirection": projector.GetDirection(), "ProjectorViewUp": projector.GetViewUp()}.items():
    values = value if isinstance(value, tuple) else (value,)
    assert tuple(proxy.GetProperty(name).GetElement(i) for i in range(len(values))) == values, name
menu = proxy.GetProperty("Projection").FindDomain("vtkSMEnumerationDomain")
assert menu.GetNumberOfEntries() == projector.GetNumberOfProjections()
for i in range(menu.GetNumberOfEntries()):
    projector.SetProjection(i)
    word = menu.GetEntryText(i).lower().replace(" ", "_")
    assert word == projector.GetProjectionName() or word.replace("_", "") == projector.GetProjectionName(), (word, projector.GetProjectionName())
print("panorama: as it should be")
'''

RANKS_SCRIPT = r'''
import os
import sys

from paraview import simple
from paraview.simple import *

LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
view = CreateRenderView(ViewSize=[200, 200], OrientationAxesVisibility=0, UseFXAA=0)
shown = Show(Sphere(Radius=2, ThetaResolution=64, PhiResolution=48), view)
shown.SetRepresentationType("Panorama")
shown.Panorama, shown.ProjectorPosition = CreateTexture("panorama.png"), [.3, -.2, .4]
# In light, normals where pieces meet would count.
shown.Ambient, shown.Diffuse, shown.Specular = 1, 0, 0
Render(view)
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp, view.CameraViewAngle = [0, 0, 0], [0, 0, -1], [0, 1, 0], 90
Render(view)
SaveScreenshot(sys.argv[1], view, ImageResolution=[200, 200])
'''


def run(*command):
    done = subprocess.run([*xvfb_run(367), *command], env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}, capture_output=True,
                          text=True, timeout=120)
    assert done.returncode == 0, (done.returncode, done.stdout[-3000:], done.stderr[-5000:])
    assert "ERR" not in done.stderr and "rror" not in done.stderr, done.stderr[-5000:]
    return done.stdout


def bytes_of(name):
    with open(name, "rb") as file:
        return file.read()


for name, text in (("throw.py", SCRIPT), ("ranks.py", RANKS_SCRIPT)):
    with open(name, "w") as file:
        file.write(text)
assert "as it should be" in run("pvpython", "throw.py")
# Two ranks, which have a half of a ball each, show what one does.
run("pvbatch", "ranks.py", "one.png")
run("mpiexec", "--oversubscribe", "-n", "2", "pvbatch", "ranks.py", "two.png")
assert bytes_of("one.png") == bytes_of("two.png")
