# SPDX-License-Identifier: Apache-2.0
"""ParaView itself, on a screen in memory, loads the plugin, shows its filters' panels and draws."""
import json
import os
import subprocess
import tempfile
import time

from display import xvfb_run

SCRIPT = """
import os
from paraview.simple import *
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())
plane = Plane(XResolution=30, YResolution=30)
plane.UpdatePipeline()
for source in (AnamorphReliefSource(FileName={folder!r} + "/ramp.pgm"), AnamorphInbetween(Input=[plane, plane], Weights=[2, -1]),
               AnamorphDeform(Input=plane, GenerateOverlay=1)):
    SetActiveSource(source)
Show(source)
Show(OutputPort(source, 1))
Render()
SaveScreenshot({folder!r} + "/view.png")
open({folder!r} + "/drawn", "w").close()
"""

with tempfile.TemporaryDirectory() as folder:
    settings = folder + "/.config/ParaView"
    os.makedirs(settings)
    with open(settings + "/ParaView-UserSettings.json", "w") as file:
        json.dump({"settings": {"GeneralSettings": {"ShowWelcomeDialog": 0}}}, file)
    with open(folder + "/ramp.pgm", "wb") as file:
        file.write(b"P5\n16 16\n255\n" + bytes(range(256)))
    with open(folder + "/script.py", "w") as file:
        file.write(SCRIPT.format(folder=folder))
    environment = {**os.environ, "HOME": folder, "XDG_CONFIG_HOME": folder + "/.config", "XDG_RUNTIME_DIR": folder}
    with open(folder + "/log", "w+") as log:
        # A process group of its own, so that the screen goes with the program.
        shown = subprocess.Popen([*xvfb_run(321), "paraview", "--script=" + folder + "/script.py"], env=environment,
                                 stdout=log, stderr=log, start_new_session=True)
        try:
            deadline = time.monotonic() + 120
            while not os.path.exists(folder + "/drawn") and shown.poll() is None and time.monotonic() < deadline:
                time.sleep(0.2)
            time.sleep(2)  # panels are made after the script
            log.seek(0)
            text = log.read()
            assert os.path.exists(folder + "/drawn") and shown.poll() is None, text[-4000:]
            assert "ERR|" not in text, text[-4000:]
            assert os.path.getsize(folder + "/view.png") > 5000
        finally:
            os.killpg(shown.pid, 15)
            shown.wait(timeout=60)
