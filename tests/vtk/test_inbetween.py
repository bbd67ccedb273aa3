# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphInbetween from Python: every property set and read, and a blend.
import anamorph
from vtkmodules.vtkFiltersSources import vtkSphereSource

inbetween = anamorph.vtkAnamorphInbetween()
for name, value in [("Mode", inbetween.DELTAS), ("BaseIndex", 1), ("NormalizeWeights", True),
                    ("Interpolation", inbetween.MONOTONE_CUBIC), ("Normals", inbetween.DROP_NORMALS),
                    ("OutputPointsPrecision", inbetween.DOUBLE_PRECISION), ("NumberOfWeights", 2),
                    ("NumberOfMasks", 2), ("NumberOfKeys", 1)]:
    getattr(inbetween, "Set" + name)(value)
    assert getattr(inbetween, "Get" + name)() == value, name
inbetween.SetMaskArrayName(1, "mouth")
assert inbetween.GetMaskArrayName(1) == "mouth"
inbetween.SetKey(0, 1.5, 1, 2.5)
assert (inbetween.GetKeyTime(0), inbetween.GetKeyInput(0), inbetween.GetKeyWeight(0)) == (1.5, 1, 2.5)
assert "mouth" in str(inbetween)

spheres = [vtkSphereSource(), vtkSphereSource()]
for radius, sphere in zip((1, 2), spheres):
    sphere.SetRadius(radius)
inbetween = anamorph.vtkAnamorphInbetween()
for sphere in spheres:
    inbetween.AddInputConnection(sphere.GetOutputPort())
for index, weight in enumerate((-1, 2)):
    inbetween.SetWeight(index, weight)
inbetween.Update()
bounds = inbetween.GetOutputDataObject(0).GetBounds()
assert abs(bounds[5] - 3) < 1e-6, bounds
