# SPDX-License-Identifier: Apache-2.0
"""The bump that Deform begins with, on the sources of ParaView's menu as they are made, and on terrains: it is seen, stands outwards on the side that is
seen, is round where the source is coarse, and leaves the far side alone. A script that gives a list of its own gets that list and nothing of it."""
from display import run_shown

SCRIPT = r'''
import os

import numpy as np
from time import time
from paraview import servermanager, simple
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))


view = CreateRenderView(ViewSize=[160, 120])
view.OrientationAxesVisibility = 0


def picture(source):
    shown = Show(source, view)
    assert shown.Representation == "Surface", shown.Representation
    shown.ColorArrayName = ["POINTS", ""]
    view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, 0, 4], [0, 0, 0], [0, 1, 0]
    ResetCamera(view)
    SaveScreenshot("seen.png", view, ImageResolution=[160, 120])
    Hide(source, view)
    reader = vtkPNGReader()
    reader.SetFileName("seen.png")
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)


def arrays(source):
    source.UpdatePipeline()
    data = servermanager.Fetch(source)
    return vtk_to_numpy(data.GetPoints().GetData()).astype(float), vtk_to_numpy(data.GetPointData().GetArray("Displacement")).astype(float)


def terrain():
    """As Warp By Scalar raises one."""
    flat = simple.Calculator(Input=Wavelet(WholeExtent=[-20, 20, -20, 20, 0, 0]), ResultArrayName="Height",
                             Function="2*sin(coordsX/6)*cos(coordsY/7)")
    return simple.WarpByScalar(Input=flat, Scalars=["POINTS", "Height"])


begin = time()
SOURCES = {"Sphere": Sphere, "Plane": Plane, "Box": Box, "Cone": Cone, "Cylinder": Cylinder, "Wavelet": Wavelet,
           "image terrain": lambda: Wavelet(WholeExtent=[-10, 10, -10, 10, 0, 0]), "terrain": terrain,
           "small volume": lambda: simple.ResampleToImage(Input=Wavelet(), SamplingDimensions=[9, 9, 9]),
           "floor": lambda: Plane(Origin=[-1, 0, 1], Point1=[1, 0, 1], Point2=[-1, 0, -1])}
for name, make in SOURCES.items():
    source = make()
    source.UpdatePipeline()
    bounds = np.array(source.GetDataInformation().GetBounds()).reshape(3, 2)
    diagonal = np.linalg.norm(bounds[:, 1] - bounds[:, 0])
    deform = simple.AnamorphDeform(Input=source)
    points, moved = arrays(deform)
    rest = points - moved
    length = np.linalg.norm(moved, axis=1)
    peak = length.argmax()
    # As high as it is told, of more points than one.
    assert .6 * diagonal / 10 < length[peak] < 1.001 * diagonal / 10, (name, length[peak], diagonal)
    around = np.unique(np.round(rest[length > length[peak] / np.e], 6), axis=0)
    assert len(around) >= 4, (name, len(around))
    # Outwards, to where the eye is: the surface about the peak was beyond it nowhere.
    out = moved[peak] / length[peak]
    assert out.min() > -1e-6, (name, out)
    near = np.linalg.norm(rest - rest[peak], axis=1) < diagonal / 12
    assert ((rest[near] - rest[peak]) @ out).max() < .03 * diagonal, name
    # On the far side nothing moves.
    far = (rest - rest[peak]) @ out < -diagonal / 3
    assert far.any() == (name not in ("Plane", "image terrain", "terrain", "floor")), name
    assert not far.any() or length[far].max() < .01 * length[peak], (name, length[far].max())
    # It is seen beside the surface at rest.
    same = simple.AnamorphDeform(Input=source, Deformations=[0, 0, 1, 1, 0, 0, 0, 0, 0], Subdivisions=deform.Subdivisions)
    different = np.abs(picture(deform) - picture(same)).max(axis=1) > 8
    assert different.mean() > .004, (name, different.mean())
    print(round(time()-begin,1), name, list(np.round(out, 2)), len(around), deform.Subdivisions, round(different.mean(), 4))

    # A list that is given, when it is made or after that, is without anything else, to the bit.
    row = [.1, .2, .7, .6, .1, .2, .3, 0, 1]
    given = simple.AnamorphDeform(Input=source, Deformations=row)
    for word, value in (("Deformations", row), ("Bumps", [.1, .2, 0, .7, .6, 0, .1, .2, .3, 0, 1, 0, 1, 0, 0, 0, 0, 0, 0])):
        later = simple.AnamorphDeform(Input=source)
        setattr(later, word, value)
        for other in (given, later):
            assert list(other.Depths) == [] and list(other.Frames) == [] and other.Subdivisions == 0, (name, word)
        for one, two in zip(arrays(given), arrays(later)):
            assert one.tobytes() == two.tobytes(), (name, word)
    # One that is edited is not another one.
    kept = list(deform.Depths), list(deform.Frames), deform.Subdivisions
    edited = list(deform.Deformations)
    for column in (4, 5, 6):
        edited[column] *= 2
        deform.Deformations = edited
    deform.UpdatePipeline()
    assert (list(deform.Depths), list(deform.Frames), deform.Subdivisions) == kept, name

# In texture coordinates it is where they are, and stands out of the surface.
ball = simple.TextureMaptoSphere(Input=Sphere(ThetaResolution=40, PhiResolution=40), PreventSeam=0)
ball.UpdatePipeline()
deform = simple.AnamorphDeform(Input=ball, ParameterMode=1)
points, moved = arrays(deform)
peak = np.linalg.norm(moved, axis=1).argmax()
assert points[peak].min() > .25 and moved[peak].min() > .04, (points[peak], moved[peak])
assert 0 < deform.Deformations[0] < 1 and deform.Deformations[2] < .2, list(deform.Deformations)

# A mesh that is not of polygons alone is not subdivided without being asked, and refused where it is.
edges = simple.AppendGeometry(Input=[Plane(), Line(Point1=[0, 0, 1], Point2=[1, 0, 1])])
edges.UpdatePipeline()
deform = simple.AnamorphDeform(Input=edges)
assert deform.Subdivisions == 0 and np.linalg.norm(arrays(deform)[1], axis=1).max() > .1
print("every one")
'''

with open("first_bump.py", "w") as file:
    file.write(SCRIPT)
done = run_shown(391, "pvpython", "first_bump.py")
print(done.stdout)
assert "every one" in done.stdout and "ERR" not in done.stderr, done.stderr[-5000:]
# Of these a small grid and a mesh with a line in it are too coarse to show a round one.
assert done.stderr.count("the mesh is coarse") == 4, done.stderr[-5000:]
