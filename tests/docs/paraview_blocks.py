# SPDX-License-Identifier: Apache-2.0
"""The Python of the plugin's README: each block, with what it takes for granted before it and a look at what it made behind.
Runs in pvpython where the README's own export has said where the plugin is, on a screen in memory, in the README's tree."""
import shutil
import subprocess

import numpy as np
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

import blocks

TEXT = blocks.python_of("paraview")


def run(name, names):
    exec(compile(TEXT[name], "plugins/paraview/README.md, " + name, "exec"), names)
    return names


def names(**more):
    return {**globals(), **more}


def shown(view):
    """Its pixels, [pixel, channel]."""
    SaveScreenshot("shown.png", view, ImageResolution=[200, 200])
    reader = vtkPNGReader()
    reader.SetFileName("shown.png")
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)


def new_view():
    view = CreateView("RenderView")
    view.UseColorPaletteForBackground = 0
    view.Background = [0, 0, 0]
    view.OrientationAxesVisibility = 0
    return view


def check_ellipsoids():
    # Nine points with the tensor diag(0.1, 0.2, 0.1).
    points = ProgrammableFilter(Input=Plane(XResolution=2, YResolution=2), Script="""
import numpy
output.ShallowCopy(inputs[0].VTKObject)
output.PointData.append(numpy.tile([0.1, 0, 0, 0, 0.2, 0, 0, 0, 0.1], (9, 1)), "D")
""")
    view = new_view()
    made = run("ellipsoids", names(points=points, view=view))
    assert made["display"].EllipsoidShape == "Tensor", made["display"].EllipsoidShape
    ResetCamera(view)
    assert (shown(view).sum(1) > 0).sum() > 2000, "no ellipsoids are seen"
    subprocess.run(["/usr/bin/python3", "-c", "import OpenImageIO as o; b = o.ImageBuf(o.ImageSpec(8, 8, 3, 'uint8'));"
                    "o.ImageBufAlgo.fill(b, (1, 0, 0)); b.write('wood.png')"], check=True)
    run("textures", made)
    assert list(made["display"].EllipsoidTextureNames) == ["wood"], made["display"].EllipsoidTextureNames
    Render(view)


def check_save():
    made = run("save", names(base=Sphere(), smile=Sphere(Radius=0.75)))
    assert "SaveData" in made and b"targetNames" in open("face.glb", "rb").read()


def check_panorama():
    subprocess.run(["/usr/bin/python3", "-c", "import OpenImageIO as o; b = o.ImageBuf(o.ImageSpec(64, 32, 3, 'uint8'));"
                    "o.ImageBufAlgo.fill(b, (1, 0, 0)); b.write('panorama.png')"], check=True)
    view = new_view()
    display = Show(Sphere(Center=[3, 1.6, 0], Radius=1), view)
    run("panorama", names(shown=display))
    display.Ambient, display.Diffuse = 1, 0
    ResetCamera(view)
    colors = shown(view)
    assert (colors[:, 0] - colors[:, 1] > 100).sum() > 500, "nothing is red"


def check_state():
    run("state", names())
    assert (shown(GetViews()[-1]).std(0) > 5).any(), "the state's view is of one color"


checks = {"ellipsoids": check_ellipsoids, "panorama": check_panorama, "save": check_save, "state": check_state}
for check in checks.values():
    check()
assert set(TEXT) == {*checks, "textures"}, TEXT.keys()
