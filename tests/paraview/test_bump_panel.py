# SPDX-License-Identifier: Apache-2.0
"""The table of bumps in Deform's panel, as it is seen on the screen: rows are counted from 0, as Selected counts, whose row is marked; centre, extent and
vector are seen without scrolling and are edited there; a click on a row's number selects its bump, whose handles are then in the view."""
import time

import numpy as np
from shown_deform import run

ROWS = [-.4, 0, .3, .3, 0, 0, .3, 0, 1, .4, 0.125, .3, .3, 1 / 3, -.1234567, .3, 0, 1]


def stretches(marks):
    """Where a row of marks is set: begins and ends."""
    steps = np.diff(np.concatenate([[0], marks.astype(np.int8), [0]]))
    return list(zip((steps == 1).nonzero()[0], (steps == -1).nonzero()[0]))


class Panel:
    """The marked row of the table, which is found by its color, and its cells, between lines of the grid."""

    def __init__(self, shown):
        self.picture = shown.screen.picture()[:, :shown.left].astype(int)
        is_marked = (abs(self.picture - [48, 140, 198]).max(axis=2) < 12)
        self.top, self.bottom = stretches(is_marked.sum(axis=1) > 80)[-1]  # the pipeline's are above
        self.cells = stretches(is_marked[self.top:self.bottom].mean(axis=0) > .3)
        self.height = self.bottom - self.top + 1

    def is_at(self, other, down):
        """Is the mark so many rows below that of another panel?"""
        return abs(self.top - other.top - down * other.height) <= 3

    def middle(self, cell):
        return (self.cells[cell][0] + self.cells[cell][1]) // 2, (self.top + self.bottom) // 2

    def number_of_row(self, down=0):
        """Where the number of a row is, which is beside its first cell."""
        return self.cells[0][0] - 8, (self.top + self.bottom) // 2 + down * self.height

    def glyph(self, at):
        """What is written about a place, cut out: 0 is the background, 1 the ink."""
        around = self.picture[at[1] - self.height // 2 + 3:at[1] + self.height // 2 - 2, at[0] - 5:at[0] + 6].mean(axis=2)
        ink = abs(around - np.median(around))
        ink /= ink.max()
        rows, columns = (ink > .4).nonzero()
        return ink[rows.min():rows.max() + 1, columns.min():columns.max() + 1]


def are_alike(one, other):
    return one.shape == other.shape and np.corrcoef(one.ravel(), other.ravel())[0, 1] > .9


def drive(shown):
    screen = shown.screen

    def edit(cell, text):
        at = Panel(shown).middle(cell)
        screen.move(*at)
        for down in (True, False, True, False):
            screen.test.XTestFakeButtonEvent(screen.display, 1, int(down), 0)
        screen.x11.XSync(screen.display, 0)
        time.sleep(1)
        screen.type(text)

    shown.save("panel")
    panel = Panel(shown)
    # Of the marked row c v is 0, and so is its number; the next one's is not.
    zero = panel.glyph((panel.cells[1][0] + 6, panel.middle(1)[1]))
    assert are_alike(panel.glyph(panel.number_of_row()), zero)
    assert not are_alike(panel.glyph(panel.number_of_row(1)), zero)

    # Cells that are whole before the panel ends: c u, c v, a u, a v, V x, V y and V z.
    assert len(panel.cells) >= 7, panel.cells
    edit(6, "0.45")
    shown.wait_for(lambda: shown.state()["list"] == ROWS[:6] + [.45] + ROWS[7:])
    edit(3, "0.2")
    shown.wait_for(lambda: shown.state()["list"] == ROWS[:3] + [.2, 0, 0, .45] + ROWS[7:])

    # Undo and redo have each of them, to the bit.
    for key, wanted in (("z", ROWS[:6] + [.45] + ROWS[7:]), ("z", ROWS), ("y", ROWS[:6] + [.45] + ROWS[7:]),
                        ("y", ROWS[:3] + [.2, 0, 0, .45] + ROWS[7:])):
        shown.press(key)
        shown.wait_for(lambda: shown.state()["list"] == wanted)

    at = panel.number_of_row(1)
    screen.move(*at)
    screen.button(True)
    screen.button(False)
    shown.wait_for(lambda: shown.state()["selected"] == 1)
    shown.wait_for(lambda: abs(shown.state()["places"]["SelectedCenter"][0] - .4) < 1e-9)
    shown.wait_for(lambda: Panel(shown).is_at(panel, 1))
    # What has more digits than there is room for keeps them where it is not edited.
    edit(0, "0.5")
    shown.wait_for(lambda: shown.state()["list"][9:] == [.5] + ROWS[10:])
    # And a click in the view marks the row.
    shown.click(-.4, 0)
    shown.wait_for(lambda: shown.state()["selected"] == 0)
    shown.wait_for(lambda: Panel(shown).is_at(panel, 0))
    shown.save("panel_edited")


run(__file__, 331, drive, settings=f"Deformations={ROWS}, Depths=[0, 0, 1, 0, 0, 1]", position="[0, 0, 7]", focus="[0, 0, 0]", up="[0, 1, 0]")
