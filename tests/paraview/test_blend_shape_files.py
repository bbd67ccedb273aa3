# SPDX-License-Identifier: Apache-2.0
# host: pvpython
"""Blend shapes out of ParaView: Save Data writes grouped surfaces as morph targets, with keys, which open again as the same shapes; and a blended
surface over time as a series of .vtp files, whose points are those of every step to the bit."""
import glob
import os

import numpy as np
from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy

simple.LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())


def points(source, port=0):
    data = servermanager.Fetch(simple.OutputPort(source, port))
    while data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    return vtk_to_numpy(data.GetPoints().GetData())


ball = simple.Sphere(registrationName="ball", ThetaResolution=12, PhiResolution=9)
ball.UpdatePipeline()
shapes = [ball]
for name, scale in (("wide", [2, 1, 1]), ("tall", [1, 1, 1.5])):
    shape = simple.Transform(registrationName=name, Input=ball)
    shape.Transform.Scale = scale
    shapes.append(shape)
group = simple.GroupDatasets(Input=shapes)
group.BlockNames = ["base", "wide", "tall"]
keys = [0, 1, 0.0, 1, 1, 1.0, 1, 2, 0.5, 2, 2, 1.0]

# As glTF and back.
for name in ("shapes.glb", "shapes.gltf"):
    simple.SaveData(name, proxy=group, Keys=keys)
    reader = AnamorphBlendShapeReader(FileName=[name])
    reader.UpdatePipeline()
    told = servermanager.Fetch(reader).GetFieldData().GetAbstractArray("anamorph:shapes")
    assert [told.GetValue(i) for i in range(2)] == ["wide", "tall"]
    assert list(reader.TimestepValues) == [0, 1, 2], reader.TimestepValues
    for i, shape in enumerate(shapes):
        block = simple.ExtractBlock(Input=simple.OutputPort(reader, 1), Selectors=["/Root/" + ("base", "wide", "tall")[i]])
        off = np.abs(points(block) - points(shape)).max()
        assert off < 1e-7, (name, i, off)

# What Anamorph Inbetween makes of the keys is what the file's animation is.
blend = AnamorphInbetween(Input=shapes, Mode="Base and deltas", Keys=keys)
for time in (0, 0.25, 1, 1.75, 2):
    blend.UpdatePipeline(time)
    reader.UpdatePipeline(time)
    off = np.abs(points(blend) - points(reader)).max()
    assert off < 1e-6, (time, off)

# A shape opened from a file, with its weights, is written again.
reader.UpdatePipeline(0)
simple.SaveData("again.glb", proxy=simple.OutputPort(reader, 1))
again = AnamorphBlendShapeReader(FileName=["again.glb"])
again.UpdatePipeline(1)
reader.UpdatePipeline(1)
assert list(again.TimestepValues) == [0, 1, 2] and np.abs(points(again) - points(reader)).max() < 1e-6

# As .vtp, a file for each time step.
blend.UpdatePipeline(0)
simple.SaveData("blended.vtp", proxy=blend, Writetimestepsasfileseries=1, DataMode="Ascii")
files = sorted(glob.glob("blended_*.vtp"))
assert len(files) == 3, files
for time, file in enumerate(files):
    part = simple.XMLPolyDataReader(FileName=[file])
    part.UpdatePipeline()
    blend.UpdatePipeline(time)
    assert np.array_equal(points(part), points(blend)), file
print("as it should be")
