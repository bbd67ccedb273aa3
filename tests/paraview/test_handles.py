# SPDX-License-Identifier: Apache-2.0
"""In ParaView's window, the handles of Deform are on the deformed surface, and the mouse drags the bump by them: its centre, its
corner and the tip of its vector."""
import json
import os
import subprocess
import sys
import tempfile
import time

from display import xvfb_run

# The view's background is of a color that nothing else has, by which it is found on the screen.
SCRIPT = """
import json, os
from paraview.simple import *
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())
GetSettingsProxy("GeneralSettings").AutoApply = 1
sphere = Sphere(Radius=1, ThetaResolution=64, PhiResolution=65)
sphere.UpdatePipeline()
deform = AnamorphDeform(Input=sphere, AutomaticPlane=0, Deformations=[0, 0, .5, .5, 0, 0, .5, 0, 1], Depths=[0, 0, 1])
view = GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground, view.Background, view.OrientationAxesVisibility = 0, [0, 1, 0], 0
try:
    view.BackgroundColorMode = "Single Color"
except Exception:
    pass
Show(deform, view)
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, -7, .3], [0, 0, .3], [0, 0, 1]
view.CameraParallelProjection, view.CameraParallelScale = 1, 2.2
SetActiveSource(deform)
Render(view)
told = [None]


def tell(*_):
    renderer = view.GetRenderer()
    handles = {{}}
    for name in ("SelectedCenter", "SelectedCorner", "SelectedTip"):
        renderer.SetWorldPoint(*deform.GetPropertyValue(name), 1)
        renderer.WorldToDisplay()
        handles[name] = list(renderer.GetDisplayPoint())
    now = json.dumps({{"size": list(view.GetRenderWindow().GetSize()), "handles": handles,
                      "list": list(deform.Deformations),
                      "places": {{name: list(deform.GetPropertyValue(name)) for name in handles}}}})
    if now != told[0]:
        told[0] = now
        with open({folder!r} + "/state.new", "w") as file:
            file.write(now)
        os.replace({folder!r} + "/state.new", {folder!r} + "/state")


view.GetRenderWindow().AddObserver("EndEvent", tell)
tell()
"""


def view_on(picture):
    """The rectangle of the view: left, top, right, bottom."""
    rows, columns = ((picture[:, :, 1] > 200) & (picture[:, :, 0] < 60) & (picture[:, :, 2] < 60)).nonzero()
    assert len(rows) > 10000, "the view is not seen"
    return columns.min(), rows.min(), columns.max() + 1, rows.max() + 1


def drive(folder):
    from screen_events import Screen
    shown = subprocess.Popen(["paraview", "--script=" + folder + "/script.py"])
    screen = Screen()

    def state():
        with open(folder + "/state") as file:
            return json.load(file)

    def wait_for(condition):
        deadline = time.monotonic() + 20
        while not condition():
            assert time.monotonic() < deadline and shown.poll() is None, "nothing happens"
            time.sleep(0.3)
    try:
        wait_for(lambda: os.path.exists(folder + "/state"))
        time.sleep(6)  # panels are made after the script, and the welcome is shown
        screen.close_dialog()
        left, top, right, bottom = view_on(screen.picture())
        size = state()["size"]
        assert abs(right - left - size[0]) <= 2 and abs(bottom - top - size[1]) <= 2, (left, top, right, bottom, size)
        pixel = 2 * 2.2 / size[1]  # in space

        def drag(name, right, up):
            """Drags a handle by a way in space, x and z; what becomes of the list."""
            before, at = state(), state()["handles"][name]
            start = left + at[0], bottom - at[1]
            screen.drag(start, (start[0] + right / pixel, start[1] - up / pixel))
            np_save(folder + "/dragged", screen.picture())
            wait_for(lambda: state()["list"] != before["list"])
            time.sleep(2)
            return state()

        before = state()
        assert abs(before["places"]["SelectedCenter"][2] - 1.5) < 1e-5, before["places"]
        np_save(folder + "/before", screen.picture())
        tip = drag("SelectedTip", 0.3, 0.2)
        found, wanted = tip["list"], [0, 0, .5, .5, .3, 0, .7, 0, 1]
        assert all(abs(f - w) < 3 * pixel for f, w in zip(found, wanted)), found
        np_save(folder + "/tip", screen.picture())
        center = drag("SelectedCenter", -0.25, 0)
        assert abs(center["list"][0] + .25) < 3 * pixel and center["list"][2:] == found[2:], center["list"]
        corner = drag("SelectedCorner", 0.2, 0)
        assert abs(corner["list"][2] - .7) < 3 * pixel, corner["list"]
        assert corner["list"][4:] == found[4:], corner["list"]
        np_save(folder + "/corner", screen.picture())
    finally:
        shown.kill()
        shown.wait(timeout=60)


def np_save(name, picture):
    keep = os.environ.get("ANAMORPH_KEEP_PICTURES")
    if keep:
        with open(os.path.join(keep, os.path.basename(name) + ".ppm"), "wb") as file:
            file.write(b"P6\n%d %d\n255\n" % (picture.shape[1], picture.shape[0]) + picture.tobytes())


def main():
    with tempfile.TemporaryDirectory() as folder:
        os.makedirs(folder + "/.config")
        with open(folder + "/script.py", "w") as file:
            file.write(SCRIPT.format(folder=folder))
        environment = {**os.environ, "HOME": folder, "XDG_CONFIG_HOME": folder + "/.config", "XDG_RUNTIME_DIR": folder}
        done = subprocess.run([*xvfb_run(326), sys.executable, __file__, folder], env=environment, capture_output=True,
                              text=True, timeout=250)
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]


if len(sys.argv) > 1:
    drive(sys.argv[1])
else:
    main()
