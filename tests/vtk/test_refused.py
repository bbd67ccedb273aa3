# SPDX-License-Identifier: Apache-2.0
# What moves points refuses by name data that has none of its own: hyper tree grids, and the cell grids of VTK 9.3 and newer. What reads cells
# refuses those whose corners are no points.
from vtkmodules import vtkCommonDataModel
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkHyperTreeGrid, vtkImageData, vtkPolyData, vtkUnstructuredGrid

from anamorph import (vtkAnamorphDeform, vtkAnamorphInbetween, vtkAnamorphNonlinearTexture, vtkAnamorphPanoramaProjection,
                      vtkAnamorphProjectionBake)


def refusal(algorithm, data):
    told = []

    def tell(caller, event, text=""):
        told.append(text)

    tell.CallDataType = "string0"
    algorithm.AddObserver("ErrorEvent", tell)
    algorithm.GetExecutive().AddObserver("ErrorEvent", lambda *_: None)
    algorithm.AddInputDataObject(data)
    algorithm.Update()
    return "".join(told)


refused = [vtkHyperTreeGrid()]
if hasattr(vtkCommonDataModel, "vtkCellGrid"):
    refused.append(vtkCommonDataModel.vtkCellGrid())
for data in refused:
    for kind in (vtkAnamorphDeform, vtkAnamorphInbetween):
        said = refusal(kind(), data)
        assert f"is a {data.GetClassName()}: it must be a point set" in said, (data.GetClassName(), said)


# Cells with corners that are no points, of a broken file or script.
def broken(*corners, points=9, grid=False):
    made, cells, places, coordinates = vtkUnstructuredGrid() if grid else vtkPolyData(), vtkCellArray(), vtkPoints(), vtkFloatArray()
    coordinates.SetNumberOfComponents(2)
    for k in range(points):
        places.InsertNextPoint(k % 3, k // 3, 0)
        coordinates.InsertNextTuple2(k % 3 / 2, k // 3 / 2)
    cells.InsertNextCell(3, (0, 1, 3))
    cells.InsertNextCell(3, corners)
    made.SetPoints(places)
    made.SetCells(5, cells) if grid else made.SetPolys(cells)
    made.GetPointData().SetTCoords(coordinates)
    return made


def image():
    made = vtkImageData()
    made.SetDimensions(8, 4, 1)
    made.AllocateScalars(3, 3)
    return made


normals, cut = vtkAnamorphDeform(), vtkAnamorphDeform()
cut.SetSubdivisions(1)
for deform in (normals, cut):
    deform.SetComputeNormals(deform is normals)
    deform.AddDeformation(1, 1, 1, 1, 0, 0, 1)
bake, shadow = vtkAnamorphProjectionBake(), vtkAnamorphProjectionBake()
for projection in (bake, shadow):
    projection.AddProjector(1, 1, 3, 0, 0, -1, 0, 1, 0)
    projection.AddInputDataObject(1, image())
shadow.SetOcclusion(True)
for algorithm in (normals, cut, vtkAnamorphNonlinearTexture(), vtkAnamorphPanoramaProjection(), bake):
    for corners, first, points in (((1, 2, 9), 9, 9), ((1, 2, 999999), 999999, 9), ((-1, 4, 5), -1, 9), ((0, 1, 2), 0, 0)):
        if points == 0 and algorithm in (normals, cut):
            continue  # there is nothing to move
        algorithm.RemoveAllInputConnections(0)
        said = refusal(algorithm, broken(*corners, points=points))
        words = f"has a cell with a corner at point {first}: its points are {'0 to 8' if points else 'none'}"
        assert words in said or points == 0 and not said, (algorithm.GetClassName(), corners, said)
projection = vtkAnamorphPanoramaProjection()
assert "corner at point 9: its points are 0 to 8" in refusal(projection, broken(1, 2, 9, grid=True))
shadow.SetInputDataObject(2, broken(1, 2, 9))
assert "corner at point 9: its points are 0 to 8" in refusal(shadow, broken(1, 2, 4))
