# SPDX-License-Identifier: Apache-2.0
# host: pvpython
"""Anamorph Image Warp behind Anamorph Deform on a Plane: what Deform's bump moves in the plane, it moves in the image, whenever the bump
is another; and by a mesh that Transform turns, the image turns. Anamorph Image Morph between images with a Line over each: it goes with the lines, over time too."""
import os

import numpy as np
from paraview.simple import *
from paraview.vtk.util.numpy_support import vtk_to_numpy

LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())
SIDE = 81
image = Wavelet(WholeExtent=[-40, 40, -40, 40, 0, 0], XFreq=4, YFreq=3, ZFreq=0)
image.UpdatePipeline()
plane = Plane(Origin=[-40, -40, 0], Point1=[40, -40, 0], Point2=[-40, 40, 0], XResolution=40, YResolution=40)


def pixels(source):
    source.UpdatePipeline()
    data = servermanager.Fetch(source)
    assert data.GetExtent() == (-40, 40, -40, 40, 0, 0)
    return vtk_to_numpy(data.GetPointData().GetScalars()).reshape(SIDE, SIDE).astype(float)


GIVEN = pixels(image)


def bilinear(x, y):
    """Of the image at world coordinates; nothing beyond."""
    x, y = x + 40, y + 40
    i, j = np.clip(np.floor(x).astype(int), 0, SIDE - 2), np.clip(np.floor(y).astype(int), 0, SIDE - 2)
    s, t = x - i, y - j
    return (1 - t) * ((1 - s) * GIVEN[j, i] + s * GIVEN[j, i + 1]) + t * ((1 - s) * GIVEN[j + 1, i] + s * GIVEN[j + 1, i + 1])


Y, X = np.mgrid[-40:41, -40:41].astype(float)
deform = AnamorphDeform(Input=plane, AutomaticPlane=0, Origin=[-40, -40, 0], Axis1=[80, 0, 0], Axis2=[0, 80, 0],
                        Deformations=[0.5, 0.5, .2, .2, 0, 0, 0, 0, 1])
warp = AnamorphImageWarp(Input=image, Mesh=deform, Interpolation="Linear")
assert np.abs(pixels(warp) - GIVEN).max() < 1e-3 * np.ptp(GIVEN), "a bump of no height"


def moved(x, y, vector, centre=(0, 0), extent=16):
    f = np.exp(-((x - centre[0]) ** 2 + (y - centre[1]) ** 2) / extent**2)
    return x + vector[0] * f, y + vector[1] * f


# The bump is dragged about, as its handles do: what was at p is seen at p + V F.
for vector, centre in (((5, -3), (0, 0)), ((-6, 4), (0, 0)), ((3, 5), (-8, 6))):
    deform.Deformations = [(centre[0] + 40) / 80, (centre[1] + 40) / 80, .2, .2, *vector, 0, 0, 1]
    # By fixed point: q = p + V F(p).
    x, y = X.copy(), Y.copy()
    for _ in range(200):
        at = moved(x, y, vector, centre)
        x, y = x + 0.7 * (X - at[0]), y + 0.7 * (Y - at[1])
    inside = (np.abs(x) < 38) & (np.abs(y) < 38)
    # The mesh of 40 x 40 follows the bump to some hundredths of a pixel.
    off = np.abs(pixels(warp) - bilinear(x, y))[inside].max() / np.ptp(GIVEN)
    assert off < 0.01, (vector, off)
    assert 0 <= warp.GetPropertyValue("MaxError") <= 0.01
turned = Transform(Input=plane)
turned.Transform.Rotate = [0, 0, 30]
other = AnamorphImageWarp(Input=image, Mesh=turned, Interpolation="Linear", Direction="Pull")
c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
x, y = c * X - s * Y, s * X + c * Y
inside = (np.abs(x) < 39) & (np.abs(y) < 39)
assert np.abs(pixels(other) - bilinear(x, y))[inside].max() < 1e-3 * np.ptp(GIVEN)

# One line, or two, as far up over the second image: the first one's color in the second one's shape is as far up.
second = Wavelet(WholeExtent=[-40, 40, -40, 40, 0, 0], XFreq=2, YFreq=5, ZFreq=0)
lines = [Line(Point1=[-20, y, 0], Point2=[20, y, 0], Resolution=1) for y in (0, 10)]
for source in (second, *lines):
    source.UpdatePipeline()
SetActiveSource(image)
morph = AnamorphImageMorph(Input=image, Other=second, Lines=lines[0], OtherLines=lines[1], Interpolation="Linear", ColorFollowsShape=0, Shape=1, Color=0)
assert np.abs(pixels(morph)[10:] - GIVEN[:-10]).max() < 1e-3 * np.ptp(GIVEN)
lines[1].Point1, lines[1].Point2 = [-20, -5, 0], [20, -5, 0]
assert np.abs(pixels(morph)[:-5] - GIVEN[5:]).max() < 1e-3 * np.ptp(GIVEN), "the line was moved"
more = [AppendGeometry(Input=[line, Transform(Input=line)]) for line in lines]
for both in more:
    both.Input[1].Transform.Translate = [0, 30, 0]
morph.Lines, morph.OtherLines = more
assert np.abs(pixels(morph)[:-5] - GIVEN[5:]).max() < 1e-3 * np.ptp(GIVEN), "two lines"
morph.ColorFollowsShape = 1
scene = GetAnimationScene()
scene.StartTime, scene.EndTime = 0, 1
track = GetAnimationTrack("Shape", proxy=morph)
track.KeyFrames = [CompositeKeyFrame(KeyTime=0, KeyValues=[0]), CompositeKeyFrame(KeyTime=1, KeyValues=[1])]
for time, whole in ((0, GIVEN), (1, pixels(second))):
    scene.AnimationTime = time
    assert morph.Shape == time and np.abs(pixels(morph) - whole).max() < 1e-3 * np.ptp(GIVEN), time
print("image warp: as it should be")
