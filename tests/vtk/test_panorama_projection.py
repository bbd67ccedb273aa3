# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphPanoramaProjection from Python: every property set and read, and a wall painted, without a display.
import os

import anamorph
from conformance import Source, steps_of, time_of
from conformance import wall as wall_at
from vtkmodules.vtkFiltersSources import vtkPlaneSource

os.environ.pop("DISPLAY", None)
projection = anamorph.vtkAnamorphPanoramaProjection()
for name, value in [("Projection", projection.CYLINDRICAL), ("PanoramaWidth", 1000), ("PanoramaHeight", 300),
                    ("FieldOfView", 350.0), ("PanniniDistance", 0.5), ("ProjectionAlpha", 0.25), ("VerticalFieldOfView", 70.0), ("Lens", "none"), ("Position", (1.0, 2.0, 3.0)),
                    ("Direction", (1.0, 0.0, 0.0)), ("ViewUp", (0.0, 0.0, 1.0)), ("Tolerance", 0.5), ("Occlusion", False),
                    ("Picture", "a.png"), ("TimeBudget", 0.5)]:
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

# What hides others may vary in time, where the scene does not.
occluders = Source(lambda time: wall_at(-0.5, half=0.05 + time / 20), (0.0, 1.0, 2.0))
projection = anamorph.vtkAnamorphPanoramaProjection()
projection.SetInputConnection(wall.GetOutputPort())
projection.SetInputConnection(1, occluders.GetOutputPort())
assert steps_of(projection) == [0, 1, 2]
left = []
for time in (0.0, 2.0, 1.0):
    projection.UpdateTimeStep(time)
    assert [time_of(projection.GetOutputDataObject(port)) for port in (0, 1)] == [time, time]
    left.append(projection.GetOutputDataObject(1).GetNumberOfCells())
assert 0 < left[0] < left[2] < left[1] and [asked[0] for asked in occluders.asked] == [0, 2, 1], (left, occluders.asked)
