# SPDX-License-Identifier: Apache-2.0
"""What is asked of every class of the modules, whichever there are: it prints itself, the same value of any property changes nothing, and without an input it says
so and goes on. And of every one that makes data: a second update makes nothing again, progress rises to 1, inputs stay as they were, field arrays of the first are
handed on, and empty ones do no harm."""
import os

import anamorph
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR, vtkOutputWindow, vtkStringArray, vtkStringOutputWindow
from vtkmodules.vtkCommonDataModel import vtkImageData, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm
from vtkmodules.vtkFiltersCore import vtkFeatureEdges
from vtkmodules.vtkFiltersSources import vtkPlaneSource

SOURCE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "../..")
vtkOutputWindow.SetInstance(vtkStringOutputWindow())  # errors are observed


def image():
    made = vtkImageData()
    made.SetDimensions(32, 16, 1)
    made.AllocateScalars(VTK_UNSIGNED_CHAR, 3)
    values = vtk_to_numpy(made.GetPointData().GetScalars())
    values[:] = (7 * values.reshape(-1, 3).cumsum(axis=0) + 31) % 251
    return made


def plane():
    source = vtkPlaneSource()
    source.SetOrigin(0, 0, 0)
    source.SetPoint1(31, 0, 0)
    source.SetPoint2(0, 15, 0)
    source.SetResolution(6, 5)
    source.Update()
    return source.GetOutput()


def plane_lines():
    edges = vtkFeatureEdges()
    edges.SetInputData(plane())
    edges.Update()
    return edges.GetOutput()


def file_of(name):
    return lambda made: getattr(made, "AddFileName" if "BlendShape" in made.GetClassName() else "SetFileName")(os.path.join(SOURCE, name))


def figures():
    reader = anamorph.vtkAnamorphFigureReader()
    reader.SetFileName(os.path.join(SOURCE, "examples/figures/walker.nudes"))
    reader.Update()
    return reader.GetOutputDataObject(0)


# Of classes that make data: inputs by port, and what else they need.
INPUTS = {
    "BlendShapeReader": ({}, file_of("examples/paraview/expressions.glb")),
    "Deform": ({0: plane}, lambda made: made.AddDeformation(10, 5, 4, 4, 0, 0, 1)),
    "DeformImage": ({0: image}, lambda made: made.AddDeformation(10, 5, 4, 4, 1, 0, 0)),
    "Drape": ({0: image}, None),
    "FigureGeometry": ({0: figures}, None),
    "FigureImage": ({0: figures}, None),
    "FigureOutline": ({0: figures}, None),
    "FigureReader": ({}, file_of("examples/figures/walker.nudes")),
    "FigureSkeleton": ({0: figures}, None),
    "ImageMorph": ({0: image, 1: image, 2: plane_lines, 3: plane_lines}, None),
    "ImageWarp": ({0: image, 1: plane}, None),
    "Inbetween": ({0: plane}, None),
    "NonlinearTexture": ({0: plane}, None),
    "PanoramaProjection": ({0: plane}, lambda made: made.SetPosition(15, 7, 5)),
    "PanoramaView": ({0: image}, None),
    "ProjectionBake": ({0: plane, 1: image}, lambda made: made.AddProjector(15, 7, 5, 0, 0, -1, 0, 1, 0)),
    "ReliefSource": ({0: image}, None),
    "SplatReader": ({}, file_of("examples/paraview/splats.ply")),
}


def check_properties(made):
    str(made)
    for name in dir(made):
        if not name.startswith("Set") or name == "SetProgress" or not hasattr(made, "Get" + name[3:]) or "Shader" in name:
            continue
        try:
            value = getattr(made, "Get" + name[3:])()
            give = lambda: getattr(made, name)(*value) if isinstance(value, tuple) else getattr(made, name)(value)
            give()
        except TypeError:
            continue  # it asks for more, such as the number of a row
        before = made.GetMTime()
        give()
        assert made.GetMTime() == before, (made.GetClassName(), name)


def digest(data):
    arrays = [] if data.IsA("vtkImageData") else [data.GetPoints().GetData()]
    arrays += [data.GetPointData().GetArray(i) for i in range(data.GetPointData().GetNumberOfArrays())]
    return [hash(vtk_to_numpy(array).tobytes()) for array in arrays if array]


def check_data(name, made):
    ports, prepare = INPUTS[name]
    inputs = {port: make() for port, make in ports.items()}
    for port, data in inputs.items():
        made.SetInputDataObject(port, data)
    if inputs:
        note = vtkStringArray()
        note.SetName("note")
        inputs[0].GetFieldData().AddArray(note)
    if prepare:
        prepare(made)
    seen, runs, errors = [], [], []
    made.AddObserver("ProgressEvent", lambda *_: seen.append(made.GetProgress()))
    made.AddObserver("StartEvent", lambda *_: runs.append(1))
    listen = lambda _, __, text: errors.append(text)
    listen.CallDataType = "string0"
    made.AddObserver("ErrorEvent", listen)
    before = [digest(data) for data in inputs.values()]
    made.Update()
    assert not errors and made.GetOutputDataObject(0), (name, errors)
    assert not inputs or made.GetOutputDataObject(0).GetFieldData().HasArray("note"), name
    assert seen == sorted(seen) and seen[-1] == 1, (name, seen)
    assert before == [digest(data) for data in inputs.values()], name
    count = len(runs)
    made.Update()
    assert count > 0 and len(runs) == count, (name, runs)
    for port, data in inputs.items():
        made.SetInputDataObject(port, vtkImageData() if data.IsA("vtkImageData") else vtkPolyData())
        made.Update()  # says so, or makes nothing
        made.SetInputDataObject(port, data)


classes = [name for name in sorted(dir(anamorph)) if name.startswith("vtkAnamorph")]
checked = set()
for name in classes:
    try:
        made = getattr(anamorph, name)()
    except TypeError:
        continue  # abstract
    check_properties(made)
    if isinstance(made, vtkAlgorithm):
        alone, errors = getattr(anamorph, name)(), []
        for speaks in (alone, alone.GetExecutive()):
            speaks.AddObserver("ErrorEvent", lambda *_: errors.append(1))
        alone.Update()
        assert errors, name
        if made.GetNumberOfOutputPorts() > 0:
            check_data(name[len("vtkAnamorph"):], getattr(anamorph, name)())
            checked.add(name[len("vtkAnamorph"):])
assert checked == set(INPUTS), checked ^ set(INPUTS)
print(len(classes), "classes,", len(checked), "that make data")
