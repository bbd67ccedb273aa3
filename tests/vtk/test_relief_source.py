# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphReliefSource from Python: every property set and read, and a relief.
import anamorph
from vtkmodules.vtkCommonDataModel import vtkImageData

relief = anamorph.vtkAnamorphReliefSource()
for name, value in [("FileName", "face.png"), ("Origin", (1, 2, 3)), ("Point1", (2, 2, 3)), ("Point2", (1, 5, 3)),
                    ("KeepAspect", False), ("HeightScale", 2.5), ("HeightOffset", -1.5), ("Component", 2),
                    ("SampleRate", 3), ("Resolution", (4, 5)), ("Smoothing", 1.5), ("GenerateNormals", True),
                    ("OutputPointsPrecision", relief.DOUBLE_PRECISION)]:
    getattr(relief, "Set" + name)(value)
    assert getattr(relief, "Get" + name)() == value, name
assert "face.png" in str(relief)

image = vtkImageData()
image.SetDimensions(5, 4, 1)
image.AllocateScalars(10, 1)  # float
image.GetPointData().GetScalars().FillComponent(0, 0.5)
relief = anamorph.vtkAnamorphReliefSource()
assert relief.GetComponent() == relief.LUMINANCE
relief.SetInputData(image)
relief.SetHeightScale(3)
relief.Update()
dimensions = [0, 0, 0]
relief.GetOutput().GetDimensions(dimensions)
assert dimensions == [5, 4, 1]
assert relief.GetOutput().GetBounds()[4:] == (1.5, 1.5)
