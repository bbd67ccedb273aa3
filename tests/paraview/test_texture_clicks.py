# SPDX-License-Identifier: Apache-2.0
"""Clicks on a surface whose parameters are texture coordinates: a click selects the bump that is there, and the handles follow, and one with Ctrl makes a
new one at the (u, v) that was clicked, which stands out of it there. Seen from above."""
from shown_deform import run

ROWS = [.3, .5, .1, .1, 0, 0, .3, 0, 1, .7, .5, .1, .1, 0, 0, .3, 0, 1]


def drive(shown):
    near = 4 * shown.pixel

    def is_near(found, wanted):
        return all(abs(f - w) < near for f, w in zip(found, wanted))

    # The plane is two units wide, and u and v go from 0 to 1 on it.
    assert shown.state()["selected"] == 0 and is_near(shown.state()["places"]["SelectedCenter"], (-.4, 0))
    shown.click(.4, -.15)
    shown.wait_for(lambda: shown.state()["selected"] == 1)
    shown.wait_for(lambda: is_near(shown.state()["places"]["SelectedCenter"], (.4, 0, .3)))
    shown.click(-.4, -.15)
    shown.wait_for(lambda: shown.state()["selected"] == 0 and is_near(shown.state()["places"]["SelectedCenter"], (-.4, 0, .3)))
    shown.click(.2, .7, control=True)
    shown.wait_for(lambda: len(shown.state()["list"]) == 27 and shown.state()["selected"] == 2)
    row = shown.state()["list"][18:]
    assert is_near([2 * x - 1 for x in row[:2]], (.2, .7)) and row[2:] == ROWS[2:9], row
    shown.wait_for(lambda: is_near(shown.state()["places"]["SelectedCenter"], (.2, .7, .3)))
    shown.save("placed_by_texture")


run(__file__, 330, drive, surface="Plane(Origin=[-1, -1, 0], Point1=[1, -1, 0], Point2=[-1, 1, 0], XResolution=80, YResolution=80)",
    settings=f"Deformations={ROWS}, ParameterMode=1", position="[0, 0, 7]", focus="[0, 0, 0]", up="[0, 1, 0]")
