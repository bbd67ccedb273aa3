# SPDX-License-Identifier: Apache-2.0
"""In ParaView's window a dragged handle shows the surface live, before anything is applied, and one that is put back brings it back."""
import time

from shown_deform import run


def drive(shown):
    screen, near = shown.screen, 4 * shown.pixel

    def area():
        time.sleep(1)
        return int(shown.surface().sum())

    # Live: with the button still held the list is as it was, and the bump on the screen is higher.
    before, low = shown.state(), area()
    start = shown.of_view(before["handles"]["SelectedTip"])
    screen.move(*start)
    screen.button(True)
    for i in range(1, 9):
        screen.move(start[0], start[1] - i / 8 * 0.5 / shown.pixel)
    shown.wait_for(lambda: abs(shown.state()["bounds"][5] - 2) < 4 * near)
    high = area()
    shown.save("live")
    assert shown.state()["list"] == before["list"], shown.state()["list"]
    assert (high - low) * shown.pixel ** 2 > 0.1, (low, high)  # by the integral of .5 F, some .3
    screen.button(False)
    time.sleep(2)
    assert shown.state()["list"] == before["list"]
    # Back where it was: so is the surface.
    at = shown.of_view((before["handles"]["SelectedTip"][0], before["handles"]["SelectedTip"][1] + 0.5 / shown.pixel))
    screen.drag(at, start)
    shown.wait_for(lambda: abs(shown.state()["bounds"][5] - 1.5) < 4 * near)
    assert abs(area() - low) * shown.pixel ** 2 < 0.05


run(__file__, 327, drive, auto_apply=0)
