#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""hashes.py ANAMORPH WRITE_SAMPLE HASHES WORK_DIR [--write]

The views of the page have the hashes that its list says of the desktop program: `anamorph hash` prints them of the page's panorama.
With --write the list gets those that are printed.
"""
import pathlib
import re
import subprocess
import sys

LINE = re.compile(r"^([0-9a-f]{32}) (\S+)(.*)$")


def main():
    anamorph, write_sample = (str(pathlib.Path(p).resolve()) for p in sys.argv[1:3])
    hashes, work = map(pathlib.Path, sys.argv[3:5])
    work.mkdir(parents=True, exist_ok=True)
    subprocess.run([write_sample, "2048", "panorama.ppm"], cwd=work, check=True)
    lines = hashes.read_text(encoding="utf-8").splitlines()
    found = [(i, LINE.match(line)) for i, line in enumerate(lines) if not line.startswith("#")]
    names = [f"panorama.ppm.{match.group(2)}" for _, match in found]
    printed = subprocess.run([anamorph, "hash", *names], cwd=work, check=True, stdout=subprocess.PIPE, text=True).stdout
    digits = [line[:32] for line in printed.splitlines()]
    if len(digits) != len(found) or len(found) < 10:
        sys.exit(f"{len(digits)} hashes are printed of {len(found)} views")
    wrong = [f"{new} {match.group(2)}" for (_, match), new in zip(found, digits) if match.group(1) != new]
    if "--write" in sys.argv:
        for (i, match), new in zip(found, digits):
            lines[i] = f"{new} {match.group(2)}{match.group(3)}"
        hashes.write_text("\n".join(lines) + "\n", encoding="utf-8")
    elif wrong:
        sys.exit("\n".join([f"{hashes} has other hashes than these:", *wrong]))
    print(f"{len(found)} views, {len(wrong)} other than listed")


if __name__ == "__main__":
    main()
