# SPDX-License-Identifier: Apache-2.0
"""What Panorama Projection paints is shown with its picture as soon as it is applied: as eq. 4.1 of Kim 2003 has it, written out
here, on a sphere, a plane and a volume; without a picture lines are shown; on two ranks and on a server the same as on one."""
import os
import subprocess

from display import run_shown, xvfb_run

COMMON = r'''
import os
import sys

import numpy as np
from paraview import simple
from paraview.simple import *
from textures import texture_of
from paraview.vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

SIZE, WIDTH, HEIGHT = 200, 512, 256


def start():
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
    return CreateRenderView(ViewSize=[SIZE, SIZE], OrientationAxesVisibility=0, UseColorPaletteForBackground=0,
                            Background=[0, 0, 0], UseFXAA=0)


def pixels(view, name="view.png"):
    Render(view)
    SaveScreenshot(name, view, ImageResolution=[SIZE, SIZE])
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(SIZE, SIZE, -1)[::-1, :, :3].astype(float)


def from_centre(view):
    Render(view)
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp, view.CameraViewAngle = [0, 0, 0], [0, 0, -1], [0, 1, 0], 90


def plain(shown):
    shown.Ambient, shown.Diffuse, shown.Specular = 1, 0, 0
'''

SCRIPT = COMMON + r'''
def colour(u, v):
    return np.stack([127 + 100 * np.sin(2 * np.pi * u), 127 + 100 * np.cos(2 * np.pi * u), 20 + 200 * v], -1)


y, x = np.mgrid[0:HEIGHT, 0:WIDTH]
image, writer = vtkImageData(), vtkPNGWriter()
image.SetDimensions(WIDTH, HEIGHT, 1)
rows = colour((x + 0.5) / WIDTH, (y + 0.5) / HEIGHT).round().astype(np.uint8)[::-1]
image.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(rows).reshape(-1, 3), deep=True))
writer.SetFileName("painted.png")
writer.SetInputData(image)
writer.Write()
PICTURE = os.path.abspath("painted.png")
view = start()

# From the centre, where projector and camera are, all surfaces look the same: the directions of pixels, looked up.
j, i = np.mgrid[0:SIZE, 0:SIZE]
across, down = (i + 0.5 - SIZE / 2) / (SIZE / 2), (j + 0.5 - SIZE / 2) / (SIZE / 2)
wanted = colour(0.5 + np.arctan2(across, 1) / (2 * np.pi), 0.5 + np.arctan2(down, np.hypot(across, 1)) / np.pi)
for scene in (Sphere(), Wavelet(WholeExtent=[-4, 4, -4, 4, -4, 4])):
    scene.UpdatePipeline()
    projection = simple.AnamorphPanoramaProjection(Input=scene, Picture=PICTURE)
    shown, rest = Show(projection, view), Show(OutputPort(projection, 1), view)
    assert (shown.Representation, rest.Representation) == ("Painted", "Wireframe"), (shown.Representation, rest.Representation)
    assert list(projection.Position) == [0, 0, 0] and projection.GetPropertyValue("UsedTolerance") == 0.125
    plain(shown)
    from_centre(view)
    off = np.abs(pixels(view) - wanted).max()
    assert off <= 2.5, (scene, off)
    # Of its size errors count, not of PanoramaWidth: a quarter of the tolerance at four times the width.
    fine = projection.GetDataInformation().GetNumberOfCells()
    projection.Picture = ""
    projection.PanoramaWidth, projection.PanoramaHeight = WIDTH, HEIGHT
    lines = pixels(view)
    assert projection.GetDataInformation().GetNumberOfCells() == fine
    assert lines.std() > 30 and (lines.sum(-1) > 0).all(), "no lines are shown"
    # A texture that is set is shown instead.
    shown.Texture = texture_of(PICTURE)
    off = np.abs(pixels(view) - wanted).max()
    assert off <= 2.5, (scene, off)
    shown.Texture = None
    assert np.abs(pixels(view) - lines).max() <= 1
    Hide(projection, view)
    Hide(OutputPort(projection, 1), view)

# Of a plane the projector stands before it, whichever way the plane lies, and looks at it.
for normal in ([0, 0, 1], [0, 1, 0], [1, 0, 0]):
    ends = [np.array([3, 4, 5]) + np.roll([1, 0, 0], np.argmax(normal) + k) for k in (1, 2)]
    plane = Plane(Origin=[3, 4, 5], Point1=list(ends[0]), Point2=list(ends[1]))
    plane.UpdatePipeline()
    projection = simple.AnamorphPanoramaProjection(Input=plane, Picture=PICTURE)
    to = sum(ends) / 2 - projection.Position
    assert abs(np.hypot(1, 1) / 2 - np.linalg.norm(to)) < 1e-6 and np.allclose(np.abs(projection.Direction), normal), normal
    assert np.dot(to, projection.Direction) > 0 and np.dot(projection.ViewUp, projection.Direction) == 0
    projection.UpdatePipeline()
    cells = [OutputPort(projection, k).GetDataInformation().GetNumberOfCells() for k in (0, 1)]
    assert cells[0] > 10 and cells[1] == 0, cells

# What is no picture is told, and what was there before is shown no longer.
told = []
projection.SMProxy.GetClientSideObject().AddObserver("ErrorEvent", lambda *_: told.append(1))
for bad in ("missing.png", "painted.py"):
    projection.Picture = os.path.abspath(bad)
    projection.UpdatePipeline()
    assert projection.GetDataInformation().GetNumberOfCells() == 0, bad
assert len(told) >= 2, told
projection.Picture = PICTURE
shown = Show(projection, view)
plain(shown)
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = list(projection.Position), list(sum(ends) / 2), [0, 1, 0]
before = pixels(view)
SaveState(os.path.abspath("painted.pvsm"))
ResetSession()
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
LoadState(os.path.abspath("painted.pvsm"))
GetActiveView().UseFXAA = 0
again = pixels(GetActiveView())
assert np.abs(again - before).max() <= 1 and before.std() > 10, np.abs(again - before).max()
print("as it should be")
'''

RANKS_SCRIPT = COMMON + r'''
if "ANAMORPH_SERVER" in os.environ:
    host, port = os.environ["ANAMORPH_SERVER"].split(":")
    Connect(host, int(port))
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=True, ns=vars(simple))
view = start()
view.RemoteRenderThreshold = 0 if sys.argv[2] == "there" else 1e9
ball = Sphere(ThetaResolution=16, PhiResolution=12)
projection = simple.AnamorphPanoramaProjection(Input=ball, Picture=os.path.abspath("painted.png"))
shown = Show(projection, view)
assert shown.Representation == "Painted", shown.Representation
plain(shown)
from_centre(view)
Render(view)
SaveScreenshot(sys.argv[1] + ".png", view, ImageResolution=[SIZE, SIZE])
'''


def run(*command):
    return run_shown(391, *command).stdout


def bytes_of(name):
    with open(name, "rb") as file:
        return file.read()


for name, text in (("painted.py", SCRIPT), ("ranks.py", RANKS_SCRIPT)):
    with open(name, "w") as file:
        file.write(text)
assert "as it should be" in run("pvpython", "painted.py")
run("pvbatch", "ranks.py", "one", "here")
one = bytes_of("one.png")
run("mpiexec", "--oversubscribe", "-n", "2", "pvbatch", "ranks.py", "two", "here")
assert bytes_of("two.png") == one, "two ranks show something else"
for where in ("there", "here"):
    server = subprocess.Popen([*xvfb_run(396), "mpiexec", "--oversubscribe", "-n", "2", "pvserver", "--server-port=0"],
                              env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}, stdout=subprocess.PIPE, text=True)
    try:
        line = next(line for line in server.stdout if line.startswith("Accepting connection(s): "))
        os.environ["ANAMORPH_SERVER"] = "127.0.0.1:" + line.strip().rsplit(":", 1)[1]
        run("pvpython", "ranks.py", "server_" + where, where)
    finally:
        os.environ.pop("ANAMORPH_SERVER", None)
        server.terminate()
        server.wait(timeout=60)
    assert bytes_of(f"server_{where}.png") == one, where
