# SPDX-License-Identifier: Apache-2.0
# The package holds every class, and comes from the folder given as an argument, if any.
import pathlib
import sys

import anamorph

assert len(sys.argv) < 2 or anamorph.__file__.startswith(sys.argv[1]), anamorph.__file__
headers = pathlib.Path(__file__).parents[2].glob("vtk_filters/**/vtkAnamorph*.h")
names = [header.stem for header in headers if "vtkAbstractTypeMacro" not in header.read_text()]
assert "vtkAnamorphDeform" in names
# What does not draw loads no OpenGL.
assert not [name for name in sys.modules if "Rendering" in name], sys.modules
assert set(names) <= set(dir(anamorph)), set(names) - set(dir(anamorph))
assert not [name for name in sys.modules if "Rendering" in name], "dir() loads none either"
everything = {}
exec("from anamorph import *", everything)
assert set(names) <= set(everything), set(names) - set(everything)
for name in names:
    assert getattr(anamorph, name)().GetClassName() == name, name
