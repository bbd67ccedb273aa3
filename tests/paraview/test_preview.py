# SPDX-License-Identifier: Apache-2.0
"""In ParaView's window a projection is coarse at once and fine when it is left alone, after a change too; traces and undo know
nothing of it, and with PreviewTime 0, or an animation track, it is never coarse."""
import json
import os
import subprocess
import tempfile
import time

from display import xvfb_run

SCRIPT = """
import json, os, time
from paraview.simple import *
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())
sphere = Sphere()
sphere.UpdatePipeline()
projection = AnamorphPanoramaProjection(Input=sphere, PreviewTime=0.05)
view = GetActiveViewOrCreate("RenderView")
shown = Show(projection, view)
told = []


def tell(*_):
    told.append([projection.GetPropertyValue("UsedTolerance"), projection.GetDataInformation().GetNumberOfCells()])
    with open({folder!r} + "/told.new", "w") as file:
        json.dump(told, file)
    os.replace({folder!r} + "/told.new", {folder!r} + "/told")
    if told[-1][0] > .125 or len(told) > 40:
        return
    if state[0] == 0:  # A change of the input is coarse at first, too.
        state[0] = 1
        sphere.Radius = 0.4
        Render(view)
    elif state[0] == 1 and told[-2][0] > .125:
        state[0] = 2
        projection.PreviewTime = 0
        projection.Direction = [1, 0, 0]
        Render(view)
        never = projection.GetPropertyValue("UsedTolerance")
        projection.PreviewTime = 0.05
        GetAnimationTrack("Tolerance", proxy=projection)
        projection.Direction = [0, 0, 1]
        Render(view)
        with open({folder!r} + "/end.new", "w") as file:
            json.dump([never, projection.GetPropertyValue("UsedTolerance")], file)
        os.replace({folder!r} + "/end.new", {folder!r} + "/end")


state = [0]
view.GetRenderWindow().AddObserver("EndEvent", tell)
Render(view)
tell()
"""

with tempfile.TemporaryDirectory() as folder:
    os.makedirs(folder + "/.config")
    with open(folder + "/script.py", "w") as file:
        file.write(SCRIPT.format(folder=folder))
    environment = {**os.environ, "HOME": folder, "XDG_CONFIG_HOME": folder + "/.config", "XDG_RUNTIME_DIR": folder}
    with open(folder + "/log", "w+") as log:
        program = subprocess.Popen([*xvfb_run(401), "paraview", "--script=" + folder + "/script.py"], env=environment,
                                   stdout=log, stderr=log, start_new_session=True)
        try:
            deadline = time.monotonic() + 200
            while not os.path.exists(folder + "/end") and program.poll() is None and time.monotonic() < deadline:
                time.sleep(0.5)
            log.seek(0)
            told = open(folder + "/told").read() if os.path.exists(folder + "/told") else "nothing"
            assert os.path.exists(folder + "/end"), told + log.read()[-4000:]
            told = json.loads(told)
            tolerances = [tolerance for tolerance, _ in told]
            assert tolerances[0] > 0.125 and 0.125 in tolerances, told
            fine = tolerances.index(0.125)
            assert told[0][1] * 4 < told[fine][1], told
            # The second time: coarse again, and fine again.
            assert any(t > 0.125 for t in tolerances[fine:]) and tolerances[-1] == 0.125, told
            with open(folder + "/end") as file:
                assert json.load(file) == [0.125, 0.125]
            assert "ERR|" not in log.read()
        finally:
            os.killpg(program.pid, 15)
            program.wait(timeout=60)
