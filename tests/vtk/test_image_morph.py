# SPDX-License-Identifier: Apache-2.0
# vtkAnamorphImageMorph against numpy: the maps of Beier and Neely's lines written out, images of other sizes and places, polylines, files, the border,
# parts, and what is refused.
import json
import math

import anamorph
import numpy as np
from conformance import Source, errors_of, pixels, steps_of, time_of
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkPoints
from vtkmodules.vtkCommonDataModel import vtkCellArray, vtkImageData, vtkPolyData

seed = 29
print("seed", seed)
random = np.random.default_rng(seed)
WIDTH, HEIGHT, ORIGIN, SPACING = 120, 90, (3.0, -2.0, 5.0), (0.5, 0.5, 1.0)


def first(i, j):
    """At a pixel's index, from the left and from below; smooth, and never 0."""
    return 3 + np.sin(i / 11 + 1) * np.cos(j / 9) + 0.3 * np.sin((i + 2 * j) / 17)


def second(i, j):
    return 5 + np.cos(i / 13) * np.sin(j / 8 + 2)


def image(value, kind=np.float32, size=(WIDTH, HEIGHT), origin=ORIGIN, spacing=SPACING, name="height", components=1):
    made = vtkImageData()
    made.SetDimensions(*size, 1)
    made.SetOrigin(origin)
    made.SetSpacing(spacing)
    j, i = np.mgrid[0:size[1], 0:size[0]]
    numbers = value(i * (WIDTH - 1) / (size[0] - 1), j * (HEIGHT - 1) / (size[1] - 1)).astype(kind).ravel()
    array = numpy_to_vtk(np.repeat(numbers[:, None], components, 1), deep=True)
    array.SetName(name)
    made.GetPointData().SetScalars(array)
    return made


def lines_of(chains, origin=ORIGIN, spacing=SPACING):
    """Polylines through places, in indices."""
    made, points, cells = vtkPolyData(), vtkPoints(), vtkCellArray()
    points.SetDataTypeToDouble()
    for chain in chains:
        cells.InsertNextCell(len(chain))
        for i, j in chain:
            cells.InsertCellPoint(points.InsertNextPoint(origin[0] + i * spacing[0], origin[1] + j * spacing[1], origin[2]))
    made.SetPoints(points)
    made.SetLines(cells)
    return made


def morph(a=None, b=None, lines=(), **properties):
    made = anamorph.vtkAnamorphImageMorph()
    made.SetInputDataObject(0, a or image(first))
    made.SetInputDataObject(1, b or image(second))
    for port, chains in enumerate(lines):
        if chains is not None:
            made.SetInputDataObject(2 + port, chains if isinstance(chains, vtkPolyData) else lines_of(chains))
    made.SetInterpolation(made.CUBIC)
    for name, argument in properties.items():
        getattr(made, "Set" + name)(argument)
    return made


def drawn(made):
    said = errors_of(made)
    assert not said, said
    return pixels(made.GetOutput())[:, :, 0]


def source_points(x, y, target, source, a=1, b=2, p=0.5):
    """Where a point comes from (Kim 2003, eq. 5.9 to 5.11), by lines (x0, y0, x1, y1) as they are in the target and in the source."""
    total, sum_x, sum_y = 0, 0, 0
    for (px, py, qx, qy), (sx, sy, tx, ty) in zip(target, source):
        length, other = math.hypot(qx - px, qy - py), math.hypot(tx - sx, ty - sy)
        u = ((x - px) * (qx - px) + (y - py) * (qy - py)) / length**2
        v = ((x - px) * -(qy - py) + (y - py) * (qx - px)) / length
        to_x, to_y = sx + u * (tx - sx) - v * (ty - sy) / other, sy + u * (ty - sy) + v * (tx - sx) / other
        apart = np.where(u < 0, np.hypot(x - px, y - py), np.where(u > 1, np.hypot(x - qx, y - qy), np.abs(v)))
        weight = (length**p / (a + apart))**b
        total, sum_x, sum_y = total + weight, sum_x + weight * (to_x - x), sum_y + weight * (to_y - y)
    return x + sum_x / total, y + sum_y / total


J, I = np.mgrid[0:HEIGHT, 0:WIDTH].astype(float)


def expected(lines_a, lines_b, shape, color, **weights):
    """The blend, and where both images are well inside."""
    lines_a, lines_b = np.array(lines_a), np.array(lines_b)
    target = (1 - shape) * lines_a + shape * lines_b
    at = [source_points(I, J, target, lines, **weights) for lines in (lines_a, lines_b)]
    inside = np.all([(i > 2) & (i < WIDTH - 3) & (j > 2) & (j < HEIGHT - 3) for i, j in at], axis=0)
    return (1 - color) * first(*at[0]) + color * second(*at[1]), inside


def compare(picture, wanted, most=3e-3):
    value, inside = wanted
    off = np.abs(picture - value)[inside]
    assert inside.sum() > 2000 and off.max() < most, (inside.sum(), off.max())


def chains_of(lines):
    return [[line[:2], line[2:]] for line in lines]


LINES_A = [(20, 20, 60, 25), (80, 15, 100, 60), (30, 70, 70, 75), (60, 40, 62, 55)]
LINES_B = [(24, 26, 58, 22), (76, 20, 104, 58), (34, 66, 66, 78), (57, 43, 66, 54)]
CHAINS = chains_of(LINES_A), chains_of(LINES_B)

# At the ends it is one of the images, bit for bit, and without lines a plain blend.
for kind in (np.float32, np.uint8, np.uint16):
    a, b = image(lambda i, j: 40 * first(i, j), kind), image(lambda i, j: 30 * second(i, j), kind)
    for shape, whole in ((0, a), (1, b)):
        assert (drawn(morph(a, b, CHAINS, Shape=shape, Tolerance=0)) == pixels(whole)[:, :, 0]).all(), (kind, shape)
    blend = drawn(morph(a, b, Shape=0.25))
    assert np.abs(blend - (0.75 * pixels(a) + 0.25 * pixels(b))[:, :, 0]).max() <= (0.501 if kind != np.float32 else 1e-4), kind
out = morph(lines=CHAINS)
drawn(out)
assert 0 <= out.GetMaxError() <= 0.01
assert out.GetOutput().GetFieldData().GetArray("anamorph:max_error").GetValue(0) == out.GetMaxError()
out = out.GetOutput()
assert out.GetOrigin() == ORIGIN and out.GetSpacing() == SPACING and out.GetExtent() == image(first).GetExtent()
assert out.GetPointData().GetScalars().GetName() == "height"

# By the formula, with color beside the shape and other weights too.
compare(drawn(morph(lines=CHAINS)), expected(LINES_A, LINES_B, 0.5, 0.5))
compare(drawn(morph(lines=CHAINS, Shape=0.3, Color=0.8, ColorFollowsShape=False)), expected(LINES_A, LINES_B, 0.3, 0.8))
compare(drawn(morph(lines=CHAINS, Shape=0.7, WeightA=4.0, WeightB=1.5, WeightP=1.0)), expected(LINES_A, LINES_B, 0.7, 0.7, a=4, b=1.5, p=1))

# Polylines are the lines between their points.
vertices = [[(20, 20), (60, 25), (80, 70)], [(24, 26), (58, 22), (84, 66)]]
apart = [[line[:2] for line in (chain, chain[1:])] for chain in vertices]
assert (drawn(morph(lines=[[vertices[0]], [vertices[1]]])) == drawn(morph(lines=apart))).all()

# The second image may be of another size, elsewhere in space; its lines are where it is.
size, origin, spacing = (239, 179), (-7.0, 11.0, 0.0), (2.0, 0.25, 1.0)
large = image(second, size=size, origin=origin, spacing=spacing, name="other")
# Pixels are scaled by their edges.
to_large = lambda k, n, big: (k + 0.5) * big / n - 0.5
lines_large = [[(to_large(i, WIDTH, size[0]), to_large(j, HEIGHT, size[1])) for i, j in chain] for chain in CHAINS[1]]
picture = drawn(morph(None, large, [CHAINS[0], lines_of(lines_large, origin, spacing)], Shape=0.4))
target = 0.6 * np.array(LINES_A) + 0.4 * np.array(LINES_B)
at = [source_points(I, J, target, np.array(lines)) for lines in (LINES_A, LINES_B)]
in_large = [to_large(at[1][k], n, big) * (n - 1) / (big - 1) for k, n, big in ((0, WIDTH, size[0]), (1, HEIGHT, size[1]))]
inside = np.all([(i > 2) & (i < WIDTH - 3) & (j > 2) & (j < HEIGHT - 3) for i, j in at], axis=0)
compare(picture, (0.6 * first(*at[0]) + 0.4 * second(*in_large), inside))

# A file of features has pixels from the upper left, whose centres are at halves.
pixel = lambda line: [line[0] + 0.5, HEIGHT - 0.5 - line[1], line[2] + 0.5, HEIGHT - 0.5 - line[3]]
with open("lines.json", "w") as file:
    json.dump({"features": [{"line": [pixel(a), pixel(b)]} for a, b in zip(LINES_A, LINES_B)]}, file)
with open("lines.csv", "w") as file:
    file.write("".join(",".join(map(str, pixel(a) + pixel(b))) + "\n" for a, b in zip(LINES_A, LINES_B)))
by_lines = drawn(morph(lines=CHAINS))
for name in ("lines.json", "lines.csv"):
    assert (drawn(morph(FileName=name)) == by_lines).all(), name

# The border is held as by lines along it.
edges = [(-.5, -.5, WIDTH - .5, -.5), (WIDTH - .5, -.5, WIDTH - .5, HEIGHT - .5), (WIDTH - .5, HEIGHT - .5, -.5, HEIGHT - .5), (-.5, HEIGHT - .5, -.5, -.5)]
compare(drawn(morph(lines=CHAINS, PinBorder=1.0)), expected(LINES_A + edges, LINES_B + edges, 0.5, 0.5))

# Any part is the same.
for extent in ([10, 30, 5, 60, 0, 0], [0, 119, 44, 44, 0, 0], [119, 119, 89, 89, 0, 0]):
    part = morph(lines=CHAINS)
    part.UpdateExtent(extent)
    assert part.GetOutput().GetExtent() == tuple(extent)
    x0, x1, y0, y1, _, _ = extent
    assert (pixels(part.GetOutput())[:, :, 0] == by_lines[y0:y1 + 1, x0:x1 + 1]).all()

# The array of the first one's name is taken of the second, whichever is active there.

other = numpy_to_vtk(np.zeros(WIDTH * HEIGHT, np.float32), deep=True)
other.SetName("zero")
named = image(second)
named.GetPointData().SetScalars(other)
named.GetPointData().AddArray(image(second).GetPointData().GetScalars())
assert (drawn(morph(None, named, CHAINS)) == by_lines).all()

# Lines that move over time, while the images do not.
over_time = Source(lambda time: lines_of(chains_of([np.add(line, 2 * time) for line in LINES_B])), [0, 1, 2])
timed = morph(lines=CHAINS)
timed.SetOtherLinesConnection(over_time.GetOutputPort())
assert steps_of(timed) == [0, 1, 2], steps_of(timed)
for time in (2, 0, 1):
    timed.UpdateTimeStep(time)
    assert time_of(timed.GetOutput()) == time
    compare(pixels(timed.GetOutput())[:, :, 0], expected(LINES_A, np.array(LINES_B) + 2 * time, 0.5, 0.5))


# What is refused, in words.
def refused(words, *arguments, **properties):
    said = errors_of(morph(*arguments, **properties))
    assert words in said, (words, said)


refused("the lines over the second image are not given", None, None, [CHAINS[0]])
refused("the lines over the first image are not given", None, None, [None, CHAINS[1]])
refused("there are 4 lines over the first image and 3 over the second: must be as many", None, None, [CHAINS[0], CHAINS[1][:3]])
refused("line 1 has 3 points over the first image and 2 over the second: must have as many", None, None, [[vertices[0]], [vertices[1][:2]]])
refused("line 2", None, None, [[*CHAINS[0][:1], [(5, 5), (5, 5)]], CHAINS[1][:2]])
refused("line 1", None, None, [[[(math.nan, 5), (5, 5)]], CHAINS[1][:1]])
refused("must not be given together with lines", None, None, CHAINS, FileName="lines.json")
refused("nowhere.json: cannot be read", FileName="nowhere.json")
with open("three.json", "w") as file:
    json.dump({"features": [{"line": [pixel(LINES_A[0])] * 3}]}, file)
refused("features of 3 images: must have those of 2", FileName="three.json")
refused("the second image has 1 components of unsigned char, but must be as the first, which has 1 of float", None, image(second, np.uint8))
refused("the second image has 2 components", None, image(second, components=2))
refused("): Shape=nan: must be a number from 0 to 1\n", Shape=math.nan)
for name in ("WeightA", "WeightB", "WeightP", "PinBorder", "Tolerance"):
    refused(f"): {name}=nan: must be", None, None, CHAINS, **{name: math.nan})
refused("): Color=nan: must be a number from 0 to 1\n", Color=math.nan, ColorFollowsShape=False)
# Lines through points that there are not.
for port, name in enumerate(("first", "second")):
    for ids, last in (((0, 2), 1), ((0, 1 << 40), 1), ((-1, 0), 1), ((0, 1), None)):
        beside, cell = lines_of([[(5, 5), (9, 9)]]), vtkCellArray()
        cell.InsertNextCell(2, ids)
        beside.SetLines(cell)
        if last is None:
            beside.SetPoints(vtkPoints())
        missing = ids[1] if last and ids[1] > last else ids[0]
        lines = [CHAINS[0][:1], CHAINS[1][:1]]
        lines[port] = beside
        refused(f"line 1 over the {name} image goes through point {missing}: the points are {f'0 to {last}' if last else 'none'}", None, None,
                lines)
alone = anamorph.vtkAnamorphImageMorph()
assert "the first image is not given" in errors_of(alone)
alone.SetInputDataObject(0, image(first))
assert "the second image is not given" in errors_of(alone)
for name, values in {"Shape": ((-1.0, 0), (2.0, 1)), "WeightB": ((17.0, 16),), "Tolerance": ((-1.0, 0),)}.items():
    for given, kept in values:
        getattr(alone, "Set" + name)(given)
        assert getattr(alone, "Get" + name)() == kept, name
print("image morph: as it should be")
