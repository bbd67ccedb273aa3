# SPDX-License-Identifier: Apache-2.0
"""In ParaView's window the representation Panorama has a widget for its projector: the mouse drags the position, and turns the direction, and
what is thrown follows. A magenta slide is thrown along x onto a board, which is seen from above."""
import math
import time

import numpy as np
from shown_deform import run

SCRIPT = """
import json, os
from paraview.simple import *
from textures import texture_of
from paraview.vtk.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGWriter
import numpy as np
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())
image, writer = vtkImageData(), vtkPNGWriter()
image.SetDimensions(64, 64, 1)
image.GetPointData().SetScalars(numpy_to_vtk(np.tile(np.array([[250, 0, 250]], np.uint8), (64 * 64, 1)), deep=1))
writer.SetFileName({folder!r} + "/slide.png")
writer.SetInputData(image)
writer.Write()
board = Plane(Origin=[-3, -2, 0], Point1=[3, -2, 0], Point2=[-3, 2, 0])
board.UpdatePipeline()
view = GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground, view.Background, view.OrientationAxesVisibility = 0, [0, 1, 0], 0
shown = Show(board, view)
shown.SetRepresentationType("Panorama")
shown.Ambient, shown.Diffuse, shown.Specular = 1, 0, 0
shown.AmbientColor = shown.DiffuseColor = [1, 1, 1]
shown.Panorama, shown.PanoramaProjection, shown.PanoramaFieldOfView = texture_of({folder!r} + "/slide.png"), "Rectilinear", 30
shown.ProjectorPosition, shown.ProjectorDirection, shown.HideUnpainted = [0, 0, .5], [1, 0, -.5], 1
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, 0, 9], [0, 0, 0], [0, 1, 0]
view.CameraParallelProjection, view.CameraParallelScale = 1, 2.2
SetActiveSource(board)
Render(view)
told = [None]


def tell(*_):
    size = list(view.GetRenderWindow().GetSize())
    now = json.dumps({{"size": size, "pixel": 2 * view.GetActiveCamera().GetParallelScale() / size[1],
                      "position": list(shown.ProjectorPosition), "direction": list(shown.ProjectorDirection)}})
    if now != told[0]:
        told[0] = now
        with open({folder!r} + "/state.new", "w") as file:
            file.write(now)
        os.replace({folder!r} + "/state.new", {folder!r} + "/state")


view.GetRenderWindow().AddObserver("EndEvent", tell)
tell()
"""


def slide(position, direction):
    """The corners of the slide on the board, which is at z = 0: a square of 30 degrees, with y up."""
    ahead = np.array(direction) / np.linalg.norm(direction)
    right = np.cross(ahead, (0, 1, 0))
    right /= np.linalg.norm(right)
    rays = [ahead + math.tan(math.radians(15)) * (a * right + b * np.cross(right, ahead)) for a in (-1, 1) for b in (-1, 1)]
    return np.array([(position - ray * (position[2] / ray[2]))[:2] for ray in rays])


def drive(shown):
    def check():
        """That the slide is where the projector throws it; widgets are of other colors."""
        picture, now = shown.screen.picture().astype(int), shown.state()
        rows, columns = ((picture[:, :, 0] > 240) & (picture[:, :, 2] > 240) & (picture[:, :, 1] < 10)).nonzero()
        assert len(rows) > 500, "no slide is seen"
        found = [columns.min() - shown.left, shown.bottom - rows.max() - 1, columns.max() + 1 - shown.left, shown.bottom - rows.min()]
        found = (np.array(found) - [side / 2 for side in now["size"] * 2]) * now["pixel"]
        corners = slide(now["position"], now["direction"])
        wanted = np.concatenate([corners.min(0), corners.max(0)])
        assert np.abs(found - wanted).max() < 3 * now["pixel"], (found, wanted)

    def at(x, y):
        now = shown.state()
        return shown.of_view((now["size"][0] / 2 + x / now["pixel"], now["size"][1] / 2 + y / now["pixel"]))

    def drag(start, end, name):
        before = shown.state()
        shown.screen.drag(at(*start), at(*end))
        shown.wait_for(lambda: shown.state()[name] != before[name])
        time.sleep(3)
        shown.save("projector_" + name)
        check()
        return before, shown.state()

    check()
    # The position is dragged across the direction, in the plane of the widget.
    before, after = drag((0, 0), (-.1, .3), "position")
    moved = np.subtract(after["position"], before["position"])
    assert abs(moved[1] - .3) < 3 * before["pixel"] and abs(moved @ before["direction"]) < 1e-6, moved
    assert np.allclose(after["direction"], before["direction"] / np.linalg.norm(before["direction"])), after
    # The direction is turned by its arrow, as by a trackball.
    x, y, _ = after["position"]
    before, after = drag((x + 2.37, y), (x + 2.3, y + .4), "direction")
    assert abs(after["direction"][1]) > .05 and np.allclose(after["position"], before["position"]), (before, after)


run(__file__, 329, drive, script=SCRIPT)
