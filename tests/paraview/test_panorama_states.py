# SPDX-License-Identifier: Apache-2.0
"""The states in examples/paraview open from any folder, with their picture where the user says it is, and show it as the formulas
written out here say; saved and opened again they are the same."""
import os
import shutil
import subprocess

from display import xvfb_run

SCRIPT = r'''
import os
import sys

import numpy as np
from paraview import simple
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkJPEGReader, vtkPNGReader

EXAMPLES, WIDTH, HEIGHT = sys.argv[1], 320, 240


def read(reader, name):
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(*image.GetDimensions()[1::-1], -1)[::-1, :, :3].astype(float)


PANORAMA = read(vtkJPEGReader(), EXAMPLES + "/panorama.jpg")


def colour(way):
    """What is seen of the panorama, whose middle is at -z, with y up; bilinear."""
    x, y, z = np.moveaxis(way, -1, 0)
    rows, columns = PANORAMA.shape[:2]
    u = (np.arctan2(x, -z) / (2 * np.pi) + 0.5) * columns - 0.5
    v = np.clip((0.5 - np.arctan2(y, np.hypot(x, z)) / np.pi) * rows - 0.5, 0, rows - 1)
    i, j = np.floor(u).astype(int), np.floor(v).astype(int)
    s, t = (u - i)[..., None], (v - j)[..., None]
    at = lambda a, b: PANORAMA[np.minimum(b, rows - 1), a % columns]
    return (1 - t) * ((1 - s) * at(i, j) + s * at(i + 1, j)) + t * ((1 - s) * at(i, j + 1) + s * at(i + 1, j + 1))


def start(state, **options):
    ResetSession()
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
    LoadState(os.path.abspath(state), **options)
    return GetActiveViewOrCreate("RenderView")


def screenshot(view):
    # Render() would move the camera the first time.
    SaveScreenshot("seen.png", view, ImageResolution=[WIDTH, HEIGHT])
    return read(vtkPNGReader(), "seen.png")


def rays(width, height, angle):
    """Through the middles of pixels, to the right, up and ahead; `angle`: of the height, in degrees."""
    j, i = np.mgrid[0:height, 0:width]
    scale = 2 * np.tan(np.radians(angle / 2)) / height
    return (i + 0.5 - width / 2) * scale, -(j + 0.5 - height / 2) * scale


def check_look_around(view):
    look = FindSource("look around")
    look.UpdatePipeline()
    image = servermanager.Fetch(look)
    size = image.GetDimensions()
    seen = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(size[1], size[0], -1)[::-1, :, :3].astype(float)
    right, up = rays(size[0], size[1], look.ViewAngle)
    assert (look.Yaw, look.Pitch, look.Roll) == (0, 0, 0)
    exact = colour(np.stack([right, up, -np.ones_like(up)], -1))
    assert np.abs(seen - exact).max() <= 1.6, np.abs(seen - exact).max()
    assert screenshot(view).std() > 20


def first_hit(start_, way, centre, radius):
    """Of a ball: how far along the way, infinite where it is missed."""
    from_centre = start_ - centre
    a, b, c = (way * way).sum(-1), (way * from_centre).sum(-1), (from_centre * from_centre).sum(-1) - radius * radius
    root = b * b - a * c
    with np.errstate(invalid="ignore"):
        at = (-b - np.sqrt(root)) / a
    return np.where((root > 0) & (at > 0), at, np.inf)


def check_thrown(view):
    """A room with a ball: the ball hides what is behind it from the projector, not from the camera."""
    low, high = np.array([-4, -1, -4]), np.array([4, 3, 4])
    centre, radius, projector = np.array([1.4, 0.2, -1.2]), 0.7, np.array([0, 0.6, 0])
    eye, at = np.array(view.CameraPosition), np.array(view.CameraFocalPoint)
    ahead = (at - eye) / np.linalg.norm(at - eye)
    right = np.cross(ahead, [0, 1, 0]) / np.linalg.norm(np.cross(ahead, [0, 1, 0]))
    x, y = rays(WIDTH, HEIGHT, view.CameraViewAngle)
    way = ahead + x[..., None] * right + y[..., None] * np.cross(right, ahead)
    with np.errstate(divide="ignore"):
        wall = ((np.where(way > 0, high, low) - eye) / way).min(-1)
    ball = first_hit(eye, way, centre, radius)
    point = eye + way * np.minimum(wall, ball)[..., None]
    hidden = first_hit(projector, point - projector, centre, radius) < 1 - 0.02
    exact = np.where(hidden[..., None], 255, colour(point - projector))
    off = np.abs(screenshot(view) - exact).max(-1)
    assert 0.03 < hidden.mean() < 0.5, hidden.mean()
    # Borders of the shadow are as coarse as its map and as the ball's facets; textures are smoothed where they shrink.
    assert (off > 12).mean() < 0.06, (off > 12).mean()
    assert np.median(off) <= 2, np.median(off)
    inside = hidden & np.roll(hidden, 4, 0) & np.roll(hidden, -4, 0) & np.roll(hidden, 4, 1) & np.roll(hidden, -4, 1)
    assert (off[inside] <= 1).mean() > 0.98, (off[inside] <= 1).mean()


for name, check in (("look_around", check_look_around), ("thrown_panorama", check_thrown)):
    # The picture is asked for: wherever one is, it is looked for in a folder.
    view = start(EXAMPLES + f"/{name}.pvsm", data_directory=EXAMPLES)
    check(view)
    first = screenshot(view)
    SaveState(os.path.abspath(name + "_again.pvsm"))
    view = start(name + "_again.pvsm")
    check(view)
    assert np.abs(screenshot(view) - first).max() <= 1, name
    # Its name is relative: it may lie in the folder where ParaView was started.
    view = start(EXAMPLES + f"/{name}.pvsm")
    check(view)
    assert np.abs(screenshot(view) - first).max() <= 1, name
print("states: as they should be")
'''

examples = os.environ["ANAMORPH_SOURCE_DIR"] + "/examples/paraview"
shutil.copy(examples + "/panorama.jpg", "panorama.jpg")
with open("states.py", "w") as file:
    file.write(SCRIPT)
done = subprocess.run([*xvfb_run(376), "pvpython", "states.py", examples], env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"},
                      capture_output=True, text=True, timeout=250)
assert done.returncode == 0 and "as they should be" in done.stdout, (done.stdout[-3000:], done.stderr[-5000:])
assert "ERR" not in done.stderr, done.stderr[-5000:]
