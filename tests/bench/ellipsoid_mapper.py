#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""vtkAnamorphEllipsoidMapper, with and without leaving out what others hide, beside vtkGlyph3DMapper with spheres of facets: the time of a frame, and how many pixels
show another ellipsoid than vtkAnamorphFigureImage, which is exact, or none where it shows one, or one where it shows none.

Both draw the same ellipsoids with the same colors and light, in perspective, in turn in one run; each frame has another camera,
and is finished before the next. Buffers and shaders are made before the clock starts. Prints the medians and their ratios
to the first. Fails if more than 0.2% of vtkAnamorphEllipsoidMapper's pixels are wrong.

Needs plain VTK (not ParaView's, which is built for debugging), the module anamorph, and a screen, such as xvfb-run's."""
import argparse
import pathlib
import statistics
import sys
import time

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "vtk"))
from ellipsoid_scene import Scene, core_picture, crowd  # noqa: E402

from vtkmodules.vtkFiltersSources import vtkSphereSource  # noqa: E402
from vtkmodules.vtkRenderingCore import vtkGlyph3DMapper  # noqa: E402

import anamorph  # noqa: E402

MOST_WRONG = 0.002


def ray_cast(data, culling):
    mapper = anamorph.vtkAnamorphEllipsoidMapper()
    mapper.SetInputData(data)
    mapper.SetOcclusionCulling(mapper.ALWAYS if culling else mapper.NEVER)
    return mapper


def glyphs(data, facets):
    sphere, mapper = vtkSphereSource(), vtkGlyph3DMapper()
    sphere.SetRadius(1)
    sphere.SetThetaResolution(facets)
    sphere.SetPhiResolution(facets)
    mapper.SetInputData(data)
    mapper.SetSourceConnection(sphere.GetOutputPort())
    mapper.SetScaleArray("Axes")
    mapper.SetScaleModeToScaleByVectorComponents()
    mapper.SetOrientationArray("Orientation")
    mapper.SetOrientationModeToQuaternion()
    return mapper


def colored(mapper):
    mapper.SetScalarModeToUsePointFieldData()
    mapper.SelectColorArray("Color")
    return mapper


def frame_seconds(scene, frame):
    scene.look((4 * 0.3, 1 + 0.01 * frame, 4.5), angle=30)
    start = time.perf_counter()
    scene.window.Render()
    scene.window.WaitForCompletion()
    return time.perf_counter() - start


def wrong_pixels(mapper, data, size):
    scene = Scene(mapper, size, size)
    scene.look((1.2, 1, 4.5), angle=30)
    return (scene.ids() != core_picture(data, scene, anamorph.vtkAnamorphFigureImage.BODY_ID)).mean()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--count", type=int, default=2000, help="how many ellipsoids")
    parser.add_argument("--size", type=int, default=512, help="pixels of a side of the picture")
    parser.add_argument("--radius", type=float, default=0.03, help="of an ellipsoid; all are in a cube of side 2")
    parser.add_argument("--frames", type=int, default=15, help="how many frames of each are timed")
    parser.add_argument("--facets", type=int, default=48, help="of the spheres, each way; 0: no vtkGlyph3DMapper")
    arguments = parser.parse_args()
    data, facets = crowd(arguments.count, arguments.radius), arguments.facets
    makers = {"vtkAnamorphEllipsoidMapper": lambda data: ray_cast(data, True),
              "the same, all are drawn": lambda data: ray_cast(data, False)}
    if facets:
        makers[f"vtkGlyph3DMapper, {facets} x {facets}"] = lambda data: glyphs(data, facets)
    scenes = {name: Scene(colored(make(data)), arguments.size, arguments.size) for name, make in makers.items()}
    times = {name: [] for name in makers}
    for frame in range(-2, arguments.frames):
        for name, scene in scenes.items():
            seconds = frame_seconds(scene, frame)
            if frame >= 0:
                times[name].append(seconds)
    print(f"{arguments.count} ellipsoids, {arguments.size} x {arguments.size} pixels, median of {arguments.frames} frames")
    wrong = {name: wrong_pixels(make(data), data, arguments.size) for name, make in makers.items()}
    for name in makers:
        print(f"{name:28} {1000 * statistics.median(times[name]):9.2f} ms   {100 * wrong[name]:.4f}% of pixels wrong")
    medians = [statistics.median(each) for each in times.values()]
    print("ratios", *(f"{other / medians[0]:.1f}" for other in medians[1:]))
    if max(list(wrong.values())[:2]) > MOST_WRONG:
        sys.exit(f"more than {100 * MOST_WRONG}% of the pixels are wrong")


main()
