# SPDX-License-Identifier: Apache-2.0
"""The Python of docs/vtk.md, and what docs/start.md has of it: each block, with what it takes for granted before it and a look at what it made behind.
Runs where the page's own exports have said where the packages are, on a screen in memory, in the tree."""
import shutil

import numpy as np
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersSources import vtkCubeSource, vtkLineSource, vtkPlaneSource, vtkSphereSource
from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTexture,
                                         vtkWindowToImageFilter)

import blocks

TEXT = blocks.python_of("vtk")


def run(name, names):
    exec(compile(TEXT[name], "docs/vtk.md, " + name, "exec"), names)
    return names


def points(data):
    return vtk_to_numpy(data.GetPoints().GetData())


def red_picture():
    image = vtkImageData()
    image.SetDimensions(64, 32, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(np.tile(np.uint8([250, 20, 20]), (64 * 32, 1)), deep=True))
    return image


def drawn(actor):
    """What a window shows of it, [pixel, channel]; the background is black."""
    renderer, window, grab = vtkRenderer(), vtkRenderWindow(), vtkWindowToImageFilter()
    window.OffScreenRenderingOn()
    window.SetSize(100, 100)
    window.AddRenderer(renderer)
    renderer.AddActor(actor)
    renderer.ResetCamera()
    window.Render()
    grab.SetInput(window)
    grab.Update()
    return vtk_to_numpy(grab.GetOutput().GetPointData().GetScalars()).astype(int)


def check_start():
    assert run("start", {})["vtkAnamorphReliefSource"]().IsA("vtkAnamorphReliefSource")


def check_deform():
    surface = vtkPlaneSource()
    surface.SetResolution(20, 20)
    names = run("deform", {"surface": surface})
    deform = names["deform"]
    # The bump in the middle is as high as its vector says.
    assert abs(points(deform.GetOutput())[:, 2].max() - 1) < 1e-3, points(deform.GetOutput()).max(0)
    # At last it is of the back, which a plane does not show.
    run("depths", names)
    deform.Update()
    assert points(deform.GetOutput())[:, 2].max() == 0, points(deform.GetOutput()).max(0)
    # Anchored it is as deep as it is wide; its image beyond the edge is 1 away.
    run("anchor", names)
    deform.SetDepth(0, 0, deform.GetDepth(0)[1], 0)
    deform.Update()
    assert deform.GetDepth(0)[1] == 0.5 and deform.GetDeformationName(0) == "left brow"
    assert abs(points(deform.GetOutput())[:, 2].max() - 1 - np.exp(-4)) < 1e-3, points(deform.GetOutput()).max(0)
    # A bump of its own on a box, out of its corner and round, of a mesh that is finer than that takes.
    box = vtkCubeSource()
    deform = type(deform)()
    deform.SetInputConnection(box.GetOutputPort())
    run("first bump", {"deform": deform})
    deform.Update()
    assert deform.GetNumberOfDeformations() == 1 and deform.GetOutput().GetNumberOfPolys() == 12 * 4**5
    assert np.allclose(points(deform.GetOutput()).max(0), 0.6, atol=1e-3), points(deform.GetOutput()).max(0)


def check_image():
    volume = vtkRTAnalyticSource()
    volume.SetWholeExtent(-4, 4, -4, 4, 0, 3)
    image = run("image", {"volume": volume})["image"]
    image.Update()
    before, after = (vtk_to_numpy(data.GetPointData().GetScalars()) for data in (volume.GetOutput(), image.GetOutput()))
    assert before.shape == after.shape and 0 < (before != after).sum() < before.size and image.GetNumberOfFailures() == 0


def check_bent():
    surface = vtkPlaneSource()
    surface.SetResolution(3, 3)
    surface.Update()
    coordinates = vtk_to_numpy(surface.GetOutput().GetPointData().GetTCoords())
    coordinates[:, 0] += 0.1 * np.sin(4 * coordinates[:, 1])
    bent = run("bent", {"surface": surface})["bent"]
    assert bent.GetOutput().GetNumberOfCells() > 100
    assert 0 < bent.GetOutput().GetFieldData().GetArray("anamorph:max_error").GetValue(0) <= 0.25


def check_writer():
    base, smile, frown = (vtkSphereSource() for _ in range(3))
    smile.SetRadius(0.75)
    writer = run("writer", {"base": base, "smile": smile, "frown": frown})["writer"]
    assert writer.GetErrorCode() == 0 and writer.GetMaxError() < 1e-7, writer
    with open("face.glb", "rb") as file:
        assert b'"targetNames":["smile","shape 2"]' in file.read()


def check_warp():
    moved = vtkPlaneSource()
    moved.SetOrigin(0, 0, 0)
    moved.SetPoint1(63, 0, 0)
    moved.SetPoint2(0, 31, 0)
    warp = run("warp", {"image": red_picture(), "moved": moved})["warp"]
    assert (vtk_to_numpy(warp.GetOutput().GetPointData().GetScalars()) == [250, 20, 20]).all()
    assert warp.GetMaxError() <= 0.05


def check_morph():
    lines, other_lines = vtkLineSource(), vtkLineSource()
    for source, height in ((lines, 10), (other_lines, 20)):
        source.SetPoint1(15, height, 0)
        source.SetPoint2(45, height, 0)
    names = {"image": red_picture(), "other": red_picture(), "lines": lines, "other_lines": other_lines}
    vtk_to_numpy(names["other"].GetPointData().GetScalars())[:] = (50, 220, 20)
    morph = run("morph", names)["morph"]
    assert (vtk_to_numpy(morph.GetOutput().GetPointData().GetScalars()) == [200, 70, 20]).all()
    assert morph.GetMaxError() <= 0.01


def check_project():
    scene = vtkSphereSource()
    scene.SetRadius(5)
    projection = run("project", {"scene": scene})["projection"]
    assert projection.GetOutput(0).GetNumberOfCells() > 0
    assert projection.GetOutput(0).GetPointData().GetTCoords()


def check_view():
    view = run("view", {"image": red_picture()})["view"]
    view.Update()
    seen = view.GetOutput()
    assert seen.GetExtent() == (-16, 515, -16, 515, 0, 0), seen.GetExtent()
    assert (vtk_to_numpy(seen.GetPointData().GetScalars()) == [250, 20, 20, 255]).all()
    assert seen.GetFieldData().GetArray("anamorph:max_error").GetValue(0) == view.GetMaxError() <= 0.01


def check_shader():
    sphere, mapper, actor, texture = vtkSphereSource(), vtkPolyDataMapper(), vtkActor(), vtkTexture()
    sphere.SetCenter(0, 1.6, -3)
    mapper.SetInputConnection(sphere.GetOutputPort())
    actor.SetMapper(mapper)
    actor.GetProperty().LightingOff()
    texture.SetInputData(red_picture())
    texture.InterpolateOn()
    names = run("shader", {"texture": texture, "actor": actor})
    colors = drawn(actor)
    assert (colors[:, 0] - colors[:, 1] > 100).sum() > 500, "nothing is red"
    run("mosaics", names)
    assert names["projector"].GetCircles() == 32
    colors = drawn(actor)
    assert (colors[:, 0] - colors[:, 1] > 100).sum() > 100, "nothing is red by circles"


def check_mapper():
    shutil.copy("examples/figures/walker.nudes", "walker.nudes")
    names = run("mapper", {})
    assert (drawn(names["actor"]).sum(1) > 0).sum() > 200, "no walker is seen"
    run("labels", names)
    assert names["mapper"].GetStyle() == names["mapper"].OCTANT and names["renderer"].GetActors2D().GetNumberOfItems() == 1
    texture, image = vtkTexture(), names["anamorph"].vtkAnamorphFigureImage()
    texture.SetInputData(red_picture())
    run("textures", {**names, "texture": texture, "image": image, "picture": red_picture()})
    image.SetInputConnection(names["reader"].GetOutputPort())
    image.Update()
    assert image.GetOutput().GetNumberOfPoints() > 0


checks = {"start": check_start, "deform": check_deform, "image": check_image, "bent": check_bent, "writer": check_writer, "warp": check_warp,
          "morph": check_morph, "project": check_project, "shader": check_shader, "view": check_view, "mapper": check_mapper}
for check in checks.values():
    check()
assert set(TEXT) == {*checks, "depths", "anchor", "first bump", "labels", "mosaics", "textures"}, TEXT.keys()
