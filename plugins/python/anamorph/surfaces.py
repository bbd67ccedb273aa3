# SPDX-License-Identifier: Apache-2.0
"""Points moved by lists of bumps, and shapes between shapes (Oka et al. 1987), on arrays.

    uv = np.stack(np.meshgrid(np.linspace(0, 1, 200), np.linspace(0, 1, 200)), -1).reshape(-1, 2)
    plane = np.column_stack([uv, np.zeros(len(uv))])
    raised, bound = anamorph.surfaces.deform(uv, plane, [{"vector": [0, 0, 0.2], "center": [0.5, 0.5], "extent": [0.1, 0.1]}])
    half = anamorph.surfaces.inbetween([plane, raised], [0.5, 0.5])
"""
import numpy as _numpy

from . import _core
from ._checks import encoded as _encoded
from ._checks import json_of as _json_of

__all__ = ["deform", "inbetween"]


def deform(uv, points, deformations):
    """Moves points by a list of bumps, that of a file of deformations: (moved points, the most by which a coordinate may be off).

    uv: an array (n, 2), the place of each point in the plane that the bumps lie in. points: (n, 3). deformations: a list of dicts, or a
    dict with it by the name "deformations". Bumps with a depth or a side are for surfaces with normals (vtkAnamorphDeform)."""
    if not isinstance(deformations, dict):
        deformations = {"deformations": list(deformations)}
    text = _json_of("deformations", deformations)
    return _core.deform(_encoded(text), _numpy.asarray(uv, float), _numpy.asarray(points, float))


def inbetween(shapes, weights, *, normalize=False):
    """The sum of shapes by weights, whose sum must be 1, or is divided out with `normalize`. shapes: arrays of one shape; weights: as many
    numbers, also below 0 or above 1. Returns an array of double of that shape, added in double and rounded once."""
    arrays = [_numpy.asarray(shape, float) for shape in shapes]
    if any(array.shape != arrays[0].shape for array in arrays):
        raise ValueError(f"shapes: must all have the same shape, not {', '.join(str(array.shape) for array in arrays)}")
    return _core.inbetween(arrays, [float(weight) for weight in weights], bool(normalize)).reshape(arrays[0].shape if arrays else ())
