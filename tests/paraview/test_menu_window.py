# SPDX-License-Identifier: Apache-2.0
"""In ParaView's window a Deform that is made by name, as from the menu, is one of the active source, in the active view of two, and its first bump is seen there at
once. A click with Ctrl on another side of the surface makes one that stands out of it, too."""
import os
import time

import numpy as np
from shown_deform import CONTROL, run

SCRIPT = """
import json, os
from paraview.simple import *
LoadPlugin(os.environ["ANAMORPH_PLUGIN"], remote=False, ns=globals())
GetSettingsProxy("GeneralSettings").AutoApply = 1
layout = GetLayout()
left = GetActiveViewOrCreate("RenderView")
other, ball = Plane(registrationName="other"), Sphere(registrationName="ball")
other.UpdatePipeline()
ball.UpdatePipeline()
layout.SplitHorizontal(0, 0.3)
view = CreateRenderView()
AssignViewToLayout(view=view, layout=layout, hint=2)
view.UseColorPaletteForBackground, view.Background, view.OrientationAxesVisibility = 0, [0, 1, 0], 0
view.BackgroundColorMode = "Single Color"
Show(other, left)
Show(ball, view)
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, 0, 4], [0, 0, 0], [0, 1, 0]
view.CameraParallelProjection, view.CameraParallelScale = 1, 1
SetActiveView(view)
SetActiveSource(ball)
Render(view)


def tell(*_):
    made = [p for p in GetSources().values() if p.SMProxy.GetXMLName() == "AnamorphDeform"]
    now = {{"size": list(view.GetRenderWindow().GetSize()), "pixel": 2 * view.GetRenderer().GetActiveCamera().GetParallelScale() / view.GetRenderWindow().GetSize()[1],
           "made": len(made)}}
    if made:
        shown = [v.FindRepresentation(made[0].SMProxy, 0) for v in (left.SMProxy, view.SMProxy)]
        now.update(of=[made[0].Input.SMProxy.GetXMLName(), made[0].Input.Port], shown=[bool(r and r.GetProperty("Visibility").GetElement(0)) for r in shown],
                   table=list(made[0].Bumps), subdivisions=made[0].Subdivisions)
    with open({folder!r} + "/state.new", "w") as file:
        file.write(json.dumps(now))
    os.replace({folder!r} + "/state.new", {folder!r} + "/state")


view.GetRenderWindow().AddObserver("EndEvent", tell)
tell()
"""


def drive(shown):
    screen = shown.screen
    assert shown.state()["made"] == 0
    rest = shown.surface()
    middle = shown.of_view([c / 2 for c in shown.state()["size"]])
    screen.move(*middle)
    screen.focus()
    before = screen.picture()
    for symbol, down in ((CONTROL, True), (0x20, True), (0x20, False), (CONTROL, False)):
        screen.key(symbol, down)  # the quick launch: the menu's entries by name
    shown.wait_until_still(before)
    before = screen.picture()
    screen.focus_top()
    for symbol in map(ord, "anamorph deform"):
        for down in (True, False):
            screen.key(symbol, down)
    shown.wait_until_still(before)
    for down in (True, False):
        screen.key(0xff0d, down)
    shown.wait_for(lambda: shown.state()["made"] == 1 and shown.state()["shown"] == [False, True])
    assert shown.state()["of"] == ["SphereSource", 0] and shown.state()["subdivisions"] > 0, shown.state()
    time.sleep(3)
    shown.save("first")
    # It stands out at the upper right.
    rows, columns = (shown.surface() & ~rest).nonzero()
    size = shown.state()["size"]
    upper_right = ((columns > size[0] / 2) & (rows < size[1] / 2)).sum()
    assert upper_right * shown.pixel ** 2 > .003 and upper_right > .8 * len(rows), (upper_right, len(rows), size)

    first = shown.state()["table"]
    shown.click(-.3, -.25, control=True)
    shown.wait_for(lambda: len(shown.state()["table"]) == 2 * 19)
    assert shown.state()["table"][:19] == first
    V = np.array(shown.state()["table"][19 + 6:19 + 9])
    at = np.array([-.3, -.25, np.sqrt(.25 - .09 - .0625)])
    assert V @ at > .9 * np.linalg.norm(V) * np.linalg.norm(at), V
    time.sleep(2)
    shown.save("second")


os.environ.pop("PV_PLUGIN_PATH", None)
run(__file__, 395, drive, script=SCRIPT, arguments=["--disable-registry"])
