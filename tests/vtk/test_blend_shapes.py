# SPDX-License-Identifier: Apache-2.0
"""vtkAnamorphBlendShapeReader against glTF's formulas, written out here in numpy: targets, names, nodes, and animations of weights and places in
steps, lines and splines, from .gltf and .glb; OBJ files; what is wrong is named."""
import base64
import json
import os
import struct
import tempfile

import anamorph
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

os.environ.pop("DISPLAY", None)
SEED = 20240611
print("seed", SEED)
random = np.random.default_rng(SEED)
folder = tempfile.mkdtemp()
BASE = random.normal(size=(5, 3)).astype(np.float32)
NORMALS = random.normal(size=(5, 3)).astype(np.float32)
DELTAS = random.normal(size=(2, 5, 3)).astype(np.float32)
NORMAL_DELTAS = random.normal(size=(2, 5, 3)).astype(np.float32)
FACES = np.array([[0, 1, 2], [0, 2, 3], [0, 3, 4]], np.uint16)
PLACE = [0.5, -1.0, 2.0]
TIMES = np.array([0, 0.5, 2, 3], np.float32)
KEYS = random.uniform(-0.5, 1.5, size=(4, 2)).astype(np.float32)
TANGENTS = random.normal(size=(4, 2, 2)).astype(np.float32)  # into and out of each key


def document(interpolation=None, names=("smile", "frown"), **changes):
    """A file's JSON and its buffer: two nodes have the mesh, the second one stands elsewhere."""
    data, views, accessors = b"", [], []

    def add(array, kind, component):
        nonlocal data
        data += b"\0" * (-len(data) % 4)
        views.append({"buffer": 0, "byteOffset": len(data), "byteLength": array.nbytes})
        data += array.tobytes()
        flat = array.reshape(-1, {"SCALAR": 1, "VEC3": 3}[kind])
        accessors.append({"bufferView": len(views) - 1, "componentType": component, "count": len(flat), "type": kind,
                          "min": flat.min(0).tolist(), "max": flat.max(0).tolist()})
        return len(accessors) - 1

    targets = [{"POSITION": add(d, "VEC3", 5126), "NORMAL": add(n, "VEC3", 5126)} for d, n in zip(DELTAS, NORMAL_DELTAS)]
    primitive = {"attributes": {"POSITION": add(BASE, "VEC3", 5126), "NORMAL": add(NORMALS, "VEC3", 5126)},
                 "indices": add(FACES, "SCALAR", 5123), "mode": 4, "targets": targets}
    mesh = {"name": "face", "primitives": [primitive], "weights": [0.25, 0.5]}
    if names:
        mesh["extras"] = {"targetNames": list(names)}
    top = {"asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}],
           "nodes": [{"name": "head", "mesh": 0, "translation": PLACE, "scale": [2, 2, 2]}], "meshes": [mesh]}
    if interpolation:
        values = KEYS if interpolation != "CUBICSPLINE" else np.stack([TANGENTS[:, 0], KEYS, TANGENTS[:, 1]], 1)
        top["animations"] = [{"samplers": [{"input": add(TIMES, "SCALAR", 5126), "output": add(values, "SCALAR", 5126),
                                           "interpolation": interpolation}],
                             "channels": [{"sampler": 0, "target": {"node": 0, "path": "weights"}}]}]
    top.update(bufferViews=views, accessors=accessors, **changes)
    return top, data


def write(name, top, data):
    path = os.path.join(folder, name)
    if name.endswith(".glb"):
        top["buffers"] = [{"byteLength": len(data)}]
        text = json.dumps(top).encode()
        text += b" " * (-len(text) % 4)
        data += b"\0" * (-len(data) % 4)
        with open(path, "wb") as file:
            file.write(b"glTF" + struct.pack("<II", 2, 28 + len(text) + len(data)) + struct.pack("<I", len(text)) + b"JSON" + text
                       + struct.pack("<I", len(data)) + b"BIN\0" + data)
    else:
        top["buffers"] = [{"byteLength": len(data), "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode()}]
        with open(path, "w") as file:
            json.dump(top, file)
    return path


def expected(weights):
    return 2 * (BASE.astype(float) + np.tensordot(weights, DELTAS.astype(float), 1)) + PLACE


def weights_at(time, interpolation):
    time = min(max(time, TIMES[0]), TIMES[-1])
    k = min(int(np.searchsorted(TIMES, time, "right")) - 1, len(TIMES) - 2)
    step = float(TIMES[k + 1] - TIMES[k])
    t = (time - float(TIMES[k])) / step
    if interpolation == "STEP":
        return KEYS[k + 1 if t >= 1 else k].astype(float)
    if interpolation == "LINEAR":
        return KEYS[k] * (1 - t) + KEYS[k + 1] * t
    return ((2 * t**3 - 3 * t**2 + 1) * KEYS[k] + step * (t**3 - 2 * t**2 + t) * TANGENTS[k, 1]
            + (-2 * t**3 + 3 * t**2) * KEYS[k + 1] + step * (t**3 - t**2) * TANGENTS[k + 1, 0])


def points(data):
    while data.IsA("vtkMultiBlockDataSet"):
        data = data.GetBlock(0)
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float)


def reader_of(*paths):
    reader = anamorph.vtkAnamorphBlendShapeReader()
    for path in paths:
        reader.AddFileName(path)
    return reader


def names_of(reader):
    names = reader.GetShapeNames()
    return [names.GetValue(i) for i in range(names.GetNumberOfValues())]


# The file's own weights, and those that are set; names; the shapes.
for name in ("face.gltf", "face.glb"):
    reader = reader_of(write(name, *document()))
    assert reader.CanReadFile(reader.GetFileName()) == 1
    reader.Update()
    assert names_of(reader) == ["smile", "frown"], names_of(reader)
    assert np.abs(points(reader.GetOutputDataObject(0)) - expected([0.25, 0.5])).max() < 2e-6
    shapes = reader.GetOutputDataObject(1)
    assert [shapes.GetMetaData(i).Get(shapes.NAME()) for i in range(3)] == ["base", "smile", "frown"]
    for i, weights in enumerate(([0, 0], [1, 0], [0, 1])):
        assert np.abs(points(shapes.GetBlock(i)) - expected(weights)).max() < 2e-6, i
    for weights in ([1, 0], [-0.5, 2], [0.75]):
        reader.SetNumberOfWeights(0)
        for i, weight in enumerate(weights):
            reader.SetWeight(i, weight)
        reader.Update()
        assert np.abs(points(reader.GetOutputDataObject(0)) - expected((weights + [0])[:2])).max() < 4e-6, weights
        told = reader.GetOutputDataObject(0).GetFieldData().GetArray("anamorph:weights")
        assert [told.GetValue(i) for i in range(2)] == (weights + [0])[:2]
    assert reader.GetOutputDataObject(0).GetBlock(0).GetNumberOfCells() == 3
reader = reader_of(write("nameless.gltf", *document(names=None)))
reader.Update()
assert names_of(reader) == ["target 0", "target 1"], names_of(reader)

# Over time: at keys, between them, before and after.
for interpolation in ("STEP", "LINEAR", "CUBICSPLINE"):
    reader = reader_of(write(interpolation + ".gltf", *document(interpolation)))
    reader.UpdateInformation()
    steps = list(reader.GetOutputInformation(0).Get(Pipeline.TIME_STEPS()))
    assert steps == [float(t) for t in TIMES], steps
    for time in (0.0, 0.25, 0.5, 1.0, 1.99, 2.5, 3.0, -1.0, 9.0):
        reader.UpdateTimeStep(time)
        off = np.abs(points(reader.GetOutputDataObject(0)) - expected(weights_at(time, interpolation))).max()
        assert off < 2e-5, (interpolation, time, off)
    reader.SetAnimation(-1)
    reader.Update()
    assert np.abs(points(reader.GetOutputDataObject(0)) - expected([0.25, 0.5])).max() < 2e-6

# Two nodes: the targets of each have its name, and leave the other as it is.
top, data = document()
top["nodes"].append({"name": "twin", "mesh": 0, "weights": [0, 1]})
top["scenes"][0]["nodes"] = [0, 1]
reader = reader_of(write("twins.gltf", top, data))
reader.Update()
assert names_of(reader) == ["head/smile", "head/frown", "twin/smile", "twin/frown"], names_of(reader)
twin = vtk_to_numpy(reader.GetOutputDataObject(0).GetBlock(1).GetPoints().GetData()).astype(float)
assert np.abs(points(reader.GetOutputDataObject(0)) - expected([0.25, 0.5])).max() < 2e-6
assert np.abs(twin - (BASE + DELTAS[1])).max() < 2e-6

# OBJ files.
paths = []
for k in range(3):
    paths.append(os.path.join(folder, f"pose{k}.obj"))
    shape = BASE if k == 0 else BASE + DELTAS[k - 1]
    with open(paths[-1], "w") as file:
        file.writelines("v %.9g %.9g %.9g\n" % tuple(p) for p in shape)
        file.writelines("f %d %d %d\n" % tuple(face + 1) for face in FACES)
reader = reader_of(*paths)
reader.SetWeight(1, 0.5)
reader.Update()
assert names_of(reader) == ["pose1", "pose2"], names_of(reader)
assert np.abs(points(reader.GetOutputDataObject(0)) - (BASE + 0.5 * DELTAS[1])).max() < 2e-6

# What is wrong is named.
short = os.path.join(folder, "short.obj")
with open(short, "w") as file:
    file.write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
cut = os.path.join(folder, "cut.glb")
with open(os.path.join(folder, "face.glb"), "rb") as file, open(cut, "wb") as out:
    out.write(file.read()[:40])
bad = os.path.join(folder, "bad.gltf")
with open(bad, "w") as file:
    file.write("{]")
cases = [((), "FileName"), (("/no/such.gltf",), "/no/such.gltf"), ((cut,), "cut"), ((bad,), "bad.gltf"), ((paths[0], short), "blended"),
         ((paths[0], cut), "obj")]
for files, words in cases:
    told = []
    reader = reader_of(*files)
    reader.AddObserver("ErrorEvent", lambda *_: told.append(1))
    reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    assert files and reader.CanReadFile(files[0]) == (files[0].endswith(".obj")) or not files
    reader.Update()
    assert told and reader.GetOutputDataObject(0).GetNumberOfBlocks() == 0, words


def damaged(change):
    top, data = document("LINEAR")
    path = write("damaged.gltf", top, data)
    change(top)
    with open(path, "w") as file:
        json.dump(top, file)
    return path


# What leads out of a document, on which VTK's loader crashes.
for change in (lambda top: top.update(meshes={"a": 1}), lambda top: top["nodes"][0].update(mesh=7),
               lambda top: top["nodes"][0].update(mesh=-3), lambda top: top["nodes"][0].update(children=[9]),
               lambda top: top["accessors"][0].update(count=10**9), lambda top: top["accessors"][0].update(bufferView=99),
               lambda top: top["accessors"][0].update(type="VEC9"), lambda top: top["bufferViews"][0].update(byteLength=10**9),
               lambda top: top["meshes"][0]["primitives"][0]["targets"][0].update(POSITION=99),
               lambda top: top["meshes"][0]["primitives"][0].update(targets=[3]), lambda top: top.update(scene=4),
               lambda top: top["animations"][0]["channels"][0].update(sampler=5),
               lambda top: top["animations"][0]["samplers"][0].update(input=77),
               lambda top: top["animations"][0]["channels"][0]["target"].update(node=5),
               # Buffers that are not there, or not whole.
               lambda top: top["buffers"][0].update(uri="none.bin"), lambda top: top["buffers"][0].update(uri="."),
               lambda top: top["buffers"][0].update(uri=7), lambda top: top["buffers"][0].pop("uri"), lambda top: top["buffers"][0].update(uri=""),
               lambda top: top["buffers"][0].update(uri="data:application/octet-stream;base64,AAAA"),
               lambda top: top["buffers"][0].update(uri="data:"), lambda top: top["buffers"][0].update(uri="data:text/plain," + "A" * 10000),
               lambda top: top["buffers"][0].update(uri="data:application/octet-stream;base64," + "!" * 10000),
               lambda top: top.update(buffers=[])):
    told = []
    reader = reader_of(damaged(change))
    reader.AddObserver("ErrorEvent", lambda *_: told.append(1))
    reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    assert reader.CanReadFile(reader.GetFileName(0)) == 0
    reader.Update()
    assert told and reader.GetOutputDataObject(0).GetNumberOfBlocks() == 0
told = []
reader = reader_of(os.path.join(folder, "face.gltf"))
reader.SetWeight(2, 1)
reader.AddObserver("ErrorEvent", lambda *_: told.append(1))
reader.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
reader.Update()
assert told
print("as it should be")
