# SPDX-License-Identifier: Apache-2.0
# What moves points refuses by name data that has none of its own: hyper tree grids, and the cell grids of VTK 9.3 and newer.
from vtkmodules import vtkCommonDataModel
from vtkmodules.vtkCommonDataModel import vtkHyperTreeGrid

from anamorph import vtkAnamorphDeform, vtkAnamorphInbetween


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
