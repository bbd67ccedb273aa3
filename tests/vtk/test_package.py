# SPDX-License-Identifier: Apache-2.0
# The package holds every class, and comes from the folder given as an argument, if any.
import sys

import anamorph

assert len(sys.argv) < 2 or anamorph.__file__.startswith(sys.argv[1]), anamorph.__file__
for name in ["vtkAnamorphDeform", "vtkAnamorphDeformationList", "vtkAnamorphFigureReader",
             "vtkAnamorphInbetween", "vtkAnamorphReliefSource"]:
    assert getattr(anamorph, name)().GetClassName() == name
