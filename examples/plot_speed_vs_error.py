#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Draws the table of `speed_vs_error --csv` as time per pixel against the largest error, one panel for each case.

Usage: plot_speed_vs_error.py [--cases NAME,NAME...] TABLE.csv PICTURE...

The endings of the pictures' names say their formats: .png, .svg, .pdf. Without --cases all cases are drawn. Only the largest size of the table is drawn, on one thread. A scheme that makes no error (or none that has a meaning,
as the copy of the bytes touched) is a dashed line. What fell back to the exact map at every pixel is not drawn.
"""
import argparse
import csv
import sys

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from whole_file import whole_file

COLUMNS = ("op case scheme tol_px size threads ns_per_px ratio_to_exact mean_error_px p99_error_px "
           "max_error_px bound_px exact_fraction cycles frames_per_second").split()
ROUNDING = 1e-9  # source pixels


def read_table(path):
    with open(path, newline="") as file:
        reader = csv.DictReader(file)
        if reader.fieldnames != COLUMNS:
            sys.exit(f"{path}: the columns are {reader.fieldnames}, expected are {COLUMNS}")
        rows = list(reader)
    if not rows:
        sys.exit(f"{path}: no rows")
    size = max(int(row["size"]) for row in rows)
    return size, [row for row in rows if int(row["size"]) == size and int(row["threads"]) == 1]


def error(row):
    """The largest error; 0 where it is that of rounding only, or has no meaning."""
    value = float(row["max_error_px"])
    return value if value > ROUNDING else 0.0


def draw_case(axes, rows, colors):
    # Schemes that coincide stay visible: the first are drawn the widest.
    for i, (scheme, color) in enumerate(colors.items()):
        mine = [row for row in rows if row["scheme"] == scheme]
        points = sorted((error(row), float(row["ns_per_px"])) for row in mine)
        inexact = [point for point in points if point[0] > 0]
        if inexact:
            axes.plot(*zip(*inexact), "o-", color=color, label=scheme, markersize=4, linewidth=max(1, 4 - i))
        elif points:
            axes.axhline(points[0][1], color=color, linestyle="--", linewidth=1, label=scheme)
    axes.set(xscale="log", yscale="log", title=rows[0]["case"], xlabel="largest error, source pixels")
    axes.grid(True, which="both", linewidth=0.3)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cases", help="those to draw, separated by commas")
    parser.add_argument("table")
    parser.add_argument("picture", nargs="+")
    arguments = parser.parse_args()

    size, rows = read_table(arguments.table)
    cases = list(dict.fromkeys(row["case"] for row in rows))
    if arguments.cases:
        unknown = set(arguments.cases.split(",")) - set(cases)
        if unknown:
            sys.exit(f"{arguments.table}: no case {', '.join(sorted(unknown))}")
        cases = arguments.cases.split(",")
        rows = [row for row in rows if row["case"] in cases]
    schemes = list(dict.fromkeys(row["scheme"] for row in rows))
    colors = {scheme: plt.get_cmap("tab20" if len(schemes) > 10 else "tab10")(i) for i, scheme in enumerate(schemes)}

    across = min(len(cases), 3)
    down = -(-len(cases) // across)
    figure, panels = plt.subplots(down, across, figsize=(4.6 * across + 1.8, 3.6 * down), squeeze=False, sharex=True,
                                  sharey=True)
    for case, axes in zip(cases, panels.flat):
        draw_case(axes, [row for row in rows if row["case"] == case], colors)
    for axes in panels.flat[len(cases):]:
        axes.set_visible(False)
    for axes in panels[:, 0]:
        axes.set_ylabel("ns per pixel, 1 thread")

    entries = {}
    for axes in panels.flat[:len(cases)]:
        for handle, label in zip(*axes.get_legend_handles_labels()):
            entries.setdefault(label, handle)
    figure.legend(entries.values(), entries.keys(), loc="center right", fontsize=8)
    figure.suptitle(f"Time against error, {rows[0]['op']}, {size} x {size}")
    figure.tight_layout(rect=(0, 0, 1 - 1.9 / figure.get_figwidth(), 1))
    for picture in arguments.picture:
        with whole_file(picture) as name:
            figure.savefig(name, dpi=110)


if __name__ == "__main__":
    main()
