# SPDX-License-Identifier: Apache-2.0
# %% [markdown]
# # A ParaView user's surface
# Bumps on a mesh by a VTK filter, whose points are an array again: in `pvpython`, or in Python with VTK.

# %%
import numpy as np
from anamorph import vtkAnamorphDeform
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkFiltersSources import vtkPlaneSource

plane = vtkPlaneSource()
plane.SetResolution(100, 100)

# %% [markdown]
# Two bumps, each with its centre in x and y, its extent and its vector. Of an edit only what it reaches is computed again.

# %%
deform = vtkAnamorphDeform()
deform.SetInputConnection(plane.GetOutputPort())
deform.AddDeformation(-0.2, 0, 0.1, 0.1, 0, 0, 0.2)
deform.AddDeformation(0.2, 0, 0.1, 0.2, 0, 0, -0.1)
deform.Update()

# %% [markdown]
# Points and normals as numpy arrays, and how far a coordinate may be off.

# %%
output = deform.GetOutput()
points = vtk_to_numpy(output.GetPoints().GetData())
print(f"heights from {points[:, 2].min():.3f} to {points[:, 2].max():.3f}, off by at most {deform.GetErrorBound():.1e}")

# %% [markdown]
# The same by the formula, in numpy.

# %%
start = vtk_to_numpy(plane.GetOutput().GetPoints().GetData())
x, y = start[:, 0].astype(float), start[:, 1].astype(float)
formula = 0.2 * np.exp(-((x + 0.2) / 0.1) ** 2 - (y / 0.1) ** 2) - 0.1 * np.exp(-((x - 0.2) / 0.1) ** 2 - (y / 0.2) ** 2)
difference = np.abs(points[:, 2] - formula).max()
print(f"largest difference {difference:.1e}")
