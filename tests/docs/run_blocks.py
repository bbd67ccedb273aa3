# SPDX-License-Identifier: Apache-2.0
"""Runs the blocks of the .md files that the tables of blocks.py give to a test, as they stand there, in a tree of links to
the real one, and looks whether there is what they say they write.

Usage: run_blocks.py RUN

ANAMORPH_SOURCE_DIR and ANAMORPH_BUILD_DIR are the tree and its build. What starts with `configure.` is configured anew in a
folder of its own.
"""
import glob
import os
import pathlib
import shutil
import struct
import subprocess
import sys
import tempfile

import blocks

SOURCE, BUILD = blocks.source_dir(), pathlib.Path(os.environ["ANAMORPH_BUILD_DIR"])
VTK_PREFIX = os.environ.get("ANAMORPH_VTK_PREFIX", "")

MOTION = """HIERARCHY
ROOT hip
{
  OFFSET 0 0 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT arm
  {
    OFFSET 0 10 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 8 0
    }
  }
}
MOTION
Frames: 3
Frame Time: 0.04
0 0 0 0 0 0 0 0 0
1 0 0 0 20 0 15 0 0
2 0 0 0 40 0 30 0 0
"""
# Of building, what ninja would do; all else is CMake's own answer. A variable that the project does not know is an error.
CONFIGURE = """
set -euo pipefail
cmake() {
    if [ "$1" = --build ]; then
        command cmake "$@" -- -n
    else
        command cmake "$@" 2>&1 | tee -a configured.txt
    fi
}
"""
CONFIGURED = """
if grep -A 5 "not used by the project" configured.txt; then exit 1; fi
"""

BULGE = """{"columns": 2, "rows": 2, "units": "fractions",
"vertices": [[0, 0], [0.5, 0], [1, 0], [0, 0.5], [0.6, 0.45], [1, 0.5], [0, 1], [0.5, 1], [1, 1]]}"""


def link_tree(folder, preset):
    """A folder that looks like the tree with its build, where nothing that is written gets into either."""
    for entry in SOURCE.iterdir():
        if entry.name != "build" and not entry.name.startswith("."):
            (folder / entry.name).symlink_to(entry)
    (folder / "build").mkdir()
    if preset:
        (folder / "build" / preset).symlink_to(BUILD)
    if VTK_PREFIX:
        (folder / "build/vtk-9.1").symlink_to(VTK_PREFIX)


def shell(text, folder, screen=None, **environment):
    """What bash prints; on a screen in memory of that number, or without one."""
    display = ["xvfb-run", "-a", "-n", str(screen), "-s", "-screen 0 1280x1024x24 -noreset"] if screen else []
    done = subprocess.run([*display, "bash", "-c", text], cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                          env={**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1", **environment}, errors="replace", timeout=550)
    assert done.returncode == 0, f"{text}\n{done.stdout[-6000:]}"
    return done.stdout


def check_files(lines, folder):
    for pattern in blocks.made_by(lines):
        found = glob.glob(str(folder / pattern))
        assert found and all(os.path.getsize(name) for name in found), f"{pattern}: {found}; there is {os.listdir(folder)}"


def configure(run, folder):
    lines = blocks.lines_of(run)
    # Where VTK is not unpacked but installed, it needs no path.
    environment = {"VTK_ROOT": VTK_PREFIX + "/usr"} if VTK_PREFIX else {}
    shell(CONFIGURE + "\n".join(lines) + CONFIGURED, folder, **environment)


def run_commands(folder):
    """Programs without a host."""
    for name in "walker.nudes", "benzene.cif":
        shutil.copy(SOURCE / "examples/figures" / name, folder)
    shutil.copy(SOURCE / "examples/swirl.ps", folder / "warp.ps")
    (folder / "boxing.bvh").write_text(MOTION)
    ramp = [value for y in range(16) for x in range(16) for value in (x / 16, y / 16, 0)]
    (folder / "picture.pfm").write_bytes(b"PF\n16 16\n-1\n" + struct.pack("<768f", *ramp))
    (folder / "face.rgb").write_bytes(bytes(range(256)) * (3 * 1024))
    (folder / "inframe").write_text("1 0 1\n511 0 0 90\n100 150 100 2560 2560 0 0 0 0 face\n")
    blocks.write_files("command", folder)
    lines = blocks.lines_of("command")
    assert len(lines) > 15, lines
    if os.environ["ANAMORPH_HAVE_CAIRO"] == "0":
        lines = [line for line in lines if not line.startswith(("anamorph-figure pdf", "anamorph-figure png"))]
    path = os.environ["ANAMORPH_PROGRAMS"] + ":" + os.environ["PATH"]
    shell("set -ex\n" + "\n".join(lines), folder, PATH=path)
    check_files([line for line in lines if shutil.which("ffmpeg") or ".mp4" not in line], folder)


def run_vtk(folder):
    """Lines of the shell, and then Python with the paths that these have set."""
    shell('/usr/bin/python3 examples/make_panorama.py panorama.exr 256 && oiiotool panorama.exr --ch R,G,B -d uint8 -o photo.jpg',
          folder)
    shell("oiiotool photo.jpg --flop -o mirrored.jpg", folder)
    (folder / "bulge.json").write_text(BULGE)
    (folder / "faces.csv").write_text("100,60,140,70,110,64,150,66\n60,90,66,40,50,88,58,42\n")
    # Paths first: an example of an earlier section points to them.
    lines = sorted(blocks.lines_of("vtk"), key=lambda line: not line.startswith(("tests/unpack_vtk.sh", "export ")))
    assert len(lines) > 8, lines
    shell("set -ex\n" + "\n".join([*lines, f"/usr/bin/python3 {SOURCE}/tests/docs/python_blocks.py"]), folder, screen=371)
    check_files(lines, folder)
    assert os.listdir(folder / "faces"), "the example of expressions wrote no pictures"


def run_paraview(folder):
    lines = blocks.lines_of("paraview")
    assert len(lines) == 3, lines
    shell("set -ex\n" + "\n".join([*lines, f"pvpython {SOURCE}/tests/docs/paraview_blocks.py"]), folder, screen=372)
    made = os.listdir(folder / "OUT")
    assert {"face.pvsm", "figures.png", "figures.pvsm"} <= set(made), made


def main(run):
    with tempfile.TemporaryDirectory(dir=os.getcwd()) as name:
        folder = pathlib.Path(name)
        if run == "command":
            run_commands(folder)
        elif run.startswith("configure."):
            link_tree(folder, None)
            configure(run, folder)
        else:
            link_tree(folder, run)
            {"vtk": run_vtk, "paraview": run_paraview}[run](folder)


if __name__ == "__main__":
    main(sys.argv[1])
