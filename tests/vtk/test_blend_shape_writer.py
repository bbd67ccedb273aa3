# SPDX-License-Identifier: Apache-2.0
"""vtkAnamorphBlendShapeWriter: its files read back by json and struct alone, as glTF 2.0 says, and by vtkAnamorphBlendShapeReader: points, normals,
names, weights over time in steps, lines and splines; several parts, grids, tables of keys; what is wrong is named."""
import json
import os
import struct
import tempfile

import anamorph
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkMultiBlockDataSet, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

os.environ.pop("DISPLAY", None)
SEED = 20261129
print("seed", SEED)
random = np.random.default_rng(SEED)
folder = tempfile.mkdtemp()
FACES = [[0, 1, 2], [0, 2, 3], [0, 3, 4]]
NAMES = ["base", "smile \"\\ ü", "frown"]
KEYS = [(0.0, 1, 0.25), (0.0, 2, 0.5), (0.5, 1, -0.5), (2.0, 2, 1.5), (3.0, 1, 1.0), (3.0, 0, 7.0)]
TIMES, FRAMES = [0, 0.5, 2, 3], np.array([[0.25, 0.5], [-0.5, 0], [0, 1.5], [1, 0]])


def surface(points, normals=None, texture=None):
    data, cells, at = vtkPolyData(), vtkCellArray(), vtkPoints()
    at.SetData(numpy_to_vtk(points, deep=True))
    data.SetPoints(at)
    for face in FACES:
        cells.InsertNextCell(len(face))
        for point in face:
            cells.InsertCellPoint(point)
    data.SetPolys(cells)
    if normals is not None:
        data.GetPointData().SetNormals(numpy_to_vtk(normals, deep=True))
    if texture is not None:
        data.GetPointData().SetTCoords(numpy_to_vtk(texture, deep=True))
    return data


def blocks(shapes, names=NAMES):
    data = vtkMultiBlockDataSet()
    for i, shape in enumerate(shapes):
        data.SetBlock(i, shape)
        data.GetMetaData(i).Set(data.NAME(), names[i])
    return data


def written(name, data, prepare=lambda writer: None):
    writer = anamorph.vtkAnamorphBlendShapeWriter()
    for one in data if isinstance(data, list) else [data]:
        writer.AddInputData(one)
    writer.SetFileName(os.path.join(folder, name))
    prepare(writer)
    assert writer.Write() == 1, name
    return writer


def document(path):
    """A file's JSON, and what its accessors hold."""
    with open(path, "rb") as file:
        data = file.read()
    if data[:4] == b"glTF":
        version, size, length = struct.unpack("<III", data[4:16])
        assert version == 2 and size == len(data) and data[16:20] == b"JSON"
        top, rest = json.loads(data[20:20 + length]), data[20 + length:]
        assert rest[4:8] == b"BIN\0" and struct.unpack("<I", rest[:4])[0] == len(rest) - 8
        binary = rest[8:]
    else:
        top = json.loads(data)
        with open(os.path.join(folder, top["buffers"][0]["uri"]), "rb") as file:
            binary = file.read()
    assert top["buffers"][0]["byteLength"] <= len(binary) and top["asset"]["version"] == "2.0"

    def held(index):
        accessor = top["accessors"][index]
        view = top["bufferViews"][accessor["bufferView"]]
        kind = {5126: "<f4", 5123: "<u2", 5125: "<u4"}[accessor["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[accessor["type"]]
        array = np.frombuffer(binary, kind, accessor["count"] * width, view["byteOffset"]).reshape(-1, width)
        if "min" in accessor:
            assert accessor["min"] == array.min(0).tolist() and accessor["max"] == array.max(0).tolist()
        return array

    return top, held


def reader_of(name):
    reader = anamorph.vtkAnamorphBlendShapeReader()
    reader.AddFileName(os.path.join(folder, name))
    reader.Update()
    return reader


def leaf(data):
    while data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    return data


def points(data):
    return vtk_to_numpy(leaf(data).GetPoints().GetData())


def names_of(reader):
    names = reader.GetShapeNames()
    return [names.GetValue(i) for i in range(names.GetNumberOfValues())]


# Points and normals whose offsets are exact in float come back to the bit; a document is as glTF says.
shapes = [(random.integers(-2000, 2000, (5, 3)) / 1024).astype(np.float32) for _ in range(3)]
normals = [(random.integers(-1000, 1000, (5, 3)) / 1024).astype(np.float32) for _ in range(3)]
texture = (random.integers(0, 1024, (5, 2)) / 1024).astype(np.float32)
exact = blocks([surface(p, n, texture) for p, n in zip(shapes, normals)])
for name in ("exact.glb", "exact.gltf"):
    writer = written(name, exact)
    assert writer.GetMaxError() == 0
    top, held = document(os.path.join(folder, name))
    (mesh,), (node,) = top["meshes"], top["nodes"]
    assert mesh["extras"]["targetNames"] == NAMES[1:] and node["mesh"] == 0 and top["scenes"][top["scene"]]["nodes"] == [0]
    (primitive,) = mesh["primitives"]
    assert held(primitive["indices"]).ravel().tolist() == sum(FACES, []) and len(primitive["targets"]) == 2
    for kind, wanted in (("POSITION", shapes), ("NORMAL", normals)):
        base = held(primitive["attributes"][kind])
        assert np.array_equal(base, wanted[0])
        for target, shape in zip(primitive["targets"], wanted[1:]):
            assert np.array_equal(base + held(target[kind]), shape)
    assert np.array_equal(held(primitive["attributes"]["TEXCOORD_0"]), texture * [1, -1] + [0, 1])
    reader = reader_of(name)
    assert names_of(reader) == NAMES[1:]
    for i, shape in enumerate(shapes):
        data = leaf(reader.GetOutputDataObject(1).GetBlock(i))
        assert np.array_equal(points(data), shape) and points(data).dtype == np.float32
        assert np.array_equal(vtk_to_numpy(data.GetPointData().GetNormals()), normals[i])
        assert np.array_equal(vtk_to_numpy(data.GetPointData().GetTCoords()), texture)
        assert data.GetNumberOfCells() == 3

# Any doubles: what float makes of them, and no more than the error that the writer tells; a shape near 0 is what costs.
for scale in (1e-30, 1, 1e6):
    wide = [scale * random.normal(size=(5, 3)) for _ in range(3)]
    wide[2][0] *= 1e-9
    writer = written("wide.glb", [surface(p) for p in wide], lambda w: [w.SetShapeName(i, f"s{i}") for i in range(3)])
    reader = reader_of("wide.glb")
    assert names_of(reader) == ["s1", "s2"]
    off = max(np.linalg.norm(points(reader.GetOutputDataObject(1).GetBlock(i)) - wide[i], axis=1).max() for i in range(3))
    assert abs(off / writer.GetMaxError() - 1) < 1e-12 and 0 < off < 4e-7 * scale * 3, (scale, off, writer.GetMaxError())


# Weights over time, by each interpolation of vtkAnamorphInbetween, which the reader's animation is to follow.
for interpolation in range(4):
    def prepare(writer):
        for key in KEYS:
            writer.AddKey(*key)
        writer.SetInterpolation(interpolation)

    written("moving.glb", exact, prepare)
    top, held = document(os.path.join(folder, "moving.glb"))
    (sampler,) = top["animations"][0]["samplers"]
    assert held(sampler["input"]).ravel().tolist() == TIMES
    assert sampler["interpolation"] == ("STEP", "LINEAR", "CUBICSPLINE", "CUBICSPLINE")[interpolation]
    values = held(sampler["output"]).reshape(4, -1, 2)
    assert np.array_equal(values[:, values.shape[1] // 2], FRAMES.astype(np.float32))
    assert top["meshes"][0]["weights"] == FRAMES[0].tolist()
    blend = anamorph.vtkAnamorphInbetween()
    blend.SetModeToDeltas()
    blend.SetInterpolation(interpolation)
    for i in range(3):
        blend.AddInputDataObject(exact.GetBlock(i))
    for key in KEYS:
        blend.AddKey(*key)
    reader = reader_of("moving.glb")
    reader.UpdateInformation()
    assert list(reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS())) == TIMES
    for time in (-1, 0.0, 0.2, 0.5, 1.1, 1.9, 2.0, 2.6, 3.0, 5):
        blend.UpdateTimeStep(time)
        reader.UpdateTimeStep(time)
        off = np.abs(points(reader.GetOutputDataObject(0)) - points(blend.GetOutputDataObject(0))).max()
        assert off < 2e-5, (interpolation, time, off)

    # What the reader has is written again: the same shapes, and its weights at its times.
    again = anamorph.vtkAnamorphBlendShapeWriter()
    again.SetInputConnection(reader.GetOutputPort(1))
    again.SetFileName(os.path.join(folder, "again.glb"))
    again.SetInterpolation(interpolation)
    assert again.Write() == 1
    second, held_again = document(os.path.join(folder, "again.glb"))
    assert second["meshes"][0]["extras"] == top["meshes"][0]["extras"]
    (sampler_again,) = second["animations"][0]["samplers"]
    assert np.array_equal(held_again(sampler_again["input"]), held(sampler["input"]))
    assert np.abs(held_again(sampler_again["output"]) - held(sampler["output"])).max() < 2e-5
    assert np.array_equal(points(reader_of("again.glb").GetOutputDataObject(1).GetBlock(2)), shapes[2])

# The weights that stand still are those of the data.
still = blocks([surface(p) for p in shapes])
numbers = numpy_to_vtk(np.array([0.125, -2.0]))
numbers.SetName("anamorph:weights")
still.GetFieldData().AddArray(numbers)
written("still.gltf", still)
assert document(os.path.join(folder, "still.gltf"))[0]["meshes"][0]["weights"] == [0.125, -2.0]

# Several parts are primitives of one mesh, that one weight moves; lines stay lines.
line = vtkPolyData()
line.DeepCopy(surface(shapes[0]))
line.SetPolys(vtkCellArray())
lines = vtkCellArray()
lines.InsertNextCell(4)
for point in (0, 1, 2, 4):
    lines.InsertCellPoint(point)
line.SetLines(lines)
other = vtkPolyData()
other.DeepCopy(line)
moved = vtkPoints()
moved.SetData(numpy_to_vtk(shapes[1], deep=True))
other.SetPoints(moved)
pair = blocks([blocks([surface(shapes[0]), line], ["skin", "hair"]), blocks([surface(shapes[2]), other], ["skin", "hair"])])
written("pair.glb", pair)
top, held = document(os.path.join(folder, "pair.glb"))
skin, hair = top["meshes"][0]["primitives"]
assert (skin["mode"], hair["mode"]) == (4, 1) and hair["extras"]["name"] == "hair"
assert held(hair["indices"]).ravel().tolist() == [0, 1, 1, 2, 2, 4]
assert np.array_equal(held(hair["attributes"]["POSITION"]) + held(hair["targets"][0]["POSITION"]), shapes[1])
reader = reader_of("pair.glb")
assert names_of(reader) == NAMES[1:2] and reader.GetOutputDataObject(1).GetBlock(1).GetNumberOfBlocks() == 2

# A grid's surface: the same of its points in all shapes.
image = vtkImageData()
image.SetDimensions(3, 4, 2)
grown = vtkImageData()
grown.SetDimensions(3, 4, 2)
grown.SetSpacing(2, 1, 0.5)
written("grid.glb", [image, grown])
reader = reader_of("grid.glb")
base, shape = (points(reader.GetOutputDataObject(1).GetBlock(i)) for i in range(2))
assert len(base) == 24 and np.array_equal(base * [2, 1, 0.5], shape)
assert leaf(reader.GetOutputDataObject(1).GetBlock(0)).GetNumberOfCells() == 2 * 2 * (2 * 3 + 2 * 1 + 3 * 1)

# What is wrong is named, and no file appears.
holes = np.array(shapes[1])
holes[3, 1] = np.nan
short = surface(shapes[1])
short.SetPoints(vtkPoints())
cases = [
    (exact, dict(SetFileName=("",)), "FileName"),
    (exact, dict(SetFileName=(os.path.join(folder, "bad.obj"),)), "must end in .glb or .gltf"),
    (exact, dict(SetFileName=("/no/such/folder/bad.glb",)), "cannot be written"),
    (exact, dict(AddKey=(-1.0, 1, 0.5)), "at least 0"),
    (exact, dict(AddKey=(float("nan"), 1, 0.5)), "Keys[0].Time=nan"),
    (exact, dict(AddKey=(1.0, 3, 0.5)), "Keys[0].Shape=3"),
    (exact, dict(SetKeyNumbers=(0, 1.0, 1.5, 0.5)), "Keys[0].Shape=1.5"),
    (exact, dict(AddKey=(1.0, 1, float("inf"))), "inf"),
    (exact, dict(AddKey=(1.0, 1, 1e39)), "1e+39"),
    ([surface(shapes[0]), surface(holes)], {}, "at point 3"),
    ([surface(shapes[0]), surface(1e39 * np.ones((5, 3)))], {}, "1e+39"),
    ([surface(shapes[0]), short], {}, "0 points"),
    ([surface(shapes[0]), blocks([surface(shapes[0]), surface(shapes[0])])], {}, "2 blocks"),
    (vtkMultiBlockDataSet(), {}, "no points"),
    ([vtkPolyData()], {}, "no points"),
]
for data, calls, words in cases:
    writer, told = anamorph.vtkAnamorphBlendShapeWriter(), []
    for one in data if isinstance(data, list) else [data]:
        writer.AddInputData(one)
    bad = os.path.join(folder, "bad.glb")
    writer.SetFileName(bad)
    for call, arguments in calls.items():
        getattr(writer, call)(*arguments)

    def tell(caller, event, text):
        told.append(text)
    tell.CallDataType = 13  # VTK_STRING
    writer.AddObserver("ErrorEvent", tell)
    writer.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    writer.Write()
    assert told and words in told[0] and writer.GetErrorCode() != 0 and not os.path.exists(bad), (words, told)
    assert len(told[0].split("): ", 1)[-1]) <= 420, told

# Setting what is set already changes nothing.
writer = anamorph.vtkAnamorphBlendShapeWriter()
writer.AddKey(1, 2, 3)
writer.SetShapeName(1, "a")
before = writer.GetMTime()
writer.SetKeyNumbers(0, 1, 2, 3)
writer.SetShapeName(1, "a")
writer.SetInterpolation(1)
assert writer.GetMTime() == before and writer.GetShapeName(1) == "a" and writer.GetShapeName(9) == "" and "1, 2, 3" in str(writer)
print("as it should be")
