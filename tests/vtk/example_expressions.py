# SPDX-License-Identifier: Apache-2.0
"""Runs examples/vtk/expressions.py and compares its pictures with those in baseline/, shrunk to blocks.

Usage: example_expressions.py [--write] EXAMPLE.py FOLDER

Drivers differ in single pixels, not in the means of blocks: 1.5 levels of 255 of mean difference and 12 of largest are let
pass. Two faces that are different shapes differ by more. --write makes the baseline anew.
"""
import os
import runpy
import sys

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonDataModel import vtkImageData
from vtkmodules.vtkIOImage import vtkPNGReader, vtkPNGWriter

SIZE, BLOCK = 120, 10
BASELINE = os.path.join(os.path.dirname(os.path.abspath(__file__)), "baseline")


def read(name):
    """The levels of a picture, 0 to 255, [y, x], of colour pictures the mean of the channels."""
    reader = vtkPNGReader()
    reader.SetFileName(name)
    reader.Update()
    image = reader.GetOutput()
    width, height, _ = image.GetDimensions()
    return vtk_to_numpy(image.GetPointData().GetScalars()).reshape(height, width, -1).mean(axis=2)


def write(name, levels):
    image = vtkImageData()
    image.SetDimensions(levels.shape[1], levels.shape[0], 1)
    image.GetPointData().SetScalars(numpy_to_vtk(np.rint(levels).astype(np.uint8).ravel(), deep=True))
    writer = vtkPNGWriter()
    writer.SetFileName(name)
    writer.SetInputData(image)
    writer.Write()


def blocks(levels):
    height, width = levels.shape
    return levels.reshape(height // BLOCK, BLOCK, width // BLOCK, BLOCK).mean(axis=(1, 3))


writing = "--write" in sys.argv
example, folder = sys.argv[-2:]
sys.argv = [example, "--size", str(SIZE), folder]
names = runpy.run_path(example, run_name="__main__")
assert len(names["deformations"]({})) == 50 and len(names["VARIANTS"]) == 9
for sheet, across, down in ("variants", 5, 2), ("expressions", 4, 2):
    picture = read(os.path.join(folder, sheet + ".png"))
    assert picture.shape == (down * SIZE * 5 // 4, across * SIZE), picture.shape
    small = blocks(picture)
    if writing:
        write(os.path.join(BASELINE, sheet + ".png"), small)
    wanted = read(os.path.join(BASELINE, sheet + ".png"))
    difference = np.abs(small - wanted)
    assert difference.mean() <= 1.5 and difference.max() <= 12, (sheet, difference.mean(), difference.max())
    tile_rows = np.split(picture, down)
    tiles = [tile[:-20] for row in tile_rows for tile in np.split(row, across, axis=1)]  # without the titles
    for i, tile in enumerate(tiles):
        for other in tiles[:i]:
            assert np.abs(tile - other).max() > 12, (sheet, i)
