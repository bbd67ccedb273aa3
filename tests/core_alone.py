#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""core_alone.py SOURCE_DIR BINARY_DIR WORK_DIR CMAKE [OPTION...]

The core, its programs and its tests are what they are without host libraries: configured where none can be found, they
would be built by the same commands as in BINARY_DIR, a Ninja build with hosts; and what was read there is no host's header.
"""
import pathlib
import re
import shutil
import subprocess
import sys

HOSTS = ("OpenImageIO", "OpenColorIO", "Imath", "OpenEXR", "VTK", "ParaView")
PROGRAMS = ("tests/core/anamorph_core_tests", "core/command/anamorph", "core/command/anamorph-figure",
            "core/command/anamorph-machine")
HOST_HEADER = re.compile(r"/(OpenImageIO|OpenColorIO|Imath|OpenEXR|vtk[^/]*|paraview[^/]*|opencv[^/]*)/")


def output_of(*command):
    """What a command prints; ends the test with it where the command fails."""
    result = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if result.returncode:
        sys.exit(f"{' '.join(map(str, command))}\n{result.stdout}")
    return result.stdout


def commands(folder):
    """How ninja makes the programs, with FOLDER in place of the build's folder."""
    made = output_of("ninja", "-C", folder, "-t", "commands", *PROGRAMS)
    # Ninja says where it goes.
    lines = [line for line in made.splitlines() if not line.startswith("ninja: Entering directory")]
    return [line.replace(str(folder), "FOLDER") for line in lines]


def files_compiled_together(folder, made):
    """Those that the commands name: what was configured before leaves others."""
    names = set(re.findall(r"\bFOLDER/(\S+/Unity/\w+\.cxx)\b", "\n".join(made)))
    return {name: (folder / name).read_text() for name in sorted(names)}


def objects_with_headers(folder):
    """(object, its headers) of what the programs are made of."""
    wanted = set(re.findall(r"\S+\.o\b", "\n".join(commands(folder))))
    for entry in output_of("ninja", "-C", folder, "-t", "deps").split("\n\n"):
        name, _, headers = entry.partition(":")
        name = name.splitlines()[-1] if name else ""
        if name in wanted:
            yield name, headers


def main():
    source, binary, work = (pathlib.Path(path).resolve() for path in sys.argv[1:4])
    shutil.rmtree(work, ignore_errors=True)
    hidden = [f"-DCMAKE_DISABLE_FIND_PACKAGE_{host}=ON" for host in HOSTS]
    output_of(sys.argv[4], "-S", source, "-B", work, "-G", "Ninja", "-DANAMORPH_TOOLKIT=NONE", "-DANAMORPH_OIIO=OFF",
              "-DOPENCV_INCLUDE_DIR=OFF",  # the benchmark looks for it without a package
              *hidden, *sys.argv[5:])

    with_hosts, alone = commands(binary), commands(work)
    differing = [pair for pair in zip(with_hosts, alone) if pair[0] != pair[1]]
    if differing:
        sys.exit("without hosts another command is run:\n{}\nwith hosts:\n{}".format(differing[0][1], differing[0][0]))
    if len(with_hosts) != len(alone):
        sys.exit(f"without hosts {len(alone)} commands are run, with hosts {len(with_hosts)}")
    if files_compiled_together(binary, with_hosts) != files_compiled_together(work, alone):
        sys.exit("without hosts other files are compiled together")

    count = 0
    for name, headers in objects_with_headers(binary):
        count += 1
        found = HOST_HEADER.search(headers)
        if found:
            sys.exit(f"{name} reads a host's header: {found.group()}")
    if count < 70:
        sys.exit(f"ninja knows what {count} objects read: too few to say something of the core")
    print(f"{len(alone)} commands are the same; {count} objects read no host's header")


if __name__ == "__main__":
    main()
