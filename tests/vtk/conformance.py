# SPDX-License-Identifier: Apache-2.0
# What the tests of conformance share: sources that vary in time and note what they are asked for, and what an object says.
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline
from vtkmodules.vtkFiltersSources import vtkPlaneSource


class Source(VTKPythonAlgorithmBase):
    """make(time), at any of the steps; `asked` are the times, pieces, and numbers of pieces that it has made."""

    def __init__(self, make, steps=None):
        self.make, self.steps, self.asked = make, steps, []
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType=make(0).GetClassName())

    def RequestInformation(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        info.Remove(Pipeline.TIME_STEPS())
        info.Remove(Pipeline.TIME_RANGE())
        if self.steps:
            info.Set(Pipeline.TIME_STEPS(), self.steps, len(self.steps))
            info.Set(Pipeline.TIME_RANGE(), (self.steps[0], self.steps[-1]), 2)
        if isinstance(self.make(0), vtkImageData):
            info.Set(Pipeline.WHOLE_EXTENT(), self.make(0).GetExtent(), 6)
        return 1

    def RequestData(self, request, inputs, outputs):
        info, output = outputs.GetInformationObject(0), vtkDataObject.GetData(outputs, 0)
        time = info.Get(Pipeline.UPDATE_TIME_STEP()) if info.Has(Pipeline.UPDATE_TIME_STEP()) else 0
        self.asked.append((time, info.Get(Pipeline.UPDATE_PIECE_NUMBER()), info.Get(Pipeline.UPDATE_NUMBER_OF_PIECES())))
        output.ShallowCopy(self.make(time))
        if self.steps:
            output.GetInformation().Set(vtkDataObject.DATA_TIME_STEP(), time)
        return 1


def wall(z=-1.0, half=1.0, resolution=4):
    """A square with texture coordinates."""
    source = vtkPlaneSource()
    source.SetOrigin(-half, -half, z)
    source.SetPoint1(half, -half, z)
    source.SetPoint2(-half, half, z)
    source.SetResolution(resolution, resolution)
    source.Update()
    return source.GetOutput()


def picture(factor=1.0, kind=np.float32, width=64, height=32):
    """One component that grows to the right and upwards."""
    image = vtkImageData()
    image.SetDimensions(width, height, 1)
    numbers = numpy_to_vtk((factor * (1 + np.add.outer(np.arange(height), np.arange(width)))).astype(kind).ravel(), deep=True)
    numbers.SetName("brightness")
    image.GetPointData().SetScalars(numbers)
    return image


def ghosts_of(values):
    array = vtkUnsignedCharArray()
    array.SetName("vtkGhostType")
    for value in values:
        array.InsertNextValue(value)
    return array


def pixels(image):
    """The numbers of an image: rows from the bottom up."""
    columns, rows, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(rows, columns, -1).astype(float)


def steps_of(algorithm):
    algorithm.UpdateInformation()
    info = algorithm.GetOutputInformation(0)
    return [info.Get(Pipeline.TIME_STEPS(), i) for i in range(info.Length(Pipeline.TIME_STEPS()))]


def time_of(data):
    info, key = data.GetInformation(), vtkDataObject.DATA_TIME_STEP()
    return info.Get(key) if info.Has(key) else None


def errors_of(algorithm, update=None):
    """What an algorithm and its executive say is wrong."""
    said = []

    def note(caller, event, text):
        said.append(text)

    note.CallDataType = "string0"
    observed = [(each, each.AddObserver("ErrorEvent", note)) for each in (algorithm, algorithm.GetExecutive())]
    (update or algorithm.Update)()
    for each, tag in observed:
        each.RemoveObserver(tag)
    return "\n".join(said)
