# SPDX-License-Identifier: Apache-2.0
"""The installed plugin works where it has been moved to, and loads nothing from the build tree."""
import glob
import os
import subprocess
import tempfile

BUILD = os.environ["ANAMORPH_BUILD_DIR"]
SCRIPT = """
from paraview.simple import *
LoadPlugin({plugin!r}, remote=False, ns=globals())
import anamorph
surface = AnamorphDeform(Input=Plane(), Deformations=[0, 0, 1, 1, 0, 0, 1, 0, 1])
surface.UpdatePipeline()
assert surface.GetDataInformation().GetBounds()[5] > 0.5
assert anamorph.vtkAnamorphDeform().GetClassName() == "vtkAnamorphDeform"
print(open("/proc/self/maps").read())
"""

with tempfile.TemporaryDirectory() as folder:
    subprocess.run(["cmake", "--install", BUILD, "--prefix", folder + "/first"], check=True, stdout=subprocess.DEVNULL)
    os.rename(folder + "/first", folder + "/second")
    plugins = glob.glob(folder + "/second/lib/**/paraview-*/plugins/Anamorph/Anamorph.so", recursive=True)
    assert len(plugins) == 1, plugins
    packages = glob.glob(folder + "/second/lib/**/dist-packages", recursive=True)
    assert len(packages) == 1, packages
    with open(folder + "/script.py", "w") as script:
        script.write(SCRIPT.format(plugin=plugins[0]))
    environment = {**os.environ, "PYTHONPATH": packages[0]}
    done = subprocess.run(["pvpython", folder + "/script.py"], env=environment, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stdout + done.stderr
    loaded = {line.split()[-1] for line in done.stdout.splitlines() if "namorph" in line}
    assert len(loaded) >= 4 and all(path.startswith(folder + "/second/") for path in loaded), loaded
    print("\n".join(sorted(os.path.basename(path) for path in loaded)))
