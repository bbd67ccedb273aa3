# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphPanoramaProjection from Python: every property set and read, and a wall painted, without a display.
import os

import anamorph
from vtkmodules.vtkFiltersSources import vtkPlaneSource

os.environ.pop("DISPLAY", None)
projection = anamorph.vtkAnamorphPanoramaProjection()
for name, value in [("Projection", projection.CYLINDRICAL), ("PanoramaWidth", 1000), ("PanoramaHeight", 300),
                    ("FieldOfView", 350.0), ("PanniniDistance", 0.5), ("Lens", "none"), ("Position", (1.0, 2.0, 3.0)),
                    ("Direction", (1.0, 0.0, 0.0)), ("ViewUp", (0.0, 0.0, 1.0)), ("Tolerance", 0.5), ("Occlusion", False)]:
    getattr(projection, "Set" + name)(value)
    assert getattr(projection, "Get" + name)() == value, name
assert "cylindrical" in str(projection)

wall = vtkPlaneSource()
wall.SetCenter(0, 0, -1)
projection = anamorph.vtkAnamorphPanoramaProjection()
projection.SetInputConnection(wall.GetOutputPort())
projection.Update()
painted, rest = projection.GetOutputDataObject(0), projection.GetOutputDataObject(1)
assert painted.GetNumberOfCells() > 100 and rest.GetNumberOfCells() == 0, (painted, rest)
u, v = (painted.GetPointData().GetTCoords().GetRange(c) for c in range(2))
# 53.13 of 360 and of 180 degrees, about the middle.
assert abs(u[0] - (0.5 - 0.0737918)) < 1e-6 and abs(v[1] - (0.5 + 0.1475836)) < 1e-6, (u, v)
assert painted.GetFieldData().GetArray("anamorph:max_error").GetValue(0) <= 0.125
