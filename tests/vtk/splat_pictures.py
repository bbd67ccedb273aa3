# SPDX-License-Identifier: Apache-2.0
"""Gaussian splats drawn as ellipsoids: where a splat is seen, how large, how turned, and in which color."""
import math
import os
import tempfile

import anamorph
import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer, vtkRenderWindow, vtkWindowToImageFilter

NAMES = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
HARMONIC = 1 / (2 * math.sqrt(math.pi))
TURN = math.radians(30)
# Half axes .4, .1 and .1, turned by 30 degrees about z; nearly red, and opaque.
SPLAT = [.2, -.1, 0, .4 / HARMONIC, -.5 / HARMONIC, -.5 / HARMONIC, 40, math.log(.4), math.log(.1), math.log(.1),
         2 * math.cos(TURN / 2), 0, 0, 2 * math.sin(TURN / 2)]
with tempfile.TemporaryDirectory() as folder:
    path = os.path.join(folder, "one.ply")
    with open(path, "wb") as file:
        file.write(("ply\nformat binary_little_endian 1.0\nelement vertex 1\n" +
                    "".join(f"property float {name}\n" for name in NAMES) + "end_header\n").encode() + np.array(SPLAT, "<f4").tobytes())
    reader = anamorph.vtkAnamorphSplatReader()
    reader.SetFileName(path)
    reader.Update()
mapper, actor, renderer, window, grab = (anamorph.vtkAnamorphEllipsoidMapper(), vtkActor(), vtkRenderer(), vtkRenderWindow(),
                                         vtkWindowToImageFilter())
mapper.SetInputConnection(reader.GetOutputPort())
actor.SetMapper(mapper)
actor.GetProperty().LightingOff()
renderer.AddActor(actor)
window.SetSize(200, 200)
window.SetMultiSamples(0)
window.AddRenderer(renderer)
camera = renderer.GetActiveCamera()
camera.ParallelProjectionOn()
camera.SetPosition(0, 0, 5)
camera.SetParallelScale(1)
renderer.ResetCameraClippingRange()
window.Render()
grab.SetInput(window)
grab.Update()
image = grab.GetOutput()
pixels = vtk_to_numpy(image.GetPointData().GetScalars()).reshape(200, 200, -1).astype(int)
y, x = np.mgrid[0:200, 0:200]
x, y = (x + .5) / 100 - 1 - SPLAT[0], (y + .5) / 100 - 1 - SPLAT[1]
along, across = x * math.cos(TURN) + y * math.sin(TURN), y * math.cos(TURN) - x * math.sin(TURN)
inside = (along / .4) ** 2 + (across / .1) ** 2
seen = pixels.sum(2) > 0
edge = abs(inside - 1) < 1e-3  # where rounding decides
assert np.array_equal(seen[~edge], (inside < 1)[~edge]), (seen != (inside < 1)).sum()
assert seen.sum() > 1000
color = pixels[seen]
assert abs(color[:, 0] - .9 * 255).max() <= 1 and color[:, 1:3].max() <= 1, (color.min(0), color.max(0))
print("splat pictures: all right")
