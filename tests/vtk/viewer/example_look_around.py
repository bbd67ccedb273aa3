# SPDX-License-Identifier: Apache-2.0
"""examples/vtk/look_around.py, driven by events: both ways to draw show what vtkAnamorphPanoramaView draws without OpenGL."""
import importlib.util
import math
import sys

from anamorph import vtkAnamorphPanoramaView
from vtkmodules.vtkCommonCore import VTK_UNSIGNED_CHAR, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkImageData

WIDTH, HEIGHT = 200, 140


def panorama(width, height):
    image = vtkImageData()
    image.SetDimensions(width, height, 1)
    image.AllocateScalars(VTK_UNSIGNED_CHAR, 3)
    for j in range(height):
        for i in range(width):
            a, b = 2 * math.pi * (i + 0.5) / width, math.pi * (j + 0.5) / height
            for c, v in enumerate((math.sin(3 * a) * math.sin(b), math.cos(2 * a) * math.sin(b), math.cos(4 * b))):
                image.SetScalarComponentFromDouble(i, j, 0, c, round(127.5 + 120 * v))
    return image


def compare(view, image, projection):
    """The largest difference, in levels, of what the window shows."""
    exact = vtkAnamorphPanoramaView()
    exact.SetInputData(image)
    exact.SetProjection(projection)
    exact.SetViewSize(WIDTH, HEIGHT)
    exact.SetYaw(view.style.GetYaw())
    exact.SetPitch(view.style.GetPitch())
    exact.SetViewAngle(view.style.GetFieldOfView())
    exact.SetTolerance(0)
    exact.Update()
    seen = vtkUnsignedCharArray()
    view.window.Render()
    view.window.GetPixelData(0, 0, WIDTH - 1, HEIGHT - 1, 0, seen, 0)
    expected = exact.GetOutput().GetPointData().GetScalars()
    assert seen.GetNumberOfTuples() == expected.GetNumberOfTuples()
    return max(abs(seen.GetComponent(i, c) - expected.GetComponent(i, c)) for i in range(WIDTH * HEIGHT) for c in range(3))


def event(view, name, x, y):
    view.interactor.SetEventInformation(x, y, 0, 0, "\0", 0, None)
    view.interactor.InvokeEvent(name)


def check(module, vertex):
    image = panorama(256, 128)
    view = module.LookAround(image, "equirectangular", vertex=vertex)
    view.window.SetSize(WIDTH, HEIGHT)
    view.interactor.Initialize()
    view.window.Render()
    # Pixels of OpenGL's have texels' weights of 8 bits; corners may be off by the tolerance of the example.
    most = 4 if vertex else 2
    off = [compare(view, image, 0)]
    event(view, "LeftButtonPressEvent", 100, 70)
    event(view, "MouseMoveEvent", 30, 90)
    event(view, "LeftButtonReleaseEvent", 30, 90)
    assert view.style.GetYaw() > 20 and view.style.GetPitch() < -5, (view.style.GetYaw(), view.style.GetPitch())
    off.append(compare(view, image, 0))
    for _ in range(5):
        event(view, "MouseWheelForwardEvent", 100, 70)
    assert abs(view.style.GetFieldOfView() - 90 / 1.1**5) < 1e-9
    off.append(compare(view, image, 0))
    view.style.SetYaw(176)
    view.style.Look()
    off.append(compare(view, image, 0))
    print("vertex" if vertex else "fragment", off)
    assert max(off) <= most, off


specification = importlib.util.spec_from_file_location("look_around", sys.argv[1])
example = importlib.util.module_from_spec(specification)
specification.loader.exec_module(example)
check(example, vertex=False)
check(example, vertex=True)
