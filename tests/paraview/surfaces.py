# SPDX-License-Identifier: Apache-2.0
"""Surfaces that the tests make in different hosts, and what is compared of them."""
import hashlib
import os

import numpy as np
from paraview import servermanager
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy

if "ANAMORPH_SERVER" in os.environ:
    host, port = os.environ["ANAMORPH_SERVER"].split(":")
    Connect(host, int(port))
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=True)
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())

# Bumps that reach over most of a unit square: c_u, c_v, a_u, a_v, V_x, V_y, V_z, kernel, enabled.
BUMPS = [0.1, 0.05, 0.3, 0.2, 0.05, -0.1, 0.4, 0, 1,
         -0.3, 0.2, 0.5, 0.1, 0.2, 0.1, -0.3, 1, 1,
         0.0, 0.0, 0.9, 0.9, 0.0, 0.1, 0.1, 0, 1,
         0.2, 0.2, 0.9, 0.9, 0.0, 5.0, 0.1, 0, 0]
TURN_BUMPS = [0.3, 0.5, 0.2, 0.3, 0.1, 0.2, 0.3, 0, 1, 0.7, 0.4, 0.1, 0.2, -0.1, 0.1, 0.2, 1, 1]


def number_of_pieces():
    return servermanager.ActiveConnection.GetNumberOfDataPartitions()


def with_original(surface):
    """The surface with its points as an array, which tell a point of the pieces from the others."""
    original = Calculator(Input=surface, ResultArrayName="Original", Function="coords", ResultArrayType="Double")
    original.UpdatePipeline()
    return original


def write_inputs(folder):
    """Writes a picture of some hills."""
    from paraview.vtk import vtkImageData
    from paraview.vtk.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkIOImage import vtkPNGWriter
    y, x = np.mgrid[0:41, 0:41] / 40
    grey = np.round(255 * (0.5 + 0.3 * np.sin(7 * x) * np.cos(5 * y))).astype(np.uint8)
    image = vtkImageData()
    image.SetDimensions(41, 41, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(grey.ravel(), deep=1))
    writer = vtkPNGWriter()
    writer.SetFileName(folder + "/hills.png")
    writer.SetInputDataObject(image)
    writer.Write()


def make(folder):
    """Some surfaces, by name, of every filter of the plugin; in pieces, where there are several ranks."""
    relief = with_original(AnamorphReliefSource(FileName=folder + "/hills.png", HeightScale=0.5, GenerateNormals=1))
    polygons = ExtractSurface(Input=relief)
    polygons.UpdatePipeline()
    deformed = AnamorphDeform(Input=polygons, Deformations=BUMPS)
    double = AnamorphDeform(Input=polygons, Deformations=BUMPS, OutputPointsPrecision=1, AutomaticPlane=0,
                            Origin=[0.1, 0, 0], Axis1=[0, 1, 0.2], Axis2=[0, 0, 2],
                            FormulaX="a*sin(6*u+frame)", FormulaDefinitions="a=0.1", Frame=2)
    turned = AnamorphDeform(Input=relief, Deformations=TURN_BUMPS, ParameterMode=1)
    raised = AnamorphDeform(Input=relief, Deformations=BUMPS)
    between = AnamorphInbetween(Input=[deformed, double], Weights=[1.5, -0.5])
    return {"deformed": deformed, "double": double, "turned": turned, "relief": relief, "raised": raised,
            "between": between}


def gather(source):
    """What is known of every point of a surface, by its place before: the same for all points at that place."""
    polygons = ExtractSurface(Input=source)  # of grids too, only one piece of which would be fetched
    polygons.UpdatePipeline()
    data = servermanager.Fetch(polygons)
    arrays = [np.ascontiguousarray(vtk_to_numpy(data.GetPoints().GetData()))]
    points = data.GetPointData()
    for name in ("Displacement", "Normals"):
        array = points.GetArray(name) or (points.GetNormals() if name == "Normals" else None)
        if array:
            arrays.append(np.ascontiguousarray(vtk_to_numpy(array)))
    ghosts = points.GetArray("vtkGhostType")
    ghosts = vtk_to_numpy(ghosts) if ghosts else np.zeros(data.GetNumberOfPoints(), np.uint8)
    original = np.ascontiguousarray(vtk_to_numpy(points.GetArray("Original")))
    found = {}
    for i in np.flatnonzero(ghosts == 0):
        known = b"".join(array[i].tobytes() for array in arrays)
        place = original[i].tobytes()
        assert found.setdefault(place, known) == known, ("points at one place differ", original[i], i)
    return found


def digest(found):
    """Of gather's answer: the same for any number of pieces and order of points."""
    return hashlib.sha256(b"".join(place + known for place, known in sorted(found.items()))).hexdigest()


def digests(folder):
    """By name: how many points there are, and the digest."""
    found = {name: gather(source) for name, source in make(folder).items()}
    return {name: (len(f), digest(f)) for name, f in found.items()}


def splats_head(count):
    """The head of a file of Gaussian splats."""
    names = ["x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2", "rot_0", "rot_1", "rot_2", "rot_3"]
    return f"ply\nformat binary_little_endian 1.0\nelement vertex {count}\n" + \
        "".join(f"property float {name}\n" for name in names) + "end_header\n"
