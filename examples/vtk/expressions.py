#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""A face out of a computed picture and 50 deformations, nine variants of it, and expressions made of these.

Usage: expressions.py [--size PIXELS] FOLDER

Writes FOLDER/variants.png (the face and its nine variants) and FOLDER/expressions.png (sums of variants, some with
weights outside 0 to 1). PIXELS is the width of one face. Without a display, run it under
xvfb-run -a -s "-screen 0 1280x1024x24 -noreset".

The way is that of Oka 1987, chapter 4: a plane is raised by a picture, bumps are added to it (section 4.1), edits of the
bumps make other shapes, and weighted sums of the shapes make the rest (section 4.2).
"""
import argparse
import os

import numpy as np
import vtkmodules.vtkRenderingFreeType  # noqa: F401
import vtkmodules.vtkRenderingOpenGL2  # noqa: F401
from anamorph import vtkAnamorphDeform, vtkAnamorphInbetween, vtkAnamorphReliefSource
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGWriter
from vtkmodules.vtkRenderingCore import (vtkActor, vtkDataSetMapper, vtkLight, vtkRenderer, vtkRenderWindow, vtkTextActor,
                                         vtkWindowToImageFilter)

WIDTH, HEIGHT = 1.6, 2.0  # of the plane; the face is around its middle, x to its left, y up

# Parts in the middle, and those on both sides (at x and -x): centre x, y, half axes x, y, displacement x, y, z.
MIDDLE = {
    "forehead": (0, 0.52, 0.30, 0.20, 0, 0, 0.05),
    "between brows": (0, 0.29, 0.06, 0.08, 0, 0, 0.03),
    "nose root": (0, 0.20, 0.05, 0.08, 0, 0, 0.03),
    "nose bridge": (0, 0.06, 0.055, 0.16, 0, 0, 0.11),
    "nose ridge": (0, -0.08, 0.06, 0.12, 0, 0, 0.11),
    "nose tip": (0, -0.16, 0.075, 0.07, 0, 0, 0.11),
    "nose base": (0, -0.25, 0.10, 0.04, 0, 0, -0.02),
    "philtrum": (0, -0.30, 0.03, 0.05, 0, 0, -0.02),
    "upper lip": (0, -0.375, 0.13, 0.04, 0, 0, 0.065),
    "lip line": (0, -0.425, 0.17, 0.016, 0, 0, -0.055),
    "lower lip": (0, -0.475, 0.12, 0.045, 0, 0, 0.075),
    "below the lip": (0, -0.56, 0.13, 0.04, 0, 0, -0.03),
    "chin": (0, -0.68, 0.14, 0.09, 0, 0, 0.08),
    "chin cleft": (0, -0.70, 0.025, 0.05, 0, 0, -0.01),
}
SIDES = {
    "eye socket": (0.23, 0.15, 0.15, 0.11, 0, 0, -0.10),
    "eyeball": (0.23, 0.14, 0.09, 0.06, 0, 0, 0.10),
    "upper lid": (0.23, 0.195, 0.11, 0.02, 0, 0, 0.03),
    "lower lid": (0.23, 0.085, 0.10, 0.02, 0, 0, 0.02),
    "brow, inner": (0.12, 0.285, 0.07, 0.04, 0, 0, 0.035),
    "brow, middle": (0.23, 0.31, 0.08, 0.04, 0, 0, 0.04),
    "brow, outer": (0.34, 0.28, 0.07, 0.04, 0, 0, 0.03),
    "temple": (0.50, 0.30, 0.10, 0.18, 0, 0, -0.04),
    "cheekbone": (0.38, 0.0, 0.14, 0.10, 0, 0, 0.05),
    "cheek": (0.33, -0.25, 0.13, 0.14, 0, 0, 0.02),
    "nostril wing": (0.085, -0.19, 0.04, 0.05, 0, 0, 0.06),
    "nostril": (0.045, -0.225, 0.02, 0.018, 0, 0, -0.05),
    "fold": (0.19, -0.28, 0.04, 0.10, 0, 0, -0.02),
    "mouth corner": (0.19, -0.425, 0.035, 0.035, 0, 0, -0.03),
    "upper lip, side": (0.09, -0.385, 0.06, 0.03, 0, 0, 0.025),
    "lower lip, side": (0.09, -0.465, 0.06, 0.03, 0, 0, 0.02),
    "jaw": (0.38, -0.50, 0.12, 0.16, 0, 0, 0.03),
    "ear": (0.62, 0.08, 0.05, 0.16, 0.04, 0, 0.10),
}

# What is added to the numbers of a part; an x is mirrored on the other side.
VARIANTS = {
    "smile": {"mouth corner": (0, 0, 0.05, 0.05, 0.04, 0.075, 0.01), "cheek": (0.02, 0.10, 0, -0.03, 0, 0, 0.06),
              "fold": (0.05, 0.03, 0.01, 0, 0, 0, -0.015), "lower lid": (0, 0.015, 0, 0.005, 0, 0, 0.02)},
    "sorrow": {"mouth corner": (0, 0, 0.05, 0.05, 0, -0.07, 0.01), "brow, inner": (0, 0, 0.02, 0.04, 0, 0.06, 0),
               "brow, outer": (0, 0, 0.02, 0.03, 0, -0.05, 0), "upper lid": (0, -0.02, 0, 0.01, 0, 0, 0),
               "chin": (0, 0.04, 0, 0, 0, 0, 0.03)},
    "anger": {"brow, inner": (0, 0, 0.03, 0.04, -0.04, -0.08, 0.03), "brow, middle": (0, -0.02, 0, 0, 0, -0.03, 0.02),
              "brow, outer": (0, 0, 0.02, 0.03, 0, 0.04, 0), "between brows": (0, 0, -0.02, 0, 0, 0, -0.05),
              "nostril wing": (0.02, 0.01, 0, 0, 0.01, 0.01, 0.02), "mouth corner": (0, 0, 0.03, 0.03, 0, -0.03, 0),
              "jaw": (0, 0, 0, 0, 0.02, 0, 0.03)},
    "surprise": {"brow, inner": (0, 0, 0.03, 0.06, 0, 0.045, 0), "brow, middle": (0, 0, 0.03, 0.06, 0, 0.05, 0),
                 "brow, outer": (0, 0, 0.03, 0.06, 0, 0.04, 0), "upper lid": (0, 0.02, 0, 0.01, 0, 0, 0.01),
                 "lip line": (0, -0.05, -0.07, 0.06, 0, 0, -0.12), "lower lip": (0, -0.11, -0.02, 0, 0, 0, 0),
                 "lower lip, side": (-0.02, -0.10, 0, 0, 0, 0, 0), "below the lip": (0, -0.08, 0, 0, 0, 0, 0),
                 "chin": (0, -0.06, 0, 0, 0, -0.03, 0), "mouth corner": (0, 0, 0.04, 0.04, -0.05, -0.03, 0.02)},
    "pout": {"upper lip": (0, 0, -0.05, 0.01, 0, 0, 0.06), "lower lip": (0, 0, -0.05, 0.01, 0, 0, 0.08),
             "mouth corner": (0, 0, 0.04, 0.05, -0.07, 0, 0.01), "cheek": (0, 0, 0, 0, 0, 0, -0.05)},
    "puffed cheeks": {"cheek": (0, -0.06, 0.03, 0.05, 0.03, 0, 0.15), "lip line": (0, 0, -0.03, 0, 0, 0, 0)},
    "closed eyes": {"eyeball": (0, 0, 0.02, 0.01, 0, 0, -0.03), "upper lid": (0, -0.075, 0, 0.02, 0, 0, 0.01),
                    "lower lid": (0, -0.01, 0, -0.005, 0, 0, -0.04), "brow, middle": (0, 0, 0, 0.02, 0, -0.02, 0)},
    "long nose": {"nose tip": (0, 0, 0, 0.01, 0, -0.06, 0.15), "nose ridge": (0, 0, 0, 0.02, 0, 0, 0.07),
                  "nose bridge": (0, 0, 0, 0, 0, 0, 0.03)},
    "broad jaw": {"jaw": (0.03, -0.04, 0.02, 0, 0.10, 0, 0.06), "chin": (0, 0, 0.06, 0, 0, -0.03, 0.04)},
}

# Weights of variants against the face; the rest of the weight is the face's.
EXPRESSIONS = {
    "smile 1.7": {"smile": 1.7},
    "smile -1": {"smile": -1},
    "smile 0.8, surprise 0.8": {"smile": 0.8, "surprise": 0.8},
    "anger 1.3, pout 0.7": {"anger": 1.3, "pout": 0.7},
    "sorrow 1, closed eyes 1": {"sorrow": 1, "closed eyes": 1},
    "long nose -0.6, broad jaw 1": {"long nose": -0.6, "broad jaw": 1},
    "left: smile; right: sorrow": {"smile": 1.2, "sorrow": 1.2},
    "surprise 1.2, anger -0.3": {"surprise": 1.2, "anger": -0.3},
}
MASKED = "left: smile; right: sorrow"


def head_picture(width=161, height=201):
    """The height of a head, 0 to 1: an ellipsoid, flat at its rim."""
    y, x = np.mgrid[-1:1:height * 1j, -0.8:0.8:width * 1j]
    inside = np.clip(1 - (x / 0.64) ** 2 - (y / 0.90) ** 2, 0, 1)
    picture = vtkImageData()
    picture.SetDimensions(width, height, 1)
    picture.GetPointData().SetScalars(numpy_to_vtk((inside ** 0.75).ravel().astype(np.float32), deep=True))
    return picture


def deformations(edits):
    """The 50 deformations, with a variant's edits: centre, extent and displacement in the plane's coordinates."""
    found = []
    for part, numbers in {**MIDDLE, **SIDES}.items():
        edited = np.array(numbers) + np.array(edits.get(part, (0,) * 7))
        found.append(edited)
        if part in SIDES:
            found.append(edited * (-1, 1, 1, 1, -1, 1, 1))
    return found


def shape(relief, edits):
    """A filter that deforms the relief."""
    deform = vtkAnamorphDeform()
    deform.SetInputConnection(relief.GetOutputPort())
    deform.SetParameterModeToPlane()
    deform.AutomaticPlaneOff()  # the defaults: parameters are x and y
    for x, y, extent_x, extent_y, *displacement in deformations(edits):
        deform.AddDeformation(x, y, extent_x, extent_y, *displacement)
    return deform


def with_regions(face):
    """The face as data, with the regions `left` and `right`: 0 to 1 over the nose's width."""
    face.Update()
    data = face.GetOutputDataObject(0)
    x = np.array([data.GetPoint(i)[0] for i in range(data.GetNumberOfPoints())])
    left = np.clip(x / 0.2 + 0.5, 0, 1)
    left = left * left * (3 - 2 * left)
    for name, values in ("left", left), ("right", 1 - left):
        array = numpy_to_vtk(values.astype(np.float32), deep=True)
        array.SetName(name)
        data.GetPointData().AddArray(array)
    return data


def expression(face, variants, weights, masks=()):
    """A filter that adds variants to the face by weights, in regions if given."""
    inbetween = vtkAnamorphInbetween()
    inbetween.SetModeToDeltas()
    inbetween.AddInputDataObject(face)
    for index, name in enumerate(VARIANTS, 1):
        inbetween.AddInputConnection(variants[name].GetOutputPort())
        inbetween.SetWeight(index, weights.get(name, 0))
        inbetween.SetMaskArrayName(index, dict(masks).get(name, ""))
    return inbetween


def renderer(source, title, viewport):
    """One surface, seen from its right, lit from above on the left."""
    mapper = vtkDataSetMapper()
    mapper.SetInputConnection(source.GetOutputPort())
    mapper.ScalarVisibilityOff()
    actor = vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetColor(0.86, 0.68, 0.55)
    actor.GetProperty().SetSpecular(0.15)
    actor.GetProperty().SetSpecularPower(20)
    text = vtkTextActor()
    text.SetInput(title)
    text.GetTextProperty().SetFontSize(13)
    text.SetPosition(6, 4)
    scene = vtkRenderer()
    scene.SetViewport(*viewport)
    scene.SetBackground(0.16, 0.18, 0.22)
    scene.AddActor(actor)
    scene.AddActor2D(text)
    scene.AutomaticLightCreationOff()
    for position, intensity in ((-1.5, 2, 3), 0.75), ((2, 0.3, 3), 0.35):
        light = vtkLight()
        light.SetPosition(*position)
        light.SetIntensity(intensity)
        scene.AddLight(light)
    camera = scene.GetActiveCamera()
    camera.SetPosition(1.2, 0.25, 4.9)
    camera.SetFocalPoint(0, 0, 0.15)
    camera.SetViewAngle(24)
    scene.ResetCameraClippingRange()
    return scene


def write_sheet(name, sources, across, size):
    """All of {title: filter} in one picture."""
    down = -(-len(sources) // across)
    window = vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(across * size, down * size * 5 // 4)
    for index, (title, source) in enumerate(sources.items()):
        column, row = index % across, down - 1 - index // across
        viewport = (column / across, row / down, (column + 1) / across, (row + 1) / down)
        window.AddRenderer(renderer(source, title, viewport))
    window.Render()
    grab = vtkWindowToImageFilter()
    grab.SetInput(window)
    grab.ReadFrontBufferOff()
    writer = vtkPNGWriter()
    writer.SetFileName(name)
    writer.SetInputConnection(grab.GetOutputPort())
    writer.Write()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--size", type=int, default=240)
    parser.add_argument("folder")
    arguments = parser.parse_args()
    os.makedirs(arguments.folder, exist_ok=True)

    relief = vtkAnamorphReliefSource()
    relief.SetInputData(head_picture())
    relief.SetSize(WIDTH, HEIGHT)
    relief.SetHeightScale(0.55)
    relief.SetSmoothing(1.5)
    face = shape(relief, {})
    variants = {name: shape(relief, edits) for name, edits in VARIANTS.items()}
    write_sheet(os.path.join(arguments.folder, "variants.png"), {"the face": face, **variants}, 5, arguments.size)

    base = with_regions(face)
    expressions = {}
    for title, weights in EXPRESSIONS.items():
        masks = {"smile": "left", "sorrow": "right"} if title == MASKED else {}
        expressions[title] = expression(base, variants, weights, masks)
    write_sheet(os.path.join(arguments.folder, "expressions.png"), expressions, 4, arguments.size)


if __name__ == "__main__":
    main()
