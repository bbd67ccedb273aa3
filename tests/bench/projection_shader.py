#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Panoramas on a room, drawn by OpenGL: frames and fragments a second, and errors, of vtkAnamorphProjectionShader's three modes beside
what VTK has, which has no tolerance: vtkProjectedTexture (a picture of 90 degrees; Kim 2003 calls it conventional projective
texture mapping) and vtkTextureMapToSphere, both of which give the vertices of a mesh texture coordinates; and
vtkAnamorphPanoramaProjection, which does so within a tolerance. Their vertices a second are those of the filter. With occluders the
room hides itself, by a map of 1024 texels a face that is drawn once.

Every pixel of the window shows the room, whose walls have CELLS x CELLS quads. Errors are in texels, of pictures whose texels have their
place as their color, read without interpolation, against the formulas of this file in double: at their middle half a texel
is right. Times are of whole frames until OpenGL has finished, the median of the rounds, with bilinear interpolation.

Needs plain VTK (not ParaView's, which is built for debugging), the module anamorph, and a screen, such as xvfb-run's: there Mesa
draws with the processor. Fails if a mode of the shader is off by more than it may be."""
import argparse
import csv
import statistics
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkUnsignedCharArray
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkFiltersCore import vtkAppendPolyData
from vtkmodules.vtkFiltersModeling import vtkProjectedTexture
from vtkmodules.vtkFiltersSources import vtkPlaneSource
from vtkmodules.vtkFiltersTexture import vtkTextureMapToSphere
from vtkmodules.vtkRenderingCore import vtkActor, vtkPolyDataMapper, vtkRenderer, vtkRenderWindow, vtkTexture
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401: it is what draws

from anamorph import vtkAnamorphPanoramaProjection, vtkAnamorphPanoramaProjector, vtkAnamorphProjectionShader

HALF, CELLS, POSITION, EYE, VIEW_ANGLE = 2.0, 16, np.array([-0.3, 0.2, 0.1]), np.array([0.4, 0.3, 0.7]), 80.0
MODES = ("direct", "residual", "multipass")
# Texels, half of one and a little: what a mode that is measured may be off.
MOST = 0.6


def room():
    """The six walls."""
    walls = vtkAppendPolyData()
    for axis in range(3):
        for side in (-HALF, HALF):
            corner = np.full(3, -HALF)
            corner[axis] = side
            plane, a, b = vtkPlaneSource(), corner.copy(), corner.copy()
            a[(axis + 1) % 3] = b[(axis + 2) % 3] = HALF
            plane.SetOrigin(corner)
            plane.SetPoint1(a)
            plane.SetPoint2(b)
            plane.SetResolution(CELLS, CELLS)
            walls.AddInputConnection(plane.GetOutputPort())
    walls.Update()
    mesh = walls.GetOutput()
    mesh.GetPointData().Initialize()
    return mesh


def texture(width, height, places):
    """Colors that tell the place, or smooth ones that can be interpolated."""
    y, x = np.mgrid[0:height, 0:width]
    colors = [x % 256, y % 256, x // 256 + y // 256 * 16] if places else [x * 255 // width, y * 255 // height, x * 0 + 99]
    rows = np.ascontiguousarray(np.stack(colors, -1).astype(np.uint8)[::-1]).reshape(-1, 3)
    image, made = vtkImageData(), vtkTexture()
    image.SetDimensions(width, height, 1)
    image.GetPointData().SetScalars(numpy_to_vtk(rows, deep=True))
    made.SetInputData(image)
    made.SetInterpolate(not places)
    made.SetQualityTo32Bit()
    return made


class Window:
    def __init__(self, mesh):
        self.actor, self.renderer, self.window, self.mapper = vtkActor(), vtkRenderer(), vtkRenderWindow(), vtkPolyDataMapper()
        self.mapper.SetInputData(mesh)
        self.actor.SetMapper(self.mapper)
        self.actor.GetProperty().LightingOff()
        self.renderer.AddActor(self.actor)
        self.window.SetOffScreenRendering(1)
        self.window.SetMultiSamples(0)
        self.window.AddRenderer(self.renderer)
        camera = self.renderer.GetActiveCamera()
        camera.SetPosition(EYE)
        camera.SetFocalPoint(EYE - (0, 0, 1))
        camera.SetViewAngle(VIEW_ANGLE)
        camera.SetClippingRange(0.01, 20)

    def picture(self, size):
        self.window.SetSize(*size)
        self.window.Render()
        pixels = vtkUnsignedCharArray()
        self.window.GetPixelData(0, 0, size[0] - 1, size[1] - 1, 0, pixels, 0)
        return vtk_to_numpy(pixels).reshape(size[1], size[0], 3)[::-1].astype(int)

    def seconds(self, size, rounds):
        self.window.SetSize(*size)
        self.window.Render()
        times = []
        for _ in range(rounds):
            begin = time.perf_counter()
            self.window.Render()
            self.window.WaitForCompletion()
            times.append(time.perf_counter() - begin)
        return statistics.median(times)


def seen_points(size):
    """The point of the room that each pixel shows."""
    width, height = size
    j, i = np.mgrid[0:height, 0:width]
    scale = 2 * np.tan(np.radians(VIEW_ANGLE / 2)) / height
    way = np.stack([(i + 0.5 - width / 2) * scale, -(j + 0.5 - height / 2) * scale, -np.ones(i.shape)], -1)
    with np.errstate(divide="ignore"):
        far = ((np.where(way > 0, HALF, -HALF) - EYE) / way).min(-1)
    return EYE + way * far[..., None]


def equirectangular(points, width, height):
    x, y, z = np.moveaxis(points - POSITION, -1, 0)
    return (np.arctan2(x, -z) / (2 * np.pi) + 0.5) * width, (0.5 - np.arctan2(y, np.hypot(x, z)) / np.pi) * height


def rectilinear(points, width, height):
    """90 degrees across; NaN beside it."""
    x, y, z = np.moveaxis(points - POSITION, -1, 0)
    with np.errstate(invalid="ignore", divide="ignore"):
        u, v = np.where(z < 0, x / -z, np.nan), np.where(z < 0, y / -z, np.nan)
    u, v = np.where(np.abs(u) < 1, u, np.nan), np.where(np.abs(v) < height / width, v, np.nan)
    return (u + 1) * width / 2, height / 2 - v * width / 2


def worst(picture, truth, width):
    """The largest distance, in texels, and the share of pixels off by more than one."""
    x, y = picture[..., 0] + picture[..., 2] % 16 * 256 + 0.5, picture[..., 1] + picture[..., 2] // 16 * 256 + 0.5
    across = np.abs(x - truth[0])
    off = np.fmax(np.minimum(across, np.abs(width - across)), np.abs(y - truth[1]))
    off = off[np.isfinite(off)]
    return off.max(), (off > 1).mean()


def vertices_a_second(make, rounds):
    """Of a filter, and what it gives."""
    times = []
    for _ in range(rounds):
        filter_ = make()
        begin = time.perf_counter()
        filter_.Update()
        times.append(time.perf_counter() - begin)
    output = filter_.GetOutputDataObject(0)
    return output.GetNumberOfPoints() / statistics.median(times), output


def sphere(mesh):
    coordinates = vtkTextureMapToSphere()
    coordinates.SetInputData(mesh)
    coordinates.SetAutomaticSphereGeneration(False)
    coordinates.SetCenter(POSITION)
    coordinates.SetPreventSeam(False)
    return coordinates


def slide(mesh, width, height):
    coordinates = vtkProjectedTexture()
    coordinates.SetInputData(mesh)
    coordinates.SetPosition(POSITION)
    coordinates.SetFocalPoint(POSITION - (0, 0, 1))
    coordinates.SetUp(0, 1, 0)
    coordinates.SetAspectRatio(2, 2 * height / width, 1)
    return coordinates


def cut(mesh, width, height):
    projection = vtkAnamorphPanoramaProjection()
    projection.SetInputData(mesh)
    projection.SetPanoramaWidth(width)
    projection.SetPanoramaHeight(height)
    projection.SetPosition(POSITION)
    projection.SetOcclusion(False)
    return projection


def sphere_truth(points, width, height):
    """vtkTextureMapToSphere's poles are on z, the one on -z at the bottom, and its seam is towards x."""
    x, y, z = np.moveaxis(points - POSITION, -1, 0)
    return np.arctan2(y, x) % (2 * np.pi) / (2 * np.pi) * width, np.arctan2(np.hypot(x, y), -z) / np.pi * height


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--sizes", default="640x480,1024x768,1920x1080,3840x2160", help="of the window, in pixels")
    parser.add_argument("--width", type=int, default=2048, help="of the panorama, to 3584 texels")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--csv", help="a file for the table")
    arguments = parser.parse_args()
    sizes = [tuple(int(n) for n in size.split("x")) for size in arguments.sizes.split(",")]
    width, height, mesh = arguments.width, arguments.width // 2, room()
    points, rows, failed = seen_points(sizes[0]), [], False

    def report(name, show, truth, speed=None):
        """`show(window, places)` sets a window up."""
        window = Window(mesh)
        show(window, True)
        off = worst(window.picture(sizes[0]), truth, width) if truth else None
        window = Window(mesh)
        show(window, False)
        for size in sizes:
            seconds = window.seconds(size, arguments.rounds)
            rows.append({"case": name, "size": f"{size[0]}x{size[1]}", "frames_per_s": 1 / seconds,
                         "fragments_per_s": size[0] * size[1] / seconds, "vertices_per_s": speed or "",
                         "worst_texels": off[0] if off else "", "share_off_by_one": off[1] if off else ""})
            print("{case:24} {size:>10} {frames_per_s:9.1f} frames/s {fragments_per_s:10.3g} fragments/s".format(**rows[-1]),
                  "  worst {:8.3f} texels, {:.3%} off by more than one".format(*off) if off else "",
                  f"  {speed:.3g} vertices/s" if speed else "", flush=True)
        return off[0] if off else 0

    for mode, hides in [(mode, False) for mode in MODES] + [("direct", True)]:
        def throw(window, places, mode=mode, hides=hides):
            window.shader, projector = vtkAnamorphProjectionShader(), vtkAnamorphPanoramaProjector()
            if hides:
                projector.SetOccluderData(mesh)
            projector.SetPanorama(texture(width, height, places))
            projector.SetPosition(POSITION)
            window.shader.AddProjector(projector)
            window.shader.SetMode(MODES.index(mode))
            window.shader.SetPlaneSize(2048)
            window.shader.AddTo(window.actor)
        # Mode multipass reads a picture that was read before, in which colors are no places; tests/vtk/projector measures it.
        truth = equirectangular(points, width, height) if mode != "multipass" else None
        off = report("shader " + mode + ", occluders" * hides, throw, truth)
        failed = failed or off > MOST

    # Concentric mosaics, of which plain VTK has nothing like it; tests/vtk/projector measures where texels are read.
    for circles in (2, 16):
        def throw_mosaic(window, places, circles=circles):
            window.shader, projector = vtkAnamorphProjectionShader(), vtkAnamorphPanoramaProjector()
            projector.SetPanorama(texture(width, circles * (width // 16), places))
            projector.SetProjectionName("cylindrical")
            projector.SetCircles(circles)
            projector.SetCircleRadius(HALF / 2)
            projector.SetPosition(POSITION)
            window.shader.AddProjector(projector)
            window.shader.AddTo(window.actor)
        report(f"shader mosaic, {circles} circles", throw_mosaic, None)

    def by_coordinates(output, size):
        def show(window, places):
            window.mapper.SetInputData(output)
            window.actor.SetTexture(texture(*size, places))
        return show

    for name, make, size, truth in (
            ("panorama projection", lambda: cut(mesh, width, height), (width, height), equirectangular(points, width, height)),
            ("vtkTextureMapToSphere", lambda: sphere(mesh), (width, height), sphere_truth(points, width, height)),
            ("vtkProjectedTexture", lambda: slide(mesh, width, height), (width, height), rectilinear(points, width, height))):
        speed, output = vertices_a_second(make, arguments.rounds)
        report(name, by_coordinates(output, size), truth, speed)
    if arguments.csv:
        with open(arguments.csv, "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys())
            writer.writeheader()
            writer.writerows(rows)
    if failed:
        sys.exit("a mode of the shader is off by more than it may be")


if __name__ == "__main__":
    main()
