# SPDX-License-Identifier: Apache-2.0
"""In ParaView's window a click on a bump of Deform selects it, and a click with Ctrl makes a new one where the surface was clicked, which stands
out of it there; the handles follow. Seen from above."""
import math
import time

import numpy as np
from shown_deform import run

ROWS = [-.4, 0, .3, .3, 0, 0, .3, 0, 1, .4, 0, .3, .3, 0, 0, .3, 0, 1]


def drive(shown):
    near = 4 * shown.pixel

    def is_near(found, wanted):
        return all(abs(f - w) < near for f, w in zip(found, wanted))

    assert shown.state()["selected"] == 0 and is_near(shown.state()["places"]["SelectedCenter"], (-.4, 0))
    shown.click(.55, -.12)
    shown.wait_for(lambda: shown.state()["selected"] == 1)
    shown.wait_for(lambda: is_near(shown.state()["places"]["SelectedCenter"], (.4, 0, math.sqrt(.84) + .3)))
    # Which is one step of undo, the handles too, and of redo.
    shown.press("z")
    shown.wait_for(lambda: shown.state()["selected"] == 0 and is_near(shown.state()["places"]["SelectedCenter"], (-.4, 0)))
    shown.press("y")
    shown.wait_for(lambda: shown.state()["selected"] == 1 and is_near(shown.state()["places"]["SelectedCenter"], (.4, 0, math.sqrt(.84) + .3)))
    shown.click(-.55, -.12)
    shown.wait_for(lambda: shown.state()["selected"] == 0)
    # Nothing is there, and nothing beside the surface.
    for place in ((0, -.8), (1.5, 1)):
        shown.click(*place)
        time.sleep(2)
        assert shown.state()["selected"] == 0 and shown.state()["list"] == ROWS
    before = shown.surface()
    shown.click(0, .9, control=True)
    shown.wait_for(lambda: len(shown.state()["list"]) == 27)
    shown.wait_for(lambda: shown.state()["selected"] == 2 and shown.state()["bounds"][3] > 1.1)
    time.sleep(2)
    shown.save("placed")
    row = shown.state()["list"][18:]
    assert is_near(row, (0, .9)) and row[2:4] == [.3, .3], row
    assert is_near([x / .3 for x in row[4:7]], (0, .9, math.sqrt(.19))), row
    # It is seen beyond the sphere's edge, and nothing else has moved.
    after = shown.surface()
    rows, columns = (after & ~before).nonzero()
    size = shown.state()["size"]
    assert len(rows) * shown.pixel ** 2 > 0.02, len(rows)
    # Beside it there is the corner's handle.
    column, row = np.median(columns), np.median(rows)
    assert abs((column - size[0] / 2) * shown.pixel) < 0.1 and row < size[1] / 2 - 0.9 / shown.pixel, (column, row, size, shown.pixel)
    # The click is one step of undo, and of redo, to the bit.
    placed = shown.state()["list"]
    shown.press("z")
    shown.wait_for(lambda: shown.state()["list"] == ROWS and shown.state()["selected"] == 0)
    shown.press("y")
    shown.wait_for(lambda: shown.state()["list"] == placed and shown.state()["selected"] == 2)


run(__file__, 328, drive, settings=f"Deformations={ROWS}, Depths=[0, 0, 1, 0, 0, 1]", position="[0, 0, 7]", focus="[0, 0, 0]", up="[0, 1, 0]")
