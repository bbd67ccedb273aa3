# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphDrape from Python: every property set and read, and a picture on a sphere.
import anamorph
from conformance import Source, picture, pixels, steps_of, time_of
from vtkmodules.vtkCommonDataModel import vtkImageData

drape = anamorph.vtkAnamorphDrape()
for name, value in [("Surface", drape.TORUS), ("Angle", 90.5), ("Radius", 0.4), ("Tube", 0.1), ("Amplitude", 0.2),
                    ("Wavelength", 0.3), ("Phase", 0.4), ("Direction", 30), ("Turn", 0.7), ("ViewSize", (30, 20)),
                    ("CameraPosition", (1, 2, 3)), ("CameraFocalPoint", (0, 1, 0)), ("CameraViewUp", (0, 1, 1)),
                    ("CameraParallelProjection", True), ("CameraParallelScale", 0.8), ("CameraViewAngle", 50),
                    ("Tolerance", 0.5), ("Filter", drape.BICUBIC), ("Background", (0.1, 0.2, 0.3, 1)),
                    ("Style", drape.DEPTH), ("Scheme", drape.OKA_Z), ("Block", 4), ("Overlap", 1), ("Machine", "oka-1987:block=4"), ("BlendWeights", (0, 0, 0.5, 0, 0, 0, 0, 0, 0.1)), ("HeightScale", 0.3),
                    ("HeightSmooth", 2), ("DeformationFileName", "bumps.csv"),
                    ("FormulaX", "u"), ("FormulaY", "v"), ("FormulaZ", "u*v*k"), ("FormulaDefinitions", "k=2"), ("Frame", 3),
                    ("PositionsArrayName", "place"), ("HeightArrayName", "height"), ("Shading", drape.PHONG),
                    ("NumberOfLights", 2), ("Ambient", 0.3), ("Diffuse", 0.4), ("Specular", 0.5), ("Shininess", 6)]:
    getattr(drape, "Set" + name)(value)
    assert getattr(drape, "Get" + name)() == value, name
assert "torus" in str(drape)
drape.SetLight(1, 1, 2, 3)
assert drape.GetLight(1) == (1, 2, 3) and drape.GetLight(0) == (0, 0, 1)

image = vtkImageData()
image.SetDimensions(8, 8, 1)
image.AllocateScalars(3, 3)  # unsigned char
for c, value in enumerate((200, 100, 50)):
    image.GetPointData().GetScalars().FillComponent(c, value)
drape = anamorph.vtkAnamorphDrape()
drape.SetInputData(image)
drape.SetSurface(drape.SPHERE)
drape.SetAngle(360)
drape.SetViewSize(41, 31)
drape.Update()
seen = drape.GetOutput()
assert seen.GetDimensions() == (41, 31, 1)
assert [seen.GetScalarComponentAsDouble(20, 15, 0, c) for c in range(3)] == [200, 100, 50]
assert seen.GetScalarComponentAsDouble(0, 0, 0, 0) == 0
assert 0 < drape.GetMaxError() <= drape.GetTolerance()

# A height that varies in time moves the surface, where the texture does not vary.
heights = Source(lambda time: picture((1 + time) / 500), (0.0, 1.0, 2.0))
drape = anamorph.vtkAnamorphDrape()
drape.SetInputData(picture(1))
drape.SetInputConnection(2, heights.GetOutputPort())
drape.SetHeightScale(0.5)
drape.SetViewSize(41, 31)
drape.SetStyle(drape.DEPTH)
assert steps_of(drape) == [0, 1, 2]
depths = []
for time in (0.0, 2.0, 1.0):
    drape.UpdateTimeStep(time)
    assert time_of(drape.GetOutput()) == time
    depths.append(pixels(drape.GetOutput())[15, 20, 0])
assert depths[0] > depths[2] > depths[1] > 0 and [asked[0] for asked in heights.asked] == [0, 2, 1], (depths, heights.asked)
