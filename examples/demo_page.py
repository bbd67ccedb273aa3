#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Makes the page that the demo ends with: demo_page.py ANAMORPH LINES FOLDER

LINES is a file of what was drawn: on each line a picture's name, a tab and the command that made it. The page, FOLDER/index.html, shows these, and
a plot of time against the proven error, measured by `ANAMORPH explain --time` of recipes in FOLDER at several tolerances.
"""
import html
import pathlib
import re
import subprocess
import sys

from whole_file import whole_file

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1] / "plugins/python/anamorph"))
import plot  # noqa: E402

RECIPES = {"a view of a panorama": "panorama.exr.pano?to=rectilinear&fov=100&yaw=160&size=512x512&filter=bilinear",
           "a lens": "panorama.exr.lens?lens=brown:k1=-0.1&fov=80&size=512x512&filter=bilinear",
           "a mesh": "round.png.warp?mesh=bulge.json&filter=bilinear",
           "a morph": "round.png.morph?b=long.png&features=faces.csv&t=0.5&filter=bilinear"}
TOLERANCES = ("0", "0.0001", "0.001", "0.01", "0.1")
LEAST = 1e-5
FILMS = (".mp4", ".webm")


def measured(program, recipe, folder):
    """(nanoseconds a pixel, proven error) of a recipe's picture."""
    text = subprocess.run([program, "explain", "--time", recipe], cwd=folder, capture_output=True, text=True, check=True).stdout
    width, height = map(int, re.search(r"^picture +(\d+) x (\d+)", text, re.M).groups())
    planned, drawn = map(float, re.search(r"planned in ([\d.e-]+), drawn in ([\d.e-]+)", text).groups())
    error = float(re.search(r"^max_error +([\d.e-]+)", text, re.M)[1])
    return 1e9 * (planned + drawn) / (width * height), error


def points(program, folder):
    for name, recipe in RECIPES.items():
        for tol in TOLERANCES:
            time, error = measured(program, f"{recipe}&tol={tol}", folder)
            yield plot.Point(name, "Anamorph", error, max(time, 0.1), f"tol={tol}")


def shown(name):
    kind = pathlib.Path(name).suffix
    if kind in FILMS:
        return f'<video src="{name}" controls loop></video>'
    return f'<img src="{name}" alt="{html.escape(name)}" loading="lazy">' if kind in (".png", ".jpg", ".svg") else f'<a href="{name}">{html.escape(name)}</a>'


def page(lines, plotted):
    parts = ['<!doctype html><html lang="en"><meta charset="utf-8"><title>Anamorph: the demo</title>',
             "<style>body{font-family:sans-serif;max-width:70em;margin:2em auto;padding:0 1em}figure{display:inline-block;vertical-align:top;width:21em;margin:0 1em 2em 0}"
             "img,video{max-width:100%;max-height:20em}code{font-size:.75em;word-break:break-all;color:#444}svg{width:100%;height:auto}</style>",
             "<h1>What the demo drew</h1><p>Each picture and the line that made it, in this folder.</p>"]
    for name, command in lines:
        parts.append(f"<figure>{shown(name)}<figcaption><b>{html.escape(name)}</b><br><code>{html.escape(command)}</code></figcaption></figure>")
    parts += ["<h2>Time against error</h2><p>Of this machine, all threads: planning and drawing, and the proven error, at five tolerances. Lower is faster, "
              "further left is nearer to the exact map. <code>anamorph bench</code> measures more, beside other programs.</p>", plotted]
    return "\n".join(parts) + "\n"


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    program, listed, folder = sys.argv[1:]
    lines = [line.split("\t", 1) for line in pathlib.Path(listed).read_text(encoding="utf-8").splitlines()]
    missing = [name for name, _ in lines if not pathlib.Path(folder, name).exists()]
    if missing:
        sys.exit(f"{', '.join(missing)}: not there")
    plotted = plot.svg(list(points(program, folder)), LEAST)
    for name, text in (("speed_vs_error.svg", plotted), ("index.html", page(lines, plotted))):
        with whole_file(str(pathlib.Path(folder, name))) as beside:
            pathlib.Path(beside).write_text(text, encoding="utf-8")


if __name__ == "__main__":
    main()
