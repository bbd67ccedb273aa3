# SPDX-License-Identifier: Apache-2.0
# What the tests and the benchmark of vtkAnamorphEllipsoidMapper share: ellipsoids, a window that shows them, and what it shows.
import math

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import VTK_DOUBLE, vtkFloatArray, vtkPoints, vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkRenderingCore import vtkActor, vtkRenderer, vtkRenderWindow
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401: it is what draws

import anamorph


def points_of(centers, **arrays):
    """Points with arrays."""
    data, points = vtkPolyData(), vtkPoints()
    points.SetDataType(VTK_DOUBLE)
    points.SetData(numpy_to_vtk(np.asarray(centers, float).reshape(-1, 3), deep=True))
    data.SetPoints(points)
    for name, values in arrays.items():
        array = numpy_to_vtk(np.asarray(values), deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    return data


def crowd(count, size=0.02, aspect=3.0, seed=1):
    """Ellipsoids all over a cube of side 2, turned at random, with half axes of `size` / `aspect` to `size` * `aspect`; each has
    a color, Color, and one of its own, Id."""
    random = np.random.default_rng(seed)
    numbers = np.arange(count)
    ids = np.stack([numbers % 256, numbers // 256 % 256, 255 - numbers // 65536], 1).astype(np.uint8)
    return points_of(random.uniform(-1, 1, (count, 3)), Axes=size * aspect ** random.uniform(-1, 1, (count, 3)),
                     Orientation=random.normal(size=(count, 4)), Id=ids,
                     Color=random.integers(0, 256, (count, 3)).astype(np.uint8))


class Scene:
    """A window with one actor on a black ground."""

    def __init__(self, mapper, width=512, height=512):
        self.mapper, self.actor, self.renderer, self.window = mapper, vtkActor(), vtkRenderer(), vtkRenderWindow()
        self.actor.SetMapper(mapper)
        self.renderer.AddActor(self.actor)
        self.renderer.SetBackground(0, 0, 0)
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.SetSize(width, height)
        self.window.AddRenderer(self.renderer)
        self.camera = self.renderer.GetActiveCamera()

    def look(self, position, focus=(0, 0, 0), up=(0, 1, 0), angle=30.0, parallel_scale=None):
        self.camera.SetPosition(position)
        self.camera.SetFocalPoint(focus)
        self.camera.SetViewUp(up)
        self.camera.SetViewAngle(angle)
        self.camera.SetParallelProjection(parallel_scale is not None)
        if parallel_scale is not None:
            self.camera.SetParallelScale(parallel_scale)
        self.renderer.ResetCameraClippingRange()

    def colors(self):
        """Red, green and blue of the pixels, rows from the bottom up."""
        self.window.Render()
        width, height = self.window.GetSize()
        pixels = vtkUnsignedCharArray()
        self.window.GetPixelData(0, 0, width - 1, height - 1, 0, pixels, 0)
        return vtk_to_numpy(pixels).reshape(height, width, 3).astype(int)

    def ids(self):
        """Where the array Id is drawn as it is: which point each pixel shows; -1: none."""
        self.mapper.SetScalarModeToUsePointFieldData()
        self.mapper.SelectColorArray("Id")
        self.mapper.ScalarVisibilityOn()
        self.actor.GetProperty().LightingOff()
        colors = self.colors()
        self.actor.GetProperty().LightingOn()
        return np.where(colors[..., 2] > 0, colors[..., 0] + 256 * colors[..., 1] + 65536 * (255 - colors[..., 2]), -1)

    def depths(self):
        """The depth of each pixel from the eye along the camera's axis; infinite: nothing there."""
        self.window.Render()
        width, height = self.window.GetSize()
        buffer = vtkFloatArray()
        self.window.GetZbufferData(0, 0, width - 1, height - 1, buffer)
        z = vtk_to_numpy(buffer).reshape(height, width).astype(float)
        near, far = self.camera.GetClippingRange()
        if self.camera.GetParallelProjection():
            depth = near + z * (far - near)
        else:
            depth = near * far / (far - z * (far - near))
        return np.where(z == 1, math.inf, depth)


def core_picture(data, scene, style, image=None, **settings):
    """What a vtkAnamorphFigureImage shows of the data to the same camera: an array of rows from the bottom up."""
    image, camera = image or anamorph.vtkAnamorphFigureImage(), scene.camera
    image.SetInputData(data)
    image.SetViewMode(image.CAMERA)
    image.SetViewSize(*scene.window.GetSize())
    image.SetCameraPosition(camera.GetPosition())
    image.SetCameraFocalPoint(camera.GetFocalPoint())
    image.SetCameraViewUp(camera.GetViewUp())
    image.SetCameraViewAngle(camera.GetViewAngle())
    image.SetCameraParallelProjection(camera.GetParallelProjection())
    image.SetCameraParallelScale(camera.GetParallelScale())
    image.SetStyle(style)
    for name, value in settings.items():
        getattr(image, "Set" + name)(value)
    image.Update()
    width, height = scene.window.GetSize()
    numbers = vtk_to_numpy(image.GetOutput().GetPointData().GetScalars())
    return numbers.reshape(height, width, -1).squeeze().astype(float)
