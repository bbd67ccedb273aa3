# SPDX-License-Identifier: Apache-2.0
"""The VTK classes of Anamorph: deformation, inbetweening and reliefs of surfaces, panoramas on scenes, figures.

Classes that draw are loaded, and OpenGL with them, when the first of them is asked for.
"""

from .AnamorphFilters import *


def __getattr__(name):
    if not name.startswith("vtkAnamorph"):
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import AnamorphRendering
    return getattr(AnamorphRendering, name)
