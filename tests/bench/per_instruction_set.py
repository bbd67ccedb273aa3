#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""per_instruction_set.py SPEED_VS_ERROR [--sets AVX3,AVX2,SSE4] [--tol 0.01] [options of speed_vs_error]

Runs speed_vs_error once for every instruction set and prints a Markdown table: for each case, ns a pixel at one
tolerance, and how many times faster that is than the best of the other programs and loops in the same run. Loops and
libraries that are compared with choose their instructions themselves.
"""
import argparse
import csv
import math
import pathlib
import subprocess
import sys
import tempfile

PEERS = {"double", "simd_exact", "opencv", "opencv_remap", "opencv_fixed", "oiio_st_warp", "vtk_reslice", "xmorph"}
OURS = {"automatic", "auto"}
NAMES = {"AVX3": "AVX-512", "SSE4": "SSE4.1"}


def measure(program, instructions, options):
    """The rows of one run."""
    with tempfile.TemporaryDirectory() as folder:
        table = pathlib.Path(folder) / "table.csv"
        command = [program, "--instructions", instructions, "--csv", str(table), *options]
        result = subprocess.run(command, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True)
        if not table.exists():
            sys.exit(result.stderr.strip() or f"{program} wrote no table")
        return list(csv.DictReader(table.open()))


def cells(rows, tol):
    """(op, case): ns a pixel, and the best peer's over it."""
    found = {}
    for row in rows:
        if row["scheme"] not in OURS or float(row["tol_px"]) != tol:
            continue
        key = (row["op"], row["case"])
        if key in found:
            continue
        alike = [r for r in rows if (r["op"], r["case"], r["threads"]) == (*key, row["threads"])]
        # Averages have no source points that could be off, and the others take none.
        is_average = math.isnan(float(row["max_error_px"]))
        peers = [float(r["ns_per_px"]) for r in alike if r["scheme"] in PEERS and not is_average]
        own = float(row["ns_per_px"])
        found[key] = (own, min(peers) / own if peers else None)
    return found


def text(cell):
    if cell is None:
        return "|"
    own, ratio = cell
    return f"{own:.2f} | {ratio:.1f}" if ratio else f"{own:.2f} |"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("--sets", default="AVX3,AVX2,SSE4")
    parser.add_argument("--tol", type=float, default=0.01)
    arguments, options = parser.parse_known_args()
    sets = arguments.sets.split(",")
    columns = [cells(measure(arguments.program, name, options), arguments.tol) for name in sets]
    print("| case |" + "".join(f" {NAMES.get(name, name)}: ns/px | x best peer |" for name in sets))
    print("|---|" + "---|---|" * len(sets))
    for op, case in columns[0]:
        values = "".join(f" {text(column.get((op, case)))} |" for column in columns)
        print(f"| {op} {case} |{values}")


if __name__ == "__main__":
    main()
