# SPDX-License-Identifier: Apache-2.0
"""In the panel of Inbetween a weight stands beside its input's name, and is typed there."""
import time

import numpy as np
from shown_deform import run

SCRIPT = """
import json, os
from paraview.simple import *
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())
GetSettingsProxy("GeneralSettings").AutoApply = 1
shapes = [Sphere(registrationName=name, Radius=radius) for name, radius in (("MMMMMMMM", 1), ("i", 2))]
between = AnamorphInbetween(Input=shapes, NormalizeWeights=1)
view = GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground, view.Background, view.OrientationAxesVisibility = 0, [0, 1, 0], 0
try:
    view.BackgroundColorMode = "Single Color"
except Exception:
    pass
Show(between, view)
SetActiveSource(between)
Render(view)


def tell(*_):
    with open({folder!r} + "/state.new", "w") as file:
        json.dump({{"size": list(view.GetRenderWindow().GetSize()), "pixel": 1, "weights": list(between.Weights),
                   "bounds": list(between.GetDataInformation().GetBounds())}}, file)
    os.replace({folder!r} + "/state.new", {folder!r} + "/state")


view.GetRenderWindow().AddObserver("EndEvent", tell)
tell()
"""


def names_of(picture):
    """The rows of the table below the filter's name: where each is, and how many pixels wide what is written in its first column."""
    white = (picture > 250).all(axis=2)
    left = white[:, 10:96]
    marks = left[:, :2].all(axis=1) & (left.mean(axis=1) > .2) & (np.arange(len(left)) > 480)  # before what is written
    steps = np.diff(np.concatenate([[0], marks.astype(np.int8), [0]]))
    rows = [(begin, end) for begin, end in zip((steps == 1).nonzero()[0], (steps == -1).nonzero()[0]) if end - begin > 10]
    inks = [(~left[begin + 2:end - 2]).any(axis=0).nonzero()[0] for begin, end in rows]
    return [((begin + end) // 2, np.ptp(ink) + 1) for (begin, end), ink in zip(rows, inks)]


def drive(shown):
    screen = shown.screen
    shown.save("weights")
    rows = names_of(screen.picture()[:, :shown.left - 10].astype(int))
    assert len(rows) == 2 and rows[0][1] > 60 and rows[1][1] < 8, rows
    assert shown.state()["weights"] == []

    def edit(row, text):
        screen.move(200, rows[row][0])
        for down in (True, False, True, False):
            screen.test.XTestFakeButtonEvent(screen.display, 1, int(down), 0)
        screen.x11.XSync(screen.display, 0)
        time.sleep(1)
        screen.type(text)

    def wait_for_radius(radius):  # to the facets of the sphere's default resolution
        shown.wait_for(lambda: abs(shown.state()["bounds"][5] - radius) < 1e-6)

    edit(1, "3")
    shown.wait_for(lambda: shown.state()["weights"] == [0, 3])
    wait_for_radius(2)
    edit(0, "1")
    shown.wait_for(lambda: shown.state()["weights"] == [1, 3])
    wait_for_radius(1.75)
    shown.save("weights_edited")


run(__file__, 333, drive, script=SCRIPT)
