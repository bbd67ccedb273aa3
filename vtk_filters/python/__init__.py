# SPDX-License-Identifier: Apache-2.0
"""The VTK classes of Anamorph: deformation, inbetweening and reliefs."""

from .AnamorphFilters import *
