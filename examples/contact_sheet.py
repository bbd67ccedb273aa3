#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Puts pictures on one sheet, three in a row, each under its file's name.

Usage: contact_sheet.py SHEET.png PICTURE.png...
"""
import pathlib
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from whole_file import whole_file

ACROSS = 3


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    pictures = [pathlib.Path(name) for name in sys.argv[2:]]
    down = -(-len(pictures) // ACROSS)
    figure, panels = plt.subplots(down, ACROSS, figsize=(5 * ACROSS, 3.9 * down), squeeze=False)
    for axes in panels.flat:
        axes.set_axis_off()
    for axes, picture in zip(panels.flat, pictures):
        axes.imshow(plt.imread(picture))
        axes.set_title(picture.stem.replace("_", " "))
    figure.tight_layout()
    with whole_file(sys.argv[1]) as name:
        figure.savefig(name, dpi=80)


if __name__ == "__main__":
    main()
