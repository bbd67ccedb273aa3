# SPDX-License-Identifier: Apache-2.0
"""Figures of ellipsoids as arrays: scripts of NUDES that are performed, and motions of other programs (.bvh, .cif, .3).

    motion = anamorph.figures.perform("walker.nudes")
    for frame in motion:
        print(frame.number, frame.centers)     # (bodies, 3), in units of the window of 1000
    lines = motion[12].outlines((640, 480))    # hidden lines removed
"""
import os as _os

from . import _core
from ._checks import encoded as _encoded
from ._checks import integer as _integer

__all__ = ["Frame", "Line", "Motion", "perform", "read"]


class Line:
    """A line of an outline. `body`: the position of its body in the frame; `kind`: visible or hidden; `points`: an array (n, 2) of pixels from
    the upper left corner, x right, y down."""

    def __init__(self, body, kind, points):
        self.body, self.kind, self.points = body, kind, points

    def __repr__(self):
        return f"<anamorph.figures.Line of body {self.body}, {self.kind}, {len(self.points)} points>"


class Frame:
    """Figures at one moment. A body is the points center + rotation @ (axes * x), |x| <= 1.

    number: of the frame. names: of the bodies. figures: names of the figures, of which body i has figures[figure_of[i]].
    centers, axes: arrays (bodies, 3), in units, x right, y up. rotations: (bodies, 3, 3). colors: (bodies, 3), 0 to 255.
    joints: (name, body, body, (x, y, z)) of each.
    """

    def __init__(self, core):
        self._core = core
        self.number, self.names, self.figures = core.number, core.names, core.figures
        self.figure_of, self.joints = core.figure_of, core.joints
        self.centers, self.axes, self.rotations, self.colors = core.centers, core.axes, core.rotations, core.colors

    def outlines(self, size, *, tol=0.1, hidden="remove", crossings=False):
        """The outlines of the bodies as Lines on a picture of `size`, (width, height) in pixels, from far to near; chords are off by at most
        `tol` pixels. hidden="keep": also the lines that bodies hide. `crossings`: also the curves in which bodies pass through each other."""
        width, height = (float(side) for side in size)
        if not (0 < width <= 1e6 and 0 < height <= 1e6):
            raise ValueError(f"size={size}: must be (width, height), each above 0, at most 1e+06")
        return [Line(*line) for line in self._core.outlines(width, height, float(tol), str(hidden), bool(crossings))]

    def __repr__(self):
        return f"<anamorph.figures.Frame {self.number} of {', '.join(self.figures)}: {len(self.names)} bodies>"


class Motion:
    """Frames, one after the other: motion[12] is frame 12, as its script counts; frame 0 is the figures at rest. Iterating gives those that are
    shown. A frame has the same bits in whatever order they are asked for."""

    def __init__(self, core):
        self._core = core

    @property
    def numbers(self):
        """The numbers of the frames that are shown: a range."""
        return range(self._core.first(), self._core.last() + 1, self._core.step())

    @property
    def rate(self):
        """How many frames a second are meant."""
        return self._core.rate()

    @property
    def warnings(self):
        """What of a file is not shown as it says."""
        return self._core.warnings()

    def __getitem__(self, number):
        return Frame(self._core.frame(_integer("frame", number)))

    def __len__(self):
        return len(self.numbers)

    def __iter__(self):
        return (self[number] for number in self.numbers)


def perform(script, *, strict=False, name="script"):
    """The Motion of a script of NUDES: a file by its name, or the text itself, which has line ends. `strict`: the dialect as the language is
    documented. What a file includes is looked for in its folder. Raises Error with the first error of the script."""
    if isinstance(script, str) and "\n" in script:
        return Motion(_core.Motion.of_text(_encoded(script, "script"), _encoded(name, "name"), bool(strict)))
    return read(script, strict=strict)


def read(file, *, strict=False):
    """The Motion of a file, by its ending: .bvh, .cif, .3, .mrasel; any other is a script."""
    path = _os.fsdecode(file)
    if path == "-":
        raise ValueError("file=-: must be the name of a file")
    return Motion(_core.Motion.of_file(_encoded(path, "file"), bool(strict)))
