# SPDX-License-Identifier: Apache-2.0
"""The handles of Deform are on a ball whose halves are on two ranks of a server, whichever half the selected bump is on, and the button Anchor Selected finds
either. (tests/vtk/ranks.py has what a click finds on several ranks.)"""
import os
import subprocess

SCRIPT = r'''
import math
import surfaces  # connects, and loads the plugin on both sides
from paraview.simple import *

assert surfaces.number_of_pieces() == 2
ROWS = [0, -.45, .3, .3, 0, 0, .3, 0, 1, 0, .45, .3, .3, 0, 0, .3, 0, 1]
ball = Sphere(Radius=1, ThetaResolution=64, PhiResolution=65)
deform = AnamorphDeform(Input=ball, AutomaticPlane=0, Deformations=ROWS, Depths=[0, 0, 1, 0, 0, 1])


def is_near(found, wanted):
    return all(abs(f - w) < 0.03 for f, w in zip(found, wanted))


for selected in (1, 0, 1):
    deform.SelectedDeformation = selected
    deform.UpdatePipeline()
    assert is_near(deform.SelectedCenter, (0, ROWS[9 * selected + 1], math.sqrt(1 - .45 ** 2) + .3)), (selected, list(deform.SelectedCenter))
for selected in (0, 1):
    deform.SelectedDeformation = selected
    deform.InvokeCommand("AnchorSelected")
    v = ROWS[9 * selected + 1]
    vector = list(deform.Deformations)[9 * selected + 4:9 * selected + 7]
    assert is_near([x / .3 for x in vector], (0, v, math.sqrt(1 - v * v))), vector
    assert abs(deform.Depths[3 * selected] - math.sqrt(1 - v * v)) < 0.03, list(deform.Depths)
print("anchored")
'''

server = subprocess.Popen(["mpiexec", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n", "2", "pvserver", "--server-port=0"],
                          stdout=subprocess.PIPE, text=True)
try:
    port = next(line.strip().rsplit(":", 1)[1] for line in server.stdout if line.startswith("Accepting connection(s): "))
    with open("handles_on_ranks.py", "w") as file:
        file.write(SCRIPT)
    done = subprocess.run(["pvpython", "handles_on_ranks.py"], env={**os.environ, "ANAMORPH_SERVER": "127.0.0.1:" + port}, capture_output=True,
                          text=True, timeout=200)
    assert done.returncode == 0 and "anchored" in done.stdout, (done.stdout[-3000:], done.stderr[-4000:])
finally:
    server.terminate()
    server.wait(timeout=60)
