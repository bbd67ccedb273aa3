# SPDX-License-Identifier: Apache-2.0
"""The representation "Panorama" throws a picture onto surfaces as the formulas of Kim 2003, eq. 4.1, have it, written out here;
in every mode, on blocks, with what hides, out of a state file, on two ranks, and on a server."""
import os
import subprocess

from display import run_shown, xvfb_run

SCRIPT = r'''
import os
import sys

import anamorph
import numpy as np
from paraview import simple
from paraview.simple import *
from textures import texture_of
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
shown.Panorama = texture_of("panorama.png")
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


def behind_board():
    """Which pixels show what a board behind the camera hides from the projector, but for those at borders."""
    j, i = np.mgrid[0:SIZE, 0:SIZE]
    way = np.stack([(i + 0.5) * 2 / SIZE - 1, 1 - (j + 0.5) * 2 / SIZE, -np.ones((SIZE, SIZE))], -1)
    ray = way * (2 / np.abs(way).max(-1))[..., None] - POSITION
    on_board = POSITION + ray * ((0.1 - POSITION[2]) / ray[..., 2])[..., None]
    hidden = (np.abs(on_board[..., :2] - POSITION[:2]) < 0.1).all(-1)
    near = [np.roll(hidden, step, axis) for axis in (0, 1) for step in (-1, 1)]
    return hidden, np.all([other == hidden for other in near], 0)


def check_hidden(hidden, inner):
    off, picture = np.abs(pixels(view) - exact()[0]).max(-1), pixels(view)
    assert hidden.sum() > 2000
    assert (picture[hidden & inner] > 250).all() and (off[~hidden & inner] <= 2.0).all()


# The board belongs to the same data; moved and turned with its projector, all is as it was.
Hide(room, view)
board = Plane(Origin=[0.2, -0.3, 0.1], Point1=[0.4, -0.3, 0.1], Point2=[0.2, -0.1, 0.1])
both = GroupDatasets(Input=[room, board])
together = Show(both, view)
white(together)
together.SetRepresentationType("Panorama")
together.Panorama = texture_of("panorama.png")
together.ProjectorPosition, together.ProjectorDirection = list(POSITION), [1, 0, 0]
compare(view, exact())
together.PanoramaOcclusion = 1
check_hidden(*behind_board())
place = "Translation" if "Translation" in together.ListProperties() else "Position"  # before ParaView 5.13
together.SetPropertyWithName(place, [0, 0, 1])
together.ProjectorPosition = list(POSITION + [0, 0, 1])
view.CameraPosition, view.CameraFocalPoint = [0, 0, 1], [0, 0, 0]
check_hidden(*behind_board())
together.SetPropertyWithName(place, [0, 0, 0])
together.ProjectorPosition = list(POSITION)
view.CameraPosition, view.CameraFocalPoint = [0, 0, 0], [0, 0, -1]
board.Origin, board.Point1, board.Point2 = [9, 9, 9], [9.1, 9, 9], [9, 9.1, 9]
compare(view, exact())
board.Origin, board.Point1, board.Point2 = [0.2, -0.3, 0.1], [0.4, -0.3, 0.1], [0.2, -0.1, 0.1]
check_hidden(*behind_board())
together.PanoramaOcclusion = 0
compare(view, exact())
Delete(together)
Delete(both)
Show(room, view)
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
shown.Panorama = texture_of("panorama.png")
shown.ProjectorPosition, shown.ProjectorDirection = list(POSITION), [1, 0, 0]
compare(view, exact())

# Concentric mosaics: three panoramas of the slits of circles, each of other colours, as the camera sees them.
CIRCLES, ROWS, RADIUS, CENTRE = 3, 192, 1.5, np.array([-0.5, 0.2, 0.3])


def slit_colour(k, u, v):
    return np.stack([60 + 70 * k + 40 * np.sin(4 * np.pi * u), 127 + 100 * np.cos(2 * np.pi * u), 20 + 200 * v], -1)


def write_mosaics(name):
    y, x = np.mgrid[0:ROWS, 0:WIDTH]
    stack = np.concatenate([slit_colour(k, (x + 0.5) / WIDTH, (y + 0.5) / ROWS) for k in range(CIRCLES)])
    image, writer = vtkImageData(), vtkPNGWriter()
    image.SetDimensions(WIDTH, CIRCLES * ROWS, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(np.ascontiguousarray(stack.round().astype(np.uint8)[::-1]).reshape(-1, 3), deep=True))
    writer.SetFileName(name)
    writer.SetInputData(image)
    writer.Write()


def of_mosaics(viewer):
    """By the tangents from a point to each circle; right is z, and ahead is x."""
    j, i = np.mgrid[0:SIZE, 0:SIZE]
    way = np.stack([(i + 0.5) * 2 / SIZE - 1, 1 - (j + 0.5) * 2 / SIZE, -np.ones((SIZE, SIZE))], -1)
    world = way * (2 / np.abs(way).max(-1))[..., None]
    ahead, up, right = np.moveaxis(world - CENTRE, -1, 0)
    u_ahead, _, u_right = np.moveaxis(world - viewer, -1, 0)
    length, rho = np.hypot(u_ahead, u_right), np.hypot(ahead, right)
    offset = (right * u_ahead - ahead * u_right) / length
    place = (offset / RADIUS + 1) / 2 * (CIRCLES - 1)
    sum_, all_ = 0, 0
    for k in range(CIRCLES):
        q = RADIUS * (k - 1)
        along, aside = q * q / rho**2, q * np.sqrt(np.maximum(rho**2 - q * q, 0)) / rho**2
        x, z = right - along * right - aside * ahead, ahead - along * ahead + aside * right
        u, v = np.arctan2(x, z) / (2 * np.pi) + 0.5, 0.5 - up / np.hypot(x, z) * WIDTH / (2 * np.pi * ROWS)
        share = np.maximum(0, 1 - np.abs(place - k)) * ((v >= 0) & (v <= 1))
        sum_, all_ = sum_ + share[..., None] * slit_colour(k, u, v), all_ + share
    seen = (np.abs(offset) <= RADIUS) & (rho > RADIUS) & (ahead * u_ahead + right * u_right > 0) & (all_ > 0)
    return np.where(seen[..., None], sum_ / np.maximum(all_, 1e-9)[..., None], 255), seen


write_mosaics("mosaics.png")
Delete(shown)
shown = Show(room, view)
white(shown)
shown.SetRepresentationType("Panorama")
shown.Panorama, shown.PanoramaProjection = texture_of("mosaics.png"), "Cylindrical"
shown.ProjectorPosition, shown.ProjectorDirection = list(CENTRE), [1, 0, 0]
shown.PanoramaCircles, shown.PanoramaCircleRadius = CIRCLES, RADIUS
assert of_mosaics(np.zeros(3))[1].sum() > 20000
compare(view, of_mosaics(np.zeros(3)), 3.0)
shown.PanoramaFollowCamera, shown.PanoramaViewpoint = 0, [-0.9, 0, 1.1]
compare(view, of_mosaics(np.array([-0.9, 0, 1.1])), 3.0)
Delete(shown)

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
                    "HideUnpainted": shader.GetHideUnpainted(), "Occlusion": 0, "ShadowSize": projector.GetShadowSize(),
                    "Circles": projector.GetCircles(), "CircleRadius": projector.GetCircleRadius(),
                    "FollowCamera": projector.GetFollowCamera(), "Viewpoint": projector.GetViewpoint(), "ProjectorPosition": projector.GetPosition(),
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
from textures import texture_of

if "ANAMORPH_SERVER" in os.environ:
    host, port = os.environ["ANAMORPH_SERVER"].split(":")
    Connect(host, int(port))
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=True, ns=vars(simple))
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))
view = CreateRenderView(ViewSize=[200, 200], OrientationAxesVisibility=0, UseFXAA=0)
view.RemoteRenderThreshold = 0 if sys.argv[2] == "there" else 1e9
shown = Show(Sphere(Radius=2, ThetaResolution=64, PhiResolution=48), view)
shown.SetRepresentationType("Panorama")
shown.Panorama, shown.ProjectorPosition = texture_of("panorama.png"), [.3, -.2, .4]
# In light, normals where pieces meet would count.
shown.Ambient, shown.Diffuse, shown.Specular = 1, 0, 0
Render(view)
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp, view.CameraViewAngle = [0, 0, 0], [0, 0, -1], [0, 1, 0], 90
Render(view)
SaveScreenshot(sys.argv[1] + ".png", view, ImageResolution=[200, 200])
# From one end of the ball: the half of the other rank hides this one's.
shown.ProjectorPosition, shown.PanoramaOcclusion, shown.HideUnpainted = [0.1, 9, -2], 1, 1
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, 0, 9], [0, 0, 0], [0, 1, 0]
SaveScreenshot(sys.argv[1] + "_hidden.png", view, ImageResolution=[200, 200])
shown.PanoramaOcclusion = 0
SaveScreenshot(sys.argv[1] + "_all.png", view, ImageResolution=[200, 200])
'''


def run(*command):
    done = run_shown(367, *command, timeout=120)
    assert "ERR" not in done.stderr and "rror" not in done.stderr, done.stderr[-5000:]
    return done.stdout


def bytes_of(name):
    with open(name, "rb") as file:
        return file.read()


for name, text in (("throw.py", SCRIPT), ("ranks.py", RANKS_SCRIPT)):
    with open(name, "w") as file:
        file.write(text)
assert "as it should be" in run("pvpython", "throw.py")
PICTURES = ("", "_hidden", "_all")


def pictures_of(name):
    return [bytes_of(name + more + ".png") for more in PICTURES]


def on_server(ranks, where):
    """With the client drawing, or the server."""
    name = f"server_{where}"
    command = ["pvserver", "--server-port=0"]
    server = subprocess.Popen([*xvfb_run(371), "mpiexec", "--oversubscribe", "-n", str(ranks), *command],
                              env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}, stdout=subprocess.PIPE, text=True)
    try:
        line = next(line for line in server.stdout if line.startswith("Accepting connection(s): "))
        os.environ["ANAMORPH_SERVER"] = "127.0.0.1:" + line.strip().rsplit(":", 1)[1]
        run("pvpython", "ranks.py", name, where)
    finally:
        os.environ.pop("ANAMORPH_SERVER", None)
        server.terminate()
        server.wait(timeout=60)
    return pictures_of(name)


# Two ranks, which have a half of a ball each, show what one does; so do servers.
run("pvbatch", "ranks.py", "one", "here")
one = pictures_of("one")
assert len(set(one)) == 3, "what is hidden shows"
run("mpiexec", "--oversubscribe", "-n", "2", "pvbatch", "ranks.py", "two", "here")
assert pictures_of("two") == one
for where in ("there", "here"):
    assert on_server(2, where) == one, where
