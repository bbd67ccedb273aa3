#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""includes.py CORE_DIR LIBRARY...

What the core includes. No header of a host. Highway, in files for one instruction set at a time alone: *_lanes.cpp, and what they
include as *-inl.h. And folders include each other one way only: no way leads from a folder to others and back. Each LIBRARY is
NAME:FOLDERS:LINKS, with commas between its folders, or none where it has what no other has, and between the libraries that it links:
its files include their own and those of these.
"""
import collections
import pathlib
import re
import sys

HOST = re.compile(r'# *include *[<"](OpenImageIO|OpenColorIO|Imath|OpenEXR|opencv2|vtk)')
HIGHWAY = re.compile(r'# *include *[<"]hwy/')
OWN = re.compile(r'# *include *"anamorph/([^"]+)"')


def folder_of(path):
    """What lies in none, below all others, is one too. Those of figures are many."""
    return "/".join(path.parts[:-1][:2 if path.parts[0] == "figure" else 1]) or "."


def libraries_of(arguments):
    """(library by folder, with "" for other folders; what each links, itself too)."""
    owners, links = {}, {}
    for argument in arguments:
        name, folders, linked = argument.split(":")
        owners.update((folder, name) for folder in folders.split(","))
        links[name] = {name, *linked.split(",")}
    return owners, links


def way_back(arrows, start):
    """Folders from `start` to itself, each including the next; None if there is no such way."""
    ways = collections.deque([[start]])
    seen = set()
    while ways:
        way = ways.popleft()
        for folder in sorted(arrows[way[-1]]):
            if folder == start:
                return [*way, start]
            if folder not in seen:
                seen.add(folder)
                ways.append([*way, folder])
    return None


def main():
    core = pathlib.Path(sys.argv[1]) / "anamorph"
    owners, links = libraries_of(sys.argv[2:])
    if "" not in owners:
        sys.exit("no library has what no other has")

    def library_of(path):
        return owners.get(path.parts[0].removesuffix(".h"), owners[""])

    def is_topic(path):
        """Is it a header that gathers those of a folder, or of all, for users?"""
        return len(path.parts) == 1 and path.suffix == ".h" and (core / path.stem).is_dir() or path.name == "anamorph.h"

    files = sorted(p for p in core.rglob("*") if p.suffix in (".h", ".cpp"))
    faults = [] if files else [f"no sources under {core}"]
    arrows = collections.defaultdict(dict)
    for path in files:
        name = path.relative_to(core)
        text = path.read_text(encoding="utf-8")
        if HOST.search(text):
            faults.append(f"{name}: includes a header of a host")
        if HIGHWAY.search(text) and not name.name.endswith(("_lanes.cpp", "-inl.h")):
            faults.append(f"{name}: includes Highway: must be *_lanes.cpp")
        for other in OWN.findall(text):
            if library_of(pathlib.PurePath(other)) not in links[library_of(name)]:
                faults.append(f"{name}: includes {other} of a library that it does not link")
            here, there = folder_of(name), folder_of(pathlib.PurePath(other))
            if is_topic(pathlib.PurePath(other)) and not is_topic(name):
                faults.append(f"{name}: includes {other}, which is for users")
            if here != there and not is_topic(name):
                arrows[here].setdefault(there, f"{name} includes {other}")
    for folder in sorted(arrows):
        way = way_back(arrows, folder)
        if way and folder == min(way):
            faults.append("a circle of folders: " + "; ".join(arrows[a][b] for a, b in zip(way, way[1:])))
    for fault in faults:
        print(fault)
    return 1 if faults else 0


sys.exit(main())
