# SPDX-License-Identifier: Apache-2.0
"""Speed against error on this machine: anamorph bench, or python3 -m anamorph.bench.

Each case draws one picture by Anamorph at several tolerances, and by OpenCV, SciPy and scikit-image where they are installed, from the same
array on one thread, bilinearly. The source is a ramp, whose channels are the x and y of each pixel: what is drawn is then the point where
the source was read, and its distance from the formula in double is the error, measured alike for all. The others are handed the exact map,
in the form that they take, at no cost; what numpy takes to make it is a line of its own.

With --tables the long tables of a build's tests/bench/speed_vs_error, with all schemes and rivals, are measured as well.
"""
import argparse
import csv
import difflib
import html
import io
import math
import os
import pathlib
import platform
import subprocess
import sys
import time

import numpy as np

import anamorph
from anamorph import plot

TOLERANCES = (0, 1e-4, 1e-2, 1e-1)
# A ramp's numbers are float: they have steps of 2^-14 pixels at 1024 pixels from its middle.
RESOLUTION = 1e-4
OPERATIONS = ("pano", "warp", "morph", "drape")
SOURCE = (2048, 1024)


def ramp(width, height):
    """An image of the place of each pixel, from its middle."""
    x, y = np.meshgrid(np.arange(width) + 0.5 - width / 2, np.arange(height) + 0.5 - height / 2)
    return np.stack([x, y], -1).astype(np.float32)


def sheet(cells, width, height):
    """A control mesh that bulges."""
    u, v = np.meshgrid(np.linspace(0, 1, cells + 1), np.linspace(0, 1, cells + 1))
    bulge = 0.05 * np.sin(np.pi * u) * np.sin(np.pi * v)
    return {"columns": cells, "rows": cells, "vertices": np.stack([(u + bulge * np.cos(5 * v)) * width, (v + bulge * np.sin(4 * u)) * height], -1).reshape(-1, 2)}


def cases(size):
    """(name, operation, size of the source, keys)"""
    return (("view of a panorama", "pano", SOURCE, {"from_": "equirectangular", "to": "rectilinear", "fov": 90, "yaw": 30, "pitch": 20,
                                                    "size": (size, size)}),
            ("fisheye of a panorama", "pano", SOURCE, {"from_": "equirectangular", "to": "fisheye", "fov": 180, "yaw": 30, "pitch": 20, "size": (size, size)}),
            ("lens", "lens", (size, size), {"lens": "brown:k1=-0.2,k2=0.05", "fov": 70}),
            ("mesh of 8 x 8", "warp", (size, size), {"mesh": sheet(8, size, size)}))


def numpy_view(size):
    """The first case's map as one writes it with numpy."""
    width, height = SOURCE
    x, y = np.meshgrid(np.arange(size) + 0.5 - size / 2, np.arange(size) + 0.5 - size / 2)
    z = np.full_like(x, size / 2)
    pitch, yaw = np.radians(20), np.radians(30)
    y, z = y * np.cos(pitch) - z * np.sin(pitch), y * np.sin(pitch) + z * np.cos(pitch)
    x, z = x * np.cos(yaw) + z * np.sin(yaw), z * np.cos(yaw) - x * np.sin(yaw)
    return (np.arctan2(x, z) / (2 * np.pi) + 0.5) * width, (np.arctan2(y, np.hypot(x, z)) / np.pi + 0.5) * height


def rivals(u, v):
    """(name, a function of the source that draws it through the map) of what is installed."""
    try:
        import cv2

        cv2.setNumThreads(1)
        x, y = np.float32(u - 0.5), np.float32(v - 0.5)
        yield "OpenCV remap", lambda source: cv2.remap(source, x, y, cv2.INTER_LINEAR)
    except ImportError:
        pass
    try:
        from scipy import ndimage

        at = np.stack([v - 0.5, u - 0.5])
        yield "SciPy map_coordinates", lambda source: np.stack([ndimage.map_coordinates(source[..., c], at, order=1, mode="nearest") for c in range(2)], -1)
    except ImportError:
        pass
    try:
        from skimage import transform

        rows_columns = np.stack([v - 0.5, u - 0.5])
        yield "scikit-image warp", lambda source: np.stack([transform.warp(source[..., c], rows_columns, order=1, mode="edge", preserve_range=True)
                                                            for c in range(2)], -1)
    except ImportError:
        pass


def best_time(call, rounds):
    """The least processor time of some calls, in seconds, and what the last returned."""
    times = []
    for _ in range(rounds):
        begin = time.process_time()
        result = call()
        times.append(time.process_time() - begin)
    return min(times), result


def measure(size, rounds, told=lambda text: None):
    """[(case, what, tol or None, ns a pixel, largest error in pixels or None)]"""
    rows = []
    for name, operation, (width, height), keys in cases(size):
        told(name)
        source = ramp(width, height)
        exact = anamorph.Picture(operation, source, tol=0, filter="bilinear", threads=1, **keys)
        rows_of, columns_of = exact.shape[:2]
        x, y = np.meshgrid(np.arange(columns_of) + 0.5, np.arange(rows_of) + 0.5)
        u, v = exact.source_points(x, y)
        # Where all texels that count are the ramp's: not at its edges, over the seam, or where there is no source point.
        inside = (u > 1) & (u < width - 1) & (v > 1) & (v < height - 1)
        points = np.stack([u - width / 2, v - height / 2], -1)[inside]

        def error(drawn):
            return float(np.hypot(*np.moveaxis(drawn[inside] - points, -1, 0)).max())

        def add(what, tol, seconds, off):
            rows.append((name, what, tol, 1e9 * seconds / x.size, off))

        for tol in TOLERANCES:
            add("Anamorph", tol, *(lambda seconds, drawn: (seconds, error(drawn)))(*best_time(
                lambda: anamorph.apply(operation, source, tol=tol, filter="bilinear", threads=1, **keys), rounds)))
        u, v = np.where(np.isfinite(u), u, 0), np.where(np.isfinite(v), v, 0)
        for what, call in rivals(u, v):
            seconds, drawn = best_time(lambda: call(source), rounds)
            add(what, None, seconds, error(drawn))
        if operation == "pano" and keys["to"] == "rectilinear":
            seconds, (mine_u, mine_v) = best_time(lambda: numpy_view(size), rounds)
            add("(numpy's map alone)", None, seconds, None)
            assert np.abs(mine_u - u)[inside].max() < 1e-6 and np.abs(mine_v - v)[inside].max() < 1e-6
    return rows


def points_of(rows):
    return [plot.Point(case, what, off, ns, "" if tol is None else f"tol={tol:g}") for case, what, tol, ns, off in rows if off is not None]


def table_program():
    """speed_vs_error: of the build that this module is of."""
    beside = pathlib.Path(anamorph.__file__).resolve().parents[2] / "tests/bench/speed_vs_error"
    return os.environ.get("ANAMORPH_SPEED_VS_ERROR") or (str(beside) if beside.exists() else None)


def long_table(program, operation, size, rounds, folder):
    """The table of an operation as a file, and its points."""
    path = folder / f"speed_vs_error_{operation}.csv"
    done = subprocess.run([program, "--op", operation, "--size", str(size), "--rounds", str(rounds), "--csv", str(path)], stdout=subprocess.DEVNULL)
    if done.returncode:
        sys.exit(f"anamorph bench: {program} --op {operation} ended with the status {done.returncode}; what was measured before is in {folder / 'index.html'}")
    with open(path, newline="", encoding="utf-8") as file:
        rows = [row for row in csv.DictReader(file) if row["threads"] == "1"]
    points = [plot.Point(row["case"], row["scheme"], float(row["max_error_px"]), float(row["ns_per_px"])) for row in rows if float(row["ns_per_px"]) > 0]
    # A copy of the bytes has no error: it stands where there is none.
    return [point._replace(error=0.0) if math.isnan(point.error) else point for point in points if point.error != math.inf]


def write_whole(path, text):
    """A file that is there in full or not at all."""
    beside = path.with_name(f".{path.name}.{os.getpid()}.part")
    try:
        beside.write_text(text, encoding="utf-8")
        beside.replace(path)
    finally:
        beside.unlink(missing_ok=True)


def csv_text(rows):
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow("case what tol_px ns_per_px max_error_px".split())
    for case, what, tol, ns, off in rows:
        writer.writerow([case, what, "" if tol is None else f"{tol:g}", f"{ns:.2f}", "" if off is None else f"{off:.3g}"])
    return text.getvalue()


def machine_text():
    model = next((line.split(":", 1)[1].strip() for line in pathlib.Path("/proc/cpuinfo").read_text().splitlines() if line.startswith("model name")),
                 platform.processor()) if os.path.exists("/proc/cpuinfo") else platform.processor()
    versions = [f"Anamorph {anamorph.__version__}"]
    for name in ("numpy", "cv2", "scipy", "skimage"):
        if name in sys.modules:
            versions.append(f"{name} {sys.modules[name].__version__}")
    return f"{model}, {os.cpu_count()} processors; {', '.join(versions)}; {time.strftime('%Y-%m-%d')}"


def page(rows, size, rounds, tables):
    lines = ['<!doctype html><html lang="en"><meta charset="utf-8"><title>Speed against error</title>',
             "<style>body{font-family:sans-serif;max-width:60em;margin:2em auto;padding:0 1em}td,th{padding:.1em .8em;text-align:right}"
             "td:first-child,td:nth-child(2),th:first-child,th:nth-child(2){text-align:left}svg{width:100%;height:auto}</style>",
             "<h1>Speed against error</h1>", f"<p>{html.escape(machine_text())}. Pictures of {size} x {size}, one thread, bilinear, the least processor time of {rounds}. "
             "Lower is faster, further left is nearer to the exact map. Errors below "
             f"{RESOLUTION:g} pixels are below what is measured. The others are handed an exact map at no cost.</p>", plot.svg(points_of(rows), RESOLUTION),
             "<table><tr><th>case<th>what<th>tol<th>ns a pixel<th>largest error, px"]
    for case, what, tol, ns, off in rows:
        lines.append(f"<tr><td>{html.escape(case)}<td>{html.escape(what)}<td>{'' if tol is None else f'{tol:g}'}<td>{ns:.1f}<td>{'' if off is None else f'{off:.2g}'}")
    lines.append("</table>")
    for operation, points in tables.items():
        lines += [f"<h2>All schemes of {operation}</h2>", plot.svg(points)]
    return "\n".join(lines) + "\n"


def main(arguments=None):
    parser = argparse.ArgumentParser("anamorph bench", description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("-o", "--output", default="anamorph-bench", metavar="FOLDER", help="of the page, index.html, and the table, table.csv [anamorph-bench]")
    parser.add_argument("--size", type=int, default=1024, metavar="N", help="width and height of the pictures, 64 to 8192 [1024]")
    parser.add_argument("--rounds", type=int, default=5, metavar="N", help="of which the least processor time counts, 1 to 1000 [5]")
    parser.add_argument("--tables", action="store_true", help="measure the long tables of all schemes as well, where the build has them")
    given, unknown = parser.parse_known_args(arguments)
    if unknown:
        meant = difflib.get_close_matches(unknown[0].split("=")[0], ("--output", "--size", "--rounds", "--tables", "--help"), 1)
        parser.error(f"{unknown[0]}: there is no such {'option' if unknown[0].startswith('-') else 'argument'}" + (f", perhaps {meant[0]} is meant" if meant else ""))
    if not 64 <= given.size <= 8192:
        parser.error(f"--size={given.size}: must be from 64 to 8192")
    if not 1 <= given.rounds <= 1000:
        parser.error(f"--rounds={given.rounds}: must be from 1 to 1000")
    program = table_program()
    if given.tables and not program:
        parser.error("--tables: there is no speed_vs_error: must be run of a build that has made it (target speed_vs_error), or ANAMORPH_SPEED_VS_ERROR must name it")
    folder = pathlib.Path(given.output)
    folder.mkdir(parents=True, exist_ok=True)
    told = (lambda text: print(text, file=sys.stderr)) if sys.stderr.isatty() else (lambda text: None)
    rows = measure(given.size, given.rounds, told)
    tables = {}
    write_whole(folder / "table.csv", csv_text(rows))
    write_whole(folder / "plot.svg", plot.svg(points_of(rows), RESOLUTION))
    write_whole(folder / "index.html", page(rows, given.size, given.rounds, tables))
    # Each takes long; the page has those that are there.
    for operation in OPERATIONS if given.tables else ():
        told(f"all schemes of {operation}")
        tables[operation] = long_table(program, operation, given.size, given.rounds, folder)
        write_whole(folder / "index.html", page(rows, given.size, given.rounds, tables))
    print(folder / "index.html")


if __name__ == "__main__":
    main()
