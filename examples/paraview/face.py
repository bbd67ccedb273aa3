# SPDX-License-Identifier: Apache-2.0
"""Raises a face from a picture by 50 deformations, makes nine faces of it by editing parts, synthesises expressions by
weights, and films them: Figures 4.4 to 4.6 of Oka 1987 in our own pictures.

Usage, with the plugin's folder in PV_PLUGIN_PATH, after xvfb-run -a -s "-screen 0 1280x1024x24 -noreset" where there is
no screen:
    pvbatch face.py OUT [--frames 73] [--points 257]

Writes to the folder OUT: face.png (the picture), raised.png (before, after, and the bumps), variants.png,
expressions.png, film.0000.png and so on, face.json (the list of deformations) and face.pvsm (the film as a state of
ParaView: load it, play it, edit it).
"""
import argparse
import os

import face_model as model
from paraview.simple import *
from paraview.vtk import vtkImageData
from paraview.vtk.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkIOImage import vtkPNGWriter

arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
arguments.add_argument("out")
arguments.add_argument("--frames", type=int, default=73)
arguments.add_argument("--points", type=int, default=257, help="of the surface along each side")
given = arguments.parse_args()
out = os.path.abspath(given.out)
os.makedirs(out, exist_ok=True)


def write_picture(rgb, path):
    image = vtkImageData()
    image.SetDimensions(rgb.shape[1], rgb.shape[0], 1)
    image.GetPointData().SetScalars(numpy_to_vtk(rgb.reshape(-1, 3), deep=1))
    writer = vtkPNGWriter()
    writer.SetFileName(path)
    writer.SetInputDataObject(image)
    writer.Write()


write_picture(model.picture(), out + "/face.png")
texture = CreateTexture(out + "/face.png")
texture.UpdateVTKObjects()  # ParaView 5.13 does not do so itself

# Brightness is the first guess of height; the deformations do the rest.
relief = AnamorphReliefSource(registrationName="relief", FileName=out + "/face.png", HeightScale=0.02, Smoothing=2,
                              Resolution=[given.points, given.points], GenerateNormals=1)
relief.UpdatePipeline()


def deformed(name, rows):
    return AnamorphDeform(registrationName=name, Input=relief, Deformations=model.flat(rows))


def new_view(width, height, half_height, centre=(0, 0)):
    view = CreateView("RenderView")
    view.ViewSize = [width, height]
    view.UseColorPaletteForBackground = 0
    view.Background = [0.10, 0.13, 0.18]
    view.OrientationAxesVisibility = 0
    view.CameraParallelProjection = 1
    view.CameraParallelScale = half_height
    view.CameraFocalPoint = [*centre, 0.1]
    view.CameraPosition = [*centre, 4]
    view.CameraViewUp = [0, 1, 0]
    return view


def move(shown, orientation, position):
    """ParaView 6 calls a representation's position its translation."""
    shown.Orientation = orientation
    setattr(shown, "Translation" if "Translation" in shown.ListProperties() else "Position", position)


def show(source, view, place=(0, 0), turn=28):
    """Lays the picture on a surface and shows it from a little aside, as a portrait is."""
    shown = Show(source, view)
    shown.SetRepresentationType("Surface")
    ColorBy(shown, ("POINTS", ""))
    shown.DiffuseColor = shown.AmbientColor = [1, 1, 1]
    shown.Texture = texture
    shown.Interpolation = "Gouraud"
    shown.Ambient, shown.Diffuse, shown.Specular = 0.25, 0.85, 0.1
    move(shown, [-8, turn, 0], [*place, 0])
    return shown


def write_sheet(columns, sources, name):
    """A picture of surfaces side by side, the first one on the upper left."""
    rows = -(-len(sources) // columns)
    view = new_view(220 * columns, 240 * rows, 0.55 * rows, (0.5 * (columns - 1), -0.55 * (rows - 1)))
    for i, source in enumerate(sources):
        show(source, view, (i % columns, -1.1 * (i // columns)))
    SaveScreenshot(f"{out}/{name}.png", view, ImageResolution=view.ViewSize)
    Delete(view)


# The face, and the bumps it is made of (Figures 4.1 and 4.4).
face = deformed("face", model.rows())
face.GenerateOverlay = 1
face.ExportFile = out + "/face.json"
view = new_view(900, 330, 0.55, (1.0, 0))
show(relief, view, (0, 0))
show(face, view, (1, 0))
show(face, view, (1, 0))
bumps = Show(OutputPort(face, 1), view)
move(bumps, [-8, 28, 0], [2, 0, 0])
bumps.DiffuseColor = bumps.AmbientColor = [1, 0.6, 0.2]
SaveScreenshot(out + "/raised.png", view, ImageResolution=view.ViewSize)
Delete(view)

# Nine faces by editing parts (Figure 4.5).
variants = [deformed(name, rows) for name, rows in model.VARIANTS.items()]
write_sheet(3, variants, "variants")
for variant in variants:
    Delete(variant)

# Expressions by weights, from the opposite of an expression to half as much again (Figure 4.6).
expressions = [deformed(name, model.rows(added=bumps)) for name, bumps in model.EXPRESSIONS.items()]
shapes = [face] + expressions
blends = []
for shape in range(1, len(shapes)):
    for amount in (-0.5, 0, 0.5, 1, 1.5):
        weights = [1 - amount] + [amount if i == shape else 0 for i in range(1, len(shapes))]
        blends.append(AnamorphInbetween(Input=shapes, Weights=weights))
write_sheet(5, blends, "expressions")
for blend in blends:
    Delete(blend)

# The film: key frames of weights (neutral, smile, surprise, anger) over time, and a bump that moves.
KEYS = {0: (1, 0, 0, 0), 1: (0, 1, 0, 0), 2: (1, 0, 0, 0), 3: (-0.2, 0, 1.2, 0), 4: (0, 0.6, 0.4, 0),
        5: (-0.3, 0, 0, 1.3), 6: (1, 0, 0, 0)}
film = AnamorphInbetween(registrationName="film", Input=shapes, Interpolation="Catmull-Rom",
                         Keys=[float(n) for time, weights in KEYS.items() for i, w in enumerate(weights)
                               for n in (time, i, w)])
film.UpdatePipelineInformation()
view = new_view(480, 480, 0.55)
view.ViewTime = 0
shown = show(film, view, turn=0)
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
scene.PlayMode = "Sequence"
scene.NumberOfFrames = given.frames
scene.StartTime, scene.EndTime = 0, 6
turn = GetAnimationTrack("Orientation", index=1, proxy=shown)
turn.KeyFrames = [CompositeKeyFrame(KeyTime=time, KeyValues=[angle])
                  for time, angle in ((0, -35), (0.5, 35), (1, -35))]
nose = GetAnimationTrack("Deformations", index=9 * model.first_of("nose") + 9 * 3 + 6, proxy=face)
nose.KeyFrames = [CompositeKeyFrame(KeyTime=time, KeyValues=[height])
                  for time, height in ((0, 0.05), (0.5, 0.12), (1, 0.05))]
for name, track in (("turn", turn), ("nose", nose)):
    for key in track.KeyFrames:  # a state has what is registered, and nothing else
        servermanager.ProxyManager().RegisterProxy("animation", f"{name} {key.KeyTime}", key.SMProxy)
SaveAnimation(out + "/film.png", view, ImageResolution=view.ViewSize, FrameWindow=[0, given.frames - 1])
scene.GoToFirst()
SaveState(out + "/face.pvsm")
print(f"{len(model.rows())} deformations, {len(model.VARIANTS)} faces, {len(model.EXPRESSIONS)} expressions, "
      f"{given.frames} frames: {out}")
