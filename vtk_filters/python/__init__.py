# SPDX-License-Identifier: Apache-2.0
"""The VTK classes of Anamorph: deformation, inbetweening and reliefs of surfaces, panoramas on scenes, figures.

Classes that draw are loaded, and OpenGL with them, when the first of them is asked for.
"""

from . import AnamorphFilters
from .AnamorphFilters import *

_DRAWING = "@drawing_classes@".split(";")
__all__ = [name for name in dir(AnamorphFilters) if name.startswith("vtkAnamorph")] + _DRAWING


def __dir__():
    return sorted(set(globals()) | set(__all__))


def __getattr__(name):
    if not name.startswith("vtkAnamorph"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import AnamorphRendering
    return getattr(AnamorphRendering, name)
