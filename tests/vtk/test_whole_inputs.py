# SPDX-License-Identifier: Apache-2.0
# Filters that draw an image of images ask for all of each input, whatever part or piece of theirs is asked for: any pixel may come from anywhere.
import os

import anamorph
import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData
from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as Pipeline

WHOLE, PART = (0, 63, 0, 47, 0, 0), (10, 20, 5, 9, 0, 0)


class Images(VTKPythonAlgorithmBase):
    """Makes of an image what it is asked for, and remembers that."""

    def __init__(self):
        super().__init__(nInputPorts=0, outputType="vtkImageData")
        self.asked = None

    def RequestInformation(self, request, inputs, outputs):
        outputs.GetInformationObject(0).Set(Pipeline.WHOLE_EXTENT(), WHOLE, 6)
        return 1

    def RequestData(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        self.asked = tuple(info.Get(Pipeline.UPDATE_EXTENT()))
        image = vtkImageData.GetData(outputs)
        image.SetExtent(self.asked)
        x0, x1, y0, y1 = self.asked[:4]
        j, i = np.mgrid[y0:y1 + 1, x0:x1 + 1]
        array = numpy_to_vtk((i + 100 * j).astype(np.float32).ravel(), deep=True)
        array.SetName("value")
        image.GetPointData().SetScalars(array)
        return 1


class Lines(VTKPythonAlgorithmBase):
    """A quad, whose outline is a polyline, too; remembers what piece of it is asked for."""

    def __init__(self):
        super().__init__(nInputPorts=0, outputType="vtkPolyData")
        self.asked = None

    def RequestInformation(self, request, inputs, outputs):
        outputs.GetInformationObject(0).Set(self.CAN_HANDLE_PIECE_REQUEST(), 1)
        return 1

    def RequestData(self, request, inputs, outputs):
        info = outputs.GetInformationObject(0)
        self.asked = (info.Get(Pipeline.UPDATE_PIECE_NUMBER()), info.Get(Pipeline.UPDATE_NUMBER_OF_PIECES()))
        points, cells = vtkPoints(), vtkCellArray()
        for place in ((0, 0, 0), (63, 0, 0), (63, 47, 0), (0, 47, 0)):
            points.InsertNextPoint(place)
        cells.InsertNextCell(4)
        for k in range(4):
            cells.InsertCellPoint(k)
        data = vtkPolyData.GetData(outputs)
        data.SetPoints(points)
        self.set_cells(data, cells)
        return 1

    def set_cells(self, data, cells):
        data.SetLines(cells)


class Mesh(Lines):
    def set_cells(self, data, cells):
        data.SetPolys(cells)
        data.GetPointData().SetTCoords(numpy_to_vtk(np.array([[0, 0], [1, 0], [1, 1], [0, 1]], np.float32), deep=True))


def check(made, images, others):
    for source in images + others:
        source.asked = None
    made.UpdateExtent(PART)
    assert [source.asked for source in images] == [WHOLE] * len(images), [source.asked for source in images]
    assert [source.asked for source in others] == [(0, 1)] * len(others), [source.asked for source in others]
    assert made.GetOutput().GetExtent() == PART, made.GetOutput().GetExtent()
    check_piece(made, images)


def check_piece(made, images):
    """As one of several ranks asks."""
    for source in images:
        source.asked = None
        source.Modified()
    made.UpdatePiece(1, 3, 0)
    assert [source.asked for source in images] == [WHOLE] * len(images), (made.GetClassName(), [source.asked for source in images])


image, mesh = Images(), Mesh()
warp = anamorph.vtkAnamorphImageWarp()
warp.SetInputConnection(0, image.GetOutputPort())
warp.SetMeshConnection(mesh.GetOutputPort())
check(warp, [image], [mesh])

images, lines = [Images(), Images()], [Lines(), Lines()]
morph = anamorph.vtkAnamorphImageMorph()
morph.SetInputConnection(0, images[0].GetOutputPort())
morph.SetOtherConnection(images[1].GetOutputPort())
morph.SetLinesConnection(lines[0].GetOutputPort())
morph.SetOtherLinesConnection(lines[1].GetOutputPort())
check(morph, images, lines)

for name in ("DeformImage", "Drape", "PanoramaView", "FigureImage"):
    image, made = Images(), getattr(anamorph, "vtkAnamorph" + name)()
    if name == "FigureImage":
        figures = anamorph.vtkAnamorphFigureReader()
        figures.SetFileName(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../examples/figures/walker.nudes"))
        made.SetInputConnection(figures.GetOutputPort())
        made.SetBumpConnection(image.GetOutputPort())
    else:
        made.SetInputConnection(image.GetOutputPort())
    made.UpdateExtent(PART)
    assert image.asked == WHOLE and made.GetOutput().GetExtent() == PART, (name, image.asked)
    check_piece(made, [image])
