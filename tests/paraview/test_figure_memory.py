# SPDX-License-Identifier: Apache-2.0
"""A script of many frames, played and drawn in pvbatch, takes no more memory at its end than near its beginning; bodies
too large for the tolerance are refused instead of filling the memory."""
import os
import subprocess
import tempfile

from display import xvfb_run

FRAMES, BODIES, MOST_GROWTH, MOST = 720, 8, 64, 1500  # MB
ENVIRONMENT = {**os.environ, "LIBGL_ALWAYS_SOFTWARE": "1"}
PLAY = """
import os, resource, sys
from paraview import simple
from paraview.simple import *
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=vars(simple))


def resident():
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE") // 2 ** 20


figures = OpenDataFile(sys.argv[1])
view = CreateRenderView()
view.ViewSize = [120, 120]
surfaces = simple.AnamorphFigureGeometry(Input=figures, Tolerance=1)
outlines = simple.AnamorphFigureOutline(Input=figures)
shown = Show(surfaces, view)
ColorBy(shown, ("CELLS", "Color"))
Show(outlines, view)
scene = GetAnimationScene()
scene.UpdateAnimationUsingDataTimeSteps()
frames = list(figures.TimestepValues)
for frame in frames:
    scene.AnimationTime = frame
    Render(view)
    if frame in (100, 700):
        print("resident", resident(), surfaces.GetDataInformation().GetNumberOfCells())
print("frames", len(frames), "most", resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
"""


def many_frames():
    names = [f"b{i}" for i in range(BODIES)]
    lines = [f"figure f {BODIES} " + " ".join(names)]
    lines += [f"ellipsoid {name} {20 + i} {40 - i} 30" for i, name in enumerate(names)]
    lines += [f"joint j{i} b{i - 1} 0 {40 - i} 0 b{i} 0 -30 0" for i in range(1, BODIES)]
    lines += ["repeat 0 1 moveto f b0 300 200 300", f"linear 0 {FRAMES} moveby f world 400 0 0"]
    lines += [f"linear 0 {FRAMES} bendby b{i} j{i} world 720 x" for i in range(1, BODIES)]
    return "\n".join(lines + ["stop", ""])


def play(folder, script):
    with open(folder + "/play.py", "w") as file:
        file.write(PLAY)
    with open(folder + "/script.nudes", "w") as file:
        file.write(script)
    done = subprocess.run([*xvfb_run(351), "pvbatch", folder + "/play.py", folder + "/script.nudes"], env=ENVIRONMENT,
                          capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, (done.stdout[-2000:], done.stderr[-4000:])
    return [line.split() for line in done.stdout.splitlines()], done.stdout + done.stderr


with tempfile.TemporaryDirectory() as folder:
    lines, text = play(folder, many_frames())
    early, late = (int(line[1]) for line in lines if line[0] == "resident")
    print(*lines, sep="\n")
    assert ["frames", str(FRAMES)] == lines[-1][:2], lines
    assert late - early < MOST_GROWTH, (early, late)
    lines, text = play(folder, "figure f 8 a b c d e f g h\n" +
                       "\n".join(f"ellipsoid {name} 90000 90000 90000" for name in "abcdefgh") +
                       "\nrepeat 0 2 moveto f a 300 200 300\nstop\n")
    assert "triangles, but there must be at most" in text, text[-4000:]
    assert int(lines[-1][-1]) < MOST, lines
