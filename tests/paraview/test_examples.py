# SPDX-License-Identifier: Apache-2.0
"""The example makes its pictures, which show what they say; its film is in its state; the scaling script runs."""
import glob
import os
import subprocess
import sys
import tempfile

import numpy as np
from display import xvfb_run

SOURCE = os.environ["ANAMORPH_SOURCE_DIR"]
ENVIRONMENT = {**os.environ, "PV_PLUGIN_PATH": os.path.dirname(os.environ["ANAMORPH_PLUGIN"]),
               "LIBGL_ALWAYS_SOFTWARE": "1"}
AGAIN = """
from paraview.simple import *
LoadState({folder!r} + "/face.pvsm")
film = FindSource("film")
assert list(film.TimestepValues) == [0, 1, 2, 3, 4, 5, 6], list(film.TimestepValues)
assert len(FindSource("face").Deformations) == 50 * 9
tracks = [cue for cue in GetAnimationScene().Cues if cue.GetXMLName() == "KeyFrameAnimationCue"]
assert [[key.KeyValues[0] for key in track.KeyFrames] for track in tracks] == [[-35, 35, -35], [0.05, 0.12, 0.05]], tracks
SaveScreenshot({folder!r} + "/again.png", GetActiveView() or GetViews()[0], ImageResolution=[480, 480])
"""
READ = """
import sys
import numpy as np
from paraview.vtk.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader
for path in sys.argv[1:]:
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    image = reader.GetOutput()
    np.save(path + ".npy", vtk_to_numpy(image.GetPointData().GetScalars()).reshape(*image.GetDimensions()[1::-1], -1))
"""


def run(*command):
    done = subprocess.run(command, env=ENVIRONMENT, capture_output=True, text=True, timeout=250)
    assert done.returncode == 0, (command, done.stdout[-2000:], done.stderr[-4000:])
    return done.stdout


def script(folder, name, text):
    with open(f"{folder}/{name}", "w") as file:
        file.write(text)
    return f"{folder}/{name}"


def difference(a, b):
    return np.abs(a.astype(int) - b.astype(int)).mean()


def check_face(folder):
    printed = run(*xvfb_run(301), "pvbatch", SOURCE + "/examples/paraview/face.py", folder, "--frames", "4",
                  "--points", "97")
    assert "50 deformations, 9 faces, 3 expressions, 4 frames" in printed, printed
    run(*xvfb_run(302), "pvbatch", script(folder, "again.py", AGAIN.format(folder=folder)))
    paths = sorted(glob.glob(folder + "/*.png"))
    assert len(paths) == 4 + 4 + 1, paths
    run("pvpython", script(folder, "read.py", READ), *paths)
    pictures = {os.path.basename(path)[:-4]: np.load(path + ".npy") for path in paths}
    for name, picture in pictures.items():
        assert picture.std() > 20, (name, "is blank")

    # Cells of the sheets, upper left first. Every variant differs from the first face.
    def cells(sheet, rows, columns):
        return [cell for row in reversed(np.array_split(sheet, rows)) for cell in np.array_split(row, columns, axis=1)]
    first, *others = cells(pictures["variants"], 3, 3)
    assert all(difference(first, other) > 0.1 for other in others), [difference(first, other) for other in others]
    # Along a row of expressions the weight grows: the second is the face itself, and the farther the more it differs.
    for row in np.array_split(np.arange(15), 3):
        expressions = cells(pictures["expressions"], 3, 5)
        opposite, face, half, whole, more = (expressions[i] for i in row)
        assert difference(face, half) < difference(face, whole) < difference(face, more), row
        assert difference(face, opposite) > 0.1, row
    # The state shows the film's first frame.
    assert difference(pictures["again"], pictures["film.0000"]) < 1, difference(pictures["again"], pictures["film.0000"])
    assert difference(pictures["film.0000"], pictures["film.0001"]) > 1


with tempfile.TemporaryDirectory() as made:
    check_face(made)
table = run(sys.executable, SOURCE + "/examples/paraview/scaling.py", "--points", "65", "--bumps", "5")
assert [line.split()[0] for line in table.splitlines()] == ["ranks", "1", "2"], table
