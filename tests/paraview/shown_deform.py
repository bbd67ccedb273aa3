# SPDX-License-Identifier: Apache-2.0
"""A Deform of a sphere in ParaView's window, with its handles: what the mouse does there, and what becomes of the list."""
import json
import os
import subprocess
import sys
import tempfile
import time

from display import xvfb_run

CONTROL = 0xffe3
# The view's background is of a color that nothing else has, by which it is found on the screen.
SCRIPT = """
import json, os
from paraview.simple import *
if "PV_PLUGIN_PATH" not in os.environ:
    LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())
GetSettingsProxy("GeneralSettings").AutoApply = {auto_apply}
sphere = {surface}
sphere.UpdatePipeline()
deform = AnamorphDeform(Input=sphere, AutomaticPlane=0, {settings})
view = GetActiveViewOrCreate("RenderView")
view.UseColorPaletteForBackground, view.Background, view.OrientationAxesVisibility = 0, [0, 1, 0], 0
try:
    view.BackgroundColorMode = "Single Color"
except Exception:
    pass
Show(deform, view)
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = {position}, {focus}, {up}
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
    now = json.dumps({{"size": list(view.GetRenderWindow().GetSize()),
                      "pixel": 2 * renderer.GetActiveCamera().GetParallelScale() / view.GetRenderWindow().GetSize()[1], "handles": handles,
                      "list": list(deform.Deformations), "table": list(deform.Bumps), "selected": deform.SelectedDeformation, "ranks": servermanager.ActiveConnection.GetNumberOfDataPartitions(),
                      "bounds": list(deform.GetDataInformation().GetBounds()),
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


class Shown:
    """ParaView's window, which runs the script of a folder."""

    def __init__(self, folder):
        from screen_events import Screen
        self.folder = folder
        self.server = None
        where = os.environ.get("ANAMORPH_ARGUMENTS", "").split()
        if os.environ.get("ANAMORPH_RANKS"):
            self.server = subprocess.Popen(["mpiexec", "--oversubscribe", "--mca", "mpi_yield_when_idle", "1", "-n", os.environ["ANAMORPH_RANKS"],
                                            "pvserver", "--server-port=0"], stdout=subprocess.PIPE, text=True)
            port = next(line.strip().rsplit(":", 1)[1] for line in self.server.stdout if line.startswith("Accepting connection(s): "))
            where = ["--disable-registry", "--server-url=cs://127.0.0.1:" + port]  # without the welcome, which comes before the script
        self.program = subprocess.Popen(["paraview", *where, "--script=" + folder + "/script.py"])
        self.screen = Screen()

    def look(self):
        """Waits for the window, and finds its view."""
        self.wait_for(lambda: os.path.exists(self.folder + "/state"))
        time.sleep(6)  # panels are made after the script, and the welcome is shown
        if not self.server and "--disable-registry" not in self.program.args:
            self.screen.close_dialog()
        self.left, top, right, self.bottom = view_on(self.screen.picture())
        size = self.state()["size"]
        assert abs(right - self.left - size[0]) <= 2 and abs(self.bottom - top - size[1]) <= 2, (self.left, top, right, self.bottom)
        self.pixel = self.state()["pixel"]  # in space; the camera is reset as the panels are made

    def state(self):
        with open(self.folder + "/state") as file:
            return json.load(file)

    def wait_for(self, condition):
        deadline = time.monotonic() + 150
        while not condition():
            assert time.monotonic() < deadline and self.program.poll() is None, "nothing happens"
            time.sleep(0.3)

    def of_view(self, at):
        """A point of the view, pixels from its lower left, on the screen."""
        return self.left + at[0], self.bottom - at[1]

    def wait_until_still(self, before):
        """Until the screen shows something else than before, and nothing but a cursor changes."""
        def changed(a, b):
            return (a != b).any(axis=2).sum() > 300

        last = [before]

        def still():
            last.append(self.screen.picture())
            return changed(last[-1], before) and not changed(last[-1], last[-2])

        self.wait_for(still)

    def click(self, x, y, control=False):
        """At a place in space, from the middle of the view."""
        size = self.state()["size"]
        at = self.of_view((size[0] / 2 + x / self.pixel, size[1] / 2 + y / self.pixel))
        self.screen.move(at[0] + 1, at[1])
        self.screen.move(*at)
        if control:
            self.screen.key(CONTROL, True)
        self.screen.button(True)
        self.screen.button(False)
        if control:
            self.screen.key(CONTROL, False)

    def press(self, key):
        """A key with Ctrl, such as z and y, which undo and redo."""
        self.screen.focus()
        for symbol, down in ((CONTROL, True), (ord(key), True), (ord(key), False), (CONTROL, False)):
            self.screen.key(symbol, down)

    def apply(self):
        """Presses the button Apply, which is green when there is something to apply."""
        def green():
            panel = self.screen.picture()[:, :self.left - 10].astype(int)
            return ((panel[:, :, 1] > panel[:, :, 0] + 15) & (panel[:, :, 1] > panel[:, :, 2] + 15) & (panel[:, :, 1] > 150)).nonzero()

        self.wait_for(lambda: len(green()[0]) > 300)
        rows, columns = green()
        self.screen.move(sorted(columns)[len(columns) // 2], sorted(rows)[len(rows) // 2])
        self.screen.button(True)
        self.screen.button(False)

    def view(self):
        """The pixels of the view."""
        width, height = self.state()["size"]
        return self.screen.picture()[self.bottom - height:self.bottom, self.left:self.left + width].astype(int)

    def surface(self):
        """Which pixels of the view are not its background."""
        picture = self.view()
        return ~((picture[:, :, 1] > 200) & (picture[:, :, 0] < 60) & (picture[:, :, 2] < 60))

    def save(self, name):
        keep = os.environ.get("ANAMORPH_KEEP_PICTURES")
        if keep:
            picture = self.screen.picture()
            with open(os.path.join(keep, name + ".ppm"), "wb") as file:
                file.write(b"P6\n%d %d\n255\n" % (picture.shape[1], picture.shape[0]) + picture.tobytes())

    def close(self):
        self.program.kill()
        self.program.wait(timeout=60)
        if self.server:
            self.server.terminate()
            self.server.wait(timeout=60)


def run(file, number, drive, auto_apply=1, surface="Sphere(Radius=1, ThetaResolution=64, PhiResolution=65)",
        settings="Deformations=[0, 0, .5, .5, 0, 0, .5, 0, 1], Depths=[0, 0, 1]", position="[0, -7, .3]", focus="[0, 0, .3]",
        up="[0, 0, 1]", script=SCRIPT, ranks=0, arguments=()):
    """Runs `drive` of a window in a display of its own; `file` is the test, which calls this again there. `script` shows the Deform, or
    something else; `arguments` are more of the program's. With `ranks` the window is the client of a server of so many, and both have the plugin by PV_PLUGIN_PATH."""
    if len(sys.argv) > 1:
        shown = Shown(sys.argv[1])
        try:
            shown.look()
            drive(shown)
        finally:
            shown.close()
        return
    with tempfile.TemporaryDirectory() as folder:
        os.makedirs(folder + "/.config")
        with open(folder + "/script.py", "w") as file_:
            file_.write(script.format(folder=folder, auto_apply=auto_apply, surface=surface, settings=settings, position=position,
                                      focus=focus, up=up))
        environment = {**os.environ, "HOME": folder, "XDG_CONFIG_HOME": folder + "/.config", "XDG_RUNTIME_DIR": folder,
                       "ANAMORPH_ARGUMENTS": " ".join(arguments)}
        if ranks:
            environment.update(ANAMORPH_RANKS=str(ranks), PV_PLUGIN_PATH=os.path.dirname(os.environ["ANAMORPH_PLUGIN"]))
        done = subprocess.run([*xvfb_run(number), sys.executable, file, folder], env=environment, capture_output=True, text=True,
                              timeout=390)
        assert done.returncode == 0, done.stdout[-4000:] + done.stderr[-4000:]
