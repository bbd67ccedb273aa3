#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Looks around in a panorama with the mouse (Kim 2003, section 4.5), drawn by OpenGL.

Usage: look_around.py [--vertex] PANORAMA [PROJECTION]

PANORAMA is a picture that VTK reads: .hdr, .png, .jpg, .tif. PROJECTION is equirectangular unless it is given. The panorama is
thrown from the camera onto a sphere around it, fragment by fragment; with --vertex onto the screen's rectangle, which is cut
into triangles until interpolation between their corners is off by no more than a quarter of a texel. anamorph-view does without
OpenGL, and reads more kinds of files.
"""
import math
import sys

import vtkmodules.vtkInteractionStyle  # noqa: F401: what interactors begin with
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401: what draws
from anamorph import (vtkAnamorphPanoramaProjection, vtkAnamorphPanoramaProjector, vtkAnamorphPanoramaStyle,
                      vtkAnamorphProjectionShader)
from vtkmodules.vtkFiltersSources import vtkPlaneSource, vtkSphereSource
from vtkmodules.vtkIOImage import vtkImageReader2Factory
from vtkmodules.vtkRenderingCore import (vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkRenderWindowInteractor,
                                         vtkTexture)

TOLERANCE = 0.25


def turned(yaw, pitch, right, up, ahead):
    """A direction in the frame of a view, in that of the world."""
    y, p = math.radians(yaw), math.radians(pitch)
    up, ahead = up * math.cos(p) + ahead * math.sin(p), ahead * math.cos(p) - up * math.sin(p)
    return right * math.cos(y) + ahead * math.sin(y), up, right * math.sin(y) - ahead * math.cos(y)


class LookAround:
    """The window, its style, and what is drawn."""

    def __init__(self, image, projection="equirectangular", vertex=False):
        self.renderer, self.window, self.interactor = vtkRenderer(), vtkRenderWindow(), vtkRenderWindowInteractor()
        self.style = vtkAnamorphPanoramaStyle()
        self.window.AddRenderer(self.renderer)
        self.window.SetMultiSamples(0)
        self.window.SetSize(960, 640)
        self.interactor.SetRenderWindow(self.window)
        self.interactor.SetInteractorStyle(self.style)
        self.style.SetDefaultRenderer(self.renderer)
        self.texture = vtkTexture()
        self.texture.SetInputData(image)
        self.texture.SetColorModeToDirectScalars()
        self.texture.InterpolateOn()
        self.actor = vtkActor()
        # The panorama's own colors, in no light.
        self.actor.GetProperty().SetAmbient(1)
        self.actor.GetProperty().SetDiffuse(0)
        self.actor.GetProperty().SetSpecular(0)
        self.renderer.AddActor(self.actor)
        self.renderer.GetActiveCamera().SetPosition(0, 0, 0)
        self.throw_on_vertices(image, projection) if vertex else self.throw_on_fragments(projection)
        self.style.Look()

    def throw_on_fragments(self, projection):
        sphere = vtkSphereSource()
        sphere.SetRadius(10)
        sphere.SetThetaResolution(64)
        sphere.SetPhiResolution(32)
        self.show(sphere)
        self.projector = vtkAnamorphPanoramaProjector()
        self.projector.SetPanorama(self.texture)
        self.projector.SetProjectionName(projection)
        self.shader = vtkAnamorphProjectionShader()
        self.shader.AddProjector(self.projector)
        self.shader.AddTo(self.actor)

    def throw_on_vertices(self, image, projection):
        names = vtkAnamorphPanoramaProjector()
        names.SetProjectionName(projection)
        self.screen = vtkPlaneSource()
        self.projection = vtkAnamorphPanoramaProjection()
        self.projection.SetInputConnection(self.screen.GetOutputPort())
        self.projection.SetProjection(names.GetProjection())
        self.projection.SetPanoramaWidth(image.GetDimensions()[0])
        self.projection.SetPanoramaHeight(image.GetDimensions()[1])
        self.projection.SetTolerance(TOLERANCE)
        self.projection.OcclusionOff()
        self.show(self.projection)
        self.actor.SetTexture(self.texture)
        self.renderer.AddObserver("StartEvent", lambda *_: self.place_screen())

    def show(self, source):
        mapper = vtkPolyDataMapper()
        mapper.SetInputConnection(source.GetOutputPort())
        mapper.ScalarVisibilityOff()
        self.actor.SetMapper(mapper)

    def place_screen(self):
        """The rectangle that the view fills, at the distance 1."""
        width, height = self.renderer.GetSize()
        across = math.tan(math.radians(self.style.GetFieldOfView()) / 2)
        up = across * height / max(1, width)
        corners = [turned(self.style.GetYaw(), self.style.GetPitch(), x, y, 1)
                   for x, y in ((-across, -up), (across, -up), (-across, up))]
        self.screen.SetOrigin(corners[0])
        self.screen.SetPoint1(corners[1])
        self.screen.SetPoint2(corners[2])
        self.renderer.GetActiveCamera().SetClippingRange(0.1, 100)


def read_image(name):
    reader = vtkImageReader2Factory.CreateImageReader2(name)
    if not reader:
        sys.exit(f"{name}: VTK does not read it")
    reader.SetFileName(name)
    reader.Update()
    return reader.GetOutput()


def main():
    arguments = [a for a in sys.argv[1:] if a != "--vertex"]
    if len(arguments) not in (1, 2):
        sys.exit(__doc__)
    view = LookAround(read_image(arguments[0]), *arguments[1:], vertex="--vertex" in sys.argv)
    view.interactor.Initialize()
    view.window.Render()
    view.interactor.Start()


if __name__ == "__main__":
    main()
