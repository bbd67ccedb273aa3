# SPDX-License-Identifier: Apache-2.0
"""vtkAnamorphSplatReader against the formulas of Gaussian splats, written out here in numpy."""
import os
import tempfile

import anamorph
import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_STRING
from vtkmodules.util.misc import calldata_type

NAMES = ["x", "y", "z", "nx", "ny", "nz", "f_dc_0", "f_dc_1", "f_dc_2", *(f"f_rest_{k}" for k in range(9)), "opacity",
         "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
SEED = 7
print("seed", SEED)
random = np.random.default_rng(SEED)


def head(names, count, types=None, more="", form="binary_little_endian"):
    lines = [f"property {(types or {}).get(name, 'float')} {name}" for name in names]
    return "\n".join(["ply", f"format {form} 1.0", "comment by a test", f"element vertex {count}", *lines]) + "\n" + more + "end_header\n"


def splats(count, names=NAMES, types=None):
    kinds = {"float": "<f4", "double": "<f8", "uchar": "<u1"}
    table = np.zeros(count, [(name, kinds[(types or {}).get(name, "float")]) for name in names])
    for name in names:
        table[name] = random.uniform(0, 200, count) if (types or {}).get(name) == "uchar" else random.normal(0, 2, count)
    return table


def read(text, data, folder):
    path = os.path.join(folder, "splats.ply")
    with open(path, "wb") as file:
        file.write(text.encode() + data)
    reader = anamorph.vtkAnamorphSplatReader()
    told = []

    @calldata_type(VTK_STRING)
    def tell(caller, event, words):
        told.append(words)

    reader.AddObserver("ErrorEvent", tell)
    reader.GetExecutive().AddObserver("ErrorEvent", tell)
    reader.SetFileName(path)
    reader.Update()
    return reader, reader.GetOutput(), "".join(told)


def expect(out, table):
    count = len(table)
    assert out.GetNumberOfPoints() == out.GetNumberOfVerts() == count
    if count == 0:
        return
    columns = {name: table[name].astype(float) for name in table.dtype.names}
    stack = lambda names: np.stack([columns[name] for name in names], 1)
    data = out.GetPointData()
    assert np.array_equal(vtk_to_numpy(out.GetPoints().GetData()), stack("xyz").astype(np.float32))
    axes = np.exp(stack(["scale_0", "scale_1", "scale_2"]))
    assert np.allclose(vtk_to_numpy(data.GetArray("Axes")), axes, rtol=2e-7)
    turns = stack(["rot_0", "rot_1", "rot_2", "rot_3"])
    turns /= np.linalg.norm(turns, axis=1, keepdims=True)
    assert np.allclose(vtk_to_numpy(data.GetArray("Orientation")), turns, atol=2e-7)
    colors = np.full((count, 4), 1.)
    if "f_dc_0" in columns:
        colors[:, :3] = .5 + stack(["f_dc_0", "f_dc_1", "f_dc_2"]) / np.sqrt(4 * np.pi)
    if "opacity" in columns:
        colors[:, 3] = 1 / (1 + np.exp(-columns["opacity"]))
    assert data.GetScalars().GetName() == "Color"
    assert np.abs(vtk_to_numpy(data.GetScalars()) - 255 * np.clip(colors, 0, 1)).max() <= .5 + 1e-9


with tempfile.TemporaryDirectory() as folder:
    # As programs write it, of several blocks; an element behind the vertices; other orders, types and properties.
    for count in (0, 1, 4096, 10001):
        table = splats(count)
        reader, out, told = read(head(NAMES, count), table.tobytes(), folder)
        assert told == "" and reader.CanReadFile(reader.GetFileName()) == 1, told
        expect(out, table)
    mixed = ["tag", *NAMES[::-1]]
    types = {"tag": "uchar", "x": "double", "opacity": "double", "rot_2": "double"}
    table = splats(300, mixed, types)
    reader, out, told = read(head(mixed, 300, types, "element face 1\nproperty list uchar int vertex_indices\n").replace("\n", "\r\n"),
                             table.tobytes() + b"\3" + bytes(12), folder)
    assert told == "", told
    expect(out, table)
    few = [name for name in NAMES if not name.startswith("f_") and name != "opacity"]
    table = splats(50, few)
    expect(read(head(few, 50), table.tobytes(), folder)[1], table)
    # A quaternion of no length, and numbers that are none, make no ellipsoid, which the mapper counts; the others stay.
    table = splats(3)
    for name in ("rot_0", "rot_1", "rot_2", "rot_3"):
        table[name][1] = 0
    table["scale_0"][2] = 1000
    out = read(head(NAMES, 3), table.tobytes(), folder)[1]
    assert np.isnan(vtk_to_numpy(out.GetPointData().GetArray("Orientation"))[1]).all()
    assert np.isinf(vtk_to_numpy(out.GetPointData().GetArray("Axes"))[2, 0])
    # What is no such file says why.
    good, data = head(NAMES, 2), splats(2).tobytes()
    for text, bytes_, words in [
            (good, data[:-1], "ends before its 2 vertices do"), (head(NAMES, 2**31), data, "ends before its 2147483648 vertices do"),
            (head(NAMES, 2**31 + 1), data, "from 0 to 2^31 vertices"), (head(NAMES, -1), data, "from 0 to 2^31 vertices"),
            ("obj\n", b"", "must begin with a line ply"), ("", b"", "must begin with a line ply"),
            (good.replace("end_header\n", ""), b"", "no end_header"), (head(NAMES, 2, form="ascii"), data, "format ascii: must be"),
            (good.replace("rot_3", "rot_4"), data, "has no property rot_3"),
            (good.replace("float x", "int x"), data, "property x: must be float or double, not int"),
            (good.replace("property float nx", "property list uchar int nx"), data, "must be of a plain type"),
            (good.replace("element vertex", "element face"), data, "vertex must be the first"),
            (good.replace("comment by", "remark by"), data, "is not known")]:
        reader, out, told = read(text, bytes_, folder)
        assert words in told and out.GetNumberOfPoints() == 0, (words, told)
        assert len(told) < 1500
        assert reader.CanReadFile(reader.GetFileName()) == (1 if "ends before" in words else 0), words
    reader.SetFileName(os.path.join(folder, "none.ply"))
    reader.Update()
    assert reader.GetOutput().GetNumberOfPoints() == 0 and reader.CanReadFile("none.ply") == 0
    assert "FileName: " in str(reader)
print("splats: all right")
