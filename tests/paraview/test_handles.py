# SPDX-License-Identifier: Apache-2.0
"""In ParaView's window, the handles of Deform are on the deformed surface, and the mouse drags the bump by them: its centre, its
corner and the tip of its vector."""
import time

from shown_deform import run


def drive(shown):
    def drag(name, right, up):
        """Drags a handle by a way in space, x and z; what becomes of the list."""
        before = shown.state()
        start = shown.of_view(before["handles"][name])
        shown.screen.drag(start, (start[0] + right / shown.pixel, start[1] - up / shown.pixel))
        shown.apply()
        shown.wait_for(lambda: shown.state()["list"] != before["list"])
        time.sleep(2)
        return shown.state()

    near = 3 * shown.pixel
    before = shown.state()
    assert abs(before["places"]["SelectedCenter"][2] - 1.5) < 1e-5, before["places"]
    shown.save("before")
    tip = drag("SelectedTip", 0.3, 0.2)
    found, wanted = tip["list"], [0, 0, .5, .5, .3, 0, .7, 0, 1]
    assert all(abs(f - w) < near for f, w in zip(found, wanted)), found
    shown.save("tip")
    center = drag("SelectedCenter", -0.25, 0)
    assert abs(center["list"][0] + .25) < near and center["list"][2:] == found[2:], center["list"]
    corner = drag("SelectedCorner", 0.2, 0)
    assert abs(corner["list"][2] - .7) < near, corner["list"]
    assert corner["list"][4:] == found[4:], corner["list"]
    shown.save("corner")


# Auto Apply takes what a slow drag has by then, and ParaView takes no mouse while it applies.
run(__file__, 326, drive, auto_apply=0)
