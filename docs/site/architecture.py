#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Draws docs/architecture.svg, the folders and which include which: architecture.py SOURCES [FILE]

From the includes that there are. A folder stands above all that it includes; an arrow is left out where a way of others leads there. The test
docs_blocks says when the drawing is not what the sources are.
"""
import collections
import html
import pathlib
import re
import sys

# What a folder has, in a few words; in core/anamorph all must be here.
CORE = {
    "number": "scalars of formulas", "geometry": "points, boxes", "parameter": "tables of keys, files", "chart": "projections, lenses", "plan": "blocks with bounds",
    "image": "pictures, filters", "lens": "lens maps", "formula": "formulas as text", "mesh": "meshes, ST-maps", "morph": "feature lines", "panorama": "views of panoramas",
    "chain": "pictures of pictures", "projector": "panoramas on scenes", "deform": "bumps, inbetweens", "surface": "pictures on surfaces", "figure": "figures, NUDES",
    "machine": "hardware of 1987, 2003", "operation": "every operation by name",
}
HOSTS = {
    "core/command": "anamorph-figure, -machine", "oiio_ops": "OpenImageIO's buffers", "plugins/imageio": "recipes as pictures", "plugins/command": "anamorph draw, explain",
    "plugins/python": "numpy arrays", "vtk_filters": "VTK's filters", "plugins/paraview": "ParaView",
}
LIBRARIES = {"surface": ["deform", "surface"], "figure": ["figure"], "machine": ["machine"], "operations": ["operation"]}
COLORS = {"core": "#dbe8f6", "surface": "#dff0d8", "figure": "#fcf3cf", "machine": "#f6dde0", "operations": "#e8dff5", "hosts": "#eeeeee"}
WIDTH, HEIGHT, GAP, ROW = 158, 44, 22, 88
INCLUDE = re.compile(r'# *include *[<"]([^">]+)[">]')


def folder_of(include, own, sources):
    """The folder of our own that an include leads to; None where it is none, or lies below all folders."""
    if include.startswith("anamorph/"):
        first = include.split("/")[1]
        if (sources / "oiio_ops" / include).exists() and own != "oiio_ops":
            return "oiio_ops"
        first = first.removesuffix(".h")
        return first if first in CORE else "operation" if first == "anamorph" else None
    if include.startswith("vtkAnamorph"):
        return "vtk_filters"
    if next((sources / (own if own in HOSTS else f"core/anamorph/{own}")).rglob(include), None):
        return None
    return next((host for host in HOSTS if host != own and (sources / host / include).is_file()), None)


def includes(sources):
    """{folder: the folders that it includes}."""
    arrows = collections.defaultdict(set)
    places = {name: sources / "core/anamorph" / name for name in CORE} | {name: sources / name for name in HOSTS}
    missing = sorted({path.name for path in (sources / "core/anamorph").iterdir() if path.is_dir()} - set(CORE))
    if missing:
        sys.exit(f"architecture.py has no words for {', '.join(missing)}")
    for name, place in places.items():
        for path in sorted(place.rglob("*")):
            if path.suffix in (".h", ".cpp", ".cxx"):
                for include in INCLUDE.findall(path.read_text(encoding="utf-8")):
                    to = folder_of(include, name, sources)
                    if to and to != name:
                        arrows[name].add(to)
    arrows["plugins/paraview"].add("vtk_filters")  # by CMake: its proxies name the classes
    return arrows


def reached(arrows, start):
    found, open_ = set(), [start]
    while open_:
        for to in arrows[open_.pop()]:
            if to not in found:
                found.add(to)
                open_.append(to)
    return found


def rows_of(names, arrows):
    """The names in rows, from the lowest, each above all that it includes, and those next to each other that have to do with the same."""
    level = {}

    def find(name):
        if name not in level:
            level[name] = 1 + max((find(to) for to in sorted(arrows[name])), default=-1)
        return level[name]

    top = max(find(name) for name in names if name not in HOSTS)
    for name in HOSTS:
        level[name] = max(find(name), top + 1)
    rows = [[name for name in names if level[name] == k] for k in range(max(level.values()) + 1)]
    for row, below in zip(rows[1:], rows):
        place = {name: i / max(len(below) - 1, 1) for i, name in enumerate(below)}
        row.sort(key=lambda name: (sum(place.get(to, 0.5) for to in arrows[name]) / max(len(arrows[name]), 1), names.index(name)))
    return rows


def drawn(sources):
    arrows = includes(sources)
    names = [*CORE, *HOSTS]
    direct = {name: {to for to in arrows[name] if not any(to in reached(arrows, other) for other in arrows[name] - {to})} for name in names}
    rows = rows_of(names, arrows)
    width = max(len(row) for row in rows) * (WIDTH + GAP) + GAP
    height = len(rows) * ROW + 40
    library = {folder: name for name, folders in LIBRARIES.items() for folder in folders}
    at = {}
    for k, row in enumerate(rows):
        left = (width - len(row) * (WIDTH + GAP) + GAP) // 2
        for i, name in enumerate(row):
            at[name] = left + i * (WIDTH + GAP), height - 40 - (k + 1) * ROW + (ROW - HEIGHT) // 2
    lines = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" width="{width}" height="{height}" font-family="sans-serif" font-size="12">',
             "<title>The folders of Anamorph, each above those that it includes</title>", f'<rect width="{width}" height="{height}" fill="white"/>']
    for name in names:
        for to in sorted(direct[name]):
            (x0, y0), (x1, y1) = at[name], at[to]
            x0, y0, x1 = x0 + WIDTH // 2, y0 + HEIGHT, x1 + WIDTH // 2
            bend = (y1 - y0) // 2
            lines.append(f'<path d="M{x0} {y0}C{x0} {y0 + bend} {x1} {y1 - bend} {x1} {y1}" fill="none" stroke="#777"/>')
            lines.append(f'<path d="M{x1 - 4} {y1 - 7}L{x1} {y1}L{x1 + 4} {y1 - 7}" fill="none" stroke="#777"/>')
    for name in names:
        x, y = at[name]
        color = COLORS["hosts" if name in HOSTS else library.get(name, "core")]
        middle = x + WIDTH // 2
        lines.append(f'<rect x="{x}" y="{y}" width="{WIDTH}" height="{HEIGHT}" rx="5" fill="{color}" stroke="#555"/>')
        lines.append(f'<text x="{middle}" y="{y + 18}" text-anchor="middle" font-weight="bold">{name}</text>')
        lines.append(f'<text x="{middle}" y="{y + 34}" text-anchor="middle" font-size="11">{html.escape((CORE | HOSTS)[name])}</text>')
    for i, (name, color) in enumerate(COLORS.items()):
        x = GAP + i * 165
        lines.append(f'<rect x="{x}" y="{height - 28}" width="16" height="16" fill="{color}" stroke="#555"/>')
        lines.append(f'<text x="{x + 22}" y="{height - 15}">{name if name == "hosts" else "Anamorph::" + name}</text>')
    return "\n".join([*lines, "</svg>", ""])


if __name__ == "__main__":
    if len(sys.argv) not in (2, 3):
        sys.exit(__doc__)
    sources = pathlib.Path(sys.argv[1]).resolve()
    (pathlib.Path(sys.argv[2]) if len(sys.argv) == 3 else sources / "docs/architecture.svg").write_text(drawn(sources), encoding="utf-8")
