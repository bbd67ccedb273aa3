# SPDX-License-Identifier: Apache-2.0
"""Anamorph's VTK classes, vtkAnamorphDeform and the others, beside the operations on arrays: from anamorph.vtk import vtkAnamorphDeform.

They are a build of their own (the presets vtk and paraview), whose folder in PYTHONPATH comes behind that of this module. Classes that draw
are loaded, and OpenGL with them, when the first of them is asked for. `image`, `pixels` and `points` lead from numpy to VTK and back.
"""
import numpy as _numpy

try:
    from . import AnamorphFilters as _filters
    from .AnamorphFilters import *  # noqa: F401,F403
except ImportError as _missing:
    raise ImportError(f"{_missing}: Anamorph's VTK modules are not in PYTHONPATH, or VTK's are not") from None


def __getattr__(name):
    if not name.startswith("vtkAnamorph"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import AnamorphRendering

    return getattr(AnamorphRendering, name)


def __dir__():
    return sorted(set(globals()) | {name for name in dir(_filters) if name.startswith("vtkAnamorph")})


def image(pixels):
    """An array (height, width) or (height, width, channels), rows from the top, as a vtkImageData, whose rows go up."""
    from vtkmodules.util.numpy_support import numpy_to_vtk
    from vtkmodules.vtkCommonDataModel import vtkImageData

    pixels = _numpy.asarray(pixels)
    if pixels.ndim not in (2, 3) or pixels.size == 0:
        raise ValueError(f"pixels has the shape {pixels.shape}: must be (height, width) or (height, width, channels)")
    height, width = pixels.shape[:2]
    data = vtkImageData()
    data.SetDimensions(width, height, 1)
    scalars = numpy_to_vtk(_numpy.ascontiguousarray(pixels[::-1]).reshape(height * width, -1), deep=True)
    scalars.SetName("pixels")
    data.GetPointData().SetScalars(scalars)
    return data


def pixels(data):
    """The array of a vtkImageData of one slice, rows from the top: the other way of image()."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    width, height, depth = data.GetDimensions()
    scalars = data.GetPointData().GetScalars()
    if depth != 1 or scalars is None:
        raise ValueError("data must be an image of one slice that has scalars")
    array = vtk_to_numpy(scalars).reshape(height, width, -1)[::-1].copy()
    return array[:, :, 0] if array.shape[2] == 1 else array


def points(data):
    """The points of a vtkPolyData or another point set: an array (points, 3), a copy."""
    from vtkmodules.util.numpy_support import vtk_to_numpy

    return vtk_to_numpy(data.GetPoints().GetData()).copy()
