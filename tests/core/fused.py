#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""fused.py CORE_DIR

Kernels compute alike on every processor: none calls what Highway does in one rounding on some and in two on others, nor its estimates,
but where ALIKE says why the bits are the same all the same. Colours and points use Fused (number/fused-inl.h).
"""
import collections
import pathlib
import re
import sys

UNALIKE = re.compile(r"\b(?:\w*Mul(?:Add|Sub)\w*|Approximate\w*|MulByPow2|FastExp\w*)\s*\(")
ALIKE = {
    ("number/fused-inl.h", "MulAdd"): (1, "where the instruction set rounds once"),
    ("deform/deform_lanes.cpp", "MulAdd"): (1, "what is rounded twice elsewhere is made good there"),
    ("image/packed_blocks_lanes.cpp", "MulAdd"): (2, "the products are exact: by a power of two"),
}


def main():
    core = pathlib.Path(sys.argv[1]) / "anamorph"
    found = collections.Counter()
    files = sorted(p for p in core.rglob("*") if p.name.endswith(("_lanes.cpp", "-inl.h")) or p.name == "lanes.h")
    for path in files:
        code = re.sub(r"//[^\n]*", "", path.read_text(encoding="utf-8"))
        for match in UNALIKE.finditer(code):
            found[path.relative_to(core).as_posix(), match.group().rstrip("( ")] += 1
    faults = [] if files else [f"no kernels under {core}"]
    for use in sorted(set(found) | set(ALIKE)):
        known = ALIKE.get(use, (0,))[0]
        if found[use] != known:
            faults.append(f"{use[0]}: {found[use]} calls of {use[1]}, of which {known} are known to be alike on every processor")
    for fault in faults:
        print(fault)
    return 1 if faults else 0


sys.exit(main())
