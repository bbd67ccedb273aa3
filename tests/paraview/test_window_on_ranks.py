# SPDX-License-Identifier: Apache-2.0
"""ParaView's window as the client of a server of two ranks, each of which has half of the sphere, with the plugin by PV_PLUGIN_PATH on both sides: a click selects
the bump that is there, whichever half it is on, Ctrl and a click make a new one, a dragged handle shows the surface live, and Apply makes it so. Seen
from above."""
import math
import time

from shown_deform import run

ROWS = [0, -.45, .3, .3, 0, 0, .3, 0, 1, 0, .45, .3, .3, 0, 0, .3, 0, 1]


def drive(shown):
    near = 4 * shown.pixel

    def is_near(found, wanted):
        return all(abs(f - w) < near for f, w in zip(found, wanted))

    shown.save("ranks")
    assert shown.state()["ranks"] == 2, shown.state()
    assert shown.state()["selected"] == 0 and is_near(shown.state()["places"]["SelectedCenter"], (0, -.45))
    for selected, v in ((1, .45), (0, -.45)):
        shown.click(.1, v + .15 * (-1 if v < 0 else 1))
        shown.wait_for(lambda: shown.state()["selected"] == selected)
        shown.wait_for(lambda: is_near(shown.state()["places"]["SelectedCenter"], (0, v, math.sqrt(1 - v * v) + .3)))

    # Of the centre's handle, with the button held: the list is as it was, and there is no bump any more where it was.
    before, screen = shown.state(), shown.screen

    def near_the_bump():
        size, half = before["size"], int(.2 / shown.pixel)
        column, row = size[0] // 2, int(size[1] / 2 + .45 / shown.pixel)
        return shown.view()[row - half:row + half, column - half:column + half]

    time.sleep(1)
    seen, outline = near_the_bump(), shown.surface()
    start = shown.of_view(before["handles"]["SelectedCenter"])
    screen.move(start[0] + 1, start[1])
    screen.move(*start)
    screen.button(True)
    for i in range(1, 9):
        screen.move(start[0] + i / 8 * .7 / shown.pixel, start[1])
    shown.wait_for(lambda: (abs(near_the_bump() - seen).max(axis=2) > 10).mean() > .5)
    shown.save("ranks_live")
    assert shown.state()["list"] == before["list"]
    screen.button(False)
    shown.apply()
    shown.wait_for(lambda: is_near(shown.state()["list"], (.7, -.45)))
    assert shown.state()["list"][2:] == ROWS[2:], shown.state()["list"]
    shown.wait_for(lambda: is_near(shown.state()["places"]["SelectedCenter"], (.7, -.45, math.sqrt(1 - .45 ** 2 - .49) + .3)))

    shown.click(-.9, 0, control=True)
    shown.wait_for(lambda: len(shown.state()["list"]) == 27 and shown.state()["selected"] == 2)
    shown.wait_for(lambda: shown.state()["bounds"][0] < -1.1)
    row = shown.state()["list"][18:]
    # The vector is along the normal of the facet that is there.
    normal = (*row[:2], math.sqrt(1 - row[0] ** 2 - row[1] ** 2))
    assert is_near(row, (-.9, 0)) and all(abs(x / .3 - n) < .08 for x, n in zip(row[4:7], normal)), row
    time.sleep(2)
    shown.save("ranks_placed")
    assert ((shown.surface() & ~outline).sum() * shown.pixel ** 2) > .02


run(__file__, 332, drive, settings=f"Deformations={ROWS}, Depths=[0, 0, 1, 0, 0, 1]", position="[0, 0, 7]", focus="[0, 0, 0]", up="[0, 1, 0]", ranks=2,
    auto_apply=0)
